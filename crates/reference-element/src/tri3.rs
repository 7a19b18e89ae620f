//! The linear 3-node triangle on `(0, 0), (1, 0), (0, 1)`: the facet of a tetrahedron.
//!
//! `N_1 = 1 - xi - eta`, `N_2 = xi`, `N_3 = eta`. Tangents are constant, second derivatives vanish. Rules of quadrature are in
//! [`crate::triangle`].

/// Number of nodes.
pub const NODE_COUNT: usize = 3;

/// Natural coordinates `(xi, eta)` of the nodes, counter-clockwise.
pub const VERTICES: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// Shape functions `N_I` at the natural coordinates `xi`.
#[inline]
pub fn shape(xi: [f64; 2]) -> [f64; 3] {
    crate::triangle::shape(xi)
}

/// Gradients `dN_I / d(xi, eta)`, constant: row `I`, column the direction.
#[inline]
pub const fn shape_gradient() -> [[f64; 2]; 3] {
    [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]
}
