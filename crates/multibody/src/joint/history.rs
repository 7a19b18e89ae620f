//! History of a joint: full turns, whether it acted in the last step, and the value that a pretension keeps. Also the energy that a step stores and dissipates.

use super::Joint;
use super::coordinate_forces::{CoordinateHistory, SMALLEST_SLIP};
use stoss_term::{Fault, Undefined, Work};

/// Bytes of the history of a coordinate.
const SIZE: usize = 8 * 7 + 1;

/// Part of a step below which two times count as equal.
const SAME_TIME: f64 = 1e-9;

impl Joint {
    /// State of the step that begins at `q_n`.
    pub(super) fn begin_at(&mut self, q_n: &[f64]) {
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
            if self.step.time_n == self.step.time_np1 {
                // It was off before.
                c.history.driving = 0.0;
            }
            if let Some(pretension) = &c.options.pretension {
                let at = |time| pretension.force.value(time).abs() / c.scale();
                let largest = at(self.step.time_n).max(at(self.step.time_np1));
                let is_past = self.step.time_n + SAME_TIME * self.step.dt >= pretension.lock;
                // The row of a force that is wrong by its own size is as long as the joint.
                c.state.pretension_unit = if largest > 0.0 { largest / self.length } else { stiffness };
                c.state.locked = c.history.locked.or(is_past.then_some(c.state.value));
            }
            if let Some(friction) = c.options.friction {
                // A row of slip is as long as the joint if the torque is ten times what it should be, so that it is judged as rows of stick are.
                let bound = friction.bound / c.scale() + c.friction_slope() * self.last_reaction;
                c.state.friction_unit = if bound > 0.0 { 10.0 * bound / self.length } else { stiffness };
                c.state.complementarity = stiffness.max(1e3 * bound / self.length);
            }
        }
    }
}

impl Joint {
    pub(super) fn step_work(&self, q_np1: &[f64], multipliers: &[f64], active: &[bool]) -> Work {
        let mut work = Work::default();
        if !active.contains(&true) {
            // What a spring had is lost with a joint that is released.
            work.dissipated = self.coordinates.iter().map(|c| c.history.stored).sum();
            work.friction_work = work.dissipated;
            return work;
        }
        if self.coordinates.is_empty() {
            return work;
        }
        let values = self.evaluate(q_np1).values;
        let mut closing = 0.0;
        for c in &self.coordinates {
            let (value, change) = c.end_of_step(&values);
            work.stored += c.spring_energy(value);
            let of = |slot: Option<usize>| {
                slot.filter(|&slot| active[slot]).map_or(0.0, |slot| c.scale() * multipliers[slot] * change)
            };
            // What a stick or a limit moves within the tolerance must not give energy. More than that is seen in the balance of energy.
            let is_round_off = c.scale() * change.abs() <= SMALLEST_SLIP * self.length;
            let lost = |work: f64| if is_round_off { work.max(0.0) } else { work };
            work.dissipated += -c.viscous_torque(&self.step, change) * change + lost(of(c.slots.friction));
            // Statics has no energy that closing could cost.
            match self.step.has_rates {
                true => closing += lost(of(c.slots.limit)),
                false => work.dissipated += lost(of(c.slots.limit)),
            }
            // Forces of statics are those of the end of a step: their work is that of the trapezium rule, as of supports.
            let share = |m: f64| if self.step.has_rates { m } else { 0.5 * (m + c.history.driving) };
            let by_drive = |slot: usize| c.scale() * share(multipliers[slot]) * change;
            work.driven += c.slots.motor.filter(|&slot| active[slot]).map_or(0.0, by_drive);
            if c.state.locked.is_none() {
                work.driven -= c.slots.pretension.filter(|&slot| active[slot]).map_or(0.0, by_drive);
            }
        }
        work.friction_work = work.dissipated;
        work.closing = Some(closing);
        work
    }

    pub(super) fn spring_energy(&self, q: &[f64]) -> f64 {
        if self.coordinates.is_empty() {
            return 0.0;
        }
        let values = self.evaluate(q).values;
        self.coordinates.iter().map(|c| c.spring_energy(c.value(&values))).sum()
    }

    pub(super) fn end_step(&mut self, q_np1: &[f64], multipliers: &[f64], active: &[bool]) {
        let held = active.contains(&true);
        self.last_reaction = if held { self.reaction(multipliers) } else { 0.0 };
        if self.coordinates.is_empty() {
            return;
        }
        let values = self.evaluate(q_np1).values;
        for c in &mut self.coordinates {
            let (end, (value, change)) = (c.invariants(&values), c.end_of_step(&values));
            let drive = c.slots.motor.or(c.slots.pretension);
            c.history = CoordinateHistory {
                turns: c.kind.turns(value, end),
                accepted: Some(end),
                stored: if held { c.spring_energy(value) } else { 0.0 },
                viscous: if held { c.viscous_torque(&self.step, change) } else { 0.0 },
                driving: drive.filter(|&slot| active[slot]).map_or(0.0, |slot| multipliers[slot]),
                locked: c.state.locked,
            };
        }
    }

    pub(super) fn history(&self) -> Vec<u8> {
        let mut bytes = self.last_reaction.to_le_bytes().to_vec();
        for c in &self.coordinates {
            let h = &c.history;
            let [s, c] = h.accepted.unwrap_or_default();
            bytes.extend(h.turns.to_le_bytes());
            for value in [s, c, h.stored, h.viscous, h.driving, h.locked.unwrap_or_default()] {
                bytes.extend(value.to_le_bytes());
            }
            bytes.push(u8::from(h.accepted.is_some()) | u8::from(h.locked.is_some()) << 1);
        }
        bytes
    }

    pub(super) fn set_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let size = 8 + SIZE * self.coordinates.len();
        let (reaction, rest) = match bytes.split_first_chunk::<8>() {
            Some(parts) if bytes.len() == size => parts,
            _ => {
                let reason = format!("it has {size} bytes of history, not {}", bytes.len());
                return Err(Fault::other(Undefined { term: format!("joint {}", self.name), reason }));
            }
        };
        self.last_reaction = f64::from_le_bytes(*reaction);
        for (c, bytes) in self.coordinates.iter_mut().zip(rest.chunks_exact(SIZE)) {
            let word = |k: usize| std::array::from_fn(|i| bytes[8 * k + i]);
            let number = |k: usize| f64::from_le_bytes(word(k));
            c.history = CoordinateHistory {
                turns: i64::from_le_bytes(word(0)),
                accepted: (bytes[SIZE - 1] & 1 != 0).then(|| [number(1), number(2)]),
                stored: number(3),
                viscous: number(4),
                driving: number(5),
                locked: (bytes[SIZE - 1] & 2 != 0).then(|| number(6)),
            };
        }
        Ok(())
    }
}
