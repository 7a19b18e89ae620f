//! Probes of stress and strain at material points, and extrema over nodes, against closed forms.

use std::path::Path;
use stoss::build::{Built, Probe, build};

const LAMBDA: f64 = 7.0;
const MU: f64 = 3.0;
const SHEAR: f64 = 0.3;
const STRETCH: f64 = 0.2;

fn built(rest: &str) -> Result<Built, String> {
    let text = format!(
        r#"
[scene]
title = "block"
kind = "quasi-static"
[solver]
polish = true
[time]
end = 1.0
step = 0.25
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 2, 3], divisions = [2, 2, 2] }}
material = {{ law = "saint-venant-kirchhoff", lambda = {LAMBDA}, mu = {MU} }}
{rest}
"#
    );
    let scene = stoss::scene::parse(&text, "test.toml").map_err(|errors| errors.to_string())?;
    build(&scene, Path::new(".")).map_err(|errors| errors.to_string())
}

fn values(built: &Built, name: &str) -> Vec<f64> {
    built.probes.iter().find(|probe: &&Probe| probe.name == name).unwrap().values(&built.simulation)
}

fn run(rest: &str) -> Built {
    let mut built = built(rest).unwrap_or_else(|errors| panic!("{errors}"));
    while !built.simulation.finished() {
        built.simulation.advance().unwrap();
        built.schedule.events(&mut built.simulation, &built.probes).unwrap();
    }
    built
}

/// `x = X + SHEAR Z/3`, `z = (1 + STRETCH) Z` on the boundary: in the middle equilibrium gives it.
fn sheared() -> String {
    [("z = 0", 0.0), ("z = 1.5", 0.5), ("z = 3", 1.0)]
        .map(|(plane, part)| {
            let end = [part * SHEAR * 3.0, 0.0, part * STRETCH * 3.0];
            format!(
                "[[prescribe]]\nname = \"at-{:.0}\"\nset = \"block.boundary & {plane}\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = {{ table = [[0, 0, 0, 0], [1, {}, {}, {}]] }}\n",
                2.0 * part, end[0], end[1], end[2]
            )
        })
        .concat()
}

/// `E = (F^T F - 1)/2`, `S = lambda tr E 1 + 2 mu E`, `F S F^T / J`.
fn exact() -> ([[f64; 3]; 3], [[f64; 3]; 3], [[f64; 3]; 3]) {
    type M = [[f64; 3]; 3];
    let product =
        |a: M, b: M| -> M { std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum())) };
    let transposed = |a: M| -> M { std::array::from_fn(|i| std::array::from_fn(|j| a[j][i])) };
    let f = [[1.0, 0.0, SHEAR], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0 + STRETCH]];
    let c = product(transposed(f), f);
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let e: M = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (c[i][j] - unit(i, j))));
    let trace = e[0][0] + e[1][1] + e[2][2];
    let s: M = std::array::from_fn(|i| std::array::from_fn(|j| LAMBDA * trace * unit(i, j) + 2.0 * MU * e[i][j]));
    let sigma = product(product(f, s), transposed(f)).map(|row| row.map(|x| x / (1.0 + STRETCH)));
    (f, e, sigma)
}

fn components(m: [[f64; 3]; 3]) -> Vec<f64> {
    vec![m[0][0], m[1][1], m[2][2], m[0][1], m[1][2], m[0][2]]
}

fn mises(s: [[f64; 3]; 3]) -> f64 {
    let normal = (s[0][0] - s[1][1]).powi(2) + (s[1][1] - s[2][2]).powi(2) + (s[2][2] - s[0][0]).powi(2);
    (0.5 * normal + 3.0 * (s[0][1].powi(2) + s[1][2].powi(2) + s[0][2].powi(2))).sqrt()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?} is not {expected:?}");
}

#[test]
fn a_homogeneous_deformation_has_the_stress_of_the_law_everywhere() {
    let quantities = [
        "cauchy_stress",
        "green_lagrange_strain",
        "von_mises",
        "deformation_gradient",
        "principal_stresses",
        "logarithmic_strain",
    ];
    let mut rest = sheared();
    for (k, point) in ["[0.3, 1.7, 2.2]", "[1, 2, 3]", "[0.5, 1, 1.5]"].iter().enumerate() {
        for quantity in quantities {
            let name = format!("{quantity}-{k}");
            rest += &format!(
                "[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nbody = \"block\"\npoint = {point}\n"
            );
        }
    }
    for (reduce, quantity, more) in [
        ("max", "von_mises", ""),
        ("min", "von_mises", ""),
        ("min", "cauchy_stress", "component = \"xz\"\n"),
        ("max", "principal_stresses", ""),
        ("max", "green_lagrange_strain", ""),
        ("min", "green_lagrange_strain", "component = \"xz\"\n"),
        ("max", "logarithmic_strain", ""),
        ("min", "logarithmic_strain", ""),
    ] {
        rest += &format!(
            "[[probe]]\nname = \"{reduce}-{quantity}\"\nquantity = \"{quantity}\"\nreduce = \"{reduce}\"\nbody = \"block\"\n{more}"
        );
    }
    let built = run(&rest);
    let (f, e, sigma) = exact();
    for k in 0..3 {
        close(&values(&built, &format!("cauchy_stress-{k}")), &components(sigma));
        close(&values(&built, &format!("green_lagrange_strain-{k}")), &components(e));
        close(&values(&built, &format!("von_mises-{k}")), &[mises(sigma)]);
        close(&values(&built, &format!("deformation_gradient-{k}")), &f.concat());
    }
    for name in ["max-von_mises", "min-von_mises"] {
        close(&values(&built, name)[..1], &[mises(sigma)]);
    }
    close(&values(&built, "min-cauchy_stress")[..1], &[sigma[0][2]]);
    close(&values(&built, "min-green_lagrange_strain")[..1], &[e[0][2]]);
    // The eigenvalues of E are those of (C - 1)/2, and those of ln V half the logarithms of those of C.
    let eigenvalues = |m: [[f64; 3]; 3]| {
        let matrix = stoss::tensor::Tensor2::from_fn(|i, j| m[i][j]);
        let values = matrix.symmetric_eigenvalues();
        [values.max(), values.min()]
    };
    let [largest, smallest] = eigenvalues(e);
    close(&values(&built, "max-principal_stresses")[..1], &eigenvalues(sigma)[..1]);
    close(&values(&built, "max-green_lagrange_strain")[..1], &[largest]);
    close(&values(&built, "max-logarithmic_strain")[..1], &[0.5 * (1.0 + 2.0 * largest).ln()]);
    close(&values(&built, "min-logarithmic_strain")[..1], &[0.5 * (1.0 + 2.0 * smallest).ln()]);
    for k in 0..3 {
        let [first, last] = eigenvalues(sigma);
        let principal = values(&built, &format!("principal_stresses-{k}"));
        close(&[principal[0], principal[2]], &[first, last]);
        let strain = values(&built, &format!("logarithmic_strain-{k}"));
        close(&[strain[..3].iter().sum::<f64>()], &[(1.0 + STRETCH).ln()]);
    }
    let columns: Vec<String> = built.probes.iter().flat_map(Probe::columns).collect();
    assert_eq!(
        columns[..7].join(","),
        "cauchy_stress-0.xx,cauchy_stress-0.yy,cauchy_stress-0.zz,cauchy_stress-0.xy,cauchy_stress-0.yz,cauchy_stress-0.xz,green_lagrange_strain-0.xx"
    );
    assert_eq!(columns[columns.len() - 2..], ["min-logarithmic_strain", "min-logarithmic_strain.node"]);
}

/// Turned by 40 degrees about the diagonal, a node moves by `2 sin(20 deg)` times its distance from the axis: that is linear in the position, largest at (0, 0, 3),
/// at a distance of `sqrt(9 - 3)`, and zero on the axis.
#[test]
fn extrema_of_a_rotation_are_at_their_nodes() {
    let probe = |name: &str, quantity: &str, rest: &str| {
        format!("[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\n{rest}\n")
    };
    let rest = "[[prescribe]]\nset = \"block.boundary\"\nrotation = { axis = [1, 1, 1], degrees = { table = [[0, 0], [1, 40]] } }\n".to_owned()
        + &probe("far", "displacement", "reduce = \"max\"\nbody = \"block\"")
        + &probe("near", "displacement", "reduce = \"min\"\nset = \"block.all & x = 0\"")
        + &probe("low", "position", "reduce = \"min\"\ncomponent = \"z\"\nset = \"block.top\"");
    let built = run(&rest);
    let at = |probe: &str| {
        let node = values(&built, probe)[1] as usize;
        let x = &built.simulation.model().reference;
        [x[3 * node], x[3 * node + 1], x[3 * node + 2]]
    };
    close(&values(&built, "far")[..1], &[2.0 * 20f64.to_radians().sin() * 6f64.sqrt()]);
    assert_eq!(at("far"), [0.0, 0.0, 3.0]);
    close(&values(&built, "near")[..1], &[0.0]);
    assert_eq!(at("near"), [0.0; 3]);
    // Rodrigues' formula for the third component of a position.
    let (sin, cos) = 40f64.to_radians().sin_cos();
    let turned = |x: [f64; 3]| {
        let along = (x[0] + x[1] + x[2]) / 3.0;
        x[2] * cos + (x[1] - x[0]) / 3f64.sqrt() * sin + along * (1.0 - cos)
    };
    let corners = [[0.0, 0.0, 3.0], [1.0, 0.0, 3.0], [0.0, 2.0, 3.0], [1.0, 2.0, 3.0]];
    let lowest = corners.into_iter().min_by(|a, b| turned(*a).total_cmp(&turned(*b))).unwrap();
    close(&values(&built, "low")[..1], &[turned(lowest)]);
    assert_eq!(at("low"), lowest);
}

/// An event looks at a component of a stress, and at an extremum: the stretch is released once they are above half of what comes at the end.
#[test]
fn events_follow_stresses_and_extrema() {
    let (_, _, sigma) = exact();
    for (probe, condition) in [
        (
            "quantity = \"cauchy_stress\"\nbody = \"block\"\npoint = [0.5, 1, 1.5]",
            format!("component = \"zz\", above = {}", 0.5 * sigma[2][2]),
        ),
        ("quantity = \"von_mises\"\nreduce = \"max\"\nbody = \"block\"", format!("above = {}", 0.5 * mises(sigma))),
        (
            "quantity = \"deformation_gradient\"\nbody = \"block\"\npoint = [0, 0, 0]",
            format!("component = \"xz\", above = {}", 0.45 * SHEAR),
        ),
    ] {
        let rest = sheared()
            + &format!(
                "[[probe]]\nname = \"p\"\n{probe}\n[[event]]\nname = \"off\"\nrelease = \"at-2\"\nwhen = {{ probe = \"p\", {condition} }}\n"
            );
        let mut built = built(&rest).unwrap_or_else(|errors| panic!("{errors}"));
        built.simulation.advance().unwrap();
        built.schedule.events(&mut built.simulation, &built.probes).unwrap();
        assert!(built.simulation.released().is_empty(), "{condition}");
        for _ in 0..2 {
            built.simulation.advance().unwrap();
            built.schedule.events(&mut built.simulation, &built.probes).unwrap();
        }
        assert_eq!(built.simulation.released().len(), 1, "{condition}");
    }
}

#[test]
fn mistakes_of_probes_are_told() {
    for (probe, expected) in [
        (
            "quantity = \"von_mises\"\nbody = \"block\"\npoint = [0, 0, 3.5]",
            "the nearest node is at [0.0, 0.0, 3.0], 5.000e-1 away",
        ),
        ("quantity = \"von_mises\"\nset = \"block.top\"", "belongs to a point of a body"),
        ("quantity = \"von_mises\"\nbody = \"block\"", "probe[0].point: is missing"),
        ("quantity = \"energy\"\nreduce = \"max\"", "has no value at each node"),
        ("quantity = \"position\"\nreduce = \"max\"\nbody = \"block\"", "probe[0].component: is missing"),
        ("quantity = \"displacement\"\ncomponent = \"x\"\nset = \"block.top\"", "is for extrema"),
        (
            "quantity = \"displacement\"\nreduce = \"max\"\ncomponent = \"xx\"\nset = \"block.top\"",
            "did you mean `x`? The choices are `x`, `y`, `z`",
        ),
        ("quantity = \"displacement\"\nreduce = \"most\"\nset = \"block.top\"", "the choices are `max`, `min`"),
        (
            "quantity = \"displacement\"\nreduce = \"max\"\nbody = \"block\"\npoint = [0, 0, 0]",
            "an extremum belongs to a set or a body",
        ),
    ] {
        let errors = built(&format!("{}[[probe]]\nname = \"p\"\n{probe}\n", sheared())).unwrap_err();
        assert!(errors.contains(expected) && errors.lines().count() == 1, "{probe}: {errors}");
    }
}

/// General contact that names no surfaces: a rigid box presses on a block whose foot is held. What the surface of the block gets is what the box gets, and what the foot bears, for every cell; also the moment about the origin.
#[test]
fn the_force_of_general_contact_on_a_set_is_whole_for_every_cell() {
    for cell in ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge15"] {
        let text = format!(
            r#"
[scene]
title = "block under a box"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "block"
mesh = {{ generator = "block", min = [-0.5, -0.5, 0], max = [0.5, 0.5, 1], divisions = [1, 1, 1] }}
material = {{ law = "neo-hooke", young = 100.0, poisson = 0.0 }}
cell = "{cell}"
[[rigid]]
name = "tool"
shape = {{ kind = "box", size = [3, 3, 1] }}
position = [0.2, 0.1, 1.5]
[[prescribe]]
name = "held"
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
rigid = "tool"
components = ["z"]
displacement = {{ table = [[0, 0], [1, -0.05]] }}
[general_contact]
[[probe]]
name = "all"
quantity = "contact_force"
set = "block.all"
[[probe]]
name = "top"
quantity = "contact_force"
set = "block.top"
[[probe]]
name = "tool"
quantity = "contact_force"
set = "tool.boundary"
[[probe]]
name = "moment"
quantity = "contact_moment"
set = "block.top"
[[probe]]
name = "tool_moment"
quantity = "contact_moment"
set = "tool.boundary"
[[probe]]
name = "foot"
quantity = "reaction"
set = "block.bottom"
"#
        );
        let scene = stoss::scene::parse(&text, "test.toml").unwrap_or_else(|errors| panic!("{errors}"));
        let mut built = build(&scene, Path::new(".")).unwrap_or_else(|errors| panic!("{errors}"));
        while !built.simulation.finished() {
            built.simulation.advance().unwrap();
        }
        let [all, top, tool, foot] = ["all", "top", "tool", "foot"].map(|name| values(&built, name)[2]);
        assert!(tool > 4.0, "{cell}: {tool}");
        for (name, force) in [("all", all), ("top", top), ("foot", -foot)] {
            assert!((force + tool).abs() < 1e-6 * tool, "{cell}, {name}: {force}, the tool has {tool}");
        }
        let [moment, opposite] = ["moment", "tool_moment"].map(|name| values(&built, name));
        for (m, o) in moment.iter().zip(&opposite) {
            assert!((m + o).abs() < 1e-6 * tool, "{cell}: moment {moment:?}, the tool has {opposite:?}");
        }
    }
}
