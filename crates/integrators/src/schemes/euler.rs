//! Euler's methods (theory/integrators#eq-backward-euler; thesis (5.15)).

use crate::{Claims, Combination, ConstraintTerm, ForceRule, ForceTerm, GradientRule, Scheme, StepRule};

/// Backward Euler method: everything at the end point, `v_np1 = (q_np1 - q_n)/dt`.
///
/// First order; conserves linear momentum, dissipates energy.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackwardEuler;

/// `a_alg = (q_np1 - q_n - dt v_n)/dt^2`, velocity `(q_np1 - q_n)/dt`.
fn difference(dt: f64, force: ForceTerm, constraint: ConstraintTerm) -> StepRule {
    StepRule {
        inertia: Combination::new(1.0 / (dt * dt), -1.0 / dt),
        force,
        constraint,
        history: None,
        velocity: Combination::new(1.0 / dt, 0.0),
        impulse: None,
        acceleration: None,
    }
}

impl Scheme for BackwardEuler {
    fn name(&self) -> &'static str {
        "backward-euler"
    }
    fn claims(&self) -> Claims {
        Claims { order: 1, linear_momentum: true, angular_momentum: false, energy: false, constraints: true }
    }
    fn rule(&self, dt: f64) -> StepRule {
        let force = ForceTerm { rule: ForceRule::END_POINT, weight: 1.0 };
        difference(dt, force, ConstraintTerm { rule: GradientRule::EndPoint, weight: 1.0 })
    }
}

/// Forward Euler method: `q_np1 = q_n + dt v_n`, `M v_np1 = M v_n - dt F(q_n)`. Unstable for every oscillation without damping; here for
/// comparison. It cannot carry constraints: positions are fixed before any multiplier acts.
///
/// First order; conserves linear momentum.
#[derive(Clone, Copy, Debug, Default)]
pub struct ForwardEuler;

impl Scheme for ForwardEuler {
    fn name(&self) -> &'static str {
        "forward-euler"
    }
    fn claims(&self) -> Claims {
        Claims { order: 1, linear_momentum: true, angular_momentum: false, energy: false, constraints: false }
    }
    fn rule(&self, dt: f64) -> StepRule {
        let force = ForceTerm { rule: ForceRule::START, weight: 0.0 };
        let constraint = ConstraintTerm { rule: GradientRule::StartPoint, weight: 1.0 };
        StepRule { velocity: Combination::new(0.0, 1.0), impulse: Some(-dt), ..difference(dt, force, constraint) }
    }
}
