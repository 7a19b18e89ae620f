//! A return that has no kink: the traction keeps inside of its bound (theory/friction#eq-smoothed-return).

use super::law::{Bound, Plane, Traction, direction};

/// Most iterations for the root; bisection alone takes as many as a number has digits.
const MAX_ITERATIONS: u32 = 60;

/// Solves `(w - 1) (1 - eta^2 / w^2) = epsilon` for `w > max(1, eta)`, the ratio of trial traction to traction: a function that grows from `-epsilon` there without end.
fn ratio(eta: f64, epsilon: f64) -> f64 {
    let (mut low, mut high) = (eta.max(1.0), 1.0 + eta + epsilon);
    let mut w = high;
    for _ in 0..MAX_ITERATIONS {
        let square = (eta / w).powi(2);
        let value = (w - 1.0) * (1.0 - eta / w) * (1.0 + eta / w) - epsilon;
        if value > 0.0 {
            high = w
        } else {
            low = w
        }
        let slope = 1.0 + square - 2.0 * square / w;
        let next = w - value / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - w).abs() <= f64::EPSILON * w {
            return next;
        }
        w = next;
    }
    w
}

/// The traction `t` that minimises `|t - trial|^2 / 2 - theta^2 ln(r^2 - |t|^2)`, with its derivatives: inside of the bound `r`, and the return to it without smoothing. At the solution of
/// `t = return(t + k s)` the slip is `k s = 2 theta^2 t / (r^2 - |t|^2)`, the path of an interior point, as `p c gap = theta^2` is that of pressures.
///
/// `theta > 0`: a traction.
pub(super) fn smoothed_return(trial: Plane, bound: &Bound, slip: Plane, theta: f64) -> Traction {
    let r = bound.traction;
    let y = trial[0].hypot(trial[1]);
    let epsilon = 2.0 * (theta / r).powi(2);
    if r == 0.0 || !epsilon.is_finite() {
        return Traction { sticks: true, ..Traction::default() };
    }
    let n = direction(trial);
    let eta = y / r;
    let w = ratio(eta, epsilon);
    let tau = eta / w;
    // 1 - tau^2, near the bound without cancellation.
    let room = if eta < 1.0 { (1.0 - tau) * (1.0 + tau) } else { epsilon / (w - 1.0) };
    let stiffness = room + 2.0 * epsilon * tau * tau / room + epsilon;
    let (by_eta, by_epsilon) = (room / stiffness, -tau / stiffness);
    let by_bound = tau - eta * by_eta - 2.0 * epsilon * by_epsilon;
    let by_slip = direction(slip).map(|s| by_bound * bound.d_slip * s);
    Traction {
        traction: trial.map(|t| t / w),
        sticks: true,
        d_pressure: n.map(|n| by_bound * bound.d_pressure * n),
        d_trial: std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let along = n[i] * n[j];
                by_eta * along + (f64::from(u8::from(i == j)) - along) / w
            })
        }),
        d_slip: n.map(|n| by_slip.map(|s| n * s)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::law::return_to_bound;
    use super::*;

    fn bound(mu: f64, p: f64) -> Bound {
        Bound { traction: mu * p, d_pressure: mu, d_slip: 0.0 }
    }

    #[test]
    fn derivatives_are_those_of_differences_at_any_smoothing() {
        for exponent in -7..=3 {
            let theta = 10f64.powi(exponent);
            for trial in [[0.1, 0.02], [0.3, 0.39999], [0.3, 0.4], [0.31, 0.41], [-4.0, 7.0]] {
                let (mu, p) = (0.5, 1.0);
                let at = |trial: Plane, p: f64| smoothed_return(trial, &bound(mu, p), [0.0; 2], theta);
                let here = at(trial, p);
                let size = here.traction[0].hypot(here.traction[1]);
                assert!(size < mu * p || theta < 1e-6 && size <= mu * p);
                // Within the kink the function has a radius of curvature of the smoothing.
                let h = 1e-3 * theta.min(1e-2);
                for j in 0..2 {
                    let moved =
                        |d: f64| at(std::array::from_fn(|i| trial[i] + if i == j { d } else { 0.0 }), p).traction;
                    let (more, less) = (moved(h), moved(-h));
                    for i in 0..2 {
                        let difference = (more[i] - less[i]) / (2.0 * h);
                        let error = (difference - here.d_trial[i][j]).abs();
                        assert!(error < 1e-5 + 1e-15 / h, "theta {theta} {trial:?}: {difference} {:?}", here.d_trial);
                    }
                }
                let (more, less) = (at(trial, p + h).traction, at(trial, p - h).traction);
                for i in 0..2 {
                    let difference = (more[i] - less[i]) / (2.0 * h);
                    let error = (difference - here.d_pressure[i]).abs();
                    assert!(error < 1e-5 + 1e-15 / h, "theta {theta} {trial:?}: {difference} {:?}", here.d_pressure);
                }
            }
        }
    }

    #[test]
    fn it_ends_at_the_return_and_keeps_the_path() {
        let (mu, p) = (0.5, 2.0);
        for trial in [[0.3, -0.2], [3.0, 1.0]] {
            let exact = return_to_bound(trial, &bound(mu, p), [0.0; 2]);
            for theta in [1e-2, 1e-4, 1e-8] {
                let smooth = smoothed_return(trial, &bound(mu, p), [0.0; 2], theta);
                let [a, b] = [0, 1].map(|i| (smooth.traction[i] - exact.traction[i]).abs());
                assert!(a.max(b) < 2.0 * theta, "{trial:?} {theta}");
                // k s (r^2 - |t|^2) = 2 theta^2 t, up to the round-off of the difference of squares.
                let (bound, [a, b]) = ((mu * p).powi(2), smooth.traction);
                for i in 0..2 {
                    let slip = trial[i] - smooth.traction[i];
                    let error = slip * (bound - a * a - b * b) - 2.0 * theta * theta * smooth.traction[i];
                    assert!(error.abs() < 1e-14 * bound * slip.abs() + 1e-15 * bound, "{trial:?} {theta}: {error}");
                }
            }
        }
    }

    #[test]
    fn without_pressure_or_trial_there_is_no_traction() {
        let none = smoothed_return([1.0, 2.0], &Bound::default(), [0.0; 2], 0.1);
        assert_eq!(none.traction, [0.0; 2]);
        let at_rest = smoothed_return([0.0; 2], &bound(0.5, 1.0), [0.0; 2], 0.5);
        assert!(at_rest.traction == [0.0; 2] && (at_rest.d_trial[0][0] - 1.0 / 3.0).abs() < 1e-15);
    }
}
