//! Wedges, a triangle `(0,0), (1,0), (0,1)` times `[-1, 1]`: wedge6 and the serendipity wedge15.
//!
//! Nodes 0, 1, 2 are at `zeta = -1`, nodes 3, 4, 5 above them. wedge15 adds the middles of the edges `01 12 20 34 45 53 03 14 25` (6 to 14).
//! With `L_0 = 1 - xi - eta`, `L_1 = xi`, `L_2 = eta` and `z = zeta zeta_I` its functions are
//! `L (1 + z)(2 L + z - 2) / 2` at the corners, `2 L_a L_b (1 + z)` on the edges of the triangles and `L (1 - zeta^2)` on the others.

use super::{gradient, shape};
use crate::table::{CellKind, CellTable, Face, Family, Integration};
use crate::{FaceKind, quadrature};

const EDGES: [[u8; 3]; 9] =
    [[0, 1, 6], [1, 2, 7], [2, 0, 8], [3, 4, 9], [4, 5, 10], [5, 3, 11], [0, 3, 12], [1, 4, 13], [2, 5, 14]];

const CORNERS: [[f64; 3]; 6] =
    [[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];

/// Gradients of the `L_a` in the plane of the triangle.
const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

const NODES: [[f64; 3]; 15] = {
    let mut nodes = [[0.0; 3]; 15];
    let mut i = 0;
    while i < 6 {
        nodes[i] = CORNERS[i];
        i += 1;
    }
    while i < 15 {
        let [a, b, _] = EDGES[i - 6];
        let (a, b) = (CORNERS[a as usize], CORNERS[b as usize]);
        nodes[i] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])];
        i += 1;
    }
    nodes
};

pub(crate) static WEDGE6: CellTable = CellTable {
    name: "wedge6",
    about: "Linear wedges with 6 nodes.",
    family: Family::Wedge,
    nodes: &CORNERS,
    corners: 6,
    edges: &[],
    faces: &[
        Face { kind: FaceKind::Tri3, nodes: &[0, 2, 1] },
        Face { kind: FaceKind::Tri3, nodes: &[3, 4, 5] },
        Face { kind: FaceKind::Quad4, nodes: &[0, 1, 4, 3] },
        Face { kind: FaceKind::Quad4, nodes: &[1, 2, 5, 4] },
        Face { kind: FaceKind::Quad4, nodes: &[2, 0, 3, 5] },
    ],
    linear: CellKind::Wedge6,
    rules: &[(Integration::Full, &quadrature::WEDGE_6)],
    mass: &quadrature::WEDGE_6,
    shape: |xi| shape(linear(xi).map(|(n, _)| n)),
    shape_gradient: |xi| gradient(linear(xi).map(|(_, dn)| dn)),
    vtk: 13,
    gmsh: 6,
    from_gmsh: &[0, 1, 2, 3, 4, 5],
    abaqus: &["C3D6", "C3D6H"],
    from_abaqus: &[0, 1, 2, 3, 4, 5],
};

pub(crate) static WEDGE15: CellTable = CellTable {
    name: "wedge15",
    about: "Quadratic wedges with 15 nodes.",
    family: Family::Wedge,
    nodes: &NODES,
    corners: 6,
    edges: &EDGES,
    faces: &[
        Face { kind: FaceKind::Tri6, nodes: &[0, 2, 1, 8, 7, 6] },
        Face { kind: FaceKind::Tri6, nodes: &[3, 4, 5, 9, 10, 11] },
        Face { kind: FaceKind::Quad8, nodes: &[0, 1, 4, 3, 6, 13, 9, 12] },
        Face { kind: FaceKind::Quad8, nodes: &[1, 2, 5, 4, 7, 14, 10, 13] },
        Face { kind: FaceKind::Quad8, nodes: &[2, 0, 3, 5, 8, 12, 11, 14] },
    ],
    linear: CellKind::Wedge6,
    rules: &[(Integration::Full, &quadrature::WEDGE_21)],
    mass: &quadrature::WEDGE_21,
    shape: |xi| shape(quadratic(xi).map(|(n, _)| n)),
    shape_gradient: |xi| gradient(quadratic(xi).map(|(_, dn)| dn)),
    vtk: 26,
    gmsh: 18,
    from_gmsh: &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11],
    abaqus: &["C3D15", "C3D15H"],
    from_abaqus: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14],
};

fn linear(xi: [f64; 3]) -> [(f64, [f64; 3]); 6] {
    let l = crate::triangle::shape([xi[0], xi[1]]);
    std::array::from_fn(|i| {
        let (a, v) = (i % 3, CORNERS[i][2]);
        let p = 1.0 + v * xi[2];
        (0.5 * l[a] * p, [0.5 * SLOPES[a][0] * p, 0.5 * SLOPES[a][1] * p, 0.5 * v * l[a]])
    })
}

fn quadratic(xi: [f64; 3]) -> [(f64, [f64; 3]); 15] {
    let l = crate::triangle::shape([xi[0], xi[1]]);
    let z = xi[2];
    std::array::from_fn(|i| match i {
        0..6 => {
            let (a, v) = (i % 3, CORNERS[i][2]);
            let (p, q) = (1.0 + v * z, 2.0 * l[a] + v * z - 2.0);
            let in_plane = 0.5 * p * (q + 2.0 * l[a]);
            let n = 0.5 * l[a] * p * q;
            (n, [SLOPES[a][0] * in_plane, SLOPES[a][1] * in_plane, 0.5 * l[a] * v * (q + p)])
        }
        6..12 => {
            let [a, b, _] = EDGES[i - 6].map(|node| usize::from(node) % 3);
            let v = NODES[i][2];
            let p = 2.0 * (1.0 + v * z);
            let slope = |d: usize| p * (l[a] * SLOPES[b][d] + l[b] * SLOPES[a][d]);
            (l[a] * l[b] * p, [slope(0), slope(1), 2.0 * l[a] * l[b] * v])
        }
        _ => {
            let a = i - 12;
            let bubble = 1.0 - z * z;
            (l[a] * bubble, [SLOPES[a][0] * bubble, SLOPES[a][1] * bubble, -2.0 * z * l[a]])
        }
    })
}
