//! Sums over slices in a fixed order (left to right), so that the bits do not depend on anything but the data.
//! Not a vector type: the project's global vectors are plain `Vec<f64>`.

use std::ops::Range;

/// `x . y`.
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    debug_assert_eq!(x.len(), y.len());
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// `y <- y + a x`.
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    debug_assert_eq!(x.len(), y.len());
    for (yi, xi) in y.iter_mut().zip(x) {
        *yi += a * xi;
    }
}

/// The largest absolute value; NaN if any entry is NaN.
pub fn norm_inf(x: &[f64]) -> f64 {
    let mut m = 0.0;
    for v in x {
        let a = v.abs();
        // `!(a <= m)` lets a NaN in; once in, it stays: every comparison with it is false.
        if a > m || a.is_nan() {
            m = a;
        }
        if m.is_nan() {
            return m;
        }
    }
    m
}

/// The Euclidean norm, scaled so that neither overflow nor underflow spoils it; NaN or infinity if an entry is.
pub fn norm2(x: &[f64]) -> f64 {
    let m = norm_inf(x);
    if m == 0.0 || !m.is_finite() {
        return m;
    }
    if (1e-140..1e140).contains(&m) {
        return dot(x, x).sqrt();
    }
    m * x.iter().map(|v| (v / m) * (v / m)).sum::<f64>().sqrt()
}

/// [`norm2`] of the entries in some ranges: the same bits if all others are zero and the ranges ascend.
pub fn norm2_of(x: &[f64], ranges: &[Range<usize>]) -> f64 {
    let largest = ranges.iter().map(|range| norm_inf(&x[range.clone()]));
    let m = largest.fold(0.0, |m: f64, n| if n > m || n.is_nan() { n } else { m });
    if m == 0.0 || !m.is_finite() {
        return m;
    }
    let scale = if (1e-140..1e140).contains(&m) { 1.0 } else { m };
    let mut sum = 0.0;
    for range in ranges {
        for v in &x[range.clone()] {
            let v = v / scale;
            sum += v * v;
        }
    }
    scale * sum.sqrt()
}

/// Entry `i` of a fixed vector of pseudo-random numbers in [-1, 1): a hash of the index. (Equal entries may cancel exactly against a rigid motion.)
pub(crate) fn pseudo_random(i: usize) -> f64 {
    let mut h = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (h >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Index of the first entry that is not finite.
pub fn first_non_finite(x: &[f64]) -> Option<usize> {
    x.iter().position(|v| !v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_norm_over_what_is_not_zero_has_the_same_bits() {
        for scale in [1.0, 1e200, 1e-200] {
            let mut x: Vec<f64> = (0..40).map(|i| scale * (0.3 * f64::from(i)).sin()).collect();
            x[5..11].fill(0.0);
            x[30..].fill(0.0);
            assert_eq!(norm2(&x).to_bits(), norm2_of(&x, &[0..5, 11..30]).to_bits());
        }
        assert_eq!(norm2_of(&[0.0; 3], std::slice::from_ref(&(0..3))), 0.0);
        assert_eq!(norm2_of(&[3.0, 9.0, 4.0], &[0..1, 2..3]), 5.0);
        assert!(norm2_of(&[1.0, f64::NAN], &[0..1, 1..2]).is_nan());
    }
}
