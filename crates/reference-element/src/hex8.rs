//! The trilinear 8-node hexahedron on `[-1, 1]^3` (theory/elements#cells).
//!
//! ```text
//!          7-------6
//!         /|      /|        zeta  eta
//!        4-------5 |           | /
//!        | 3-----|-2           |/
//!        |/      |/            +--- xi
//!        0-------1
//! ```
//!
//! `N_I = (1 + xi xi_I)(1 + eta eta_I)(1 + zeta zeta_I) / 8` with the vertex coordinates `(xi_I, eta_I, zeta_I)` of
//! [`VERTICES`].
//!
//! This is not an element: there are no physical coordinates and no integrals here.

/// Number of nodes.
pub const NODE_COUNT: usize = 8;

/// Natural coordinates `(xi, eta, zeta)` of the nodes, in node order. VTK's cell type 12, Gmsh's type 5 and Abaqus' C3D8
/// number the nodes in the same way.
pub const VERTICES: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Local node numbers of the six facets. In each row the nodes follow [`crate::quad4::VERTICES`], and with the facet's tangents
/// `a1`, `a2` the vector `a1 x a2` points out of a positively oriented cell.
///
/// The order of the rows is `zeta = -1`, `zeta = +1`, `eta = -1`, `xi = +1`, `eta = +1`, `xi = -1`, which is that of
/// Abaqus' faces S1 to S6.
pub const FACETS: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Shape functions `N_I` at the natural coordinates `xi`.
#[inline]
pub fn shape(xi: [f64; 3]) -> [f64; 8] {
    std::array::from_fn(|i| {
        let v = VERTICES[i];
        0.125 * (1.0 + xi[0] * v[0]) * (1.0 + xi[1] * v[1]) * (1.0 + xi[2] * v[2])
    })
}

/// Gradients `dN_I / d(xi, eta, zeta)` at the natural coordinates `xi`: row `I`, column the direction.
#[inline]
pub fn shape_gradient(xi: [f64; 3]) -> [[f64; 3]; 8] {
    std::array::from_fn(|i| {
        let v = VERTICES[i];
        let f = [1.0 + xi[0] * v[0], 1.0 + xi[1] * v[1], 1.0 + xi[2] * v[2]];
        [0.125 * v[0] * f[1] * f[2], 0.125 * v[1] * f[0] * f[2], 0.125 * v[2] * f[0] * f[1]]
    })
}
