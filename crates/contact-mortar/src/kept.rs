//! Gaps that slots keep in a step, and penetrations that they keep over several.

use crate::method::{MortarContact, WeightedConstraint};
use crate::slot::Work;
use stoss_contact::ContactRule;

/// How much of a penetration that is kept where integrals follow the iterate is left after the next step of full size.
const STAYS: f64 = 0.9;

/// What is known of a closed slot from the last step, lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Closed {
    /// The penetration that it kept, not positive.
    kept: f64,
    /// The gap at the end.
    gap: f64,
}

impl MortarContact {
    /// The gap that a node keeps in the step, a length.
    pub(crate) fn kept_gap(&self, slot: usize, active: bool) -> f64 {
        let gap_n = Some(self.gap_n[slot]).filter(|gap| gap.is_finite()).unwrap_or(0.0);
        match self.options.constraint {
            WeightedConstraint::Standard => 0.0,
            WeightedConstraint::Modified if active => gap_n,
            // A node that was released while it kept a negative gap must not be caught by that.
            WeightedConstraint::Modified => gap_n.min(0.0),
            WeightedConstraint::OneSided => match self.closed[slot].filter(|_| self.keeps_penetrations()) {
                None => gap_n.min(0.0),
                Some(Closed { kept, gap }) => {
                    // Steps that are cut let out as much less.
                    let steps = if self.longest_step > 0.0 { self.step_size / self.longest_step } else { 1.0 };
                    (STAYS.powf(steps) * (kept + (gap_n - gap).min(0.0))).max(gap_n.min(0.0))
                }
            },
        }
    }

    /// Whether nodes keep penetrations over several steps.
    fn keeps_penetrations(&self) -> bool {
        self.rule == ContactRule::EndPoint && self.options.constraint == WeightedConstraint::OneSided
    }

    /// The gap that a slot kept in the last accepted step, zero if it keeps none.
    pub(crate) fn kept_of(&self, slot: usize) -> f64 {
        self.closed.get(slot).copied().flatten().map_or(0.0, |closed| closed.kept)
    }

    /// Remembers what closed slots keep, at the end of a step.
    pub(crate) fn commit_kept(&mut self, q_np1: &[f64], active: &[bool]) {
        let keeps = self.keeps_penetrations();
        let mut work = Work::default();
        for (k, active) in active.iter().enumerate() {
            let slot = self.slots().get(k).filter(|_| keeps && *active);
            let gap = slot.and_then(|slot| Some(slot.gap(q_np1, false, &mut work)? / slot.support));
            self.closed[k] = gap.map(|gap| Closed { kept: self.kept_gap(k, true), gap });
        }
    }

    /// Appends what the slots keep; nothing if none does.
    pub(crate) fn save_kept(&self, bytes: &mut Vec<u8>) {
        if self.closed.iter().any(Option::is_some) {
            let values = |closed: &Option<Closed>| closed.map_or([f64::NAN; 2], |closed| [closed.kept, closed.gap]);
            bytes.extend(self.closed.iter().flat_map(values).flat_map(f64::to_le_bytes));
        }
    }

    /// Takes what [`Self::save_kept`] wrote.
    pub(crate) fn load_kept(&mut self, kept: &[u8]) {
        self.closed.fill(None);
        for (closed, bytes) in self.closed.iter_mut().zip(kept.chunks_exact(16)) {
            let [kept, gap] = [0, 8].map(|at| f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k])));
            *closed = Some(Closed { kept, gap }).filter(|_| !kept.is_nan());
        }
    }
}
