//! What a step is to solids: two configurations and a rule of the scheme.

use stoss_integrators::ForceRule;

/// The two configurations of a step and the scheme's rule. Positions of the whole model, node-major, `3 * nodes` entries; a length.
#[derive(Clone, Copy, Debug)]
pub struct SolidStep<'a> {
    /// Beginning of the step (not read by [`ForceRule::END_POINT`]).
    pub q_n: &'a [f64],
    /// End of the step: the unknown (not read by the rule with `theta = 0`).
    pub q_np1: &'a [f64],
    /// Configuration at which forces are taken.
    pub rule: ForceRule,
}
