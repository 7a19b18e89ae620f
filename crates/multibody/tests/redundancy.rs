//! Redundant joints: found, named, and solved with multipliers of least norm.

use crate::common::{ABOUT_Z, AXES, add_body, add_constraint, add_weight, rod, run, run_with};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;
use stoss_multibody::{
    ConstraintSet, CoordinateOptions, Equations, Joint, JointFrame, JointKind, PiecewiseLinear, RigidBody, RigidMass,
    Weights, analyse,
};
use stoss_solver::{Model, Simulation};
use stoss_term::{GradientRule, StepConfiguration, Term};

const WEIGHTS: Weights = Weights { mass: 1.0, stiffness: 0.0 };

fn joint(name: &str, kind: JointKind, a: &JointFrame, b: &JointFrame, model: &Model) -> Joint {
    Joint::new(name, kind, a, b, 0.5, &model.reference).unwrap()
}

fn sets<'a>(rigidity: &'a [ConstraintSet], joints: &'a [Joint]) -> Vec<&'a dyn Equations> {
    rigidity.iter().map(|r| r as &dyn Equations).chain(joints.iter().map(|j| j as &dyn Equations)).collect()
}

/// Adds the joints, compliant if the analysis says so; returns the pairs, the first of the joints.
fn add_joints(model: &mut Model, bodies: &[&RigidBody], joints: &[Joint]) -> (usize, stoss_multibody::Redundancy) {
    let rigidity: Vec<_> = bodies.iter().map(|body| body.constraints()).collect();
    let found = analyse(&sets(&rigidity, joints), &model.reference, |_| true).unwrap();
    let first = model.contacts.len();
    for (k, joint) in joints.iter().enumerate() {
        let mut joint = joint.clone();
        if found.involved.contains(&(k + bodies.len())) {
            joint.set_redundant(Some(WEIGHTS));
        }
        add_constraint(model, "joint", joint);
    }
    (first, found)
}

/// Gradients of all functions as columns, without what the rigidity of the bodies takes.
fn gradients(sets: &[Joint], bodies: &[&RigidBody], q_n: &[f64], q_np1: &[f64], rule: GradientRule) -> DMatrix<f64> {
    let step = StepConfiguration { q_n, q_np1, rule };
    let of = |set: &dyn Term| {
        let slots = set.slot_count();
        let mut columns = DMatrix::<f64>::zeros(q_n.len(), slots);
        for slot in 0..slots {
            let mut multipliers = vec![0.0; slots];
            multipliers[slot] = 1.0;
            set.assemble(&step.at(&multipliers, &vec![true; slots]), false, &mut |local| {
                for (k, &node) in local.nodes.iter().enumerate() {
                    for i in 0..3 {
                        columns[(3 * node as usize + i, slot)] -= local.residual[3 * k + i];
                    }
                }
            })
            .unwrap();
        }
        columns
    };
    let all: Vec<_> = sets.iter().map(|set| of(set)).collect();
    let (mut g, mut at) = (DMatrix::<f64>::zeros(q_n.len(), all.iter().map(|g| g.ncols()).sum()), 0);
    for columns in &all {
        g.view_mut((0, at), (q_n.len(), columns.ncols())).copy_from(columns);
        at += columns.ncols();
    }
    let mut projector = DMatrix::<f64>::identity(q_n.len(), q_n.len());
    for body in bodies {
        let r = of(&body.constraints());
        let gram = (r.transpose() * &r).cholesky().unwrap().inverse();
        projector -= &r * gram * r.transpose();
    }
    projector * g
}

/// Orthonormal combinations of the columns that vanish.
fn null_space(g: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = (g.transpose() * g).symmetric_eigen();
    let columns: Vec<_> =
        (0..g.ncols()).filter(|&k| eigen.eigenvalues[k] < 1e-8).map(|k| eigen.eigenvectors.column(k)).collect();
    DMatrix::from_columns(&columns)
}

/// Multipliers of the joints less those of the pseudo-inverse, relative to the largest of them, for the same resultants `G f`: those that are combinations of the gradients at the
/// end of the step, `l = H^T y` with `G H^T y = f`. Where forces are taken at the end they are those of least norm.
fn distance_to_least_norm(
    simulation: &Simulation,
    first: usize,
    q_n: &[f64],
    bodies: &[&RigidBody],
    joints: &[Joint],
    rule: GradientRule,
) -> f64 {
    let q_np1 = &simulation.state().q;
    let g = gradients(joints, bodies, q_n, q_np1, rule);
    let h = gradients(joints, bodies, q_n, q_np1, GradientRule::EndPoint);
    let multipliers = simulation.pressures()[first..first + joints.len()].iter().flatten().copied();
    let found = DVector::from_iterator(g.ncols(), multipliers);
    // What of them is in the null space: `l - N c` is at right angles to that of `H`. (nalgebra's SVD is not accurate enough here.)
    let (null_g, null_h) = (null_space(&g), null_space(&h));
    assert_eq!(null_g.ncols(), null_h.ncols());
    let part = (null_h.transpose() * &null_g).lu().solve(&(null_h.transpose() * &found)).unwrap();
    let least = &found - null_g * part;
    (&found - &least).amax() / found.amax()
}

/// Runs with the energy-momentum scheme; returns the largest number of iterations in a step, and the largest distance from the multipliers of least norm.
fn run_to_end(simulation: &mut Simulation, first: usize, bodies: &[&RigidBody], joints: &[Joint]) -> (u32, f64) {
    let (mut most, mut worst) = (0, 0.0_f64);
    while !simulation.finished() {
        let q_n = simulation.state().q.clone();
        most = most.max(simulation.advance().unwrap().iterations);
        worst =
            worst.max(distance_to_least_norm(simulation, first, &q_n, bodies, joints, GradientRule::DiscreteGradient));
    }
    (most, worst)
}

fn door(hinges: u8) -> (Model, RigidBody, Vec<Joint>) {
    let mut model = Model::default();
    let mass = RigidMass::new(2.0, [0.4, 0.1, 1.0], [0.1, 0.03, 0.3], AXES).unwrap();
    let door = add_body(&mut model, "door", mass, [0.0; 3], [0.0; 3]);
    // A skew axis, so that the door falls.
    let axis = stoss_multibody::axes_along([0.3, -0.5, 1.0]).unwrap();
    let joints = (0..hinges)
        .map(|k| {
            let at: [f64; 3] = std::array::from_fn(|i| f64::from(k) * 0.7 * axis[0][i]);
            joint(
                &format!("door-{}", k + 1),
                JointKind::Hinge,
                &JointFrame::ground(at, axis),
                &door.frame(at, axis),
                &model,
            )
        })
        .collect();
    add_weight(&mut model, &[&door], [0.0, 0.0, -9.81]);
    (model, door, joints)
}

/// A door on three hinges moves as one on a single hinge does, with multipliers of least norm.
#[test]
fn a_door_on_three_hinges() {
    let (mut model, body, joints) = door(3);
    let (first, found) = add_joints(&mut model, &[&body], &joints);
    assert_eq!((found.equations, found.rank), (21, 11));
    assert_eq!(
        found.messages,
        [
            "hinge door-2: 5 of its 5 equations follow from others",
            "hinge door-3: 5 of its 5 equations follow from others"
        ]
    );
    assert_eq!(found.involved, [1, 2, 3]);
    let mut simulation = run(model, 0.01, 4.0);
    let (mut single, body_1, joints_1) = door(1);
    let (first_1, _) = add_joints(&mut single, &[&body_1], &joints_1);
    let mut single = run(single, 0.01, 4.0);
    let start = *simulation.balance();
    let (mut worst, mut apart, mut most) = (0.0_f64, 0.0_f64, 0);
    while !simulation.finished() {
        let q_n = simulation.state().q.clone();
        let record = simulation.advance().unwrap();
        single.advance().unwrap();
        most = most.max(record.iterations);
        worst = worst.max(distance_to_least_norm(
            &simulation,
            first,
            &q_n,
            &[&body],
            &joints,
            GradientRule::DiscreteGradient,
        ));
        // Resultant of the forces of the joints on the door.
        let resultant = |run: &Simulation, joints: &[Joint], first: usize| {
            let force = |(k, joint): (usize, &Joint)| {
                joint.force(&q_n, &run.state().q, GradientRule::DiscreteGradient, &run.pressures()[first + k]).0
            };
            joints
                .iter()
                .enumerate()
                .map(force)
                .fold([0.0; 3], |sum: [f64; 3], f| std::array::from_fn(|i| sum[i] + f[i]))
        };
        let (three, one) = (resultant(&simulation, &joints, first), resultant(&single, &joints_1, first_1));
        assert!((0..3).all(|i| (three[i] - one[i]).abs() < 1e-7 * 2.0 * 9.81), "{three:?} {one:?}");
        let both = simulation.state().q.iter().zip(&single.state().q);
        apart = apart.max(both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
    }
    let energy = simulation.balance().total() - start.total();
    println!("door: {most} iterations, least norm {worst:e}, motion {apart:e}, energy {energy:e}");
    assert!(worst < 1e-6, "{worst:e}");
    assert!(apart < 1e-9, "{apart:e}");
    assert!(energy.abs() < 1e-9, "{energy:e}");
    assert!(most <= 6);
}

/// Three bearings of a door that stick, all on the same angle, and slide together: the door falls as with one bearing that has all of the friction.
#[test]
fn friction_in_redundant_bearings() {
    use stoss_multibody::CoordinateFriction;
    let run_door = |bounds: &[f64]| {
        let (mut model, body, joints) = door(bounds.len() as u8);
        let joints: Vec<_> = (joints.into_iter().zip(bounds))
            .map(|(joint, &bound)| {
                let friction = Some(CoordinateFriction { bound, ..Default::default() });
                joint.with_options(CoordinateOptions { friction, ..Default::default() }).unwrap()
            })
            .collect();
        add_joints(&mut model, &[&body], &joints);
        let mut simulation = run(model, 0.01, 2.0);
        let start = *simulation.balance();
        let mut path = Vec::new();
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            assert!((record.balance.total() - start.total()).abs() < 1e-9);
            path.push(simulation.state().q[0]);
        }
        path
    };
    let largest = |path: &[f64]| path.iter().map(|x| (x - 0.4).abs()).fold(0.0, f64::max);
    let (three, one) = (run_door(&[0.3, 0.2, 0.1]), run_door(&[0.6]));
    let apart = three.iter().zip(&one).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("bearings: {apart:e}, moved by {}", largest(&one));
    assert!(apart < 1e-8 && largest(&one) > 0.01);
    assert!(largest(&run_door(&[5.0, 5.0, 5.0])) < 1e-9);
}

/// A plane loop of four links on four parallel hinges has three redundant equations. It turns freely in space: momenta and energy stay.
#[test]
fn a_loop_of_four_links() {
    let mut model = Model::default();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.2, 0.8, 0.0], [0.1, 0.9, 0.0]];
    let mut bodies = Vec::new();
    let spin = [0.3, 0.2, 1.0];
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        let c: [f64; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        let v = [spin[1] * c[2] - spin[2] * c[1], spin[2] * c[0] - spin[0] * c[2], spin[0] * c[1] - spin[1] * c[0]];
        bodies.push(add_body(&mut model, "link", rod(1.0 + 0.3 * k as f64, c, 0.1), v, spin));
    }
    // Two opposite forces for a while would break the balance; unequal links deform the loop as it turns.
    let joints: Vec<_> = (0..4)
        .map(|k| {
            let at = corners[(k + 1) % 4];
            let (a, b) = (&bodies[k], &bodies[(k + 1) % 4]);
            joint(&format!("pin-{k}"), JointKind::Hinge, &a.frame(at, ABOUT_Z), &b.frame(at, ABOUT_Z), &model)
        })
        .collect();
    let bodies: Vec<&RigidBody> = bodies.iter().collect();
    let (first, found) = add_joints(&mut model, &bodies, &joints);
    assert_eq!((found.equations, found.rank), (44, 41));
    assert_eq!(found.messages, ["hinge pin-3: 3 of its 5 equations follow from others"]);
    let mut simulation = run(model, 0.01, 5.0);
    let start = *simulation.balance();
    let (most, worst) = run_to_end(&mut simulation, first, &bodies, &joints);
    let end = *simulation.balance();
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    let momenta =
        [apart(start.linear_momentum, end.linear_momentum), apart(start.angular_momentum, end.angular_momentum)];
    println!(
        "loop: {most} iterations, least norm {worst:e}, momenta {momenta:?}, energy {:e}",
        end.total() - start.total()
    );
    println!("{:?}", simulation.solver_statistics());
    let size = |p: [f64; 3]| p.iter().map(|p| p * p).sum::<f64>().sqrt();
    assert!(momenta[0] < 1e-11 * size(start.linear_momentum) && momenta[1] < 1e-11 * size(start.angular_momentum));
    assert!((end.total() / start.total() - 1.0).abs() < 1e-10);
    assert!(worst < 1e-6, "{worst:e}");
}

/// 18 welds between two bodies: 102 redundant equations.
#[test]
fn a_hundred_redundant_equations() {
    let mut model = Model::default();
    let spin = [0.5, 1.0, -0.7];
    let one = add_body(&mut model, "one", rod(1.0, [0.0; 3], 0.3), [0.0; 3], spin);
    let at = [0.8, 0.3, -0.2];
    let v = [spin[1] * at[2] - spin[2] * at[1], spin[2] * at[0] - spin[0] * at[2], spin[0] * at[1] - spin[1] * at[0]];
    let two = add_body(&mut model, "two", rod(1.7, at, 0.2), v, spin);
    let joints: Vec<_> = (0..18)
        .map(|k| {
            let t = f64::from(k);
            let at = [0.3 * t.sin(), 0.2 * t.cos(), 0.1 * (2.0 * t).sin()];
            let axes = stoss_multibody::axes_along([t.cos(), t.sin(), 0.3]).unwrap();
            joint("weld", JointKind::Weld, &one.frame(at, axes), &two.frame(at, axes), &model)
        })
        .collect();
    let bodies = [&one, &two];
    let (first, found) = add_joints(&mut model, &bodies, &joints);
    assert_eq!(found.equations - found.rank, 102);
    let mut simulation = run(model, 0.01, 2.0);
    let start = *simulation.balance();
    let (most, worst) = run_to_end(&mut simulation, first, &bodies, &joints);
    let end = *simulation.balance();
    println!("welds: {most} iterations, least norm {worst:e}, energy {:e}", end.total() / start.total() - 1.0);
    for i in 0..3 {
        assert!((start.angular_momentum[i] - end.angular_momentum[i]).abs() < 1e-10);
    }
    assert!((end.total() / start.total() - 1.0).abs() < 1e-10);
    assert!(worst < 1e-6, "{worst:e}");
}

/// Motors that disagree and loops that do not close are errors; those that agree are redundant.
#[test]
fn contradictions() {
    let (model, body, _) = door(1);
    let ground = |at: f64| JointFrame::ground([0.0, 0.0, at], ABOUT_Z);
    let motor = |at: f64, target: f64| {
        let options =
            CoordinateOptions { motor: Some(Arc::new(PiecewiseLinear(vec![(0.0, target)]))), ..Default::default() };
        joint(&format!("motor at {at}"), JointKind::Hinge, &ground(at), &body.frame([0.0, 0.0, at], ABOUT_Z), &model)
            .with_options(options)
            .unwrap()
    };
    let rigidity = [body.constraints()];
    let agreeing = [motor(0.0, 0.0), motor(1.0, 0.0)];
    let found = analyse(&sets(&rigidity, &agreeing), &model.reference, |_| true).unwrap();
    assert_eq!(found.messages, ["hinge motor at 1: 6 of its 6 equations follow from others"]);
    let error = analyse(&sets(&rigidity, &[motor(0.0, 0.0), motor(1.0, 0.3)]), &model.reference, |_| true).unwrap_err();
    assert!(error.to_string().contains("motor at 1: equation 6"), "{error}");
    // With the body held there is nothing to solve for; a motor that would move it is a contradiction all the same.
    let found = analyse(&sets(&[], &agreeing[..1]), &model.reference, |_| false).unwrap();
    assert_eq!((found.rank, found.redundant.len()), (0, 0));
    assert!(analyse(&sets(&[], &[motor(0.0, 0.3)]), &model.reference, |_| false).is_err());
}

/// A chain of 100 bodies takes well below a second, in any order of the joints.
#[test]
fn a_chain_of_a_hundred_bodies() {
    let mut model = Model::default();
    let bodies: Vec<_> = (0..100)
        .map(|k| add_body(&mut model, "link", rod(1.0, [f64::from(k) + 0.5, 0.0, 0.0], 0.1), [0.0; 3], [0.0; 3]))
        .collect();
    let rigidity: Vec<_> = bodies.iter().map(|body| body.constraints()).collect();
    let mut joints: Vec<_> = (1..100)
        .map(|k| {
            let at = [f64::from(k as u8), 0.0, 0.0];
            let axes = stoss_multibody::axes_along([0.0, (k as f64).sin(), 1.0]).unwrap();
            joint("link", JointKind::Hinge, &bodies[k - 1].frame(at, axes), &bodies[k].frame(at, axes), &model)
        })
        .collect();
    for stride in [1, 37] {
        let order: Vec<_> = (0..99).map(|k| joints[k * stride % 99].clone()).collect();
        let clock = std::time::Instant::now();
        let found = analyse(&sets(&rigidity, &order), &model.reference, |_| true).unwrap();
        println!("chain of 100: {:?}", clock.elapsed());
        assert_eq!((found.equations, found.rank, found.involved.len()), (1095, 1095, 0));
    }
    joints.reverse();
    let at = [50.0, 0.0, 0.0];
    joints.push(joint("twice", JointKind::Ball, &bodies[49].frame(at, AXES), &bodies[50].frame(at, AXES), &model));
    let found = analyse(&sets(&rigidity, &joints), &model.reference, |_| true).unwrap();
    assert_eq!(found.messages, ["ball twice: 3 of its 3 equations follow from others"]);
}

/// Under a scheme that takes all at the end of the step the multipliers are those of the pseudo-inverse.
#[test]
fn least_norm_at_the_end_of_a_step() {
    let (mut model, body, joints) = door(3);
    let (first, _) = add_joints(&mut model, &[&body], &joints);
    let mut simulation = run_with(model, 0.01, 2.0, Some(Box::new(stoss_integrators::BackwardEuler)));
    let mut worst = 0.0_f64;
    while !simulation.finished() {
        let q_n = simulation.state().q.clone();
        simulation.advance().unwrap();
        worst = worst.max(distance_to_least_norm(&simulation, first, &q_n, &[&body], &joints, GradientRule::EndPoint));
    }
    println!("door, backward Euler: least norm {worst:e}");
    assert!(worst < 1e-6, "{worst:e}");
}
