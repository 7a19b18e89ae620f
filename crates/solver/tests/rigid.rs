//! Rigid bodies in whole runs: what the energy-momentum scheme keeps.

use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_multibody::{RigidBody, RigidMass};
use stoss_newton::NewtonOptions;
use stoss_solver::{CouplingTerm, InsideOutTreatment, Model, Settings, Simulation, StepControl};

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn add(name: &str, model: &mut Model, mass: RigidMass, velocity: [f64; 3], spin: [f64; 3]) {
    let body = RigidBody::new(name, model.node_count() as u32, mass);
    model.reference.extend(body.reference().iter().flatten());
    model.velocity.extend(body.velocity(velocity, spin).iter().flatten());
    model.contacts.push(CouplingTerm {
        name: format!("{name} rigidity"),
        acts: true,
        term: Box::new(body.constraints()),
        complementarity: 1.0,
        restitution: None,
    });
    model.parts.push(Box::new(body));
}

fn simulation(model: Model, step: f64, end: f64) -> Simulation {
    let settings = Settings {
        control: StepControl { step, end, max_cuts: 0, grow_after: 4, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-9, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Simulation::new(model, settings).unwrap()
}

/// An unsymmetric body in free flight: all ten integrals stay, five iterations a step at the most.
#[test]
fn free_flight_keeps_momenta_and_energy() {
    let mut model = Model::default();
    let mass = RigidMass::new(2.0, [0.3, -0.2, 0.5], [0.4, 0.25, 0.1], AXES).unwrap();
    add("top", &mut model, mass, [0.3, 0.1, -0.2], [3.0, 0.2, 7.0]);
    let mut simulation = simulation(model, 0.02, 20.0);
    let first = *simulation.balance();
    let mut most = 0;
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        most = most.max(record.iterations);
    }
    let last = *simulation.balance();
    for i in 0..3 {
        assert!((first.linear_momentum[i] - last.linear_momentum[i]).abs() < 1e-12);
        assert!((first.angular_momentum[i] - last.angular_momentum[i]).abs() < 1e-11);
    }
    assert!((first.total() / last.total() - 1.0).abs() < 1e-12, "{} {}", first.total(), last.total());
    assert!(most <= 5, "{most} iterations");
}
