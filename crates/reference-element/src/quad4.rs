//! The bilinear 4-node quadrilateral on `[-1, 1]^2`: the facet of [`crate::hex8`].
//!
//! `N_I = (1 + xi xi_I)(1 + eta eta_I) / 4`. The tangents of a facet with nodes `x_I` are `a1 = sum_I N_I,1 x_I` and
//! `a2 = sum_I N_I,2 x_I`; the only second derivative that does not vanish is the mixed one, a constant.
//!
//! This is not a surface in space: closest points, normals and curvature are in `stoss-geometry`.

/// Number of nodes.
pub const NODE_COUNT: usize = 4;

/// Natural coordinates `(xi, eta)` of the nodes, counter-clockwise.
pub const VERTICES: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Shape functions `N_I` at the natural coordinates `xi`.
#[inline]
pub fn shape(xi: [f64; 2]) -> [f64; 4] {
    let (a, b) = (0.25 * (1.0 - xi[0]), 0.25 * (1.0 + xi[0]));
    let (c, d) = (1.0 - xi[1], 1.0 + xi[1]);
    [a * c, b * c, b * d, a * d]
}

/// Gradients `dN_I / d(xi, eta)` at the natural coordinates `xi`: row `I`, column the direction.
#[inline]
pub fn shape_gradient(xi: [f64; 2]) -> [[f64; 2]; 4] {
    let (a, b) = (0.25 * (1.0 - xi[0]), 0.25 * (1.0 + xi[0]));
    let (c, d) = (0.25 * (1.0 - xi[1]), 0.25 * (1.0 + xi[1]));
    [[-c, -a], [c, -b], [d, b], [-d, a]]
}

/// The mixed second derivatives `N_I,12`, constant over the cell.
#[inline]
pub const fn mixed_derivative() -> [f64; 4] {
    [0.25, -0.25, 0.25, -0.25]
}
