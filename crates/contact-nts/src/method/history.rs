//! What a slot carries from one accepted step to the next.

use crate::method::NodeToSurface;
use stoss_contact::ContactError;
use stoss_term::Work;

/// Bytes of history of a slot: facet, gap kept, strayed or not, the part of the gap that is held, steps closed.
const HISTORY: usize = 25;

impl NodeToSurface {
    pub(super) fn step_work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<Work, ContactError> {
        let mut total = self.friction_work(q_np1, pressures, active)?;
        total.stored += self.normal_stored(q_np1, active)?;
        Ok(Work { closing: None, ..total })
    }

    pub(super) fn end_step(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        self.commit_friction(q_np1, pressures, active);
        self.reference_gap.commit();
        let view = self.search.at(q_np1);
        let behind: Vec<(bool, f64)> = (0..self.slots.len())
            .map(|slot| {
                let state = &self.slots[slot];
                // Most nodes are in front, or far away: nothing to look for.
                let may_stray = state.origin.is_none() || state.strayed;
                let was_kept = self.leaves && (state.committed.is_some() || state.kept < 0.0);
                if active[slot] || !(may_stray || was_kept) {
                    return (false, 0.0);
                }
                let point = self.closest(&view, slot, q_np1);
                match point.pairing {
                    Some(pairing) if point.gap < 0.0 => {
                        let strayed = may_stray && self.came_from_behind(slot, pairing.facet);
                        (strayed, if was_kept { self.gap_to_keep(slot, &point, q_np1) } else { 0.0 })
                    }
                    _ => (false, 0.0),
                }
            })
            .collect();
        for ((slot, &active), (strayed, left_behind)) in self.slots.iter_mut().zip(active).zip(behind) {
            slot.committed = slot.pairing.filter(|_| active).map(|p| p.end);
            let is_closed = slot.committed.is_some();
            slot.kept = if is_closed { slot.reference } else { left_behind };
            (slot.held, slot.steps) = if is_closed { (slot.held, slot.steps.saturating_add(1)) } else { (0.0, 0) };
            slot.strayed = strayed;
        }
    }

    pub(super) fn history(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HISTORY * self.slots.len());
        for slot in &self.slots {
            out.extend_from_slice(&slot.committed.unwrap_or(u32::MAX).to_le_bytes());
            out.extend_from_slice(&slot.kept.to_le_bytes());
            out.push(u8::from(slot.strayed));
            out.extend_from_slice(&slot.held.to_le_bytes());
            out.extend_from_slice(&slot.steps.to_le_bytes());
        }
        self.save_friction(&mut out);
        self.reference_gap.save(&mut out);
        out
    }

    pub(super) fn set_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        let size = HISTORY + self.friction_bytes();
        let count = self.slots.len();
        let error = || ContactError::History {
            reason: format!("{} bytes for {count} slave nodes of {size} bytes", bytes.len()),
        };
        let (of_slots, of_contact) = bytes.split_at_checked(size * count).ok_or_else(error)?;
        let (bytes, friction) = of_slots.split_at(HISTORY * count);
        let mut reference_gap = self.reference_gap.clone();
        if !reference_gap.load(of_contact, count).ok_or_else(error)?.is_empty() {
            return Err(error());
        }
        let facets = self.search.surface().facets().len() as u32;
        for (slot, chunk) in self.slots.iter_mut().zip(bytes.chunks_exact(HISTORY)) {
            let facet = u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
            if facet != u32::MAX && facet >= facets {
                return Err(ContactError::History { reason: format!("facet {facet} of {facets}") });
            }
            let number = |first: usize| f64::from_le_bytes(std::array::from_fn(|k| chunk[first + k]));
            slot.committed = (facet != u32::MAX).then_some(facet);
            slot.kept = number(4);
            slot.strayed = chunk[12] != 0;
            slot.held = number(13);
            slot.steps = u32::from_le_bytes(std::array::from_fn(|k| chunk[21 + k]));
        }
        self.reference_gap = reference_gap;
        self.load_friction(friction);
        Ok(())
    }
}
