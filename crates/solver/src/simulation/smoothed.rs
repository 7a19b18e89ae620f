//! The last resort before a step is cut: smoothed complementarity.

use super::Simulation;
use super::advance::{Completed, Start, Way};
use crate::step::decision;
use crate::{DecisionKind, StepError};
use stoss_integrators::StepRule;

/// Trials in a step, whatever its size: where the second one fails a third will.
const MOST_TRIALS: usize = 2;

impl Simulation {
    /// Tries a step of which plain attempts failed with more care, if contact may be the cause: once more with a set of closed slots if there is friction, then by smoothed
    /// complementarity. The error is that of the plain attempt.
    pub(super) fn try_carefully(
        &mut self,
        [first, last]: [Start; 2],
        dt: f64,
        rule: StepRule,
        cause: StepError,
    ) -> Result<Completed, StepError> {
        if !self.may_smooth(&cause) {
            return Err(cause);
        }
        let has_friction = self.model.contacts.iter().any(|c| c.unilateral().is_some() && c.term.has_friction());
        // Layers that keep surfaces apart have no rows.
        let has_rows = self.model.has_unilateral_contact() && !self.model.keeps_apart();
        let with_care =
            |from: Start| (Way::Careful, from, DecisionKind::Restart, "with compliant rows and slips of little weight");
        let mut ways = Vec::new();
        if matches!(cause, StepError::Singular { .. }) && !has_rows {
            ways.push((Way::Anchored, last, DecisionKind::Restart, "held by springs that vanish"));
        }
        if has_friction && has_rows {
            ways.push(with_care(first));
            if last != first {
                ways.push(with_care(last));
            }
        }
        if has_rows {
            ways.push((Way::Smoothed, last, DecisionKind::Smoothed, "contact smoothed"));
        }
        for (way, from, kind, words) in ways {
            let reason = format!("{words}: {cause}");
            self.log.decisions.push(decision(self.step + 1, self.state.time, dt, kind, reason));
            match self.try_by(way, from, dt, rule) {
                // A motion that was free at the start and is resisted by nothing but the shape of pressed surfaces, so that any disturbance leads off, is free.
                Ok(completed) if matches!(cause, StepError::Singular { .. }) && completed.is_unstable() => break,
                Ok(completed) => return Ok(completed),
                // The diagnosis looks at plain attempts.
                Err(_) => drop(self.failures.pop()),
            }
        }
        Err(cause)
    }

    /// Whether smoothed complementarity may get over a failure.
    fn may_smooth(&self, cause: &StepError) -> bool {
        let may_be_contact = matches!(
            cause,
            StepError::NotConverged { .. }
                | StepError::Cycling { .. }
                | StepError::ActiveSet { .. }
                | StepError::Singular { .. }
                | StepError::Term(_)
        );
        let of_step = self.log.decisions.iter().rev().take_while(|decision| decision.step == self.step + 1);
        let trials = of_step.filter(|decision| decision.kind == DecisionKind::Smoothed).count();
        let has_contact = self.model.has_unilateral_contact() || self.model.keeps_apart();
        may_be_contact && trials < MOST_TRIALS && self.how.scheme.is_none() && has_contact
    }
}
