//! Models of beams and strings for the tests.
#![allow(dead_code, reason = "every test file uses some of it")]

use stoss_integrators::{EnergyMomentum, Scheme};
use stoss_linalg::AutoSolver;
use stoss_multibody::{Beam, ConstraintSet, Embedded, Equation, QuadraticsBuilder};
use stoss_newton::NewtonOptions;
use stoss_solver::{
    CouplingTerm, InsideOutTreatment, Load, LoadKind, Model, Prescription, Settings, Simulation, StepControl,
    StepRecord, Table,
};

pub fn simulation(model: Model, dynamic: bool, step: f64, end: f64) -> Simulation {
    let settings = Settings {
        control: StepControl { step, end, max_cuts: 0, grow_after: 4, automatic: None },
        scheme: dynamic.then(|| Box::new(EnergyMomentum) as Box<dyn Scheme>),
        newton: NewtonOptions { relative_tolerance: 1e-9, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Simulation::new(model, settings).unwrap()
}

pub fn constrain(model: &mut Model, name: &str, set: ConstraintSet) {
    model.contacts.push(CouplingTerm {
        name: name.to_owned(),
        acts: true,
        term: Box::new(set),
        complementarity: 1.0,
        restitution: None,
    });
}

/// Adds vectors at rest.
pub fn vectors(model: &mut Model, reference: &[[f64; 3]]) {
    model.reference.extend(reference.iter().flatten());
    model.velocity.resize(model.reference.len(), 0.0);
}

/// Adds a beam whose nodes `held` do not move.
pub fn beam(model: &mut Model, beam: Beam, held: &[usize]) {
    vectors(model, &beam.reference());
    let fixed: Vec<u32> = held.iter().flat_map(|&i| beam.node_vectors(i)).collect();
    fix(model, &fixed);
    constrain(model, "rigidity", beam.constraints_except(held));
    model.parts.push(Box::new(beam));
}

pub fn fix(model: &mut Model, vectors: &[u32]) {
    if !vectors.is_empty() {
        model.prescriptions.push(Prescription {
            name: "fixed".into(),
            nodes: vectors.to_vec(),
            directions: Vec::new(),
            components: vec![0, 1, 2],
            displacement: Table::constant(&[0.0; 3]),
            rotation: None,
            ramp_until: None,
        });
    }
}

/// The force of a vector from zero to `force` at time 1.
pub fn ramp(model: &mut Model, vector: u32, force: [f64; 3]) {
    let pattern = (0..3).map(|d| (3 * vector + d, force[d as usize])).collect();
    model.loads.push(Load {
        name: "ramp".to_owned(),
        kind: LoadKind::Dead { patterns: vec![pattern] },
        magnitude: Table::from_rows(&[vec![0.0, 0.0], vec![1.0, 1.0]], 1).unwrap(),
    });
}

/// Constant weights of all parts.
pub fn gravity(model: &mut Model, acceleration: [f64; 3]) {
    let mut pattern = Vec::new();
    for part in &model.parts {
        part.weight(acceleration, &mut |v, f| pattern.extend((0..3).map(|d| (3 * v + d, f[d as usize]))));
    }
    model.loads.push(Load {
        name: "gravity".to_owned(),
        kind: LoadKind::Dead { patterns: vec![pattern] },
        magnitude: Table::constant(&[1.0]),
    });
}

/// Two points are one.
pub fn joined(name: &str, a: &Embedded, b: &Embedded) -> ConstraintSet {
    let mut builder = QuadraticsBuilder::new();
    let gap = builder.form(&a.plus(-1.0, b));
    for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        let axis = builder.form(&Embedded::ground(axis));
        builder.function(0.0, &[(1.0, gap, axis)]);
    }
    ConstraintSet::new(name, 1.0, vec![Equation::each(builder.build())])
}

/// Prints residuals and increments of a step, and returns the increments.
pub fn newton(what: &str, record: &StepRecord) -> Vec<f64> {
    let of = |f: fn(&stoss_solver::NewtonRow) -> f64| record.newton.iter().map(f).collect::<Vec<_>>();
    println!("{what}: residuals {}", brief(&of(|row| row.residual)));
    let increments: Vec<f64> = of(|row| row.increment).into_iter().filter(|i| *i > 0.0).collect();
    println!("{what}: increments {}", brief(&increments));
    increments
}

/// Order of convergence seen in the last three increments above round-off, `ln(c/b) / ln(b/a)`: about 2.
pub fn assert_quadratic(increments: &[f64], length: f64) {
    let above: Vec<f64> = increments.iter().copied().filter(|i| *i > 1e-12 * length).collect();
    let [.., a, b, c] = above[..] else { panic!("{}", brief(increments)) };
    let order = (c / b).ln() / (b / a).ln();
    assert!(a > b && b > c && order > 1.6, "order {order} of {}", brief(increments));
}

pub fn place(q: &[f64], vector: u32) -> [f64; 3] {
    let at = 3 * vector as usize;
    [q[at], q[at + 1], q[at + 2]]
}

/// Numbers with two digits.
pub fn brief(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:.1e}")).collect::<Vec<_>>().join(" ")
}
