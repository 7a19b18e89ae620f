//! The ability to act in the place of constraints, by forces with an energy and without multipliers.

use stoss_integrators::GradientRule;

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
    /// The pair of two bodies that do nothing to each other.
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
    /// Moment of the force about the origin.
    pub moment: [f64; 3],
}

/// Forces that act in the place of constraints: penalties, barriers. They have an energy ([`crate::Term::energy`]), but for friction, and no multiplier.
///
/// The balance of energy stays exact under [`GradientRule::DiscreteGradient`] if the force of a step does the work `V(q_n) - V(q_np1)`; both momenta stay if it has
/// neither resultant nor moment about `(q_n + q_np1)/2`.
pub trait Potential: Sync {
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
}
