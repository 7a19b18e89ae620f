//! Variational integrator with the generalised midpoint rule (theory/integrators#eq-variational; thesis (5.42), (6.27)-(6.30)).

use crate::{Claims, Combination, ConstraintTerm, ForceRule, ForceTerm, GradientRule, Scheme, StepRule};

/// Position-momentum form of the discrete Euler-Lagrange equations of
/// `L_d = dt [1/2 w^T M w - V(q_alpha)]`, `w = (q_np1 - q_n)/dt`, `q_alpha = (1 - alpha) q_n + alpha q_np1`:
///
/// `M w - P_n + dt (1 - alpha) F(q_alpha) - dt G(q_n)^T p = 0`, `P_np1 = M w - dt alpha F(q_alpha)`.
///
/// Symplectic, conserves both momenta; second order for `alpha = 1/2`.
///
/// Under constraints the positions are those of SHAKE: `P_np1` has not yet the part of the constraint impulse at `n+1` that the next step gives to it, so
/// the velocities `M^-1 P_np1` leave the constraint by a part of first order in `dt` along `M^-1 G^T`; positions and momenta are as said above. What has no mass gets no
/// velocity from momenta: a model with such coordinates needs another scheme.
#[derive(Clone, Copy, Debug)]
pub struct VariationalMidpoint {
    /// Place of the forces, in `[0, 1)`.
    pub alpha: f64,
}

impl Default for VariationalMidpoint {
    fn default() -> Self {
        Self { alpha: 0.5 }
    }
}

impl Scheme for VariationalMidpoint {
    fn name(&self) -> &'static str {
        "variational-midpoint"
    }
    fn claims(&self) -> Claims {
        let order = if self.alpha == 0.5 { 2 } else { 1 };
        Claims { order, linear_momentum: true, angular_momentum: true, energy: false, constraints: true }
    }
    fn rule(&self, dt: f64) -> StepRule {
        let Self { alpha } = *self;
        StepRule {
            inertia: Combination::new(1.0 / (dt * dt), -1.0 / dt),
            force: ForceTerm { rule: ForceRule::Configuration { theta: alpha }, weight: 1.0 - alpha },
            constraint: ConstraintTerm { rule: GradientRule::StartPoint, weight: 1.0 },
            history: None,
            velocity: Combination::new(1.0 / dt, 0.0),
            impulse: Some(-dt * alpha),
            acceleration: None,
        }
    }
}
