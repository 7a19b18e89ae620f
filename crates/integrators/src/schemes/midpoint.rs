//! Midpoint rule (theory/integrators#eq-midpoint; thesis (5.22)).

use crate::{Claims, Combination, ConstraintTerm, ForceRule, ForceTerm, GradientRule, Scheme, StepRule};

/// Implicit midpoint rule: `a_alg = 2/dt^2 (q_np1 - q_n - dt v_n)`, forces at `q_mid`, `v_np1 = 2 (q_np1 - q_n)/dt - v_n`.
///
/// Second order, symplectic; conserves both momenta, energy only for quadratic potentials.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint;

/// Velocity that varies linearly over the step, with the given force and constraint rules.
pub(super) fn mean_velocity(dt: f64, force: ForceRule, constraint: GradientRule) -> StepRule {
    StepRule {
        inertia: Combination::new(2.0 / (dt * dt), -2.0 / dt),
        force: ForceTerm { rule: force, weight: 1.0 },
        constraint: ConstraintTerm { rule: constraint, weight: 1.0 },
        history: None,
        velocity: Combination::new(2.0 / dt, -1.0),
        impulse: None,
        acceleration: None,
    }
}

impl Scheme for Midpoint {
    fn name(&self) -> &'static str {
        "midpoint"
    }
    fn claims(&self) -> Claims {
        Claims { order: 2, linear_momentum: true, angular_momentum: true, energy: false, constraints: true }
    }
    fn rule(&self, dt: f64) -> StepRule {
        mean_velocity(dt, ForceRule::MIDPOINT, GradientRule::Midpoint)
    }
}
