//! The normal part as a part of the contact method: row of a slot, rounds of the augmented Lagrangian, energy of the springs.

use crate::method::NodeToSurface;
use stoss_contact::friction::MAX_AUGMENTATIONS;
use stoss_contact::{ContactError, Enforcement, NormalRow, position};
use stoss_term::GradientRule;

/// A closed node has this gap at most, in multiples of a master edge, once its multiplier has settled, or what round-off of the positions is.
const CLOSED: f64 = 1.0e-13;
/// A gap that may be left when it has not settled after all rounds, in multiples of a master edge.
const CLOSE: f64 = 1.0e-8;

/// A spring becomes stiffer by this factor at most within a step.
const STIFFEST: f64 = 1.0e8;

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
        self.normal.present().row(at_end(rule), ends, pressure, self.normal.multiplier(slot))
    }

    pub(crate) fn normal_complementarity(&self, slot: usize, gap: f64) -> f64 {
        self.normal.present().complementarity(at_end(self.normal.rule), self.ends(slot, gap))
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

    /// Makes the pressures the multipliers of the augmented Lagrangian; returns how many were not settled.
    pub(crate) fn augment_normal(
        &mut self,
        q_np1: &[f64],
        pressures: &[f64],
        active: &[bool],
    ) -> Result<usize, ContactError> {
        if self.normal.multipliers.is_empty() {
            return Ok(0);
        }
        self.normal.rounds += 1;
        let is_last = self.normal.rounds > MAX_AUGMENTATIONS;
        let (mut unsettled, mut far_off, mut largest) = (0, 0, 0.0_f64);
        for slot in 0..self.slots.len() {
            let Some(pairing) = self.slots[slot].pairing.filter(|_| active[slot]) else {
                self.normal.multipliers[slot] = 0.0;
                continue;
            };
            let [_, end] = self.ends(slot, self.gap(slot, pairing.end, q_np1)?.gap);
            let far = position(q_np1, self.node(slot)).norm();
            if end.abs() > CLOSED * self.length + 4.0 * f64::EPSILON * far {
                self.normal.multipliers[slot] = pressures[slot].max(0.0);
                unsettled += 1;
                largest = largest.max(end.abs());
                far_off += usize::from(end.abs() > CLOSE * self.length);
            }
        }
        if far_off > 0 {
            self.normal.stiffening.follow(largest, STIFFEST);
        }
        match is_last {
            false => Ok(unsettled),
            true if far_off == 0 => Ok(0),
            true => {
                let (what, rounds) = ("gap", MAX_AUGMENTATIONS);
                Err(ContactError::Augmentation { what, unsettled: far_off, rounds })
            }
        }
    }
}
