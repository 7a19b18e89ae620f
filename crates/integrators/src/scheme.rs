//! The trait of a scheme.

use crate::{State, StepRule};

/// Order of a scheme, and what it conserves for an autonomous, frictionless, free system to the tolerance of the nonlinear solution
/// (theory/integrators#kept). As data, so that tests can check each claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claims {
    /// Order of convergence of positions.
    pub order: u32,
    /// Linear momentum is exact.
    pub linear_momentum: bool,
    /// Angular momentum is exact.
    pub angular_momentum: bool,
    /// Total energy is exact for any potential.
    pub energy: bool,
    /// The scheme can integrate systems with constraints (contact).
    pub constraints: bool,
}

/// A one-step scheme: [`StepRule`]s and a predictor. See the crate's documentation for how to add one.
pub trait Scheme: std::fmt::Debug + Send + Sync {
    /// Name used in scenes and reports.
    fn name(&self) -> &'static str;
    /// Order and conservation.
    fn claims(&self) -> Claims;
    /// Residual and updates of a step of size `dt > 0`.
    fn rule(&self, dt: f64) -> StepRule;
    /// Predictor of the increment `q_np1 - q_n`: by default `dt v_n`.
    fn predict(&self, state_n: &State, dt: f64, increment: &mut [f64]) {
        for (out, v) in increment.iter_mut().zip(&state_n.v) {
            *out = dt * v;
        }
    }
}
