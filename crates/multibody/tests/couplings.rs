//! Couplings of nodes to a body without mass.

use crate::common::{ABOUT_Z, AXES, add_body, add_constraint, finish, rod, run};
use std::ops::Range;
use std::sync::Arc;
use stoss_multibody::{
    ConstraintSet, CoordinateOptions, DriveFunction, Embedded, GradientAt, Joint, JointKind, Kernel, QuadraticEnergy,
    Quadratics, QuadraticsBuilder, RigidBody, distributing_coupling, kinematic_coupling,
};
use stoss_solver::Model;
use stoss_term::{At, Fault, ForceRule, GradientRule, Local, StepConfiguration, Term, Vectors};

/// Point masses with a spring between each two of them: a small elastic body.
#[derive(Debug)]
struct Cloud {
    own: Range<u32>,
    springs: Vec<Quadratics>,
    energy: QuadraticEnergy,
}

impl Cloud {
    fn new(first: u32, points: &[[f64; 3]], stiffness: f64) -> Self {
        let mut springs = Vec::new();
        for i in 0..points.len() {
            for j in 0..i {
                let length = (0..3).map(|k| (points[i][k] - points[j][k]).powi(2)).sum::<f64>().sqrt();
                let vector = |k: usize| Embedded::vector(first + k as u32);
                let mut builder = QuadraticsBuilder::new();
                let arm = builder.form(&vector(i).plus(-1.0, &vector(j)));
                builder.function(-0.5 * length, &[(0.5 / length, arm, arm)]);
                springs.push(builder.build());
            }
        }
        let energy = QuadraticEnergy { stiffness: vec![stiffness], rest: vec![0.0] };
        Self { own: first..first + points.len() as u32, springs, energy }
    }
}

impl Term for Cloud {
    fn name(&self) -> &str {
        "cloud"
    }
    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.springs.iter().for_each(|s| visit(s.vectors(), &[]));
    }
    fn assemble(&self, step: &At<'_>, want: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = step.rule.force() else { return Ok(()) };
        let at = match rule {
            ForceRule::Configuration { theta } => GradientAt::Configuration(theta),
            ForceRule::DiscreteGradient => GradientAt::Discrete,
        };
        let mut kernel = Kernel::default();
        for s in &self.springs {
            kernel.evaluate(s, &self.energy, step.q_n, step.q_np1, at, want);
            visit(&Local {
                nodes: s.vectors().to_vec(),
                residual: kernel.force.clone(),
                tangent: kernel.tangent.clone(),
                ..Local::default()
            });
        }
        Ok(())
    }
    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        Ok(self.springs.iter().map(|s| Kernel::default().value(s, &self.energy, q)).sum())
    }
    fn length_scale(&self) -> f64 {
        0.5
    }
    fn force_scale(&self) -> f64 {
        self.energy.stiffness[0]
    }
}

impl Vectors for Cloud {
    fn own_vectors(&self) -> Range<u32> {
        self.own.clone()
    }
    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        self.own.clone().for_each(|v| visit(v, v, 0.4));
    }
}

const POINTS: [[f64; 3]; 6] =
    [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [0.1, 0.6, 0.1], [0.0, 0.1, 0.5], [0.5, 0.5, 0.4], [-0.3, 0.3, 0.3]];
const NODES: [(u32, f64); 4] = [(1, 1.0), (2, 2.0), (4, 1.5), (5, 0.7)];

/// Velocities of a rigid motion.
fn moving(spin: [f64; 3], x: [f64; 3]) -> [f64; 3] {
    [0.2 + spin[1] * x[2] - spin[2] * x[1], spin[2] * x[0] - spin[0] * x[2], spin[0] * x[1] - spin[1] * x[0]]
}

fn cloud(model: &mut Model, spin: [f64; 3]) {
    let first = model.node_count() as u32;
    for x in POINTS {
        model.reference.extend(x);
        model.velocity.extend(moving(spin, x));
    }
    model.parts.push(Box::new(Cloud::new(first, &POINTS, 60.0)));
}

fn centre() -> [f64; 3] {
    let total: f64 = NODES.iter().map(|(_, w)| w).sum();
    std::array::from_fn(|i| NODES.iter().map(|&(n, w)| w * POINTS[n as usize][i]).sum::<f64>() / total)
}

fn frame_of(model: &mut Model, point: [f64; 3], spin: [f64; 3]) -> RigidBody {
    let axes = stoss_multibody::axes_along([0.2, 0.7, 0.4]).unwrap();
    let body = RigidBody::massless("frame", model.node_count() as u32, point, axes, 0.4).unwrap();
    model.reference.extend(body.reference().iter().flatten());
    model.velocity.extend(body.velocity(moving(spin, point), spin).iter().flatten());
    add_constraint(model, "frame rigidity", body.constraints());
    model.parts.push(Box::new(body.clone()));
    body
}

/// An elastic body that carries a rigid one by a hinge at a coupled frame, in free flight: all integrals stay, with a kinematic coupling of three nodes (nine equations
/// for the six ways to move) and with a distributing one of four.
#[test]
fn flight_with_couplings() {
    for kinematic in [true, false] {
        let spin = [0.4, -0.8, 1.1];
        let mut model = Model::default();
        cloud(&mut model, spin);
        let point = [0.3, 0.3, 0.3];
        let frame = frame_of(&mut model, point, spin);
        let coupling: ConstraintSet = if kinematic {
            kinematic_coupling("coupling", &frame, &[1, 2, 4], &model.reference).unwrap()
        } else {
            distributing_coupling("coupling", &frame, &NODES, &model.reference).unwrap()
        };
        add_constraint(&mut model, "coupling", coupling);
        let out = [0.9, 0.4, 0.2];
        let body = add_body(&mut model, "rigid", rod(0.8, out, 0.1), moving(spin, out), spin);
        let hinge = Joint::new(
            "hinge",
            JointKind::Hinge,
            &frame.frame(point, ABOUT_Z),
            &body.frame(point, ABOUT_Z),
            0.5,
            &model.reference,
        );
        let motor = DriveFunction(|t: f64| 0.3 * t * t);
        let options = CoordinateOptions { motor: Some(Arc::new(motor)), ..Default::default() };
        add_constraint(&mut model, "hinge", hinge.unwrap().with_options(options).unwrap());
        let mut simulation = run(model, 0.01, 3.0);
        let first = *simulation.balance();
        let (most, _) = finish(&mut simulation);
        let last = *simulation.balance();
        let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        let momenta =
            [apart(first.linear_momentum, last.linear_momentum), apart(first.angular_momentum, last.angular_momentum)];
        println!(
            "kinematic {kinematic}: {most} iterations, momenta {momenta:?}, energy {:e}, work {}, {:?}",
            last.total() - first.total(),
            last.external_work,
            simulation.solver_statistics().pivoting_fallbacks
        );
        assert!(momenta[0] < 1e-10 && momenta[1] < 1e-10);
        assert!((last.total() - first.total()).abs() < 1e-9);
        assert!(last.external_work.abs() > 1e-2);
        assert!(most <= 5);
    }
}

/// Whatever the multipliers, what the coupling exerts on the frame it exerts on the nodes with the other sign: force and moment about the midpoint, also with deformed nodes.
#[test]
fn force_and_torque_reach_the_nodes() {
    let mut model = Model::default();
    cloud(&mut model, [0.0; 3]);
    let frame = frame_of(&mut model, centre(), [0.0; 3]);
    let coupling = distributing_coupling("coupling", &frame, &NODES, &model.reference).unwrap();
    let move_by = |seed: f64| {
        let mut q: Vec<f64> =
            model.reference.iter().enumerate().map(|(k, x)| x + 0.1 * (seed + 3.1 * k as f64).sin()).collect();
        // The centre follows; directors need not.
        let total: f64 = NODES.iter().map(|(_, w)| w).sum();
        for i in 0..3 {
            q[18 + i] = NODES.iter().map(|&(n, w)| w * q[3 * n as usize + i]).sum::<f64>() / total;
        }
        q
    };
    let (q_n, q_np1) = (move_by(0.3), move_by(1.7));
    let multipliers = [0.3, -0.8, 0.5, 1.1, -0.4, 0.9];
    let step = StepConfiguration { q_n: &q_n, q_np1: &q_np1, rule: GradientRule::DiscreteGradient };
    let (mut sums, mut moments) = ([[0.0; 3]; 2], [[0.0; 3]; 2]);
    coupling
        .assemble(&step.at(&multipliers, &[true; 6]), false, &mut |local| {
            for (k, &node) in local.nodes.iter().enumerate() {
                let side = usize::from(node >= 6);
                let at = 3 * node as usize;
                let x: [f64; 3] = std::array::from_fn(|i| 0.5 * (q_n[at + i] + q_np1[at + i]));
                let f: [f64; 3] = std::array::from_fn(|i| -local.residual[3 * k + i]);
                for i in 0..3 {
                    sums[side][i] += if node > 6 { 0.0 } else { f[i] };
                    moments[side][i] += x[(i + 1) % 3] * f[(i + 2) % 3] - x[(i + 2) % 3] * f[(i + 1) % 3];
                }
            }
        })
        .unwrap();
    for i in 0..3 {
        assert!((sums[0][i] + sums[1][i]).abs() < 1e-14 && (moments[0][i] + moments[1][i]).abs() < 1e-14);
        assert!(moments[0][i].abs() > 1e-3);
    }
}

/// Statics: a torque of a given size on the frame turns up as the moment of the nodes, and a rigid motion of nodes turns the frame with them.
#[test]
fn the_frame_turns_with_its_nodes() {
    let mut model = Model::default();
    cloud(&mut model, [0.0; 3]);
    let frame = frame_of(&mut model, centre(), [0.0; 3]);
    let coupling = distributing_coupling("coupling", &frame, &NODES, &model.reference).unwrap();
    // A rotation about z by 0.7 and a shift.
    let (s, c) = 0.7_f64.sin_cos();
    let q: Vec<f64> = (model.reference.chunks_exact(3).enumerate())
        .flat_map(|(k, x)| {
            let shift = if k > 6 { 0.0 } else { 0.3 };
            [c * x[0] - s * x[1] + shift, s * x[0] + c * x[1] - shift, x[2] + 2.0 * shift]
        })
        .collect();
    let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::EndPoint };
    // Of a body anywhere else, too.
    let mut far = Model { reference: model.reference[..18].to_vec(), velocity: vec![0.0; 18], ..Model::default() };
    let beside = frame_of(&mut far, [2.0, -1.0, 0.7], [0.0; 3]);
    let beside = distributing_coupling("beside", &beside, &NODES, &far.reference).unwrap();
    let moved = [c * 2.0 + s + 0.3, s * 2.0 - c - 0.3, 0.7 + 0.6];
    let q_far = [&q[..18], &moved[..], &q[21..]].concat();
    beside
        .assemble(
            &StepConfiguration { q_n: &q_far, q_np1: &q_far, ..step }.at(&[0.0; 6], &[true; 6]),
            false,
            &mut |local| {
                for row in &local.residual[3 * local.nodes.len()..] {
                    assert!(row.abs() < 1e-14, "{row:e}");
                }
            },
        )
        .unwrap();
    for set in [&coupling, &kinematic_coupling("k", &frame, &[0, 1, 2, 3, 4, 5], &model.reference).unwrap()] {
        let slots = set.slot_count();
        set.assemble(&step.at(&vec![0.0; slots], &vec![true; slots]), false, &mut |local| {
            for row in &local.residual[3 * local.nodes.len()..] {
                assert!(row.abs() < 1e-14, "{row:e}");
            }
        })
        .unwrap();
    }
    let on_a_line = [(0, 1.0), (1, 1.0)];
    let middle = std::array::from_fn(|i| 0.5 * (POINTS[0][i] + POINTS[1][i]));
    let other = RigidBody::massless("other", 6, middle, AXES, 0.4).unwrap();
    assert!(
        distributing_coupling("c", &other, &on_a_line, &model.reference).unwrap_err().to_string().contains("on a line")
    );
    assert!(distributing_coupling("c", &other, &[(0, -1.0)], &model.reference).is_err());
    assert!(kinematic_coupling("c", &other, &[], &model.reference).is_err());
}
