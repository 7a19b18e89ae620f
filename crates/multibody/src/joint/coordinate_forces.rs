//! Torques on a coordinate of a joint, and the rows of its slots.

use super::StepState;
use super::coordinate::{CoordinateKind, LARGEST_TURN};
use super::options::CoordinateOptions;
use stoss_term::{GradientRule, JointTorques, Undefined};

/// A slip below this part of the length of the joint, where a limit stops the motion, counts as zero.
pub(super) const SMALLEST_SLIP: f64 = 1e-9;

/// The slots of a coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Slots {
    pub friction: Option<usize>,
    pub motor: Option<usize>,
    pub pretension: Option<usize>,
    pub limit: Option<usize>,
}

/// State of a coordinate in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CoordinateState {
    /// Invariants and coordinate at `q_n`.
    pub start: [f64; 2],
    pub value: f64,
    /// `c` of friction, `f` of its slip row, that of the row of a given pretension, `c` of limits; a force over a length each.
    pub complementarity: f64,
    pub friction_unit: f64,
    pub pretension_unit: f64,
    /// The value that a locked pretension keeps.
    pub locked: Option<f64>,
    pub stiffness: f64,
}

impl CoordinateState {
    pub const FIRST: Self = Self {
        start: [0.0; 2],
        value: 0.0,
        complementarity: 1.0,
        friction_unit: 1.0,
        pretension_unit: 1.0,
        locked: None,
        stiffness: 1.0,
    };
}

/// What a coordinate carries from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CoordinateHistory {
    /// Full turns.
    pub turns: i64,
    /// Invariants after the last accepted step.
    pub accepted: Option<[f64; 2]>,
    /// Energy of the spring after the last accepted step, if the joint was held.
    pub stored: f64,
    /// Torque of viscous friction on side b in the last accepted step.
    pub viscous: f64,
    /// Multiplier of motor or pretension in the last accepted step.
    pub driving: f64,
    /// The value that a locked pretension keeps.
    pub locked: Option<f64>,
}

/// One coordinate of a joint.
#[derive(Clone, Debug)]
pub(super) struct Coordinate {
    pub kind: CoordinateKind,
    /// Number of its first invariant among the functions of the joint, and how many it has.
    pub first: usize,
    pub count: usize,
    /// Length of the joint.
    pub length: f64,
    pub options: CoordinateOptions,
    pub slots: Slots,
    pub state: CoordinateState,
    pub history: CoordinateHistory,
}

/// The coordinate in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoordinateStep {
    pub value_n: f64,
    pub change: f64,
    /// Weights of the gradients of the invariants at the start, between and at the end: `g = sum W_k grad phi_k`.
    pub weights: [[f64; 2]; 3],
    /// Derivatives of the weights of configuration `moving` with respect to the invariants of configuration `column`.
    pub second: [[f64; 2]; 2],
    pub moving: usize,
    pub column: usize,
    /// Derivatives of the coordinate with respect to the invariants at the end.
    pub slope: [f64; 2],
}

/// Torque and its derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Torque {
    pub value: f64,
    pub by_coordinate: f64,
}

/// A row of a slot on the coordinate: value, and derivatives with respect to the coordinate and its own multiplier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub value: f64,
    pub by_coordinate: f64,
    pub by_own: f64,
    /// Derivative with respect to the norm of the reaction.
    pub by_reaction: f64,
    /// Whether it holds as an equation on the coordinate.
    pub holds: bool,
}

impl Coordinate {
    /// What multipliers are multiplied by to be torques: the length of the joint for an angle, 1 for a displacement.
    pub fn scale(&self) -> f64 {
        match self.kind {
            CoordinateKind::Angle => self.length,
            CoordinateKind::Displacement => 1.0,
        }
    }

    /// Invariants of the coordinate among the values of all functions.
    pub fn invariants(&self, values: &[f64]) -> [f64; 2] {
        [0, 1].map(|k| if k < self.count { values[self.first + k] } else { 0.0 })
    }

    /// Value at accepted invariants: principal value and turns.
    pub fn value_at(&self, start: [f64; 2]) -> f64 {
        self.kind.principal(start) + std::f64::consts::TAU * self.history.turns as f64
    }

    /// Value, less than half a turn from that of the last accepted step (before the first step: from zero).
    pub fn value(&self, values: &[f64]) -> f64 {
        let phi = self.invariants(values);
        match self.history.accepted {
            Some(start) => self.value_at(start) + self.kind.change(start, phi),
            None => self.kind.principal(phi),
        }
    }

    pub fn spring_energy(&self, value: f64) -> f64 {
        self.options.spring.map_or(0.0, |spring| 0.5 * spring.stiffness * (value - spring.rest).powi(2))
    }

    /// Value and change in the step that ends with these values of all functions.
    pub fn end_of_step(&self, values: &[f64]) -> (f64, f64) {
        let change = self.kind.change(self.state.start, self.invariants(values));
        (self.state.value + change, change)
    }

    /// The coordinate in a step, from the values of all functions at the start, between and at the end; `None` if nothing acts on it.
    pub fn in_step(
        &self,
        joint: &str,
        rule: GradientRule,
        values: [&[f64]; 3],
    ) -> Result<Option<CoordinateStep>, Undefined> {
        if !self.options.any() {
            return Ok(None);
        }
        let kind = self.kind;
        let [start, between, end] = values.map(|values| self.invariants(values));
        let change = kind.change(start, end);
        if kind == CoordinateKind::Angle && change.abs() > LARGEST_TURN {
            return Err(Undefined {
                term: format!("joint {joint}"),
                reason: format!("it turns by {change:.2} rad, nearly half a turn, in one step; use smaller steps"),
            });
        }
        let mut weights = [[0.0; 2]; 3];
        let (second, moving, column) = match rule {
            GradientRule::DiscreteGradient => {
                let (w, second) = kind.discrete_gradient(start, end);
                weights[1] = w;
                (second, 1, 2)
            }
            GradientRule::EndPointMean => {
                weights[0] = kind.derivatives(start).0.map(|w| 0.5 * w);
                let (w, second) = kind.derivatives(end);
                weights[2] = w.map(|w| 0.5 * w);
                (second.map(|row| row.map(|s| 0.5 * s)), 2, 2)
            }
            GradientRule::StartPoint | GradientRule::EndPoint | GradientRule::Midpoint => {
                let (w, second) = kind.derivatives(between);
                weights[1] = w;
                (second, 1, 1)
            }
        };
        let value_n = self.value_at(start);
        Ok(Some(CoordinateStep { value_n, change, weights, second, moving, column, slope: kind.derivatives(end).0 }))
    }

    /// Torque that resists the coordinate, without the parts of multipliers.
    pub fn torque(&self, step: &StepState, theta: f64, c: &CoordinateStep) -> Torque {
        let mut torque = Torque::default();
        if let Some(spring) = self.options.spring {
            torque.value += spring.stiffness * (c.value_n + theta * c.change - spring.rest);
            torque.by_coordinate += theta * spring.stiffness;
        }
        if self.is_damped(step) {
            torque.value += self.options.viscous * c.change / step.dt;
            torque.by_coordinate += self.options.viscous / step.dt;
        }
        if step.dt == 0.0 && self.slots.pretension.is_some() && self.state.locked.is_none() {
            // The multiplier is not known yet where accelerations of the start are made.
            torque.value += self.given_pretension(step, 1.0);
        }
        torque
    }

    pub fn is_damped(&self, step: &StepState) -> bool {
        self.options.viscous > 0.0 && step.has_rates && step.dt > 0.0
    }

    /// Slots on the coordinate, and the sign of their multipliers in the torque that resists it.
    pub fn signs(&self) -> impl Iterator<Item = (usize, f64)> {
        let s = self.slots;
        [(s.friction, 1.0), (s.motor, -1.0), (s.pretension, 1.0), (s.limit, 1.0)]
            .into_iter()
            .filter_map(|(slot, sign)| Some((slot?, sign)))
    }

    pub fn friction_row(&self, c: &CoordinateStep, reaction: f64, multipliers: &[f64], slot: usize) -> Row {
        let (friction, scale) = (self.options.friction.unwrap_or_default(), self.scale());
        let by_reaction = self.friction_slope();
        let bound = friction.bound / scale + by_reaction * reaction;
        let (own, slip) = (multipliers[slot], scale * c.change);
        let trial = own + self.state.complementarity * slip;
        let unit = self.state.friction_unit;
        let side = match self.closed_limit(c, multipliers) {
            // The limit stops the motion. Friction acts against the rest of it, and is zero if there is none.
            Some((_, rest)) if rest.abs() <= SMALLEST_SLIP * self.length => 0.0,
            Some((_, rest)) => rest.signum(),
            None => trial.signum(),
        };
        // A point that slides the other way sticks first; otherwise the iteration would alternate.
        let sticks = trial.abs() <= bound || (own * slip < 0.0 && own.abs() <= 1.5 * bound);
        if sticks && self.closed_limit(c, multipliers).is_none() {
            return Row { value: slip, by_coordinate: scale, by_own: 0.0, by_reaction: 0.0, holds: true };
        }
        Row {
            value: (side * bound - own) / unit,
            by_coordinate: 0.0,
            by_own: -1.0 / unit,
            by_reaction: side * by_reaction / unit,
            holds: false,
        }
    }

    /// Derivative of the bound of friction, as a multiplier, with respect to the reaction.
    pub fn friction_slope(&self) -> f64 {
        let friction = self.options.friction.unwrap_or_default();
        match self.kind {
            CoordinateKind::Angle => friction.coefficient * friction.radius / self.scale(),
            CoordinateKind::Displacement => friction.coefficient,
        }
    }

    pub fn motor_row(&self, step: &StepState, c: &CoordinateStep) -> Row {
        let target = self.options.motor.as_ref().map_or(0.0, |drive| drive.value(step.time_np1));
        let scale = self.scale();
        let value = -scale * (c.value_n + c.change - target);
        Row { value, by_coordinate: -scale, by_own: 0.0, by_reaction: 0.0, holds: true }
    }

    pub fn pretension_row(
        &self,
        step: &StepState,
        theta: f64,
        c: &CoordinateStep,
        multipliers: &[f64],
        slot: usize,
    ) -> Row {
        let scale = self.scale();
        if let Some(locked) = self.state.locked {
            let value = scale * (c.value_n + c.change - locked);
            return Row { value, by_coordinate: scale, by_own: 0.0, by_reaction: 0.0, holds: true };
        }
        let unit = self.state.pretension_unit;
        let value = (self.given_pretension(step, theta) / scale - multipliers[slot]) / unit;
        Row { value, by_coordinate: 0.0, by_own: -1.0 / unit, by_reaction: 0.0, holds: false }
    }

    /// The force of a pretension that is not locked, at the time of the rule.
    fn given_pretension(&self, step: &StepState, theta: f64) -> f64 {
        let time = step.time_n + theta * (step.time_np1 - step.time_n);
        self.options.pretension.as_ref().map_or(0.0, |pretension| pretension.force.value(time))
    }

    /// Torque of viscous friction on side b in a step with this change.
    pub fn viscous_torque(&self, step: &StepState, change: f64) -> f64 {
        if self.is_damped(step) { -self.options.viscous * change / step.dt } else { 0.0 }
    }

    /// Torques (or forces) that act on side b at the end of the last accepted step, which has led to this value.
    pub fn torques(&self, value: f64, multipliers: &[f64]) -> JointTorques {
        let of = |slot: Option<usize>| slot.map_or(0.0, |slot| self.scale() * multipliers[slot]);
        JointTorques {
            friction: -of(self.slots.friction),
            viscous: self.history.viscous,
            spring: self.options.spring.map_or(0.0, |spring| -spring.stiffness * (value - spring.rest)),
            motor: of(self.slots.motor) - of(self.slots.pretension),
            limit: -of(self.slots.limit),
        }
    }

    /// Distance of the coordinate beyond a limit that is closed, and how far it may go in the step; lengths.
    fn closed_limit(&self, c: &CoordinateStep, multipliers: &[f64]) -> Option<(f64, f64)> {
        let (own, factor, scale) = (multipliers[self.slots.limit?], self.state.stiffness, self.scale());
        let [low, high] = self.options.limits?;
        let value = c.value_n + c.change;
        let pair = |limit: f64| (scale * (value - limit), scale * (limit - c.value_n));
        if own + factor * pair(high).0 > 0.0 {
            Some(pair(high))
        } else if own + factor * pair(low).0 < 0.0 {
            Some(pair(low))
        } else {
            None
        }
    }

    pub fn limit_row(&self, c: &CoordinateStep, multipliers: &[f64], slot: usize) -> Row {
        let factor = self.state.stiffness;
        match self.closed_limit(c, multipliers) {
            Some((value, _)) => Row { value, by_coordinate: self.scale(), by_own: 0.0, by_reaction: 0.0, holds: true },
            None => Row {
                value: -multipliers[slot] / factor,
                by_coordinate: 0.0,
                by_own: -1.0 / factor,
                by_reaction: 0.0,
                holds: false,
            },
        }
    }
}
