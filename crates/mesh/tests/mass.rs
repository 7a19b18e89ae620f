//! Mass properties: closed forms against surfaces and meshes, invariance, conversions.

use proptest::prelude::*;
use stoss_mesh::generate::{Ball, Block, Hexahedron, HollowBall, Portion};
use stoss_mesh::surface::{Cone, Cuboid, Cylinder, Plane, RoundDivisions, Sphere};
use stoss_mesh::{MassProperties, Mesh, MeshError, Rotation, SurfaceMesh};
use stoss_reference_element::FacetNodes;

type Matrix = [[f64; 3]; 3];

fn matrix(entry: impl Fn(usize, usize) -> f64) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    matrix(|i, j| (0..3).map(|k| a[i][k] * b[k][j]).sum())
}

fn transposed(a: &Matrix) -> Matrix {
    matrix(|i, j| a[j][i])
}

/// Largest difference in mass, centre and Euler tensor: relative to the mass, to the radius of gyration, to the trace.
fn difference(a: &MassProperties, b: &MassProperties) -> f64 {
    let trace: f64 = (0..3).map(|i| b.euler[i][i]).sum();
    let gyration = (trace / b.mass).sqrt();
    let centre = (0..3).map(|i| (a.centre[i] - b.centre[i]).abs() / gyration);
    let euler = (0..9).map(|k| (a.euler[k / 3][k % 3] - b.euler[k / 3][k % 3]).abs() / trace);
    centre.chain(euler).fold((a.mass / b.mass - 1.0).abs(), f64::max)
}

/// A body moved: `c -> R (c - p) + p + t`, `E -> R E R^T`.
fn moved(m: &MassProperties, rotation: &Rotation, shift: [f64; 3]) -> MassProperties {
    let (r, p) = (rotation.matrix().unwrap(), rotation.about);
    let centre = std::array::from_fn(|i| (0..3).map(|k| r[i][k] * (m.centre[k] - p[k])).sum::<f64>() + p[i] + shift[i]);
    MassProperties { mass: m.mass, centre, euler: product(&product(&r, &m.euler), &transposed(&r)) }
}

fn round(around: u32) -> RoundDivisions {
    RoundDivisions { around, along: around / 4, radial: around / 8 }
}

#[test]
fn unit_tetrahedron() {
    // int dV = 1/6, int x = 1/24, int x^2 = 1/60, int x y = 1/120 over the simplex
    let x = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let facets = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|f: [u32; 3]| f.into());
    let surface = SurfaceMesh::new(x, facets.to_vec()).unwrap();
    let expected = MassProperties {
        mass: 0.5,
        centre: [0.25; 3],
        euler: matrix(|i, j| 3.0 * (if i == j { 1.0 / 60.0 } else { 1.0 / 120.0 } - 1.0 / 96.0)),
    };
    assert!(difference(&MassProperties::of_surface(&surface, 3.0).unwrap(), &expected) < 1e-15);
}

#[test]
fn boxes_are_exact() {
    let size = [1.0, 2.5, 0.3];
    let exact = MassProperties::of_cuboid(size, 7.0).unwrap();
    assert!((exact.mass - 7.0 * 0.75).abs() < 1e-14);
    // moments of inertia of a box: m (b^2 + c^2) / 12
    let inertia = exact.inertia();
    assert!((inertia[0][0] - 5.25 * (6.25 + 0.09) / 12.0).abs() < 1e-14);
    let surface = Cuboid { size, divisions: [3, 2, 4] }.generate().unwrap();
    let mesh = Block { grading: [3.0, 1.0, 0.5], ..Block::with_size(size, [3, 2, 4]) }.generate().unwrap();
    assert!(difference(&MassProperties::of_surface(&surface, 7.0).unwrap(), &exact) < 1e-14);
    assert!(difference(&MassProperties::of_mesh(&mesh, 7.0).unwrap(), &exact) < 1e-14);
}

/// A frustum of a pyramid over a square, from half width `a` at z = 0 to `b` at z = h: all faces are plane, the map is not affine.
#[test]
fn frustum_of_a_pyramid() {
    let (a, b, h) = (1.0, 0.4, 1.5);
    let corners = std::array::from_fn(|k| {
        let v = stoss_reference_element::hex8::VERTICES[k];
        let w = if v[2] > 0.0 { b } else { a };
        [w * v[0], w * v[1], if v[2] > 0.0 { h } else { 0.0 }]
    });
    // with w = a + (b - a) s: V = 4 h int w^2 ds, int z = 4 h^2 int s w^2 ds, int z^2 = 4 h^3 int s^2 w^2 ds, int x^2 = 4/3 h int w^4 ds
    let d = b - a;
    let volume = 4.0 * h * (a * a + a * d + d * d / 3.0);
    let first = 4.0 * h * h * (a * a / 2.0 + 2.0 * a * d / 3.0 + d * d / 4.0);
    let second = 4.0 * h * h * h * (a * a / 3.0 + a * d / 2.0 + d * d / 5.0);
    let across = 4.0 / 3.0 * h * (b.powi(5) - a.powi(5)) / (5.0 * d);
    let centre = first / volume;
    let along = second - volume * centre * centre;
    let exact = MassProperties {
        mass: 2.0 * volume,
        centre: [0.0, 0.0, centre],
        euler: matrix(|i, j| if i != j { 0.0 } else { 2.0 * [across, across, along][i] }),
    };
    for divisions in [[1; 3], [2, 3, 4]] {
        let mesh = Hexahedron::new(corners, divisions).generate().unwrap();
        let surface = SurfaceMesh::from_mesh(&mesh).unwrap();
        assert!(difference(&MassProperties::of_mesh(&mesh, 2.0).unwrap(), &exact) < 1e-14);
        assert!(difference(&MassProperties::of_surface(&surface, 2.0).unwrap(), &exact) < 1e-14);
    }
}

/// Errors of three sizes, each half of the one before, fall by four.
fn second_order(name: &str, exact: MassProperties, of: impl Fn(u32) -> MassProperties) {
    let errors: Vec<f64> = [16, 32, 64].map(|n| difference(&of(n), &exact)).to_vec();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "{name}: {errors:?}");
    }
    assert!(errors[2] < 0.01, "{name}: {errors:?}");
}

#[test]
fn round_shapes_converge_at_second_order() {
    let density = 1.3;
    let of = |s: Result<SurfaceMesh, MeshError>| MassProperties::of_surface(&s.unwrap(), density).unwrap();
    let sphere = MassProperties::of_sphere(0.8, density).unwrap();
    second_order("sphere", sphere, |n| of(Sphere { radius: 0.8, divisions: n / 4 }.generate()));
    second_order("ball", sphere, |n| {
        let divisions = [n as usize / 8, n as usize / 8, 2];
        let ball = Ball { radius: 0.8, part: Portion::Full, divisions, refinement: None };
        MassProperties::of_mesh(&ball.generate().unwrap(), density).unwrap()
    });
    second_order("cylinder", MassProperties::of_cylinder(0.8, 2.0, density).unwrap(), |n| {
        of(Cylinder { radius: 0.8, length: 2.0, divisions: round(n) }.generate())
    });
    for tip_radius in [0.0, 0.1, 0.7] {
        let exact = MassProperties::of_cone(0.8, 2.0, tip_radius, density).unwrap();
        second_order(&format!("cone {tip_radius}"), exact, |n| {
            of(Cone { radius: 0.8, height: 2.0, tip_radius, divisions: round(n) }.generate())
        });
    }
    // a hollow ball is a ball less a ball
    let (outer, inner) =
        (MassProperties::of_sphere(1.0, density).unwrap(), MassProperties::of_sphere(0.5, density).unwrap());
    let hollow = MassProperties {
        mass: outer.mass - inner.mass,
        centre: [0.0; 3],
        euler: matrix(|i, j| outer.euler[i][j] - inner.euler[i][j]),
    };
    let mesh = |n: u32| {
        HollowBall { inner_diameter: 1.0, outer_diameter: 2.0, divisions: [n as usize / 4, 2] }.generate().unwrap()
    };
    second_order("hollow ball", hollow, |n| MassProperties::of_mesh(&mesh(n), density).unwrap());
    second_order("its surface", hollow, |n| of(SurfaceMesh::from_mesh(&mesh(n))));
}

/// The closed forms themselves, by the midpoint rule over discs of the solids of revolution.
#[test]
fn closed_forms_of_revolution_by_discs() {
    let discs = |h: f64, from: f64, radius: &dyn Fn(f64) -> f64| {
        let n = 200_000;
        let dz = h / f64::from(n);
        let (mut v, mut first, mut second, mut across) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..n {
            let z = (f64::from(i) + 0.5) * dz;
            let area = std::f64::consts::PI * radius(from + z).powi(2);
            v += area * dz;
            first += area * z * dz;
            second += area * z * z * dz;
            across += area * radius(from + z).powi(2) / 4.0 * dz;
        }
        let c = first / v;
        let along = second - v * c * c;
        MassProperties {
            mass: v,
            centre: [0.0, 0.0, from + c],
            euler: matrix(|i, j| if i == j { [across, across, along][i] } else { 0.0 }),
        }
    };
    for tip in [0.0, 0.3, 0.8] {
        let exact = MassProperties::of_cone(0.9, 1.7, tip, 1.0).unwrap();
        assert!(difference(&exact, &discs(1.7, 0.0, &|z| tip + (0.9 - tip) * z / 1.7)) < 1e-9);
    }
    let cylinder = MassProperties::of_cylinder(0.9, 1.7, 1.0).unwrap();
    assert!(difference(&cylinder, &discs(1.7, -0.85, &|_| 0.9)) < 1e-9);
    let sphere = MassProperties::of_sphere(0.9, 1.0).unwrap();
    assert!(difference(&sphere, &discs(1.8, -0.9, &|z| (0.81 - z * z).max(0.0).sqrt())) < 1e-9);
    // known moments of inertia: 2/5 m r^2, m (3 r^2 + l^2) / 12 and m r^2 / 2, of a whole cone 3/10 m r^2
    assert!((sphere.inertia()[0][0] / sphere.mass - 0.4 * 0.81).abs() < 1e-15);
    assert!((cylinder.inertia()[0][0] / cylinder.mass - (3.0 * 0.81 + 1.7 * 1.7) / 12.0).abs() < 1e-15);
    assert!((cylinder.inertia()[2][2] / cylinder.mass - 0.5 * 0.81).abs() < 1e-15);
    let cone = MassProperties::of_cone(0.9, 1.7, 0.0, 2.0).unwrap();
    assert!((cone.inertia()[2][2] / cone.mass - 0.3 * 0.81).abs() < 1e-15);
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-2.0..2.0)
}

/// Half a cone and the like have no symmetry: a mixed surface without any.
fn lopsided() -> SurfaceMesh {
    let mut surface = Cone {
        radius: 1.0,
        height: 1.5,
        tip_radius: 0.0,
        divisions: RoundDivisions { around: 7, along: 2, radial: 2 },
    }
    .generate()
    .unwrap();
    for x in &mut surface.nodes {
        x[0] += 0.3 * x[1] * x[1] + 0.2 * x[2];
        x[1] -= 0.1 * x[0] * x[2];
    }
    surface
}

proptest! {
    /// `m`, `R c + t`, `R E R^T`, for surfaces and meshes.
    #[test]
    fn rigid_motion(axis in vector(), degrees in -180.0..180.0, about in vector(), shift in vector()) {
        prop_assume!(axis.iter().any(|a| a.abs() > 1e-3));
        let rotation = Rotation { axis, degrees, about };
        let mut surface = lopsided();
        let before = MassProperties::of_surface(&surface, 1.7).unwrap();
        surface.transform(Some(&rotation), shift).unwrap();
        let after = MassProperties::of_surface(&surface, 1.7).unwrap();
        prop_assert!(difference(&after, &moved(&before, &rotation, shift)) < 1e-13);

        let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.2], [1.2, 1.1, 0.0], [0.0, 0.9, 0.1], [0.1, 0.0, 1.0], [0.9, 0.0, 1.1], [1.0, 1.0, 0.8], [0.0, 1.3, 1.0]];
        let mut mesh = Hexahedron::new(corners, [2, 1, 1]).generate().unwrap();
        let before = MassProperties::of_mesh(&mesh, 1.7).unwrap();
        mesh.transform(Some(&rotation), shift).unwrap();
        let after = MassProperties::of_mesh(&mesh, 1.7).unwrap();
        prop_assert!(difference(&after, &moved(&before, &rotation, shift)) < 1e-13);
    }

    /// An affine map of a box: `m det A`, `A c + b`, `det A A E A^T`, exactly for surface and mesh.
    #[test]
    fn parallelepipeds_are_exact(a in prop::array::uniform9(-0.4..0.4), b in vector()) {
        let a = matrix(|i, j| a[3 * i + j] + if i == j { 1.0 } else { 0.0 });
        let map = |x: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| b[i] + (0..3).map(|k| a[i][k] * x[k]).sum::<f64>()) };
        let det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
            + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
        prop_assume!(det > 0.05);
        let size = [1.0, 0.7, 1.9];
        let cuboid = MassProperties::of_cuboid(size, 2.0).unwrap();
        let exact = MassProperties {
            mass: det * cuboid.mass,
            centre: b,
            euler: product(&product(&a, &cuboid.euler), &transposed(&a)).map(|row| row.map(|e| det * e)),
        };
        let mut surface = Cuboid { size, divisions: [1, 2, 3] }.generate().unwrap();
        surface.nodes.iter_mut().for_each(|x| *x = map(*x));
        let mesh = Block::with_size(size, [1, 2, 2]).generate().unwrap().map(map).unwrap();
        prop_assert!(difference(&MassProperties::of_surface(&surface, 2.0).unwrap(), &exact) < 1e-13);
        prop_assert!(difference(&MassProperties::of_mesh(&mesh, 2.0).unwrap(), &exact) < 1e-13);
    }

    /// General hexahedra with curved faces: the volume below four triangles is that below the bilinear facet; `from_inertia` undoes `inertia`; the
    /// sum of the parts of a mesh is the whole.
    #[test]
    fn general_hexahedra(moves in prop::collection::vec(-0.12..0.12, 24), start in 0u32..4) {
        let corners = std::array::from_fn(|k| {
            let v = stoss_reference_element::hex8::VERTICES[k];
            std::array::from_fn(|i| 0.5 * v[i] + moves[3 * k + i])
        });
        let mesh = Hexahedron::new(corners, [1; 3]).generate().unwrap();
        let whole = MassProperties::of_mesh(&mesh, 1.0).unwrap();
        let mut surface = SurfaceMesh::from_mesh(&mesh).unwrap();
        let inside = MassProperties::of_surface(&surface, 1.0).unwrap();
        prop_assert!((inside.mass / whole.mass - 1.0).abs() < 1e-14);
        // where the numbering of a facet starts is of no importance
        for facet in &mut surface.facets {
            let nodes = *facet;
            *facet = FacetNodes::from_fn(nodes.kind(), |k| nodes[(k + start as usize) % 4]);
        }
        prop_assert!(difference(&MassProperties::of_surface(&surface, 1.0).unwrap(), &inside) < 1e-14);

        // the same trilinear solid cut in eight: its parts have the same moments, so the rule is exact for them
        let parts = Hexahedron::new(corners, [2; 3]).generate().unwrap();
        prop_assert!(difference(&MassProperties::of_mesh(&parts, 1.0).unwrap(), &whole) < 1e-13);
    }
}

/// Far away from the origin only the coordinates' own round-off is lost.
#[test]
fn far_away() {
    let mut surface = Sphere { radius: 1.0, divisions: 6 }.generate().unwrap();
    let near = MassProperties::of_surface(&surface, 1.0).unwrap();
    surface.transform(None, [1e6, -1e6, 1e6]).unwrap();
    let mut far = MassProperties::of_surface(&surface, 1.0).unwrap();
    far.centre = [far.centre[0] - 1e6, far.centre[1] + 1e6, far.centre[2] - 1e6];
    assert!(difference(&far, &near) < 1e-9, "{}", difference(&far, &near));
}

#[test]
fn errors_are_named() {
    let sphere = Sphere { radius: 1.0, divisions: 2 }.generate().unwrap();
    for density in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let named = |r: Result<MassProperties, MeshError>| {
            assert!(matches!(r, Err(MeshError::Parameter { parameter: "density", .. })))
        };
        named(MassProperties::of_surface(&sphere, density));
        named(MassProperties::of_mesh(&Mesh::default(), density));
        named(MassProperties::of_sphere(1.0, density));
        named(MassProperties::of_cuboid([1.0; 3], density));
        named(MassProperties::of_cylinder(1.0, 1.0, density));
        named(MassProperties::of_cone(1.0, 1.0, 0.0, density));
    }
    let mut open = sphere.clone();
    open.facets.pop();
    let error = MassProperties::of_surface(&open, 1.0).unwrap_err();
    assert!(matches!(error, MeshError::OpenSurface { count: 4, .. }));
    assert!(error.to_string().contains("4 edges"), "{error}");
    let turned = sphere.clone().flipped();
    assert!(matches!(MassProperties::of_surface(&turned, 1.0), Err(MeshError::Volume { volume }) if volume < 0.0));
    let plane = Plane { size: [1.0; 2], divisions: [1; 2] }.generate().unwrap();
    let mut two_sided = plane.clone();
    two_sided.facets.extend(plane.clone().flipped().facets);
    assert_eq!(MassProperties::of_surface(&two_sided, 1.0), Err(MeshError::Volume { volume: 0.0 }));
    assert_eq!(MassProperties::of_surface(&SurfaceMesh::default(), 1.0), Err(MeshError::NoFacets));
    assert_eq!(MassProperties::of_mesh(&Mesh::default(), 1.0), Err(MeshError::NoElements));
    for radius in [1e-200, 1e200] {
        assert!(matches!(MassProperties::of_sphere(radius, 1.0), Err(MeshError::Volume { .. })));
        let sphere = Sphere { radius, divisions: 2 }.generate().unwrap();
        assert!(matches!(MassProperties::of_surface(&sphere, 1.0), Err(MeshError::Volume { .. })));
    }
    let mut nan = sphere;
    nan.nodes[3][0] = f64::NAN;
    assert!(matches!(MassProperties::of_surface(&nan, 1.0), Err(MeshError::Volume { .. })));
    assert!(MassProperties::of_cone(1.0, 1.0, 1.0, 1.0).is_err());
}
