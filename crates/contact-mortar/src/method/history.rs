//! What goes from one accepted step to the next: tractions of friction, for how many steps rows have been closed, and what their tangents have learnt.

use super::MortarContact;
use crate::secant::Secant;
use stoss_contact::ContactError;
use stoss_term::{ReferenceGap, Term as _, Work};

/// A history, as it was saved.
struct Saved<'a> {
    steps: &'a [u8],
    friction: &'a [u8],
    reference_gap: ReferenceGap,
    /// Bytes of these three.
    length: usize,
    secants: Vec<Secant>,
}

impl MortarContact {
    pub(super) fn step_work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Work {
        let mut work = self.friction_work(q_np1, pressures, active);
        if let Some(stiffness) = self.options.overclosure {
            let closed = self.end.slots.iter().zip(pressures).zip(active).filter(|(_, active)| **active);
            work.stored += closed.map(|((slot, p), _)| 0.5 * slot.support * p * p / stiffness).sum::<f64>();
        }
        work.closing = self.has_middle().then(|| {
            let carrying = (0..self.slot_count()).filter(|&k| active[k] && self.step.carried[k]);
            let end = |k: usize| {
                let slot = &self.end.slots[k];
                Some(slot.gap(q_np1)? - self.step.distance[k] * slot.support)
            };
            carrying.filter_map(|k| Some(pressures[k] * (self.step.start_beyond(k) - end(k)?))).sum()
        });
        work
    }

    pub(super) fn end_step(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        self.commit_friction(q_np1, pressures, active);
        self.reference_gap.commit();
        for (steps, active) in self.closed_steps.iter_mut().zip(active) {
            *steps = if *active { steps.saturating_add(1) } else { 0 };
        }
        let opened = self.secants.iter_mut().zip(active).filter(|(_, active)| !**active);
        opened.for_each(|(secant, _)| *secant = Secant::default());
    }

    pub(super) fn history(&self) -> Vec<u8> {
        let mut out: Vec<u8> = self.closed_steps.iter().flat_map(|steps| steps.to_le_bytes()).collect();
        out.extend(self.save_friction());
        self.reference_gap.save(&mut out);
        let learnt = self.secants.iter().enumerate().filter(|(k, _)| self.own[*k]);
        save_secants(learnt, &mut out);
        out
    }

    /// What all ranks saved, put together: what rows have learnt is that of their ranks, and everything else the same on all.
    pub(super) fn join(&self, parts: &[Vec<u8>]) -> Result<Vec<u8>, ContactError> {
        let mut all = vec![Secant::default(); self.slot_count()];
        let mut out = Vec::new();
        for part in parts {
            let Saved { length, secants, .. } = self.saved(part)?;
            out.clear();
            out.extend_from_slice(&part[..length]);
            let learnt = all.iter_mut().zip(secants).filter(|(_, found)| !found.is_empty());
            learnt.for_each(|(secant, found)| *secant = found);
        }
        if !parts.is_empty() {
            save_secants(all.iter().enumerate(), &mut out);
        }
        Ok(out)
    }

    fn saved<'a>(&self, bytes: &'a [u8]) -> Result<Saved<'a>, ContactError> {
        let saved = || {
            let (steps, rest) = bytes.split_at_checked(4 * self.closed_steps.len())?;
            let (friction, rest) = rest.split_at_checked(self.friction_history())?;
            let mut reference_gap = self.reference_gap.clone();
            let rest = reference_gap.load(rest, self.slot_count())?;
            let secants = load_secants(rest, self.slot_count())?;
            Some(Saved { steps, friction, reference_gap, length: bytes.len() - rest.len(), secants })
        };
        saved().ok_or_else(|| {
            let reason = format!("{} bytes for {} slots", bytes.len(), self.slot_count());
            ContactError::History { reason }
        })
    }

    pub(super) fn set_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        let Saved { steps, friction, reference_gap, secants, .. } = self.saved(bytes)?;
        let (numbers, _) = steps.as_chunks::<4>();
        self.closed_steps.iter_mut().zip(numbers).for_each(|(steps, bytes)| *steps = u32::from_le_bytes(*bytes));
        self.load_friction(friction);
        self.secants = secants;
        self.reference_gap = reference_gap;
        // Of the step that was begun before they were known.
        self.step.reference.clear();
        Ok(())
    }
}

/// What rows have learnt, with their numbers; those that have learnt nothing are left out.
fn save_secants<'a>(of_rows: impl Iterator<Item = (usize, &'a Secant)>, out: &mut Vec<u8>) {
    let learnt: Vec<_> = of_rows.filter(|(_, secant)| !secant.is_empty()).collect();
    out.extend((learnt.len() as u32).to_le_bytes());
    for (k, secant) in learnt {
        out.extend((k as u32).to_le_bytes());
        secant.save(out);
    }
}

/// What rows have learnt; `None` if the bytes are others.
fn load_secants(mut bytes: &[u8], rows: usize) -> Option<Vec<Secant>> {
    let word = |bytes: &mut &[u8]| -> Option<u32> {
        let (word, rest) = bytes.split_first_chunk()?;
        *bytes = rest;
        Some(u32::from_le_bytes(*word))
    };
    let mut out = vec![Secant::default(); rows];
    for _ in 0..word(&mut bytes)? {
        let row = word(&mut bytes)? as usize;
        *out.get_mut(row)? = Secant::load(&mut bytes)?;
    }
    bytes.is_empty().then_some(out)
}
