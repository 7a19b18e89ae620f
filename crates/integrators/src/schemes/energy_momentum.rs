//! Energy-momentum scheme (theory/integrators#eq-energy-momentum; thesis (5.62)).

use super::midpoint::mean_velocity;
use crate::{Claims, ForceRule, GradientRule, Scheme, StepRule};

/// Energy-momentum scheme: inertia of the midpoint rule, forces and constraint gradients by (G-equivariant) discrete gradients
/// (`F_bar . (q_np1 - q_n) = V_np1 - V_n`).
///
/// Second order; conserves both momenta and the energy for any potential and any step size at which the nonlinear system has a
/// solution.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnergyMomentum;

impl Scheme for EnergyMomentum {
    fn name(&self) -> &'static str {
        "energy-momentum"
    }
    fn claims(&self) -> Claims {
        Claims { order: 2, linear_momentum: true, angular_momentum: true, energy: true, constraints: true }
    }
    fn rule(&self, dt: f64) -> StepRule {
        mean_velocity(dt, ForceRule::DiscreteGradient, GradientRule::DiscreteGradient)
    }
}
