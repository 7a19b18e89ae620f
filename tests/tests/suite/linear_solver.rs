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

/// The slaves of a mortar row are all nodes around it; the multipliers of each row are eliminated with its own. (They were with the one of the smallest number: fronts had no pivots.)
#[test]
fn multipliers_of_mortar_contact_and_friction_have_pivots() {
    let text = r#"
[scene]
title = "a stiff block on a soft one"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "block"
mesh = { generator = "block", min = [0.5, 0.5, 1.0], max = [1.5, 1.5, 2.0], divisions = [4, 4, 3] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[body]]
name = "slab"
mesh = { generator = "block", min = [0.0, 0.0, 0.0], max = [3.0, 2.0, 1.0], divisions = [9, 6, 3] }
material = { law = "neo-hooke", young = 1.0, poisson = 0.3 }
[[contact]]
method = "mortar"
slave = "block.bottom"
master = "slab.top"
friction = { law = "coulomb", mu = 0.5 }
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.top"
components = ["x", "y", "z"]
displacement = { table = [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, -0.1], [1.0, 0.2, 0.0, -0.1]] }
"#;
    let mut simulation = simulation(text);
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    let counts = simulation.solver_statistics();
    assert!(counts.factorisations >= 4 && simulation.active()[0].iter().any(|active| *active));
    assert_eq!(counts.pivoting_fallbacks, 0, "of {}", counts.factorisations);
}

/// A crank has two joints and is the first body of both; the whole mechanism has no freedom left, so that its bodies make one group.
#[test]
fn a_mechanism_without_freedom_is_factorised_once() {
    let text = r#"
[scene]
title = "crank press"
kind = "dynamic"
[time]
end = 0.05
step = 0.005
integrator = { scheme = "energy-momentum" }
[solver]
linear = "multifrontal"
factors = "new"
[[rigid]]
name = "crank"
shape = { kind = "box", size = [0.06, 0.02, 0.02] }
position = [0.025, 0, 0]
density = 7850.0
angular_velocity = [0, 6, 0]
velocity = [0, 0, -0.15]
[[rigid]]
name = "rod"
shape = { kind = "box", size = [0.02, 0.02, 0.15] }
position = [0.025, 0.03, "-sqrt(0.15^2 - 0.05^2) / 2"]
rotation = { axis = [0, 1, 0], degrees = "degrees(asin(1 / 3))" }
density = 7850.0
velocity = [0, 0, -0.3]
[[rigid]]
name = "ram"
shape = { kind = "box", size = [0.08, 0.08, 0.04] }
position = [0, 0, "-sqrt(0.15^2 - 0.05^2) - 0.02"]
density = 7850.0
velocity = [0, 0, -0.3]
[[body]]
name = "pad"
mesh = { generator = "block", size = [0.06, 0.06, 0.04], divisions = [3, 3, 2] }
position = [0, 0, -1]
material = { law = "neo-hooke", young = 4e6, poisson = 0.4 }
density = 1200.0
[[joint]]
name = "shaft"
kind = "hinge"
between = ["ground", "crank"]
at = [0, 0, 0]
axis = [0, 1, 0]
motor = { angle = { table = [[0, 0], [1, "degrees(6)"]] } }
[[joint]]
name = "big-end"
kind = "cylindrical"
between = ["crank", "rod"]
at = [0.05, 0, 0]
axis = [0, 1, 0]
[[joint]]
name = "small-end"
kind = "ball"
between = ["rod", "ram"]
at = [0, 0, "-sqrt(0.15^2 - 0.05^2)"]
[[joint]]
name = "guide"
kind = "slider"
between = ["ground", "ram"]
at = [0, 0, "-sqrt(0.15^2 - 0.05^2)"]
axis = [0, 0, 1]
"#;
    let mut simulation = simulation(text);
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    let counts = simulation.solver_statistics();
    assert!(counts.factorisations > 20, "{counts:?}");
    assert_eq!(counts.pivoting_fallbacks, 0, "of {}", counts.factorisations);
}

/// Nodes close and open while the equations are solved by iteration.
#[test]
fn iteration_gives_the_motion_of_factorisation() {
    let end = |linear: &str| {
        let mut simulation = simulation(&scene(linear, 8).replace("end = 0.1", "end = 0.05"));
        let mut closed = 0;
        while !simulation.finished() {
            closed += simulation.advance().unwrap().contact.unwrap().closed;
        }
        assert!(closed > 0);
        (simulation.state().q.clone(), simulation.solver_statistics(), simulation.solver_name().to_owned())
    };
    let (iterated, counts, name) = end("iterative");
    assert_eq!(name, "smoothed aggregation");
    assert!(counts.iterative_solves > 50 && counts.factorisations == 0 && counts.handed_over == 0, "{counts:?}");
    let difference = iterated.iter().zip(&end("multifrontal").0).fold(0f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(difference < 1e-8, "{difference:e}");
}

/// Balances hang on Newton's method and its polish, not on the accuracy of the linear solutions.
#[test]
fn momenta_and_energy_are_kept_by_inexact_solutions() {
    let text = r#"
[scene]
title = "a block in flight"
kind = "dynamic"
[time]
end = 0.4
step = 0.02
integrator = { scheme = "energy-momentum" }
[solver]
linear = "iterative"
[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [8, 8, 8] }
material = { law = "neo-hooke", young = 1e3, poisson = 0.3 }
density = 1.0
velocity = [1.0, 2.0, 0.5]
angular_velocity = [12.0, 4.0, 10.0]
"#;
    let mut simulation = simulation(text);
    let first = *simulation.balance();
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    let (last, counts) = (simulation.balance(), simulation.solver_statistics());
    assert!(counts.iterative_solves >= 60 && counts.factorisations == 0, "{counts:?}");
    // Loose on purpose: some four iterations a solution.
    assert!(counts.iterations < 8 * counts.iterative_solves, "{counts:?}");
    let before = first.kinetic + first.strain;
    let drift = (last.kinetic + last.strain - before).abs() / before;
    let of = |a: [f64; 3], b: [f64; 3]| {
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        size([0, 1, 2].map(|i| a[i] - b[i])) / size(b)
    };
    let linear = of(last.linear_momentum, first.linear_momentum);
    let angular = of(last.angular_momentum, first.angular_momentum);
    assert!(drift < 1e-12 && linear < 1e-12 && angular < 1e-12, "{drift:e} {linear:e} {angular:e}");
}

/// A column that is pushed beyond its critical load without an imperfection: the tangent has negative directions, and they are counted by factorisation whatever solves the other systems.
#[test]
fn directions_of_falling_energy_are_counted_all_the_same() {
    let text = |linear: &str| {
        format!(
            r#"
[scene]
title = "a straight column"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[solver]
linear = "{linear}"
[[body]]
name = "column"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 12], divisions = [3, 3, 36] }}
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
[[prescribe]]
set = "column.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "column.top"
components = ["z"]
displacement = {{ table = [[0.0, 0.0], [1.0, -0.6]] }}
"#
        )
    };
    let run = |linear: &str| {
        let mut simulation = simulation(&text(linear));
        let mut unstable = Vec::new();
        while !simulation.finished() {
            unstable.push(simulation.advance().unwrap().unstable);
        }
        (unstable, simulation.solver_statistics())
    };
    let (direct, _) = run("multifrontal");
    let (iterated, counts) = run("iterative");
    println!("{direct:?} {iterated:?} {counts:?}");
    assert!(counts.iterative_solves > 0 && counts.factorisations > 0, "{counts:?}");
    assert_eq!(direct.last(), iterated.last(), "{direct:?} {iterated:?}");
}
