//! One step of a simulation: attempts, acceptance, work.

use super::books::Draft;
use super::impact::Impact;
use super::{InsideOutRule, Simulation};
use crate::anchored::attempt_anchored;
use crate::assembly::{System, Tally, no_auxiliaries};
use crate::failure::{AttemptLog, FailedAttempt};
use crate::iterate::Iterate;
use crate::rows::Rows;
use crate::smooth::attempt_smoothed;
use crate::step::{Attempt, StepInput, attempt, decision};
use crate::system::FeSystem;
use crate::terms::Line;
use crate::{
    Automatic, Balance, ContactSummary, Coupling, DecisionKind, Phase, PhaseTime, SimulationError, StepChange,
    StepError, StepRecord,
};
use std::ops::Range;
use stoss_fe_solid::InsideOut;
use stoss_integrators::{ForceRule, State, Step, StepConfiguration, StepRule, finish};
use stoss_linalg::vector;
use stoss_term::{At, Coverage, Step as ContactStep, Work};

/// A quasi-static step is started by extrapolating the last one if that moves prescribed components to where they have to be, up to this
/// fraction of their motion.
const EXTRAPOLATION_FITS: f64 = 0.1;

/// End of the message of a step whose size does not matter.
const AT_ANY_SIZE: &str =
    "; the matrix at the start of the step is singular whatever the step size, so that smaller steps were not tried";

/// From where the iterations start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// The scheme's predictor; in statics the last increment once more.
    Extrapolation,
    /// The last positions, and the linear response to the motion of prescribed components.
    Linear,
    /// The last positions.
    Last,
}

/// How a step is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// By Newton's method with a set of closed slots.
    Plain,
    /// The same from where springs have led it.
    Anchored,
    /// The same with compliant rows and slips of little weight.
    Careful,
    /// Along smoothed complementarity.
    Smoothed,
}

/// An attempt that succeeded, with what could still have failed.
pub(super) struct Completed {
    attempt: Attempt,
    next: State,
    rule: StepRule,
    draft: Draft,
    contact: Option<ContactSummary>,
    work: Work,
    /// For each contact pair.
    stored: Vec<[f64; 2]>,
    /// What closing gaps cost in the step, for each constraint; empty in statics.
    closing: Vec<f64>,
    /// What the impact of what closed did to the velocities.
    impact: Option<Impact>,
    /// For each body.
    inside_out: Vec<Option<InsideOut>>,
    /// Linear solutions of the attempt.
    solves: u32,
}

impl Completed {
    /// Whether the energy falls in some direction at the end of the step.
    pub(super) fn is_unstable(&self) -> bool {
        self.attempt.unstable > 0
    }
}

impl Simulation {
    fn kinetic(&self, v: &[f64]) -> f64 {
        self.system.inertia.masses.kinetic_energy(v)
    }

    /// Does one step: tries the present step size and halves it as often as the settings allow.
    ///
    /// # Errors
    /// [`SimulationError::StepFailed`]; state, balance and records are then those of the last completed step.
    pub fn advance(&mut self) -> Result<StepRecord, SimulationError> {
        let mut timer = PhaseTime::default();
        let record = timer.measure(|| self.advance_untimed());
        self.log.timings.total.add(timer);
        record
    }

    fn advance_untimed(&mut self) -> Result<StepRecord, SimulationError> {
        // Those between the steps belong to the step that follows.
        let first_decision = self.log.decisions.partition_point(|decision| decision.step <= self.step);
        self.failures.clear();
        loop {
            match self.try_step() {
                Ok(completed) => return Ok(self.accept(completed, first_decision)),
                Err(cause) => {
                    let (time, dt) = (self.state.time, self.clock.dt());
                    let at_any_size = self.failures.last().is_some_and(|failure| failure.at_any_size);
                    if !at_any_size && self.ramps_overlaps(&cause) {
                        continue;
                    }
                    if at_any_size || !self.clock.cut() {
                        let hint = if at_any_size { AT_ANY_SIZE.to_owned() } else { self.undivided(&cause) };
                        return Err(SimulationError::StepFailed {
                            step: self.step + 1,
                            time,
                            dt,
                            were_smaller: self.failures.iter().any(|failure| failure.dt > dt),
                            cause: Box::new(cause),
                            hint,
                        });
                    }
                    self.log.decisions.push(decision(self.step + 1, time, dt, DecisionKind::Cut, cause.to_string()));
                }
            }
        }
    }

    fn try_step(&mut self) -> Result<Completed, StepError> {
        let dt = self.clock.dt();
        let time = self.state.time;
        let rule = self.step_rule(dt);
        self.set_dead_loads(time + rule.force.rule.load_fraction() * dt);
        self.system.set_ramp(self.ramp(self.clock.next_time()));
        let (start, other) = self.starts(dt);
        match self.try_from(start, dt, rule) {
            Err(cause) if other.is_some() && self.may_start_elsewhere(start, &cause) => {
                let reason = format!("from the predictor: {cause}");
                self.log.decisions.push(decision(self.step + 1, time, dt, DecisionKind::Restart, reason));
                match self.try_from(other.unwrap_or(start), dt, rule) {
                    Err(cause) => self.try_carefully([start, other.unwrap_or(start)], dt, rule, cause),
                    result => result,
                }
            }
            Err(cause) => self.try_carefully([start, start], dt, rule, cause),
            result => result,
        }
    }

    /// Whether a step that failed from `start` may well succeed from elsewhere. In statics the last increment may lead far from the solution where
    /// surfaces slide from one facet to the next; a shorter step costs more than another start.
    fn may_start_elsewhere(&self, start: Start, cause: &StepError) -> bool {
        match cause {
            StepError::Term(fault) => fault.is_undefined(),
            StepError::Singular { .. } => start == Start::Linear,
            StepError::NotConverged { .. } | StepError::Cycling { .. } | StepError::ActiveSet { .. } => {
                self.how.scheme.is_none() && start == Start::Extrapolation
            }
            _ => false,
        }
    }

    /// Begins a step of all terms that act: what they keep of the last positions, search and projection there.
    pub(super) fn begin_terms(&mut self, dt: f64, rule: StepRule, careful: bool) -> Result<(), StepError> {
        // The farthest that two surfaces can approach each other in the step if nothing accelerates them much.
        let speed = self.model.embedding.largest_of(&self.system.own, &self.state.v);
        let state = &self.state;
        let step = ContactStep {
            q_n: &state.q,
            v_n: &state.v,
            time: state.time,
            end: self.clock.next_time(),
            dt,
            rule: rule.constraint.rule,
            force: rule.force.rule,
            rates: rule.has_inertia(),
            careful,
            impacts: Self::has_impacts(&rule),
            reach: 2.0 * speed * dt,
            support: &self.stage.support,
        };
        for (line, _, term) in self.model.terms_mut(&self.system.present.acting).filter(|(_, acts, _)| *acts) {
            let phase = if line == Line::Force { Phase::Assembly } else { Phase::Search };
            let reach = step.reach + 0.5 * term.length_scale();
            self.log.timings.measure(phase, || term.begin(&ContactStep { reach, ..step }))?;
        }
        Ok(())
    }

    /// How to start, and how to start if an element is inverted there.
    fn starts(&self, dt: f64) -> (Start, Option<Start>) {
        let moves = vector::norm_inf(&self.state.v) * dt > 0.0;
        if self.how.scheme.is_some() {
            return (Start::Extrapolation, moves.then_some(Start::Last));
        }
        let end = self.clock.next_time();
        let (mut moved, mut missed) = (0.0_f64, 0.0_f64);
        for k in 0..self.stage.prescribed.len() {
            let (component, position) = self.prescribed_position(k, end);
            let motion = position - self.state.q[component];
            moved = moved.max(motion.abs());
            missed = missed.max((motion - dt * self.state.v[component]).abs());
        }
        let plain = if moved > 0.0 { Start::Linear } else { Start::Last };
        if missed <= EXTRAPOLATION_FITS * moved {
            (Start::Extrapolation, moves.then_some(plain))
        } else {
            (plain, (plain == Start::Linear).then_some(Start::Last))
        }
    }

    fn try_from(&mut self, from: Start, dt: f64, rule: StepRule) -> Result<Completed, StepError> {
        self.try_by(Way::Plain, from, dt, rule)
    }

    pub(super) fn try_by(&mut self, way: Way, from: Start, dt: f64, rule: StepRule) -> Result<Completed, StepError> {
        let mut trace = AttemptLog::default();
        let result = self.traced(way, from, dt, rule, &mut trace);
        self.log.solves += u64::from(trace.solves);
        if let Err(cause) = &result {
            // Without inertia and stabilisation the step size is in no term of this matrix; it is in a start that goes on as the last step ended.
            let goes_on = from == Start::Extrapolation && vector::norm_inf(&self.state.v) > 0.0;
            let at_any_size = self.how.scheme.is_none()
                && self.system.present.stabilisation.is_none()
                && !goes_on
                && trace.first_was_singular(cause);
            let failed = trace.failed(&self.model, (self.step + 1, self.state.time, dt), cause);
            self.failures.push(FailedAttempt { at_any_size, ..failed });
        }
        result
    }

    fn traced(
        &mut self,
        way: Way,
        from: Start,
        dt: f64,
        rule: StepRule,
        trace: &mut AttemptLog,
    ) -> Result<Completed, StepError> {
        // Also after an attempt from elsewhere, which has changed pairings.
        let is_careful = matches!(way, Way::Careful | Way::Smoothed);
        self.begin_terms(dt, rule, is_careful)?;
        self.system.rows = if is_careful { Rows::compliant() } else { Rows::default() };
        self.system.present.anchor = None;
        let (q_n, increment) = (&self.state.q, vec![0.0; self.state.q.len()]);
        let embedding = &self.model.embedding;
        let mut start = Iterate {
            q: q_n.clone(),
            followed: [embedding.followed(q_n), embedding.followed(&increment)],
            increment,
            pressures: self.slots.pressures.clone(),
            auxiliaries: no_auxiliaries(&self.model),
            active: self.slots.active.clone(),
        };
        if from == Start::Extrapolation {
            match &self.how.scheme {
                Some(scheme) => scheme.predict(&self.state, dt, &mut start.increment),
                None => vector::axpy(dt, &self.state.v, &mut start.increment),
            }
            for own in &self.system.own {
                vector::axpy(1.0, &start.increment[own.clone()], &mut start.q[own.clone()]);
            }
        }
        let end = self.clock.next_time();
        let prescribed: Vec<(usize, f64)> =
            (0..self.stage.prescribed.len()).map(|k| self.prescribed_position(k, end)).collect();
        let predict = from == Start::Linear;
        if !predict {
            for &(component, position) in &prescribed {
                start.place(component, position, q_n);
            }
        }
        start.follow(&self.model.embedding);
        let input = StepInput {
            step: Step { state_n: &self.state, dt, rule },
            start,
            prescribed,
            predict,
            newton: self.how.newton,
        };
        let (model, system, timings) = (&mut self.model, &mut self.system, &mut self.log.timings);
        let mut attempt = match way {
            Way::Plain | Way::Careful => attempt(model, system, input, timings, trace)?,
            Way::Anchored => attempt_anchored(model, system, input, timings, trace)?,
            Way::Smoothed => attempt_smoothed(model, system, input, timings, trace)?,
        };
        let solves = trace.solves;
        // Whatever can still fail is done before anything of the state is changed: at the end of a midpoint step, for
        // instance, an element may be inverted although it is not at the midpoint.
        let inside_out = self.inside_out(&attempt.iterate.q)?;
        if self.how.inside_out == InsideOutRule::Refuse
            && let Some(error) = self.newly_inside_out(&inside_out).next()
        {
            return Err(error);
        }
        let mut coverage = Coverage::default();
        for (_, pair) in self.model.couplings() {
            coverage.defect = coverage.defect.max(pair.term.verify(&attempt.iterate.q)?.defect);
        }
        for (pair, active) in self.model.contacts.iter().zip(&attempt.iterate.active) {
            if let Some(of) = pair.bilateral() {
                of.verify_inactive(&attempt.iterate.q, active)?;
            }
        }
        let (work, of_pairs) = self.contact_work(&attempt.iterate, rule, dt)?;
        let draft = self.draft(&attempt.iterate, &of_pairs, &rule, dt)?;
        let (contact, slaves) = self.contact_summary(&attempt, rule, dt, &of_pairs)?.unzip();
        let mut contact = contact.map(|c| ContactSummary { coverage, ..c });
        let stored = of_pairs.iter().map(|work| [work.stored, work.friction_stored]).collect();
        let mut closing: Vec<f64> = match rule.has_inertia() {
            true => of_pairs.iter().map(|work| work.closing.unwrap_or(0.0)).collect(),
            false => Vec::new(),
        };
        let mut next = self.next_state(&mut attempt.iterate, dt, rule)?;
        let impact = self.impact(&attempt.iterate, &of_pairs, &rule, dt, &mut next)?;
        if let Some(impact) = &impact {
            closing.iter_mut().zip(&impact.closings).for_each(|(closing, taken)| *closing -= taken);
            if let (Some(contact), Some(slaves)) = (&mut contact, &slaves) {
                contact.pairs.iter_mut().zip(&impact.friction).for_each(|(pair, work)| pair.friction_work += work);
                self.add_impulses(&impact.mean, slaves, &attempt.iterate.active, &next.q, contact);
            }
        }
        Ok(Completed { attempt, next, rule, draft, contact, work, stored, closing, impact, inside_out, solves })
    }

    pub(super) fn inside_out(&self, q: &[f64]) -> Result<Vec<Option<InsideOut>>, StepError> {
        Ok(self.model.bodies.iter().map(|body| body.solid.inside_out(q)).collect::<Result<_, _>>()?)
    }

    /// Part of the stabilisation that acts at a time of the stage.
    fn ramp(&self, time: f64) -> f64 {
        1.0 - self.clock.part_done(time)
    }

    /// Velocities and whatever else the scheme carries, at the end of a converged step, with the positions of the iterate, which are moved.
    fn next_state(&mut self, iterate: &mut Iterate, dt: f64, rule: StepRule) -> Result<State, StepError> {
        let v = self.state.v.clone();
        let mut next = State { q: std::mem::take(&mut iterate.q), v, ..State::default() };
        let mut followed = self.model.embedding.followed(&next.v);
        let end = self.clock.next_time();
        self.set_prescribed_velocities(end, &mut next.v);
        let Self { model, system, state, .. } = self;
        let mut buffers = std::mem::take(&mut system.buffers);
        let Iterate { pressures, auxiliaries, active, .. } = &*iterate;
        let mut fe = FeSystem { model, system, pressures, auxiliaries, active };
        let step = Step { state_n: state, dt, rule };
        let result = finish(&mut fe, &step, &iterate.increment, &mut buffers, &mut next);
        if let Ok(true) = result {
            vector::axpy(1.0, &buffers.inertia, &mut buffers.residual);
        }
        self.system.buffers = buffers;
        result?;
        // Nodes without mass have no velocity in the equations: that of the step is the mean one.
        for node in self.model.bodies.iter().filter_map(|body| body.massless.as_ref()).flat_map(|of| of.nodes()) {
            let own = 3 * node as usize..3 * node as usize + 3;
            next.v[own.clone()].iter_mut().zip(&iterate.increment[own]).for_each(|(v, moved)| *v = moved / dt);
        }
        let embedding = &self.model.embedding;
        embedding.follow_changes(&mut next.v, &mut followed);
        embedding.follow(&mut next.a);
        if rule.history.is_some_and(|history| history.constraint) && !next.history.is_empty() {
            let (touched, constraint) = (&self.system.tally.touched, &self.system.buffers.constraint);
            for c in touched.iter().flat_map(|&node| 3 * node as usize..3 * node as usize + 3) {
                next.history[c] = -constraint[c];
            }
            embedding.pull_back_of(touched, &mut next.history);
        }
        // The clock's ticks, not the sum of steps.
        next.time = end;
        Ok(next)
    }

    fn accept(&mut self, completed: Completed, first_decision: usize) -> StepRecord {
        self.warn_inside_out(&completed.inside_out);
        self.warn_dependent();
        let Completed { attempt, next, rule, draft, mut contact, stored, closing, impact, inside_out, solves, .. } =
            completed;
        self.forces.moved = contact.as_mut().map(|contact| std::mem::take(&mut contact.moved)).unwrap_or_default();
        let contact_work = completed.work;
        let Attempt { iterate, newton, unstable, .. } = attempt;
        let dt = self.clock.dt();
        let (time_n, time) = (self.state.time, next.time);
        // Work of the step: loads that vary in time or follow, and reactions at moving supports; of the forces of the rule, or in
        // statics, where all forces are those of the end, by the trapezium rule.
        let mut varying = vec![0.0; self.state.q.len()];
        let quasi_static = self.how.scheme.is_none();
        if quasi_static {
            self.add_varying_loads(time_n, 0.5, &mut varying);
            self.add_reactions(0.5, &mut varying);
        }
        let mut of_supports = if quasi_static { 0.5 * self.reaction_work(&next.q) } else { 0.0 };
        let end_weight = if quasi_static { 0.5 } else { 1.0 };
        self.add_varying_loads(time_n + rule.force.rule.load_fraction() * dt, end_weight, &mut varying);
        if self.system.loads.has_followers {
            vector::axpy(end_weight, &self.system.loads.follower, &mut varying);
            if quasi_static {
                let (mut fe, state) = self.equations_of(&iterate.auxiliaries);
                let at_n = StepConfiguration { time: time_n, dt: 0.0, q_n: &state.q, q_np1: &state.q };
                // cannot fail: directors are orthogonal at the end of a step.
                fe.evaluate_follower(at_n, ForceRule::END_POINT, None).unwrap_or(());
                vector::axpy(0.5, &self.system.loads.follower, &mut varying);
            }
        }
        for &(component, ..) in &self.stage.prescribed {
            // The residual at a prescribed component is what the support has to exert.
            let c = component as usize;
            self.forces.reactions[c] = self.system.buffers.residual[c];
        }
        self.add_reactions(end_weight, &mut varying);
        of_supports += end_weight * self.reaction_work(&next.q);
        let mut work = 0.0;
        for c in self.system.loads.support.iter().flat_map(Range::clone) {
            work += varying[c] * (next.q[c] - self.state.q[c]);
        }
        // Nothing is judged by it in statics.
        let closes = |pair: &Coupling| pair.acts && !pair.always_holds();
        let has_contact = contact.is_some() && self.model.contacts.iter().any(closes);
        let work_of_contact = (!quasi_static && has_contact).then(|| -> f64 {
            let System { tally, buffers, .. } = &self.system;
            let components = tally.support.iter().flat_map(Range::clone);
            components.map(|c| buffers.constraint[c] * (next.q[c] - self.state.q[c])).sum()
        });
        let damped = draft.dissipated_by_parts();
        let (stabilised, stabilising) = if self.system.present.stabilisation.is_some() {
            let increment: Vec<f64> = next.q.iter().zip(&self.state.q).map(|(next, q)| next - q).collect();
            let force = self.system.stabilising(&increment, dt);
            let work = self.system.stabilised(self.ramp(time_n), &self.state.v, &increment, dt);
            (work, force.map(|force| [force, self.external_forces()]))
        } else {
            (0.0, None)
        };
        let damped_bodies = self.system.damped(dt) + draft.dissipated_in_bodies();
        let step = Step { state_n: &self.state, dt, rule };
        for (line, _, term) in self.model.terms_mut(&self.system.present.acting).filter(|(_, acts, _)| *acts) {
            term.commit(&At { q_np1: &next.q, ..iterate.at_line(line, &step) });
        }
        self.state = next;
        // Velocities from momenta lack the next impulse of the constraints, and get it in the next step.
        let has_supports = rule.impulse.is_none() && self.has_sliding_supports();
        let mut jump = 0.0;
        if self.how.scheme.is_some() && (!self.stage.prescribed.is_empty() || has_supports) {
            // Supports move with the slope of their tables; the jump of kinetic energy at a kink is work of the support.
            let before = self.kinetic(&self.state.v);
            let mut v = std::mem::take(&mut self.state.v);
            let mut followed = self.model.embedding.followed(&v);
            self.set_prescribed_velocities(time, &mut v);
            if has_supports {
                self.meet_held_directions(time, |held| held.rate, &mut v);
            }
            self.model.embedding.follow_changes(&mut v, &mut followed);
            self.state.v = v;
            jump = self.kinetic(&self.state.v) - before;
            work += jump;
        }
        if !self.model.contacts.is_empty() {
            let System { tally: Tally { support, touched, .. }, buffers, .. } = &self.system;
            for node in self.forces.pushed.drain(..) {
                self.forces.contact[3 * node as usize..3 * node as usize + 3].fill(0.0);
            }
            for range in support {
                self.forces.contact[range.clone()].copy_from_slice(&buffers.constraint[range.clone()]);
            }
            self.forces.pushed.extend_from_slice(touched);
            if let Some(impact) = &impact {
                let forces = impact.mean.forces.iter().flatten();
                forces.for_each(|&(c, force)| self.forces.contact[c as usize] += force);
            }
            // Vertices of traces belong to no body: its nodes have the forces on its faces.
            if !self.model.traces.is_empty() {
                let traces = &self.model.traces;
                let vertices: Vec<u32> = touched.iter().copied().filter(|node| traces.contains_key(node)).collect();
                self.model.embedding.pull_back_of(&vertices, &mut self.forces.contact);
            }
        }
        let mut impact = impact.unwrap_or_default();
        for &(c, force) in &impact.mean.reactions {
            self.forces.reactions[c as usize] += force;
        }
        self.impacts.largest_rate = self.impacts.largest_rate.max(impact.largest_rate);
        work += impact.external;
        self.ledger.stored = stored;
        self.slots.pressures = iterate.pressures;
        self.slots.mean_pressures = std::mem::take(&mut impact.mean.pressures);
        self.slots.active = iterate.active;
        self.take_sliding_supports_from_contact_force();
        let balance =
            self.measure_balance(draft.strain(), self.ledger.balance.external_work + work + contact_work.driven);
        let before = self.ledger.balance;
        let stored_by_normal = |stored: f64, by_friction: f64| stored - by_friction;
        // Without contact the constraints are those of joints, and what they lose is what their limits report.
        let limits = if quasi_static { 0.0 } else { contact_work.closing.unwrap_or(0.0) };
        let normal_work = work_of_contact.map_or(-limits, |work| {
            let stored = stored_by_normal(contact_work.stored, contact_work.friction_stored)
                - stored_by_normal(before.contact, before.friction_stored);
            work + contact_work.friction_work + contact_work.damped + stored - contact_work.driven
        });
        // Friction of the law of impact in the place of that of the step.
        let of_impact: f64 = impact.friction.iter().sum();
        self.ledger.balance = Balance {
            contact: contact_work.stored,
            dissipation: self.ledger.balance.dissipation + contact_work.dissipated + of_impact + damped + damped_bodies,
            damping: self.ledger.balance.damping + damped_bodies,
            stabilisation: self.ledger.balance.stabilisation + stabilised,
            friction_work: self.ledger.balance.friction_work + contact_work.friction_work + of_impact + damped,
            friction_stored: contact_work.friction_stored,
            closing_loss: self.ledger.balance.closing_loss - normal_work - impact.closing,
            contact_remainder: self.ledger.balance.contact_remainder
                + if quasi_static { 0.0 } else { contact_work.closing.map_or(0.0, |closing| -normal_work - closing) },
            impact_loss: self.ledger.balance.impact_loss + impact.loss,
            impact_deformable: self.ledger.balance.impact_deformable + impact.deformable,
            impacts: self.ledger.balance.impacts + impact.closed,
            impact_capped: self.ledger.balance.impact_capped + impact.excess,
            ..balance
        };
        let books = self.close_books(draft, &impact, [of_supports, jump], stabilised, &before);
        self.step += 1;
        self.stage.sudden.clear();
        if let Some(work) = work_of_contact {
            self.warn_contact_gain(work - contact_work.driven, &before);
        }
        let change = match (self.clock.accept(solves), self.how.control.automatic) {
            (StepChange::None, _) => None,
            (StepChange::Doubled, None) => {
                Some((DecisionKind::Grow, format!("{} steps succeeded in a row", self.how.control.grow_after)))
            }
            (StepChange::Doubled, Some(Automatic { easy, after, .. })) => {
                Some((DecisionKind::Grow, format!("{after} steps in a row took at most {easy} iterations each")))
            }
            (StepChange::Halved, automatic) => {
                let hard = automatic.map_or(0, |automatic| automatic.hard);
                Some((DecisionKind::Shrink, format!("the step took {solves} iterations, more than {hard}")))
            }
        };
        if let Some((kind, reason)) = change {
            self.log.decisions.push(decision(self.step, time, dt, kind, reason));
        }
        self.warn_stabilisation();
        self.warn_fallbacks();
        self.warn_handed_over();
        StepRecord {
            step: self.step,
            stage: self.stage.number,
            time,
            dt,
            nominal: self.clock.on_nominal_grid(),
            balance: self.ledger.balance,
            newton,
            iterations: solves,
            decisions: self.log.decisions[first_decision..].to_vec(),
            unstable,
            closing,
            books,
            impact_losses: impact.losses,
            stabilising,
            inside_out: inside_out.iter().flatten().map(|found| found.count).sum(),
            contact,
        }
    }

    /// Adds `factor` times the dead loads that vary in time.
    fn add_varying_loads(&self, time: f64, factor: f64, force: &mut [f64]) {
        let at = At { time, ..At::force([&self.state.q; 2], ForceRule::END_POINT, 0.0) };
        let loads = self.model.acting_loads(&self.system.present.acting);
        for load in loads.filter(|load| !load.follows() && !load.is_conservative()) {
            // cannot fail: the forces are constant.
            load.add_force(&at, factor, force).unwrap_or(());
        }
    }

    /// Sum of the magnitudes of the components of the forces of supports and loads at the end of a step.
    fn external_forces(&self) -> f64 {
        let reactions =
            self.stage.prescribed.iter().map(|&(component, ..)| self.forces.reactions[component as usize].abs());
        let loads = self.system.loads.support.iter().flat_map(Range::clone).map(|c| {
            let follower = if self.system.loads.has_followers { self.system.loads.follower[c] } else { 0.0 };
            let dead = if self.system.loads.has_dead { self.system.loads.dead[c] } else { 0.0 };
            (dead + follower).abs()
        });
        reactions.sum::<f64>() + loads.sum::<f64>()
    }

    /// Work of the present reactions on the way to `q`.
    fn reaction_work(&self, q: &[f64]) -> f64 {
        let components = self.stage.prescribed.iter().map(|&(component, ..)| component as usize);
        components.map(|c| self.forces.reactions[c] * (q[c] - self.state.q[c])).sum()
    }

    fn add_reactions(&self, factor: f64, force: &mut [f64]) {
        for &(component, ..) in &self.stage.prescribed {
            force[component as usize] += factor * self.forces.reactions[component as usize];
        }
    }
}
