//! Curves of error against cost, and what is read from them.

use cpu_time::ProcessTime;

/// Errors at which the costs of schemes are compared.
pub const TARGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// Runs shorter than this are repeated, and the fastest counts.
const SHORT: f64 = 0.02;

/// Most repetitions of a short run.
const REPETITIONS: usize = 5;

/// One run.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Step size.
    pub dt: f64,
    /// Relative error of the end positions.
    pub error: f64,
    /// Relative error of the energy that friction has dissipated, where there is friction.
    pub of_dissipation: Option<f64>,
    /// CPU time of the run.
    pub seconds: f64,
    /// Evaluations of the forces.
    pub evaluations: u64,
}

/// The runs of one scheme, steps decreasing.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// Name of the scheme.
    pub scheme: String,
    /// Runs that came to their end.
    pub points: Vec<Point>,
    /// Steps at which the scheme failed, and why.
    pub failures: Vec<String>,
    /// The order that the two finest runs must show; `None`: reported without a bound.
    pub checked_order: Option<f64>,
}

impl Curve {
    /// Observed order of the two finest runs whose errors are larger than `floor`.
    pub fn order(&self, floor: f64) -> Option<f64> {
        let told: Vec<&Point> = self.points.iter().filter(|p| p.error > floor).collect();
        let [.., a, b] = told.as_slice() else { return None };
        let order = (a.error / b.error).ln() / (a.dt / b.dt).ln();
        order.is_finite().then_some(order)
    }

    /// CPU time at which the error falls to `target`, interpolated between runs; `None` if it does not.
    pub fn seconds_to(&self, target: f64) -> Option<f64> {
        let reached = self.points.iter().filter(|p| p.error <= target).map(|p| p.seconds);
        let between = self.points.windows(2).filter_map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            if !(a.error > target && b.error <= target && b.error > 0.0) {
                return None;
            }
            let share = (a.error / target).ln() / (a.error / b.error).ln();
            Some((a.seconds.ln() + share * (b.seconds / a.seconds).ln()).exp())
        });
        reached.chain(between).min_by(f64::total_cmp)
    }
}

/// A problem with its reference and the curves of all schemes.
#[derive(Clone, Debug)]
pub struct ProblemCurves {
    /// Short name.
    pub name: String,
    /// What it is.
    pub about: String,
    /// How the reference was computed.
    pub reference: String,
    /// Estimate of its relative error.
    pub reference_error: f64,
    /// Estimate of the relative error of the energy that friction has dissipated in the reference; `None` without friction.
    pub dissipation_error: Option<f64>,
    /// Smallest error of [`TARGETS`] that the reference can tell.
    pub least_target: f64,
    /// Figure of the thesis that it corresponds to.
    pub figure: Option<String>,
    /// One a scheme.
    pub curves: Vec<Curve>,
}

impl ProblemCurves {
    /// Errors below this say more about the reference than about the scheme.
    pub fn floor(&self) -> f64 {
        100.0 * self.reference_error
    }

    /// Schemes that need at most `factor` times the CPU time of the cheapest one, the others too.
    pub fn level(&self, target: f64, factor: f64) -> Vec<&str> {
        let Some((cheapest, seconds)) = self.cheapest(target) else { return Vec::new() };
        let others = self.curves.iter().filter(|c| c.scheme != cheapest);
        others
            .filter(|c| c.seconds_to(target).is_some_and(|s| s <= factor * seconds))
            .map(|c| c.scheme.as_str())
            .collect()
    }

    /// The scheme that reaches an error with the least CPU time.
    pub fn cheapest(&self, target: f64) -> Option<(&str, f64)> {
        let reached = self.curves.iter().filter_map(|c| c.seconds_to(target).map(|s| (c.scheme.as_str(), s)));
        reached.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Result of a run and its CPU time; short runs are repeated.
pub fn timed<T, E>(mut run: impl FnMut() -> Result<T, E>) -> Result<(T, f64), E> {
    let mut best = f64::INFINITY;
    let mut count = 0;
    loop {
        let start = ProcessTime::now();
        let result = run()?;
        best = best.min(start.elapsed().as_secs_f64());
        count += 1;
        if best > SHORT || count == REPETITIONS {
            // A clock that does not tick gives no zero, which no logarithm could show.
            return Ok((result, best.max(1e-9)));
        }
    }
}

/// `|a - b| / |b|`.
pub fn relative_distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    squares(&mut a.iter().zip(b).map(|(a, b)| a - b)) / squares(&mut b.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64, f64)]) -> Curve {
        let points = points.iter().map(|&(dt, error, seconds)| Point {
            dt,
            error,
            of_dissipation: None,
            seconds,
            evaluations: 1,
        });
        Curve { scheme: "s".into(), points: points.collect(), ..Curve::default() }
    }

    #[test]
    fn costs_are_interpolated_on_logarithmic_axes() {
        let c = curve(&[(1.0, 1e-1, 1.0), (0.5, 1e-3, 4.0)]);
        assert!((c.seconds_to(1e-2).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(c.seconds_to(1e-4), None);
        assert_eq!(c.seconds_to(1.0), Some(1.0), "the first run is good enough");
        assert!((c.order(0.0).unwrap() - 100.0_f64.log2()).abs() < 1e-12);
    }

    #[test]
    fn the_cheapest_scheme_is_found() {
        let fast = Curve { scheme: "fast".into(), ..curve(&[(1.0, 1e-4, 0.5)]) };
        let case = ProblemCurves {
            name: String::new(),
            about: String::new(),
            reference: String::new(),
            reference_error: 0.0,
            dissipation_error: None,
            least_target: 1e-4,
            figure: None,
            curves: vec![curve(&[(1.0, 1e-4, 1.0)]), fast],
        };
        assert_eq!(case.cheapest(1e-3), Some(("fast", 0.5)));
        assert_eq!(case.cheapest(1e-9), None);
    }
}
