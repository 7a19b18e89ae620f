//! Sign changes of a polynomial of degree at most five on an interval.

/// Evaluates `sum_k c_k t^k`.
fn horner(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |value, c| value * t + c)
}

/// Places in `[-1, 1]` where the quintic `sum_k c_k t^k` changes its sign; returns how many entries of `roots` were filled.
///
/// Between two neighbouring extrema a polynomial is monotonic, and the extrema are sign changes of the derivative: the
/// derivatives are worked off from degree one upwards, with bisection on every monotonic piece. A root without a sign change (of even
/// multiplicity) is not reported; for a derivative it belongs to no minimum.
pub(crate) fn sign_changes_of_quintic(coefficients: &[f64; 6], roots: &mut [f64; 5]) -> usize {
    // derivatives[k] holds the k-th derivative, of degree 5 - k.
    let mut derivatives = [[0.0; 6]; 5];
    derivatives[0] = *coefficients;
    for k in 1..5 {
        for j in 0..6 - k {
            derivatives[k][j] = derivatives[k - 1][j + 1] * (j + 1) as f64;
        }
    }
    let mut extrema = [0.0; 5];
    let mut count = 0;
    for k in (0..5).rev() {
        let polynomial = &derivatives[k][..6 - k];
        let mut found = 0;
        let mut left = -1.0;
        let mut left_value = horner(polynomial, left);
        for piece in 0..=count {
            let right = if piece < count { extrema[piece] } else { 1.0 };
            let right_value = horner(polynomial, right);
            if (left_value < 0.0) != (right_value < 0.0) {
                roots[found] = bisect(polynomial, left, right, left_value < 0.0);
                found += 1;
            }
            (left, left_value) = (right, right_value);
        }
        extrema = *roots;
        count = found;
    }
    count
}

/// Newton inside a bracket, bisection where it leaves it.
fn bisect(polynomial: &[f64], mut left: f64, mut right: f64, left_negative: bool) -> f64 {
    let mut t = 0.5 * (left + right);
    for _ in 0..80 {
        let (mut value, mut slope) = (0.0, 0.0);
        for &c in polynomial.iter().rev() {
            slope = slope * t + value;
            value = value * t + c;
        }
        if (value < 0.0) == left_negative {
            left = t;
        } else {
            right = t;
        }
        let newton = t - value / slope;
        let next = if newton >= left && newton <= right { newton } else { 0.5 * (left + right) };
        if (next - t).abs() <= 2.0 * f64::EPSILON || right - left <= 2.0 * f64::EPSILON {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn expand(zeros: &[f64; 5]) -> [f64; 6] {
        let mut c = [0.0; 6];
        c[0] = 1.0;
        for (degree, z) in zeros.iter().enumerate() {
            for k in (0..=degree + 1).rev() {
                c[k] = if k > 0 { c[k - 1] } else { 0.0 } - z * c[k];
            }
        }
        c
    }

    proptest! {
        #[test]
        fn finds_well_separated_roots(start in -1.6f64..0.0, gaps in proptest::array::uniform4(0.12f64..0.6)) {
            let mut zeros = [start; 5];
            for k in 0..4 {
                zeros[k + 1] = zeros[k] + gaps[k];
            }
            prop_assume!(zeros.iter().all(|z| (z.abs() - 1.0).abs() > 1e-6));
            let mut roots = [0.0; 5];
            let count = sign_changes_of_quintic(&expand(&zeros), &mut roots);
            let inside: Vec<f64> = zeros.into_iter().filter(|z| z.abs() < 1.0).collect();
            prop_assert_eq!(count, inside.len());
            for (r, z) in roots.iter().zip(&inside) {
                prop_assert!((r - z).abs() < 1e-10, "{} {}", r, z);
            }
        }
    }

    #[test]
    fn double_roots_and_zero_are_no_sign_changes() {
        let mut roots = [0.0; 5];
        // (t - 1/4)^2 (t^2 + 1) in exact binary fractions
        assert_eq!(sign_changes_of_quintic(&[0.0625, -0.5, 1.0625, -0.5, 1.0, 0.0], &mut roots), 0);
        assert_eq!(sign_changes_of_quintic(&[0.0; 6], &mut roots), 0);
        assert_eq!(sign_changes_of_quintic(&[-0.5, 1.0, 0.0, 0.0, 0.0, 0.0], &mut roots), 1);
        assert_eq!(roots[0], 0.5);
    }
}
