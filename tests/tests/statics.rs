//! Loads, supports and their work against closed forms.

mod support;

use support::simulation;

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
fn node_at(simulation: &stoss::solver::Simulation, x: [f64; 3]) -> usize {
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
