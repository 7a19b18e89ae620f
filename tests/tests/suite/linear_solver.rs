//! The linear solvers that a scene can choose, and what their analysis costs while contacts open and close.

use crate::support::simulation;

/// A slightly tilted block falls on a plate; its lower nodes are near the plate from the start and hit it one after another.
fn scene(linear: &str, divisions: u32) -> String {
    format!(
        r#"
[scene]
title = "tilted block"
kind = "dynamic"
[time]
end = 0.1
step = 0.002
integrator = {{ scheme = "energy-momentum" }}
[solver]
linear = "{linear}"
[[body]]
name = "plate"
mesh = {{ generator = "block", min = [-1, -1, -1], max = [2, 2, 0], divisions = [5, 5, 2] }}
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
density = 1.0
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [{divisions}, {divisions}, {divisions}] }}
rotation = {{ axis = [1, 2, 0], degrees = 2 }}
position = [0.07, 0.11, 0.05]
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
density = 1.0
velocity = [0, 0, -3]
[[prescribe]]
set = "plate.bottom"
components = ["x", "y", "z"]
fixed = true
[[contact]]
method = "nts"
slave = "block.bottom"
master = "plate.top"
"#
    )
}

#[test]
fn all_solvers_give_the_same_motion() {
    let end = |linear: &str, name: &str| {
        let mut simulation = simulation(&scene(linear, 3));
        while !simulation.finished() {
            simulation.advance().unwrap();
        }
        assert_eq!(simulation.solver_name(), name);
        assert_eq!(simulation.solver_statistics().pivoting_fallbacks, 0);
        simulation.state().q.clone()
    };
    let reference = end("faer", "faer");
    for (linear, name) in [("multifrontal", "multifrontal"), ("auto", "multifrontal")] {
        let difference = end(linear, name).iter().zip(&reference).fold(0f64, |m, (a, b)| m.max((a - b).abs()));
        // Newton's tolerance, amplified by an impact.
        assert!(difference < 1e-8, "{linear}: {difference:e}");
    }
}

/// End-point rules without friction give a symmetric saddle point, and `L D L^T` the motion of LU. In test builds the solver compares matrix and
/// transpose wherever it announces them as equal.
#[test]
fn symmetric_where_the_rule_is() {
    for (scheme, symmetric) in
        [("backward-euler", true), ("newmark", true), ("hht", false), ("midpoint", false), ("energy-momentum", false)]
    {
        let end = |linear: &str| {
            let text = scene(linear, 3).replace("energy-momentum", scheme).replace("end = 0.1", "end = 0.05");
            let mut simulation = simulation(&text);
            let mut closed = 0;
            while !simulation.finished() {
                closed += simulation.advance().unwrap().contact.unwrap().closed;
            }
            let counts = simulation.solver_statistics();
            assert!(closed > 0, "{scheme}: no contact");
            assert_eq!(counts.symmetric, if symmetric { counts.factorisations } else { 0 }, "{scheme}");
            assert_eq!(counts.pivoting_fallbacks, 0, "{scheme}");
            simulation.state().q.clone()
        };
        let reference = end("faer");
        let difference = end("multifrontal").iter().zip(&reference).fold(0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(difference < 1e-8, "{scheme}: {difference:e}");
    }
}

/// More than fifty equations are the multifrontal solver's.
#[test]
fn a_larger_system_is_multifrontal() {
    let mut simulation = simulation(&scene("auto", 6));
    simulation.advance().unwrap();
    assert_eq!(simulation.solver_name(), "multifrontal");
}

/// Nodes close and open; the pattern changes only where a node comes to another facet.
#[test]
fn the_active_set_needs_no_new_analysis() {
    let mut simulation = simulation(&scene("multifrontal", 3));
    let (mut steps, mut repaired) = (0, 0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let contact = record.contact.unwrap();
        steps += u64::from(contact.closed + contact.released > 0);
        repaired += contact.repaired;
    }
    let analyses = simulation.solver_statistics().analyses;
    assert!(steps >= 8, "{steps} steps with changes");
    assert!(analyses <= 2, "{analyses} analyses, {steps} steps with changes, {repaired} repaired");
}
