//! Tetrahedra on the corners `(0,0,0), (1,0,0), (0,1,0), (0,0,1)`: tet4 and the quadratic tet10.
//!
//! With `L_0 = 1 - xi - eta - zeta` and `L_1 .. L_3 = xi, eta, zeta` the functions of tet4 are the `L_a`; those of tet10 are `L_a (2 L_a - 1)`
//! at the corners and `4 L_a L_b` in the middles of the edges `01 12 20 03 13 23` (4 to 9).

use super::{gradient, shape};
use crate::table::{CellKind, CellTable, Face, Family, Integration};
use crate::{FaceKind, quadrature};

const EDGES: [[u8; 3]; 6] = [[0, 1, 4], [1, 2, 5], [2, 0, 6], [0, 3, 7], [1, 3, 8], [2, 3, 9]];

const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Gradients of the `L_a`.
const SLOPES: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

const NODES: [[f64; 3]; 10] = {
    let mut nodes = [[0.0; 3]; 10];
    let mut i = 0;
    while i < 4 {
        nodes[i] = CORNERS[i];
        i += 1;
    }
    while i < 10 {
        let [a, b, _] = EDGES[i - 4];
        let (a, b) = (CORNERS[a as usize], CORNERS[b as usize]);
        nodes[i] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])];
        i += 1;
    }
    nodes
};

pub(crate) static TET4: CellTable = CellTable {
    name: "tet4",
    about: "Linear tetrahedra with 4 nodes. They lock in bending and with nearly incompressible materials.",
    family: Family::Tetrahedron,
    nodes: &CORNERS,
    corners: 4,
    edges: &[],
    faces: &[
        Face { kind: FaceKind::Tri3, nodes: &[0, 2, 1] },
        Face { kind: FaceKind::Tri3, nodes: &[0, 1, 3] },
        Face { kind: FaceKind::Tri3, nodes: &[1, 2, 3] },
        Face { kind: FaceKind::Tri3, nodes: &[2, 0, 3] },
    ],
    linear: CellKind::Tet4,
    rules: &[(Integration::Full, &quadrature::TET_1)],
    mass: &quadrature::TET_4,
    shape: |xi| shape(barycentric(xi)),
    shape_gradient: |_| gradient(SLOPES),
    vtk: 10,
    gmsh: 4,
    from_gmsh: &[0, 1, 2, 3],
    abaqus: &["C3D4", "C3D4H"],
    from_abaqus: &[0, 1, 2, 3],
};

pub(crate) static TET10: CellTable = CellTable {
    name: "tet10",
    about: "Quadratic tetrahedra with 10 nodes.",
    family: Family::Tetrahedron,
    nodes: &NODES,
    corners: 4,
    edges: &EDGES,
    faces: &[
        Face { kind: FaceKind::Tri6, nodes: &[0, 2, 1, 6, 5, 4] },
        Face { kind: FaceKind::Tri6, nodes: &[0, 1, 3, 4, 8, 7] },
        Face { kind: FaceKind::Tri6, nodes: &[1, 2, 3, 5, 9, 8] },
        Face { kind: FaceKind::Tri6, nodes: &[2, 0, 3, 6, 7, 9] },
    ],
    linear: CellKind::Tet4,
    rules: &[(Integration::Full, &quadrature::TET_8), (Integration::Reduced, &quadrature::TET_4)],
    mass: &quadrature::TET_14,
    shape: |xi| shape(quadratic(xi).map(|(n, _)| n)),
    shape_gradient: |xi| gradient(quadratic(xi).map(|(_, dn)| dn)),
    vtk: 24,
    gmsh: 11,
    from_gmsh: &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    abaqus: &["C3D10", "C3D10M", "C3D10H", "C3D10I", "C3D10MH", "C3D10HS", "C3D10R"],
    from_abaqus: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9],
};

fn barycentric(xi: [f64; 3]) -> [f64; 4] {
    [1.0 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]]
}

fn quadratic(xi: [f64; 3]) -> [(f64, [f64; 3]); 10] {
    let l = barycentric(xi);
    std::array::from_fn(|i| match i.checked_sub(4) {
        None => (l[i] * (2.0 * l[i] - 1.0), SLOPES[i].map(|s| (4.0 * l[i] - 1.0) * s)),
        Some(edge) => {
            let [a, b, _] = EDGES[edge].map(usize::from);
            (4.0 * l[a] * l[b], std::array::from_fn(|d| 4.0 * (l[a] * SLOPES[b][d] + l[b] * SLOPES[a][d])))
        }
    })
}
