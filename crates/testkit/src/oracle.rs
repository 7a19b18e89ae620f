//! Independent derivatives: differences for any function. Derivatives to round-off by dual numbers are in [`crate::laws`].

/// Jacobian `d f_i / d x_j` (row-major, `outputs` rows) by central differences at two step sizes, extrapolated (error of fourth order in
/// `step`). A step of about `1e-3` times the scale of `x` balances truncation against round-off (both near 1e-11).
pub fn central_difference_jacobian(
    mut f: impl FnMut(&[f64], &mut [f64]),
    x: &[f64],
    step: f64,
    outputs: usize,
) -> Vec<f64> {
    let mut jacobian = vec![0.0; outputs * x.len()];
    let mut at = x.to_vec();
    let (mut plus, mut minus) = (vec![0.0; outputs], vec![0.0; outputs]);
    for j in 0..x.len() {
        for (h, weight) in [(step, -1.0 / 3.0), (0.5 * step, 4.0 / 3.0)] {
            at[j] = x[j] + h;
            f(&at, &mut plus);
            at[j] = x[j] - h;
            f(&at, &mut minus);
            at[j] = x[j];
            for i in 0..outputs {
                jacobian[i * x.len() + j] += weight * (plus[i] - minus[i]) / (2.0 * h);
            }
        }
    }
    jacobian
}

/// Largest difference over the largest magnitude of `expected` (or over `floor` if that is larger).
pub fn max_relative_error(actual: &[f64], expected: &[f64], floor: f64) -> f64 {
    assert_eq!(actual.len(), expected.len(), "lengths differ");
    let scale = expected.iter().fold(floor, |m, x| m.max(x.abs()));
    actual.iter().zip(expected).fold(0.0_f64, |m, (a, b)| {
        let d = (a - b).abs();
        if d.is_nan() { f64::INFINITY } else { m.max(d) }
    }) / scale
}

/// Panics with the worst entry if two Jacobians of `columns` columns differ by more than `tolerance` relative to the largest
/// entry of `expected`.
pub fn assert_jacobian_close(actual: &[f64], expected: &[f64], columns: usize, tolerance: f64, what: &str) {
    let error = max_relative_error(actual, expected, f64::MIN_POSITIVE);
    if error > tolerance {
        let worst = (0..actual.len())
            .max_by(|&a, &b| (actual[a] - expected[a]).abs().total_cmp(&(actual[b] - expected[b]).abs()))
            .unwrap_or(0);
        panic!(
            "{what}: relative error {error:.2e} > {tolerance:.0e}; worst entry ({}, {}): {:e} against {:e}",
            worst / columns,
            worst % columns,
            actual[worst],
            expected[worst]
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `f = (sin x y, exp x / y)`.
    fn f(x: &[f64], out: &mut [f64]) {
        out[0] = (x[0] * x[1]).sin();
        out[1] = x[0].exp() / x[1];
    }

    fn exact(x: f64, y: f64) -> [f64; 4] {
        [y * (x * y).cos(), x * (x * y).cos(), x.exp() / y, -x.exp() / (y * y)]
    }

    #[test]
    fn differences_are_of_fourth_order() {
        let error = |step| {
            let jacobian = central_difference_jacobian(f, &[0.7, 1.3], step, 2);
            max_relative_error(&jacobian, &exact(0.7, 1.3), 0.0)
        };
        assert!(error(1e-3) < 1e-11);
        let order = (error(0.2) / error(0.1)).log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn errors_are_relative_to_the_largest_entry_or_the_floor() {
        assert_eq!(max_relative_error(&[1.0, 4.5], &[1.0, 4.0], 0.0), 0.125);
        assert_eq!(max_relative_error(&[1.0, 4.5], &[1.0, 4.0], 10.0), 0.05);
        assert_eq!(max_relative_error(&[f64::NAN], &[1.0], 0.0), f64::INFINITY);
        assert_eq!(max_relative_error(&[1.0, f64::NAN, 1.0], &[1.0; 3], 0.0), f64::INFINITY);
    }

    #[test]
    #[should_panic(expected = "worst entry (1, 0)")]
    fn a_wrong_entry_is_named() {
        assert_jacobian_close(&[1.0, 2.0, 3.5, 4.0], &[1.0, 2.0, 3.0, 4.0], 2, 1e-3, "test");
    }

    #[test]
    #[should_panic(expected = "relative error inf")]
    fn nan_is_no_derivative() {
        assert_jacobian_close(&[1.0, f64::NAN], &[1.0, 2.0], 2, 1e-3, "test");
    }
}
