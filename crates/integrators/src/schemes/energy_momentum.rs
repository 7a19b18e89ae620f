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

const CLAIMS: Claims =
    Claims { order: 2, linear_momentum: true, angular_momentum: true, energy: true, constraints: true };

impl Scheme for EnergyMomentum {
    fn name(&self) -> &'static str {
        "energy-momentum"
    }
    fn claims(&self) -> Claims {
        CLAIMS
    }
    fn rule(&self, dt: f64) -> StepRule {
        mean_velocity(dt, ForceRule::DiscreteGradient, GradientRule::DiscreteGradient)
    }
}

/// The energy-momentum scheme on the system with augmented coordinates (CAT, theory/integrators#eq-spring-augmented): an invariant of the configuration becomes a
/// coordinate without mass, tied by a constraint that is quadratic in the positions. Its gradient at the midpoint is exact, and the discrete
/// gradient of the potential is that of a function of one variable.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnergyMomentumAugmented;

impl Scheme for EnergyMomentumAugmented {
    fn name(&self) -> &'static str {
        "energy-momentum-augmented"
    }
    fn claims(&self) -> Claims {
        CLAIMS
    }
    fn rule(&self, dt: f64) -> StepRule {
        EnergyMomentum.rule(dt)
    }
    fn augmented(&self) -> bool {
        true
    }
}
