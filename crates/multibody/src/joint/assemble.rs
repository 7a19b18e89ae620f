//! Force, tangent and rows of a joint.
//!
//! `R = -sum lambda_k grad phi_k + T g`, where `g` is a gradient of the coordinate under the rule and `T` all torques that resist it. Rows in the order of the slots:
//! `-phi_k`; friction `xi` in stick (`|t + c xi| <= B`, or `t` against `xi`) and else `(+-B - t) / f`, with a closed limit always; motor `-(gamma - target)`; pretension `(P - p) / f` with the given force `P`, and `gamma - gamma_lock` once it is locked; limits `(max(0, p + c (xi - hi)) + min(0, p + c (xi - lo)) - p) / c`,
//! with lengths `xi` for the coordinate.

use super::coordinate::LARGEST_TURN;
use super::{CoordinateKind, Joint};
use crate::constraint::{Rows, gradient_fraction};
use crate::quadratic::Evaluation;
use stoss_contact::{
    Constraint, ContactError, ContactRule, JointReport, LocalContribution, Report, SlotReport, StepConfiguration,
};

/// A slip below this share of the length of the joint that a limit leaves is none.
pub(super) const SMALLEST_SLIP: f64 = 1e-9;

/// Functions at the three configurations of a step.
#[derive(Debug, Default)]
struct Evaluations {
    start: Evaluation,
    between: Evaluation,
    end: Evaluation,
}

/// The coordinate in a step.
#[derive(Clone, Copy, Debug)]
struct CoordinateStep {
    value_n: f64,
    change: f64,
    /// Weights of the gradients of the invariants at the start, between and at the end: `g = sum W_k grad phi_k`.
    weights: [[f64; 2]; 3],
    /// Derivatives of the weights of configuration `moving` with respect to the invariants of configuration `column`.
    second: [[f64; 2]; 2],
    moving: usize,
    column: usize,
    /// Derivatives of the value with respect to the invariants at the end.
    slope: [f64; 2],
}

/// Torque and its derivatives.
#[derive(Clone, Debug, Default)]
struct Torque {
    value: f64,
    by_coordinate: f64,
}

/// A row of a slot on the coordinate: value, and derivatives with respect to the coordinate and its own multiplier.
#[derive(Clone, Copy, Debug)]
struct Row {
    value: f64,
    by_coordinate: f64,
    by_own: f64,
    /// Derivative with respect to the norm of the reaction.
    by_reaction: f64,
    /// Whether it holds as an equation on the coordinate.
    holds: bool,
}

impl Joint {
    fn evaluations(&self, step: StepConfiguration<'_>, want_tangent: bool) -> Evaluations {
        let mut e = Evaluations::default();
        let theta = gradient_fraction(step.rule);
        let (q_n, q_np1) = (step.q_n, step.q_np1);
        self.functions.evaluate(q_n, q_np1, 0.0, step.rule == ContactRule::EndPointMean, &mut e.start);
        self.functions.evaluate(q_n, q_np1, theta, true, &mut e.between);
        self.functions.evaluate(q_n, q_np1, 1.0, want_tangent || step.rule == ContactRule::EndPointMean, &mut e.end);
        e
    }

    fn coordinate_step(&self, rule: ContactRule, e: &Evaluations) -> Result<Option<CoordinateStep>, ContactError> {
        let Some(kind) = self.kind.coordinate().filter(|_| self.options.any()) else { return Ok(None) };
        let [start, between, end] = [&e.start, &e.between, &e.end].map(|e| self.invariants_of(e));
        let change = kind.change(start, end);
        if kind == CoordinateKind::Angle && change.abs() > LARGEST_TURN {
            return Err(ContactError::Joint {
                joint: self.name.clone(),
                reason: format!("it turns by {change:.2} rad, nearly half a turn, in one step; take smaller steps"),
            });
        }
        let mut weights = [[0.0; 2]; 3];
        let (second, moving, column) = match rule {
            ContactRule::EnergyMomentum => {
                let (w, second) = kind.discrete_gradient(start, end);
                weights[1] = w;
                (second, 1, 2)
            }
            ContactRule::EndPointMean => {
                weights[0] = kind.derivatives(start).0.map(|w| 0.5 * w);
                let (w, second) = kind.derivatives(end);
                weights[2] = w.map(|w| 0.5 * w);
                (second.map(|row| row.map(|s| 0.5 * s)), 2, 2)
            }
            _ => {
                let (w, second) = kind.derivatives(between);
                weights[1] = w;
                (second, 1, 1)
            }
        };
        let value_n = kind.principal(start) + std::f64::consts::TAU * self.history.turns as f64;
        Ok(Some(CoordinateStep { value_n, change, weights, second, moving, column, slope: kind.derivatives(end).0 }))
    }

    /// Torque that resists the coordinate, without the parts of multipliers.
    fn torque(&self, theta: f64, c: &CoordinateStep) -> Torque {
        let mut torque = Torque::default();
        if let Some(spring) = self.options.spring {
            torque.value += spring.stiffness * (c.value_n + theta * c.change - spring.rest);
            torque.by_coordinate += theta * spring.stiffness;
        }
        if self.is_damped() {
            torque.value += self.options.viscous * c.change / self.step.dt;
            torque.by_coordinate += self.options.viscous / self.step.dt;
        }
        if self.step.dt == 0.0 && self.slots.pretension.is_some() && self.step.locked.is_none() {
            // The multiplier is not known yet where accelerations of the start are made.
            torque.value += self.given_pretension(1.0);
        }
        torque
    }

    pub(super) fn is_damped(&self) -> bool {
        self.options.viscous > 0.0 && self.step.has_rates && self.step.dt > 0.0
    }

    /// Whole torque with the parts of multipliers (friction, motor, pretension, limit) as it acts along the gradient, thus `-T`, and the weights of the invariants; for output.
    pub(super) fn torque_and_weights(
        &self,
        q_n: &[f64],
        q_np1: &[f64],
        rule: ContactRule,
        multipliers: &[f64],
    ) -> Option<(f64, [f64; 2])> {
        let e = self.evaluations(StepConfiguration { q_n, q_np1, rule }, true);
        let c = self.coordinate_step(rule, &e).ok().flatten()?;
        let mut torque = self.torque(gradient_fraction(rule), &c).value;
        for (slot, sign) in self.signs() {
            torque += sign * self.scale() * multipliers[slot];
        }
        let sum = [0, 1].map(|k| c.weights.iter().map(|w| w[k]).sum::<f64>());
        Some((-torque, sum))
    }

    /// Slots on the coordinate, and the sign of their multipliers in the torque that resists it.
    fn signs(&self) -> impl Iterator<Item = (usize, f64)> {
        let s = self.slots;
        [(s.friction, 1.0), (s.motor, -1.0), (s.pretension, 1.0), (s.limit, 1.0)]
            .into_iter()
            .filter_map(|(slot, sign)| Some((slot?, sign)))
    }

    fn friction_row(&self, c: &CoordinateStep, multipliers: &[f64], slot: usize) -> Row {
        let (friction, scale) = (self.options.friction.unwrap_or_default(), self.scale());
        let by_reaction = self.friction_slope();
        let bound = friction.bound / scale + by_reaction * self.reaction(multipliers);
        let (own, slip) = (multipliers[slot], scale * c.change);
        let trial = own + self.step.complementarity * slip;
        let unit = self.step.friction_unit;
        let side = match self.closed_limit(c, multipliers) {
            // The limit stops the motion. Friction is against what is left of it, and rests if that is nothing.
            Some((_, rest)) if rest.abs() <= SMALLEST_SLIP * self.length => 0.0,
            Some((_, rest)) => rest.signum(),
            None => trial.signum(),
        };
        // Against its own direction nothing slides: after a slip the other way comes a stick first, else the iteration would go to and fro.
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
    pub(super) fn friction_slope(&self) -> f64 {
        let friction = self.options.friction.unwrap_or_default();
        match self.kind.coordinate() {
            Some(CoordinateKind::Angle) => friction.coefficient * friction.radius / self.scale(),
            _ => friction.coefficient,
        }
    }

    fn motor_row(&self, c: &CoordinateStep) -> Row {
        let target = self.options.motor.as_ref().map_or(0.0, |drive| drive.value(self.step.time_np1));
        let scale = self.scale();
        let value = -scale * (c.value_n + c.change - target);
        Row { value, by_coordinate: -scale, by_own: 0.0, by_reaction: 0.0, holds: true }
    }

    fn pretension_row(&self, theta: f64, c: &CoordinateStep, multipliers: &[f64], slot: usize) -> Row {
        let scale = self.scale();
        if let Some(locked) = self.step.locked {
            let value = scale * (c.value_n + c.change - locked);
            return Row { value, by_coordinate: scale, by_own: 0.0, by_reaction: 0.0, holds: true };
        }
        let unit = self.step.pretension_unit;
        let value = (self.given_pretension(theta) / scale - multipliers[slot]) / unit;
        Row { value, by_coordinate: 0.0, by_own: -1.0 / unit, by_reaction: 0.0, holds: false }
    }

    /// The force of a pretension that is not locked, at the time of the rule.
    fn given_pretension(&self, theta: f64) -> f64 {
        let time = self.step.time_n + theta * (self.step.time_np1 - self.step.time_n);
        self.options.pretension.as_ref().map_or(0.0, |pretension| pretension.force.value(time))
    }

    /// If a limit is closed: how far the coordinate is beyond it, and how far it may go in the step; lengths.
    fn closed_limit(&self, c: &CoordinateStep, multipliers: &[f64]) -> Option<(f64, f64)> {
        let (own, factor, scale) = (multipliers[self.slots.limit?], self.step.stiffness, self.scale());
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

    fn limit_row(&self, c: &CoordinateStep, multipliers: &[f64], slot: usize) -> Row {
        let factor = self.step.stiffness;
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

    fn add_coordinate(
        &self,
        step: StepConfiguration<'_>,
        multipliers: &[f64],
        e: &Evaluations,
        want: bool,
        local: &mut LocalContribution,
    ) -> Result<(), ContactError> {
        let Some(c) = self.coordinate_step(step.rule, e)? else { return Ok(()) };
        let theta = gradient_fraction(step.rule);
        let (n, dim, first, scale) = (3 * local.nodes.len(), local.dim(), self.kind.equations(), self.scale());
        let count = self.functions.len() - first;
        let all = [&e.start, &e.between, &e.end];
        let mut gradient = vec![0.0; n];
        for (at, weights) in all.iter().zip(c.weights) {
            for (k, w) in weights.iter().enumerate().take(count).filter(|(_, w)| **w != 0.0) {
                let row = &at.gradients[(first + k) * n..(first + k + 1) * n];
                gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
            }
        }
        let mut torque = self.torque(theta, &c);
        let place = |local: &LocalContribution, slot: usize| local.slots.iter().position(|&s| s as usize == slot);
        for (slot, sign) in self.signs() {
            if place(local, slot).is_some() {
                torque.value += sign * scale * multipliers[slot];
            }
        }
        for (r, g) in local.residual.iter_mut().zip(&gradient) {
            *r += torque.value * g;
        }
        let mut slope = vec![0.0; if want { n } else { 0 }];
        for (k, weight) in c.slope.iter().enumerate().take(if want { count } else { 0 }) {
            let row = &e.end.gradients[(first + k) * n..(first + k + 1) * n];
            slope.iter_mut().zip(row).for_each(|(s, r)| *s += weight * r);
        }
        let s = self.slots;
        for (slot, sign) in self.signs() {
            let Some(k) = place(local, slot) else { continue };
            let row = if Some(slot) == s.friction {
                self.friction_row(&c, multipliers, slot)
            } else if Some(slot) == s.motor {
                self.motor_row(&c)
            } else if Some(slot) == s.pretension {
                self.pretension_row(theta, &c, multipliers, slot)
            } else {
                self.limit_row(&c, multipliers, slot)
            };
            let at = n + k;
            local.residual[at] = row.value;
            if !want {
                continue;
            }
            for i in 0..n {
                local.tangent[i * dim + at] += sign * scale * gradient[i];
                local.tangent[at * dim + i] += row.by_coordinate * slope[i];
            }
            local.tangent[at * dim + at] += row.by_own;
            let reaction = self.reaction(multipliers);
            if row.by_reaction != 0.0 && reaction > 0.0 {
                for slot in 0..self.kind.point_equations() {
                    if let Some(j) = place(local, slot) {
                        local.tangent[at * dim + n + j] += row.by_reaction * multipliers[slot] / reaction;
                    }
                }
            }
            if row.holds {
                self.compliance.add(at, multipliers[slot], want, local);
            }
        }
        if want {
            self.add_coordinate_tangent(theta, &c, all, &torque, &gradient, &slope, local);
        }
        Ok(())
    }

    /// `T dg/dq_np1 + g (x) dT/dq_np1`.
    #[expect(clippy::too_many_arguments, reason = "all of them belong to one evaluation of the coordinate")]
    fn add_coordinate_tangent(
        &self,
        theta: f64,
        c: &CoordinateStep,
        all: [&Evaluation; 3],
        torque: &Torque,
        gradient: &[f64],
        slope: &[f64],
        local: &mut LocalContribution,
    ) {
        let (n, dim, first) = (3 * local.nodes.len(), local.dim(), self.kind.equations());
        let count = self.functions.len() - first;
        for (weights, fraction) in c.weights.iter().zip([0.0, theta, 1.0]) {
            for (k, w) in weights.iter().enumerate().take(count) {
                let factor = torque.value * w * fraction;
                self.functions.add_second_derivatives(first + k, factor, dim, &mut local.tangent);
            }
        }
        let row = |e: &Evaluation, k: usize, i: usize| e.gradients[(first + k) * n + i];
        let (columns, factor) = (all[c.column], if c.column == 2 { 1.0 } else { theta });
        for i in 0..n {
            let mut product = [0.0; 2];
            for (l, p) in product.iter_mut().enumerate().take(count) {
                *p = (0..count).map(|k| c.second[k][l] * row(all[c.moving], k, i)).sum::<f64>() * torque.value * factor;
            }
            for j in 0..n {
                let mut entry = torque.by_coordinate * gradient[i] * slope[j];
                for (l, p) in product.iter().enumerate().take(count) {
                    entry += p * row(columns, l, j);
                }
                local.tangent[i * dim + j] += entry;
            }
        }
    }
}

impl Report for Joint {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn conserves_linear_momentum(&self) -> bool {
        !self.grounded
    }

    fn conserves_angular_momentum(&self) -> bool {
        !self.grounded
    }

    fn joint(&self, q: &[f64], multipliers: &[f64]) -> Option<JointReport> {
        let torques = self.torques(q, multipliers);
        // Of a step from `q` to `q`, which knows no rate.
        let (force, moment) = self.force_with(q, q, ContactRule::EndPoint, multipliers, torques.viscous);
        let coordinate = self.coordinate(q);
        let is_angle = self.kind.coordinate() == Some(CoordinateKind::Angle);
        let arm = self.forms[super::kinds::ARM].at(q);
        Some(JointReport { force, moment, arm, coordinate, is_angle, torques })
    }

    fn report(&self, _q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        Ok(Vec::new())
    }
}

impl Constraint for Joint {
    fn slot_count(&self) -> usize {
        self.slots.count
    }

    fn slot_weight(&self, _slot: usize) -> f64 {
        1.0
    }

    fn is_symmetric(&self, rule: ContactRule) -> bool {
        let given = self.slots.pretension.is_some() && self.step.locked.is_none();
        rule == ContactRule::EndPoint && self.slots.friction.is_none() && self.slots.limit.is_none() && !given
    }

    fn set_rule(&mut self, _rule: ContactRule, step_size: f64) {
        self.step.dt = step_size;
    }

    fn set_times(&mut self, time_n: f64, time_np1: f64) {
        (self.step.time_n, self.step.time_np1) = (time_n, time_np1);
    }

    fn set_has_rates(&mut self, has_rates: bool) {
        self.step.has_rates = has_rates;
    }

    fn begin_step(&mut self, q_n: &[f64], _reach: f64) -> Result<(), ContactError> {
        self.begin(q_n);
        Ok(())
    }

    fn renew(
        &mut self,
        _q_np1: &[f64],
        _pressures: &[f64],
        _auxiliaries: &[f64],
        _active: &[bool],
        want_tangent: bool,
    ) -> Result<bool, ContactError> {
        self.compliance.renew(want_tangent);
        Ok(false)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let slots: Vec<u32> = (0..self.slots.count as u32).filter(|&slot| active[slot as usize]).collect();
        if !slots.is_empty() {
            visit(self.functions.vectors(), &slots);
        }
    }

    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        multipliers: &[f64],
        active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        let mut local = LocalContribution::default();
        local.slots.extend((0..self.slots.count as u32).filter(|&slot| active[slot as usize]));
        if local.slots.is_empty() {
            return Ok(());
        }
        local.nodes.extend_from_slice(self.functions.vectors());
        local.reset(want_tangent);
        let e = self.evaluations(step, want_tangent);
        let theta = gradient_fraction(step.rule);
        let rows = Rows { functions: &self.functions, first: 0, count: self.kind.equations(), theta };
        rows.add([&e.between, &e.end], multipliers, &self.compliance, want_tangent, &mut local);
        self.add_coordinate(step, multipliers, &e, want_tangent, &mut local)?;
        visit(&local);
        Ok(())
    }
}
