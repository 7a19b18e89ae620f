//! The normal part as a part of the contact method: row of a slot, energy of the springs.

use crate::method::NodeToSurface;
use stoss_contact::{ContactError, Enforcement, NormalRow};
use stoss_term::GradientRule;

fn at_end(rule: GradientRule) -> bool {
    match rule {
        GradientRule::StartPoint | GradientRule::EndPoint | GradientRule::EndPointMean => true,
        GradientRule::Midpoint | GradientRule::DiscreteGradient => false,
    }
}

impl NodeToSurface {
    /// Gaps at both ends of the step, less the gap that the constraint refers to; `gap` is the one to the facet.
    fn ends(&self, slot: usize, gap: f64) -> [f64; 2] {
        let (kept, slot) = (self.reference_gap.of(slot), &self.slots[slot]);
        [slot.gap_n - slot.reference, gap - kept - slot.reference]
    }

    /// Equation of an active, paired slot with a gap at `n+1`.
    pub(crate) fn normal_row(&self, slot: usize, rule: GradientRule, gap: f64, pressure: f64) -> NormalRow {
        let ends = self.ends(slot, gap);
        self.normal.enforcement.row(at_end(rule), ends, pressure)
    }

    pub(crate) fn normal_complementarity(&self, slot: usize, gap: f64) -> f64 {
        self.normal.enforcement.complementarity(at_end(self.normal.rule), self.ends(slot, gap))
    }

    /// Energy of the springs of the active slots.
    pub(crate) fn normal_stored(&self, q_np1: &[f64], active: &[bool]) -> Result<f64, ContactError> {
        let mut total = 0.0;
        if !matches!(self.normal.enforcement, Enforcement::Penalty(_)) {
            return Ok(total);
        }
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let Some(pairing) = self.slots[slot].pairing else { continue };
            let [_, end] = self.ends(slot, self.gap(slot, pairing.end, q_np1)?.gap);
            total += self.slave.weights()[slot] * self.normal.enforcement.stored(end);
        }
        Ok(total)
    }
}
