//! Sums over slices in a fixed order (left to right), so that the bits do not depend on anything but the data.
//! Not a vector type: the project's global vectors are plain `Vec<f64>`.

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

/// Index of the first entry that is not finite.
pub fn first_non_finite(x: &[f64]) -> Option<usize> {
    x.iter().position(|v| !v.is_finite())
}
