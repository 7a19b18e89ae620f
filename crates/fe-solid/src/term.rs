//! A body as a term of a step: what a solver of whole models asks of it.

use crate::{ForceRule, SolidBody, SolidError, SolidStep, StepEnd};
use stoss_continuum::Loss;
use stoss_term::{At, Fault, Local, MaterialWork, Rule, StepContext, Term, Work};

/// An element that is inverted, or whose law has no stress, has no force at these positions.
impl From<SolidError> for Fault {
    fn from(error: SolidError) -> Self {
        Self::undefined(error)
    }
}

/// The body as a term. Of a body that is shared out among ranks the stencils, contributions, energies and works are those of the elements of this rank, and
/// those of all ranks add up to the body's; of [`MaterialWork::flow`] the largest counts. Name, scales and symmetry are those of the body.
impl Term for SolidBody {
    fn name(&self) -> &str {
        self.name()
    }

    fn length_scale(&self) -> f64 {
        self.characteristic_length()
    }

    fn force_scale(&self) -> f64 {
        let length = self.characteristic_length();
        self.law().small_strain_moduli().shear * length * length
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        rule != Rule::Force(ForceRule::DiscreteGradient)
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        Ok(self.begin_step(step.q_n, step.force, step.dt)?)
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        SolidBody::stencils(self).for_each(|nodes| visit(nodes, &[]));
    }

    /// Residual and tangent of the elements, in rayon's current pool if it has more than one thread; the bits do not depend on their number. Nothing is allocated after the first call.
    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let At { q_n, q_np1, before, .. } = *at;
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let step = SolidStep { q_n, q_np1, rule };
        // A force that does not depend on q_np1 has no derivative.
        let tangent = want_tangent.then_some(if rule.reads_end() { 1.0 } else { 0.0 });
        let mut hand_out = |_, local: &Local| visit(local);
        Ok(self.with_workspace(|workspace| self.visit(before, step, tangent, workspace, &mut hand_out))?)
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        Ok(self.strain_energy(q)?)
    }

    /// What the material stores and what it has lost.
    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        Ok(match self.step_end(at.q_np1)? {
            None => Work { stored: self.strain_energy(at.q_np1)?, ..Work::default() },
            Some(StepEnd { stored, hardening, loss, flow }) => {
                let Loss { plastic, viscous, softening } = loss;
                let material = MaterialWork { hardening, plastic, viscous, softening, flow };
                Work { stored, dissipated: loss.total(), material, ..Work::default() }
            }
        })
    }

    fn merit(&self, at: &At<'_>) -> Result<f64, Fault> {
        Ok(SolidBody::potential(self, at.q_np1)?)
    }

    fn commit(&mut self, at: &At<'_>) {
        // cannot fail: `work` has made the same states before the step was accepted.
        self.end_step(at.q_np1).unwrap_or(());
    }

    /// The states of the Gauss points; of a share those of its elements, see [`SolidBody::merge_history`].
    fn save_history(&self) -> Vec<u8> {
        self.states().flatten().flat_map(|number| number.to_le_bytes()).collect()
    }

    /// The bytes are those of the whole body.
    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let states: Vec<f64> = bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        self.set_states(&states).map_err(Fault::other)
    }
}
