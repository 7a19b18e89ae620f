//! Every generator: counts, validity, volume, areas and directions of its named surfaces.

use std::f64::consts::PI;

use proptest::prelude::*;
use stoss_mesh::generate::{
    Ball, Block, Cylinder, Hexahedron, HollowBall, HollowTorus, Indenter, LBlock, Portion, Refinement,
};
use stoss_mesh::{Facet, Mesh, MeshError};

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Area vector of a facet: half the cross product of its diagonals (exact for a bilinear patch).
fn area_vector(mesh: &Mesh, facet: &Facet) -> [f64; 3] {
    let x: Vec<_> = facet.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
    let d = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| 0.5 * (x[a][i] - x[b][i])) };
    let c = cross(d(2, 0), d(3, 1));
    c.map(|c| 2.0 * c)
}

fn total(mesh: &Mesh, facets: &[Facet]) -> [f64; 3] {
    facets.iter().map(|f| area_vector(mesh, f)).fold([0.0; 3], |s, a| std::array::from_fn(|i| s[i] + a[i]))
}

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|a| a * a).sum::<f64>().sqrt()
}

/// What holds for every mesh: usable; each set sorted; the boundary closed and outward (Gauss' theorem gives the
/// volume, and each element's volume adds up to it).
fn battery(mesh: &Mesh) {
    mesh.check().unwrap();
    let boundary = mesh.facets_of("boundary").unwrap();
    let area: f64 = boundary.iter().map(|f| norm(area_vector(mesh, f))).sum();
    assert!(norm(total(mesh, &boundary)) < 1e-12 * area);
    // volume = 1/3 int x . n dA; over a bilinear patch by the 2 x 2 rule, exactly
    let mut volume = 0.0;
    for f in &boundary {
        let x: Vec<_> = f.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
        for (xi, w) in stoss_reference_element::quadrature::GAUSS_QUAD_2 {
            let n = stoss_reference_element::quad4::shape(xi);
            let dn = stoss_reference_element::quad4::shape_gradient(xi);
            let sum = |c: &dyn Fn(usize) -> f64| -> [f64; 3] {
                std::array::from_fn(|i| (0..4).map(|a| c(a) * x[a][i]).sum())
            };
            let (p, a1, a2) = (sum(&|a| n[a]), sum(&|a| dn[a][0]), sum(&|a| dn[a][1]));
            let normal = cross(a1, a2);
            volume += w * (0..3).map(|i| p[i] * normal[i]).sum::<f64>() / 3.0;
        }
    }
    let report = mesh.quality();
    assert!(
        (report.volume - volume).abs() < 1e-10 * volume.abs() + 1e-12 * area.powf(1.5),
        "{volume} {}",
        report.volume
    );
    assert_eq!(report.inverted_elements, 0);
    for (name, facets) in &mesh.facet_sets {
        assert!(!facets.is_empty(), "{name}");
        assert!(facets.is_sorted_by(|a, b| a < b), "{name}");
        assert!(facets.iter().all(|f| boundary.binary_search(f).is_ok()), "{name} is not on the boundary");
        let nodes = mesh.nodes_of(name).unwrap();
        assert!(nodes.is_sorted_by(|a, b| a < b));
    }
}

/// The named sides of a block: count, direction, coordinate of the plane if it is one.
fn sides(mesh: &Mesh, [nx, ny, nz]: [usize; 3]) {
    let rows = [
        ("left", 0, -1.0, ny * nz),
        ("right", 0, 1.0, ny * nz),
        ("front", 1, -1.0, nx * nz),
        ("back", 1, 1.0, nx * nz),
        ("bottom", 2, -1.0, nx * ny),
        ("top", 2, 1.0, nx * ny),
    ];
    let mut all = 0;
    for (name, axis, sign, count) in rows {
        let facets = mesh.facets_of(name).unwrap();
        assert_eq!(facets.len(), count, "{name}");
        assert!(sign * total(mesh, &facets)[axis] > 0.0, "{name}");
        all += count;
    }
    assert_eq!(mesh.boundary_facets().len(), all);
}

/// Parts of a ball and how many eighths they have.
const PARTS: [(Portion, usize); 4] =
    [(Portion::Full, 8), (Portion::Half, 4), (Portion::Quarter, 2), (Portion::Eighth, 1)];

/// Sets that exist lie in a coordinate plane at `level` to the last bit, and face outwards.
fn planes(mesh: &Mesh, rows: &[(&str, usize, f64)], level: f64) {
    for &(name, axis, sign) in rows {
        let Some(facets) = mesh.facet_sets.get(name) else { continue };
        assert!(sign * total(mesh, facets)[axis] > 0.0, "{name}");
        assert!(mesh.nodes_of(name).unwrap().iter().all(|&n| mesh.nodes[n as usize][axis] == level), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn blocks(
        min in prop::array::uniform3(-3.0..3.0f64),
        size in prop::array::uniform3(0.1..5.0f64),
        n in prop::array::uniform3(1usize..5),
        grade in prop::array::uniform3(-2.0..2.0f64),
    ) {
        let max: [f64; 3] = std::array::from_fn(|i| min[i] + size[i]);
        let grading: [f64; 3] = std::array::from_fn(|i| if n[i] == 1 { 1.0 } else { grade[i].exp() });
        let mesh = Block { min, max, divisions: n, grading }.generate().unwrap();
        prop_assert_eq!(mesh.elements.len(), n[0] * n[1] * n[2]);
        prop_assert_eq!(mesh.nodes.len(), (n[0] + 1) * (n[1] + 1) * (n[2] + 1));
        prop_assert_eq!(mesh.bounding_box(), (min, max));
        battery(&mesh);
        sides(&mesh, n);
        let volume = size[0] * size[1] * size[2];
        prop_assert!((mesh.quality().volume - volume).abs() < 1e-12 * volume);
        // sizes along x: the last over the first is the grading, neighbours have one ratio
        let h: Vec<f64> = (0..n[0]).map(|i| mesh.nodes[i + 1][0] - mesh.nodes[i][0]).collect();
        prop_assert!((h[n[0] - 1] / h[0] - grading[0]).abs() < 1e-9 * grading[0]);
        for w in h.windows(3) {
            prop_assert!((w[1] * w[1] - w[0] * w[2]).abs() < 1e-9 * w[1] * w[1]);
        }
    }

    #[test]
    fn balls(inner in 0.1..0.95f64, n in 1usize..6, layers in 1usize..4) {
        let mesh = HollowBall { inner_diameter: inner, outer_diameter: 1.0, divisions: [n, layers] }.generate().unwrap();
        prop_assert_eq!(mesh.elements.len(), 6 * n * n * layers);
        prop_assert_eq!(mesh.nodes.len(), (6 * n * n + 2) * (layers + 1));
        battery(&mesh);
        for (name, radius) in [("outer", 0.5), ("inner", 0.5 * inner)] {
            prop_assert_eq!(mesh.facets_of(name).unwrap().len(), 6 * n * n);
            for node in mesh.nodes_of(name).unwrap() {
                prop_assert!((norm(mesh.nodes[node as usize]) - radius).abs() < 1e-15);
            }
        }
        prop_assert_eq!(mesh.boundary_facets().len(), 12 * n * n);
    }

    #[test]
    fn tori(tube in 0.1..0.9f64, hole in 0.1..0.9f64, nr in 3usize..12, nt in 3usize..8, nw in 1usize..3) {
        let (ring_radius, inner) = (2.0, 2.0 * tube * hole);
        let torus = HollowTorus {
            ring_radius,
            tube_outer_radius: 2.0 * tube,
            tube_inner_radius: inner,
            divisions: [nr, nt, nw],
        };
        let mesh = torus.generate().unwrap();
        prop_assert_eq!(mesh.elements.len(), nr * nt * nw);
        prop_assert_eq!(mesh.nodes.len(), nr * nt * (nw + 1));
        battery(&mesh);
        for (name, radius) in [("outer", 2.0 * tube), ("inner", inner)] {
            prop_assert_eq!(mesh.facets_of(name).unwrap().len(), nr * nt);
            for node in mesh.nodes_of(name).unwrap() {
                let [x, y, z] = mesh.nodes[node as usize];
                prop_assert!(((x.hypot(y) - ring_radius).hypot(z) - radius).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn l_blocks(n in prop::array::uniform4(1usize..4), arm in prop::array::uniform2(0.2..3.0f64), w in 0.2..2.0f64) {
        let length = arm.map(|a| a + w);
        let mesh = LBlock { length, width: w, thickness: 0.7, divisions: n }.generate().unwrap();
        prop_assert_eq!(mesh.elements.len(), (n[2] * n[2] + n[2] * (n[0] + n[1])) * n[3]);
        battery(&mesh);
        let volume = (w * w + w * (arm[0] + arm[1])) * 0.7;
        prop_assert!((mesh.quality().volume - volume).abs() < 1e-12 * volume);
        let t = |name: &str| total(&mesh, &mesh.facets_of(name).unwrap());
        prop_assert!((t("notch")[0] - arm[1] * 0.7).abs() < 1e-12 && (t("notch")[1] - arm[0] * 0.7).abs() < 1e-12);
        prop_assert!((t("end-x")[0] - w * 0.7).abs() < 1e-12 && (t("end-y")[1] - w * 0.7).abs() < 1e-12);
        let parts: usize = mesh.element_sets.values().map(Vec::len).sum();
        prop_assert_eq!(parts, mesh.elements.len());
        let named: usize = mesh.facet_sets.values().map(Vec::len).sum();
        prop_assert_eq!(named, mesh.boundary_facets().len());
    }

    #[test]
    fn solid_balls(n in 1usize..5, m in 1usize..5, r in 1usize..4, p in 0usize..4) {
        let (part, pieces) = PARTS[p];
        let mesh = Ball { radius: 1.5, part, divisions: [n, m, r], refinement: None }.generate().unwrap();
        prop_assert_eq!(mesh.elements.len(), pieces * (n * n * m + (n * n + 2 * n * m) * r));
        battery(&mesh);
        prop_assert_eq!(mesh.facets_of("outer").unwrap().len(), pieces * (n * n + 2 * n * m));
        for node in mesh.nodes_of("outer").unwrap() {
            prop_assert!((norm(mesh.nodes[node as usize]) - 1.5).abs() < 1e-14);
        }
        let names: Vec<&str> = mesh.facet_sets.keys().map(String::as_str).collect();
        let expected: &[&str] =
            [&["outer"][..], &["outer", "top"], &["left", "outer", "top"], &["front", "left", "outer", "top"]][p];
        prop_assert_eq!(names, expected);
        planes(&mesh, &[("top", 2, 1.0), ("left", 0, -1.0), ("front", 1, -1.0)], 0.0);
    }

    #[test]
    fn solid_cylinders(n in 1usize..5, m in 1usize..5, r in 1usize..4, l in 1usize..3, p in 0usize..3) {
        let (part, pieces) = [(Portion::Full, 4), (Portion::Half, 2), (Portion::Quarter, 1)][p];
        let cylinder = Cylinder { radius: 1.5, length: 0.7, part, divisions: [n, m, r, l], refinement: None };
        let mesh = cylinder.generate().unwrap();
        prop_assert_eq!(mesh.elements.len(), pieces * (n * m + (n + m) * r) * l);
        battery(&mesh);
        prop_assert_eq!(mesh.facets_of("outer").unwrap().len(), pieces * (n + m) * l);
        for node in mesh.nodes_of("outer").unwrap() {
            let [x, _, z] = mesh.nodes[node as usize];
            prop_assert!((x.hypot(z) - 1.5).abs() < 1e-14);
        }
        // Every piece of the section is a fan of triangles, n of one angle and m of another.
        let fan = |k: usize| 0.5 * 2.25 * k as f64 * (PI / 4.0 / k as f64).sin();
        let exact = pieces as f64 * (fan(n) + fan(m)) * 0.7;
        prop_assert!((mesh.quality().volume - exact).abs() < 1e-12 * exact);
        planes(&mesh, &[("top", 2, 1.0), ("left", 0, -1.0), ("front", 1, -1.0)], 0.0);
        planes(&mesh, &[("back", 1, 1.0)], 0.7);
        prop_assert_eq!(mesh.facet_sets.contains_key("left"), part == Portion::Quarter);
        prop_assert_eq!(mesh.facet_sets.contains_key("top"), part != Portion::Full);
    }

    /// Sizes along the surface from the lowest point: equal, then growing; the first element's depth is the same.
    #[test]
    fn refined_balls(elements in 1usize..8, beyond in 5usize..10, half_width in 0.01..0.2f64) {
        let refinement = Some(Refinement { half_width, elements });
        let n = elements + beyond;
        let ball = Ball { radius: 1.0, part: Portion::Eighth, divisions: [n, 2, 9], refinement };
        let mesh = ball.generate().unwrap();
        battery(&mesh);
        let mut angles: Vec<f64> = (mesh.nodes_of("outer").unwrap().iter())
            .map(|&k| mesh.nodes[k as usize])
            .filter(|x| x[1] == 0.0 && x[0] <= -x[2] + 1e-12)
            .map(|x| x[0].atan2(-x[2]))
            .collect();
        angles.sort_by(f64::total_cmp);
        prop_assert_eq!(angles.len(), n + 1);
        let sizes: Vec<f64> = angles.windows(2).map(|w| w[1] - w[0]).collect();
        let size = half_width / elements as f64;
        prop_assert!(sizes[..elements].iter().all(|s| (s - size).abs() < 1e-12));
        let ratio = sizes[elements] / size;
        prop_assert!(sizes[elements..].windows(2).all(|w| (w[1] / w[0] / ratio - 1.0).abs() < 1e-6));
        let mut depth: Vec<f64> =
            mesh.nodes.iter().filter(|x| x[0] == 0.0 && x[1] == 0.0).map(|x| 1.0 + x[2]).collect();
        depth.sort_by(f64::total_cmp);
        prop_assert!(depth[0].abs() < 1e-15 && (depth[1] - size).abs() < 1e-12);
    }

    /// Bad numbers are errors, never a panic or a bad mesh.
    #[test]
    fn any_parameters_give_a_good_mesh_or_an_error(
        a in prop::array::uniform6(prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(0.0), Just(-1.0), Just(1e300), Just(1e-300), 0.1..3.0f64,
        ]),
        n in prop::array::uniform4(prop_oneof![Just(0usize), Just(usize::MAX), Just(1usize << 33), 1usize..4]),
        grading in prop::array::uniform3(prop_oneof![Just(f64::NAN), Just(0.0), Just(1.0), 0.5..2.0f64]),
    ) {
        let [n0, n1, n2, n3] = n;
        let d3 = [n0, n1, n2];
        let results = [
            Block { min: [a[0], a[1], a[2]], max: [a[3], a[4], a[5]], divisions: d3, grading }.generate(),
            Indenter { width: [a[0], a[1]], height: a[2], radius: a[3], divisions: d3, grading }.generate(),
            HollowBall { inner_diameter: a[0], outer_diameter: a[1], divisions: [n0, n1] }.generate(),
            HollowTorus { ring_radius: a[0], tube_outer_radius: a[1], tube_inner_radius: a[2], divisions: d3 }.generate(),
            LBlock { length: [a[0], a[1]], width: a[2], thickness: a[3], divisions: [n0, n1, n2, n3] }.generate(),
            Ball { radius: a[0], part: Portion::Quarter, divisions: d3, refinement: None }.generate(),
            Ball {
                radius: a[0],
                part: Portion::Eighth,
                divisions: d3,
                refinement: Some(Refinement { half_width: a[1], elements: n3 }),
            }
            .generate(),
            Cylinder {
                radius: a[0],
                length: a[2],
                part: Portion::Full,
                divisions: n,
                refinement: Some(Refinement { half_width: a[1], elements: n3 }),
            }
            .generate(),
        ];
        for mesh in results.into_iter().flatten() {
            prop_assert!(mesh.quality().inverted_elements == 0);
        }
    }
}

/// The ball of theory/examples#ball-plate: 432 elements, 654 nodes; the volume approaches that of the shell from below at second order.
#[test]
fn ball_of_the_ball_on_plate_example() {
    let ball =
        |n: usize| HollowBall { inner_diameter: 0.8, outer_diameter: 1.0, divisions: [n, n / 3] }.generate().unwrap();
    let mesh = ball(6);
    assert_eq!((mesh.elements.len(), mesh.nodes.len()), (432, 654));
    let exact = PI / 6.0 * (1.0 - 0.8f64.powi(3));
    let error = |n| 1.0 - ball(n).quality().volume / exact;
    let (coarse, fine) = (error(6), error(12));
    assert!(coarse > 0.0 && (3.7..4.3).contains(&(coarse / fine)), "{coarse} {fine}");
    // bit for bit its own mirror image in each coordinate plane
    for axis in 0..3 {
        let sorted = |sign: f64| {
            let mut points: Vec<[f64; 3]> = mesh.nodes.clone();
            points.iter_mut().for_each(|x| x[axis] = sign * x[axis] + 0.0);
            points.sort_by(|a, b| a.partial_cmp(b).unwrap());
            points
        };
        assert_eq!(sorted(1.0), sorted(-1.0));
    }
}

/// Volumes approach those of the round bodies from below at second order, and all parts have their share.
#[test]
fn round_volumes_converge() {
    let ball = |k: usize, part| {
        Ball { radius: 2.0, part, divisions: [3 * k, 2 * k, 2 * k], refinement: None }
            .generate()
            .unwrap()
            .quality()
            .volume
    };
    for (part, pieces) in PARTS {
        let exact = 4.0 / 3.0 * PI * 8.0 * pieces as f64 / 8.0;
        let (coarse, fine) = (1.0 - ball(1, part) / exact, 1.0 - ball(2, part) / exact);
        assert!(fine > 0.0 && fine < 0.02 && (3.6..4.4).contains(&(coarse / fine)), "{part:?} {coarse} {fine}");
    }
    let cylinder = |k: usize| {
        let cylinder = Cylinder {
            radius: 2.0,
            length: 3.0,
            part: Portion::Half,
            divisions: [3 * k, 2 * k, k, 1],
            refinement: None,
        };
        1.0 - cylinder.generate().unwrap().quality().volume / (6.0 * PI)
    };
    let (coarse, fine) = (cylinder(1), cylinder(2));
    assert!(fine > 0.0 && (3.9..4.1).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// A contact of 0.02 radii in 10 elements: no element is turned over, and what cannot be reached is an error.
#[test]
fn strongly_refined_round_bodies() {
    let refinement = Some(Refinement { half_width: 0.024, elements: 12 });
    let cylinder = Cylinder { radius: 1.0, length: 0.01, part: Portion::Half, divisions: [30, 4, 18, 1], refinement };
    let mesh = cylinder.generate().unwrap();
    battery(&mesh);
    let near = mesh.nodes_of("outer").unwrap().iter().filter(|&&n| mesh.nodes[n as usize][0].abs() < 0.0201).count();
    assert_eq!(near, 2 * 21);
    let few = Cylinder { divisions: [14, 4, 18, 1], ..cylinder };
    assert!(matches!(few.generate(), Err(MeshError::Parameter { parameter: "divisions", .. })));
    let shallow = Cylinder { divisions: [30, 4, 2, 1], ..cylinder };
    assert!(matches!(shallow.generate(), Err(MeshError::Parameter { parameter: "divisions", .. })));
    let many = Cylinder { divisions: [12, 4, 18, 1], ..cylinder };
    assert!(matches!(many.generate(), Err(MeshError::Parameter { parameter: "elements", .. })));
    let eighth = Cylinder { part: Portion::Eighth, ..cylinder };
    assert!(matches!(eighth.generate(), Err(MeshError::Parameter { parameter: "part", .. })));
}

/// The torus of theory/examples#tori: 3120 elements of which edges are about 3.06 x 3.77 x 2.25 on the outer middle line.
#[test]
fn torus_of_the_two_tori_example() {
    let torus =
        HollowTorus { ring_radius: 38.0, tube_outer_radius: 12.0, tube_inner_radius: 7.5, divisions: [78, 20, 2] };
    let mesh = torus.generate().unwrap();
    assert_eq!(mesh.elements.len(), 3120);
    battery(&mesh);
    let (min, max) = mesh.bounding_box();
    // outer diameter 100; x and z extremes are nodes exactly (78 and 20 divide by 2 and 4)
    assert_eq!((min[0], max[0], min[2], max[2]), (-50.0, 50.0, -12.0, 12.0));
    let exact = 2.0 * PI * PI * 38.0 * (12.0 * 12.0 - 7.5 * 7.5);
    let volume = mesh.quality().volume;
    assert!(volume < exact && volume > 0.97 * exact);
}

/// The indenter of theory/examples#rotating-indenter.
#[test]
fn indenter_of_the_rotating_indenter_example() {
    let mesh = Indenter::literature().generate().unwrap();
    assert_eq!(mesh.elements.len(), 700);
    battery(&mesh);
    sides(&mesh, [10, 10, 7]);
    for n in mesh.nodes_of("bottom").unwrap() {
        let [x, y, z] = mesh.nodes[n as usize];
        assert!((x * x + y * y + (z - 2.0) * (z - 2.0) - 4.0).abs() < 1e-14 && z < 1.0);
    }
    assert!(mesh.nodes_of("top").unwrap().iter().all(|&n| mesh.nodes[n as usize][2] == 1.5));
    let flat = Indenter { height: 0.5, ..Indenter::literature() };
    assert!(matches!(flat.generate(), Err(MeshError::Parameter { parameter: "height", .. })));
    let sharp = Indenter { radius: 1.2, ..Indenter::literature() };
    assert!(matches!(sharp.generate(), Err(MeshError::Parameter { parameter: "radius", .. })));
}

/// The lower block of theory/examples#two-elements. Its plan is a quadrilateral whose area the shoelace formula gives.
#[test]
fn lower_block_of_the_two_element_example() {
    let plan = [[-1.0, -1.0], [1.0, -1.0], [1.2, 1.0], [-1.5, 1.5]];
    let corners = std::array::from_fn(|i| [plan[i % 4][0], plan[i % 4][1], if i < 4 { 0.0 } else { 1.0 }]);
    let shoelace: f64 =
        (0..4).map(|i| plan[i][0] * plan[(i + 1) % 4][1] - plan[(i + 1) % 4][0] * plan[i][1]).sum::<f64>() / 2.0;
    let single = Hexahedron::new(corners, [1; 3]).generate().unwrap();
    assert_eq!(single.elements.len(), 1);
    for n in [[1, 1, 1], [3, 2, 4]] {
        let mesh = Hexahedron::new(corners, n).generate().unwrap();
        battery(&mesh);
        sides(&mesh, n);
        assert!((mesh.quality().volume - shoelace).abs() < 1e-13);
    }
    // together with the unit cube above it: mass 6250 at density 1000
    assert!((1000.0 * (shoelace + 1.0) - 6250.0).abs() < 1e-9);
    let mut twisted = corners;
    twisted.swap(0, 1);
    let error = Hexahedron::new(twisted, [1; 3]).generate().unwrap_err();
    assert!(matches!(error, MeshError::InvertedElement { element: 0, .. }));
}

#[test]
fn maps_keep_the_sets_and_check_the_orientation() {
    let n = [3, 2, 2];
    let block = || Block::with_size([1.0, 1.0, 1.0], n).generate().unwrap();
    let sheared = block().map(|[x, y, z]| [x + 0.5 * z * z, y, z]).unwrap();
    battery(&sheared);
    sides(&sheared, n);
    assert!(matches!(block().map(|[x, y, z]| [-x, y, z]), Err(MeshError::InvertedElement { .. })));
    assert!(matches!(block().map(|[x, y, _]| [x, y, 1.0 / (x - x)]), Err(MeshError::NonFiniteNode { .. })));
}

#[test]
fn errors_name_parameter_value_and_remedy() {
    let ball = HollowBall { inner_diameter: 1.0, outer_diameter: 1.0, divisions: [6, 2] };
    assert_eq!(
        ball.generate().unwrap_err().to_string(),
        "inner_diameter = 1.0: must be smaller than outer_diameter = 1"
    );
    let huge = Block::with_size([1.0; 3], [1000; 3]).generate().unwrap_err();
    assert!(matches!(huge, MeshError::TooLarge { .. }) && huge.to_string().contains("1000"));
    let zero = Block::with_size([1.0; 3], [4, 0, 4]).generate().unwrap_err().to_string();
    assert_eq!(zero, "divisions = [4, 0, 4]: entry 2 must be at least 1");
    let thick = HollowTorus { ring_radius: 1.0, tube_outer_radius: 1.5, tube_inner_radius: 1.0, divisions: [8, 8, 1] };
    assert!(matches!(thick.generate(), Err(MeshError::Parameter { parameter: "tube_outer_radius", .. })));
    let few = HollowTorus { ring_radius: 2.0, tube_outer_radius: 1.5, tube_inner_radius: 1.0, divisions: [8, 2, 1] };
    assert!(matches!(few.generate(), Err(MeshError::Parameter { parameter: "divisions", .. })));
    let graded = Block { grading: [2.0, 1.0, 1.0], ..Block::with_size([1.0; 3], [1, 2, 2]) };
    assert!(matches!(graded.generate(), Err(MeshError::Parameter { parameter: "grading", .. })));
}
