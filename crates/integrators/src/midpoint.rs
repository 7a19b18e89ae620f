//! Midpoint rule (formulation §11, thesis (5.22)).

use crate::{Claims, ForceRule, Scheme, State};

/// Implicit midpoint rule: `a_alg = 2/dt^2 (q_np1 - q_n - dt v_n)`, forces at `q_mid`, `v_np1 = 2 (q_np1 - q_n)/dt - v_n`.
///
/// Second order; conserves both momenta, energy only for quadratic potentials.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint;

/// `2/dt^2 (q_np1 - q_n - dt v_n)`: the mean acceleration of a step with linearly varying velocity.
pub(crate) fn mean_acceleration(state_n: &State, q_np1: &[f64], dt: f64, out: &mut [f64]) {
    let c = 2.0 / (dt * dt);
    for (((a, q1), q0), v0) in out.iter_mut().zip(q_np1).zip(&state_n.q).zip(&state_n.v) {
        *a = c * ((q1 - q0) - dt * v0);
    }
}

/// `v_np1 = 2 (q_np1 - q_n)/dt - v_n`.
pub(crate) fn mean_velocity_update(state_n: &State, q_np1: &[f64], dt: f64, v_np1: &mut [f64]) {
    let c = 2.0 / dt;
    for (((v1, q1), q0), v0) in v_np1.iter_mut().zip(q_np1).zip(&state_n.q).zip(&state_n.v) {
        *v1 = c * (q1 - q0) - v0;
    }
}

impl Scheme for Midpoint {
    fn name(&self) -> &'static str {
        "midpoint"
    }
    fn claims(&self) -> Claims {
        Claims { order: 2, linear_momentum: true, angular_momentum: true, energy: false }
    }
    fn force_rule(&self) -> ForceRule {
        ForceRule::Midpoint
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
