//! The last resort before a step is cut: smoothed complementarity.

use super::Simulation;
use super::advance::{Completed, Start};
use crate::smooth::attempt_smoothed;
use crate::step::decision;
use crate::{DecisionKind, StepError};
use stoss_integrators::StepRule;

/// Trials in a step, whatever its size: where the second one fails a third will.
const MOST_TRIALS: usize = 2;

impl Simulation {
    /// Tries a step of which plain attempts failed by smoothed complementarity, if contact may be the cause; the error is that of the plain attempt.
    pub(super) fn try_smoothed(
        &mut self,
        from: Start,
        dt: f64,
        rule: StepRule,
        cause: StepError,
    ) -> Result<Completed, StepError> {
        if !self.may_smooth(&cause) {
            return Err(cause);
        }
        let reason = format!("contact smoothed: {cause}");
        self.decisions.push(decision(self.step + 1, self.state.time, dt, DecisionKind::Smoothed, reason));
        // A motion that was free at the start and is resisted by nothing but the shape of pressed surfaces, so that any disturbance leads off, is free.
        let was_free = matches!(cause, StepError::Singular { .. });
        match self.try_by(attempt_smoothed, from, dt, rule) {
            Ok(completed) if was_free && completed.is_unstable() => Err(cause),
            Ok(completed) => Ok(completed),
            Err(_) => {
                // The diagnosis looks at plain attempts.
                self.failures.pop();
                Err(cause)
            }
        }
    }

    /// Whether smoothed complementarity may get over a failure.
    fn may_smooth(&self, cause: &StepError) -> bool {
        let may_be_contact = matches!(
            cause,
            StepError::NotConverged { .. }
                | StepError::Cycling { .. }
                | StepError::ActiveSet { .. }
                | StepError::Singular { .. }
                | StepError::Solid(_)
                | StepError::Contact(_)
        );
        let of_step = self.decisions.iter().rev().take_while(|decision| decision.step == self.step + 1);
        let trials = of_step.filter(|decision| decision.kind == DecisionKind::Smoothed).count();
        // Layers that keep surfaces apart have no rows.
        may_be_contact
            && trials < MOST_TRIALS
            && self.scheme.is_none()
            && self.model.has_unilateral_contact()
            && !self.model.keeps_apart()
    }
}
