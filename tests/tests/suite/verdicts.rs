//! Verdicts in both directions: what comes out wrong is told, and what comes out right is sound. Each kind of fault has a scene that shows it and its counterpart without it; right values are closed
//! forms. A scene whose fault has been mended is right, and then need not be told.

use std::path::Path;
use stoss::output::Summary;
use stoss::run::{RunOptions, run_scene};
use stoss::watch::{FindingKind, Severity};

/// Summary of a run, and the last row of its probes by their columns.
struct Run {
    summary: Summary,
    probes: Vec<(String, f64)>,
}

impl Run {
    fn of(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, text).unwrap();
        let options = RunOptions { out: folder.path().join("out"), ..RunOptions::default() };
        let summary = run_scene(&scene, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}\n{text}"));
        Self { summary, probes: last_row(&options.out) }
    }

    fn probe(&self, column: &str) -> f64 {
        self.probes.iter().find(|(name, _)| name == column).unwrap_or_else(|| panic!("{column}: {:?}", self.probes)).1
    }

    fn level(&self) -> Severity {
        self.summary.verdict.level
    }

    fn has(&self, kind: FindingKind) -> bool {
        self.summary.verdict.reasons.iter().any(|reason| reason.kind == kind)
    }

    /// The run has the value, or a finding of this kind says that something is the matter.
    fn right_or_told(&self, is_right: bool, kind: FindingKind) {
        assert!(is_right || self.has(kind), "neither right nor told: {:?} {}", self.probes, self.summary.verdict);
    }

    fn sound(&self) {
        assert_eq!(self.level(), Severity::Sound, "{}", self.summary.verdict);
    }
}

fn last_row(out: &Path) -> Vec<(String, f64)> {
    let Ok(text) = std::fs::read_to_string(out.join("probes.csv")) else { return Vec::new() };
    let (head, row) = (text.lines().next().unwrap(), text.lines().last().unwrap());
    head.split(',').map(str::to_owned).zip(row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN))).collect()
}

fn near(value: f64, right: f64, part: f64) -> bool {
    (value - right).abs() <= part * right.abs()
}

const ENERGY_MOMENTUM: &str = "integrator = { scheme = \"energy-momentum\" }";

/// A rigid box falls flat on a rigid plane at the speed 0.8: without a law of impact it comes back with it (energy), or lies still.
fn box_falls(step: f64, contact: &str) -> String {
    format!(
        r#"
[scene]
title = "box"
kind = "dynamic"
[time]
end = 0.5
step = {step}
{ENERGY_MOMENTUM}
[[rigid]]
name = "box"
shape = {{ kind = "box", size = [0.5, 0.6, 0.4] }}
position = [0, 0, 0.33]
density = 2.0
velocity = [0, 0, -0.8]
[[rigid]]
name = "floor"
shape = {{ kind = "plane", size = [4, 4] }}
fixed = true
{contact}
[[probe]]
name = "v"
quantity = "velocity"
body = "box"
"#
    )
}

#[test]
fn energy_that_closing_gaps_take_is_told() {
    let named = "[[contact]]\nmethod = \"nts\"\nslave = \"box.bottom\"\nmaster = \"floor.all\"\n";
    for step in [0.01, 0.0113, 0.0127] {
        let run = Run::of(&box_falls(step, named));
        let v = run.probe("v.z");
        run.right_or_told(near(v, 0.8, 0.02) || v.abs() < 1e-6, FindingKind::ClosingLoss);
    }
    // A constraint that keeps the energy.
    let run = Run::of(&box_falls(0.0113, &(named.to_owned() + "constraint = \"modified\"\n")));
    assert!(near(run.probe("v.z"), 0.8, 1e-9), "{:?}", run.probes);
    run.sound();
}

/// A rigid door turns at 0.9 into a stop, or swings freely before it.
fn door(limit: f64) -> String {
    format!(
        r#"
[scene]
title = "door"
kind = "dynamic"
[time]
end = 1.2
step = 0.0117
{ENERGY_MOMENTUM}
[[rigid]]
name = "door"
shape = {{ kind = "box", size = [0.7, 0.05, 1.8] }}
position = [0.35, 0, 0]
density = 3.0
velocity = [0, 0.315, 0]
angular_velocity = [0, 0, 0.9]
[[joint]]
name = "hinge"
kind = "hinge"
between = ["ground", "door"]
at = [0, 0, 0]
axis = [0, 0, 1]
limits = [0, {limit}]
[[probe]]
name = "w"
quantity = "angular_velocity"
body = "door"
"#
    )
}

#[test]
fn limits_of_joints_lose_energy_and_say_so() {
    let stopped = Run::of(&door(35.0));
    let w = stopped.probe("w.z");
    stopped.right_or_told(near(w.abs(), 0.9, 0.02) || w.abs() < 1e-6, FindingKind::ClosingLoss);
    let named = stopped.summary.verdict.reasons.iter().all(|reason| reason.sentence.contains("hinge"));
    assert!(named, "{}", stopped.summary.verdict);
    // 1.2 times 0.9 are 62 degrees.
    let free = Run::of(&door(70.0));
    assert!(near(free.probe("w.z"), 0.9, 1e-9));
    free.sound();
}

/// A slack rope is dropped on a floor, or falls beside it: what is in the air falls freely.
fn rope(floor: f64, end: f64) -> String {
    format!(
        r#"
[scene]
title = "rope"
kind = "dynamic"
[time]
end = {end}
step = 0.004
integrator = {{ scheme = "backward-euler" }}
[[string]]
name = "rope"
from = [0, 0, 0.002]
to = [0, 0, 0.902]
elements = 30
axial = 800.0
mass = 0.7
tension_only = true
[[rigid]]
name = "floor"
shape = {{ kind = "plane", size = [2, 2] }}
position = [0, 0, {floor}]
fixed = true
[[contact]]
method = "nts"
slave = "rope.all"
master = "floor.all"
[gravity]
acceleration = [0, 0, -2.0]
[[probe]]
name = "top"
quantity = "position"
set = "rope.end"
"#
    )
}

#[test]
fn a_rope_that_falls_on_a_floor_is_told() {
    let fallen = Run::of(&rope(0.0, 0.76));
    fallen.right_or_told(near(fallen.probe("top.z"), 0.902 - 0.76 * 0.76, 0.02), FindingKind::ClosingLoss);
    let free = Run::of(&rope(-2.0, 0.76));
    // Backward Euler falls by g h t / 2 more.
    assert!(near(free.probe("top.z"), 0.902 - 0.76 * (0.76 + 0.004), 1e-3), "{:?}", free.probes);
    free.sound();
}

/// Two blocks on each other at rest, the upper one lower by `overlap`.
fn overlapping(overlap: f64) -> String {
    let (low, high) = (0.8 - overlap, 1.4 - overlap);
    format!(
        r#"
[scene]
title = "overlap"
kind = "dynamic"
[time]
end = 0.4
step = 0.01
{ENERGY_MOMENTUM}
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1.2, 1.2, 0.8], divisions = [2, 2, 2] }}
material = {{ law = "neo-hooke", young = 500.0, poisson = 0.3 }}
density = 1.5
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0.3, 0.3, {low}], max = [0.9, 0.9, {high}], divisions = [2, 2, 1] }}
material = {{ law = "neo-hooke", young = 500.0, poisson = 0.3 }}
density = 1.5
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
"#
    )
}

#[test]
fn energy_from_an_overlap_is_wrong() {
    let made = Run::of(&overlapping(0.015));
    let energy = made.summary.drift["energy"].absolute.unwrap();
    assert!(energy < 1e-9 || made.level() == Severity::Wrong, "{energy} {}", made.summary.verdict);
    Run::of(&overlapping(0.0)).sound();
}

/// A turned block of quadratic elements on which nothing acts.
#[test]
fn round_off_of_a_body_at_rest_is_no_energy() {
    for scheme in ["{ scheme = \"hht\", rho_inf = 0.8 }", "{ scheme = \"newmark\" }", "{ scheme = \"trapezoidal\" }"] {
        let run = Run::of(&format!(
            r#"
[scene]
title = "rest"
kind = "dynamic"
[time]
end = 0.02
step = 0.0005
integrator = {scheme}
[[body]]
name = "block"
mesh = {{ generator = "block", size = [1.1, 0.7, 1.3], divisions = [1, 1, 1] }}
material = {{ law = "saint-venant-kirchhoff", young = 30000.0, poisson = 0.25 }}
cell = "hex20"
density = 1.9
position = [0.4, -0.7, 0.2]
rotation = {{ axis = [2, -1, 3], degrees = 40 }}
[[probe]]
name = "u"
quantity = "displacement"
reduce = "max"
body = "block"
"#
        ));
        assert!(run.probe("u") < 1e-10);
        run.sound();
    }
}

/// A bar whose mass damping is as large as the step is long, pulled at once: it creeps to `F L / E A`.
#[test]
fn a_bar_that_creeps_gains_no_energy() {
    let run = Run::of(
        r#"
[scene]
title = "creep"
kind = "dynamic"
[time]
end = 8e-4
step = 4e-6
integrator = { scheme = "hht", rho_inf = 0.85 }
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [5, 1, 1], divisions = [4, 1, 1] }
material = { law = "saint-venant-kirchhoff", young = 1e5, poisson = 0.0 }
density = 1e-8
damping = { mass = 3e5 }
[[prescribe]]
set = "bar.left"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "bar.right"
traction = { table = [[0, 20, 0, 0], [1, 20, 0, 0]] }
[[probe]]
name = "u"
quantity = "displacement"
set = "bar.right"
"#,
    );
    assert!(near(run.probe("u.x"), 20.0 * 5.0 / 1e5, 0.01), "{:?}", run.probes);
    run.sound();
}

/// A stabilised bar whose left end is moved: through empty space, or while its right end is held.
fn moved(held: &str) -> String {
    format!(
        r#"
[scene]
title = "moved"
kind = "quasi-static"
[time]
end = 1.0
step = 0.1
stabilise = {{ fraction = 1e-3 }}
[[body]]
name = "bar"
mesh = {{ generator = "block", min = [0, 0, 0], max = [3, 0.5, 0.5], divisions = [6, 1, 1] }}
material = {{ law = "neo-hooke", young = 900.0, poisson = 0.3 }}
[[prescribe]]
set = "bar.left"
components = ["x", "y", "z"]
displacement = {{ table = [[0, 0, 0, 0], [1, -0.3, 0, 0]] }}
{held}
"#
    )
}

#[test]
fn a_stabilisation_that_carries_is_told() {
    let free = Run::of(&moved(""));
    assert!(free.has(FindingKind::Stabilisation) && free.level() == Severity::Doubtful, "{}", free.summary.verdict);
    Run::of(&moved("[[prescribe]]\nset = \"bar.right\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n")).sound();
}

/// A plate presses on the side of a block; its upper rim is below the block's upper edge, so that the block bulges over it.
fn rim(contact: &str) -> String {
    format!(
        r#"
[scene]
title = "rim"
kind = "quasi-static"
[time]
end = 1.0
step = 0.125
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 0.8, 1.2], divisions = [3, 2, 4] }}
material = {{ law = "neo-hooke", young = 600.0, poisson = 0.3 }}
[[rigid]]
name = "plate"
shape = {{ kind = "plane", size = [3, 3] }}
rotation = {{ axis = [0, 1, 0], degrees = -90 }}
position = [1.0, 0.4, -0.9]
[[prescribe]]
set = "block.top"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.left - block.top"
components = ["x"]
fixed = true
[[prescribe]]
rigid = "plate"
components = ["x"]
displacement = {{ table = [[0, 0], [1, -0.2]] }}
{contact}
"#
    )
}

#[test]
fn what_bulges_over_a_rim_is_not_inside() {
    Run::of(&rim("[general_contact]\n")).sound();
    let through = Run::of(&rim("[general_contact]\nenabled = false\n"));
    assert!(through.level() == Severity::Wrong && through.has(FindingKind::Penetration), "{}", through.summary.verdict);
}

/// Two guided cubes, pressed together by the strain 0.04 in each: uniaxial, `E (L - L^3) / 2` with the stretch `L`, but for the layer.
#[test]
fn the_layer_of_general_contact_does_not_buckle() {
    let run = Run::of(
        r#"
[scene]
title = "press"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "low"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "saint-venant-kirchhoff", young = 700.0, poisson = 0.0 }
[[body]]
name = "up"
mesh = { generator = "block", min = [0, 0, 1], max = [1, 1, 2], divisions = [2, 2, 2] }
material = { law = "saint-venant-kirchhoff", young = 700.0, poisson = 0.0 }
[[prescribe]]
set = "low.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "up.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.08]] }
[general_contact]
[[probe]]
name = "f"
quantity = "reaction"
set = "low.bottom"
"#,
    );
    let stretch = 0.96_f64;
    assert!(near(run.probe("f.z"), 700.0 * (stretch - stretch.powi(3)) / 2.0, 0.06), "{:?}", run.probes);
    run.sound();
}

/// A straight bar under general contact that is pressed to twice the strain of Euler's load, `pi^2 (h/l)^2 / 3` between clamped ends: it bends, or its straight
/// state is told.
#[test]
fn a_bar_that_buckles_beside_general_contact_is_told() {
    let run = Run::of(
        r#"
[scene]
title = "bar"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [0.5, 0.5, 8], divisions = [1, 1, 16] }
material = { law = "saint-venant-kirchhoff", young = 700.0, poisson = 0.0 }
[[body]]
name = "foot"
mesh = { generator = "block", min = [0, 0, -0.5], max = [0.5, 0.5, 0], divisions = [1, 1, 1] }
material = { law = "saint-venant-kirchhoff", young = 700.0, poisson = 0.0 }
[[prescribe]]
set = "foot.all"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "bar.bottom"
components = ["x", "y"]
fixed = true
[[prescribe]]
set = "bar.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.4]] }
[general_contact]
[[probe]]
name = "middle"
set = "bar.all"
quantity = "position"
"#,
    );
    let bent = (run.probe("middle.x") - 0.25).hypot(run.probe("middle.y") - 0.25) > 0.1;
    run.right_or_told(bent, FindingKind::Unstable);
}

/// A rigid roller is pressed into a block on a rigid base by `depth`.
fn roller(divisions: usize, depth: f64) -> String {
    format!(
        r#"
[scene]
title = "roller"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "block"
mesh = {{ generator = "block", min = [-2, 0, 0], max = [2, 0.5, 1.5], divisions = [{divisions}, 1, 4] }}
material = {{ law = "neo-hooke", young = 100.0, poisson = 0.3 }}
[[rigid]]
name = "roller"
shape = {{ kind = "cylinder", radius = 0.4, length = 1.0, divisions = [48, 1, 1] }}
rotation = {{ axis = [1, 0, 0], degrees = 90 }}
position = [0, 0.25, 1.9]
[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.all - block.bottom"
components = ["y"]
fixed = true
[[prescribe]]
rigid = "roller"
components = ["z"]
displacement = {{ table = [[0, 0], [1, -{depth}]] }}
[[contact]]
method = "mortar"
slave = "block.top"
master = "roller.all"
[[probe]]
name = "f"
quantity = "contact_force"
body = "roller"
"#
    )
}

/// The force on facets that are as wide as the roller, beside that on facets of an eighth.
#[test]
fn a_tool_that_sinks_into_wide_facets_is_told() {
    let fine = Run::of(&roller(40, 0.15));
    fine.sound();
    let coarse = Run::of(&roller(5, 0.15));
    let is_right = near(coarse.probe("f.z"), fine.probe("f.z"), 0.07);
    assert!(is_right || coarse.level() != Severity::Sound, "{:?}", coarse.probes);
}

/// A hollow ball with an interference of 0.004 in another one; `outer` divisions of the outer one, 4 of the inner one.
fn press_fit(outer: usize) -> String {
    let support = |body: &str, r: f64| -> String {
        [([r, 0.0, 0.0], "\"y\", \"z\""), ([0.0, r, 0.0], "\"x\", \"z\""), ([0.0, 0.0, r], "\"x\", \"y\"")]
            .map(|([x, y, z], held)| {
                format!(
                    "[[prescribe]]\nset = \"nearest({body}, {x}, {y}, {z})\"\ncomponents = [{held}]\nfixed = true\n"
                )
            })
            .concat()
    };
    format!(
        r#"
[scene]
title = "fit"
kind = "quasi-static"
[time]
end = 1.0
step = 1.0
[[body]]
name = "inner"
mesh = {{ generator = "hollow-ball", inner_diameter = 1.4, outer_diameter = 2.008, divisions = [4, 2] }}
material = {{ law = "saint-venant-kirchhoff", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "outer"
mesh = {{ generator = "hollow-ball", inner_diameter = 2.0, outer_diameter = 3.0, divisions = [{outer}, 2] }}
material = {{ law = "saint-venant-kirchhoff", young = 1000.0, poisson = 0.3 }}
{}{}
[[contact]]
method = "mortar"
slave = "inner.outer"
master = "outer.inner"
[[probe]]
name = "u"
quantity = "displacement"
set = "nearest(outer, 1.5, 0, 0)"
"#,
        support("inner", 0.7),
        support("outer", 1.5)
    )
}

/// Lame's hollow balls: the pressure `p` between them gives the outer one, of the radii 1 and 1.5, and the inner one, of 0.7 and 1, displacements at the interface that differ by the interference;
/// the outside moves by `3 (1 - nu) p 1.5 / (2 E (1.5^3 - 1))`.
#[test]
fn an_interference_below_the_arch_of_facets_is_told() {
    let (young, nu, interference) = (1000.0, 0.3, 0.004);
    let around = |radius: f64, cubes: f64| ((1.0 - 2.0 * nu) + (1.0 + nu) * radius.powi(3) / 2.0) / cubes;
    let outer = around(1.5, 1.5_f64.powi(3) - 1.0);
    let inner = around(0.7, 1.0 - 0.7_f64.powi(3));
    let pressure = interference * young / (outer + inner);
    let outside = 3.0 * (1.0 - nu) * pressure * 1.5 / (2.0 * young * (1.5_f64.powi(3) - 1.0));
    // Nodes opposite nodes: facets on facets.
    let matching = Run::of(&press_fit(4));
    assert!(near(matching.probe("u.x"), outside, 0.1), "{:?} {outside}", matching.probes);
    matching.sound();
    let crossed = Run::of(&press_fit(6));
    // Where the facets of both lie so that no force is found, depths tell.
    let told = [FindingKind::Indentation, FindingKind::Penetration].map(|kind| crossed.has(kind)).contains(&true);
    assert!(
        told || near(crossed.probe("u.x"), outside, 0.1),
        "{:?} {outside} {}",
        crossed.probes,
        crossed.summary.verdict
    );
    assert_ne!(crossed.level(), Severity::Sound, "{:?} {outside}", crossed.probes);
}

/// A rigid cube on its corner, with so much inertia that it does not turn, slides over a flat floor of `n` by `n` facets without friction: its momentum along the floor is constant.
fn corner(n: usize) -> String {
    format!(
        r#"
[scene]
title = "corner"
kind = "dynamic"
[time]
end = 1.5
step = 0.003
{ENERGY_MOMENTUM}
[[rigid]]
name = "cube"
shape = {{ kind = "box", size = [0.4, 0.4, 0.4] }}
rotation = [{{ axis = [1, 0, 0], degrees = 45 }}, {{ axis = [0, 1, 0], degrees = 35.264389682754654 }}]
position = [-0.9, -0.6, "0.2*sqrt(3)+0.001"]
mass = 2.0
inertia = [1e3, 1e3, 1e3]
velocity = [0.8, 0.6, 0]
[[rigid]]
name = "floor"
shape = {{ kind = "plane", size = [3, 3], divisions = [{n}, {n}] }}
fixed = true
[gravity]
acceleration = [0, 0, -1.2]
[general_contact]
thickness = 0.008
pairs = [{{ between = ["cube", "floor"], modulus = 1e4 }}]
[[probe]]
name = "v"
quantity = "velocity"
body = "cube"
"#
    )
}

#[test]
fn forces_along_a_flat_floor_are_told() {
    let many = Run::of(&corner(13));
    let is_right = near(many.probe("v.x"), 0.8, 0.005) && near(many.probe("v.y"), 0.6, 0.005);
    many.right_or_told(is_right, FindingKind::SideForce);
    // A ball that nodes of its surface hold on the same floor.
    let ball = corner(13)
        .replace("kind = \"box\", size = [0.4, 0.4, 0.4]", "kind = \"sphere\", radius = 0.3464, divisions = 4")
        .replace(
            "[general_contact]\nthickness = 0.008\npairs = [{ between = [\"cube\", \"floor\"], modulus = 1e4 }]",
            "[[contact]]\nmethod = \"nts\"\nslave = \"cube.all\"\nmaster = \"floor.all\"",
        );
    let ball = Run::of(&ball);
    assert!(near(ball.probe("v.x"), 0.8, 1e-9) && near(ball.probe("v.y"), 0.6, 1e-9), "{:?}", ball.probes);
    assert!(!ball.has(FindingKind::SideForce), "{}", ball.summary.verdict);
}
