//! Conservation through impact and sliding.

use crate::support::{drift, simulation, simulation_in};

/// The two blocks, frictionless; the upper one is moved so that it is about to touch.
fn two_blocks(scheme: &str, constraint: &str, end: f64) -> String {
    let contact = format!("method = \"nts\"\nconstraint = \"{constraint}\"");
    crate::support::two_blocks(scheme, 0.1, end, [0.0, 0.25, -0.0985], &contact)
}

/// What a run did: balances of all states, and how many nodes closed in each step.
struct History {
    linear: Vec<[f64; 3]>,
    angular: Vec<[f64; 3]>,
    total: Vec<f64>,
    closed: Vec<usize>,
    active: Vec<usize>,
}

fn run(mut simulation: stoss::solver::Simulation) -> History {
    let first = simulation.initial_record().balance;
    let mut history = History {
        linear: vec![first.linear_momentum],
        angular: vec![first.angular_momentum],
        total: vec![first.total()],
        closed: vec![0],
        active: vec![0],
    };
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        assert!(record.decisions.is_empty(), "step {}: {:?}", record.step, record.decisions);
        let contact = record.contact.unwrap();
        history.linear.push(record.balance.linear_momentum);
        history.angular.push(record.balance.angular_momentum);
        history.total.push(record.balance.total());
        history.closed.push(contact.closed);
        history.active.push(contact.active);
    }
    history
}

fn energy_drift(total: &[f64]) -> f64 {
    total.iter().map(|e| (e - total[0]).abs()).fold(0.0, f64::max) / total[0]
}

/// Source: theory/examples#reference-values, from an independent program in Python.
#[test]
fn pressures_of_the_first_step() {
    let mut simulation = simulation(&two_blocks("energy-momentum", "modified", 0.1));
    simulation.advance().unwrap();
    let expected = [([-0.5, -0.75], 163.584), ([0.5, -0.75], 161.915), ([0.5, 0.25], 172.558), ([-0.5, 0.25], 173.772)];
    let reports = simulation.contact_report(0).unwrap();
    let reference = &simulation.model().reference;
    for (xy, pressure) in expected {
        let slot = reports
            .iter()
            .position(|r| (0..2).all(|i| (reference[3 * r.node as usize + i] - xy[i]).abs() < 1e-9))
            .expect("a slave node is there");
        let got = simulation.pressures()[0][slot];
        assert!((got - pressure).abs() < 1e-3, "at {xy:?}: {got}, expected {pressure}");
    }
}

#[test]
fn modified_constraint_keeps_everything() {
    let history = run(simulation(&two_blocks("energy-momentum", "modified", 1.4)));
    assert_eq!(history.total.len(), 15);
    assert!(history.active.contains(&4));
    assert!(drift(&history.linear) < 1e-11, "linear momentum {:e}", drift(&history.linear));
    assert!(drift(&history.angular) < 1e-11, "angular momentum {:e}", drift(&history.angular));
    assert!(energy_drift(&history.total) < 1e-12, "energy {:e}", energy_drift(&history.total));
}

#[test]
fn standard_constraint_changes_energy_only_when_a_node_closes() {
    let history = run(simulation(&two_blocks("energy-momentum", "standard", 6.0)));
    assert!(drift(&history.linear) < 1e-11);
    assert!(drift(&history.angular) < 1e-11);
    let (mut closing, mut other) = (0.0_f64, 0.0_f64);
    for n in 1..history.total.len() {
        let change = (history.total[n] - history.total[n - 1]).abs() / history.total[0];
        if history.closed[n] > 0 {
            closing = closing.max(change);
        } else {
            other = other.max(change);
        }
    }
    assert!(other < 1e-12, "energy changes by {other:e} in a step in which nothing closes");
    assert!(closing > 1e-6, "an impact must cost energy, largest change {closing:e}");
}

#[test]
fn midpoint_keeps_momenta_and_not_energy() {
    let history = run(simulation(&two_blocks("midpoint", "standard", 3.0)));
    assert!(drift(&history.linear) < 1e-11, "linear momentum {:e}", drift(&history.linear));
    assert!(drift(&history.angular) < 1e-11, "angular momentum {:e}", drift(&history.angular));
    // In steps in which nothing closes, so that it is not the impact that changes the energy.
    let other = (1..history.total.len())
        .filter(|&n| history.closed[n] == 0)
        .map(|n| (history.total[n] - history.total[n - 1]).abs() / history.total[0])
        .fold(0.0, f64::max);
    assert!(other > 1e-8, "the midpoint rule seems to keep the energy: {other:e}");
}

/// A trough of 12 x 3 hexahedra, kinked at every facet edge, as an Abaqus input file.
fn trough() -> String {
    const NX: usize = 12;
    const NY: usize = 3;
    let mut text = String::from("*NODE\n");
    let id = |i: usize, j: usize, k: usize| 1 + i + (NX + 1) * (j + (NY + 1) * k);
    for k in 0..2 {
        for j in 0..=NY {
            for i in 0..=NX {
                let x = -3.0 + 0.5 * i as f64;
                let y = -1.5 + j as f64;
                // Ripples make the facets warped and the kinks of both signs.
                let ripple = 0.02 * ((3 * i + 5 * j) % 4) as f64;
                let z = if k == 0 { 0.0 } else { 1.0 + 0.1 * x * x + ripple };
                text += &format!("{}, {x:?}, {y:?}, {z:?}\n", id(i, j, k));
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D8\n";
    for j in 0..NY {
        for i in 0..NX {
            let quad = |k| [id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k)];
            let nodes: Vec<String> = quad(0).iter().chain(&quad(1)).map(usize::to_string).collect();
            text += &format!("{}, {}\n", 1 + i + NX * j, nodes.join(", "));
        }
    }
    text
}

/// A small block glides through a coarse trough without friction: nodes change facets over kinks.
#[test]
fn sliding_over_kinks_keeps_the_energy() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("trough.inp"), trough()).unwrap();
    let text = r#"
[scene]
title = "trough"
kind = "dynamic"
[time]
end = 3.0
step = 0.02
integrator = { scheme = "energy-momentum" }
[[body]]
name = "slider"
mesh = { generator = "block", min = [-1.67, -0.31, 1.34], max = [-1.27, 0.12, 1.64], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 400, poisson = 0.3 }
density = 5.0
velocity = [0.8, 0.05, 0.0]
[[body]]
name = "trough"
mesh = { file = "trough.inp" }
material = { law = "neo-hooke", young = 800, poisson = 0.3 }
density = 5.0
[[set]]
name = "trough.face"
body = "trough"
box = { min = [-9, -9, 0.9], max = [9, 9, 9] }
[[set]]
name = "trough.ground"
body = "trough"
box = { min = [-9, -9, -0.1], max = [9, 9, 0.1] }
[[prescribe]]
set = "trough.ground"
components = ["x", "y", "z"]
fixed = true
[[load]]
body = "slider"
body_force = [0.0, 0.0, -10.0]
[[contact]]
method = "nts"
closing = "keep"
slave = "slider.bottom"
master = "trough.face"
"#;
    let mut simulation = simulation_in(text, folder.path());
    let mut last = simulation.balance().total();
    let (mut scale, mut worst, mut crossings) = (last.abs(), 0.0_f64, 0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let contact = record.contact.unwrap();
        let total = record.balance.total();
        scale = scale.max(record.balance.kinetic + record.balance.strain);
        if contact.closed == 0 {
            worst = worst.max((total - last).abs());
            if contact.active > 0 {
                crossings += contact.repaired;
            }
        }
        last = total;
    }
    assert!(crossings > 0, "no node crossed an edge in a step without closing");
    assert!(worst < 1e-11 * scale, "energy changes by {worst:e} of {scale}");
}
