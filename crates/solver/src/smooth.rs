//! A step by smoothed complementarity, where Newton's method with a set of closed slots failed (theory/constraints#smoothed).
//!
//! All slots with a partner nearer than an edge are in play and have rows, and springs hold every free component. Smoothing and springs fall to nothing together inside the step, by less
//! where the next solution is not found near the last one; an attempt with a set takes it from there to the end: the result is a solution of the equations without both.

use crate::anchor::Anchor;
use crate::assembly::System;
use crate::failure::AttemptLog;
use crate::iterate::Iterate;
use crate::problem::{StepProblem, start_auxiliaries};
use crate::rows::{COMPLIANCE_SMOOTHED, Rows};
use crate::step::{Attempt, StepInput, attempt};
use crate::{Model, NewtonRow, Phase, StepError, Timings};
use stoss_integrators::Step;
use stoss_linalg::MatrixKind;
use stoss_newton::{LineSearch, NewtonOptions, NewtonProblem, ResidualNorms};

/// Linear solutions on the way.
const BUDGET: u32 = 120;

/// Pressures that count as none, in parts of the factor of complementarity times an edge (about Young's modulus): the smoothing is measured by the largest
/// pressure or by this.
const SMALL_PRESSURE: f64 = 1.0e-2;

/// Smoothing at the beginning and at the end.
const FIRST: f64 = 0.05;
const LAST: f64 = 1.0e-7;

/// Stiffness of the springs at the beginning, in parts of the mean diagonal of the tangent.
const SPRINGS: f64 = 1.0e-2;

/// The next smoothing, after few iterates with the present one and after more; after many the reduction stays what it was.
const QUICK: f64 = 0.1;
const SLOW: f64 = 0.4;
const FEW: u32 = 2;
const SOME: u32 = 5;

/// A smoothing that is reduced by less is not worth it.
const LEAST_FACTOR: f64 = 0.85;

/// A smoothing has been solved for when residual and violation are below this part of it, and below that.
const OF_SMOOTHING: f64 = 0.3;
const SOLVED: f64 = 1.0e-2;

/// Part of an edge by which a component moves at most in an iterate.
const REACH: f64 = 0.3;

/// Shift of the tangent in parts of its mean diagonal: the least and the most that is tried, the factor after an increment that is no use, and after a full one.
const LEAST_SHIFT: f64 = 1.0e-3;
const WATCHED_SHIFT: f64 = 10.0;
const MORE: f64 = 4.0;
const LESS: f64 = 0.25;

/// Shifts that are tried in an iterate.
const MAX_SHIFTS: u32 = 14;

/// Number of shifts after which the best part of an increment is taken, however bad.
const ENOUGH: u32 = 6;

/// Value of the merit function below which no shift is needed.
const NEAR: f64 = 1.0e-3;

/// Parts of an increment that are tried: 1, 1/2, .. 1/16.
const HALVINGS: i32 = 5;

/// An iterate may be worse than the worst of the last three by this, or by that if no part of the increment is better.
const GROWTH: f64 = 1.5;
const MOST_GROWTH: f64 = 3.0;

/// Iterates without one that is better than the best by a tenth, after which nothing may grow and the shift does.
const PATIENCE: u32 = 5;
const BETTER: f64 = 0.9;

/// Tries the step as [`attempt`] does, along smoothed complementarity. Rows of closed slots keep a compliance in the tangent.
pub(crate) fn attempt_smoothed(
    model: &mut Model,
    system: &mut System,
    input: StepInput<'_>,
    timings: &mut Timings,
    trace: &mut AttemptLog,
) -> Result<Attempt, StepError> {
    let StepInput { step, start, prescribed, predict, newton } = input;
    let path = Path::new(model, system, step, start, timings, trace);
    let found = path.follow(predict.then_some(&prescribed));
    system.rows = Rows::compliant();
    system.present.anchor = None;
    // That it is in balance does not tell that it is held without springs: the matrix does.
    let mut newton = NewtonOptions { min_iterations: newton.min_iterations.max(1), ..newton };
    // It begins with a residual that is nothing, and a point at its kink may bring a larger one at first.
    if let LineSearch::Backtracking { small, .. } = &mut newton.line_search {
        *small = small.max(NEAR);
    }
    let input = StepInput { step, start: found?, prescribed, predict: false, newton };
    attempt(model, system, input, timings, trace)
}

/// What is left of the equations, a part of the forces or of an edge.
#[derive(Clone, Copy, Debug, Default)]
struct Merit {
    value: f64,
    scale: f64,
}

/// Scales by which lengths and pressures are measured.
struct Scale {
    /// Stress of each pair by which pressures are measured.
    moduli: Vec<f64>,
    /// Shortest edge of surfaces in contact.
    edge: f64,
    /// Largest pressure, in moduli.
    reference: f64,
}

/// The iterates with one smoothing.
struct Course {
    merits: Vec<f64>,
    smallest: f64,
    /// Iterates since the smallest one.
    since: u32,
    rounds: u32,
}

impl Course {
    const NEW: Self = Self { merits: Vec::new(), smallest: f64::INFINITY, since: 0, rounds: 0 };
}

/// The way with less and less smoothing.
struct Path<'a> {
    model: &'a mut Model,
    system: &'a mut System,
    step: Step<'a>,
    iterate: Iterate,
    timings: &'a mut Timings,
    trace: &'a mut AttemptLog,
    gaps: Vec<Vec<f64>>,
    scale: Scale,
    /// Smoothing, in parts of the largest pressure.
    theta: f64,
    /// Factor from the last smoothing that was solved for, that smoothing and its solution.
    factor: f64,
    solved: Option<(f64, Iterate)>,
    /// Shift of the next tangent.
    shift: f64,
    course: Course,
    /// Solutions before.
    before: u32,
    changes: usize,
}

impl<'a> Path<'a> {
    fn new(
        model: &'a mut Model,
        system: &'a mut System,
        step: Step<'a>,
        iterate: Iterate,
        timings: &'a mut Timings,
        trace: &'a mut AttemptLog,
    ) -> Self {
        let of_contact = |c: &crate::CouplingTerm| c.unilateral().is_some();
        let lengths = model.contacts.iter().filter(|c| of_contact(c)).map(|c| c.term.length_scale());
        let edge = lengths.fold(f64::INFINITY, f64::min);
        let moduli: Vec<f64> = model.contacts.iter().map(|c| c.complementarity * c.term.length_scale()).collect();
        let pairs = model.contacts.iter().zip(&moduli).zip(&iterate.pressures);
        let pressures =
            pairs.filter(|((c, _), _)| of_contact(c)).flat_map(|((_, m), p)| p.iter().map(move |p| p.abs() / m));
        let reference = pressures.filter(|p| p.is_finite()).fold(SMALL_PRESSURE, f64::max);
        let gaps = iterate.pressures.iter().map(|p| vec![0.0; p.len()]).collect();
        let before = trace.solves;
        Self {
            model,
            system,
            step,
            iterate,
            timings,
            trace,
            gaps,
            scale: Scale { moduli, edge, reference },
            theta: FIRST,
            factor: SLOW,
            solved: None,
            shift: 0.0,
            course: Course::NEW,
            before,
            changes: 0,
        }
    }

    fn problem(&mut self) -> StepProblem<'_> {
        let Self { model, system, step, iterate, timings, trace, .. } = self;
        StepProblem::new(model, system, *step, iterate, timings, &mut trace.solves)
    }

    fn spent(&self) -> StepError {
        StepError::ActiveSet { rounds: (self.trace.solves - self.before) as usize, changes: self.changes, repairs: 0 }
    }

    /// Smoothing of a pair, a stress.
    fn smoothing(&self, pair: usize) -> f64 {
        self.theta * self.scale.reference * self.scale.moduli[pair]
    }

    fn smooth_rows(&mut self) {
        let smoothing: Vec<f64> = (0..self.model.contacts.len()).map(|c| self.smoothing(c)).collect();
        for (pair, &theta) in self.model.contacts.iter_mut().zip(&smoothing) {
            if let Some(method) = pair.unilateral_mut() {
                method.smooth_friction(theta);
            }
        }
        self.system.rows = Rows { compliance: COMPLIANCE_SMOOTHED, smoothing, ..Rows::default() };
    }

    /// Goes along the path; `prescribed`: components that have to be brought to where they are at the end of the step first.
    fn follow(mut self, prescribed: Option<&Vec<(usize, f64)>>) -> Result<Iterate, StepError> {
        self.begin(prescribed)?;
        loop {
            self.smooth_rows();
            let merit = self.assemble()?;
            if merit.value < (OF_SMOOTHING * self.theta).min(SOLVED) || merit.value < f64::MIN_POSITIVE {
                if self.theta <= LAST {
                    return self.close();
                }
                self.sharpen();
                continue;
            }
            match self.advance(merit) {
                Ok(increment) => {
                    self.changes += self.renew()?;
                    self.record(merit, increment);
                }
                Err(_) if self.may_go_back() => self.go_back()?,
                Err(error) => return Err(error),
            }
        }
    }

    fn begin(&mut self, prescribed: Option<&Vec<(usize, f64)>>) -> Result<(), StepError> {
        self.system.solver.forget();
        self.system.excess = 0;
        self.hold(self.iterate.q.clone());
        let Self { model, system, iterate, timings, .. } = self;
        timings.measure(Phase::Assembly, || system.begin_pattern(model, &iterate.active))?;
        start_auxiliaries(model, &self.step, iterate)?;
        system.base.has_linearised = false;
        if let Some(prescribed) = prescribed {
            self.problem().predict_all(prescribed)?;
        }
        // Springs do not resist what is prescribed.
        self.hold(self.iterate.q.clone());
        self.problem().residual_norms()?;
        if self.choose_in_play()? == 0 && !self.iterate.active.iter().flatten().any(|&active| active) {
            return Err(self.spent());
        }
        for c in 0..self.model.contacts.len() {
            if self.model.contacts[c].unilateral().is_none() {
                continue;
            }
            let least = self.smoothing(c);
            let slots = self.iterate.pressures[c].iter_mut().zip(&self.iterate.active[c]);
            slots.filter(|(_, active)| **active).for_each(|(p, _)| *p = p.max(least));
        }
        self.match_pattern()
    }

    /// Pattern and auxiliaries for the slots in play.
    fn match_pattern(&mut self) -> Result<(), StepError> {
        let Self { model, system, iterate, timings, .. } = self;
        timings.measure(Phase::Assembly, || system.renew_pattern(model, &iterate.active))?;
        start_auxiliaries(model, &self.step, iterate)
    }

    fn assemble(&mut self) -> Result<Merit, StepError> {
        let mut problem = self.problem();
        let norms = problem.assemble()?;
        let scale = norms.scale.max(f64::MIN_POSITIVE);
        let value = (norms.residual / scale).max(problem.relative_violation().min(1.0));
        Ok(Merit { value, scale })
    }

    /// Springs to these positions, as stiff as there is smoothing.
    fn hold(&mut self, from: Vec<f64>) {
        self.system.present.anchor = Some(Anchor { part: SPRINGS * self.theta / FIRST, stiffness: 0.0, from });
    }

    /// Less smoothing, after a solution.
    fn sharpen(&mut self) {
        self.factor = if self.course.rounds <= FEW {
            QUICK
        } else if self.course.rounds <= SOME {
            SLOW.max(self.factor * self.factor)
        } else {
            SLOW.max(self.factor)
        };
        self.solved = Some((self.theta, self.iterate.clone()));
        self.reduce();
    }

    /// Whether the smoothing may be reduced by less than it was.
    fn may_go_back(&self) -> bool {
        self.solved.is_some() && self.factor < LEAST_FACTOR && self.trace.solves - self.before < BUDGET
    }

    /// Goes back to the last solution, to reduce the smoothing by less.
    fn go_back(&mut self) -> Result<(), StepError> {
        let Some((_, iterate)) = &self.solved else { return Ok(()) };
        self.iterate.clone_from(iterate);
        self.factor = self.factor.sqrt();
        self.reduce();
        self.choose_in_play()?;
        self.match_pattern()
    }

    /// Takes the next smoothing after the one that was solved for.
    fn reduce(&mut self) {
        if let Some((solved, _)) = &self.solved {
            self.theta = (self.factor * solved).max(LAST);
        }
        (self.course, self.shift) = (Course::NEW, 0.0);
        if let Some(anchor) = self.system.present.anchor.take() {
            self.hold(anchor.from);
        }
    }

    /// One iterate: the shift grows until a part of the increment is acceptable. Returns the norm of the increment.
    fn advance(&mut self, merit: Merit) -> Result<f64, StepError> {
        self.course.rounds += 1;
        self.course.merits.push(merit.value);
        if merit.value < BETTER * self.course.smallest {
            (self.course.smallest, self.course.since) = (merit.value, 0);
        } else {
            self.course.since += 1;
        }
        let watched = self.course.since >= PATIENCE;
        if watched && self.may_go_back() {
            return Err(self.spent());
        }
        if watched {
            self.shift = (MORE * self.shift).clamp(LEAST_SHIFT, WATCHED_SHIFT);
        }
        let last = &self.course.merits[self.course.merits.len().saturating_sub(3)..];
        let ceiling = last.iter().fold(0.0_f64, |most, value| most.max(*value));
        let mean = self.problem().mean_diagonal();
        let mut shift = if merit.value < NEAR && !watched { 0.0 } else { self.shift };
        // Whether the increment is one from this iterate.
        let mut is_based = false;
        for tries in 0..=MAX_SHIFTS {
            if self.trace.solves - self.before >= BUDGET {
                return Err(self.spent());
            }
            let reach = REACH * self.scale.edge;
            let mut problem = self.problem();
            let solved = problem.factorise_shifted(MatrixKind::General, shift * mean);
            let mut length = None;
            let mut increment = f64::INFINITY;
            if solved.and_then(|_| problem.solve_factorised()).is_ok() {
                increment = problem.keep_base()?;
                is_based = true;
                let s = &*problem.system;
                let far = s.increment[..s.matrix.free()].iter().fold(0.0_f64, |most, d| most.max(d.abs()));
                if far <= reach {
                    length = self.search(merit.scale, ceiling, watched, tries > ENOUGH)?;
                }
            }
            if let Some(length) = length {
                let used = if tries > 0 { shift } else { self.shift };
                self.shift = used * if length == 1.0 { LESS } else { 1.0 };
                return Ok(length * increment);
            }
            if self.course.rounds == 1 && self.may_go_back() {
                break;
            }
            if is_based {
                self.problem().update(0.0)?;
            }
            shift = (MORE * shift).max(LEAST_SHIFT);
            self.problem().assemble()?;
        }
        Err(self.spent())
    }

    /// Goes the longest part of the increment that is acceptable, or the best one if `any` is; `None` if there is none, the iterate is anywhere then.
    fn search(&mut self, scale: f64, ceiling: f64, watched: bool, any: bool) -> Result<Option<f64>, StepError> {
        let allowed = if watched { 1.0 - 1e-2 } else { GROWTH };
        let mut best = (f64::INFINITY, 1.0);
        let mut problem = self.problem();
        for k in 0..HALVINGS {
            let length = 0.5_f64.powi(k);
            match problem.update(length).and_then(|()| problem.residual_norms()) {
                Ok(ResidualNorms { residual, .. }) if residual.is_finite() => {
                    let merit = (residual / scale).max(problem.relative_violation().min(1.0));
                    if merit <= allowed * ceiling {
                        return Ok(Some(length));
                    }
                    if merit < best.0 {
                        best = (merit, length);
                    }
                }
                Ok(_) => {}
                Err(error) if problem.is_recoverable(&error) => {}
                Err(error) => return Err(error),
            }
        }
        if !watched && best.0 < MOST_GROWTH * ceiling.max(SOLVED) || any && best.0.is_finite() {
            problem.update(best.1)?;
            problem.residual_norms()?;
            return Ok(Some(best.1));
        }
        Ok(None)
    }

    /// Slots in play, pairings and pattern at a new iterate; returns how many changed.
    fn renew(&mut self) -> Result<usize, StepError> {
        let changes = self.choose_in_play()?;
        if changes > 0 {
            self.match_pattern()?;
        }
        Ok(changes)
    }

    /// Slots with a partner nearer than an edge, or than two if they are in play already.
    fn choose_in_play(&mut self) -> Result<usize, StepError> {
        let mut changes = 0;
        for c in 0..self.model.contacts.len() {
            let theta = self.smoothing(c);
            let factor = self.model.contacts[c].complementarity;
            let Some(method) = self.model.contacts[c].unilateral_mut() else { continue };
            let (active, pressures) = (&mut self.iterate.active[c], &mut self.iterate.pressures[c]);
            let (gaps, q, reach) = (&mut self.gaps[c], &self.iterate.q, self.scale.edge);
            self.trace.begin(active);
            changes += self.timings.measure(Phase::Search, || -> Result<usize, StepError> {
                let mut changes = 0;
                method.complementarity_gaps(q, active, gaps)?;
                for ((active, p), &gap) in active.iter_mut().zip(pressures.iter_mut()).zip(&*gaps) {
                    let near = gap.is_finite() && gap < if *active { 2.0 * reach } else { reach };
                    if near != *active {
                        changes += 1;
                        *active = near;
                        // Where the smoothed function is zero.
                        *p = if near { theta * theta / (factor * gap).max(theta) } else { 0.0 };
                    }
                }
                Ok(changes + method.repair(q, active)?)
            })?;
            self.trace.end(c, active);
        }
        Ok(changes)
    }

    fn record(&mut self, merit: Merit, increment: f64) {
        let active = self.iterate.active.iter().flatten().filter(|&&active| active).count();
        self.trace.newton.push(NewtonRow {
            iteration: self.trace.newton.len() as u32,
            residual: merit.value,
            increment,
            active,
            changes: 0,
        });
    }

    /// Closes the slots that are pressed.
    fn close(mut self) -> Result<Iterate, StepError> {
        for (c, pair) in self.model.contacts.iter_mut().enumerate() {
            let Some(method) = pair.unilateral_mut() else { continue };
            method.smooth_friction(0.0);
            let (active, gaps) = (&mut self.iterate.active[c], &mut self.gaps[c]);
            method.complementarity_gaps(&self.iterate.q, active, gaps)?;
            for ((active, p), gap) in active.iter_mut().zip(&mut self.iterate.pressures[c]).zip(gaps) {
                *active &= gap.is_finite() && *p > pair.complementarity * *gap;
                if !*active {
                    *p = 0.0;
                }
            }
        }
        Ok(self.iterate)
    }
}
