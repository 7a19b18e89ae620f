//! The traits of a contact discretisation.

use crate::{
    Auxiliary, ContactError, ContactWork, GradientRule, Hold, LocalContribution, ReferenceGap, Report, Step,
    StepConfiguration,
};

/// Equations with one multiplier each, and the forces of these. A constraint that is nothing else is bilateral: its slots are active from the first step to the
/// last, whatever the sign of their multipliers (mesh ties, joints).
///
/// # Protocol
/// `begin` once for every attempted step (it may be repeated with another step size); then any number of `renew` and `assemble`, with the positions `q_n` and the rule of that step. There
/// is no undo: `begin` forgets what an attempt left. What depends on the scheme, on whether there is inertia, on what is prescribed or on what else acts is decided there, step by step: a run may have
/// stages in which it is different.
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
    fn is_symmetric(&self, _rule: GradientRule) -> bool {
        false
    }
    /// What a slot of a bilateral constraint is, for impacts.
    fn slot_kind(&self, _slot: usize) -> SlotKind {
        SlotKind::Equation
    }
    /// Tells which nodes are carried by others, and with which weights: carriers and weights of a node, if it has any. Their positions are given with
    /// all others; a search may know from the carriers alone how a surface has moved.
    fn set_carriers<'a>(&mut self, _of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {}
    /// Begins a step: search and projection at its start, and all that is constant in it. Nothing by default.
    ///
    /// # Errors
    /// A rule that the method does not have ([`ContactError::RuleUnavailable`]), and what search and projection refuse.
    fn begin(&mut self, _step: &Step<'_>) -> Result<(), ContactError> {
        Ok(())
    }
    /// Tells of every node that it joins what it does to it while it acts, once a node, for [`crate::Support`]. Nothing by default.
    fn holds(&self, _visit: &mut dyn FnMut(u32, Hold)) {}
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
    /// the pairings. `out` has `slot_count() * auxiliaries().len()` entries; it comes with the values so far, at the start of an attempt zeros. By default
    /// those of slots that are not active become zero and the others stay: a start for multipliers that are counted from what the last step ended with.
    fn start_auxiliaries(
        &self,
        _step: StepConfiguration<'_>,
        _pressures: &[f64],
        active: &[bool],
        out: &mut [f64],
    ) -> Result<(), ContactError> {
        for (values, active) in out.chunks_exact_mut(self.auxiliaries().len().max(1)).zip(active) {
            if !active {
                values.fill(0.0);
            }
        }
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

/// What a slot of a bilateral constraint is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotKind {
    /// An equation between positions that holds at all times.
    Equation,
    /// An equation that depends on time: a drive, a moving support.
    Driven,
    /// A limit: it acts on one side, and opens and closes within its own row.
    Limit,
    /// A force with a law, such as friction: it takes no part in an impact.
    Force,
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
    /// The gaps that its closed slots keep, if it can keep others than zero.
    fn reference_gap(&self) -> Option<&ReferenceGap> {
        None
    }
    /// The same to be changed between steps.
    fn reference_gap_mut(&mut self) -> Option<&mut ReferenceGap> {
        None
    }
    /// Smooths the kinks of its friction until the next step begins, or no more: `pressure` is the smoothing of pressures, a stress (theory/constraints#smoothed).
    fn smooth_friction(&mut self, _pressure: f64) {}
    /// Nodes and slots of contributions that are not active and may well become so in this step; called after `begin`. A hint: the
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
    /// pressures it has neither resultant nor moment about `q_np1`. Visits nothing by default: then there is no impact law (theory/impacts).
    fn constraint_gradients(
        &self,
        _q_np1: &[f64],
        _active: &[bool],
        _visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), ContactError> {
        Ok(())
    }
    /// Bound of the tangential traction of a closed slot over its pressure, where it slides by `slip` (two components in the tangent plane, lengths) in the step, for impacts between rigid bodies.
    /// `None`: no friction.
    fn friction_coefficient(&self, _slot: usize, _pressure: f64, _slip: [f64; 2]) -> Option<f64> {
        None
    }
    /// The way of the master's surface beside its mesh in the step, see [`crate::friction::SurfaceVelocity`].
    fn surface_way(&self) -> [f64; 3] {
        [0.0; 3]
    }
    /// By how much the constraint function that a closed slot keeps changes in the step: negative where a gap that is held comes down, else zero.
    fn settling(&self, _slot: usize) -> f64 {
        0.0
    }
}
