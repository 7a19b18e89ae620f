//! What goes from one accepted step to the next: tractions of friction, and for how many steps rows have been closed.

use super::MortarContact;
use stoss_contact::{Constraint, ContactError, ContactWork, History};

impl History for MortarContact {
    fn work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        let mut work = self.friction_work(q_np1, pressures, active);
        if let Some(stiffness) = self.options.overclosure {
            let closed = self.end.slots.iter().zip(pressures).zip(active).filter(|(_, active)| **active);
            work.stored += closed.map(|((slot, p), _)| 0.5 * slot.support * p * p / stiffness).sum::<f64>();
        }
        work.closing = self.has_middle().then(|| {
            let carrying = (0..self.slot_count()).filter(|&k| active[k] && self.step.carried[k]);
            let gaps = |k: usize| Some(self.step.gap[k].unwrap_or(0.0) - self.end.slots[k].gap(q_np1)?);
            carrying.filter_map(|k| Some(pressures[k] * gaps(k)?)).sum()
        });
        Ok(work)
    }

    fn commit(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        self.commit_friction(q_np1, pressures, active);
        for (steps, active) in self.closed_steps.iter_mut().zip(active) {
            *steps = if *active { steps.saturating_add(1) } else { 0 };
        }
    }

    fn save_history(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.closed_steps.iter().flat_map(|steps| steps.to_le_bytes()).collect();
        bytes.extend(self.save_friction());
        bytes
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        let (steps, friction) = bytes.split_at(bytes.len().min(4 * self.closed_steps.len()));
        if friction.len() != self.friction_history() || steps.len() != 4 * self.closed_steps.len() {
            let reason = format!("{} bytes for {} slots", bytes.len(), self.slot_count());
            return Err(ContactError::History { reason });
        }
        let (numbers, _) = steps.as_chunks::<4>();
        self.closed_steps.iter_mut().zip(numbers).for_each(|(steps, bytes)| *steps = u32::from_le_bytes(*bytes));
        self.load_friction(friction);
        Ok(())
    }
}
