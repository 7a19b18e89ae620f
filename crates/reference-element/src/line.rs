//! Functions of the line, of which the biquadratic and triquadratic ones are products.

/// The quadratic functions of the line at -1, +1 and 0: values and derivatives.
pub(crate) fn line(x: f64) -> [[f64; 2]; 3] {
    [[0.5 * x * (x - 1.0), x - 0.5], [0.5 * x * (x + 1.0), x + 0.5], [1.0 - x * x, -2.0 * x]]
}
