//! Which rows are closed: what the active set asks of a method.

use super::{CARRIED, MortarContact, NO_PENETRATION};
use crate::slot::Want;
use crate::state::{Need, StepState};
use stoss_contact::ContactError;
use stoss_term::{Fault, ReferenceGap, Unilateral};

impl MortarContact {
    /// The distance below which an open row closes.
    fn closes_at(&self, row: usize) -> f64 {
        let own = self.reference_gap.of(row);
        own + (self.step.reference[row] - own).min(0.0)
    }
}

impl Unilateral for MortarContact {
    fn reference_gap(&self) -> Option<&ReferenceGap> {
        Some(&self.reference_gap)
    }

    fn reference_gap_mut(&mut self) -> Option<&mut ReferenceGap> {
        Some(&mut self.reference_gap)
    }

    fn smooth_friction(&mut self, pressure: f64) {
        self.friction.iter_mut().for_each(|surface| surface.friction.smooth(pressure));
    }

    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), Fault> {
        let rows = self.surfaces.rows.iter().zip(&self.end.slots).enumerate();
        for ((k, (row, slot)), out) in rows.zip(out) {
            let there = self.step.carried[k] && slot.support > 0.0;
            let gap = if there { slot.gap(q_np1) } else { None };
            let area = slot.support.max(CARRIED * row.area);
            // A gap is held by rows that are closed, and none before it is closed.
            let reference = if active[k] { self.step.reference[k] } else { self.closes_at(k) };
            *out = gap.map_or(f64::INFINITY, |gap| (gap - reference * slot.support) / area);
            // The law gives a closed row the gap that its pressure asks for.
            if active[k] && self.options.overclosure.is_some() {
                *out = 0.0;
            }
            if gap.is_none() && self.step.carried[k] && active[k] {
                *out = 0.0;
            }
        }
        Ok(())
    }

    /// Rows that have come opposite the master since the start of the step carry multipliers from now on, if they are inside.
    fn repair(&mut self, q_np1: &[f64], _active: &[bool]) -> Result<usize, Fault> {
        let mut changes = 0;
        if self.is_frozen() {
            return Ok(0);
        }
        let tolerance = NO_PENETRATION * self.length();
        for (k, row) in self.surfaces.rows.iter().enumerate() {
            let slot = &self.end.slots[k];
            if self.step.carried[k] || slot.support <= CARRIED * row.area {
                continue;
            }
            let kept = self.closes_at(k) * slot.support;
            let inside = slot.gap(q_np1).is_some_and(|gap| gap < kept - tolerance * row.area);
            self.step.carried[k] = inside;
            changes += usize::from(inside);
        }
        if changes > 0 && self.step.without != self.surfaces.handing_over(None) {
            // What they had handed over comes back to them.
            self.step.without = self.surfaces.handing_over(Some(&self.step.carried));
            self.end.at.clear();
        }
        Ok(changes)
    }

    fn surface_way(&self) -> [f64; 3] {
        self.friction.as_ref().map_or([0.0; 3], |surface| surface.friction.surface_way())
    }

    fn friction_coefficient(&self, slot: usize, pressure: f64, slip: [f64; 2]) -> Option<f64> {
        let surface = self.friction.as_ref()?;
        let of_point = [surface.points[slot].slid, surface.step_size];
        Some(surface.friction.coefficient(pressure, slip, of_point))
    }

    fn settling(&self, slot: usize) -> f64 {
        let support = self.end.slots.get(slot).map_or(0.0, |slot| slot.support);
        self.step.settling.get(slot).map_or(0.0, |settling| settling * support)
    }

    fn constraint_gradients(
        &self,
        q_np1: &[f64],
        active: &[bool],
        visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), Fault> {
        let carrying: Vec<bool> = active.iter().zip(&self.step.carried).map(|(a, c)| *a && *c).collect();
        let StepState { candidates, without, .. } = &self.step;
        let needs = self.surfaces.needs(Need::Nothing, &carrying);
        let end = self.surfaces.integrate(candidates, q_np1.into(), &needs, without, &self.end.slots, false)?;
        for (k, slot) in end.slots.iter().enumerate().filter(|(k, slot)| carrying[*k] && slot.support > 0.0) {
            let evaluation = slot.evaluate(q_np1, slot.nodes.len(), Want::Gradient);
            let mut evaluation = evaluation.ok_or(ContactError::NoNormal { node: slot.nodes[0] })?;
            evaluation.beyond(self.step.reference[k], 0.0);
            visit(k, &slot.nodes, &evaluation.gradient);
        }
        Ok(())
    }
}
