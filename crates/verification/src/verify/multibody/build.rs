//! Models of rigid bodies, joints, beams and strings in memory, and what a run of them keeps.

use crate::verify::numbers::{apart, larger};
use crate::workspace::Outcome;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use stoss_integrators::{EnergyMomentum, Scheme};
use stoss_linalg::AutoSolver;
use stoss_multibody::{Beam, CoordinateOptions, Joint, JointFrame, JointKind, RigidBody, RigidMass};
use stoss_newton::{LineSearch, NewtonOptions};
use stoss_solver::{
    Balance, CouplingTerm, InsideOutTreatment, Load, LoadKind, Model, Prescription, Settings, Simulation, StepControl,
    StepRecord, Table,
};
use stoss_term::{At, Fault, ForceRule, Local, Term};

/// The directions of space.
pub const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Axes whose first is z.
pub const ABOUT_Z: [[f64; 3]; 3] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Residuals and constraints relative to their scales.
const TOLERANCE: f64 = 1e-9;

/// `a x b`.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Three numbers of a vector.
pub fn place(q: &[f64], vector: u32) -> [f64; 3] {
    let at = 3 * vector as usize;
    [q[at], q[at + 1], q[at + 2]]
}

/// Observed order of two errors at a step and at half of it.
pub fn order(errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).log2()
}

/// Adds a body that turns about a point, with its rigidity.
pub fn add_body(model: &mut Model, name: &str, mass: RigidMass, about: [f64; 3], spin: [f64; 3]) -> RigidBody {
    let arm: [f64; 3] = std::array::from_fn(|i| mass.centre[i] - about[i]);
    let body = RigidBody::new(name, model.node_count() as u32, mass);
    add_vectors(model, &body.reference(), &body.velocity(cross(spin, arm), spin));
    add_constraint(model, &format!("{name} rigidity"), body.constraints());
    model.parts.push(Box::new(body.clone()));
    body
}

/// Adds vectors with velocities.
pub fn add_vectors(model: &mut Model, reference: &[[f64; 3]], velocity: &[[f64; 3]]) {
    model.reference.extend(reference.iter().flatten());
    model.velocity.extend(velocity.iter().flatten());
    model.velocity.resize(model.reference.len(), 0.0);
}

/// Adds equations; returns their place.
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

/// Adds a joint; returns its place.
pub fn add_joint(
    model: &mut Model,
    name: &str,
    kind: JointKind,
    sides: [&JointFrame; 2],
    options: CoordinateOptions,
) -> Outcome<usize> {
    let joint = Joint::new(name, kind, sides[0], sides[1], 0.5, &model.reference)?.with_options(options)?;
    Ok(add_constraint(model, name, joint))
}

/// Adds a beam whose nodes `held` do not move.
pub fn add_beam(model: &mut Model, beam: &Beam, held: &[usize]) {
    add_vectors(model, &beam.reference(), &[]);
    let fixed: Vec<u32> = held.iter().flat_map(|&i| beam.node_vectors(i)).collect();
    fix(model, &fixed);
    add_constraint(model, &format!("{} rigidity", beam.name()), beam.constraints_except(held));
    model.parts.push(Box::new(beam.clone()));
}

/// The frame of a node of a beam along `axes`.
pub fn beam_frame(beam: &Beam, node: usize, axes: [[f64; 3]; 3]) -> JointFrame {
    JointFrame { point: beam.centre(node), axes: axes.map(|axis| beam.direction(node, axis)) }
}

/// Vectors that stay where they are.
pub fn fix(model: &mut Model, vectors: &[u32]) {
    if vectors.is_empty() {
        return;
    }
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

/// Weights of all parts so far.
pub fn add_gravity(model: &mut Model, acceleration: [f64; 3]) {
    let mut pattern = Vec::new();
    for part in &model.parts {
        part.weight(acceleration, &mut |v, f| pattern.extend((0..3).map(|d| (3 * v + d, f[d as usize]))));
    }
    add_load(model, "weight", pattern, Table::constant(&[1.0]));
}

/// A force on a vector, times a function of time.
pub fn add_force(model: &mut Model, vector: u32, force: [f64; 3], rows: &[[f64; 2]]) -> Outcome<()> {
    let pattern = (0..3).map(|d| (3 * vector + d, force[d as usize])).collect();
    let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    add_load(model, "force", pattern, Table::from_rows(&rows, 1)?);
    Ok(())
}

fn add_load(model: &mut Model, name: &str, pattern: Vec<(u32, f64)>, magnitude: Table) {
    model.loads.push(Load { name: name.into(), kind: LoadKind::Dead { patterns: vec![pattern] }, magnitude });
}

/// A run by the energy-momentum scheme.
pub fn dynamic(model: Model, step: f64, end: f64) -> Outcome<Simulation> {
    with_scheme(model, step, end, Some(Box::new(EnergyMomentum)))
}

/// A run as of [`dynamic`], with so many halvings of a step.
pub fn dynamic_cutting(model: Model, step: f64, end: f64, cuts: u32) -> Outcome<Simulation> {
    with_options(model, step, end, cuts, Some(Box::new(EnergyMomentum)))
}

/// A run by any scheme; steps are not cut.
pub fn with_scheme(model: Model, step: f64, end: f64, scheme: Option<Box<dyn Scheme>>) -> Outcome<Simulation> {
    with_options(model, step, end, 0, scheme)
}

fn with_options(
    model: Model,
    step: f64,
    end: f64,
    max_cuts: u32,
    scheme: Option<Box<dyn Scheme>>,
) -> Outcome<Simulation> {
    let settings = Settings {
        control: StepControl { step, end, max_cuts, grow_after: 4, automatic: None },
        scheme,
        newton: NewtonOptions {
            relative_tolerance: TOLERANCE,
            line_search: LineSearch::Off,
            ..NewtonOptions::default()
        },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Ok(Simulation::new(model, settings)?)
}

/// What changed in a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    /// Largest distance of each component from the start.
    pub linear: [f64; 3],
    /// Largest distance of angular momentum about the origin from the start.
    pub angular: [f64; 3],
    /// Largest distance of the energy from the start, with what closing gaps and limits of joints have cost.
    pub energy: f64,
    /// Largest change in a step: linear and angular momentum (any component), energy.
    pub in_step: [f64; 3],
    /// Most Newton iterations of a step, and all.
    pub iterations: [u32; 2],
    /// Steps.
    pub steps: u64,
}

impl Kept {
    fn see(&mut self, first: &Balance, before: &Balance, now: &Balance, iterations: u32) {
        for i in 0..3 {
            self.linear[i] = larger(self.linear[i], (now.linear_momentum[i] - first.linear_momentum[i]).abs());
            self.angular[i] = larger(self.angular[i], (now.angular_momentum[i] - first.angular_momentum[i]).abs());
        }
        let sum = |balance: &Balance| balance.total() + balance.closing_loss;
        self.energy = larger(self.energy, (sum(now) - sum(first)).abs());
        let changes = [
            apart(now.linear_momentum, before.linear_momentum),
            apart(now.angular_momentum, before.angular_momentum),
            (sum(now) - sum(before)).abs(),
        ];
        self.in_step = std::array::from_fn(|i| larger(self.in_step[i], changes[i]));
        self.iterations = [self.iterations[0].max(iterations), self.iterations[1] + iterations];
        self.steps += 1;
    }
}

/// Runs to the end and looks after each step.
pub fn follow(simulation: &mut Simulation, mut look: impl FnMut(&Simulation, &StepRecord)) -> Outcome<Kept> {
    let first = *simulation.balance();
    let (mut kept, mut before) = (Kept::default(), first);
    while !simulation.finished() {
        let record = simulation.advance()?;
        kept.see(&first, &before, &record.balance, record.iterations);
        before = record.balance;
        look(simulation, &record);
    }
    Ok(kept)
}

/// A moment about a fixed axis on three directors of length `l`. Turning them by `d theta` does the work `m . d theta` with `d theta = 1/2 sum d_k x dd_k`,
/// thus the forces `m x D_k / (2 l^2)`.
#[derive(Clone, Debug)]
pub struct Couple {
    directors: [u32; 3],
    length: f64,
    axis: [f64; 3],
    magnitude: Arc<AtomicU64>,
}

impl Couple {
    /// A couple on a node of a beam; without magnitude at first.
    pub fn on(beam: &Beam, node: usize, axis: [f64; 3]) -> Self {
        let [_, a, b, c] = beam.node_vectors(node);
        Self { directors: [a, b, c], length: beam.director_length(), axis, magnitude: Arc::default() }
    }

    /// Sets the moment of the steps to come, of this and of its clones.
    pub fn set(&self, moment: f64) {
        self.magnitude.store(moment.to_bits(), Ordering::Relaxed);
    }
}

impl Term for Couple {
    fn name(&self) -> &str {
        "couple"
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(&self.directors, &[]);
    }

    fn assemble(&self, step: &At<'_>, want: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = step.rule.force() else { return Ok(()) };
        let theta = if rule == ForceRule::END_POINT { 1.0 } else { 0.5 };
        let mut local = Local { nodes: self.directors.to_vec(), ..Local::default() };
        local.reset(want);
        let m = f64::from_bits(self.magnitude.load(Ordering::Relaxed)) / (2.0 * self.length * self.length);
        let [x, y, z] = self.axis.map(|a| -m * a);
        let matrix = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for (k, &vector) in self.directors.iter().enumerate() {
            let (from, to) = (place(step.q_n, vector), place(step.q_np1, vector));
            for i in 0..3 {
                for j in 0..3 {
                    local.residual[3 * k + i] += matrix[i][j] * ((1.0 - theta) * from[j] + theta * to[j]);
                    if want {
                        local.tangent[(3 * k + i) * 9 + 3 * k + j] = theta * matrix[i][j];
                    }
                }
            }
        }
        visit(&local);
        Ok(())
    }

    fn length_scale(&self) -> f64 {
        self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jumps in a step and distances from the start are two things.
    #[test]
    fn kept_quantities() {
        let at = |kinetic: f64, l: f64| Balance { kinetic, angular_momentum: [0.0, 0.0, l], ..Balance::default() };
        let (a, b, c) = (at(1.0, 5.0), at(1.5, 4.0), at(2.0, 4.5));
        let mut kept = Kept::default();
        kept.see(&a, &a, &b, 3);
        kept.see(&a, &b, &c, 2);
        assert_eq!((kept.energy, kept.angular[2], kept.in_step), (1.0, 1.0, [0.0, 1.0, 0.5]));
        assert_eq!((kept.iterations, kept.steps), ([3, 5], 2));
    }
}
