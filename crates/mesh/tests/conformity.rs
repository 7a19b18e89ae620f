//! Facets that lie on each other without being the same.

use proptest::prelude::*;
use stoss_mesh::generate::Block;
use stoss_mesh::{Elements, Mesh, MeshError, Rotation};
use stoss_reference_element::CellKind;

/// A block from `x = low` with these divisions and cells, two high and two wide.
fn block(low: f64, high: f64, divisions: [usize; 3], kind: CellKind) -> Mesh {
    let mesh = Block::new([low, 0.0, 0.0], [high, 2.0, 2.0], divisions).generate().unwrap();
    mesh.with_cells(kind).unwrap()
}

/// Both meshes in one; of nodes at the same place one remains, where `merges` says so.
fn join(a: &Mesh, b: &Mesh, merges: impl Fn([f64; 3]) -> bool) -> Mesh {
    let mut nodes = a.nodes.clone();
    let same = |x: [f64; 3], y: [f64; 3]| (0..3).all(|i| (x[i] - y[i]).abs() < 1e-12);
    let new: Vec<u32> = b
        .nodes
        .iter()
        .map(|&x| match a.nodes.iter().position(|&y| merges(x) && same(x, y)) {
            Some(n) => n as u32,
            None => {
                nodes.push(x);
                nodes.len() as u32 - 1
            }
        })
        .collect();
    let mut elements = a.elements.clone();
    elements.extend(&b.elements, |n| new[n as usize]);
    let mut mesh = a.clone();
    (mesh.nodes, mesh.elements) = (nodes, elements);
    (mesh.node_sets, mesh.facet_sets, mesh.element_sets) = Default::default();
    mesh
}

fn non_conforming(mesh: &Mesh) -> Option<([u32; 2], [f64; 3], usize)> {
    match mesh.check_allowing_coincident() {
        Ok(()) => None,
        Err(MeshError::NonConformingFacet { elements, centre, count, .. }) => Some((elements, centre, count)),
        Err(other) => panic!("{other}"),
    }
}

/// One element beside four (or eight triangles beside two): the nodes in the middle hang, and nothing holds them.
#[test]
fn hanging_nodes_are_refused() {
    use CellKind::{Hex8, Hex20, Hex27, Tet4, Tet10, Wedge6, Wedge15};
    for kind in [Hex8, Hex20, Hex27, Tet4, Tet10, Wedge6, Wedge15] {
        let coarse = block(-2.0, 0.0, [1, 1, 1], kind);
        let fine = block(0.0, 2.0, [2, 2, 2], kind);
        let mesh = join(&coarse, &fine, |_| true);
        let (elements, centre, count) = non_conforming(&mesh).unwrap_or_else(|| panic!("{kind:?}"));
        assert!((elements[0] as usize) < coarse.elements.len() && (elements[1] as usize) >= coarse.elements.len());
        assert!(centre[0].abs() < 1e-15 && (0.5..1.5).contains(&centre[1]), "{centre:?}");
        let facets = if matches!(kind, Tet4 | Tet10) { 2 } else { 1 };
        assert_eq!(count, facets, "{kind:?}");
        // the same divisions on both sides fit
        let same = join(&block(-2.0, 0.0, [1, 2, 2], kind), &block(0.0, 2.0, [2, 2, 2], kind), |_| true);
        assert_eq!(same.check(), Ok(()));
    }
}

/// Linear elements on all nodes of a quadratic facet: no node hangs, yet the displacements differ between the nodes.
#[test]
fn linear_elements_on_a_quadratic_facet_are_refused() {
    use CellKind::{Hex8, Hex20, Hex27, Tet4, Tet10};
    for (quadratic, linear) in [(Hex20, Hex8), (Hex27, Hex8), (Tet10, Tet4)] {
        let mesh = join(&block(-2.0, 0.0, [1, 1, 1], quadratic), &block(0.0, 2.0, [2, 2, 2], linear), |_| true);
        let (elements, ..) = non_conforming(&mesh).unwrap_or_else(|| panic!("{quadratic:?}"));
        let kinds = elements.map(|e| mesh.elements.kind(e as usize));
        assert_eq!(kinds, [quadratic, linear]);
    }
}

/// Two tetrahedra on each side of a square, divided along one diagonal on one side and along the other on the other.
#[test]
fn crossing_diagonals_are_refused() {
    let nodes =
        vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.5, 0.5], [-1.0, 0.5, 0.5]];
    let right: [[u32; 4]; 2] = [[0, 1, 2, 4], [0, 2, 3, 4]];
    let along: [[u32; 4]; 2] = [[0, 2, 1, 5], [0, 3, 2, 5]];
    let across: [[u32; 4]; 2] = [[0, 3, 1, 5], [1, 3, 2, 5]];
    let mesh = |left: [[u32; 4]; 2]| {
        let mut mesh =
            Mesh::new(nodes.clone(), Elements::of_kind(CellKind::Tet4, right.as_flattened().to_vec())).unwrap();
        left.iter().for_each(|tetrahedron| mesh.elements.push(CellKind::Tet4, tetrahedron));
        mesh
    };
    assert_eq!(non_conforming(&mesh(along)), None);
    assert_eq!(non_conforming(&mesh(across)).unwrap().2, 4);
}

/// Two meshes of the same interface that have only some of their nodes there in common.
#[test]
fn parts_that_do_not_fit_are_refused() {
    use CellKind::{Hex8, Hex20, Tet4, Wedge6};
    for kind in [Hex8, Hex20, Tet4, Wedge6] {
        for (n, m) in [(2, 3), (3, 4), (6, 8), (7, 10), (40, 41)] {
            let mesh = join(&block(-2.0, 0.0, [1, n, n], kind), &block(0.0, 2.0, [1, m, m], kind), |_| true);
            assert!(non_conforming(&mesh).is_some(), "{kind:?} {n} {m}");
        }
    }
    // a corner that was not merged
    let mesh = join(&block(-2.0, 0.0, [1, 1, 1], Hex8), &block(0.0, 2.0, [2, 2, 2], Hex8), |x| x[1] + x[2] < 3.0);
    assert!(non_conforming(&mesh).is_some());
    // divisions that agree in the half that is joined only
    let mesh = join(&block(-2.0, 0.0, [1, 2, 2], Hex8), &block(0.0, 2.0, [1, 2, 4], Hex8), |x| x[2] == 0.0);
    assert!(non_conforming(&mesh).is_some());
}

/// The faces of a crack have the nodes of its front in common, and pairs of nodes elsewhere; it may be open.
#[test]
fn cracks_are_accepted() {
    for opening in [0.0, 1e-6, 1e-3, 0.01, 0.1, 0.5] {
        for kind in [CellKind::Hex8, CellKind::Tet4, CellKind::Hex20] {
            // as mirror images, so that the diagonals of tetrahedra agree
            let left = block(-2.0, 0.0, [2, 2, 2], kind);
            let mut right = left.clone();
            right.nodes.iter_mut().for_each(|x| x[0] = -x[0]);
            if kind == CellKind::Tet4 {
                let mut elements = Elements::new();
                right.elements.iter().for_each(|n| elements.push(kind, &[n[0], n[2], n[1], n[3]]));
                right.elements = elements;
            } else {
                right = block(0.0, 2.0, [2, 2, 2], kind);
            }
            let mut mesh = join(&left, &right, |x| x[2] <= 1.0);
            for x in &mut mesh.nodes[left.nodes.len()..] {
                x[0] += opening * (x[2] - 1.0).max(0.0) * (2.0 - x[0]) / 2.0;
            }
            assert_eq!(non_conforming(&mesh), None, "{kind:?} {opening}");
        }
    }
}

/// Facets of one sharp edge have opposite normals and nothing between them but the element itself.
#[test]
fn sharp_edges_are_accepted() {
    for height in [0.1, 0.02, 1e-3] {
        let nodes = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, height]];
        let mut mesh = Mesh::new(nodes, Elements::of_kind(CellKind::Tet4, vec![0, 1, 2, 3])).unwrap();
        assert_eq!(non_conforming(&mesh), None);
        mesh.nodes.push([0.3, 0.3, -height]);
        mesh.elements.push(CellKind::Tet4, &[0, 2, 1, 4]);
        assert_eq!(non_conforming(&mesh), None);
    }
}

proptest! {
    /// Wherever the mesh lies, however large it is, and if the coarse facet is bent.
    #[test]
    fn hanging_nodes_are_found_in_any_place(
        degrees in 0.0..360.0, axis in prop::array::uniform3(0.1..1.0), at in prop::array::uniform3(-50.0..50.0),
        exponent in -6i32..6, ratio in 2usize..5, warp in -0.3..0.3,
    ) {
        let coarse = block(-2.0, 0.0, [1, 1, 1], CellKind::Hex8);
        let fine = block(0.0, 2.0, [1, ratio, ratio], CellKind::Hex8);
        let mut mesh = join(&coarse, &fine, |_| true);
        // the facet at x = 0 becomes a hyperbolic paraboloid, on both sides
        for x in &mut mesh.nodes {
            x[0] += warp * (x[1] - 1.0) * (x[2] - 1.0);
        }
        let rotation = Rotation { axis, degrees, about: [0.0; 3] };
        mesh.transform(Some(&rotation), at).unwrap();
        mesh.nodes.iter_mut().flatten().for_each(|x| *x *= 10f64.powi(exponent));
        prop_assert_eq!(non_conforming(&mesh).map(|(.., count)| count), Some(1));
    }
}
