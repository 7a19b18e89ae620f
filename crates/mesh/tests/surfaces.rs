//! Surfaces of rigid bodies: every generator, sets, placement, checks, the boundary of a mesh.

use proptest::prelude::*;
use stoss_mesh::generate::{Block, HollowBall};
use stoss_mesh::surface::{Cone, Cuboid, Cylinder, Plane, RoundDivisions, Sphere};
use stoss_mesh::{Mesh, MeshError, Rotation, SetKind, SurfaceMesh};

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// Twice the area vector, by the corners alone: `sum x_k x x_k+1`, from the first corner.
fn normal(surface: &SurfaceMesh, facet: u32) -> [f64; 3] {
    let x = surface.facet_coordinates(facet);
    (1..x.len() - 1)
        .map(|k| cross(minus(x[k], x[0]), minus(x[k + 1], x[0])))
        .fold([0.0; 3], |s, n| std::array::from_fn(|i| s[i] + n[i]))
}

fn centroid(surface: &SurfaceMesh, facet: u32) -> [f64; 3] {
    let x = surface.facet_coordinates(facet);
    std::array::from_fn(|i| x.iter().map(|p| p[i]).sum::<f64>() / x.len() as f64)
}

fn divisions(around: u32, along: u32, radial: u32) -> RoundDivisions {
    RoundDivisions { around, along, radial }
}

/// A convex closed surface: usable, all facets outward seen from an inner point, Euler's formula, sets that are a partition.
fn convex(surface: &SurfaceMesh, inside: [f64; 3], facets: usize) {
    surface.check().unwrap();
    assert!(surface.is_closed());
    assert_eq!(surface.facets.len(), facets);
    let corners: usize = surface.facets.iter().map(|f| f.len()).sum();
    assert_eq!(surface.nodes.len() + facets, corners / 2 + 2, "V - E + F = 2");
    for f in 0..facets as u32 {
        assert!(dot(normal(surface, f), minus(centroid(surface, f), inside)) > 0.0, "facet {f}");
    }
    assert!(surface.volume().unwrap() > 0.0);
    let turned = surface.clone().flipped();
    assert!(turned.is_closed());
    assert!(turned.facets.iter().zip(&surface.facets).all(|(t, s)| t[0] == s[0] && t[1] == s[s.len() - 1]));
    assert!((turned.volume().unwrap() / surface.volume().unwrap() + 1.0).abs() < 1e-13);
    assert_eq!(turned.flipped(), *surface);
    if !surface.facet_sets.is_empty() {
        let mut all: Vec<u32> = surface.facet_sets.values().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, surface.facets_of("boundary").unwrap());
    }
    assert_eq!(surface.nodes_of("all").unwrap(), (0..surface.nodes.len() as u32).collect::<Vec<_>>());
}

/// All normals of a set are along `direction`, and its nodes fulfil `on`.
fn set(surface: &SurfaceMesh, name: &str, count: usize, direction: [f64; 3], on: impl Fn([f64; 3]) -> bool) {
    let facets = surface.facets_of(name).unwrap();
    assert_eq!(facets.len(), count, "{name}");
    for &f in &facets {
        let n = normal(surface, f);
        assert!((dot(n, direction) / dot(n, n).sqrt() - 1.0).abs() < 1e-14, "{name} {n:?}");
    }
    for n in surface.nodes_of(name).unwrap() {
        assert!(on(surface.nodes[n as usize]), "{name} {:?}", surface.nodes[n as usize]);
    }
}

#[test]
fn plane() {
    let plane = Plane { size: [3.0, 2.0], divisions: [5, 4] }.generate().unwrap();
    plane.check().unwrap();
    assert_eq!((plane.nodes.len(), plane.facets.len()), (30, 20));
    set(&plane, "all", 20, [0.0, 0.0, 1.0], |x| x[2] == 0.0 && x[0].abs() <= 1.5 && x[1].abs() <= 1.0);
    assert!(plane.nodes.contains(&[-1.5, -1.0, 0.0]) && plane.nodes.contains(&[1.5, 1.0, 0.0]));
    let area: f64 = (0..20).map(|f| 0.5 * normal(&plane, f)[2]).sum();
    assert!((area - 6.0).abs() < 1e-14);
    // the rim: 2 (5 + 4) edges
    assert!(!plane.is_closed());
    assert_eq!(plane.open_edges().len(), 18);
    assert_eq!(plane.volume(), Err(MeshError::OpenSurface { count: 18, first: [0, 1] }));
}

#[test]
fn sphere() {
    for n in [1, 2, 5, 8] {
        let sphere = Sphere { radius: 0.7, divisions: n }.generate().unwrap();
        convex(&sphere, [0.0; 3], 6 * (n * n) as usize);
        for x in &sphere.nodes {
            assert!((dot(*x, *x).sqrt() - 0.7).abs() < 4e-16);
        }
        // no poles: three or four facets at each node
        let mut facets = vec![0; sphere.nodes.len()];
        sphere.facets.iter().flatten().for_each(|&n| facets[n as usize] += 1);
        assert_eq!(facets.iter().filter(|&&f| f == 3).count(), 8);
        assert!(facets.iter().all(|f| (3..=4).contains(f)));
        // the mirror image of each node is a node
        for x in &sphere.nodes {
            assert!(sphere.nodes.contains(&x.map(|c| -c)));
        }
    }
}

#[test]
fn cuboid() {
    let cuboid = Cuboid { size: [1.0, 2.0, 3.0], divisions: [2, 3, 4] }.generate().unwrap();
    convex(&cuboid, [0.0; 3], 2 * (6 + 12 + 8));
    for (axis, names, count) in [(0, ["left", "right"], 12), (1, ["front", "back"], 8), (2, ["bottom", "top"], 6)] {
        for (name, sign) in names.into_iter().zip([-1.0, 1.0]) {
            let mut direction = [0.0; 3];
            direction[axis] = sign;
            set(&cuboid, name, count, direction, |x| x[axis] == sign * 0.5 * (axis + 1) as f64);
        }
    }
    // the same names mean the same faces as in the block
    let mut block = SurfaceMesh::from_mesh(&Block::with_size([1.0, 2.0, 3.0], [2, 3, 4]).generate().unwrap()).unwrap();
    assert_eq!(block.set_names(), cuboid.set_names());
    assert_eq!((block.nodes.len(), block.facets.len()), (cuboid.nodes.len(), cuboid.facets.len()));
    for name in cuboid.set_names() {
        let centroids = |s: &SurfaceMesh| -> Vec<[i64; 3]> {
            let mut c: Vec<[i64; 3]> = (s.facets_of(&name).unwrap().iter())
                .map(|&f| centroid(s, f).map(|c| (c * 1e9).round() as i64))
                .collect();
            c.sort_unstable();
            c
        };
        assert_eq!(centroids(&block), centroids(&cuboid), "{name}");
    }
    block = block.flipped();
    assert!((block.volume().unwrap() + 6.0).abs() < 1e-14);
}

#[test]
fn cylinder() {
    for (around, along, radial) in [(3, 1, 1), (12, 3, 2), (17, 2, 4)] {
        let cylinder = Cylinder { radius: 0.5, length: 3.0, divisions: divisions(around, along, radial) };
        let cylinder = cylinder.generate().unwrap();
        convex(&cylinder, [0.0; 3], (around * (along + 2 * radial)) as usize);
        let ends = (around * radial) as usize;
        set(&cylinder, "bottom", ends, [0.0, 0.0, -1.0], |x| x[2] == -1.5 && x[0].hypot(x[1]) <= 0.5 + 1e-15);
        set(&cylinder, "top", ends, [0.0, 0.0, 1.0], |x| x[2] == 1.5 && x[0].hypot(x[1]) <= 0.5 + 1e-15);
        assert_eq!(cylinder.facets_of("side").unwrap().len(), (around * along) as usize);
        for n in cylinder.nodes_of("side").unwrap() {
            let x = cylinder.nodes[n as usize];
            assert!((x[0].hypot(x[1]) - 0.5).abs() < 2e-16 && x[2].abs() <= 1.5);
        }
        // a prism: area of the polygon times length
        let polygon = 0.5 * f64::from(around) * 0.25 * (2.0 * std::f64::consts::PI / f64::from(around)).sin();
        assert!((cylinder.volume().unwrap() / (polygon * 3.0) - 1.0).abs() < 1e-13);
    }
}

#[test]
fn cone() {
    for (tip_radius, names) in
        [(0.0, vec!["all", "base", "boundary", "side"]), (0.2, vec!["all", "base", "boundary", "side", "tip"])]
    {
        let (around, along, radial) = (11, 4, 3);
        let cone = Cone { radius: 0.6, height: 2.0, tip_radius, divisions: divisions(around, along, radial) };
        let cone = cone.generate().unwrap();
        let ends = if tip_radius > 0.0 { 2 } else { 1 };
        convex(&cone, [0.0, 0.0, 1.5], (around * (along + ends * radial)) as usize);
        assert_eq!(cone.set_names(), names);
        set(&cone, "base", 33, [0.0, 0.0, 1.0], |x| x[2] == 2.0);
        for n in cone.nodes_of("side").unwrap() {
            let x = cone.nodes[n as usize];
            assert!((x[0].hypot(x[1]) - (tip_radius + 0.5 * (0.6 - tip_radius) * x[2])).abs() < 4e-16);
        }
        // triangles at the tip only where it is sharp
        let triangles = cone.facets_of("side").unwrap().iter().filter(|&&f| cone.facets[f as usize].len() == 3).count();
        assert_eq!(triangles, if tip_radius > 0.0 { 0 } else { 11 });
        assert!(cone.nodes.contains(&[0.0; 3]));
        if tip_radius > 0.0 {
            set(&cone, "tip", 33, [0.0, 0.0, -1.0], |x| x[2] == 0.0);
        }
        // a frustum of a pyramid: height / 3 (A + a + sqrt(A a)), with areas as the squares of the radii
        let polygon = 0.5 * f64::from(around) * (2.0 * std::f64::consts::PI / f64::from(around)).sin();
        let volume = polygon * 2.0 / 3.0 * (0.36 + 0.6 * tip_radius + tip_radius * tip_radius);
        assert!((cone.volume().unwrap() / volume - 1.0).abs() < 1e-13);
    }
}

#[test]
fn bad_parameters_are_named() {
    let ok = divisions(8, 1, 1);
    let parameter = |result: Result<SurfaceMesh, MeshError>, name: &str| match result {
        Err(MeshError::Parameter { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{name}: {other:?}"),
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        parameter(Plane { size: [1.0, bad], divisions: [1; 2] }.generate(), "size y");
        parameter(Sphere { radius: bad, divisions: 2 }.generate(), "radius");
        parameter(Cuboid { size: [1.0, 1.0, bad], divisions: [1; 3] }.generate(), "size z");
        parameter(Cylinder { radius: 1.0, length: bad, divisions: ok }.generate(), "length");
        parameter(Cone { radius: 1.0, height: bad, tip_radius: 0.0, divisions: ok }.generate(), "height");
    }
    for bad in [-1e-9, 1.0, 2.0, f64::NAN, f64::INFINITY] {
        parameter(Cone { radius: 1.0, height: 1.0, tip_radius: bad, divisions: ok }.generate(), "tip_radius");
    }
    parameter(Plane { size: [1.0; 2], divisions: [0, 1] }.generate(), "divisions x");
    parameter(Sphere { radius: 1.0, divisions: 0 }.generate(), "divisions");
    parameter(Cuboid { size: [1.0; 3], divisions: [1, 0, 1] }.generate(), "divisions y");
    for (bad, name) in [
        (divisions(2, 1, 1), "divisions around"),
        (divisions(3, 0, 1), "divisions along"),
        (divisions(3, 1, 0), "divisions radial"),
    ] {
        parameter(Cylinder { radius: 1.0, length: 1.0, divisions: bad }.generate(), name);
        parameter(Cone { radius: 1.0, height: 1.0, tip_radius: 0.0, divisions: bad }.generate(), name);
    }
    let most = u32::MAX;
    for result in [
        Plane { size: [1.0; 2], divisions: [most; 2] }.generate(),
        Sphere { radius: 1.0, divisions: most }.generate(),
        Cuboid { size: [1.0; 3], divisions: [most; 3] }.generate(),
        Cylinder { radius: 1.0, length: 1.0, divisions: divisions(most, most, most) }.generate(),
        Cone { radius: 1.0, height: 1.0, tip_radius: 0.5, divisions: divisions(most, most, most) }.generate(),
    ] {
        assert!(matches!(result, Err(MeshError::TooLarge { .. })));
    }
    // sizes near the ends of the range of f64 are shapes like others
    for radius in [1e-300, 1e300] {
        Sphere { radius, divisions: 3 }.generate().unwrap();
    }
    let needle = Cuboid { size: [1.0, 1e-14, 1.0], divisions: [1; 3] }.generate();
    assert!(matches!(needle, Err(MeshError::DegenerateFacet { .. })), "{needle:?}");
}

#[test]
fn sets_and_checks() {
    let mut surface = Cuboid { size: [1.0; 3], divisions: [1; 3] }.generate().unwrap();
    assert_eq!(surface.set_names(), ["all", "back", "bottom", "boundary", "front", "left", "right", "top"]);
    assert_eq!(
        surface.facets_of("lid").unwrap_err(),
        MeshError::UnknownSet { name: "lid".into(), available: surface.set_names() }
    );
    surface.facet_sets.insert("all".into(), vec![2]);
    assert_eq!(surface.facets_of("all").unwrap(), [2]);
    surface.facet_sets.insert("bad".into(), vec![6]);
    let out = MeshError::SetOutOfRange { name: "bad".into(), kind: SetKind::Facets, index: 6, count: 6 };
    assert_eq!(surface.check(), Err(out.clone()));
    assert_eq!(surface.nodes_of("bad"), Err(out));

    let corners =
        vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0; 3], [0.2, 0.2, 0.0]];
    let quad = |nodes: [u32; 4]| SurfaceMesh::new(corners.clone(), vec![nodes.into()]).unwrap().check();
    let triangle = |nodes: [u32; 3]| SurfaceMesh::new(corners.clone(), vec![nodes.into()]).unwrap().check();
    assert_eq!(quad([0, 1, 2, 3]), Ok(()));
    assert_eq!(triangle([0, 1, 2]), Ok(()));
    assert_eq!(SurfaceMesh::default().check(), Err(MeshError::NoFacets));
    let degenerate = |nodes: &[u32]| Err(MeshError::DegenerateFacet { facet: 0, nodes: nodes.to_vec() });
    assert_eq!(quad([0, 1, 2, 2]), degenerate(&[0, 1, 2, 2]), "a node twice");
    assert_eq!(quad([0, 1, 2, 5]), degenerate(&[0, 1, 2, 5]), "two nodes at one place");
    assert_eq!(quad([0, 2, 1, 3]), degenerate(&[0, 2, 1, 3]), "crossed");
    assert_eq!(
        quad([0, 1, 6, 3]),
        degenerate(&[0, 1, 6, 3]),
        "an arrow head with a1 x a2 turned over at a point of the rule"
    );
    assert_eq!(triangle([0, 1, 4]), degenerate(&[0, 1, 4]), "on a line");
    assert_eq!(triangle([0, 5, 1]), degenerate(&[0, 5, 1]), "two nodes at one place");
    assert_eq!(
        SurfaceMesh::new(corners.clone(), vec![[0, 1, 7].into()]),
        Err(MeshError::FacetNodeOutOfRange { facet: 0, node: 7, count: 7 })
    );
    let mut nan = SurfaceMesh::new(corners.clone(), vec![[0, 1, 2].into()]).unwrap();
    nan.nodes[4][1] = f64::NAN;
    assert!(matches!(nan.check(), Err(MeshError::NonFiniteNode { node: 4, .. })));

    let mut some = SurfaceMesh::new(corners, vec![[0, 1, 4].into(), [1, 2, 3].into(), [4, 4, 2].into()]).unwrap();
    some.facet_sets = [("one".into(), vec![0, 1]), ("gone".into(), vec![0, 2])].into();
    assert_eq!(some.drop_degenerate(), 2);
    assert_eq!(some.nodes, [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(some.facets, [[0, 1, 2].into()]);
    assert_eq!(some.facet_sets, [("one".to_owned(), vec![0])].into());
    assert_eq!(some.drop_degenerate(), 0);
}

#[test]
fn closedness() {
    let tetrahedron = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let x = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let surface =
        |facets: &[[u32; 3]]| SurfaceMesh::new(x.clone(), facets.iter().map(|&f| f.into()).collect()).unwrap();
    assert!(surface(&tetrahedron).is_closed());
    assert!((surface(&tetrahedron).volume().unwrap() - 1.0 / 6.0).abs() < 1e-16);
    assert!(!SurfaceMesh::default().is_closed());
    assert_eq!(surface(&tetrahedron[1..]).open_edges(), [[0, 1], [0, 2], [1, 2]]);
    // one facet turned over: its edges are passed twice in the same direction
    let mut turned = tetrahedron.clone();
    turned[2].reverse();
    assert_eq!(surface(&turned).open_edges(), [[1, 2], [1, 3], [2, 3]]);
    let mut doubled = tetrahedron.clone();
    doubled.push([0, 2, 1]);
    assert_eq!(surface(&doubled).open_edges(), [[0, 1], [0, 2], [1, 2]]);
}

#[test]
fn boundary_of_a_mesh() {
    let mut mesh = HollowBall { inner_diameter: 1.0, outer_diameter: 2.0, divisions: [3, 3] }.generate().unwrap();
    // an unused node in front, so that numbers change, and a set with a facet between two elements
    mesh.nodes.insert(0, [9.0; 3]);
    (0..mesh.elements.len()).for_each(|e| mesh.elements[e].iter_mut().for_each(|n| *n += 1));
    mesh.facet_sets.values_mut().flatten().for_each(|f| f.nodes = f.nodes.map(|n| n + 1));
    let (inner, outer) = (mesh.facet(0, 1), mesh.facet_sets["outer"][0]);
    assert_eq!(mesh.facet_index().find(&inner.nodes).len(), 2);
    mesh.facet_sets.insert("mixed".into(), vec![inner, outer]);
    mesh.facet_sets.insert("hidden".into(), vec![inner]);
    mesh.node_sets.insert("nodes".into(), vec![1]);

    let surface = SurfaceMesh::from_mesh(&mesh).unwrap();
    surface.check().unwrap();
    assert!(surface.is_closed());
    assert_eq!(surface.set_names(), ["all", "boundary", "inner", "mixed", "outer"]);
    assert_eq!(surface.facets.len(), 108);
    assert_eq!(surface.nodes.len(), 2 * 56);
    for (name, radius) in [("inner", 0.5), ("outer", 1.0)] {
        assert_eq!(surface.facets_of(name).unwrap().len(), 54);
        for n in surface.nodes_of(name).unwrap() {
            assert!((dot(surface.nodes[n as usize], surface.nodes[n as usize]).sqrt() - radius).abs() < 1e-15);
        }
    }
    let mixed = surface.facets_of("mixed").unwrap();
    assert_eq!(mixed.len(), 1);
    let x = surface.facet_coordinates(mixed[0]);
    assert_eq!(x[..], *outer.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect::<Vec<_>>());
    assert!((surface.volume().unwrap() / mesh.quality().volume - 1.0).abs() < 1e-13);

    assert_eq!(SurfaceMesh::from_mesh(&Mesh::default()), Err(MeshError::NoElements));
    let bad = Mesh { elements: vec![[0, 1, 2, 3, 4, 5, 6, 7]].into(), ..Mesh::default() };
    assert!(matches!(SurfaceMesh::from_mesh(&bad), Err(MeshError::NodeOutOfRange { .. })));
}

proptest! {
    /// A surface is placed as the mesh that it is the boundary of.
    #[test]
    fn placed_as_a_mesh(axis in prop::array::uniform3(-1.0..1.0), degrees in -400.0..400.0, about in prop::array::uniform3(-3.0..3.0), shift in prop::array::uniform3(-3.0..3.0)) {
        let rotation = Rotation { axis, degrees, about };
        let mut mesh = Block::with_size([1.0, 2.0, 0.5], [2, 2, 1]).generate().unwrap();
        let mut surface = SurfaceMesh::from_mesh(&mesh).unwrap();
        mesh.transform(Some(&rotation), shift).unwrap();
        surface.transform(Some(&rotation), shift).unwrap();
        prop_assert_eq!(surface, SurfaceMesh::from_mesh(&mesh).unwrap());
    }
}

#[test]
fn bad_placement_changes_nothing() {
    let mut surface = Sphere { radius: 1.0, divisions: 1 }.generate().unwrap();
    let before = surface.clone();
    let rotation = Rotation { axis: [0.0; 3], degrees: 10.0, about: [0.0; 3] };
    assert!(surface.transform(Some(&rotation), [1.0; 3]).is_err());
    assert!(surface.transform(None, [0.0, f64::NAN, 0.0]).is_err());
    assert_eq!(surface, before);
}
