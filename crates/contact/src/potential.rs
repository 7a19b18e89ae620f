//! Contact by potentials: forces with an energy and no multiplier.

use crate::{
    Constraint, ContactError, ContactWork, GradientRule, LocalContribution, Report, SlotReport, Step, StepConfiguration,
};

/// What two bodies do to each other at the end of a step, of potentials that act between many bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPair {
    /// Numbers of the bodies, the smaller one first; the same twice for a body in contact with itself.
    pub bodies: [u32; 2],
    /// Pairs of primitives that act.
    pub active: usize,
    /// Smallest distance, a length.
    pub distance: f64,
    /// Largest pressure, per reference area: of means over the facets around a node.
    pub pressure: f64,
    /// Reference area in contact.
    pub area: f64,
    /// Force on the first body.
    pub force: [f64; 3],
    /// Moment of the same forces about the origin, at the positions at the end of the step.
    pub moment: [f64; 3],
    /// Work of friction in the step.
    pub friction_work: f64,
}

impl BodyPair {
    /// Of two bodies that do nothing to each other.
    pub fn none(bodies: [u32; 2]) -> Self {
        Self {
            bodies,
            active: 0,
            distance: f64::INFINITY,
            pressure: 0.0,
            area: 0.0,
            force: [0.0; 3],
            moment: [0.0; 3],
            friction_work: 0.0,
        }
    }
}

/// What acts at a node of a surface in a step, of potentials that act between surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceNode {
    /// The node.
    pub node: u32,
    /// Normal force over the area, positive in compression.
    pub pressure: f64,
    /// Friction on the surface over the area, tangential.
    pub friction: [f64; 3],
    /// Distance to the nearest other surface at the end of the step (infinite if none was looked at).
    pub distance: f64,
    /// Current area in contact that belongs to the node; of all facets around it where none is, as at corners and edges.
    pub area: f64,
}

/// The force on a part of a surface in a step, where nodes other than those of the surface carry it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceForce {
    /// Node of the surface.
    pub node: u32,
    /// Force on the surface there.
    pub force: [f64; 3],
    /// Its moment about the origin.
    pub moment: [f64; 3],
}

/// Forces that have an energy `V(q)` and no multiplier: penalties, barriers.
///
/// # Protocol
/// `begin` once for every attempted step (it may be repeated), then any number of `renew` and `assemble`, `longest_step` in between; `work`, then `commit` once when the step was accepted.
///
/// The balance of energy stays exact under [`GradientRule::DiscreteGradient`] if the force of a step does the work `V(q_n) - V(q_np1)`; both momenta stay if it has
/// neither resultant nor moment about `(q_n + q_np1)/2`.
pub trait Potential: Send + Sync + std::fmt::Debug {
    /// Name for reports and error messages.
    fn name(&self) -> &str;
    /// Length over which the forces change, of a facet for instance.
    fn length_scale(&self) -> f64;
    /// Whether the forces leave linear momentum as it is.
    fn conserves_linear_momentum(&self) -> bool {
        true
    }
    /// Whether the forces leave angular momentum as it is.
    fn conserves_angular_momentum(&self) -> bool {
        true
    }
    /// Whether the tangent is symmetric under a rule, as [`Constraint::is_symmetric`].
    fn is_symmetric(&self, _rule: GradientRule) -> bool {
        false
    }
    /// Whether under a rule the forces are the gradient of the energy at the end of the step, but for friction that [`Self::friction_along`] accounts for.
    fn has_energy(&self, _rule: GradientRule) -> bool {
        false
    }
    /// Remembers a motion by `increment` (`3 * nodes`) from where the forces were assembled last.
    fn set_line(&mut self, _increment: &[f64]) {}
    /// Energy at a part of that motion whose derivative by the part is, at its start, minus the power of friction: that with the normal forces and the points of the start. Zero without friction.
    fn friction_along(&self, _part: f64) -> f64 {
        0.0
    }
    /// Begins a step: search at its start.
    ///
    /// # Errors
    /// A rule that the potential does not have ([`ContactError::RuleUnavailable`]), and what the search refuses.
    fn begin(&mut self, step: &Step<'_>) -> Result<(), ContactError>;
    /// Follows the iterate; comes before every `assemble` with its `q_np1`. Returns whether the stencils changed.
    fn renew(&mut self, _q_np1: &[f64]) -> Result<bool, ContactError> {
        Ok(false)
    }
    /// Whether surfaces must never pass through each other on the way from one iterate to the next: then `longest_step` limits every motion of the iteration.
    fn keeps_apart(&self) -> bool {
        false
    }

    /// Whether anything acts, at the start of the step or at the iterate that was seen last. True by default.
    fn acts(&self) -> bool {
        true
    }
    /// Part of the motion from `q` by `increment` (`3 * nodes` each), at most 1, on which surfaces stay apart.
    fn longest_step(&mut self, _q: &[f64], _increment: &[f64]) -> f64 {
        1.0
    }
    /// Nodes of contributions that may well come in the step; called after `begin`. A hint, as that of a contact method.
    fn candidates(&self, _visit: &mut dyn FnMut(&[u32])) {}
    /// Nodes of every contribution, in the order of `assemble`; constant until `renew` says otherwise.
    fn stencils(&self, visit: &mut dyn FnMut(&[u32]));
    /// Residual (minus the force) and, if asked, tangent of every contribution; none has slots.
    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError>;
    /// Energy at `q`.
    fn energy(&self, q: &[f64]) -> Result<f64, ContactError>;
    /// Energy stored at the end of a step, and dissipated in it.
    fn work(&self, q_np1: &[f64]) -> Result<ContactWork, ContactError> {
        Ok(ContactWork { stored: self.energy(q_np1)?, ..ContactWork::default() })
    }
    /// What bodies do to each other at the end of the step, those that do; nothing from potentials that do not act between bodies.
    fn body_pairs(&self) -> Vec<BodyPair> {
        Vec::new()
    }
    /// What acts at the nodes of surfaces in the step to `q_np1`, nodes ascending; those where nothing acts and nothing is near may be missing.
    fn surface_nodes(&self, _q_np1: &[f64]) -> Vec<SurfaceNode> {
        Vec::new()
    }
    /// Forces of the step at the nodes of surfaces, nodes ascending, if others carry some of them: those of surfaces that lie inside their bodies. Empty if each node carries what acts at it.
    fn surface_forces(&self) -> Vec<SurfaceForce> {
        Vec::new()
    }
    /// Whether there is friction.
    fn has_friction(&self) -> bool {
        false
    }
    /// The step to `q_np1` was accepted.
    fn commit(&mut self, _q_np1: &[f64]) {}
    /// Opaque history for checkpoints; empty if there is none.
    fn save_history(&self) -> Vec<u8> {
        Vec::new()
    }
    /// Restores what `save_history` wrote.
    fn load_history(&mut self, _bytes: &[u8]) -> Result<(), ContactError> {
        Ok(())
    }
}

/// A potential as a constraint without slots.
#[derive(Debug)]
pub struct PotentialConstraint(pub Box<dyn Potential>);

impl Report for PotentialConstraint {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn length_scale(&self) -> f64 {
        self.0.length_scale()
    }

    fn conserves_linear_momentum(&self) -> bool {
        self.0.conserves_linear_momentum()
    }

    fn conserves_angular_momentum(&self) -> bool {
        self.0.conserves_angular_momentum()
    }

    fn report(&self, _q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        Ok(Vec::new())
    }
}

impl Constraint for PotentialConstraint {
    fn slot_count(&self) -> usize {
        0
    }

    fn slot_weight(&self, _slot: usize) -> f64 {
        0.0
    }

    fn is_symmetric(&self, rule: GradientRule) -> bool {
        self.0.is_symmetric(rule)
    }

    fn begin(&mut self, step: &Step<'_>) -> Result<(), ContactError> {
        self.0.begin(step)
    }

    fn renew(
        &mut self,
        q_np1: &[f64],
        _multipliers: &[f64],
        _auxiliaries: &[f64],
        _active: &[bool],
        _want_tangent: bool,
    ) -> Result<bool, ContactError> {
        self.0.renew(q_np1)
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.0.stencils(&mut |nodes| visit(nodes, &[]));
    }

    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        _multipliers: &[f64],
        _active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        self.0.assemble(step, want_tangent, visit)
    }
}
