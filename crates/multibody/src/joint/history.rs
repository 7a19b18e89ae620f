//! What a joint carries from step to step: full turns, and what tells whether it was held. And what its step stored and lost.

use super::Joint;
use super::acting::CoordinateHistory;
use stoss_contact::{ContactError, ContactWork, History};

/// Bytes of the history of a coordinate.
const SIZE: usize = 8 * 4 + 1;

impl Joint {
    /// State of the step that begins at `q_n`.
    pub(super) fn begin(&mut self, q_n: &[f64]) {
        self.compliance.begin(self.step.dt);
        if self.coordinates.is_empty() {
            return;
        }
        let values = self.evaluate(q_n).values;
        let stiffness = self.weights.stiffness(self.step.dt);
        for c in &mut self.coordinates {
            c.state.start = c.invariants(&values);
            c.state.value = c.value_at(c.state.start);
            c.state.stiffness = stiffness;
            if let Some(friction) = c.options.friction {
                // A row of slip is as long as the joint if the torque is ten times what it should be, so that it is judged as rows of stick are.
                let bound = friction.bound / c.scale() + c.friction_slope() * self.last_reaction;
                c.state.friction_unit = if bound > 0.0 { 10.0 * bound / self.length } else { stiffness };
                c.state.complementarity = stiffness.max(1e3 * bound / self.length);
            }
        }
    }
}

impl History for Joint {
    fn work(&self, q_np1: &[f64], multipliers: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        let mut work = ContactWork::default();
        if !active.contains(&true) {
            // What a spring had is lost with a joint that is released.
            work.dissipated = self.coordinates.iter().map(|c| c.history.stored).sum();
            work.friction_work = work.dissipated;
            return Ok(work);
        }
        if self.coordinates.is_empty() {
            return Ok(work);
        }
        let values = self.evaluate(q_np1).values;
        for c in &self.coordinates {
            let (value, change) = c.end_of_step(&values);
            work.stored += c.spring_energy(value);
            let of = |slot: Option<usize>| {
                slot.filter(|&slot| active[slot]).map_or(0.0, |slot| c.scale() * multipliers[slot] * change)
            };
            let damped = if c.is_damped(&self.step) { c.options.viscous * change * change / self.step.dt } else { 0.0 };
            // Round-off of a stick or of a limit that is reached must not give energy.
            work.dissipated += damped + of(c.slots.friction).max(0.0) + of(c.slots.limit).max(0.0);
            work.driven += of(c.slots.motor);
        }
        work.friction_work = work.dissipated;
        Ok(work)
    }

    fn stored_at_start(&self, q: &[f64]) -> f64 {
        if self.coordinates.is_empty() {
            return 0.0;
        }
        let values = self.evaluate(q).values;
        self.coordinates.iter().map(|c| c.spring_energy(c.value(&values))).sum()
    }

    fn commit(&mut self, q_np1: &[f64], multipliers: &[f64], active: &[bool]) {
        let held = active.contains(&true);
        self.last_reaction = if held { self.reaction(multipliers) } else { 0.0 };
        if self.coordinates.is_empty() {
            return;
        }
        let values = self.evaluate(q_np1).values;
        for c in &mut self.coordinates {
            let (end, (value, _)) = (c.invariants(&values), c.end_of_step(&values));
            c.history = CoordinateHistory {
                turns: c.kind.turns(value, end),
                accepted: Some(end),
                stored: if held { c.spring_energy(value) } else { 0.0 },
            };
        }
    }

    fn save_history(&self) -> Vec<u8> {
        let mut bytes = self.last_reaction.to_le_bytes().to_vec();
        for c in &self.coordinates {
            let h = &c.history;
            let [s, c] = h.accepted.unwrap_or_default();
            bytes.extend(h.turns.to_le_bytes());
            for value in [s, c, h.stored] {
                bytes.extend(value.to_le_bytes());
            }
            bytes.push(u8::from(h.accepted.is_some()));
        }
        bytes
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        let size = 8 + SIZE * self.coordinates.len();
        let (reaction, rest) = match bytes.split_first_chunk::<8>() {
            Some(parts) if bytes.len() == size => parts,
            _ => {
                let reason = format!("joint {} has {size} bytes of history, not {}", self.name, bytes.len());
                return Err(ContactError::History { reason });
            }
        };
        self.last_reaction = f64::from_le_bytes(*reaction);
        for (c, bytes) in self.coordinates.iter_mut().zip(rest.chunks_exact(SIZE)) {
            let word = |k: usize| std::array::from_fn(|i| bytes[8 * k + i]);
            let number = |k: usize| f64::from_le_bytes(word(k));
            c.history = CoordinateHistory {
                turns: i64::from_le_bytes(word(0)),
                accepted: (bytes[SIZE - 1] == 1).then(|| [number(1), number(2)]),
                stored: number(3),
            };
        }
        Ok(())
    }
}
