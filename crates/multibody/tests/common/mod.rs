//! Models of rigid bodies and joints for whole runs.
#![allow(dead_code, reason = "each test file uses its part")]

use stoss_integrators::{EnergyMomentum, Scheme};
use stoss_linalg::AutoSolver;
use stoss_multibody::{RigidBody, RigidMass};
use stoss_newton::{LineSearch, NewtonOptions};
use stoss_solver::{CouplingTerm, InsideOutTreatment, Load, LoadKind, Model, Settings, Simulation, StepControl, Table};
use stoss_term::Term;

pub const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Frames whose first axis is z.
pub const ABOUT_Z: [[f64; 3]; 3] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Adds a body with its rigidity; returns it for frames.
pub fn add_body(model: &mut Model, name: &str, mass: RigidMass, velocity: [f64; 3], spin: [f64; 3]) -> RigidBody {
    let body = RigidBody::new(name, model.node_count() as u32, mass);
    model.reference.extend(body.reference().iter().flatten());
    model.velocity.extend(body.velocity(velocity, spin).iter().flatten());
    add_constraint(model, &format!("{name} rigidity"), body.constraints());
    model.parts.push(Box::new(body.clone()));
    body
}

pub fn add_constraint(model: &mut Model, name: &str, constraint: impl Term + 'static) -> usize {
    model.contacts.push(CouplingTerm {
        name: name.to_owned(),
        acts: true,
        term: Box::new(constraint),
        complementarity: 1.0,
        restitution: None,
    });
    model.contacts.len() - 1
}

/// Gravity on the centres of bodies.
pub fn add_weight(model: &mut Model, bodies: &[&RigidBody], gravity: [f64; 3]) {
    let mut pattern = Vec::new();
    for body in bodies {
        let first = body.centre().terms[0].0;
        pattern.extend((0..3).map(|i| (3 * first + i, body.mass().mass * gravity[i as usize])));
    }
    model.loads.push(Load {
        name: "weight".into(),
        kind: LoadKind::Dead { patterns: vec![pattern] },
        magnitude: Table::constant(&[1.0]),
    });
}

pub fn run_with(model: Model, step: f64, end: f64, scheme: Option<Box<dyn Scheme>>) -> Simulation {
    let settings = Settings {
        control: StepControl { step, end, max_cuts: 0, grow_after: 4, automatic: None },
        scheme,
        newton: NewtonOptions { relative_tolerance: 1e-9, line_search: LineSearch::Off, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Simulation::new(model, settings).unwrap()
}

pub fn run(model: Model, step: f64, end: f64) -> Simulation {
    run_with(model, step, end, Some(Box::new(EnergyMomentum)))
}

/// Runs to the end; returns iterations: most of a step, and all.
pub fn finish(simulation: &mut Simulation) -> (u32, u32) {
    let (mut most, mut all) = (0, 0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        most = most.max(record.iterations);
        all += record.iterations;
    }
    (most, all)
}

pub fn rod(mass: f64, centre: [f64; 3], inertia: f64) -> RigidMass {
    // About z: E_1 + E_2.
    RigidMass::new(mass, centre, [0.5 * inertia, 0.5 * inertia, 0.2 * inertia], AXES).unwrap()
}
