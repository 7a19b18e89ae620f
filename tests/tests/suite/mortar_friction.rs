//! Friction of mortar contact in whole models: a block that is dragged, a block that sticks, the impact of two blocks.

use crate::support::{drift, simulation};
use stoss::solver::{DecisionKind, Simulation, StepRecord};

const MU: f64 = 0.1;
const PRESSURE: f64 = 2.0;

fn print_newton(record: &StepRecord) {
    let rows: Vec<String> = record.newton.iter().map(|r| format!("{:.1e}", r.residual)).collect();
    println!("step {} dt {}: {}", record.step, record.dt, rows.join(" "));
}

/// A block of height 1/4 is pressed on the flat top of another one (held in z) and then moved along it, in plane strain. `path`: rows of x.
fn drag(contact: &str, upper_is_slave: bool, mu: f64, path: &str, step: f64, end: f64) -> Simulation {
    let (slave, master) = if upper_is_slave { ("upper.bottom", "lower.top") } else { ("lower.top", "upper.bottom") };
    let mut text = format!(
        r#"
[scene]
title = "drag"
kind = "quasi-static"
[time]
end = {end:?}
step = {step:?}
[solver]
relative_tolerance = 1e-12
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [0, 0, 0], max = [3, 1, 1], divisions = [6, 2, 1] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0.3, 0, 1], max = [1.3, 1, 1.25], divisions = [5, 3, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[contact]]
method = "mortar"
slave = "{slave}"
master = "{master}"
friction = {{ law = "coulomb", mu = {mu:?}, {contact} }}
[[prescribe]]
set = "lower.bottom"
components = ["x", "z"]
fixed = true
[[prescribe]]
set = "lower.top"
components = ["z"]
fixed = true
[[prescribe]]
set = "upper.top"
components = ["x"]
displacement = {{ table = {path} }}
[[load]]
set = "upper.top"
pressure = {{ table = [[0.0, 0.0], [1.0, {PRESSURE:?}]] }}
"#
    );
    for body in ["lower", "upper"] {
        for set in ["front", "back"] {
            text += &format!("[[prescribe]]\nset = \"{body}.{set}\"\ncomponents = [\"y\"]\nfixed = true\n");
        }
    }
    simulation(&text)
}

/// Force of the contact on the upper block.
fn force_on_upper(s: &Simulation) -> [f64; 3] {
    let nodes = &s.model().bodies[1].nodes;
    std::array::from_fn(|i| nodes.clone().map(|n| s.contact_force()[3 * n as usize + i]).sum())
}

/// In full slip the tangential force is mu times the normal one, which is the load, and supports take it up.
#[test]
fn full_slip_has_the_coefficient() {
    for upper_is_slave in [true, false] {
        for options in
            ["penalty = 1e4, slip = \"objective\"", "penalty = 1e4, slip = \"direct\"", "stick = \"multiplier\""]
        {
            let path = "[[0.0, 0.0], [1.0, 0.0], [2.0, 0.39]]";
            let mut s = drag(options, upper_is_slave, MU, path, 0.1, 2.0);
            while !s.finished() {
                print_newton(&s.advance().unwrap());
            }
            let force = force_on_upper(&s);
            println!(
                "{options}, upper slave {upper_is_slave}: {} nodes, {force:?}, ratio off by {:.1e}",
                s.active()[0].iter().filter(|a| **a).count(),
                force[0] / force[2] + MU
            );
            assert!((force[2] / PRESSURE - 1.0).abs() < 1e-9, "{force:?}");
            assert!((force[0] / force[2] + MU).abs() < 1e-9 * MU, "{force:?}");
            assert!(force[1].abs() < 1e-9 * PRESSURE);
            let supports: f64 = s.model().bodies[0].nodes.clone().map(|n| s.reactions()[3 * n as usize]).sum();
            assert!((supports - force[0]).abs() < 1e-9 * PRESSURE, "{supports} {force:?}");
        }
    }
}

/// Exact stick: dragged back and forth below the bound, everything comes back to where it was, nothing is stored or dissipated, but for what the rounds of
/// an augmented Lagrangian leave.
#[test]
fn exact_stick_does_no_work() {
    for (upper_is_slave, stick, bound, work) in [
        // The tolerance of Newton's method, 1e-12, twenty times over.
        // Lower slave: nodes that are covered in part only magnify what the iteration leaves.
        // Nodes that supports hold too, front and back, yield by 1e-8 of what springs would.
        (true, "stick = \"multiplier\"", 2e-11, 1e-11),
        (false, "stick = \"multiplier\"", 1e-9, 1e-10),
    ] {
        let path = "[[0.0, 0.0], [1.0, 0.0], [1.5, 2e-4], [2.5, -2e-4], [3.0, 0.0]]";
        let mut s = drag(stick, upper_is_slave, 5.0, path, 0.1, 3.0);
        let mut pressed = Vec::new();
        let (mut largest, mut dissipated, mut stored, mut laid_down) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0);
        while !s.finished() {
            let record = s.advance().unwrap();
            if record.time < 1.0 + 1e-9 {
                pressed.clone_from(&s.state().q);
            }
            let balance = record.balance;
            stored = stored.max(balance.contact / balance.external_work);
            if record.time < 1.0 + 1e-9 {
                // Edges that are laid down slip until they carry.
                laid_down = balance.dissipation;
                assert!(laid_down < 1e-3 * balance.external_work, "{balance:?}");
            }
            dissipated = dissipated.max((balance.dissipation - laid_down).abs() / balance.external_work);
            largest = largest.max(force_on_upper(&s)[0].abs());
        }
        let apart = s.state().q.iter().zip(&pressed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!(
            "{stick}, upper slave {upper_is_slave}: largest force {largest:.3}, apart by {apart:.1e}, dissipated {dissipated:.1e}, stored {stored:.1e}"
        );
        assert!(largest > 0.1, "it was dragged");
        assert!(stored <= if stick.contains("multiplier") { 1e-9 } else { 0.0 });
        assert!(apart < bound && dissipated < work, "{apart:e} {dissipated:e}");
    }
}

/// The impact of the thesis with mu = 0.2: momenta are exact; what energy the bodies lose is dissipated, but for what closing nodes lose.
#[test]
fn two_blocks_keep_momenta_and_lose_what_friction_dissipates() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/two-blocks-mortar-02.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let mut s = simulation(&text);
    let mut records = vec![s.initial_record()];
    let (mut linear, mut angular) = (Vec::new(), Vec::new());
    while !s.finished() {
        let record = s.advance().unwrap();
        if record.contact.as_ref().is_some_and(|c| c.active > 0) && records.len() % 10 == 0 {
            print_newton(&record);
        }
        linear.push(record.balance.linear_momentum);
        angular.push(record.balance.angular_momentum);
        assert!(record.balance.dissipation >= records.last().unwrap().balance.dissipation, "step {}", record.step);
        records.push(record);
    }
    let active: Vec<bool> = records.iter().map(|r| r.contact.as_ref().is_some_and(|c| c.active > 0)).collect();
    let first = active.iter().position(|a| *a).unwrap();
    let last = active.iter().rposition(|a| *a).unwrap();
    let all: Vec<f64> = records.iter().map(|r| r.balance.total()).collect();
    let dissipated = records.last().unwrap().balance.dissipation / all[0];
    let spread = |e: &[f64]| e.iter().map(|x| (x / e[0] - 1.0).abs()).fold(0.0, f64::max);
    println!(
        "contact from step {first} to {last}; momenta {:.1e} {:.1e}; dissipated {dissipated:.4}; energy and dissipation before {:.1e}, after \
         {:.1e}, over the impact {:.3e}; {} cuts",
        drift(&linear),
        drift(&angular),
        spread(&all[..first]),
        spread(&all[last..]),
        all[last] / all[0] - 1.0,
        cuts(&s),
    );
    assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11);
    assert!(dissipated > 0.02);
    assert!(spread(&all[..first]) < 1e-11 && spread(&all[last..]) < 1e-10);
    assert!((all[last] / all[0] - 1.0).abs() < 2e-2);
    let rise = all.windows(2).map(|w| (w[1] - w[0]) / all[0]).fold(0.0, f64::max);
    assert!(rise < 1e-12, "energy rises by {rise:e} in a step");
}

/// A quasi-static scene of two blocks: `slab` and `block` are mesh and Young's modulus, `path` the displacement of the block's top, `more` the rest with the keys of the
/// contact last.
fn pressed(step: f64, slab: (&str, f64), block: (&str, f64), path: &str, more: &str) -> Simulation {
    simulation(&format!(
        r#"
[scene]
title = "a block is pressed on a slab"
kind = "quasi-static"
[time]
end = 1.0
step = {step}
[[body]]
name = "slab"
mesh = {{ generator = "block", {} }}
material = {{ law = "neo-hooke", young = {:?}, poisson = 0.3 }}
[[body]]
name = "block"
mesh = {{ generator = "block", {} }}
material = {{ law = "neo-hooke", young = {:?}, poisson = 0.3 }}
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.top"
components = ["x", "y", "z"]
displacement = {{ table = {path} }}
{more}
"#,
        slab.0, slab.1, block.0, block.1
    ))
}

fn cuts(s: &Simulation) -> usize {
    s.decisions().iter().filter(|d| d.kind == DecisionKind::Cut).count()
}

/// Supports that hold an edge of the slave along its normal, above a coarser master: pressures there would be more than there are motions.
#[test]
fn slave_edges_held_along_their_normal() {
    let slab = ("min = [-2, -1, -1], max = [3, 1, 0], divisions = [10, 4, 2]", 1e3);
    let block = ("min = [-0.45, -0.45, 0], max = [0.45, 0.45, 0.5], divisions = [3, 3, 2]", 1e3);
    let path = "[[0, 0, 0, 0], [0.3, 0, 0, -0.03], [1.0, 0.7, 0, -0.03]]";
    for multipliers in ["standard", "dual"] {
        for (min, max, lift) in [
            ("0.44, -0.46", "0.46, 0.46", 0.0),
            ("-0.46, 0.44", "0.46, 0.46", -0.03),
            ("-0.46, -0.46", "-0.44, 0.46", -0.06),
        ] {
            let more = format!(
                r#"
[[set]]
name = "block.edge"
body = "block"
box = {{ min = [{min}, -0.01], max = [{max}, 0.01] }}
[[prescribe]]
set = "block.edge"
components = ["z"]
displacement = {{ table = [[0, 0], [0.3, {lift}], [1.0, {lift}]] }}
[[contact]]
method = "mortar"
slave = "block.bottom"
master = "slab.top"
multipliers = "{multipliers}"
friction = {{ law = "coulomb", mu = 0.3 }}
"#
            );
            let mut s = pressed(0.05, slab, block, path, &more);
            while !s.finished() {
                s.advance().unwrap();
            }
            assert_eq!(cuts(&s), 0, "{multipliers} {min}");
            let force = force_on_upper(&s);
            assert!(force[2] > 0.0 && force[0] < -0.28 * force[2], "{multipliers} {min}: {force:?}");
        }
    }
}

/// A block whose rim lies on mesh lines of the slab, the slave, is pressed on it: its rim bulges over the lines, and covers slivers of the facets beyond.
/// Exact stick must not hold what has no area.
#[test]
fn rims_on_mesh_lines_of_the_slave() {
    let slab = ("min = [0, 0, 0], max = [3, 3, 1], divisions = [6, 6, 2]", 1e3);
    let block = ("min = [1, 1, 1], max = [2, 2, 2], divisions = [3, 3, 2]", 2e3);
    for (mu, step) in [(0.3, 0.1), (0.3, 0.01), (1.0, 0.1)] {
        let more = format!(
            r#"
[[contact]]
method = "mortar"
slave = "slab.top"
master = "block.bottom"
friction = {{ law = "coulomb", mu = {mu:?} }}
"#
        );
        let mut s = pressed(step, slab, block, "[[0, 0, 0, 0], [1.0, 0, 0, -0.1]]", &more);
        let mut last = 0.0;
        while !s.finished() {
            let balance = s.advance().unwrap().balance;
            assert!(balance.dissipation >= last, "{mu}, {step}: dissipation falls");
            let rest = balance.friction_work - balance.friction_stored - balance.dissipation;
            assert!(rest.abs() <= 1e-9 * balance.external_work, "{mu}, {step}: {balance:?}");
            last = balance.dissipation;
        }
        assert_eq!(cuts(&s), 0, "{mu}, {step}");
        assert!(force_on_upper(&s)[2] > 0.0, "{mu}, {step}");
    }
}

/// Two blocks without load, one above the other, are brought together and pressed: the first forces of all are those of the contact, with friction.
#[test]
fn the_first_touch_of_bodies_without_load() {
    let slab = ("min = [0, 0, 0], max = [2, 2, 1], divisions = [4, 4, 2]", 1e3);
    let block = ("min = [0.45, 0.4, 1.03], max = [1.5, 1.55, 2.03], divisions = [3, 3, 2]", 1e3);
    for method in ["mortar", "nts"] {
        for (slave, master) in [("block.bottom", "slab.top"), ("slab.top", "block.bottom")] {
            let more = format!(
                "[[contact]]\nmethod = \"{method}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n\
                 friction = {{ law = \"coulomb\", mu = 0.5 }}\n"
            );
            // Together, apart, and together again.
            let path = "[[0, 0, 0, 0], [0.4, 0, 0, -0.08], [0.7, 0, 0, 0], [1.0, 0.01, 0, -0.08]]";
            let mut s = pressed(0.05, slab, block, path, &more);
            let mut forces = Vec::new();
            while !s.finished() {
                let time = s.advance().unwrap().time;
                if [0.4, 0.7, 1.0].iter().any(|t| (time - t).abs() < 1e-9) {
                    forces.push(force_on_upper(&s)[2]);
                }
            }
            assert_eq!(cuts(&s), 0, "{method}, {slave}: {:?}", s.decisions());
            assert!(forces[0] > 10.0 && forces[1].abs() < 1e-9 && forces[2] > 10.0, "{method}, {slave}: {forces:?}");
        }
    }
}

/// Ironing with springs of stick, symmetric about a plane along the way: tractions of friction turn with the material as their mirror images do, so that there
/// is no force across.
#[test]
fn friction_of_mirror_images_is_a_mirror_image() {
    let slab = ("min = [0, 0, 0], max = [4, 2, 1], divisions = [8, 5, 2]", 1.0);
    let block = ("min = [0.6, 0.5, 1], max = [1.6, 1.5, 2], divisions = [3, 3, 2]", 1e3);
    let path = "[[0, 0, 0, 0], [0.3, 0, 0, -0.2], [1.0, 1.2, 0, -0.2]]";
    for (slave, master) in [("block.bottom", "slab.top"), ("slab.top", "block.bottom")] {
        let more = format!(
            "[[contact]]\nmethod = \"mortar\"\nslave = \"{slave}\"\nmaster = \"{master}\"\nenforcement = {{ penalty = 20.0 }}\n\
             friction = {{ law = \"coulomb\", mu = 0.5, penalty = 2.0 }}\n"
        );
        let mut s = pressed(0.1, slab, block, path, &more);
        let mut slid = 0.0_f64;
        while !s.finished() {
            s.advance().unwrap();
            let force = force_on_upper(&s);
            slid = slid.max(force[0].abs());
            assert!(force[1].abs() < 1e-9 * force[2], "{slave}: {force:?}");
        }
        assert!(slid > 0.01, "{slave}: {slid}");
    }
}

/// A slave whose contact nodes are dragged has as many tractions to stick with as the master has motions, or more: the plan says so before Newton's iteration does.
#[test]
fn a_dragged_finer_slave_is_told() {
    let scene = |cell: &str, [upper, lower]: [u32; 2], dragged: &str, friction: &str| {
        format!(
            r#"
[scene]
title = "dragged"
kind = "quasi-static"
[time]
end = 1.0
step = 0.1
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0, 0, 1], max = [1, 1, 1.6], divisions = [{upper}, {upper}, 2] }}
cell = "{cell}"
material = {{ law = "neo-hooke", young = 1e4, poisson = 0.3 }}
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [{lower}, {lower}, 2] }}
cell = "{cell}"
material = {{ law = "neo-hooke", young = 1e4, poisson = 0.3 }}
[[contact]]
method = "mortar"
slave = "upper.bottom"
master = "lower.top"
friction = {{ law = "coulomb", mu = 0.3{friction} }}
[[prescribe]]
set = "lower.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "upper.{dragged}"
components = ["x"]
displacement = {{ table = [[0.0, 0.0], [1.0, 0.1]] }}
[[load]]
set = "upper.top"
traction = [0, 0, -100]
"#
        )
    };
    let told = |text: String| {
        let scene = stoss::scene::parse(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
        let warnings =
            stoss::build::build(&scene, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}")).warnings;
        warnings.iter().any(|warning| warning.contains("more tractions than motions of the master"))
    };
    for cell in ["hex8", "tet10"] {
        assert!(told(scene(cell, [3, 2], "bottom", "")), "{cell}");
        assert!(!told(scene(cell, [2, 3], "bottom", "")), "{cell}: the master is finer");
        assert!(!told(scene(cell, [3, 2], "top", "")), "{cell}: the surface is free");
        assert!(!told(scene(cell, [3, 2], "bottom", ", penalty = 1e6")), "{cell}: springs");
    }
    // In plane strain the motion across is prescribed on both sides, and nothing is over-determined.
    let fixed = |set: &str| format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"y\"]\nfixed = true\n");
    assert!(!told(scene("hex8", [3, 2], "top", "") + &fixed("upper.all") + &fixed("lower.all")));
}
