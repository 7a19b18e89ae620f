//! One step of a simulation: attempts, and the state to which one that succeeds leads.

use super::books::Draft;
use super::impact::Impact;
use super::{InsideOutTreatment, Simulation};
use crate::anchored::attempt_anchored;
use crate::assembly::no_auxiliaries;
use crate::failure::{AttemptLog, FailedAttempt};
use crate::iterate::Iterate;
use crate::rows::Rows;
use crate::smooth::attempt_smoothed;
use crate::step::{Attempt, StepInput, attempt, decision};
use crate::system::FeSystem;
use crate::terms::Line;
use crate::{Body, ContactSummary, DecisionKind, Phase, PhaseTime, SimulationError, StepError, StepRecord};
use stoss_fe_solid::InsideOut;
use stoss_integrators::{State, Step, StepRule, finish};
use stoss_linalg::{LinalgError, vector};
use stoss_term::{Coverage, Fault, StepContext, Work};

/// A quasi-static step is started by extrapolating the last one if that moves prescribed components to where they have to be, up to this
/// fraction of their motion.
const EXTRAPOLATION_FITS: f64 = 0.1;

/// End of the message of a step whose size does not matter.
const AT_ANY_SIZE: &str =
    "; the matrix at the start of the step is singular whatever the step size, so that smaller steps were not tried";

/// Whether the linear solver refuses its settings, which no step changes.
fn is_refused(cause: &StepError) -> bool {
    matches!(cause, StepError::Linear(LinalgError::Settings { .. }))
}

/// Iterate from which the iterations start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// The scheme's predictor; in statics the last increment once more.
    Extrapolation,
    /// The last positions, and the linear response to the motion of prescribed components.
    Linear,
    /// The last positions.
    Last,
}

/// Way in which a step is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// Newton's method with a set of closed slots.
    Plain,
    /// Newton's method from where springs have led it.
    Anchored,
    /// Newton's method with compliant rows and slips of little weight.
    Careful,
    /// Along smoothed complementarity.
    Smoothed,
}

/// An attempt that succeeded, with what could still have failed.
pub(super) struct Completed {
    pub attempt: Attempt,
    pub next: State,
    pub rule: StepRule,
    pub draft: Draft,
    pub contact: Option<ContactSummary>,
    pub work: Work,
    /// Stored energies of each contact pair.
    pub stored: Vec<[f64; 2]>,
    /// What closing gaps cost in the step, for each constraint; empty in statics.
    pub closing: Vec<f64>,
    /// What the impact of what closed did to the velocities.
    pub impact: Option<Impact>,
    /// Elements that are turned inside out, for each body.
    pub inside_out: Vec<Option<InsideOut>>,
    /// Linear solutions of the attempt.
    pub solves: u32,
}

impl Completed {
    /// Whether the energy falls in some direction at the end of the step.
    pub(super) fn is_unstable(&self) -> bool {
        self.attempt.unstable > 0
    }
}

impl Simulation {
    pub(super) fn kinetic(&self, v: &[f64]) -> f64 {
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
                        let hint = match at_any_size {
                            true if is_refused(&cause) => String::new(),
                            true => AT_ANY_SIZE.to_owned(),
                            false => self.undivided(&cause),
                        };
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
        let step = StepContext {
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
            held: &self.stage.held,
        };
        let mut acting = self.model.terms_mut(&self.system.present.acting).filter(|(_, acts, _)| *acts);
        let begun = acting.try_for_each(|(line, _, term)| {
            let phase = if line == Line::Force { Phase::Assembly } else { Phase::Search };
            let reach = step.reach + 0.5 * term.length_scale();
            self.log.timings.measure(phase, || term.begin(&StepContext { reach, ..step }))
        });
        Ok(self.system.shares.agree(begun)?)
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
            let singular_at_any = self.how.scheme.is_none()
                && self.system.present.stabilisation.is_none()
                && !goes_on
                && trace.first_was_singular(cause);
            let failed = trace.failed(&self.model, (self.step + 1, self.state.time, dt), cause);
            let at_any_size = singular_at_any || is_refused(cause);
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
        if self.how.inside_out == InsideOutTreatment::Refuse
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
        if let Some(limit) = self.how.max_plastic_increment
            && let Some((body, increment)) = draft.flows_beyond(limit)
        {
            let body = self.model.bodies[body].solid.name().to_owned();
            return Err(StepError::PlasticIncrement { body, increment, limit });
        }
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
        let shares = &self.system.shares;
        let of = |body: &Body| Ok(shares.worst(body.solid.inside_out(q).map_err(Fault::from)?));
        self.model.bodies.iter().map(of).collect()
    }

    /// Part of the stabilisation that acts at a time of the stage.
    pub(super) fn ramp(&self, time: f64) -> f64 {
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
}
