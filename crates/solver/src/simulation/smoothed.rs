//! The last resort before a step is cut: smoothed complementarity.

use super::Simulation;
use super::advance::{Completed, Start};
use crate::smooth::attempt_smoothed;
use crate::step::decision;
use crate::{DecisionKind, StepError};
use stoss_integrators::StepRule;

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
        let decisions = self.decisions.len();
        let reason = format!("contact smoothed: {cause}");
        self.decisions.push(decision(self.step + 1, self.state.time, dt, DecisionKind::Restart, reason));
        self.try_by(attempt_smoothed, from, dt, rule).map_err(|_| {
            self.decisions.truncate(decisions);
            self.failures.pop();
            cause
        })
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
        // Layers that keep surfaces apart have no rows.
        may_be_contact && self.scheme.is_none() && self.model.has_unilateral_contact() && !self.model.keeps_apart()
    }
}
