//! A joint of one's own: a massless rod with ball ends that keeps the distance of two points, which is not among the kinds of `Joint`.
//!
//! Shown: a `ConstraintSet` of a function that is quadratic in positions and directors; two rigid bodies with it in a run of the solver.
//! Checked: gradient and tangent against differences; length, energy and momenta of a flight; the force of the rod in a steady rotation.
//!
//! `cargo run --example own_joint -p stoss-multibody`; docs/how-to-add/joint.md explains it.

use std::error::Error;
use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_multibody::{ConstraintSet, Embedded, Equation, QuadraticsBuilder, RigidBody, RigidMass};
use stoss_newton::NewtonOptions;
use stoss_solver::{CouplingTerm, InsideOutTreatment, Model, Settings, Simulation, StepControl};
use stoss_term::{Fault, GradientRule, Local, StepConfiguration, Term};

/// `(|x_b - x_a|^2 - l^2) / (2 l) = 0`: a length; its multiplier is the force of the rod, positive in compression.
fn rod(name: &str, a: &Embedded, b: &Embedded, length: f64) -> ConstraintSet {
    let mut builder = QuadraticsBuilder::new();
    let arm = builder.form(&b.plus(-1.0, a));
    builder.function(-0.5 * length, &[(0.5 / length, arm, arm)]);
    ConstraintSet::new(name, length, vec![Equation::each(builder.build())])
}

/// Two equal bodies with centres at `x = -1` and `x = 1`, joined by a rod between points 1/4 nearer to each other and off the line of the centres by `off`.
struct Pair {
    model: Model,
    points: [Embedded; 2],
}

const LENGTH: f64 = 1.5;
const MASS: f64 = 2.0;

fn add(model: &mut Model, name: &str, constraint: impl Term + 'static) {
    model.contacts.push(CouplingTerm::new(name, constraint, 1.0));
}

fn pair(off: f64, velocities: [[f64; 3]; 2], spins: [[f64; 3]; 2]) -> Result<Pair, Box<dyn Error>> {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut model = Model::default();
    let mut bodies = Vec::new();
    for (k, x) in [-1.0, 1.0].into_iter().enumerate() {
        let mass = RigidMass::new(MASS, [x, 0.0, 0.0], [0.06, 0.04, 0.02], axes)?;
        let body = RigidBody::new(["a", "b"][k], model.node_count() as u32, mass);
        model.reference.extend(body.reference().iter().flatten());
        model.velocity.extend(body.velocity(velocities[k], spins[k]).iter().flatten());
        add(&mut model, &format!("rigidity {k}"), body.constraints());
        model.parts.push(Box::new(body.clone()));
        bodies.push(body);
    }
    let points = [bodies[0].point([-0.75, off, 0.0]), bodies[1].point([0.75, off, 0.0])];
    add(&mut model, "rod", rod("rod", &points[0], &points[1], LENGTH));
    Ok(Pair { model, points })
}

fn simulation(model: Model) -> Result<Simulation, Box<dyn Error>> {
    let settings = Settings {
        control: StepControl { step: 0.02, end: 2.0, max_cuts: 0, grow_after: 4, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-9, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Ok(Simulation::new(model, settings)?)
}

fn largest(differences: impl IntoIterator<Item = f64>) -> f64 {
    differences.into_iter().fold(0.0, |worst, d| worst.max(d.abs()))
}

/// Tangent of residual and row against differences, for a rule of the scheme.
fn tangent_error(rule: GradientRule) -> Result<f64, Box<dyn Error>> {
    let Pair { model, points } = pair(0.1, [[0.0; 3]; 2], [[0.0; 3]; 2])?;
    let rod = rod("rod", &points[0], &points[1], LENGTH);
    let q_n = &model.reference;
    let q: Vec<f64> = q_n.iter().enumerate().map(|(i, x)| x + 0.05 * (3.0 * i as f64).sin()).collect();
    let at = |q_np1: &[f64], multiplier: f64| -> Result<Local, Fault> {
        let mut made = Local::default();
        let step = StepConfiguration { q_n, q_np1, rule };
        rod.assemble(&step.at(&[multiplier], &[true]), true, &mut |local| made = local.clone())?;
        Ok(made)
    };
    let (made, h, mut worst) = (at(&q, 0.7)?, 1e-6, 0.0_f64);
    for column in 0..made.dim() {
        let change = |h: f64| {
            let (mut q, mut multiplier) = (q.clone(), 0.7);
            match made.nodes.get(column / 3) {
                Some(&vector) => q[3 * vector as usize + column % 3] += h,
                None => multiplier += h,
            }
            at(&q, multiplier)
        };
        let (plus, minus) = (change(h)?.residual, change(-h)?.residual);
        let row = |i: usize| (plus[i] - minus[i]) / (2.0 * h) - made.tangent[i * made.dim() + column];
        worst = worst.max(largest((0..made.dim()).map(row)));
    }
    Ok(worst)
}

fn main() -> Result<(), Box<dyn Error>> {
    for rule in [GradientRule::EndPoint, GradientRule::DiscreteGradient] {
        let worst = tangent_error(rule)?;
        println!("{rule:?}: tangent against differences {worst:.1e}");
        assert!(worst < 1e-8);
    }
    // A steady rotation about the common centre: the energy-momentum scheme has the rod's force m w^2 r to round-off.
    let w = 3.0;
    let spins = [[0.0, 0.0, w]; 2];
    let mut run = simulation(pair(0.0, [[0.0, -w, 0.0], [0.0, w, 0.0]], spins)?.model)?;
    while !run.finished() {
        run.advance()?;
    }
    let force = run.pressures()[2][0];
    println!("steady rotation: force of the rod {force:.10}, closed form {:.10}", -MASS * w * w);
    assert!((force / (-MASS * w * w) - 1.0).abs() < 1e-9, "{force}");

    // A flight with spins; the velocities of the rod's ends along the rod are equal at the start.
    let off = 0.1;
    let spins = [[0.4, -1.0, 2.0], [2.0, 0.5, -3.0]];
    let along = |k: usize| off * spins[k][2];
    let velocities = [[0.3 + along(0), 0.5, 0.0], [0.3 + along(1), -1.0, 0.8]];
    let Pair { model, points } = pair(off, velocities, spins)?;
    let mut run = simulation(model)?;
    let first = *run.balance();
    println!("time   distance   energy  direction along z");
    while !run.finished() {
        let now = run.advance()?;
        let q = &run.state().q;
        let arm = points[1].plus(-1.0, &points[0]).at(q);
        let distance = arm.iter().map(|x| x * x).sum::<f64>().sqrt();
        if now.step.is_multiple_of(20) {
            println!("{:4.1} {distance:10.7} {:10.7} {:10.6}", now.time, now.balance.total(), arm[2] / distance);
        }
        let drift = |a: [f64; 3], b: [f64; 3]| largest((0..3).map(|i| a[i] - b[i]));
        assert!((distance - LENGTH).abs() < 1e-10, "{distance}");
        assert!((now.balance.total() / first.total() - 1.0).abs() < 1e-11);
        assert!(drift(now.balance.linear_momentum, first.linear_momentum) < 1e-11);
        assert!(drift(now.balance.angular_momentum, first.angular_momentum) < 1e-11);
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
