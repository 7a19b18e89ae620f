//! Hexahedra on `[-1, 1]^3`: hex8 ([`crate::hex8`]), the serendipity hex20, the triquadratic hex27.
//!
//! ```text
//!          7----14----6
//!        15|        13|       zeta  eta
//!        4----12----5 |          | /
//!        | 19       | 18         |/
//!       16 3----10-17-2          +--- xi
//!        |11        |9
//!        0-----8----1
//! ```
//! hex27 adds the centres of the faces -xi, +xi, -eta, +eta, -zeta, +zeta (20 to 25) and of the cell (26).

use super::{gradient, shape};
use crate::line::line;
use crate::table::{CellKind, CellTable, Face, Family, Integration};
use crate::{FaceKind, hex8, quadrature};

const EDGES: [[u8; 3]; 12] = [
    [0, 1, 8],
    [1, 2, 9],
    [2, 3, 10],
    [3, 0, 11],
    [4, 5, 12],
    [5, 6, 13],
    [6, 7, 14],
    [7, 4, 15],
    [0, 4, 16],
    [1, 5, 17],
    [2, 6, 18],
    [3, 7, 19],
];

/// Vertices, middles of the edges, centres of the faces and of the cell.
const NODES: [[f64; 3]; 27] = {
    let mut nodes = [[0.0; 3]; 27];
    let mut i = 0;
    while i < 8 {
        nodes[i] = hex8::VERTICES[i];
        i += 1;
    }
    while i < 20 {
        let [a, b, _] = EDGES[i - 8];
        let (a, b) = (hex8::VERTICES[a as usize], hex8::VERTICES[b as usize]);
        nodes[i] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])];
        i += 1;
    }
    while i < 26 {
        nodes[i][(i - 20) / 2] = if i % 2 == 0 { -1.0 } else { 1.0 };
        i += 1;
    }
    nodes
};

const fn nodes<const N: usize>() -> [[f64; 3]; N] {
    let mut out = [[0.0; 3]; N];
    let mut i = 0;
    while i < N {
        out[i] = NODES[i];
        i += 1;
    }
    out
}

pub(crate) static HEX8: CellTable = CellTable {
    name: "hex8",
    about: "Trilinear hexahedra with 8 nodes.",
    family: Family::Hexahedron,
    nodes: &hex8::VERTICES,
    corners: 8,
    edges: &[],
    faces: &[
        Face { kind: FaceKind::Quad4, nodes: &[0, 3, 2, 1] },
        Face { kind: FaceKind::Quad4, nodes: &[4, 5, 6, 7] },
        Face { kind: FaceKind::Quad4, nodes: &[0, 1, 5, 4] },
        Face { kind: FaceKind::Quad4, nodes: &[1, 2, 6, 5] },
        Face { kind: FaceKind::Quad4, nodes: &[2, 3, 7, 6] },
        Face { kind: FaceKind::Quad4, nodes: &[3, 0, 4, 7] },
    ],
    linear: CellKind::Hex8,
    rules: &[(Integration::Full, &quadrature::GAUSS_HEX_2)],
    mass: &quadrature::GAUSS_HEX_2,
    shape: |xi| shape(hex8::shape(xi)),
    shape_gradient: |xi| gradient(hex8::shape_gradient(xi)),
    vtk: 12,
    gmsh: 5,
    from_gmsh: &[0, 1, 2, 3, 4, 5, 6, 7],
    abaqus: &["C3D8", "C3D8R", "C3D8I", "C3D8H", "C3D8RH", "C3D8IH"],
    from_abaqus: &[0, 1, 2, 3, 4, 5, 6, 7],
};

pub(crate) static HEX20: CellTable = CellTable {
    name: "hex20",
    about: "Quadratic (serendipity) hexahedra with 20 nodes: corners and edges.",
    family: Family::Hexahedron,
    nodes: &nodes::<20>(),
    corners: 8,
    edges: &EDGES,
    faces: &[
        Face { kind: FaceKind::Quad8, nodes: &[0, 3, 2, 1, 11, 10, 9, 8] },
        Face { kind: FaceKind::Quad8, nodes: &[4, 5, 6, 7, 12, 13, 14, 15] },
        Face { kind: FaceKind::Quad8, nodes: &[0, 1, 5, 4, 8, 17, 12, 16] },
        Face { kind: FaceKind::Quad8, nodes: &[1, 2, 6, 5, 9, 18, 13, 17] },
        Face { kind: FaceKind::Quad8, nodes: &[2, 3, 7, 6, 10, 19, 14, 18] },
        Face { kind: FaceKind::Quad8, nodes: &[3, 0, 4, 7, 11, 16, 15, 19] },
    ],
    linear: CellKind::Hex8,
    rules: &[(Integration::Full, &quadrature::GAUSS_HEX_3), (Integration::Reduced, &quadrature::GAUSS_HEX_2)],
    mass: &quadrature::GAUSS_HEX_3,
    shape: |xi| shape(serendipity(xi).map(|(n, _)| n)),
    shape_gradient: |xi| gradient(serendipity(xi).map(|(_, dn)| dn)),
    vtk: 25,
    gmsh: 17,
    from_gmsh: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    abaqus: &["C3D20", "C3D20R", "C3D20H", "C3D20RH"],
    from_abaqus: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19],
};

pub(crate) static HEX27: CellTable = CellTable {
    name: "hex27",
    about: "Triquadratic hexahedra with 27 nodes: corners, edges, faces and centre.",
    family: Family::Hexahedron,
    nodes: &nodes::<27>(),
    corners: 8,
    edges: &EDGES,
    faces: &[
        Face { kind: FaceKind::Quad9, nodes: &[0, 3, 2, 1, 11, 10, 9, 8, 24] },
        Face { kind: FaceKind::Quad9, nodes: &[4, 5, 6, 7, 12, 13, 14, 15, 25] },
        Face { kind: FaceKind::Quad9, nodes: &[0, 1, 5, 4, 8, 17, 12, 16, 22] },
        Face { kind: FaceKind::Quad9, nodes: &[1, 2, 6, 5, 9, 18, 13, 17, 21] },
        Face { kind: FaceKind::Quad9, nodes: &[2, 3, 7, 6, 10, 19, 14, 18, 23] },
        Face { kind: FaceKind::Quad9, nodes: &[3, 0, 4, 7, 11, 16, 15, 19, 20] },
    ],
    linear: CellKind::Hex8,
    rules: &[(Integration::Full, &quadrature::GAUSS_HEX_3)],
    mass: &quadrature::GAUSS_HEX_3,
    shape: |xi| triquadratic(xi).map(|(n, _)| n),
    shape_gradient: |xi| triquadratic(xi).map(|(_, dn)| dn),
    vtk: 29,
    gmsh: 12,
    from_gmsh: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26],
    abaqus: &["C3D27", "C3D27H", "C3D27R", "C3D27RH"],
    from_abaqus: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 26, 24, 23, 25, 21, 22, 20],
};

/// Functions and gradients of hex20: at a vertex `(1 + x)(1 + y)(1 + z)(x + y + z - 2) / 8` with `x = xi xi_I` and so on, in the middle of
/// an edge `(1 - xi^2)(1 + y)(1 + z) / 4`.
fn serendipity(xi: [f64; 3]) -> [(f64, [f64; 3]); 20] {
    std::array::from_fn(|i| {
        let v = NODES[i];
        let p: [f64; 3] = std::array::from_fn(|a| 1.0 + xi[a] * v[a]);
        match (0..3).find(|&a| v[a] == 0.0) {
            None => {
                let last = p[0] + p[1] + p[2] - 5.0;
                let dn = std::array::from_fn(|a| {
                    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                    0.125 * v[a] * p[b] * p[c] * (last + p[a])
                });
                (0.125 * p[0] * p[1] * p[2] * last, dn)
            }
            Some(along) => {
                let (b, c) = ((along + 1) % 3, (along + 2) % 3);
                let bubble = 1.0 - xi[along] * xi[along];
                let mut dn = [0.0; 3];
                dn[along] = -0.5 * xi[along] * p[b] * p[c];
                dn[b] = 0.25 * bubble * v[b] * p[c];
                dn[c] = 0.25 * bubble * v[c] * p[b];
                (0.25 * bubble * p[b] * p[c], dn)
            }
        }
    })
}

/// Functions and gradients of hex27: products of the quadratic functions of the line.
fn triquadratic(xi: [f64; 3]) -> [(f64, [f64; 3]); 27] {
    let lines = xi.map(line);
    std::array::from_fn(|i| {
        let f: [[f64; 2]; 3] = std::array::from_fn(|a| {
            let place = NODES[i][a];
            lines[a][if place < 0.0 {
                0
            } else if place > 0.0 {
                1
            } else {
                2
            }]
        });
        let dn = [f[0][1] * f[1][0] * f[2][0], f[0][0] * f[1][1] * f[2][0], f[0][0] * f[1][0] * f[2][1]];
        (f[0][0] * f[1][0] * f[2][0], dn)
    })
}
