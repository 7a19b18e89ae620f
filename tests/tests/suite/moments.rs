//! Loads by moments through scenes: exact balance of angular momentum and energy, a beam rolled up to a circle, and the reaction of a clamped block.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use stoss::build::{Built, Probe, build};
use stoss::solver::Simulation;

fn run(text: &str, mut look: impl FnMut(&Simulation, &dyn Fn(&str) -> [f64; 3])) {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    let Built { mut simulation, probes, .. } = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    while !simulation.finished() {
        simulation.advance().unwrap();
        let value = |name: &str| probes.iter().find(|probe: &&Probe| probe.name == name).unwrap().value(&simulation);
        look(&simulation, &value);
    }
}

/// A free body: `J(t) = J_0 + m t`, about a principal axis from rest (then the angle is `m t^2 / (2 I)`) and about any axis with a spin; the work of the moment is the
/// change of the energy.
#[test]
fn a_free_body_takes_the_moment_exactly() {
    for (moment, spin, principal) in [([0.0, 0.0, 0.3], [0.0; 3], true), ([0.4, -0.2, 0.3], [1.0, 2.0, -3.0], false)] {
        let text = format!(
            r#"
[scene]
title = "free body"
kind = "dynamic"
[time]
end = 4.0
step = 0.05
integrator = {{ scheme = "energy-momentum" }}
[[rigid]]
name = "body"
mass = 2.0
inertia = [0.3, 0.2, 0.4]
angular_velocity = {spin:?}
[[load]]
set = "body.all"
moment = {moment:?}
[[probe]]
name = "j"
quantity = "angular_momentum"
body = "body"
[[probe]]
name = "w"
quantity = "angular_velocity"
body = "body"
"#
        );
        let start = [0.3 * spin[0], 0.2 * spin[1], 0.4 * spin[2]];
        let mut energy = None;
        run(&text, |simulation, value| {
            let (time, j) = (simulation.state().time, value("j"));
            for i in 0..3 {
                assert!((j[i] - start[i] - moment[i] * time).abs() < 1e-11, "{time}: {j:?}");
            }
            let balance = simulation.balance();
            let kinetic = 0.5 * (0.3 * spin[0] * spin[0] + 0.2 * spin[1] * spin[1] + 0.4 * spin[2] * spin[2]);
            assert!(
                (balance.total() - *energy.get_or_insert(kinetic)).abs() < 1e-10,
                "{:e}",
                balance.total() - kinetic
            );
            if principal {
                assert!((value("w")[2] - 0.75 * time).abs() < 0.02 * time, "{:?}", value("w"));
            }
        });
    }
}

/// A force and a moment under every scheme that carries constraints: they agree where the step is small.
#[test]
fn every_scheme_takes_it() {
    for scheme in [
        "scheme = \"midpoint\"",
        "scheme = \"trapezoidal\"",
        "scheme = \"backward-euler\"",
        "scheme = \"generalised-alpha\", rho_inf = 0.8",
        "scheme = \"variational-midpoint\"",
    ] {
        let text = format!(
            r#"
[scene]
title = "free body"
kind = "dynamic"
[time]
end = 1.0
step = 0.01
integrator = {{ {scheme} }}
[[rigid]]
name = "body"
mass = 2.0
inertia = [0.3, 0.2, 0.4]
[[load]]
set = "body.all"
moment = [0, 0, 0.8]
[[probe]]
name = "w"
quantity = "angular_velocity"
body = "body"
"#
        );
        let mut last = [0.0; 3];
        run(&text, |_, value| last = value("w"));
        assert!((last[2] - 2.0).abs() < 0.02 && last[0].abs() < 1e-9 && last[1].abs() < 1e-9, "{scheme}: {last:?}");
    }
}

/// A cantilever under the moment `2 pi EI / L` at its end becomes a circle, whatever its stiffness in shear: the end is back at the start, turned by a full turn.
#[test]
fn a_cantilever_rolls_up_to_a_circle() {
    let (length, stiffness) = (2.0, 3.0);
    let mut errors = Vec::new();
    for elements in [6, 12] {
        let text = format!(
            r#"
[scene]
title = "roll-up"
kind = "quasi-static"
[time]
end = 1.0
step = 0.05
[[beam]]
name = "beam"
points = [[0, 0, 0], [{length}, 0, 0]]
elements = {elements}
order = 2
up = [0, 0, 1]
section = {{ axial = 1e4, shear = [1e3, 1e3], bending = [{stiffness}, {stiffness}], torsion = 2.0 }}
[[joint]]
name = "clamp"
kind = "weld"
between = ["ground", "beam.start"]
at = [0, 0, 0]
[[load]]
set = "beam.end"
moment = {{ table = [[0.0, 0, 0, 0], [1.0, 0, {moment}, 0]] }}
[[probe]]
name = "end"
quantity = "position"
set = "beam.end"
[[probe]]
name = "m"
quantity = "joint_moment"
joint = "clamp"
"#,
            moment = TAU * stiffness / length,
        );
        let (mut end, mut half, mut moment) = ([f64::NAN; 3], [f64::NAN; 3], [f64::NAN; 3]);
        let mut energy = [0.0; 2];
        run(&text, |simulation, value| {
            if (simulation.state().time - 0.5).abs() < 1e-9 {
                half = value("end");
            }
            (end, moment) = (value("end"), value("m"));
            energy = [simulation.balance().strain, simulation.balance().external_work];
        });
        // Half of the moment makes half a circle, of the radius L / pi, downwards about +y.
        let expected = [0.0, 0.0, -2.0 * length / PI];
        let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        errors.push([distance(end, [0.0; 3]) / length, distance(half, expected) / length]);
        // The ground gets the moment.
        assert!((moment[1] - TAU * stiffness / length).abs() < 1e-7 && moment[0].abs() + moment[2].abs() < 1e-7);
        // M^2 L / (2 EI); in load steps the work is that of the trapezium rule of a force that turns.
        let stored = 0.5 * (TAU * stiffness / length).powi(2) * length / stiffness;
        assert!((energy[0] / stored - 1.0).abs() < 0.03 && (energy[1] / energy[0] - 1.0).abs() < 0.03, "{energy:?}");
    }
    println!("{errors:?}");
    assert!(errors[1].iter().all(|e| *e < 1e-3), "{errors:?}");
    assert!((0..2).all(|k| errors[1][k] < 0.3 * errors[0][k]), "{errors:?}");
}

/// A moment on the coupled end of a block that is clamped at the other: the reaction has the opposite moment, and no force.
#[test]
fn the_support_of_a_block_has_the_opposite_moment() {
    for coupling in ["kinematic", "distributing"] {
        let text = format!(
            r#"
[scene]
title = "block"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 2], divisions = [2, 2, 4] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "block.top"
moment = {{ table = [[0.0, 0, 0, 0], [1.0, 8, -3, 5]] }}
coupling = "{coupling}"
[[probe]]
name = "f"
quantity = "reaction"
set = "block.bottom"
[[probe]]
name = "m"
quantity = "reaction_moment"
set = "block.bottom"
"#
        );
        let (mut force, mut moment) = ([f64::NAN; 3], [f64::NAN; 3]);
        run(&text, |_, value| (force, moment) = (value("f"), value("m")));
        for (found, expected) in moment.into_iter().zip([-8.0, 3.0, -5.0]) {
            assert!((found - expected).abs() < 1e-8, "{coupling}: {moment:?}");
        }
        assert!(force.iter().all(|f| f.abs() < 1e-8), "{coupling}: {force:?}");
    }
}
