//! A cell that Stoss does not have, see docs/how-to-add/element.md: the tetrahedron with a bubble at its centre (MINI), as a table and nothing else.

use stoss_reference_element::{
    CellKind, CellTable, Face, FaceKind, Family, Integration, Shape, ShapeGradient, quadrature,
};

static TET5: CellTable = CellTable {
    name: "tet5",
    family: Family::Tetrahedron,
    nodes: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.25; 3]],
    corners: 4,
    edges: &[],
    faces: &[
        Face { kind: FaceKind::Tri3, nodes: &[0, 2, 1] },
        Face { kind: FaceKind::Tri3, nodes: &[0, 1, 3] },
        Face { kind: FaceKind::Tri3, nodes: &[1, 2, 3] },
        Face { kind: FaceKind::Tri3, nodes: &[2, 0, 3] },
    ],
    linear: CellKind::Tet4,
    rules: &[(Integration::Full, &quadrature::TET_14)],
    mass: &quadrature::TET_14,
    shape,
    shape_gradient,
    vtk: 10,
    gmsh: 4,
    from_gmsh: &[0, 1, 2, 3, 4],
    abaqus: &[],
    from_abaqus: &[0, 1, 2, 3, 4],
};

const SLOPES: [[f64; 3]; 4] = [[-1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn barycentric(xi: [f64; 3]) -> [f64; 4] {
    [1.0 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]]
}

/// `L_a - 64 L_0 L_1 L_2 L_3` at the corners, `256 L_0 L_1 L_2 L_3` at the centre.
fn shape(xi: [f64; 3]) -> Shape {
    let l = barycentric(xi);
    let bubble: f64 = l.iter().product();
    let mut out = [0.0; stoss_reference_element::MAX_CELL_NODES];
    (0..4).for_each(|a| out[a] = l[a] - 64.0 * bubble);
    out[4] = 256.0 * bubble;
    out
}

fn shape_gradient(xi: [f64; 3]) -> ShapeGradient {
    let l = barycentric(xi);
    let without = |a: usize| (0..4).filter(|&b| b != a).map(|b| l[b]).product::<f64>();
    let bubble: [f64; 3] = std::array::from_fn(|d| (0..4).map(|a| without(a) * SLOPES[a][d]).sum());
    let mut out = [[0.0; 3]; stoss_reference_element::MAX_CELL_NODES];
    (0..4).for_each(|a| out[a] = std::array::from_fn(|d| SLOPES[a][d] - 64.0 * bubble[d]));
    out[4] = bubble.map(|b| 256.0 * b);
    out
}

#[test]
fn a_table_is_all_that_a_cell_needs_here() {
    for (i, &node) in TET5.nodes.iter().enumerate() {
        let n = (TET5.shape)(node);
        assert!((0..5).all(|j| (n[j] - f64::from(u8::from(i == j))).abs() < 1e-14));
    }
    let (xi, h) = ([0.2, 0.3, 0.1], 1e-5);
    let (n, dn) = ((TET5.shape)(xi), (TET5.shape_gradient)(xi));
    assert!((n.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    for d in 0..3 {
        let at = |s: f64| (TET5.shape)(std::array::from_fn(|k| xi[k] + if k == d { s } else { 0.0 }));
        let (plus, minus) = (at(h), at(-h));
        assert!((0..5).all(|i| ((plus[i] - minus[i]) / (2.0 * h) - dn[i][d]).abs() < 1e-8));
    }
}
