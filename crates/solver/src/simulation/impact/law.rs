//! The impact law in the space of the closed slots (theory/impacts#law): impulses from the rates of the gaps, and the energy that they leave.
//!
//! Nothing here knows bodies or contact: a slot has a row, and what is needed of the rows is `W = G R(G^T)`, the rates before the step, and those at its end without impulses.

use super::complementarity::{Compliance, complementary};

/// Passes of reflections after which what still approaches is stopped.
const MAX_PASSES: usize = 200;

/// Rates below this part of the largest one count as zero.
const ROUND_OFF: f64 = 1e-12;

/// The rates of the closed slots, positive where they open.
#[derive(Debug)]
pub(super) struct Rates<'a> {
    /// `u^-`: at the start of the step.
    pub before: &'a [f64],
    /// Rates at the end of the step without the impulses of the slots.
    pub free: &'a [f64],
    /// What each must at least have in the end: zero, or that with which a gap that is held settles.
    pub least: &'a [f64],
    /// Restitution of each.
    pub restitution: &'a [f64],
}

/// Impulses of the slots.
#[derive(Clone, Debug, Default)]
pub(super) struct Impulses {
    /// Impulses without restitution.
    pub plastic: Vec<f64>,
    /// Impulses with restitution; those without if there is none.
    pub all: Vec<f64>,
    /// The restitution, if it is the same for all slots.
    pub uniform: Option<f64>,
}

/// The impulses of an impact, loads of the step included.
pub(super) fn impulses<W: Compliance>(w: &mut W, rates: &Rates<'_>) -> Result<Impulses, W::Error> {
    let m = w.len();
    let every: Vec<usize> = (0..m).collect();
    let plastic = complementary(w, rates.before, &every)?;
    let mut image = vec![0.0; m];
    let mut with_loads = |w: &mut W, mut j: Vec<f64>| -> Result<Vec<f64>, W::Error> {
        w.multiply(&j, &mut image)?;
        let rate: Vec<f64> = (0..m).map(|i| rates.free[i] + image[i] - rates.least[i]).collect();
        let loads = complementary(w, &rate, &every)?;
        j.iter_mut().zip(loads).for_each(|(j, load)| *j += load);
        Ok(j)
    };
    let of_plastic = with_loads(w, plastic.clone())?;
    let first = rates.restitution.first().copied().unwrap_or(0.0);
    let uniform = rates.restitution.iter().all(|&e| e == first).then_some(first);
    if uniform == Some(0.0) {
        return Ok(Impulses { all: of_plastic.clone(), plastic: of_plastic, uniform });
    }
    let reflected = reflections(w, rates, uniform.is_some())?;
    let mixed = match uniform {
        Some(e) => plastic.iter().zip(&reflected).map(|(p, r)| p + e * (r - p)).collect(),
        None => reflected,
    };
    let all = with_loads(w, mixed)?;
    Ok(Impulses { plastic: of_plastic, all, uniform })
}

/// Generalised reflections (Smith, Kaufman, Vouga, Tamstorf and Grinspun, *Reflections on simultaneous impact*, 2012): in each pass the slots that approach are reflected, all with `e = 1` if
/// restitution is the same everywhere, else each with its own. What approaches after the last pass is stopped.
fn reflections<W: Compliance>(w: &mut W, rates: &Rates<'_>, uniform: bool) -> Result<Vec<f64>, W::Error> {
    let m = w.len();
    let scale = rates.before.iter().fold(0.0_f64, |scale, u| scale.max(u.abs()));
    let (mut j, mut rate) = (vec![0.0; m], rates.before.to_vec());
    let approaching = |rate: &[f64]| -> Vec<usize> { (0..m).filter(|&i| rate[i] < -ROUND_OFF * scale).collect() };
    for pass in 0..=MAX_PASSES {
        let of = approaching(&rate);
        if of.is_empty() {
            break;
        }
        let factor = |i: usize| match (pass == MAX_PASSES, uniform) {
            (true, _) => 1.0,
            (false, true) => 2.0,
            (false, false) => 1.0 + rates.restitution[i],
        };
        let asked: Vec<f64> = (0..m).map(|i| factor(i) * rate[i]).collect();
        let more = complementary(w, &asked, &of)?;
        j.iter_mut().zip(more).for_each(|(j, more)| *j += more);
        w.multiply(&j, &mut rate)?;
        rate.iter_mut().zip(rates.before).for_each(|(rate, before)| *rate += before);
    }
    Ok(j)
}

/// A quadratic function on a line, `E(s)`: its values at 0 and 1, and half of its second derivative.
#[derive(Clone, Copy, Debug)]
pub(super) struct EnergyOnLine {
    /// Energy at `s = 0`.
    pub start: f64,
    /// Energy at `s = 1`.
    pub end: f64,
    /// `1/2 E''`, the kinetic energy of the difference of both velocities, not negative.
    pub curvature: f64,
}

impl EnergyOnLine {
    /// The larger `s` with `E(s) = wanted`; `None` if there is none.
    pub fn reaches(&self, wanted: f64) -> Option<f64> {
        let (a, b, c) = (self.curvature, self.end - self.start - self.curvature, self.start - wanted);
        let root = (b * b - 4.0 * a * c).sqrt();
        let s = if b > 0.0 { -2.0 * c / (b + root) } else { (root - b) / (2.0 * a) };
        s.is_finite().then_some(s)
    }

    /// Where `E` is least.
    pub fn lowest(&self) -> f64 {
        let b = self.end - self.start - self.curvature;
        if self.curvature > 0.0 { (-b / (2.0 * self.curvature)).clamp(0.0, 1.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::complementarity::DenseCompliance;
    use super::*;

    /// Numbers in [-1, 1) that look random.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// `W = G G^T` for `m` rows in a space of the dimension `n`: of deficient rank if `m > n`. Also `G` and a velocity.
    fn system(seed: u64, m: usize, n: usize) -> (DenseCompliance, Vec<Vec<f64>>, Vec<f64>) {
        let mut next = numbers(seed);
        // All of them open along the first direction: without a common one nothing but rest is admissible.
        let row = |next: &mut dyn FnMut() -> f64| -> Vec<f64> {
            (0..n).map(|c| if c == 0 { 1.0 + next().abs() } else { next() }).collect()
        };
        let g: Vec<Vec<f64>> = (0..m).map(|_| row(&mut next)).collect();
        let v: Vec<f64> = (0..n).map(|_| next()).collect();
        let entries = g.iter().flat_map(|a| g.iter().map(move |b| dot(a, b))).collect();
        (DenseCompliance::new(m, entries), g, v)
    }

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    fn after(g: &[Vec<f64>], v: &[f64], j: &[f64]) -> Vec<f64> {
        (0..v.len()).map(|c| v[c] + g.iter().zip(j).map(|(g, j)| g[c] * j).sum::<f64>()).collect()
    }

    const SIZES: [(usize, usize); 6] = [(1, 1), (4, 3), (6, 8), (12, 5), (20, 6), (40, 60)];

    #[test]
    fn plastic_impulses_are_complementary() {
        for seed in 1..40 {
            for (m, n) in SIZES {
                let (mut w, g, v) = system(seed, m, n);
                let before: Vec<f64> = g.iter().map(|g| dot(g, &v)).collect();
                let every: Vec<usize> = (0..m).collect();
                let Ok(j) = complementary(&mut w, &before, &every);
                let now = after(&g, &v, &j);
                for (g, &j) in g.iter().zip(&j) {
                    let u = dot(g, &now);
                    assert!(j >= 0.0 && u > -1e-10 && (j * u).abs() < 1e-10, "{seed} {m} {n}: {j} {u}");
                }
                assert!(dot(&now, &now) <= dot(&v, &v) * (1.0 + 1e-12));
            }
        }
    }

    /// The law by products alone.
    #[test]
    fn products_alone_give_the_same_velocities() {
        for seed in 1..20 {
            let (mut w, g, v) = system(seed, 40, 60);
            let before: Vec<f64> = g.iter().map(|g| dot(g, &v)).collect();
            let every: Vec<usize> = (0..40).collect();
            let Ok(j) = complementary(&mut w, &before, &every);
            let diagonal = g.iter().map(|g| dot(g, g)).collect();
            let mut operator =
                super::super::complementarity::OperatorCompliance::new(diagonal, |j: &[f64], out: &mut [f64]| {
                    w.multiply(j, out)
                });
            let Ok(other) = complementary(&mut operator, &before, &every);
            let off =
                after(&g, &v, &j).iter().zip(after(&g, &v, &other)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "{seed}: {off:e}");
        }
    }

    #[test]
    fn energy_is_kept_with_one_and_never_grows() {
        for seed in 1..40 {
            for (m, n) in SIZES {
                let (mut w, g, v) = system(seed, m, n);
                let before: Vec<f64> = g.iter().map(|g| dot(g, &v)).collect();
                let mut last = 0.0;
                let different: Vec<f64> = (0..m).map(|i| [0.0, 0.3, 0.9, 1.0][i % 4]).collect();
                for restitution in [vec![0.0; m], vec![0.5; m], vec![1.0; m], different] {
                    // Without loads the velocities at the end of the step are those at its start.
                    let rates =
                        Rates { before: &before, free: &before, least: &vec![0.0; m], restitution: &restitution };
                    let Ok(found) = impulses(&mut w, &rates);
                    let now = after(&g, &v, &found.all);
                    let part = dot(&now, &now) / dot(&v, &v);
                    assert!(part <= 1.0 + 1e-10, "{seed} {m} {n}: {part}");
                    assert!(g.iter().all(|g| dot(g, &now) > -1e-10), "{seed} {m} {n}: approaches");
                    match found.uniform {
                        Some(1.0) => assert!((part - 1.0).abs() < 1e-10, "{seed} {m} {n}: {part}"),
                        // One slot has no different ones.
                        Some(e) => assert!(e == 0.0 || part >= last - 1e-10, "{seed} {m} {n}: {part} {last}"),
                        None => {}
                    }
                    last = part;
                }
            }
        }
    }

    /// Five equal bodies in a row that touch, the first of which comes with a speed of one.
    #[test]
    fn a_cradle_hands_the_impact_on() {
        let g: Vec<Vec<f64>> = (0..4)
            .map(|k| {
                (0..5)
                    .map(|c| {
                        if c == k {
                            -1.0
                        } else if c == k + 1 {
                            1.0
                        } else {
                            0.0
                        }
                    })
                    .collect()
            })
            .collect();
        let v = [1.0, 0.0, 0.0, 0.0, 0.0];
        let expected: [(f64, [f64; 5]); 4] = [
            (1.0, [0.0, 0.0, 0.0, 0.0, 1.0]),
            (0.9, [0.02, 0.02, 0.02, 0.02, 0.92]),
            (0.5, [0.1, 0.1, 0.1, 0.1, 0.6]),
            (0.0, [0.2; 5]),
        ];
        for (e, expected) in expected {
            let entries = g.iter().flat_map(|a| g.iter().map(move |b| dot(a, b))).collect();
            let mut w = DenseCompliance::new(4, entries);
            let before: Vec<f64> = g.iter().map(|g| dot(g, &v)).collect();
            let rates = Rates { before: &before, free: &before, least: &[0.0; 4], restitution: &[e; 4] };
            let Ok(found) = impulses(&mut w, &rates);
            let now = after(&g, &v, &found.all);
            let off = now.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "{e}: {now:?}");
        }
    }

    #[test]
    fn energies_on_a_line() {
        // (s - 0.25)^2
        let line = EnergyOnLine { start: 0.0625, end: 0.5625, curvature: 1.0 };
        assert!((line.reaches(0.25).unwrap() - 0.75).abs() < 1e-15 && line.lowest() == 0.25);
        assert_eq!(line.reaches(-1.0), None);
        let falling = EnergyOnLine { start: 1.0, end: 0.25, curvature: 0.25 };
        assert!((falling.reaches(0.25).unwrap() - 3.0).abs() < 1e-15);
    }
}
