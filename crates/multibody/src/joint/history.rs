//! What a joint carries from step to step: full turns, what tells whether it was held, and what a pretension keeps. And what its step stored and lost.

use super::Joint;
use super::assemble::SMALLEST_SLIP;
use stoss_contact::{ContactError, ContactWork, History};

/// History of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct JointHistory {
    /// Full turns of the coordinate.
    pub turns: i64,
    /// Invariants of the coordinate after the last accepted step.
    pub accepted: Option<[f64; 2]>,
    /// Energy of the spring after the last accepted step, if the joint was held.
    pub stored: f64,
    /// Norm of the force between the points in the last accepted step.
    pub reaction: f64,
    /// Torque of viscous friction on side b in the last accepted step.
    pub viscous: f64,
    /// Multiplier of motor or pretension in the last accepted step.
    pub driving: f64,
    /// The value that a locked pretension keeps.
    pub locked: Option<f64>,
}

/// Bytes of a history.
const SIZE: usize = 8 * 8 + 1;

/// Part of a step by which times may differ that are the same.
const SAME_TIME: f64 = 1e-9;

impl Joint {
    /// State of the step that begins at `q_n`.
    pub(super) fn begin(&mut self, q_n: &[f64]) {
        self.compliance.begin(self.step.dt);
        let Some(kind) = self.kind.coordinate() else { return };
        let start = self.invariants_of(&self.evaluate(q_n));
        self.step.start = start;
        self.step.value = self.value_at(kind, start);
        let stiffness = self.weights.stiffness(self.step.dt);
        self.step.stiffness = stiffness;
        if self.step.time_n == self.step.time_np1 {
            // It was off before.
            self.history.driving = 0.0;
        }
        if let Some(pretension) = &self.options.pretension {
            let at = |time| pretension.force.value(time).abs() / self.scale();
            let largest = at(self.step.time_n).max(at(self.step.time_np1));
            let is_past = self.step.time_n + SAME_TIME * self.step.dt >= pretension.lock;
            // The row of a force that is wrong by its own size is as long as the joint.
            self.step.pretension_unit = if largest > 0.0 { largest / self.length } else { stiffness };
            self.step.locked = self.history.locked.or(is_past.then_some(self.step.value));
        }
        if let Some(friction) = self.options.friction {
            // A row of slip is as long as the joint if the torque is ten times what it should be, so that it is judged as rows of stick are.
            let bound = friction.bound / self.scale() + self.friction_slope() * self.history.reaction;
            self.step.friction_unit = if bound > 0.0 { 10.0 * bound / self.length } else { stiffness };
            self.step.complementarity = stiffness.max(1e3 * bound / self.length);
        }
    }

    fn spring_energy(&self, value: f64) -> f64 {
        self.options.spring.map_or(0.0, |spring| 0.5 * spring.stiffness * (value - spring.rest).powi(2))
    }

    /// Torque of viscous friction on side b in a step with this change of the coordinate.
    fn viscous_torque(&self, change: f64) -> f64 {
        if self.is_damped() { -self.options.viscous * change / self.step.dt } else { 0.0 }
    }

    /// Value and change of the coordinate in the step that ends at `q_np1`.
    fn end_of_step(&self, q_np1: &[f64]) -> Option<(f64, f64)> {
        let kind = self.kind.coordinate()?;
        let change = kind.change(self.step.start, self.invariants_of(&self.evaluate(q_np1)));
        Some((self.step.value + change, change))
    }
}

impl History for Joint {
    fn work(&self, q_np1: &[f64], multipliers: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        let mut work = ContactWork::default();
        if !active.contains(&true) {
            // What a spring had is lost with a joint that is released.
            work.dissipated = self.history.stored;
            work.friction_work = self.history.stored;
            return Ok(work);
        }
        let Some((value, change)) = self.end_of_step(q_np1) else { return Ok(work) };
        work.stored = self.spring_energy(value);
        let of = |slot: Option<usize>| {
            slot.filter(|&slot| active[slot]).map_or(0.0, |slot| self.scale() * multipliers[slot] * change)
        };
        // What a stick or a limit moves within the tolerance must not give energy. More than that is seen in the ledger.
        let is_round_off = self.scale() * change.abs() <= SMALLEST_SLIP * self.length;
        let lost = |work: f64| if is_round_off { work.max(0.0) } else { work };
        work.dissipated =
            -self.viscous_torque(change) * change + lost(of(self.slots.friction)) + lost(of(self.slots.limit));
        work.friction_work = work.dissipated;
        // Forces of statics are those of the end of a step: their work is that of the trapezium rule, as of supports.
        let share = |m: f64| if self.step.has_rates { m } else { 0.5 * (m + self.history.driving) };
        let by_drive = |slot: usize| self.scale() * share(multipliers[slot]) * change;
        work.driven = self.slots.motor.filter(|&slot| active[slot]).map_or(0.0, by_drive);
        if self.step.locked.is_none() {
            work.driven -= self.slots.pretension.filter(|&slot| active[slot]).map_or(0.0, by_drive);
        }
        Ok(work)
    }

    fn stored_at_start(&self, q: &[f64]) -> f64 {
        self.coordinate(q).map_or(0.0, |value| self.spring_energy(value))
    }

    fn commit(&mut self, q_np1: &[f64], multipliers: &[f64], active: &[bool]) {
        let held = active.contains(&true);
        self.history.reaction = if held { self.reaction(multipliers) } else { 0.0 };
        let (Some(kind), Some((value, change))) = (self.kind.coordinate(), self.end_of_step(q_np1)) else { return };
        self.history.viscous = if held { self.viscous_torque(change) } else { 0.0 };
        let end = self.invariants_of(&self.evaluate(q_np1));
        self.history.turns = kind.turns(value, end);
        self.history.accepted = Some(end);
        self.history.stored = if held { self.spring_energy(value) } else { 0.0 };
        let drive = self.slots.motor.or(self.slots.pretension);
        self.history.driving = drive.filter(|&slot| active[slot]).map_or(0.0, |slot| multipliers[slot]);
        self.history.locked = self.step.locked;
    }

    fn save_history(&self) -> Vec<u8> {
        let h = &self.history;
        let [s, c] = h.accepted.unwrap_or_default();
        let mut bytes = h.turns.to_le_bytes().to_vec();
        for value in [s, c, h.stored, h.reaction, h.viscous, h.driving, h.locked.unwrap_or_default()] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.push(u8::from(h.accepted.is_some()) | u8::from(h.locked.is_some()) << 1);
        bytes
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        if bytes.len() != SIZE {
            let reason = format!("joint {} has {SIZE} bytes of history, not {}", self.name, bytes.len());
            return Err(ContactError::History { reason });
        }
        let word = |k: usize| std::array::from_fn(|i| bytes[8 * k + i]);
        let number = |k: usize| f64::from_le_bytes(word(k));
        self.history = JointHistory {
            turns: i64::from_le_bytes(word(0)),
            accepted: (bytes[SIZE - 1] & 1 != 0).then(|| [number(1), number(2)]),
            stored: number(3),
            reaction: number(4),
            viscous: number(5),
            driving: number(6),
            locked: (bytes[SIZE - 1] & 2 != 0).then(|| number(7)),
        };
        Ok(())
    }
}
