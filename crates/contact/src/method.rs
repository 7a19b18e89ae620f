//! The trait of a contact discretisation.

use crate::ContactError;

/// Where the gradient of the gap is taken that makes the contact force `A p G` of a step (theory/node-to-surface#residual).
///
/// The constraint row is `-A` times the gap at `q_np1` (less the gap that it refers to) under every rule, for pressures that are multipliers;
/// otherwise see [`crate::Enforcement`]. The forces
/// of every rule have no resultant; about which configuration they have no moment is said for each.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ContactRule {
    /// `G = grad g(q_n)`, constant in the step (variational midpoint scheme: theory/integrators#eq-variational). No moment about `q_n`.
    StartPoint,
    /// `G = grad g(q_np1)` (statics, backward Euler: theory/integrators#eq-backward-euler). No moment about `q_np1`.
    EndPoint,
    /// `G = (grad g(q_n) + grad g(q_np1)) / 2` (trapezoidal rule: theory/integrators#eq-trapezoidal). The moment about `q_mid` is
    /// `-(1/4) sum dq x (grad g(q_np1) - grad g(q_n))`: it vanishes in a rigid motion on one facet, otherwise only with
    /// the step.
    EndPointMean,
    /// `G = grad g(q_mid)` (midpoint rule: theory/integrators#eq-midpoint). No moment about `q_mid`.
    Midpoint,
    /// Discrete gradient of the gap between `q_n` and `q_np1`: `G . (q_np1 - q_n) = g_np1 - g_n`. No moment about
    /// `q_mid`.
    EnergyMomentum,
}

/// Positions that a step's evaluation may read. All slices have `3 * nodes` entries, node-major.
#[derive(Clone, Copy, Debug)]
pub struct StepConfiguration<'a> {
    /// Converged positions at `n`.
    pub q_n: &'a [f64],
    /// Iterate of the positions at `n+1`.
    pub q_np1: &'a [f64],
    /// Rule of the scheme.
    pub rule: ContactRule,
}

/// A further unknown of a slot, beside its pressure. Each active slot of a method has the same list of them, see
/// [`Constraint::auxiliaries`]. What is measured in coordinates and multipliers is the method's; scaled to the units below
/// the rows can be judged together with the others, and the matrix keeps its balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Auxiliary {
    /// A global unknown, a length or a traction. Its row is a force, and counts as one of the forces that have to balance.
    Balance,
    /// A global unknown, a length or a traction. Its row is a weight (area) times a length, and counts as a constraint.
    Constraint,
    /// Eliminated in the linear equations of each iteration, but a part of the iterate: the contribution has neither row nor column of it, and
    /// [`Constraint::recover`] gives its increment.
    Condensed,
}

impl Auxiliary {
    /// Number of those that have an equation.
    pub fn equations(list: &[Self]) -> usize {
        list.iter().filter(|&&kind| kind != Self::Condensed).count()
    }
}

/// Sets the auxiliaries of slots that are not active to zero and leaves the others, `count` each: a start for multipliers that are counted from what
/// the last step ended with.
pub fn clear_inactive(active: &[bool], count: usize, auxiliaries: &mut [f64]) {
    for (values, active) in auxiliaries.chunks_exact_mut(count.max(1)).zip(active) {
        if !active {
            values.fill(0.0);
        }
    }
}

/// The first two of the `count` auxiliaries of a slot, zero where there are none: multipliers of the friction.
pub fn multipliers_of(slot: usize, count: usize, auxiliaries: &[f64]) -> [f64; 2] {
    let own = auxiliaries.get(slot * count..slot * count + count).unwrap_or_default();
    [0, 1].map(|k| own.get(k).copied().unwrap_or(0.0))
}

/// One dense contribution: unknowns are the three components of each of `nodes`, then one pressure for each of `slots`, then
/// `auxiliaries` further ones for each of `slots`, slot by slot.
///
/// `residual` has [`Self::dim`] entries, `tangent` is row-major `dim() x dim()`:
/// `d residual / d (q_np1 of nodes, p of slots)`.
#[derive(Clone, Debug, Default)]
pub struct LocalContribution {
    /// Global node numbers, each at most once.
    pub nodes: Vec<u32>,
    /// Constraint slots, each at most once.
    pub slots: Vec<u32>,
    /// Residual in the sign of theory/node-to-surface#eq-residual: minus the contact force; then `-A g`.
    pub residual: Vec<f64>,
    /// Row-major tangent; empty or stale if the tangent was not asked for.
    pub tangent: Vec<f64>,
    /// Further unknowns of each slot that have an equation, zero for most methods.
    pub auxiliaries: usize,
    /// Largest violation of equations that were condensed, relative (a length to a length); zero without such.
    pub violation: f64,
    /// What the linear equations take in addition to `residual`, one entry a row, or empty: the difference between the
    /// branch that they are linearised on and the one that the iterate is on, or the start of multipliers that are not determined. It is no part of the norm, so that it cannot change a solution.
    pub shift: Vec<f64>,
}

impl LocalContribution {
    /// Number of local unknowns.
    pub fn dim(&self) -> usize {
        3 * self.nodes.len() + self.slots.len() * (1 + self.auxiliaries)
    }
    /// Sizes and clears the arrays for the present `nodes` and `slots`.
    pub fn reset(&mut self, want_tangent: bool) {
        let n = self.dim();
        self.violation = 0.0;
        self.shift.clear();
        self.residual.clear();
        self.residual.resize(n, 0.0);
        if want_tangent {
            self.tangent.clear();
            self.tangent.resize(n * n, 0.0);
        }
    }
}

/// What a slot did at the end of a step, for output (signs: theory/node-to-surface#eq-gap).
#[derive(Clone, Debug, PartialEq)]
pub struct SlotReport {
    /// Global slave node.
    pub node: u32,
    /// Reference area of the slave node.
    pub weight: f64,
    /// Factor by which the slot's pressure becomes a force per area of the given configuration: 1 where it is one already, reference area over
    /// current area where it is one per reference area.
    pub per_current_area: f64,
    /// Area over which the pressure acts in the given configuration: the node's share of the current slave surface, with mortar contact of what of it lies
    /// opposite the master; zero if nothing does.
    pub area: f64,
    /// True gap at the given configuration; `None` if no master is within reach.
    pub gap: Option<f64>,
    /// Unit normal, master to slave (zero if there is none).
    pub normal: [f64; 3],
    /// Which geometric case the projection was ("face", "edge", "vertex", "none").
    pub feature: &'static str,
    /// Gap that a closed slot keeps: zero, but for constraints that keep a gap, and `gap` itself where the constraint gives way.
    pub reference_gap: f64,
    /// Friction in the last accepted step of this session; `None` without friction and for open slots.
    pub friction: Option<SlotFriction>,
}

/// Friction of a slot in an accepted step, in components of an orthonormal frame of the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotFriction {
    /// Traction in the equations, along the slip.
    pub traction: [f64; 2],
    /// Slip of the slave in the step that springs do not take up, a length.
    pub slip: [f64; 2],
    /// Largest traction that the law admits.
    pub bound: f64,
    /// True if nothing slides.
    pub sticks: bool,
}

/// What a joint does at the end of a step, for output.
#[derive(Clone, Debug, PartialEq)]
pub struct JointReport {
    /// Force of the first side on the second.
    pub force: [f64; 3],
    /// Moment of the first side on the second about the joint's point on the second.
    pub moment: [f64; 3],
    /// From the joint's point on the first side to that on the second.
    pub arm: [f64; 3],
    /// Angles and displacements that the joint leaves free and that can be measured.
    pub coordinates: Vec<JointCoordinate>,
}

/// A coordinate of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointCoordinate {
    /// Angle (radians, followed over turns) or displacement.
    pub value: f64,
    /// Whether it is an angle.
    pub is_angle: bool,
    /// What acts along the coordinate.
    pub torques: JointTorques,
}

/// Torques (along an angle) or forces (along a displacement) that act on the second side of a joint along its coordinate; zero without such a thing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointTorques {
    /// Of Coulomb friction.
    pub friction: f64,
    /// Of viscous friction, in the last step.
    pub viscous: f64,
    /// Of the spring, at the end of the step.
    pub spring: f64,
    /// Of the motor or the pretension.
    pub motor: f64,
    /// Of the limits.
    pub limit: f64,
}

/// A node that the ground holds along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Its global number.
    pub node: u32,
    /// The direction, of length one.
    pub direction: [f64; 3],
    /// What `direction . x` of its position has to be, a length.
    pub place: f64,
    /// Rate of `place` just after the time, a length per time.
    pub rate: f64,
}

/// How the surfaces of a discretisation are covered by what it integrates over.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// By how much the invariant is missed, round-off: of mortar contact the largest part of a slave facet that lies opposite the master and has no
    /// segment, or has two.
    pub defect: f64,
}

/// Energy of the contact in a step, as far as it is not that of the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactWork {
    /// Energy stored at the end of the step (normal and tangential springs).
    pub stored: f64,
    /// Energy dissipated in the step.
    pub dissipated: f64,
    /// The part of `stored` that is in tangential springs.
    pub friction_stored: f64,
    /// Work of the slip against the friction in the step, what friction takes out of the bodies. It is measured with force and slip: what it differs from
    /// the change of `friction_stored` and `dissipated` is what the iteration left.
    pub friction_work: f64,
    /// The part of `dissipated` that viscous normal forces took.
    pub damped: f64,
    /// What closing gaps cost in the step by the constraints themselves, `sum p (Phi(q_n) - Phi(q_np1))` over the closed slots: what the normal forces take from
    /// the bodies if they do the work of the gaps. `None` if the method does not tell.
    pub closing: Option<f64>,
    /// Work done in the step by constraints that depend on time: drives.
    pub driven: f64,
}

impl Default for ContactWork {
    fn default() -> Self {
        Self {
            stored: 0.0,
            dissipated: 0.0,
            friction_stored: 0.0,
            friction_work: 0.0,
            damped: 0.0,
            closing: Some(0.0),
            driven: 0.0,
        }
    }
}

impl std::ops::AddAssign for ContactWork {
    fn add_assign(&mut self, other: Self) {
        self.stored += other.stored;
        self.dissipated += other.dissipated;
        self.friction_stored += other.friction_stored;
        self.friction_work += other.friction_work;
        self.damped += other.damped;
        self.driven += other.driven;
        self.closing = self.closing.zip(other.closing).map(|(a, b)| a + b);
    }
}

/// What a contact, a tie or a potential says of itself, for output and judgement.
pub trait Report: Send + Sync + std::fmt::Debug {
    /// Name for reports and error messages.
    fn name(&self) -> &str;
    /// Length of a facet of the slave, the unit of its gaps.
    fn length_scale(&self) -> f64;
    /// Whether the forces leave linear momentum as it is: they add up to zero. Not so where the ground takes a part of them.
    fn conserves_linear_momentum(&self) -> bool {
        true
    }
    /// Whether it holds surfaces together that lie on each other, as mesh ties do: then their nodes may be a little inside the other body.
    fn holds_surfaces_together(&self) -> bool {
        false
    }
    /// Whether the forces leave angular momentum as it is, under schemes that conserve it: their moments about any point add up to zero.
    fn conserves_angular_momentum(&self) -> bool {
        true
    }
    /// Checks invariants of the discretisation at the end of a converged step, before it is accepted.
    fn verify(&self, _q_np1: &[f64]) -> Result<Coverage, ContactError> {
        Ok(Coverage::default())
    }
    /// Checks at the end of a converged step that equations without an active slot hold: those of joints between things that cannot move, or move as prescribed. Of constraints that always hold only.
    ///
    /// # Errors
    /// [`ContactError::Joint`] if the prescribed motion contradicts them.
    fn verify_inactive(&self, _q_np1: &[f64], _active: &[bool]) -> Result<(), ContactError> {
        Ok(())
    }
    /// What a joint does at the end of a step at `q`; `None` for everything else.
    fn joint(&self, _q: &[f64], _multipliers: &[f64]) -> Option<JointReport> {
        None
    }
    /// What a slot holds at a time, if it lets the ground hold a node along a direction and does nothing else; `None` for everything else.
    fn held(&self, _slot: usize, _time: f64) -> Option<Held> {
        None
    }
    /// Gap, normal and feature of every slot at a configuration, for output and probes.
    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, ContactError>;
}

/// Equations with one multiplier each, and the forces of these. A constraint that is nothing else is bilateral: its slots are active from the first step to the
/// last, whatever the sign of their multipliers (mesh ties, joints).
///
/// # Protocol
/// `set_rule`, `set_velocity` and then `begin_step(q_n)` once for every attempted step (it may be repeated with another step size); then any number of
/// `renew` and `assemble`; `q_n` never changes in between. There is no undo: `begin_step` forgets what an attempt left.
///
/// A *slot* is a constraint with one multiplier; their number is constant for a run, and a node may have several. Slots that are not active contribute nothing.
pub trait Constraint: Report {
    /// Number of slots.
    fn slot_count(&self) -> usize;
    /// Weight (reference area) of a slot.
    fn slot_weight(&self, slot: usize) -> f64;
    /// Whether the tangent is symmetric under a rule (constraint rows are then the gradients of the forces). If bodies, loads and contacts
    /// all are, the matrix is factorised as a symmetric one, which takes two thirds of the time. A wrong promise costs time, not the
    /// answer: the residual is measured with the whole matrix, and the solver falls back. No by default.
    fn is_symmetric(&self, _rule: ContactRule) -> bool {
        false
    }
    /// Rule and size of the step that begins, for methods with history.
    fn set_rule(&mut self, _rule: ContactRule, _step_size: f64) {}
    /// Beginning and end of the step, for constraints that depend on time; comes with `set_rule`.
    fn set_times(&mut self, _time_n: f64, _time_np1: f64) {}
    /// Whether the step has inertia, thus velocities; comes with `set_rule`. In statics nothing is viscous.
    fn set_has_rates(&mut self, _has_rates: bool) {}
    /// Tells which nodes are carried by others, and with which weights: carriers and weights of a node, if it has any. Their positions are given with
    /// all others; a search may know from the carriers alone how a surface has moved.
    fn set_carriers<'a>(&mut self, _of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {}
    /// Velocities at `q_n` (`3 * nodes`), for methods that look ahead; comes before `begin_step` and holds for that one only.
    fn set_velocity(&mut self, _v_n: &[f64]) {}
    /// Search and projection at `q_n`; `reach` is the largest distance that a node is expected to move relative to the
    /// master in the step (candidates farther away need no pairing).
    fn begin_step(&mut self, _q_n: &[f64], _reach: f64) -> Result<(), ContactError> {
        Ok(())
    }
    /// Renews what follows the iterate by itself, for instance integrals over moving overlaps; called before every `assemble` with its
    /// `q_np1`, pressures and auxiliaries. What `augment`, `work` and `commit` need of the last ones the method keeps. Returns whether the stencils
    /// of active slots changed. `want_tangent` tells whether derivatives will be needed.
    fn renew(
        &mut self,
        _q_np1: &[f64],
        _pressures: &[f64],
        _auxiliaries: &[f64],
        _active: &[bool],
        _want_tangent: bool,
    ) -> Result<bool, ContactError> {
        Ok(false)
    }
    /// Nodes and slots of every active contribution, in the order in which `assemble` visits them.
    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32]));
    /// Residual and (if asked) tangent of every active slot, visited in slot order. `pressures` has one entry a slot.
    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        pressures: &[f64],
        active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError>;
    /// Further unknowns of each slot (coordinates, multipliers), the same for all slots; none by default. Their values are a part of
    /// the solver's iterate as long as a step lasts, slot by slot; nothing of them is history.
    fn auxiliaries(&self) -> &[Auxiliary] {
        &[]
    }
    /// Values from which the iteration starts, for every active slot: at the start of an attempt and after every change of the active set or
    /// the pairings. `out` has `slot_count() * auxiliaries().len()` entries; it comes with the values so far, at the start of an attempt zeros.
    fn start_auxiliaries(
        &self,
        _step: StepConfiguration<'_>,
        _pressures: &[f64],
        _active: &[bool],
        _out: &mut [f64],
    ) -> Result<(), ContactError> {
        Ok(())
    }
    /// [`Self::assemble`] at given values of the auxiliaries; what a method with auxiliaries assembles without them is the state that
    /// [`Self::start_auxiliaries`] gives.
    fn assemble_with(
        &self,
        step: StepConfiguration<'_>,
        pressures: &[f64],
        _auxiliaries: &[f64],
        active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        self.assemble(step, pressures, active, want_tangent, visit)
    }
    /// Increments of the condensed auxiliaries that belong to an increment of `q_np1` (`3 * nodes`, zero where prescribed), at the
    /// iterate of which the linear equations were solved. `out` is as in [`Self::start_auxiliaries`].
    fn recover(
        &self,
        _step: StepConfiguration<'_>,
        _auxiliaries: &[f64],
        _active: &[bool],
        _increment: &[f64],
        _out: &mut [f64],
    ) -> Result<(), ContactError> {
        Ok(())
    }
}

/// What a method carries from one accepted step to the next, and what its step stored and dissipated. `work` comes before `commit`, which comes once when a step
/// was accepted.
pub trait History {
    /// Energy stored and dissipated by the step from `q_n` that ends at `q_np1`.
    fn work(&self, _q_np1: &[f64], _pressures: &[f64], _active: &[bool]) -> Result<ContactWork, ContactError> {
        Ok(ContactWork::default())
    }
    /// Energy stored in a configuration before the first step: what springs of a joint have.
    fn stored_at_start(&self, _q: &[f64]) -> f64 {
        0.0
    }
    /// Called once when a step was accepted.
    fn commit(&mut self, _q_np1: &[f64], _pressures: &[f64], _active: &[bool]) {}
    /// Opaque history for checkpoints; empty if there is none.
    fn save_history(&self) -> Vec<u8> {
        Vec::new()
    }
    /// Restores what `save_history` wrote.
    fn load_history(&mut self, _bytes: &[u8]) -> Result<(), ContactError> {
        Ok(())
    }
}

/// Constraints that always hold, with whatever they carry from step to step.
pub trait Bilateral: Constraint + History {}

impl<T: Constraint + History> Bilateral for T {}

/// A contact discretisation between one slave and one master surface: constraints that open and close. The active set of the solver asks `complementarity_gaps`,
/// `repair` and `augment` between the iterations of a step.
pub trait ContactMethod: Constraint + History {
    /// Whether its slots have friction.
    fn has_friction(&self) -> bool {
        false
    }
    /// Nodes and slots of contributions that are not active and may well become so in this step; called after `begin_step`. A hint: the
    /// matrix gets room for them, so that no symbolic work is needed when they close. None by default.
    fn candidates(&self, _active: &[bool], _visit: &mut dyn FnMut(&[u32], &[u32])) {}
    /// `gamma` of theory/constraints#eq-complementarity for every slot at `q_np1`: for an active slot the value of its constraint function, for an inactive one the
    /// true gap (`f64::INFINITY` if out of reach). `out` has one entry a slot.
    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), ContactError>;
    /// Re-pairs active slots whose contact point left their face (and pairs slots that are about to be activated);
    /// returns how many pairings changed. Stencils may be different afterwards.
    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, ContactError>;
    /// Updates multipliers that are no unknowns (augmented Lagrangian) after a converged iteration; returns how many have not settled. The step is
    /// solved again as long as there are such.
    fn augment(&mut self, _q_np1: &[f64], _pressures: &[f64], _active: &[bool]) -> Result<usize, ContactError> {
        Ok(0)
    }
    /// Visits the gradient of the constraint function of every closed slot that carries at `q_np1`: the slot, its nodes and three entries a node. Times the
    /// pressures it has neither resultant nor moment about `q_np1`. Visits nothing by default: then `closing_loss` cannot be restored.
    fn constraint_gradients(
        &self,
        _q_np1: &[f64],
        _active: &[bool],
        _visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), ContactError> {
        Ok(())
    }
}
