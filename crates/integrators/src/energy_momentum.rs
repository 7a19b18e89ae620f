//! Energy-momentum scheme (formulation §11, thesis (5.62)).

use crate::midpoint::{mean_acceleration, mean_velocity_update};
use crate::{Claims, ForceRule, Scheme, State};

/// Energy-momentum scheme: inertia of the midpoint rule, forces by the discrete gradient
/// (`F_bar . (q_np1 - q_n) = V_np1 - V_n`).
///
/// Second order; conserves both momenta and the energy for any law and any step size at which the nonlinear system has a
/// solution.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnergyMomentum;

impl Scheme for EnergyMomentum {
    fn name(&self) -> &'static str {
        "energy-momentum"
    }
    fn claims(&self) -> Claims {
        Claims { order: 2, linear_momentum: true, angular_momentum: true, energy: true }
    }
    fn force_rule(&self) -> ForceRule {
        ForceRule::DiscreteGradient
    }
    fn acceleration(&self, state_n: &State, q_np1: &[f64], dt: f64, out: &mut [f64]) {
        mean_acceleration(state_n, q_np1, dt, out);
    }
    fn acceleration_factor(&self, dt: f64) -> f64 {
        2.0 / (dt * dt)
    }
    fn update(&self, state_n: &State, q_np1: &[f64], dt: f64, v_np1: &mut [f64]) {
        mean_velocity_update(state_n, q_np1, dt, v_np1);
    }
}
