//! Sets by name and by region, placement, submeshes, and the checks of a mesh.

use proptest::prelude::*;
use stoss_mesh::generate::{Block, HollowBall, HollowTorus};
use stoss_mesh::{Elements, Facet, Mesh, MeshError, Region, Rotation, SetKind};
use stoss_reference_element::CellKind;

fn block(n: [usize; 3]) -> Mesh {
    Block::new([0.0; 3], n.map(|n| n as f64), n).generate().unwrap()
}

#[test]
fn automatic_sets_and_derived_sets() {
    let mesh = block([2, 2, 2]);
    assert_eq!(mesh.nodes_of("all").unwrap().len(), 27);
    assert_eq!(mesh.elements_of("all").unwrap(), (0..8).collect::<Vec<_>>());
    assert_eq!(mesh.facets_of("boundary").unwrap().len(), 24);
    assert_eq!(mesh.nodes_of("boundary").unwrap().len(), 26);
    let top = mesh.nodes_of("top").unwrap();
    let by_hand: Vec<u32> = (0..27).filter(|&n| mesh.nodes[n as usize][2] == 2.0).collect();
    assert_eq!(top, by_hand);
    assert_eq!(
        mesh.set_names(),
        ["all", "back", "bottom", "boundary", "front", "left", "right", "top"].map(str::to_owned)
    );
    match mesh.nodes_of("tip") {
        Err(MeshError::UnknownSet { name, available }) => {
            assert_eq!(name, "tip");
            assert_eq!(available, mesh.set_names());
        }
        other => panic!("{other:?}"),
    }
    let wrong = |has, wanted| move |e: MeshError| matches!(e, MeshError::WrongSetKind { has: h, wanted: w, .. } if h == has && w == wanted);
    assert!(mesh.elements_of("top").is_err_and(wrong(SetKind::Facets, SetKind::Elements)));
    assert!(mesh.facets_of("all").is_err_and(wrong(SetKind::Elements, SetKind::Facets)));
    assert!(mesh.elements_of("boundary").is_err_and(wrong(SetKind::Facets, SetKind::Elements)));
}

#[test]
fn regions_make_node_facet_and_element_sets() {
    let mut mesh = block([4, 3, 2]);
    let half = Region::Box { min: [-1.0, -1.0, -1.0], max: [2.0, 9.0, 9.0] };
    mesh.add_region_sets("half", &half).unwrap();
    assert_eq!(mesh.nodes_of("half").unwrap().len(), 3 * 4 * 3);
    assert_eq!(mesh.elements_of("half").unwrap().len(), 2 * 3 * 2);
    // boundary facets of the block only: the cut itself has none
    assert_eq!(mesh.facets_of("half").unwrap().len(), 3 * 2 + 2 * (2 * 2) + 2 * (2 * 3));
    let plane = Region::Plane { point: [0.0, 0.0, 2.0], normal: [0.0, 0.0, -7.0], tolerance: 1e-9 };
    mesh.add_region_sets("lid", &plane).unwrap();
    assert_eq!(mesh.facets_of("lid").unwrap(), mesh.facets_of("top").unwrap());
    assert!(mesh.elements_of("lid").is_err());
    mesh.check().unwrap();

    assert!(matches!(mesh.add_region_sets("lid", &plane), Err(MeshError::SetExists { .. })));
    assert!(matches!(mesh.add_region_sets("all", &plane), Err(MeshError::SetExists { .. })));
    assert!(matches!(mesh.add_region_sets(" ", &plane), Err(MeshError::Parameter { .. })));
    let away = Region::Box { min: [8.0; 3], max: [9.0; 3] };
    let empty = mesh.add_region_sets("away", &away).unwrap_err();
    assert!(empty.to_string().contains("[4.0, 3.0, 2.0]"), "{empty}");
    let bad = [
        Region::Box { min: [1.0, 0.0, 0.0], max: [0.0, 1.0, 1.0] },
        Region::Box { min: [f64::NAN; 3], max: [1.0; 3] },
        Region::Plane { point: [0.0; 3], normal: [0.0; 3], tolerance: 0.1 },
        Region::Plane { point: [0.0; 3], normal: [1.0, 0.0, 0.0], tolerance: -0.1 },
        Region::Plane { point: [f64::INFINITY, 0.0, 0.0], normal: [1.0, 0.0, 0.0], tolerance: 0.1 },
    ];
    for region in bad {
        assert!(matches!(mesh.add_region_sets("new", &region), Err(MeshError::Parameter { .. })), "{region:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    /// The boundary by brute force: facets whose node set no other facet has.
    #[test]
    fn boundary_facets_against_brute_force(n in prop::array::uniform3(1usize..4), keep in prop::collection::vec(any::<bool>(), 27)) {
        let whole = block(n);
        let kept: Vec<u32> = (0..whole.elements.len() as u32).filter(|&e| keep[e as usize]).collect();
        prop_assume!(!kept.is_empty());
        let mesh = whole.submesh(&kept).unwrap();
        mesh.check().unwrap();
        let mut all = Vec::new();
        for e in 0..mesh.elements.len() as u32 {
            all.extend((0..6).map(|l| mesh.facet(e, l)));
        }
        let key = |f: &Facet| f.nodes.iter().copied().collect::<std::collections::BTreeSet<u32>>();
        let expected: Vec<Facet> =
            all.iter().filter(|f| all.iter().filter(|g| key(g) == key(f)).count() == 1).copied().collect();
        prop_assert_eq!(mesh.boundary_facets(), expected);
        prop_assert!((mesh.quality().volume - kept.len() as f64).abs() < 1e-12);
        let index = mesh.facet_index();
        for f in &all {
            let mut shuffled = f.nodes.to_vec();
            shuffled.reverse();
            let found: Vec<_> = index.find(&shuffled).copied().collect();
            prop_assert_eq!(&found, &all.iter().filter(|g| key(g) == key(f)).copied().collect::<Vec<_>>());
        }
        prop_assert_eq!(index.find(&[0, 0, 1, 2]).len(), 0);
        // sets keep their places
        for (name, set) in &mesh.facet_sets {
            for f in set {
                for &n in f.nodes.iter() {
                    let x = mesh.nodes[n as usize];
                    prop_assert!(whole.nodes_of(name).unwrap().iter().any(|&m| whole.nodes[m as usize] == x));
                }
            }
        }
    }

    /// A placement keeps distances, orientation and volume; the axis stays, and the angle is the one asked for.
    #[test]
    fn placement_is_rigid(
        axis in prop::array::uniform3(-1.0..1.0f64),
        degrees in -720.0..720.0f64,
        about in prop::array::uniform3(-2.0..2.0f64),
        shift in prop::array::uniform3(-2.0..2.0f64),
    ) {
        let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
        prop_assume!(length > 0.1);
        let rotation = Rotation { axis, degrees, about };
        let original = block([2, 1, 1]);
        let mut mesh = original.clone();
        mesh.transform(Some(&rotation), shift).unwrap();
        mesh.check().unwrap();
        prop_assert!((mesh.quality().volume - 2.0).abs() < 1e-13);
        let d = |m: &Mesh, a: usize, b: usize| {
            (0..3).map(|i| (m.nodes[a][i] - m.nodes[b][i]).powi(2)).sum::<f64>().sqrt()
        };
        for a in 0..12 {
            for b in 0..a {
                prop_assert!((d(&mesh, a, b) - d(&original, a, b)).abs() < 1e-13);
            }
        }
        let r = rotation.matrix().unwrap();
        let trace = r[0][0] + r[1][1] + r[2][2];
        prop_assert!((trace - 1.0 - 2.0 * degrees.to_radians().cos()).abs() < 1e-13);
        // twice the axial vector of the skew part is 2 sin * n: right-handed
        let skew = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
        for i in 0..3 {
            prop_assert!((skew[i] - 2.0 * degrees.to_radians().sin() * axis[i] / length).abs() < 1e-12);
        }
        // the point of the axis only translates
        let mut point = Mesh { nodes: vec![about], ..Mesh::default() };
        point.transform(Some(&rotation), shift).unwrap();
        for i in 0..3 {
            prop_assert_eq!(point.nodes[0][i], about[i] + shift[i]);
        }
    }
}

#[test]
fn quarter_turns_are_exact() {
    let mut mesh = Mesh { nodes: vec![[1.0, 2.0, 3.0]], ..Mesh::default() };
    let quarter = Rotation { axis: [0.0, 0.0, 5.0], degrees: 90.0, about: [0.0; 3] };
    mesh.transform(Some(&quarter), [0.0; 3]).unwrap();
    assert_eq!(mesh.nodes[0], [-2.0, 1.0, 3.0]);
    let back = Rotation { degrees: -450.0, ..quarter };
    mesh.transform(Some(&back), [0.0; 3]).unwrap();
    assert_eq!(mesh.nodes[0], [1.0, 2.0, 3.0]);
    let bad = [
        Rotation { axis: [0.0; 3], ..quarter },
        Rotation { axis: [f64::NAN, 0.0, 1.0], ..quarter },
        Rotation { degrees: f64::INFINITY, ..quarter },
        Rotation { about: [f64::NAN; 3], ..quarter },
    ];
    for rotation in bad {
        assert!(matches!(mesh.transform(Some(&rotation), [0.0; 3]), Err(MeshError::Parameter { .. })));
    }
    assert!(mesh.transform(None, [f64::NAN, 0.0, 0.0]).is_err());
    assert_eq!(mesh.nodes[0], [1.0, 2.0, 3.0]);
}

#[test]
fn the_check_names_what_is_wrong() {
    let good = block([2, 1, 1]);
    let broken = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        mesh.check().unwrap_err()
    };
    assert_eq!(Mesh::default().check(), Err(MeshError::NoElements));
    assert_eq!(broken(&|m| m.elements[1][3] = 99), MeshError::NodeOutOfRange { element: 1, node: 99, count: 12 });
    assert!(matches!(broken(&|m| m.nodes[4][1] = f64::NAN), MeshError::NonFiniteNode { node: 4, .. }));
    assert!(matches!(broken(&|m| m.elements[0][6] = m.elements[0][7]), MeshError::RepeatedNode { element: 0, .. }));
    match broken(&|m| m.elements[1].swap(0, 4)) {
        MeshError::InvertedElement { element: 1, nodes, jacobian, .. } => {
            assert!(jacobian <= 0.0);
            assert_eq!(nodes[0], good.elements[1][4]);
        }
        other => panic!("{other}"),
    }
    // flat: all nodes in one plane
    assert!(matches!(broken(&|m| m.nodes.iter_mut().for_each(|x| x[2] = 0.0)), MeshError::InvertedElement { .. }));
    assert!(matches!(broken(&|m| m.nodes.push([5.0; 3])), MeshError::UnusedNodes { count: 1, first: 12, .. }));
    assert!(matches!(
        broken(&|m| {
            let x = m.nodes[1];
            m.nodes.push([x[0], x[1] + 1e-7, x[2]]);
            m.elements[1][0] = 12;
        }),
        MeshError::DuplicateNodes { first: 1, second: 12, .. }
    ));
    assert!(matches!(
        broken(&|m| {
            let (kind, first) = (m.elements.kind(0), m.elements[0].to_vec());
            m.elements.push(kind, &first);
        }),
        MeshError::OverlappingElements { elements: [0, 2], .. }
    ));
    assert!(matches!(
        broken(&|m| {
            m.node_sets.insert("bad".into(), vec![77]);
        }),
        MeshError::SetOutOfRange { kind: SetKind::Nodes, index: 77, .. }
    ));
    assert!(matches!(
        broken(&|m| m.facet_sets.get_mut("top").unwrap()[0].local = 0),
        MeshError::SetOutOfRange { kind: SetKind::Facets, .. }
    ));
    assert!(matches!(
        broken(&|m| m.facet_sets.get_mut("top").unwrap()[0].element = 9),
        MeshError::SetOutOfRange { kind: SetKind::Elements, index: 9, .. }
    ));
}

/// A cube beside other cells on its face `x = 1`; beyond it are the nodes 8 and 9.
fn beside_a_cube(others: &[(CellKind, &[u32])]) -> Mesh {
    let mut nodes: Vec<[f64; 3]> = Vec::new();
    for z in [0.0, 1.0] {
        nodes.extend([[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]);
    }
    nodes.extend([[2.0, 0.0, 0.0], [2.0, 0.0, 1.0]]);
    let mut elements = Elements::of_kind(CellKind::Hex8, (0..8).collect());
    others.iter().for_each(|(kind, nodes)| elements.push(*kind, nodes));
    let used = elements.iter().flatten().max().unwrap() + 1;
    nodes.truncate(used as usize);
    Mesh::new(nodes, elements).unwrap()
}

/// Corners of a face that a quadrilateral and two triangles have in common do not make a continuous body.
#[test]
fn quadrilaterals_meet_quadrilaterals() {
    // the facet x = 1 of the cube has the nodes 1, 2, 6, 5
    let lower: (CellKind, &[u32]) = (CellKind::Tet4, &[1, 2, 5, 8]);
    let upper: (CellKind, &[u32]) = (CellKind::Tet4, &[2, 6, 5, 8]);
    for (others, first) in [(vec![lower, upper], 1), (vec![upper], 1), (vec![lower], 1)] {
        let mesh = beside_a_cube(&others);
        for error in [mesh.check(), mesh.check_allowing_coincident()].map(Result::unwrap_err) {
            let MeshError::NonConformingFacet { elements, kinds, centre, count } = &error else { panic!("{error}") };
            assert_eq!((*elements, &kinds[..], *centre, *count), ([0, first], "hex8, tet4", [1.0, 0.5, 0.5], 1));
            assert!(error.to_string().contains("[1.0, 0.5, 0.5]") && error.to_string().contains("[[tie]]"), "{error}");
        }
    }
    // a wedge by its quadrilateral, and tetrahedra on the triangles of wedges
    let wedge: (CellKind, &[u32]) = (CellKind::Wedge6, &[1, 8, 2, 5, 9, 6]);
    assert_eq!(beside_a_cube(&[wedge]).check(), Ok(()));
    let mut mesh = beside_a_cube(&[wedge]);
    mesh.nodes.push([1.5, 0.3, 2.0]);
    mesh.elements.push(CellKind::Tet4, &[5, 9, 6, 10]);
    assert_eq!(mesh.check(), Ok(()));
    // a wedge that the cube meets with its other side: its quadrilateral on two triangles
    let mut mesh = beside_a_cube(&[wedge]);
    mesh.nodes.push([2.0, 1.0, 0.5]);
    mesh.elements.push(CellKind::Tet4, &[8, 2, 9, 10]);
    assert!(matches!(mesh.check(), Err(MeshError::NonConformingFacet { elements: [1, 2], .. })));
}

/// Coincident nodes are found wherever they lie, also across the cells of the search.
#[test]
fn two_copies_of_a_mesh_are_coincident_everywhere() {
    let ball = HollowBall { inner_diameter: 0.8, outer_diameter: 1.0, divisions: [4, 2] }.generate().unwrap();
    for node in 0..ball.nodes.len() {
        let mut mesh = ball.clone();
        let x = mesh.nodes[node];
        mesh.nodes.push(x.map(|c| c * (1.0 + 1e-9)));
        let new = mesh.nodes.len() as u32 - 1;
        // give the copy to the last element that has the node
        let e = (0..mesh.elements.len()).rfind(|&e| mesh.elements[e].contains(&(node as u32))).unwrap();
        let place = mesh.elements[e].iter().position(|&n| n == node as u32).unwrap();
        mesh.elements[e][place] = new;
        let used_elsewhere = mesh.elements.iter().flatten().any(|&n| n as usize == node);
        assert!(used_elsewhere);
        let error = mesh.check().unwrap_err();
        assert!(
            matches!(error, MeshError::DuplicateNodes { first, second, .. } if first == node as u32 && second == new),
            "{error}"
        );
    }
}

/// Two blocks that touch are two pieces with the nodes of one side at the same places: allowed where that is asked for, but not
/// two nodes of one element.
#[test]
fn bodies_that_touch() {
    let one = block([2, 2, 1]);
    let mut two = one.clone();
    let shift = one.nodes.len() as u32;
    let height = one.bounding_box().1[2] - one.bounding_box().0[2];
    two.nodes.extend(one.nodes.iter().map(|x| [x[0], x[1], x[2] + height]));
    two.elements.extend(&one.elements, |n| n + shift);
    assert_eq!((one.pieces(), two.pieces()), (1, 2));
    assert_eq!(two.piece_of_elements(&[5, 0, 4]), [0, 1, 0]);
    assert_eq!(one.coincident_nodes(), None);
    let found = two.coincident_nodes().unwrap();
    assert_eq!(found.count, 9);
    assert!(found.first < shift && found.second >= shift && found.distance < 1e-12);
    assert!(matches!(two.check(), Err(MeshError::DuplicateNodes { .. })));
    assert_eq!(two.check_allowing_coincident(), Ok(()));
    // a wedge: the edge between nodes 0 and 1 of an element is a point
    let mut wedge = block([1, 1, 1]);
    let [a, b] = [wedge.elements[0][0], wedge.elements[0][1]];
    wedge.nodes[b as usize] = wedge.nodes[a as usize];
    assert!(wedge.check_allowing_coincident().is_err());
}

#[test]
fn quality_of_known_shapes() {
    let cube = block([1, 1, 1]).quality();
    assert!((cube.volume - 1.0).abs() < 1e-15);
    assert_eq!((cube.min_scaled_jacobian, cube.max_aspect_ratio), (1.0, 1.0));
    let slab = Block::with_size([4.0, 1.0, 0.5], [2, 1, 1]).generate().unwrap().quality();
    assert_eq!((slab.max_aspect_ratio, slab.min_edge, slab.max_edge), (4.0, 0.5, 2.0));
    // shear by 45 degrees: sine of the angle between the edges
    let sheared = block([1, 1, 1]).map(|[x, y, z]| [x + z, y, z]).unwrap().quality();
    assert!((sheared.min_scaled_jacobian - 0.5f64.sqrt()).abs() < 1e-15);
    let mut turned = block([2, 1, 1]);
    turned.elements[1].swap(1, 3);
    turned.elements[1].swap(5, 7);
    let report = turned.quality();
    assert_eq!((report.inverted_elements, report.worst_element), (1, 1));
    assert!(report.min_scaled_jacobian < 0.0);
    let torus =
        HollowTorus { ring_radius: 38.0, tube_outer_radius: 12.0, tube_inner_radius: 7.5, divisions: [78, 20, 2] };
    let text = torus.generate().unwrap().quality().to_string();
    assert!(text.starts_with("3120 elements") && text.ends_with("0 inverted"), "{text}");
}

#[test]
fn submeshes_need_elements_that_exist() {
    let mesh = block([2, 1, 1]);
    assert_eq!(mesh.submesh(&[]), Err(MeshError::NoElements));
    assert!(matches!(mesh.submesh(&[0, 5]), Err(MeshError::SetOutOfRange { index: 5, .. })));
    let part = mesh.submesh(&[1, 1]).unwrap();
    assert_eq!((part.elements.len(), part.nodes.len()), (1, 8));
    assert!(part.facet_sets.contains_key("right") && !part.facet_sets.contains_key("left"));
}
