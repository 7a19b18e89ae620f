//! Meshes of other cells: what they must keep, and how well curved boundaries are met.

use stoss_mesh::generate::{Ball, Block, Cylinder, HollowBall, HollowTorus, Portion};
use stoss_mesh::{Elements, Mesh, MeshError};
use stoss_reference_element::CellKind;

const KINDS: [CellKind; 6] =
    [CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10, CellKind::Wedge6, CellKind::Wedge15];

/// `int x . n dA / 3` over the boundary, or over a set.
fn moment(mesh: &Mesh, facets: &[stoss_mesh::Facet]) -> f64 {
    let mut sum = 0.0;
    for facet in facets {
        let kind = facet.nodes.kind();
        for &(xi, w) in kind.rule() {
            let (n, dn) = (kind.shape(xi), kind.shape_gradient(xi));
            let along = |weight: &dyn Fn(usize) -> f64| -> [f64; 3] {
                std::array::from_fn(|i| {
                    facet.nodes.iter().enumerate().map(|(k, &node)| weight(k) * mesh.nodes[node as usize][i]).sum()
                })
            };
            let (x, a, b) = (along(&|k| n[k]), along(&|k| dn[k][0]), along(&|k| dn[k][1]));
            let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            sum += w * (0..3).map(|i| x[i] * normal[i]).sum::<f64>() / 3.0;
        }
    }
    sum
}

#[test]
fn blocks_keep_volume_sets_and_conformity() {
    let mut block = Block::new([0.0; 3], [2.0, 1.0, 3.0], [3, 2, 2]).generate().unwrap();
    block.element_sets.insert("first".into(), vec![0]);
    block
        .node_sets
        .insert("edge".into(), block.nodes_in(&stoss_mesh::Region::Box { min: [0.0; 3], max: [0.0, 0.0, 3.0] }));
    for kind in KINDS {
        let mesh = block.with_cells(kind).unwrap();
        mesh.check().unwrap();
        assert_eq!(mesh.elements.kinds(), [kind]);
        assert!((mesh.quality().volume - 6.0).abs() < 1e-13, "{kind}");
        assert!((moment(&mesh, &mesh.boundary_facets()) - 6.0).abs() < 1e-13, "{kind}");
        // The faces at the origin have no moment; the others have a third of the volume each.
        for (set, expected) in
            [("left", 0.0), ("right", 2.0), ("front", 0.0), ("back", 2.0), ("bottom", 0.0), ("top", 2.0)]
        {
            let of_set = moment(&mesh, &mesh.facets_of(set).unwrap());
            assert!((of_set - expected).abs() < 1e-13, "{kind}: {set} {of_set}");
        }
        let part = mesh.submesh(&mesh.elements_of("first").unwrap()).unwrap();
        assert!((part.quality().volume - 0.5).abs() < 1e-14, "{kind}");
        let expected = if kind.is_quadratic() { 5 } else { 3 };
        assert_eq!(mesh.nodes_of("edge").unwrap().len(), expected, "{kind}");
    }
    assert_eq!(block.with_cells(CellKind::Hex8).unwrap(), block);
    assert_eq!(block.quadratic().unwrap(), block.with_cells(CellKind::Hex20).unwrap());
    let tets = block.with_cells(CellKind::Tet4).unwrap();
    assert_eq!(tets.quadratic().unwrap(), block.with_cells(CellKind::Tet10).unwrap());
}

/// Largest distance of the nodes of a set from a sphere or a cylinder of radius 1.
fn off(mesh: &Mesh, set: &str, radius: impl Fn([f64; 3]) -> f64) -> f64 {
    mesh.nodes_of(set).unwrap().iter().map(|&n| (radius(mesh.nodes[n as usize]) - 1.0).abs()).fold(0.0, f64::max)
}

/// A part of a tube from node to node: `n` cells around the angle, `m` along; one cell through the wall.
fn tube(angle: f64, n: usize, m: usize) -> Mesh {
    let mut mesh = Block::with_size([1.0; 3], [1, n, m]).generate().unwrap();
    for x in &mut mesh.nodes {
        let (radius, turn) = (x[0] + 1.5, x[1] * angle);
        *x = [radius * turn.cos(), radius * turn.sin(), x[2]];
    }
    mesh
}

/// Nodes in the middle of edges of a sphere and a cylinder are on it, at its rims and on diagonals as well.
#[test]
fn spheres_and_cylinders_are_met_exactly() {
    let sphere = |x: [f64; 3]| x.iter().map(|c| c * c).sum::<f64>().sqrt();
    let cylinder = |x: [f64; 3]| x[0].hypot(x[2]);
    let about_z = |x: [f64; 3]| x[0].hypot(x[1]);
    for kind in [CellKind::Hex20, CellKind::Hex27, CellKind::Tet10, CellKind::Wedge15] {
        let check = |name: &str, mesh: Mesh, set: &str, radius: &dyn Fn([f64; 3]) -> f64| {
            let (corners, cells) = (mesh.nodes.len(), mesh.with_cells(kind));
            let Ok(cells) = cells else { return assert_eq!(kind, CellKind::Wedge15, "{name}") };
            // The node in the middle of a face of hex27 is where its edges put it.
            let exact = if kind == CellKind::Hex27 && name.contains("ball") { 2e-3 } else { 1e-14 };
            let off = off(&cells, set, radius);
            assert!(off < exact && cells.nodes.len() > corners, "{kind}, {name}: {off:e}");
        };
        let part = Portion::Quarter;
        check(
            "ball",
            Ball { radius: 1.0, divisions: [3, 3, 3], part, refinement: None }.generate().unwrap(),
            "outer",
            &sphere,
        );
        let hollow = HollowBall { inner_diameter: 1.0, outer_diameter: 2.0, divisions: [6, 3] };
        check("hollow ball", hollow.generate().unwrap(), "outer", &sphere);
        let part = Portion::Full;
        let rod = Cylinder { radius: 1.0, length: 1.0, divisions: [3, 3, 3, 2], part, refinement: None };
        check("cylinder", rod.generate().unwrap(), "outer", &cylinder);
        for (n, m) in [(4, 1), (4, 3), (6, 2)] {
            for angle in [0.5 * std::f64::consts::PI, 0.7] {
                check("inside of a part of a tube", tube(angle, n, m), "left", &about_z);
                check("outside of a part of a tube", tube(angle, n, m), "right", &|x| 0.5 * about_z(x));
            }
        }
    }
    // In a mesh that has nothing but tetrahedra normals at nodes are not exact: 0.3 % of the height of the arc.
    let tets = tube(1.0, 4, 3).with_cells(CellKind::Tet4).unwrap().quadratic().unwrap();
    let off = off(&tets, "left", about_z);
    assert!(off < 5e-5, "{off:e}");
}

/// Where the curvature is not constant middles are met up to fourth order; straight edges would be off by second order.
#[test]
fn other_surfaces_are_met_to_fourth_order() {
    for kind in [CellKind::Hex20, CellKind::Tet10] {
        let error = |n: usize| {
            let torus = HollowTorus {
                ring_radius: 2.0,
                tube_outer_radius: 1.0,
                tube_inner_radius: 0.5,
                divisions: [4 * n, 3 * n, n / 4],
            };
            let torus = torus.generate().unwrap().with_cells(kind).unwrap();
            let radius = |x: [f64; 3]| {
                let [a, b, c] = x;
                // About whichever axis it is made.
                [[a, b, c], [b, c, a], [c, a, b]]
                    .map(|[a, b, c]| (a.hypot(b) - 2.0).hypot(c))
                    .into_iter()
                    .map(|r| (r - 1.0).abs())
                    .fold(f64::MAX, f64::min)
                    + 1.0
            };
            off(&torus, "outer", radius)
        };
        let [coarse, fine] = [error(4), error(8)];
        assert!(coarse < 3e-3 && fine < coarse / 12.0, "{kind}: {coarse:e} {fine:e}");
    }
}

/// The flat ends of a cylinder stay flat.
#[test]
fn plane_boundaries_stay_plane() {
    let rod = Cylinder { radius: 1.0, length: 1.0, divisions: [3, 3, 3, 2], part: Portion::Full, refinement: None };
    let rod = rod.generate().unwrap().with_cells(CellKind::Tet10).unwrap();
    assert!(
        rod.nodes_of("front")
            .unwrap()
            .iter()
            .all(|&n| rod.nodes[n as usize][1] == rod.nodes[rod.nodes_of("front").unwrap()[0] as usize][1])
    );
    rod.check().unwrap();
}

#[test]
fn what_cannot_be_made_is_refused() {
    let block = Block::with_size([1.0; 3], [1; 3]).generate().unwrap();
    let tets = block.with_cells(CellKind::Tet10).unwrap();
    let refused = |mesh: &Mesh, kind: CellKind| match mesh.with_cells(kind) {
        Err(MeshError::Parameter { parameter: "cell", remedy, .. }) => remedy,
        other => panic!("{other:?}"),
    };
    assert!(refused(&tets, CellKind::Hex8).contains("tet10"));
    assert!(refused(&block.with_cells(CellKind::Tet4).unwrap(), CellKind::Hex20).contains("only tet4, tet10"));
    // The blocks of a ball have different third directions.
    let ball = Ball { radius: 1.0, divisions: [2; 3], part: Portion::Quarter, refinement: None }.generate().unwrap();
    assert!(refused(&ball, CellKind::Wedge6).contains("tetrahedra"));
    let error = ball.with_cells(CellKind::Wedge15).unwrap_err().to_string();
    assert!(error.contains("wedge15") && !error.contains("wedge6"), "{error}");
    ball.with_cells(CellKind::Tet4).unwrap().check().unwrap();
}

/// Two hexahedra side by side along x, the first of them quadratic already, and a quadratic tetrahedron apart from them.
fn mixed(with_tetrahedron: bool) -> Mesh {
    let two =
        Block { min: [0.0; 3], max: [2.0, 1.0, 1.0], divisions: [2, 1, 1], grading: [1.0; 3] }.generate().unwrap();
    let quadratic = two.with_cells(CellKind::Hex20).unwrap();
    let mut elements = Elements::new();
    elements.push(CellKind::Hex20, &quadratic.elements[0]);
    elements.push(CellKind::Hex8, &two.elements[1]);
    let mut nodes = quadratic.nodes.clone();
    if with_tetrahedron {
        let tet = Elements::of_kind(CellKind::Tet10, (0..10).map(|n| n + nodes.len() as u32).collect());
        elements.push(CellKind::Tet10, &tet[0]);
        let corners =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|[x, y, z]| [x + 5.0, y, z]);
        nodes.extend(corners);
        let middle = |a: usize, b: usize| std::array::from_fn(|i| 0.5 * (corners[a][i] + corners[b][i]));
        nodes.extend([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]].map(|[a, b]| middle(a, b)));
    }
    Mesh { nodes, elements, ..Mesh::default() }
}

/// Elements that are what is asked for stay, their neighbours take over the nodes on common edges, and another element is named that cannot become it.
#[test]
fn elements_that_are_quadratic_already_stay() {
    for kind in [None, Some(CellKind::Hex20)] {
        let mesh = mixed(false);
        let turned = kind.map_or_else(|| mesh.quadratic(), |kind| mesh.with_cells(kind)).unwrap();
        assert_eq!(turned.elements.kinds(), [CellKind::Hex20]);
        let [one, other] = [0, 1].map(|e| turned.elements[e].to_vec());
        assert_eq!(one.iter().filter(|node| other.contains(node)).count(), 8);
    }
    let error = mixed(true).with_cells(CellKind::Hex20).unwrap_err().to_string();
    assert!(error.contains("element 2 is a tet10 and cannot become a hex20"), "{error}");
}

/// A coarse thin wall whose middles would pass its other side: the curvature is named, not the order of nodes.
#[test]
fn a_mesh_too_coarse_for_its_curvature_is_refused_with_the_reason() {
    let torus = HollowTorus { ring_radius: 2.0, tube_outer_radius: 0.6, tube_inner_radius: 0.4, divisions: [12, 8, 1] };
    let torus = torus.generate().unwrap();
    let error = torus.with_cells(CellKind::Tet10).unwrap_err();
    let MeshError::CurvedBoundary { kind: CellKind::Tet10, sharp, .. } = error else { panic!("{error}") };
    // Around the tube facets meet by 45 degrees, in both walls: 8 lines of 12 edges each.
    assert_eq!(sharp, 2 * 8 * 12);
    let text = error.to_string();
    assert!(
        text.contains("too coarse") && text.contains("by 34 to 60 degrees") && !text.contains("order of its nodes"),
        "{text}"
    );
    torus.with_cells(CellKind::Hex20).unwrap();
}
