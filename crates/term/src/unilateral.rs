//! The ability to open and close.

use crate::{Fault, ReferenceGap};

/// Constraints that open and close, between one slave and one master surface. The active set asks `complementarity_gaps`
/// and `repair` between the iterations of a step.
pub trait Unilateral: Sync {
    /// `gamma` of theory/constraints#eq-complementarity for every slot at `q_np1`: for an active slot the value of its constraint function, for an inactive one the
    /// true gap (`f64::INFINITY` if out of reach). `out` has one entry a slot.
    ///
    /// # Errors
    /// A projection that fails.
    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), Fault>;
    /// Pairs active slots anew whose contact point left their face (and slots that are about to be activated);
    /// returns how many pairings changed. Stencils may be different afterwards.
    ///
    /// # Errors
    /// A projection that fails.
    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, Fault>;
    /// Visits the gradient of the constraint function of every closed slot that carries at `q_np1`: the slot, its nodes and three entries a node. Times the
    /// pressures it has neither resultant nor moment about `q_np1`. Visits nothing by default: then there is no impact law (theory/impacts).
    ///
    /// # Errors
    /// A projection that fails.
    fn constraint_gradients(
        &self,
        _q_np1: &[f64],
        _active: &[bool],
        _visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), Fault> {
        Ok(())
    }
    /// The gaps that its closed slots keep, if it can keep others than zero.
    fn reference_gap(&self) -> Option<&ReferenceGap> {
        None
    }
    /// The gaps that the closed slots keep, to be changed between steps.
    fn reference_gap_mut(&mut self) -> Option<&mut ReferenceGap> {
        None
    }
    /// Smooths the kinks of its friction until the next step begins, or no more: `pressure` is the smoothing of pressures, a stress (theory/constraints#smoothed).
    fn smooth_friction(&mut self, _pressure: f64) {}
    /// Bound of the tangential traction of a closed slot over its pressure, where it slides by `slip` (two components in the tangent plane, lengths) in the step, for impacts between rigid bodies.
    /// `None`: no friction.
    fn friction_coefficient(&self, _slot: usize, _pressure: f64, _slip: [f64; 2]) -> Option<f64> {
        None
    }
    /// The way of the master's surface beside its mesh in the step.
    fn surface_way(&self) -> [f64; 3] {
        [0.0; 3]
    }
    /// Change in the step of the constraint function that a closed slot keeps: negative where a gap that is held comes down, else zero.
    fn settling(&self, _slot: usize) -> f64 {
        0.0
    }
}
