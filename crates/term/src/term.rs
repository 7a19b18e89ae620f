//! The trait of whatever adds to the equations of a step.

use crate::{
    At, Auxiliary, Bilateral, Coverage, Fault, Hold, Local, Potential, Rule, Share, SlotReport, StepContext,
    Unilateral, Vectors, Work,
};
use std::ops::Range;

/// Whatever adds to the residual of a step: a solid, a beam, a spring, a load, a joint, a tie, a contact.
///
/// Its unknowns are vectors in space that all terms share (nodes, centres, directors: three components each, numbered together), and multipliers of its own: one a *slot*, and
/// [`auxiliaries`](Self::auxiliaries). The number of slots is constant for a run; slots that are not active contribute nothing.
///
/// # Protocol
/// `begin` once for every attempted step (it may be repeated with another size); then any number of `renew` and `assemble`. There is no undo: `begin` forgets what an attempt left. What depends on the
/// scheme, on whether there is inertia, on what is prescribed or on what else acts is decided there, step by step: a run may have stages in which it is different. `work` and `verify` come at the
/// converged end and may fail, then `commit`, which may not.
///
/// # Abilities
/// What only some terms can do stands in traits of its own, which a term hands out if it has them: vectors and mass of its own ([`Vectors`]), constraints that open and close ([`Unilateral`]) or
/// always hold ([`Bilateral`]), forces in the place of constraints ([`Potential`]). Who solves a step asks for the ability and never for the kind of term.
///
/// # What it promises
/// Forces with an energy `V` do the work `V(q_n) - V(q_np1)` under [`stoss_integrators::ForceRule::DiscreteGradient`] and [`stoss_integrators::GradientRule::DiscreteGradient`], and have neither resultant nor
/// moment about `(q_n + q_np1) / 2` unless the term says so; then the energy-momentum scheme conserves energy and momenta.
pub trait Term: Send + Sync + std::fmt::Debug {
    /// Name for reports and messages.
    fn name(&self) -> &str;
    /// The length to which its deformations or gaps are compared, of an element or a facet for instance.
    fn length_scale(&self) -> f64;
    /// A characteristic force: stiffness times length; zero without stiffness.
    fn force_scale(&self) -> f64 {
        0.0
    }
    /// Whether the tangent is symmetric under a rule (rows of constraints are then the gradients of their forces). If all are, the matrix is factorised as a symmetric one, which takes two thirds of the
    /// time. A wrong promise costs time, not the answer: the residual is measured with the whole matrix, and the solver falls back. No by default.
    fn is_symmetric(&self, _rule: Rule) -> bool {
        false
    }
    /// Whether the forces leave linear momentum as it is: they add up to zero. Not so where the ground takes a part of them.
    fn conserves_linear_momentum(&self) -> bool {
        true
    }
    /// Whether the forces leave angular momentum as it is, under schemes that conserve it.
    fn conserves_angular_momentum(&self) -> bool {
        true
    }
    /// Whether there is friction.
    fn has_friction(&self) -> bool {
        false
    }

    /// Number of slots.
    fn slot_count(&self) -> usize {
        0
    }
    /// Weight (reference area) of a slot.
    fn slot_weight(&self, _slot: usize) -> f64 {
        0.0
    }
    /// The node of a slot, whose displacements a factorisation eliminates right before the slot's multipliers. `None` (default): the first node of the stencil.
    fn slot_node(&self, _slot: usize) -> Option<u32> {
        None
    }
    /// Further unknowns of each slot (coordinates, multipliers), the same for all slots. Their values are a part of the iterate as long as a step lasts, slot by slot; nothing of them is history.
    fn auxiliaries(&self) -> &[Auxiliary] {
        &[]
    }

    /// Tells which nodes are carried by others, and with which weights: carriers and weights of a node, if it has any. Their positions are given with
    /// all others; a search may know from the carriers alone how a surface has moved.
    fn set_carriers<'a>(&mut self, _of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {}
    /// Deals its contributions out among ranks, where several run the same program on the same positions: [`Self::assemble`] then evaluates those of this share and visits the others in their order as
    /// [`Local::is_elsewhere`]; the sum of residuals and tangents over all ranks is that of one. Stencils, state, energies and work stay whole on every rank; `renew` and `assemble` may fail on one rank alone, and histories are
    /// put together by [`Self::join_histories`]. To be called once, before the first step. Returns the share that it takes, which says whose each contribution is and may go by places; nothing, as by default, if all ranks evaluate all.
    fn set_share(&mut self, _share: Share) -> Option<Share> {
        None
    }
    /// Begins a step: search and projection at its start, and all that is constant in it.
    ///
    /// # Errors
    /// A rule of the scheme that the term does not have, and what search and projection refuse.
    fn begin(&mut self, _step: &StepContext<'_>) -> Result<(), Fault> {
        Ok(())
    }
    /// Tells of every node that it joins what it does to it while it acts, once a node, for [`crate::HeldNodes`].
    fn holds(&self, _visit: &mut dyn FnMut(u32, Hold)) {}
    /// Follows the iterate: renews what does so by itself, for instance integrals over moving overlaps; called before every `assemble` at the same place. What `augment`, `work` and `commit` need of the last
    /// one the term keeps. Returns whether the stencils of active slots changed. `want_tangent` tells whether derivatives will be needed.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn renew(&mut self, _at: &At<'_>, _want_tangent: bool) -> Result<bool, Fault> {
        Ok(false)
    }
    /// Nodes and slots of every active contribution, in the order in which `assemble` visits them.
    fn stencils(&self, _active: &[bool], _visit: &mut dyn FnMut(&[u32], &[u32])) {}
    /// Nodes and slots of contributions that do not act and may well do so in this step; called after `begin`. A hint: the
    /// matrix gets room for them, so that no symbolic work is needed when they come.
    fn candidates(&self, _active: &[bool], _visit: &mut dyn FnMut(&[u32], &[u32])) {}
    /// Residual and, if asked, tangent of every active contribution: what it adds to the line of the residual that [`At::rule`] names, nothing to others. A pure function; threads may compute, the
    /// visitor is called in the order of `stencils`.
    ///
    /// # Errors
    /// The contribution has no value at these positions.
    fn assemble(
        &self,
        _at: &At<'_>,
        _want_tangent: bool,
        _visit: &mut (dyn FnMut(&Local) + Send),
    ) -> Result<(), Fault> {
        Ok(())
    }
    /// Values from which the iteration starts, for every active slot: at the start of an attempt and after every change of the active set or
    /// the pairings. `out` has `slot_count() * auxiliaries().len()` entries; it comes with the values so far, at the start of an attempt zeros. By default
    /// those of slots that are not active become zero and the others stay: a start for multipliers that are counted from what the last step ended with.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn start_auxiliaries(&self, at: &At<'_>, out: &mut [f64]) -> Result<(), Fault> {
        for (values, active) in out.chunks_exact_mut(self.auxiliaries().len().max(1)).zip(at.active) {
            if !active {
                values.fill(0.0);
            }
        }
        Ok(())
    }
    /// Increments of the condensed auxiliaries that belong to an increment of `q_np1` (`3 * nodes`, zero where prescribed), at the
    /// iterate at which the linear equations were solved. `out` is as in [`Self::start_auxiliaries`].
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn recover(&self, _at: &At<'_>, _increment: &[f64], _out: &mut [f64]) -> Result<(), Fault> {
        Ok(())
    }

    /// Energy that is stored at `q` and that belongs to no other term: at the start of a run, and of terms without slots at any time.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn energy(&self, _q: &[f64]) -> Result<f64, Fault> {
        Ok(0.0)
    }
    /// Energies of a converged step, before it is accepted. By default the energy at its end.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        Ok(Work { stored: self.energy(at.q_np1)?, ..Work::default() })
    }
    /// A function whose gradient at the end of the step is the force there, of a term whose tangent is symmetric, in statics: what a line search lets fall. By default what is stored
    /// and dissipated.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn merit(&self, at: &At<'_>) -> Result<f64, Fault> {
        let Work { stored, dissipated, .. } = self.work(at)?;
        Ok(stored + dissipated)
    }
    /// Checks invariants of the discretisation at the end of a converged step, before it is accepted.
    ///
    /// # Errors
    /// What does not hold.
    fn verify(&self, _q_np1: &[f64]) -> Result<Coverage, Fault> {
        Ok(Coverage::default())
    }
    /// Gap, normal and feature of every slot at a configuration, for output and probes; nothing of terms whose slots have none.
    ///
    /// # Errors
    /// A projection that fails.
    fn report(&self, _q: &[f64]) -> Result<Vec<SlotReport>, Fault> {
        Ok(Vec::new())
    }
    /// The step was accepted: the state of its end is that from which the next one begins.
    fn commit(&mut self, _at: &At<'_>) {}
    /// Opaque history for checkpoints; empty if there is none.
    fn save_history(&self) -> Vec<u8> {
        Vec::new()
    }
    /// The history of the whole term, as one rank alone saves it, of what all ranks saved after [`Self::set_share`], in their order. By default every rank has all.
    ///
    /// # Errors
    /// The bytes belong to something else.
    fn join_histories(&self, parts: &[Vec<u8>]) -> Result<Vec<u8>, Fault> {
        Ok(parts.first().cloned().unwrap_or_default())
    }
    /// Restores what `save_history` wrote.
    ///
    /// # Errors
    /// The bytes belong to something else.
    fn load_history(&mut self, _bytes: &[u8]) -> Result<(), Fault> {
        Ok(())
    }

    /// The term's own vectors and their mass, if it has some.
    fn vectors(&self) -> Option<&dyn Vectors> {
        None
    }
    /// The term as constraints that open and close, if it has such.
    fn unilateral(&self) -> Option<&dyn Unilateral> {
        None
    }
    /// The term as constraints that open and close, to be changed.
    fn unilateral_mut(&mut self) -> Option<&mut dyn Unilateral> {
        None
    }
    /// The term as constraints that always hold, if it has such.
    fn bilateral(&self) -> Option<&dyn Bilateral> {
        None
    }
    /// The term as forces in the place of constraints, if it has such.
    fn potential(&self) -> Option<&dyn Potential> {
        None
    }
    /// The term as forces in the place of constraints, to be changed.
    fn potential_mut(&mut self) -> Option<&mut dyn Potential> {
        None
    }
}

/// What [`Vectors`] says, of any term; a term without own vectors has an empty range of them.
impl dyn Term + '_ {
    /// Numbers of the term's own vectors, see [`Vectors::own_vectors`].
    pub fn own_vectors(&self) -> Range<u32> {
        self.vectors().map_or(0..0, |of| of.own_vectors())
    }

    /// Number of components of each own vector that are unknowns, see [`Vectors::width`].
    pub fn width(&self) -> usize {
        self.vectors().map_or(3, |of| of.width())
    }

    /// Whether an own vector is a direction, see [`Vectors::is_direction`].
    pub fn is_direction(&self, vector: u32) -> bool {
        self.vectors().is_some_and(|of| of.is_direction(vector))
    }

    /// First vector of the cluster of an own vector, see [`Vectors::cluster`].
    pub fn cluster(&self, vector: u32) -> u32 {
        self.vectors().map_or(vector, |of| of.cluster(vector))
    }

    /// Visits the mass matrix of the own vectors, see [`Vectors::mass`].
    pub fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        if let Some(of) = self.vectors() {
            of.mass(visit);
        }
    }

    /// Visits the forces of gravity on the own vectors, see [`Vectors::weight`].
    pub fn weight(&self, acceleration: [f64; 3], visit: &mut dyn FnMut(u32, [f64; 3])) {
        if let Some(of) = self.vectors() {
            of.weight(acceleration, visit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two positions with a consistent mass, and a direction that is coupled with the second.
    #[derive(Debug)]
    struct Three;

    impl Term for Three {
        fn name(&self) -> &str {
            "three"
        }
        fn length_scale(&self) -> f64 {
            1.0
        }
        fn vectors(&self) -> Option<&dyn Vectors> {
            Some(self)
        }
    }

    impl Vectors for Three {
        fn own_vectors(&self) -> Range<u32> {
            4..7
        }
        fn is_direction(&self, vector: u32) -> bool {
            vector == 6
        }
        fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
            [(4, 4, 2.0), (4, 5, 1.0), (5, 5, 2.0), (5, 6, 0.5), (6, 6, 7.0)]
                .iter()
                .for_each(|&(i, j, m)| visit(i, j, m));
        }
    }

    /// A uniform acceleration of the positions: `M (a, a, 0)`.
    #[test]
    fn weight_is_the_mass_times_the_acceleration_of_positions() {
        let mut force = [[0.0; 3]; 3];
        let three: &dyn Term = &Three;
        three.weight([0.0, -1.0, 10.0], &mut |i, f| (0..3).for_each(|d| force[i as usize - 4][d] += f[d]));
        assert_eq!(force, [[0.0, -3.0, 30.0], [0.0, -3.0, 30.0], [0.0, -0.5, 5.0]]);
    }
}
