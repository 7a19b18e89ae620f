//! Force, tangent and constraint rows of a joint.
//!
//! `R = -sum lambda_k grad phi_k + T g`, where `g` is a gradient of the coordinate under the rule and `T` all torques that resist it. Rows in the order of the slots:
//! `-phi_k`; friction `xi` in stick (`|t + c xi| <= B`, or `t` against `xi`) and else `(+-B - t) / f`, with a closed limit always; motor `-(gamma - target)`; pretension `(P - p) / f` with the given force `P`, and `gamma - gamma_lock` once it is locked; limits `(max(0, p + c (xi - hi)) + min(0, p + c (xi - lo)) - p) / c`,
//! with lengths `xi` for the coordinate.

use super::coordinate_forces::{Coordinate, CoordinateStep, Torque};
use super::{CoordinateKind, Joint, StepState};
use crate::constraint::{Rows, gradient_fraction};
use crate::quadratic::Evaluation;
use stoss_term::{
    At, Bilateral, Fault, GradientRule, JointCoordinate, JointReport, Local, Rule, SlotKind, StepConfiguration,
    StepContext, Term, Undefined, Work,
};

/// Functions at the three configurations of a step.
#[derive(Debug, Default)]
struct Evaluations {
    start: Evaluation,
    between: Evaluation,
    end: Evaluation,
}

impl Evaluations {
    fn values(&self) -> [&[f64]; 3] {
        [&self.start.values, &self.between.values, &self.end.values]
    }
}

impl Joint {
    fn evaluations(&self, step: StepConfiguration<'_>, want_tangent: bool) -> Evaluations {
        let mut e = Evaluations::default();
        let theta = gradient_fraction(step.rule);
        let (q_n, q_np1) = (step.q_n, step.q_np1);
        self.functions.evaluate(q_n, q_np1, 0.0, step.rule == GradientRule::EndPointMean, &mut e.start);
        self.functions.evaluate(q_n, q_np1, theta, true, &mut e.between);
        self.functions.evaluate(q_n, q_np1, 1.0, want_tangent || step.rule == GradientRule::EndPointMean, &mut e.end);
        e
    }

    /// Whole torques on the coordinates with the parts of multipliers (friction, motor, pretension, limit) and `further` ones, as they act along the gradients, thus `-T`,
    /// times the weights of the invariants: a weight for each function behind the equations; for output.
    pub(super) fn torque_weights(
        &self,
        q_n: &[f64],
        q_np1: &[f64],
        rule: GradientRule,
        multipliers: &[f64],
        further: &[f64],
    ) -> Vec<f64> {
        let e = self.evaluations(StepConfiguration { q_n, q_np1, rule }, true);
        let mut all = vec![0.0; self.list.len() - self.kind.equations()];
        for (n, coordinate) in self.coordinates.iter().enumerate() {
            let Some(c) = coordinate.in_step(&self.name, rule, e.values()).ok().flatten() else { continue };
            let mut torque = coordinate.torque(&self.step, gradient_fraction(rule), &c).value;
            for (slot, sign) in coordinate.signs() {
                torque += sign * coordinate.scale() * multipliers[slot];
            }
            for k in 0..coordinate.count {
                let weight = c.weights.iter().map(|w| w[k]).sum::<f64>();
                all[coordinate.first - self.kind.equations() + k] = (further.get(n).unwrap_or(&0.0) - torque) * weight;
            }
        }
        all
    }

    fn add_coordinate(
        &self,
        coordinate: &Coordinate,
        step: StepConfiguration<'_>,
        multipliers: &[f64],
        e: &Evaluations,
        want: bool,
        local: &mut Local,
    ) -> Result<(), Undefined> {
        let Some(c) = coordinate.in_step(&self.name, step.rule, e.values())? else { return Ok(()) };
        let theta = gradient_fraction(step.rule);
        let (n, dim, scale) = (3 * local.nodes.len(), local.dim(), coordinate.scale());
        let (first, count) = (coordinate.first, coordinate.count);
        let reaction = self.reaction(multipliers);
        let all = [&e.start, &e.between, &e.end];
        let mut gradient = vec![0.0; n];
        for (at, weights) in all.iter().zip(c.weights) {
            for (k, w) in weights.iter().enumerate().take(count).filter(|(_, w)| **w != 0.0) {
                let row = &at.gradients[(first + k) * n..(first + k + 1) * n];
                gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
            }
        }
        let mut torque = coordinate.torque(&self.step, theta, &c);
        let place = |local: &Local, slot: usize| local.slots.iter().position(|&s| s as usize == slot);
        for (slot, sign) in coordinate.signs() {
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
        let s = coordinate.slots;
        for (slot, sign) in coordinate.signs() {
            let Some(k) = place(local, slot) else { continue };
            let row = if Some(slot) == s.friction {
                coordinate.friction_row(&c, reaction, multipliers, slot)
            } else if Some(slot) == s.motor {
                coordinate.motor_row(&self.step, &c)
            } else if Some(slot) == s.pretension {
                coordinate.pretension_row(&self.step, theta, &c, multipliers, slot)
            } else {
                coordinate.limit_row(&c, multipliers, slot)
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
            self.add_coordinate_tangent(coordinate, theta, &c, all, &torque, &gradient, &slope, local);
        }
        Ok(())
    }

    /// `T dg/dq_np1 + g (x) dT/dq_np1`.
    #[expect(clippy::too_many_arguments, reason = "all of them belong to one evaluation of the coordinate")]
    fn add_coordinate_tangent(
        &self,
        coordinate: &Coordinate,
        theta: f64,
        c: &CoordinateStep,
        all: [&Evaluation; 3],
        torque: &Torque,
        gradient: &[f64],
        slope: &[f64],
        local: &mut Local,
    ) {
        let (n, dim) = (3 * local.nodes.len(), local.dim());
        let (first, count) = (coordinate.first, coordinate.count);
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

impl Term for Joint {
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

    fn slot_count(&self) -> usize {
        self.slots
    }

    fn slot_weight(&self, _slot: usize) -> f64 {
        1.0
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        let one_sided = |c: &Coordinate| {
            let given = c.slots.pretension.is_some() && c.state.locked.is_none();
            c.slots.friction.is_some() || c.slots.limit.is_some() || given
        };
        rule == Rule::Constraint(GradientRule::EndPoint) && !self.coordinates.iter().any(one_sided)
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        let StepContext { q_n, time, end, dt, rates, .. } = *step;
        // Where time stands still nothing is viscous.
        self.step = StepState { dt, time_n: time, time_np1: end, has_rates: rates && end > time };
        self.begin_at(q_n);
        Ok(())
    }

    fn renew(&mut self, _at: &At<'_>, want_tangent: bool) -> Result<bool, Fault> {
        self.compliance.renew(want_tangent);
        Ok(false)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let slots: Vec<u32> = (0..self.slots as u32).filter(|&slot| active[slot as usize]).collect();
        if !slots.is_empty() {
            visit(self.functions.vectors(), &slots);
        }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers, active, .. } = *at;
        let mut local = Local::default();
        local.slots.extend((0..self.slots as u32).filter(|&slot| active[slot as usize]));
        if local.slots.is_empty() {
            return Ok(());
        }
        local.nodes.extend_from_slice(self.functions.vectors());
        local.reset(want_tangent);
        let e = self.evaluations(step, want_tangent);
        let theta = gradient_fraction(step.rule);
        let rows = Rows { functions: &self.functions, first: 0, count: self.kind.equations(), theta };
        rows.add([&e.between, &e.end], multipliers, &self.compliance, want_tangent, &mut local);
        for coordinate in &self.coordinates {
            self.add_coordinate(coordinate, step, multipliers, &e, want_tangent, &mut local)?;
        }
        visit(&local);
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        Ok(self.spring_energy(q))
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        Ok(self.step_work(at.q_np1, at.multipliers, at.active))
    }

    fn commit(&mut self, at: &At<'_>) {
        self.end_step(at.q_np1, at.multipliers, at.active);
    }

    fn save_history(&self) -> Vec<u8> {
        self.history()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.set_history(bytes)
    }

    fn bilateral(&self) -> Option<&dyn Bilateral> {
        Some(self)
    }
}

impl Bilateral for Joint {
    fn slot_kind(&self, slot: usize) -> SlotKind {
        let is = |of: Option<usize>| of == Some(slot);
        let of = |c: &Coordinate| {
            let s = c.slots;
            match () {
                () if is(s.limit) => Some(SlotKind::Limit),
                () if is(s.motor) => Some(SlotKind::Driven),
                () if is(s.pretension) && c.state.locked.is_some() => Some(SlotKind::Equation),
                () if is(s.friction) || is(s.pretension) => Some(SlotKind::Force),
                () => None,
            }
        };
        self.coordinates.iter().find_map(of).unwrap_or(SlotKind::Equation)
    }

    fn has_limits(&self) -> bool {
        self.coordinates.iter().any(|c| c.slots.limit.is_some())
    }

    fn verify_inactive(&self, q_np1: &[f64], active: &[bool]) -> Result<(), Fault> {
        if active.iter().all(|&active| active) {
            return Ok(());
        }
        let values = self.evaluate(q_np1).values;
        let equations = (0..self.kind.equations()).filter(|&slot| !active[slot]).map(|slot| values[slot].abs());
        let motors = self.coordinates.iter().filter_map(|c| {
            let motor = c.options.motor.as_ref().filter(|_| c.slots.motor.is_some_and(|slot| !active[slot]))?;
            Some(c.scale() * (c.end_of_step(&values).0 - motor.value(self.step.time_np1)).abs())
        });
        let missed = equations.chain(motors).fold(0.0, f64::max);
        if missed <= super::TOLERANCE * self.length {
            return Ok(());
        }
        let reason = format!(
            "the prescribed motion contradicts the joint, which is {missed:.2e} from its admissible position; remove one of them, or prescribe a motion that the joint allows"
        );
        Err(Fault::other(Undefined { term: format!("joint {}", self.name), reason }))
    }

    fn joint(&self, q: &[f64], multipliers: &[f64]) -> Option<JointReport> {
        let values = self.evaluate(q).values;
        let report = |c: &Coordinate| {
            let value = c.value(&values);
            JointCoordinate { value, is_angle: c.kind == CoordinateKind::Angle, torques: c.torques(value, multipliers) }
        };
        let coordinates: Vec<JointCoordinate> = self.coordinates.iter().map(report).collect();
        // Of a step from `q` to `q`, which knows no rate.
        let viscous: Vec<f64> = coordinates.iter().map(|c| c.torques.viscous).collect();
        let (force, moment) = self.force_with(q, q, GradientRule::EndPoint, multipliers, &viscous);
        let arm = self.forms[super::kinds::ARM].at(q);
        Some(JointReport { force, moment, arm, coordinates })
    }
}
