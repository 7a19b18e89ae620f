//! Trapezoidal rule (theory/integrators#eq-trapezoidal; thesis (5.19)).

use super::midpoint::mean_velocity;
use crate::{Claims, ForceRule, ForceTerm, GradientRule, HistoryTerm, Scheme, StepRule};

/// Trapezoidal rule: the mean of the forces at both ends, and of the constraint gradients.
///
/// Second order; conserves linear momentum.
#[derive(Clone, Copy, Debug, Default)]
pub struct Trapezoidal;

impl Scheme for Trapezoidal {
    fn name(&self) -> &'static str {
        "trapezoidal"
    }
    fn claims(&self) -> Claims {
        Claims { order: 2, linear_momentum: true, angular_momentum: false, energy: false, constraints: true }
    }
    fn rule(&self, dt: f64) -> StepRule {
        StepRule {
            force: ForceTerm { rule: ForceRule::END_POINT, weight: 0.5 },
            history: Some(HistoryTerm { weight: 0.5, force: true, constraint: false }),
            ..mean_velocity(dt, ForceRule::END_POINT, GradientRule::EndPointMean)
        }
    }
}
