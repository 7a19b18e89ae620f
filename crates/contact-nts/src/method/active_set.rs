//! Which slots are closed: what the active set asks of a method.

use crate::kinematics::LOCAL;
use crate::method::NodeToSurface;
use crate::slot::{ElementNodes, Pairing};
use stoss_contact::{Enforcement, MasterPoint};
use stoss_term::{Fault, ReferenceGap, Term as _, Unilateral};

impl NodeToSurface {
    /// What the gap of a node that is not active may fall to before it counts as closed: a node that was released while it kept a negative gap
    /// must not be caught by that, in this step or later.
    fn allowance(&self, slot: usize) -> f64 {
        if !self.leaves {
            return 0.0;
        }
        let slot = &self.slots[slot];
        if slot.committed.is_none() {
            return slot.kept;
        }
        // The penetration of a spring is no gap that is kept.
        let is_spring = matches!(self.normal.enforcement, Enforcement::Penalty(_));
        if is_spring { slot.kept.min(0.0) } else { slot.origin_gap.min(0.0) }
    }

    /// Gap to the surface; of a node behind it the gap to the extension of its facet, which is what the constraint keeps if it closes. In a valley the two
    /// differ: there the surface ends where the extension goes on.
    pub(super) fn gap_to_keep(&self, slot: usize, point: &MasterPoint, q: &[f64]) -> f64 {
        match point.pairing {
            Some(pairing) if point.gap < 0.0 => {
                self.gap_beyond(slot, pairing.facet, q).map_or(point.gap, |extended| extended.clamp(point.gap, 0.0))
            }
            _ => point.gap,
        }
    }

    /// True if a node behind the surface came there from the side or from behind: without a partner at `n` it was not in front of this
    /// facet's extension then. Closing it would push it out with work that no force does.
    pub(super) fn came_from_behind(&self, slot: usize, facet: u32) -> bool {
        let state = &self.slots[slot];
        state.strayed || state.origin.is_none() && self.gap_beyond(slot, facet, &self.q_n).is_ok_and(|at_n| at_n < 0.0)
    }
}

impl Unilateral for NodeToSurface {
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
        let view = self.search.at(q_np1);
        let mut in_front = Vec::new();
        for slot in 0..self.slots.len() {
            let pairing = self.slots[slot].pairing.filter(|_| active[slot]);
            out[slot] = match pairing {
                Some(Pairing { end, .. }) => {
                    let gap = self.gap(slot, end, q_np1)?;
                    let slid_off = gap.outside() > self.search.options().overhang
                        && self.pair(&view, slot, q_np1, end).pairing.is_none();
                    if slid_off { f64::INFINITY } else { self.normal_complementarity(slot, gap.gap) }
                }
                None => {
                    let point = self.closest(&view, slot, q_np1);
                    let behind = point.gap < 0.0 && point.pairing.is_some_and(|p| self.came_from_behind(slot, p.facet));
                    let allowance = self.allowance(slot);
                    match behind {
                        true => f64::INFINITY,
                        false if allowance < 0.0 => self.gap_to_keep(slot, &point, q_np1) - allowance,
                        false => point.gap,
                    }
                }
            };
            if !active[slot] && out[slot] >= 0.0 && self.pieces(slot, q_np1).is_some() {
                in_front.push(slot);
            }
        }
        for (slot, _, gap) in self.jumps(q_np1, &in_front)? {
            out[slot] = gap;
        }
        Ok(())
    }

    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, Fault> {
        let mut changes = 0;
        for (slot, facet) in self.wanted(q_np1, active)? {
            // A node that closes (again) always gets its facet.
            let first = self.slots[slot].pairing.is_none();
            if self.slots[slot].admits(facet) || first {
                self.set_end(slot, facet, q_np1)?;
                self.place_foot(slot);
                changes += 1;
            }
        }
        changes += self.relax(q_np1, active)? + self.rechoose_midpoint_facets(q_np1, active)?;
        for (slot, &active) in self.slots.iter_mut().zip(active) {
            if !active {
                // A released node that closes again is paired again.
                slot.pairing = None;
            }
        }
        Ok(changes)
    }

    fn constraint_gradients(
        &self,
        q_np1: &[f64],
        active: &[bool],
        visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), Fault> {
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let Some(Pairing { end, .. }) = self.slots[slot].pairing else { continue };
            let element = ElementNodes::new(self.node(slot), self.search.surface(), Pairing::single(end));
            let gap = self.gap(slot, end, q_np1)?;
            let weight = self.slot_weight(slot);
            let mut gradient = [0.0; LOCAL];
            gradient.iter_mut().zip(&gap.gradient).for_each(|(out, g)| *out = weight * g);
            visit(slot, element.list(), &gradient[..3 * element.count]);
        }
        Ok(())
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
        let state = &self.slots[slot];
        if state.relaxing { 0.0 } else { -state.settling * self.slot_weight(slot) }
    }
}
