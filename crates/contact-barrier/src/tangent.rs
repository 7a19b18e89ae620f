//! The second derivative of a pair.

/// Derivative of a pair's gradient: row `3 i + k` is component `k` of point `i`, column `3 j + l` component `l` of point `j`.
pub type Tangent = [[f64; 12]; 12];
