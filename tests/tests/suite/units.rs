//! Results do not depend on the system of units: scenes of all methods with lengths, masses and times from nano to giga.
//!
//! A constant that is compared with a length, a force or a time shows as another number of steps, another verdict or another result.

use crate::support::units::{Units, in_units};
use std::collections::BTreeMap;
use stoss::run::{RunOptions, run_scene};
use stoss::scene::Dimension;

/// Nts, exact friction, statics with automatic increments.
const PRESS: &str = r#"
[scene]
title = "press and slide"
kind = "quasi-static"
[time]
end = 2.0
step = 0.25
automatic = { initial = 0.125 }
[[body]]
name = "slab"
mesh = { generator = "block", min = [0.0, 0.0, 0.0], max = [4.0, 2.0, 1.0], divisions = [5, 3, 2] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[body]]
name = "tool"
mesh = { generator = "indenter", size = [1.2, 1.2], height = 0.8, radius = 2.0, divisions = [3, 3, 2] }
material = { law = "neo-hooke", young = 5000.0, poisson = 0.3 }
position = [1.1, 1.0, 1.0]
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "tool.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.14], [2, 0.6, 0, -0.14]] }
[[contact]]
method = "nts"
slave = "tool.bottom"
master = "slab.top"
friction = { law = "coulomb", mu = 0.2 }
[[probe]]
name = "f"
quantity = "reaction"
set = "tool.top"
"#;

/// Nts, penalties, dynamics with damping and supports, generalised-alpha.
const SPRINGS: &str = r#"
[scene]
title = "penalties"
kind = "dynamic"
[time]
end = 0.2
step = 0.01
integrator = { scheme = "generalised-alpha", rho_inf = 0.8 }
[gravity]
acceleration = [0, 0, -9.81]
[solver]
absolute_tolerance = 1e-6
[[body]]
name = "plate"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 2, 0.5], divisions = [3, 3, 1] }
material = { law = "saint-venant-kirchhoff", young = 2e4, poisson = 0.25 }
density = 10.0
[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [0.7, 0.6, 0.5], divisions = [2, 2, 2] }
position = [0.6, 0.7, 0.52]
material = { law = "mooney-rivlin", c1 = 1500.0, c2 = 300.0, c = 8000.0 }
density = 20.0
velocity = [0.8, 0.3, -1.0]
damping = { mass = 0.1, stiffness = 1e-3 }
[[support]]
set = "plate.bottom"
stiffness = [2e4, 2e4, 5e4]
damping = [20.0, 20.0, 50.0]
[[contact]]
method = "nts"
slave = "block.bottom"
master = "plate.top"
enforcement = { penalty = 2e5 }
friction = { law = "static-dynamic", mu_static = 0.4, mu_dynamic = 0.3, speed = 0.1, penalty = 1e5 }
[[probe]]
name = "stress"
quantity = "cauchy_stress"
body = "block"
point = [0.9, 1.0, 0.7]
"#;

const CAT: &str = r#"
[scene]
title = "coordinate augmentation"
kind = "dynamic"
[time]
end = 4.0
step = 0.1
integrator = { scheme = "energy-momentum" }
[[body]]
name = "upper"
mesh = { generator = "block", min = [-0.5, -1.0, 1.1], max = [0.5, 0.0, 2.1], divisions = [1, 1, 1] }
material = { law = "neo-hooke", lambda = 1298.1, mu = 865.3846 }
density = 1000.0
velocity = [0.0, 0.1, -0.04]
[[body]]
name = "lower"
material = { law = "neo-hooke", lambda = 1298.1, mu = 865.3846 }
density = 1000.0
mesh = { generator = "hexahedron", divisions = [1, 1, 1], corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.2, 1.0, 0.0], [-1.5, 1.5, 0.0], [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.2, 1.0, 1.0], [-1.5, 1.5, 1.0]] }
[[contact]]
method = "cat"
slave = "upper.bottom"
master = "lower.top"
reduction = "first"
"#;

/// Mortar, standard multipliers, friction, statics in stages of springs and pressure.
const MORTAR: &str = r#"
[scene]
title = "mortar with friction"
kind = "quasi-static"
[time]
end = 2.0
step = 0.5
[[body]]
name = "slab"
mesh = { generator = "block", min = [0.0, 0.0, 0.0], max = [3.0, 2.0, 1.0], divisions = [4, 3, 2] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[body]]
name = "tool"
mesh = { generator = "block", min = [0, 0, 0], max = [1.2, 1.1, 0.5], divisions = [3, 3, 1] }
material = { law = "neo-hooke", young = 1500.0, poisson = 0.3 }
position = [0.7, 0.5, 1.0]
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "tool.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.05], [2, 0.2, 0.1, -0.05]] }
[[contact]]
method = "mortar"
slave = "tool.bottom"
master = "slab.top"
friction = { law = "coulomb", mu = 0.3 }
"#;

/// Mortar, dual multipliers with sliding friction by penalty, dynamics.
const DUAL: &str = r#"
[scene]
title = "dual mortar, impact"
kind = "dynamic"
[time]
end = 0.1
step = 0.005
integrator = { scheme = "midpoint" }
[[body]]
name = "lower"
mesh = { generator = "block", min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.0], divisions = [3, 3, 1] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 1.0
[[body]]
name = "upper"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
position = [-0.5, -0.45, 0.02]
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 1.0
velocity = [0.4, 0.2, -1.0]
[[contact]]
method = "mortar"
slave = "upper.bottom"
master = "lower.top"
multipliers = "dual"
friction = { law = "coulomb", mu = 0.2, penalty = 1e4 }
"#;

const TIE: &str = r#"
[scene]
title = "tied cantilever with spring"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
stabilise = { fraction = 2e-4 }
[[body]]
name = "root"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 1, 1], divisions = [3, 2, 2] }
material = { law = "neo-hooke", young = 12000.0, poisson = 0.3 }
[[body]]
name = "arm"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 1, 1], divisions = [4, 3, 3] }
position = [2, 0, 0]
material = { law = "ogden", mu = [3000.0, -900.0], alpha = [2.0, -2.0], kappa = 20000.0, beta = 9.0 }
[[set]]
name = "root.wall"
body = "root"
plane = { point = [0, 0, 0], normal = [1, 0, 0], tolerance = 1e-6 }
[[tie]]
slave = "arm.left"
master = "root.right"
[[prescribe]]
set = "root.wall"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "arm.right"
pressure = { table = [[0, 0], [1, -200]] }
[[load]]
set = "arm.top"
follower_pressure = { table = [[0, 0], [1, 40]] }
[[spring]]
name = "stay"
between = ["arm.right", "ground"]
at = [[4, 0.5, 0.5], [4, 0.5, 3.0]]
stiffness = 500.0
[[probe]]
name = "tip"
quantity = "displacement"
set = "arm.right"
"#;

const GENERAL: &str = r#"
[scene]
title = "general contact with friction"
kind = "dynamic"
[time]
end = 0.15
step = 0.01
integrator = { scheme = "energy-momentum" }
[gravity]
acceleration = [0, 0, -9.81]
[[body]]
name = "ball"
mesh = { generator = "ball", radius = 0.5, divisions = [1, 1, 1] }
position = [0.1, 0.05, 0.52]
material = { law = "neo-hooke", young = 2e4, poisson = 0.3 }
density = 100.0
velocity = [1.0, 0.4, -1.5]
[[rigid]]
name = "floor"
shape = { kind = "box", size = [3, 3, 0.4], divisions = [2, 2, 1] }
position = [0, 0, -0.2]
density = 100.0
[[prescribe]]
rigid = "floor"
fixed = true
[general_contact]
friction = 0.3
damping = 1e-3
"#;

/// General contact in statics, bodies that overlap are separated, event.
const OVERLAP: &str = r#"
[scene]
title = "general contact, pressed"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "floor"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [3, 3, 2] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[body]]
name = "tool"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
position = [0.45, 0.55, 1.01]
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
volumetric = "mixed"
[[prescribe]]
set = "floor.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "tool.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [1, 0.05, 0, -0.1]] }
[general_contact]
friction = 0.2
thickness = 0.02
"#;

const JOINTS: &str = r#"
[scene]
title = "door and slider with limits"
kind = "dynamic"
[time]
end = 1.0
step = 0.02
integrator = { scheme = "energy-momentum" }
[gravity]
acceleration = [0, 0, -9.81]
[[rigid]]
name = "door"
shape = { kind = "box", size = [1.0, 0.1, 2.0] }
position = [0.5, 0, 0]
density = 500.0
[[rigid]]
name = "knob"
shape = { kind = "sphere", radius = 0.1, divisions = 3 }
position = [1.0, -0.3, 0]
density = 3000.0
[[mass]]
name = "bob"
at = [1.0, -0.3, -0.8]
mass = 5.0
[[joint]]
name = "hinge"
kind = "hinge"
between = ["ground", "door"]
at = [0, 0, 0]
axis = [0, 1, 0]
limits = [-5.0, 25.0]
friction = { coulomb = 20.0, viscous = 5.0 }
spring = { stiffness = 300.0, damping = 3.0, rest = 4.0 }
[[joint]]
name = "rail"
kind = "slider"
between = ["door", "knob"]
at = [1.0, -0.3, 0]
axis = [1, 0, 1]
limits = [-0.05, 0.1]
friction = { coulomb = 10.0 }
[[joint]]
name = "line"
kind = "distance"
between = ["knob", "bob"]
at = [[1.0, -0.3, 0], [1.0, -0.3, -0.8]]
[[probe]]
name = "angle"
quantity = "joint_angle"
joint = "hinge"
[[probe]]
name = "force"
quantity = "joint_force"
joint = "rail"
"#;

/// What has no size of its own: point masses, a spring without a rest length, a rigid body without a surface.
const POINTS: &str = r#"
[scene]
title = "points"
kind = "dynamic"
[time]
end = 1.0
step = 0.02
integrator = { scheme = "energy-momentum" }
[gravity]
acceleration = [0, 0, -9.81]
[[mass]]
name = "upper"
at = [0.3, 0.1, 2.0]
mass = 2.0
velocity = [0.5, 1.0, 0]
[[mass]]
name = "lower"
at = [0.3, 0.1, 1.2]
mass = 3.0
[[rigid]]
name = "top"
mass = 1.5
euler = [0.02, 0.03, 0.05]
centre = [0.3, 0.4, 1.2]
angular_velocity = [0, 3.0, 1.0]
[[spring]]
name = "bungee"
between = ["upper", "ground"]
at = [[0.3, 0.1, 2.0], [0, 0, 2.5]]
stiffness = 150.0
rest_length = 0.0
damping = 1.0
[[joint]]
name = "rod"
kind = "distance"
between = ["upper", "lower"]
at = [[0.3, 0.1, 2.0], [0.3, 0.1, 1.2]]
[[joint]]
name = "eye"
kind = "ball"
between = ["top", "lower"]
at = [0.3, 0.1, 1.2]
[[probe]]
name = "end"
quantity = "position"
set = "lower.all"
"#;

/// What a run says: how it went, and the columns of its tables.
struct Run {
    went: String,
    columns: BTreeMap<String, Vec<f64>>,
}

fn run(scene: &str, units: Units) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, in_units(scene, units)).unwrap();
    let options = RunOptions { out: folder.path().join("out"), ..RunOptions::default() };
    let summary = run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{units:?}: {e}\n{scene}"));
    let (verdict, steps) = (summary.verdict.level, summary.steps);
    let went = format!("{verdict:?}, {steps} steps");
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for table in ["contact", "balance", "probes"] {
        let Ok(text) = std::fs::read_to_string(options.out.join(table).with_extension("csv")) else { continue };
        let mut lines = text.lines().map(|line| line.split(','));
        let names: Vec<String> = lines.next().unwrap().map(|name| format!("{table}.{name}")).collect();
        for line in lines {
            for (name, value) in names.iter().zip(line) {
                // Names of bodies are no numbers.
                let Ok(value) = value.parse::<f64>() else { continue };
                columns.entry(name.clone()).or_default().push(value);
            }
        }
    }
    Run { went, columns }
}

/// Runs in units of length, mass and time that differ by powers of ten: as many steps, the same verdict, and these columns in their units, as far as what an iteration leaves allows.
fn check(scene: &str, expected: &[(&str, Dimension)]) {
    let base = run(scene, Units::SAME);
    for (unit, factor) in (0..3).flat_map(|unit| [1e9, 1e-9].map(|factor| (unit, factor))) {
        let mut factors = [1.0; 3];
        factors[unit] = factor;
        let [length, mass, time] = factors;
        let other = run(scene, Units { length, mass, time });
        assert_eq!(base.went, other.went, "{factors:?}");
        for (name, dimension) in expected {
            let factor = factor.powi(dimension.exponents()[unit]);
            let (from, to) = (&base.columns[*name], &other.columns[*name]);
            let largest = from.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            assert_eq!(from.len(), to.len(), "{name} in units of {factors:?}");
            for (a, b) in from.iter().zip(to) {
                let near = (a - b / factor).abs() <= 1e-5 * largest;
                assert!(near, "{name} in units of {factors:?}: {a:e} {:e}", b / factor);
            }
        }
    }
}

/// Columns of every scene.
const ENERGY: (&str, Dimension) = ("balance.strain", Dimension::Energy);
const STEP: (&str, Dimension) = ("balance.dt", Dimension::Time);
const PRESSURE: (&str, Dimension) = ("contact.max_pressure", Dimension::Stress);
const MOMENTUM: (&str, Dimension) = ("balance.lz", Dimension::Momentum);

#[test]
fn node_to_surface_with_friction_in_statics() {
    check(PRESS, &[ENERGY, STEP, PRESSURE, ("probes.f.x", Dimension::Force)]);
}

#[test]
fn node_to_surface_with_penalties_in_dynamics() {
    check(SPRINGS, &[ENERGY, STEP, MOMENTUM, PRESSURE, ("probes.stress.zz", Dimension::Stress)]);
}

#[test]
fn coordinate_augmentation() {
    check(CAT, &[ENERGY, STEP, MOMENTUM, PRESSURE]);
}

#[test]
fn mortar_with_friction_in_statics() {
    check(MORTAR, &[ENERGY, STEP, PRESSURE]);
}

#[test]
fn dual_mortar_with_friction_in_dynamics() {
    check(DUAL, &[ENERGY, STEP, MOMENTUM, PRESSURE, ("balance.friction_work", Dimension::Energy)]);
}

#[test]
fn tie_springs_and_followers() {
    check(TIE, &[ENERGY, STEP, ("probes.tip.z", Dimension::Length)]);
}

#[test]
fn general_contact_in_dynamics() {
    check(GENERAL, &[ENERGY, STEP, MOMENTUM, PRESSURE]);
}

#[test]
fn general_contact_in_statics() {
    check(OVERLAP, &[ENERGY, STEP, PRESSURE]);
}

#[test]
fn joints_with_limits_springs_and_friction() {
    let angle = ("probes.angle", Dimension::Angle);
    check(JOINTS, &[("balance.potential", Dimension::Energy), STEP, MOMENTUM, angle]);
}

#[test]
fn parts_without_a_size() {
    let end = ("probes.end.z", Dimension::Length);
    check(POINTS, &[("balance.potential", Dimension::Energy), STEP, MOMENTUM, end]);
}
