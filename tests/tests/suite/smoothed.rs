//! Static steps by smoothed complementarity: what they leave.

use crate::failing::text_of;
use crate::support::simulation;
use stoss::solver::{DecisionKind, Simulation};

/// A fine plate is pressed into a coarse block as a whole, and along it: more pressures than motions.
const PLATE: &str = r#"
[scene]
title = "A plate that is moved as a whole"
kind = "quasi-static"
[time]
end = 10.0
step = 1.0
[[body]]
name = "lower"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [3, 3, 2] }
material = { law = "neo-hooke", young = 100.0, poisson = 0.3 }
[[body]]
name = "upper"
mesh = { generator = "block", min = [0.5, 0.5, 1], max = [1.5, 1.5, 1.3], divisions = [6, 6, 1] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[contact]]
method = "mortar"
slave = "upper.bottom"
master = "lower.top"
[[prescribe]]
set = "lower.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "upper.all"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [3, 0, 0, -0.1], [10, 0.42, 0, -0.1]] }
"#;

fn count(simulation: &Simulation, kind: DecisionKind) -> usize {
    simulation.decisions().iter().filter(|decision| decision.kind == kind).count()
}

fn to_end(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Runs a scene to its end twice, once with a break after the first step of which a decision begins with `words`, and compares the bits.
fn same_bits_if_resumed_after(text: &str, words: &str) -> Simulation {
    let mut whole = simulation(text);
    to_end(&mut whole);
    let mut stopped = simulation(text);
    while !stopped.decisions().iter().any(|decision| decision.reason.starts_with(words)) {
        assert!(!stopped.finished(), "no step was {words}");
        stopped.advance().unwrap();
    }
    assert!(!stopped.finished(), "nothing is left after the step that was {words}");
    let mut resumed = simulation(text);
    resumed.restore(stopped.checkpoint("t", Default::default()), "t").unwrap();
    to_end(&mut resumed);
    assert_eq!(whole.state().q, resumed.state().q);
    assert_eq!(whole.pressures(), resumed.pressures());
    assert_eq!(whole.active(), resumed.active());
    whole
}

#[test]
fn a_run_resumed_after_a_smoothed_step_has_the_same_bits() {
    // With friction it is smoothed as well, and what slides is on its cone at the end.
    for friction in ["", "friction = { law = \"coulomb\", mu = 0.4 }\n"] {
        let text = PLATE.replacen("[[prescribe]]", &format!("{friction}[[prescribe]]"), 1);
        let whole = same_bits_if_resumed_after(&text, "contact smoothed");
        assert_eq!(count(&whole, DecisionKind::Cut), 0);
        // No tension, and no row of a closed slot that is open.
        let pairs = whole.pressures().iter().zip(whole.active());
        assert!(
            pairs.flat_map(|(p, closed)| p.iter().zip(closed)).all(|(p, closed)| *p >= 0.0 && (*closed || *p == 0.0))
        );
        let report = whole.contact_report(0).unwrap();
        let closed = report.iter().zip(&whole.active()[0]).filter(|(_, closed)| **closed);
        for (report, _) in closed {
            let Some(friction) = &report.friction else { continue };
            let size = friction.traction[0].hypot(friction.traction[1]);
            assert!(size <= friction.bound * (1.0 + 1e-9), "{size} of {}", friction.bound);
        }
    }
}

#[test]
fn a_run_resumed_after_a_step_with_springs_has_the_same_bits() {
    same_bits_if_resumed_after(LOADED, "held by springs");
}

/// One block on another, which a traction presses down: general contact alone holds it, and has no stiffness before.
const LOADED: &str = r#"
[scene]
title = "A block that contact alone holds"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "low"
mesh = { generator = "block", min = [-1, -1, 0], max = [1, 1, 1], divisions = [3, 4, 2] }
material = { law = "saint-venant-kirchhoff", young = 1200.0, poisson = 0.0 }
[[body]]
name = "up"
mesh = { generator = "block", min = [-1, -1, 1], max = [1, 1, 2], divisions = [3, 4, 2] }
material = { law = "saint-venant-kirchhoff", young = 1200.0, poisson = 0.0 }
[[prescribe]]
set = "low.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "up.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "up.front"
components = ["y"]
fixed = true
[[load]]
set = "up.top"
traction = { table = [[0, 0, 0, 0], [1, 0, 0, -12.0]] }
[general_contact]
"#;

#[test]
fn a_block_that_general_contact_alone_holds_is_loaded_by_a_force() {
    let mut run = simulation(LOADED);
    to_end(&mut run);
    assert_eq!(count(&run, DecisionKind::Cut), 0);
    // A bar of length 2 under the dead traction, E (L^3 - L) / 2 = -12 with the stretch L; the layer takes its part.
    let stretch = (0..60).fold(1.0_f64, |l, _| l - (600.0 * (l * l * l - l) + 12.0) / (600.0 * (3.0 * l * l - 1.0)));
    let top = run.model().bodies[1].nodes.clone().map(|node| 3 * node as usize + 2);
    let reference = &run.model().reference;
    let moved: Vec<f64> = top.filter(|&c| reference[c] > 2.0 - 1e-9).map(|c| run.state().q[c] - reference[c]).collect();
    let mean = moved.iter().sum::<f64>() / moved.len() as f64;
    assert!((mean / (2.0 * (stretch - 1.0)) - 1.0).abs() < 0.06, "{mean} {stretch}");
}

#[test]
fn a_trial_that_fails_leaves_no_trace() {
    let mut run = simulation(&text_of("contact-cycles"));
    let failed = loop {
        let before = run.checkpoint("t", Default::default());
        if run.finished() {
            panic!("it ran to its end");
        }
        if run.advance().is_err() {
            break before;
        }
    };
    assert!(count(&run, DecisionKind::Smoothed) > 0);
    let after = run.checkpoint("t", Default::default());
    assert_eq!(failed.state.q, after.state.q);
    assert_eq!(failed.slots, after.slots);
}
