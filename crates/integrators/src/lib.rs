//! Time-stepping schemes for constrained second-order systems.
//!
//! A scheme turns `M a + F(q) - F_ext - G^T p = 0`, `Phi(q) = 0` into one nonlinear system a step (formulation §11). It
//! says three things and nothing else: the *algorithmic acceleration* as a function of `q_np1`, the *force rule* (at which
//! configurations forces and constraint gradients are taken), and the update of velocity and acceleration.
//!
//! This crate is not a solver: it knows neither elements nor contact. Whoever assembles forces reads
//! [`Scheme::force_rule`].
//!
//! # How to add a scheme
//! One file with a type that implements [`Scheme`], its [`Claims`] as data, one row in [`SCHEMES`]. The tests of this
//! crate take every row of the table and check each claim, and that what is not claimed does not hold.

mod energy_momentum;
mod midpoint;
mod registry;
mod state;

pub use energy_momentum::EnergyMomentum;
pub use midpoint::Midpoint;
pub use registry::{SCHEMES, SchemeEntry, scheme};
pub use state::State;

/// Where the forces of a step are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ForceRule {
    /// Everything at `q_np1`.
    EndPoint,
    /// Forces and constraint gradients at `q_mid = (q_n + q_np1)/2`, constraints at `q_np1`.
    Midpoint,
    /// Discrete gradients between `q_n` and `q_np1`, constraints at `q_np1`.
    DiscreteGradient,
}

impl ForceRule {
    /// Fraction of the step at which given loads are evaluated (`t_n + fraction * dt`).
    pub fn load_fraction(self) -> f64 {
        match self {
            Self::EndPoint => 1.0,
            Self::Midpoint | Self::DiscreteGradient => 0.5,
        }
    }
}

/// What a scheme conserves for an autonomous, frictionless, free system, to the tolerance of the nonlinear solution
/// (formulation §16), and its order. Data, so that a battery can test each claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claims {
    /// Order of convergence of positions.
    pub order: u32,
    /// Linear momentum is exact.
    pub linear_momentum: bool,
    /// Angular momentum is exact.
    pub angular_momentum: bool,
    /// Total energy is exact for any law.
    pub energy: bool,
}

/// A one-step scheme.
///
/// The residual of a step is `M a_alg(q_np1) + F_rule(q_n, q_np1) - F_ext - G_rule^T p`.
pub trait Scheme: std::fmt::Debug + Send + Sync {
    /// Name used in scenes and reports.
    fn name(&self) -> &'static str;
    /// Order and conservation.
    fn claims(&self) -> Claims;
    /// Where forces are evaluated.
    fn force_rule(&self) -> ForceRule;
    /// Writes the algorithmic acceleration `a_alg(q_np1)` into `out` (as many entries as `q`).
    fn acceleration(&self, state_n: &State, q_np1: &[f64], dt: f64, out: &mut [f64]);
    /// `d a_alg / d q_np1`, a multiple of the unit matrix [1/time^2].
    fn acceleration_factor(&self, dt: f64) -> f64;
    /// Predictor of `q_np1`: by default `q_n + dt v_n`.
    fn predict(&self, state_n: &State, dt: f64, q_np1: &mut [f64]) {
        for ((out, q), v) in q_np1.iter_mut().zip(&state_n.q).zip(&state_n.v) {
            *out = q + dt * v;
        }
    }
    /// Velocity at `n+1` from the converged `q_np1`.
    fn update(&self, state_n: &State, q_np1: &[f64], dt: f64, v_np1: &mut [f64]);
}
