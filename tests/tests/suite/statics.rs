//! Loads, supports and their work against closed forms.

use crate::support::simulation;
use stoss::solver::{DecisionKind, Simulation, SimulationError, StepError};

const LAMBDA: f64 = 600.0;
const MU: f64 = 400.0;

fn block(kind: &str, time: &str, divisions: [usize; 3], body: &str, conditions: &str) -> String {
    format!(
        r#"
[scene]
title = "block"
kind = "{kind}"
[time]
{time}
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = {divisions:?} }}
material = {{ law = "neo-hooke", lambda = {LAMBDA}, mu = {MU} }}
{body}
{conditions}
"#
    )
}

const SYMMETRY: &str = r#"
[[prescribe]]
set = "block.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "block.front"
components = ["y"]
fixed = true
[[prescribe]]
set = "block.bottom"
components = ["z"]
fixed = true
"#;

/// First Piola-Kirchhoff stress along a stretch `a` if the stretches are `a`, `b`, `b`, from the law's definition
/// `W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2`.
fn stress(a: f64, b: f64) -> f64 {
    let log_j = (a * b * b).ln();
    MU * (a - 1.0 / a) + LAMBDA * log_j / a
}

/// The lateral stretch at which the lateral stress vanishes, by bisection.
fn lateral(axial: f64) -> f64 {
    let f = |b: f64| MU * (b - 1.0 / b) + LAMBDA * (axial * b * b).ln() / b;
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Node of a unit block at a corner.
fn node_at(simulation: &Simulation, x: [f64; 3]) -> usize {
    let reference = &simulation.model().reference;
    (0..reference.len() / 3)
        .find(|n| (0..3).all(|i| (reference[3 * n + i] - x[i]).abs() < 1e-12))
        .expect("the block has this node")
}

#[test]
fn uniaxial_compression_and_tension() {
    for displacement in [-0.4, 0.7] {
        let conditions = format!(
            "{SYMMETRY}[[prescribe]]\nset = \"block.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0, 0], [1, {displacement:?}]] }}\n"
        );
        let text = block("quasi-static", "end = 1.0\nstep = 0.1", [2, 2, 3], "", &conditions);
        let mut simulation = simulation(&text);
        while !simulation.finished() {
            simulation.advance().unwrap();
        }
        let axial = 1.0 + displacement;
        let b = lateral(axial);
        let corner = node_at(&simulation, [1.0; 3]);
        let q = &simulation.state().q[3 * corner..3 * corner + 3];
        assert!((q[0] - b).abs() < 1e-9 && (q[1] - b).abs() < 1e-9, "{q:?}, lateral stretch {b}");
        let reference = &simulation.model().reference;
        let force: f64 = (0..reference.len() / 3)
            .filter(|n| reference[3 * n + 2] == 1.0)
            .map(|n| simulation.reactions()[3 * n + 2])
            .sum();
        let expected = stress(axial, b);
        assert!((force - expected).abs() < 1e-7 * expected.abs(), "reaction {force}, closed form {expected}");
        // Homogeneous deformation: the stored energy is that of the law, and equals the work of the supports up to the
        // load steps' quadrature.
        let log_j = (axial * b * b).ln();
        let energy = 0.5 * MU * (axial * axial + 2.0 * b * b - 3.0) - MU * log_j + 0.5 * LAMBDA * log_j * log_j;
        assert!((simulation.balance().strain - energy).abs() < 1e-9 * energy);
    }
}

#[test]
fn follower_and_dead_pressure_agree_at_small_strains_only() {
    let top = |load: &str, pressure: f64| {
        let conditions = format!("{SYMMETRY}[[load]]\nset = \"block.top\"\n{load} = {pressure:?}\n");
        let text = block("quasi-static", "end = 1.0\nstep = 1.0", [1, 1, 1], "", &conditions);
        let mut simulation = simulation(&text);
        simulation.advance().unwrap();
        let corner = node_at(&simulation, [1.0; 3]);
        simulation.state().q[3 * corner + 2] - 1.0
    };
    let young = MU * (3.0 * LAMBDA + 2.0 * MU) / (LAMBDA + MU);
    let small = 1e-5 * young;
    let (dead, follower) = (top("pressure", small), top("follower_pressure", small));
    // Both are -p/E up to terms of second order in the strain; pressure pushes inwards.
    assert!((dead + 1e-5).abs() < 1e-9, "{dead}");
    assert!((follower + 1e-5).abs() < 1e-9, "{follower}");
    // At finite strains they differ: the dead pressure is per reference area, the follower per current area.
    let large = 0.2 * young;
    let (dead, follower) = (1.0 + top("pressure", large), 1.0 + top("follower_pressure", large));
    assert!((stress(dead, lateral(dead)) + large).abs() < 1e-7 * large, "{dead}");
    let b = lateral(follower);
    assert!((stress(follower, b) + large * b * b).abs() < 1e-7 * large, "{follower}");
    assert!(follower < dead - 1e-3);
}

const EMS: &str = "integrator = { scheme = \"energy-momentum\" }";

#[test]
fn work_of_moving_supports_is_the_change_of_energy() {
    let conditions = "[[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
        displacement = { table = [[0, 0, 0, 0], [0.5, 0.2, 0, 0.1], [1.0, 0, 0.1, 0], [2, 0, 0, 0]] }\n";
    let text = block("dynamic", &format!("end = 1.0\nstep = 0.05\n{EMS}"), [1, 1, 2], "density = 10.0", conditions);
    let mut simulation = simulation(&text);
    let start = simulation.balance().total();
    let (mut scale, mut worst) = (0.0_f64, 0.0_f64);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        scale = scale.max(record.balance.kinetic + record.balance.strain);
        worst = worst.max((record.balance.total() - start).abs());
    }
    assert!(scale > 0.1, "the supports must do something, largest energy {scale}");
    assert!(simulation.balance().external_work.abs() > 1e-3 * scale);
    assert!(worst < 1e-10 * scale, "energy minus work drifts by {worst} of {scale}");
}

#[test]
fn free_fall_keeps_the_total_energy() {
    let conditions = "[[load]]\nbody = \"block\"\nbody_force = [0.0, 0.0, -98.1]\n";
    let text = block(
        "dynamic",
        &format!("end = 1.0\nstep = 0.05\n{EMS}"),
        [2, 1, 1],
        "density = 10.0\nvelocity = [1.0, 0.0, 2.0]",
        conditions,
    );
    let mut simulation = simulation(&text);
    let start = simulation.balance().total();
    // 10 / 2 (1 + 4) of kinetic energy; the potential is zero at the start.
    assert!((start - 25.0).abs() < 1e-12);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        assert!((record.balance.total() - start).abs() < 1e-11 * record.balance.kinetic.max(start));
        // Force 98.1 on mass 10: the parabola is integrated exactly.
        let t = record.time;
        let z = simulation.state().q[2];
        let z0 = simulation.model().reference[2];
        assert!((z - z0 - (2.0 * t - 0.5 * 9.81 * t * t)).abs() < 1e-11, "at {t}: {z}");
        assert!((record.balance.linear_momentum[2] - (20.0 - 98.1 * t)).abs() < 1e-10);
    }
}

fn run(text: &str) -> Simulation {
    let mut simulation = simulation(text);
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    simulation
}

fn cuts(simulation: &Simulation) -> usize {
    simulation.decisions().iter().filter(|d| d.kind == DecisionKind::Cut).count()
}

/// A cube between a fixed bottom and a platen that holds its top and presses it by `d` at time 1.
fn pressed(n: usize, d: f64, step: f64) -> String {
    let conditions = format!(
        "[[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[prescribe]]\nset = \"block.top\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
         displacement = {{ table = [[0, 0, 0, 0], [1, 0, 0, {:?}]] }}\n",
        -d
    );
    block("quasi-static", &format!("end = 1.0\nstep = {step:?}"), [n; 3], "", &conditions)
}

#[test]
fn the_interior_follows_prescribed_motion() {
    // The top moves by more than the height of an element in one step: on the boundary alone it would turn elements inside out.
    let simulation = run(&pressed(10, 0.15, 1.0));
    assert!(simulation.decisions().is_empty(), "{:?}", simulation.decisions());
    assert!(simulation.solves() <= 6, "{} solves", simulation.solves());
    // After the linear prediction the residual is of second order in the motion, and its scale, the forces, of first.
    let first_residual = |d: f64| {
        let mut simulation = self::simulation(&pressed(4, d, 1.0));
        simulation.advance().unwrap().newton[0].residual
    };
    let (a, b) = (first_residual(0.02), first_residual(0.01));
    assert!((a / b - 2.0).abs() < 0.1, "{a:e} {b:e}");
}

#[test]
fn external_work_is_of_second_order() {
    let error = |step: f64| {
        let simulation = run(&pressed(3, 0.2, step));
        (simulation.balance().external_work - simulation.balance().strain).abs() / simulation.balance().strain
    };
    let errors = [0.5, 0.25, 0.125].map(error);
    assert!(errors[0] < 0.05, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 4.0).abs() < 0.5, "{errors:?}");
    }
    let follower = |step: f64| {
        let load = "[[load]]\nset = \"block.top\"\nfollower_pressure = { table = [[0, 0], [1, 200]] }\n";
        let time = format!("end = 1.0\nstep = {step:?}");
        let simulation = run(&block("quasi-static", &time, [1, 1, 1], "", &format!("{SYMMETRY}{load}")));
        (simulation.balance().external_work - simulation.balance().strain).abs() / simulation.balance().strain
    };
    let (coarse, fine) = (follower(0.5), follower(0.25));
    assert!(coarse < 0.1 && (coarse / fine - 4.0).abs() < 0.7, "{coarse:e} {fine:e}");
}

/// `top` of a unit block turned about the vertical through its middle in so many steps.
fn twisted(bottom: &str, degrees: f64, steps: f64) -> Simulation {
    let rotation = |degrees: f64| {
        format!(
            "rotation = {{ axis = [0, 0, 2], about = [0.5, 0.5, 3], degrees = {{ table = [[0, 0], [1, {degrees:?}]] }} }}"
        )
    };
    let conditions = format!(
        "[[prescribe]]\nset = \"block.top\"\n{}\ntranslation = {{ table = [[0, 0, 0, 0], [1, 0.3, 0, 0]] }}\n\
         [[prescribe]]\nset = \"block.bottom\"\n{}\n",
        rotation(degrees),
        if bottom == "turned" {
            format!("{}\ntranslation = {{ table = [[0, 0, 0, 0], [1, 0.3, 0, 0]] }}", rotation(degrees))
        } else {
            "components = [\"x\", \"y\", \"z\"]\nfixed = true".to_owned()
        }
    );
    run(&block("quasi-static", &format!("end = 1.0\nstep = {:?}", 1.0 / steps), [3, 3, 3], "", &conditions))
}

#[test]
fn a_rigidly_turned_block_stays_free_of_stress() {
    let simulation = twisted("turned", 250.0, 5.0);
    assert!(simulation.balance().strain.abs() < 1e-10 * MU, "{}", simulation.balance().strain);
    let angle = 250.0_f64.to_radians();
    let (s, c) = angle.sin_cos();
    for (x, q) in simulation.model().reference.chunks_exact(3).zip(simulation.state().q.chunks_exact(3)) {
        let (dx, dy) = (x[0] - 0.5, x[1] - 0.5);
        let exact = [0.8 + c * dx - s * dy, 0.5 + s * dx + c * dy, x[2]];
        assert!((0..3).all(|i| (q[i] - exact[i]).abs() < 1e-10), "{q:?} {exact:?}");
    }
}

/// The torque on the turned side is the derivative of the strain energy by the angle, at a finite angle.
#[test]
fn the_torque_is_the_derivative_of_the_energy() {
    let pure = |degrees: f64| {
        let conditions = format!(
            "[[prescribe]]\nset = \"block.top\"\nrotation = {{ axis = [0, 0, 1], degrees = {{ table = [[0, 0], [1, {degrees:?}]] }} }}\n\
             [[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[probe]]\nname = \"m\"\nset = \"block.top\"\nquantity = \"reaction_moment\"\n"
        );
        block("quasi-static", "end = 1.0\nstep = 0.25", [2, 2, 2], "", &conditions)
    };
    let (at, step) = (40.0, 0.01);
    let energy = |degrees: f64| run(&pure(degrees)).balance().strain;
    let slope = (energy(at + step) - energy(at - step)) / (2.0 * step).to_radians();
    let built =
        stoss::build::build(&stoss::scene::parse(&pure(at), "t.toml").unwrap(), std::path::Path::new(".")).unwrap();
    let mut simulation = built.simulation;
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    let moment = built.probes[0].value(&simulation);
    assert!(moment[2] > 0.0 && (moment[2] / slope - 1.0).abs() < 1e-6, "{moment:?} {slope}");
}

/// In dynamics the supports have the velocity of the circle: a block that spins with both of its ends keeps its speed.
#[test]
fn turned_supports_move_with_the_circle() {
    let ends = ["top", "bottom"].map(|set| {
        format!("[[prescribe]]\nset = \"block.{set}\"\nrotation = {{ axis = [0, 0, 1], degrees = {{ table = [[0, 0], [1, 90]] }} }}\n")
    });
    let omega = std::f64::consts::FRAC_PI_2;
    let body = format!("density = 1.0\nangular_velocity = [0, 0, {omega:?}]");
    let time = "end = 0.5\nstep = 0.05\nintegrator = { scheme = \"energy-momentum\" }";
    let mut simulation = simulation(&block("dynamic", time, [2, 2, 2], &body, &ends.concat()));
    while !simulation.finished() {
        simulation.advance().unwrap();
        let (q, v) = (&simulation.state().q, &simulation.state().v);
        for n in (0..q.len() / 3).filter(|n| simulation.model().reference[3 * n + 2] != 0.5) {
            let exact = [-omega * q[3 * n + 1], omega * q[3 * n], 0.0];
            assert!((0..3).all(|i| (v[3 * n + i] - exact[i]).abs() < 1e-12));
        }
    }
    let corner = node_at(&simulation, [1.0, 0.0, 1.0]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!((simulation.state().q[3 * corner] - half).abs() < 1e-14);
    assert!((simulation.state().q[3 * corner + 1] - half).abs() < 1e-14);
}

#[test]
fn absolute_tolerance_is_a_force() {
    // The same press in two units of force: the same iterations.
    let press = |unit: f64| {
        let scene = pressed(3, 0.2, 0.25)
            .replace(&format!("lambda = {LAMBDA}"), &format!("lambda = {:?}", LAMBDA * unit))
            .replace(&format!("mu = {MU}"), &format!("mu = {:?}", MU * unit));
        let solver = format!("[solver]\nabsolute_tolerance = {:?}\nrelative_tolerance = 1e-14\n", 1e-4 * unit);
        let mut simulation = simulation(&format!("{scene}{solver}"));
        (0..4).map(|_| simulation.advance().unwrap().newton).collect::<Vec<_>>()
    };
    for (a, b) in press(1.0).iter().zip(press(1e6)) {
        assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
        for (a, b) in a.iter().zip(b) {
            assert!((a.residual - b.residual).abs() < 1e-3 * a.residual + 1e-10, "{} {}", a.residual, b.residual);
        }
        // Forces are about 100: 1e-4 is reached in a few iterations, not at once and not never.
        assert!((3..6).contains(&a.len()), "{} iterations", a.len());
    }
}

const LOWER_AND_UPPER: &str = r#"
[scene]
title = "stack"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "upper"
mesh = { generator = "block", size = [1, 1, 1], divisions = [4, 2, 2] }
position = [0.0, 0.03, 1.4999]
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[load]]
set = "upper.top"
pressure = { table = [[0, 0], [1, 50]] }
"#;

fn lower(name: &str, min: f64, max: f64) -> String {
    format!(
        r#"
[[body]]
name = "{name}"
mesh = {{ generator = "block", min = [{min:?}, -1, 0], max = [{max:?}, 1, 1], divisions = [3, 4, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[prescribe]]
set = "{name}.bottom"
components = ["x", "y", "z"]
fixed = true
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "{name}.top"
"#
    )
}

const GUIDE: &str = "[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n";

#[test]
fn a_body_held_by_contact_alone_is_pressed_on_another() {
    let scene = format!("{LOWER_AND_UPPER}{}{GUIDE}", lower("lower", -1.0, 1.0));
    let mut simulation = simulation(&scene);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let force = record.contact.unwrap().force_on_slave[2];
        // Pressure times the area 1.
        assert!((force - 50.0 * record.time).abs() < 1e-7, "{force} at {}", record.time);
    }
    assert_eq!(cuts(&simulation), 0);
}

#[test]
fn the_force_of_a_contact_pair_is_its_own() {
    // The upper body stands on two lower ones; all its bottom nodes are slaves of both pairs.
    let scene = format!("{LOWER_AND_UPPER}{}{}{GUIDE}", lower("left", -1.0, -0.0005), lower("right", 0.0005, 1.0));
    let mut simulation = simulation(&scene);
    let contact = simulation.advance().unwrap().contact.unwrap();
    let [left, right] = [0, 1].map(|pair| contact.pairs[pair].force[2]);
    assert!((contact.force_on_slave[2] - 12.5).abs() < 1e-7, "{:?}", contact.force_on_slave);
    assert!((left + right - 12.5).abs() < 1e-7 && left > 4.0 && right > 4.0, "{left} {right}");
}

#[test]
fn what_is_not_determined_is_named() {
    let fails = |scene: &str| match simulation(scene).advance() {
        Err(SimulationError::StepFailed { cause, .. }) => cause.to_string(),
        other => panic!("{other:?}"),
    };
    let load = "[[load]]\nset = \"block.top\"\npressure = 1.0\n";
    let alone = fails(&block("quasi-static", "end = 1.0\nstep = 1.0", [1; 3], "", load));
    assert!(alone.contains("node ") && alone.contains("of body block"), "{alone}");
    assert!(alone.contains("body block has no supports"), "{alone}");
    let hinged = "[[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"z\"]\nfixed = true\n";
    let rolls = fails(&block("quasi-static", "end = 1.0\nstep = 1.0", [1; 3], "", &format!("{hinged}{load}")));
    assert!(rolls.contains("too few supports"), "{rolls}");
    // What only its load brings down to the contact comes down; facets in two pairs have half of the pressure in each, and the body lies as with one pair.
    let far = format!("{LOWER_AND_UPPER}{}{GUIDE}", lower("lower", -1.0, 1.0)).replace("1.4999", "1.6");
    let record = simulation(&far).advance().unwrap();
    assert!(record.contact.is_some_and(|contact| contact.closed > 0));
    assert!(record.decisions.iter().any(|decision| decision.kind == DecisionKind::Smoothed));
    let once = format!("{LOWER_AND_UPPER}{}{GUIDE}", lower("lower", -1.0, 1.0));
    let pair =
        "[[contact]]\nname = \"second\"\nmethod = \"nts\"\nslave = \"upper.bottom\"\nmaster = \"lower.boundary\"\n";
    let [mut once, mut twice] = [simulation(&once), simulation(&format!("{once}{pair}"))];
    once.advance().unwrap();
    twice.advance().unwrap();
    let apart = once.state().q.iter().zip(&twice.state().q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
}

/// The active set and the facets of many nodes change together while an indenter slides: sets come back, but not under the same facets.
#[test]
fn an_indenter_slides_over_a_slab() {
    let scene = r#"
[scene]
title = "indenter"
kind = "quasi-static"
[time]
end = 1.0
step = 0.1
[[body]]
name = "indenter"
mesh = { generator = "indenter", size = [1, 1], height = 0.5, radius = 2.0, divisions = [6, 6, 3] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[body]]
name = "slab"
mesh = { generator = "block", min = [-1.5, -1.5, -1], max = [1.5, 1.5, 0], divisions = [9, 9, 3] }
material = { law = "neo-hooke", young = 100.0, poisson = 0.3 }
[[contact]]
method = "nts"
slave = "indenter.bottom"
master = "slab.top"
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "indenter.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [0.5, 0, 0, -0.2], [1.0, 0.5, 0, -0.2]] }
"#;
    let mut simulation = simulation(scene);
    let mut repaired = 0;
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let contact = record.contact.unwrap();
        repaired += contact.repaired;
        // The platen's reaction and the contact force are in balance.
        let platen: f64 =
            (0..simulation.model().bodies[0].nodes.len()).map(|node| simulation.reactions()[3 * node + 2]).sum();
        assert!((platen + contact.force_on_slave[2]).abs() < 1e-6, "{platen} {:?}", contact.force_on_slave);
    }
    assert_eq!(cuts(&simulation), 0, "{:?}", simulation.decisions());
    assert!(repaired > 50, "only {repaired} changes of facets, the test shows nothing");
}

#[test]
fn solves_of_failed_attempts_are_counted() {
    let scene = pressed(3, 0.3, 1.0) + "[solver]\nmax_iterations = 2\n";
    let simulation = run(&scene);
    assert!(cuts(&simulation) > 0, "the test shows nothing");
    assert_eq!(simulation.solves(), simulation.solver_statistics().factorisations);
}

#[test]
fn an_element_turned_inside_out_is_refused_or_reported() {
    // One element on a fixed bottom, one of its corners pushed along the diagonal.
    let conditions = r#"
[[set]]
name = "block.corner"
body = "block"
box = { min = [0.9, 0.9, 0.9], max = [1.1, 1.1, 1.1] }
[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.corner"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0], [1, -0.4, -0.4, -0.4]] }
"#;
    let text = block("quasi-static", "end = 1.0\nstep = 0.1", [1; 3], "", conditions);
    let mut refusing = simulation(&text);
    let error = loop {
        match refusing.advance() {
            Ok(record) => assert_eq!(record.inside_out, 0),
            Err(error) => break error,
        }
    };
    let SimulationError::StepFailed { cause, .. } = &error else { panic!("{error}") };
    assert!(matches!(&**cause, StepError::InsideOut { body, .. } if body == "block"), "{error}");
    let mut simulation = simulation(&(text + "[solver]\ninside_out = \"warn\"\n"));
    let corner = node_at(&simulation, [1.0; 3]);
    let mut counts = Vec::new();
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        // Column vectors from the corner to its three neighbours.
        let q = &simulation.state().q;
        let position = |x: [f64; 3]| {
            let at = 3 * node_at(&simulation, x);
            [q[at], q[at + 1], q[at + 2]]
        };
        let x = position([1.0; 3]);
        let edge = |y: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| x[i] - position(y)[i]) };
        let [a, b, c] = [edge([0.0, 1.0, 1.0]), edge([1.0, 0.0, 1.0]), edge([1.0, 1.0, 0.0])];
        let volume = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        assert_eq!(record.inside_out, usize::from(volume <= 0.0), "volume at corner {corner}: {volume}");
        counts.push(record.inside_out);
    }
    assert_eq!((counts[0], counts[counts.len() - 1]), (0, 1));
    let warnings: Vec<_> = simulation.decisions().iter().filter(|d| d.kind == DecisionKind::Warning).collect();
    assert_eq!(warnings.len(), 1, "once, not in every step");
    assert!(warnings[0].reason.contains("body block: 1 of 1 elements"), "{}", warnings[0].reason);
}

/// A block on a block of the same material, exactly in touch, under a pressure on top.
fn stack(method: &str, young: f64, poisson: f64, pressure: f64, step: f64) -> String {
    format!(
        r#"
[scene]
title = "stack"
kind = "quasi-static"
[time]
end = 1.0
step = {step:?}
[[body]]
name = "cube"
mesh = {{ generator = "block", min = [0, 0, 1], max = [1, 1, 2], divisions = [3, 3, 2] }}
material = {{ law = "neo-hooke", young = {young:?}, poisson = {poisson:?} }}
[[body]]
name = "base"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [3, 3, 1] }}
material = {{ law = "neo-hooke", young = {young:?}, poisson = {poisson:?} }}
[[contact]]
method = "{method}"
slave = "cube.bottom"
master = "base.top"
[[prescribe]]
set = "base.bottom"
components = ["z"]
fixed = true
[[prescribe]]
set = "base.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "base.front"
components = ["y"]
fixed = true
[[prescribe]]
set = "cube.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "cube.front"
components = ["y"]
fixed = true
[[load]]
set = "cube.top"
pressure = {{ table = [[0.0, 0.0], [1.0, {pressure:?}]] }}
"#
    )
}

/// Node of the block of `stack` on its top, and the one below it at the bottom, along the fixed edge.
const EDGE: [usize; 2] = [32, 0];

#[test]
fn a_light_load_on_bodies_in_touch_needs_no_gap() {
    for method in ["nts", "mortar"] {
        for pressure in [1e3, 1e5, 1e7] {
            let young = 2.1e11;
            let mut run = simulation(&stack(method, young, 0.3, pressure, 1.0));
            let record = run.advance().unwrap_or_else(|error| panic!("{method}, {pressure}: {error}"));
            assert!(record.iterations <= 4 && run.decisions().is_empty(), "{method}: {} iterations", record.iterations);
            assert!(run.active()[0].iter().all(|&active| active));
            let [top, bottom] = EDGE.map(|node| run.state().q[3 * node + 2]);
            let shortening = 1.0 - (top - bottom);
            let expected = pressure / young;
            assert!((shortening / expected - 1.0).abs() < 1e-3, "{method}, {pressure}: {shortening:e}, {expected:e}");
            let force: f64 = run.contact_force()[..3 * 48].iter().skip(2).step_by(3).sum();
            assert!((force / pressure - 1.0).abs() < 1e-6, "{method}, {pressure}: {force}");
        }
    }
}

#[test]
fn nearly_incompressible_bodies_in_touch_need_no_gap() {
    for method in ["nts", "mortar"] {
        let mut run = simulation(&stack(method, 1.0, 0.4999, 0.05, 0.25));
        while !run.finished() {
            let record = run.advance().unwrap_or_else(|error| panic!("{method}: {error}"));
            assert!(record.iterations <= 8, "{method}: {} iterations", record.iterations);
        }
        // Pivots of mortar contact are warned of.
        let mut decisions = run.decisions().iter();
        assert!(decisions.all(|of| of.kind == DecisionKind::Warning), "{method}: {:?}", run.decisions());
    }
}

#[test]
fn bodies_that_nothing_holds_are_told() {
    let warnings = |scene: &str| {
        let scene = stoss::scene::parse(scene, "test.toml").unwrap_or_else(|e| panic!("{e}"));
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}")).warnings
    };
    let scene = |conditions: &str| block("quasi-static", "end = 1.0\nstep = 1.0", [1, 1, 1], "", conditions);
    assert_eq!(warnings(&scene(SYMMETRY)), Vec::<String>::new());
    for (conditions, left) in [
        (String::new(), 6),
        (SYMMETRY.replace("components = [\"z\"]", "components = [\"x\"]"), 1),
        ("[[prescribe]]\nset = \"block.left\"\ncomponents = [\"x\"]\nfixed = true\n".to_owned(), 3),
    ] {
        let told = warnings(&scene(&conditions));
        let expected = format!("{left} of 6 rigid motions are free");
        assert!(told.len() == 1 && told[0].contains(&expected), "{expected}: {told:?}");
    }
    // The upper block of a stack without supports of its own.
    let stack = stack("nts", 1.0, 0.3, 0.01, 1.0);
    let loose = stack
        .replace("set = \"cube.left\"", "set = \"base.right\"")
        .replace("set = \"cube.front\"", "set = \"base.back\"");
    let told = warnings(&loose);
    assert!(told.len() == 1 && told[0].contains("supported by contact alone"), "{told:?}");
    assert_eq!(warnings(&stack), Vec::<String>::new());
}
