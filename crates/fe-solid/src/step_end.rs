//! What a step stored and lost in a body.

use stoss_continuum::Loss;

/// What a step did to a body whose law has a state, or to the elements of it that a rank has: over all ranks energies and losses add up, and the largest [`Self::flow`] counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepEnd {
    /// `int psi dV` at the end, elastic and by hardening.
    pub stored: f64,
    /// What of it hardening has stored.
    pub hardening: f64,
    /// Energy lost in the step, by cause.
    pub loss: Loss,
    /// Largest increment of the equivalent plastic strain of a point.
    pub flow: f64,
}

impl StepEnd {
    /// Adds another one.
    pub(crate) fn add(&mut self, other: &Self) {
        self.stored += other.stored;
        self.hardening += other.hardening;
        self.loss.add(1.0, &other.loss);
        self.flow = self.flow.max(other.flow);
    }
}
