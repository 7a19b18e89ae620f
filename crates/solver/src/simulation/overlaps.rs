//! Overlaps of the start that cannot be closed at once.

use super::Simulation;
use crate::step::decision;
use crate::{DecisionKind, StepError};

impl Simulation {
    /// Lets contacts that begin to act in a step of statics that failed close their overlaps in proportion to time (theory/constraints#reference-gap). False if
    /// none has an overlap that was to be closed at once; then nothing has changed.
    pub(super) fn ramps_overlaps(&mut self, cause: &StepError) -> bool {
        if self.how.scheme.is_some() {
            return false;
        }
        let (time, dt) = (self.state.time, self.clock.dt());
        let contacts = 0..self.model.contacts.len();
        let may = |c: &usize| {
            let method = self.model.contacts[*c].unilateral_mut();
            method.and_then(|method| method.reference_gap_mut()).is_some_and(|gap| gap.ramp(time))
        };
        let ramped: Vec<usize> = contacts.filter(may).collect();
        if ramped.is_empty() {
            return false;
        }
        // Measures them.
        let measured = self.begin_terms(dt, self.step_rule(dt), false).is_ok();
        let mut found = Vec::new();
        for c in ramped {
            let pair = &mut self.model.contacts[c];
            let Some(gap) = pair.unilateral_mut().and_then(|method| method.reference_gap_mut()) else {
                continue;
            };
            match gap.overlaps() {
                (slots, depth) if measured && slots > 0 => {
                    found.push(format!("{}: {slots} slave nodes overlap by up to {depth:.3e}", pair.name));
                }
                _ => gap.do_not_ramp(),
            }
        }
        let any = !found.is_empty();
        if any {
            let reason = format!("{}; closed in proportion to time, for at once: {cause}", found.join("; "));
            self.log.decisions.push(decision(self.step + 1, time, dt, DecisionKind::Restart, reason));
        }
        any
    }
}
