//! The iteration itself.

use crate::options::OVERSHOOT;
use crate::{
    IterationRecord, LineSearch, NewtonFailure, NewtonOptions, NewtonProblem, NewtonReport, Potential, ResidualNorms,
    StopReason,
};

/// Iterates until a stop reason applies. On success the problem's iterate is the solution. After a failure it is undefined:
/// the caller restores its last good state.
///
/// On success the residual held by the problem belongs to the solution, and `iterations.last()` is its record,
/// unless the last step was taken back: then its record has step length zero. The tangent belongs to it too, unless the iterate was polished: then only with [`NewtonOptions::tangent_at_solution`].
///
/// # Errors
/// [`NewtonFailure::NotConverged`] with the reason, or [`NewtonFailure::Problem`] with the problem's own error.
pub fn solve<P: NewtonProblem>(
    problem: &mut P,
    options: &NewtonOptions,
) -> Result<NewtonReport, NewtonFailure<P::Error>> {
    let mut course = Iteration { options, records: Vec::with_capacity(options.max_iterations as usize + 1) };
    match course.run(problem) {
        Ok(reason) if reason.is_converged() => Ok(course.report(reason)),
        Ok(reason) => Err(NewtonFailure::NotConverged(course.report(reason))),
        Err(error) => Err(NewtonFailure::Problem { error, report: course.report(StopReason::ProblemError) }),
    }
}

/// Step length when the iteration cycles: Newton's method may jump without end between the smooth pieces of a residual with kinks (stick and slip, the
/// facets of a surface). A step of this length ends between them.
const CYCLE_STEP: f64 = 0.5;

/// Relative difference below which two residuals count as equal in the test for cycles.
const SAME_RESIDUAL: f64 = 0.02;

/// A residual below this part of the measure of the constraint violation counts as zero. The forces of the constraints are still missing then, and neither
/// the residual nor its scale says how large they will be: when contact closes on unloaded bodies, both may be arbitrarily small.
const BALANCED_RESIDUAL: f64 = 1e-3;

/// A relative violation of constraints above this is not round-off, however small the increment of the positions: the multipliers alone may have changed, for
/// instance that of a sticking point that is about to slide.
const ROUND_OFF_VIOLATION: f64 = 1e-6;

/// Largest number of reductions of a step in the line search on a potential. The last trial is accepted even if the potential has not fallen, which only
/// round-off can cause.
const MAX_REDUCTIONS_ON_POTENTIAL: u32 = 20;

/// Iterations that lower a fixed potential do not count against the limit, up to this multiple of it. They lead to a minimum, which may be far away where a
/// surface snaps through or slips off; a shorter load step would not bring it nearer.
const EXTRA_DESCENT_ITERATIONS: u32 = 4;

/// Relative decrease of the residual that a full step must reach, and a shorter one in proportion, where the potential is not fixed.
const SUFFICIENT_DECREASE: f64 = 0.1;

/// Part of the tolerance that the residual of the linear equations may take.
const SHARE_OF_LINEAR_RESIDUAL: f64 = 0.3;

/// Armijo's constant: least decrease of the potential over the decrease that its slope at the start predicts.
const ARMIJO: f64 = 1e-4;

/// Constant of the curvature condition (strong Wolfe), used where round-off hides the decrease: beyond a minimum the potential rises again, and a step that ends with
/// a slope of more than this part of the slope at the start is too long (nearly twice the distance of the minimum of a parabola).
const CURVATURE: f64 = 0.9;

/// A shorter step is long enough if the slope at its end is at most this part of that at the start.
const ENOUGH: f64 = 0.8;

/// Potential, and its slope along the increment, where a line search starts.
#[derive(Clone, Copy)]
struct LineStart {
    at_start: Potential,
    slope: f64,
}

impl LineStart {
    /// Whether a step of this length that ends at `potential` with this slope lowers the potential sufficiently. Where round-off hides the decrease, the slope at the
    /// end decides ([`CURVATURE`]).
    fn is_descent(self, potential: Potential, length: f64, slope: f64) -> bool {
        let excess = potential.value - self.at_start.value - ARMIJO * length * self.slope;
        excess <= 0.0 && self.is_lower(potential)
            || excess <= self.at_start.round_off.max(potential.round_off) && slope <= -CURVATURE * self.slope
    }

    /// Whether `potential` is lower than at the start by more than round-off.
    fn is_lower(self, potential: Potential) -> bool {
        potential.value < self.at_start.value - self.at_start.round_off.max(potential.round_off)
    }
}

/// Norms of an iterate.
#[derive(Clone, Copy)]
struct Norms {
    /// What has to decrease: the larger of the residual and of the relative violation (at most 1) times the scale.
    measure: f64,
    residual: f64,
    scale: f64,
    violation: f64,
}

impl Norms {
    fn new(ResidualNorms { residual, scale }: ResidualNorms, violation: f64) -> Self {
        Self { measure: measure(residual, scale, violation), residual, scale, violation }
    }

    fn is_finite(self) -> bool {
        self.measure.is_finite() && self.scale.is_finite() && self.violation.is_finite()
    }
}

fn measure(residual: f64, scale: f64, violation: f64) -> f64 {
    // A multiplier of stick far beyond what friction can carry violates its row by many lengths: it will slide. A residual of forces is not much larger
    // than their scale, however wrong the iterate is.
    let part = violation.min(1.0);
    // Not `max`, which loses a residual that is NaN; a violation is checked by `Norms::is_finite`.
    if part * scale > residual { part * scale } else { residual }
}

fn assemble<P: NewtonProblem>(problem: &mut P) -> Result<Norms, P::Error> {
    let norms = problem.assemble()?;
    Ok(Norms::new(norms, problem.relative_violation()))
}

/// Norms of the residual as of [`assemble`], without the tangent.
fn evaluate<P: NewtonProblem>(problem: &mut P) -> Result<Norms, P::Error> {
    let norms = problem.residual_norms()?;
    Ok(Norms::new(norms, problem.relative_violation()))
}

/// Outcome of a step.
enum Trial {
    Taken {
        norms: Norms,
        length: f64,
        /// Whether the potential fell, if there is one.
        lower: bool,
    },
    NotAcceptable,
    NotFinite,
}

struct Iteration<'a> {
    options: &'a NewtonOptions,
    records: Vec<IterationRecord>,
}

impl Iteration<'_> {
    fn report(self, reason: StopReason) -> NewtonReport {
        NewtonReport { reason, iterations: self.records }
    }

    fn run<P: NewtonProblem>(&mut self, problem: &mut P) -> Result<StopReason, P::Error> {
        let o = self.options;
        let mut norms = assemble(problem)?;
        self.record(norms, 0.0, 0.0);
        if !norms.is_finite() {
            return Ok(StopReason::NotFinite);
        }
        let mut divergence = o.divergence_factor * norms.measure.max(norms.scale);
        let mut smallest = norms.measure;
        let mut since_smallest = 0;
        let (mut solves, mut descents) = (0, 0);
        while solves < o.min_iterations || !self.within_tolerance(norms) {
            if solves >= o.max_iterations + descents.min(EXTRA_DESCENT_ITERATIONS * o.max_iterations) {
                return Ok(StopReason::MaxIterations);
            }
            solves += 1;
            let line_search = problem.line_search(o.line_search);
            let downhill = matches!(line_search, LineSearch::Best { .. });
            problem.aim(self.enough(norms));
            let increment = if downhill { problem.solve_downhill() } else { problem.solve() }?;
            if !increment.is_finite() {
                return Ok(StopReason::NotFinite);
            }
            let previous = norms;
            let at_start = if downhill { problem.potential()? } else { None };
            // An increment along which the potential rises: the problem could not avoid it, and the residual is searched instead.
            let start = at_start
                .map(|at_start| LineStart { at_start, slope: problem.slope() })
                .filter(|start| start.slope <= 0.0);
            let first = problem.longest_step()?.min(if self.cycles() { CYCLE_STEP } else { 1.0 });
            // The slope along an increment of round-off is round-off, of either sign.
            let is_round_off = increment <= o.stagnation_increment * problem.iterate_norm();
            let line_search = if is_round_off { line_search.without_slope() } else { line_search };
            let (length, lower) = match self.step(problem, line_search, previous, (first, start))? {
                Trial::Taken { norms: new, length, lower } => {
                    norms = new;
                    (length, lower)
                }
                Trial::NotAcceptable => return Ok(StopReason::LineSearchFailed),
                Trial::NotFinite => return Ok(StopReason::NotFinite),
            };
            if self.begins_in_balance(previous) {
                divergence = divergence.max(o.divergence_factor * norms.scale);
                smallest = norms.measure;
            }
            descents += u32::from(lower && at_start.is_some_and(|potential| potential.is_fixed));
            self.record(norms, increment, length);
            if self.within_tolerance(norms) {
                continue;
            }
            // Full steps only: a short step says nothing about what a full one would gain.
            let fell = norms.measure <= o.polish_factor * previous.measure || length < 1.0;
            let at_round_off = norms.measure <= o.stagnation_residual * norms.scale
                || (is_round_off
                    && increment > 0.0
                    && problem.is_linearised()
                    && norms.violation <= ROUND_OFF_VIOLATION);
            if !fell && at_round_off {
                // The last bits may decide between two branches, as of stick and slip: the better iterate is the solution.
                if norms.measure * o.polish_factor > previous.measure {
                    problem.update(0.0)?;
                    problem.assemble()?;
                    if let Some(rejected) = self.records.last_mut() {
                        rejected.step_length = 0.0;
                    }
                }
                return Ok(StopReason::ConvergedToRoundOff);
            }
            if norms.measure > divergence {
                return Ok(StopReason::Diverged);
            }
            if norms.measure < smallest {
                smallest = norms.measure;
                since_smallest = 0;
            } else if !lower {
                since_smallest += 1;
                if since_smallest >= o.stagnation_iterations {
                    return Ok(StopReason::Stagnated);
                }
            }
        }
        self.polish(problem, norms)
    }

    /// Further iterations below the tolerance. They cannot turn success into failure, except for an error at the
    /// restored iterate.
    fn polish<P: NewtonProblem>(&mut self, problem: &mut P, mut norms: Norms) -> Result<StopReason, P::Error> {
        let o = self.options;
        for round in 1..=o.polish {
            if norms.measure <= o.round_off_level * norms.scale {
                return Ok(StopReason::ConvergedToRoundOff);
            }
            problem.aim(0.0);
            let Ok(increment) = problem.solve() else {
                return Ok(StopReason::Converged);
            };
            let trial = match problem.longest_step().and_then(|longest| problem.update(longest)) {
                Ok(()) if o.tangent_at_solution || round < o.polish => assemble(problem),
                // Nothing is solved for any more.
                Ok(()) => evaluate(problem),
                Err(error) => Err(error),
            };
            let rejected = trial.as_ref().map_or(f64::NAN, |t| t.measure);
            match trial {
                Ok(new)
                    if new.is_finite()
                        && increment.is_finite()
                        && self.within_tolerance(new)
                        && new.measure * o.polish_factor <= norms.measure =>
                {
                    self.record(new, increment, 1.0);
                    let paid = new.measure <= o.polish_factor * norms.measure;
                    norms = new;
                    if !paid {
                        return Ok(StopReason::ConvergedToRoundOff);
                    }
                }
                _ => {
                    // Clearly worse than before: restore the last iterate.
                    problem.update(0.0)?;
                    if o.tangent_at_solution { assemble(problem) } else { evaluate(problem) }?;
                    self.record(Norms { residual: rejected, ..norms }, increment, 0.0);
                    return Ok(StopReason::Converged);
                }
            }
        }
        Ok(StopReason::Converged)
    }

    /// Relative residual of the linear equations that leaves [`SHARE_OF_LINEAR_RESIDUAL`] of the tolerance.
    fn enough(&self, norms: Norms) -> f64 {
        let o = self.options;
        let residual = (o.absolute_tolerance + o.relative_tolerance * norms.scale) / norms.residual;
        SHARE_OF_LINEAR_RESIDUAL * residual.min(o.relative_tolerance / norms.violation)
    }

    /// Whether the iteration cycles: the last two residuals are equal to those of two or of three iterations before, all after full steps.
    fn cycles(&self) -> bool {
        (2..=3).any(|period| {
            let Some(last) = self.records.last_chunk::<5>().map(|last| &last[3 - period..]) else { return false };
            let same = |a: &IterationRecord, b: &IterationRecord| {
                let (a, b) = (a.relative_residual(), b.relative_residual());
                (a - b).abs() <= SAME_RESIDUAL * a
            };
            last.iter().all(|record| record.step_length == 1.0)
                && same(&last[period], &last[0])
                && same(&last[period + 1], &last[1])
        })
    }

    /// One step along the increment: `first` times the increment, or less if the line search reduces it.
    fn step<P: NewtonProblem>(
        &self,
        problem: &mut P,
        line_search: LineSearch,
        previous: Norms,
        (first, start): (f64, Option<LineStart>),
    ) -> Result<Trial, P::Error> {
        if let (Some(start), LineSearch::Best { reduction, max_reductions }) = (start, line_search) {
            return self.descend(problem, previous, (first, reduction, max_reductions), start);
        }
        // Along an increment that leads down, from where no constraint is violated.
        let start = match line_search {
            LineSearch::Slope { .. } if previous.violation <= self.options.relative_tolerance => problem.slope(),
            _ => 0.0,
        };
        let full = match problem.update(first) {
            Ok(()) => assemble(problem),
            Err(error) => Err(error),
        };
        let (max_growth, small, reduction, max_reductions, take_best) = match line_search {
            LineSearch::Backtracking { max_growth, small, reduction, max_reductions }
            | LineSearch::Slope { max_growth, small, reduction, max_reductions } => {
                (max_growth, small, reduction, max_reductions, false)
            }
            LineSearch::Best { reduction, max_reductions } => (1.0, 0.0, reduction, max_reductions, true),
            LineSearch::Off => {
                let norms = full?;
                return Ok(self.taken(norms, first));
            }
        };
        if start < 0.0
            && let Ok(norms) = &full
            && norms.is_finite()
            && !self.within_tolerance(*norms)
            && let slope = problem.slope()
            && slope > -OVERSHOOT * start
        {
            return self.follow_slope(problem, (first, max_reductions), [start, slope]);
        }
        let limit = max_growth * previous.measure.max(small * previous.scale);
        // Any step is acceptable then: every one brings constraint forces that were zero before.
        let unbounded = self.begins_in_balance(previous);
        let mut last_error = None;
        let mut best = (f64::INFINITY, first);
        match full {
            // Also below the tolerance: a residual at round-off may grow by any factor.
            Ok(norms) if norms.is_finite() && (norms.measure <= limit || self.within_tolerance(norms) || unbounded) => {
                return Ok(self.taken(norms, first));
            }
            Ok(norms) => best.0 = if norms.is_finite() { norms.measure } else { f64::INFINITY },
            Err(error) if problem.is_recoverable(&error) => last_error = Some(error),
            Err(error) => return Err(error),
        }
        let mut length = first;
        for _ in 0..max_reductions {
            length *= reduction;
            let trial = match problem.update(length) {
                Ok(()) => {
                    problem.residual_norms().map(|r| measure(r.residual, previous.scale, problem.relative_violation()))
                }
                Err(error) => Err(error),
            };
            match trial {
                Ok(residual) if residual <= limit || unbounded => {
                    let norms = assemble(problem)?;
                    return Ok(self.taken(norms, length));
                }
                Ok(residual) => {
                    last_error = None;
                    if residual < best.0 {
                        best = (residual, length);
                    }
                }
                Err(error) if problem.is_recoverable(&error) => last_error = Some(error),
                Err(error) => return Err(error),
            }
        }
        if take_best && best.0.is_finite() {
            problem.update(best.1)?;
            let norms = assemble(problem)?;
            return Ok(self.taken(norms, best.1));
        }
        last_error.map_or(Ok(Trial::NotAcceptable), Err)
    }

    /// A step along an increment whose full length goes too far: false position on the slope, which is `[at the start, at the full length]`.
    fn follow_slope<P: NewtonProblem>(
        &self,
        problem: &mut P,
        (first, trials): (f64, u32),
        [start, end]: [f64; 2],
    ) -> Result<Trial, P::Error> {
        let (mut low, mut high) = ((0.0, start), (first, end));
        let mut length = first;
        for _ in 0..trials {
            let part = (low.1 / (low.1 - high.1)).clamp(0.1, 0.9);
            length = low.0 + part * (high.0 - low.0);
            let slope = match problem.update(length).and_then(|()| problem.residual_norms()) {
                Ok(_) => problem.slope(),
                Err(error) if problem.is_recoverable(&error) => f64::INFINITY,
                Err(error) => return Err(error),
            };
            if slope.is_nan() {
                return Ok(Trial::NotFinite);
            }
            if slope <= -OVERSHOOT * start && slope >= ENOUGH * start {
                break;
            }
            if slope < 0.0 { low = (length, slope) } else { high = (length, slope.min(-1e3 * start)) }
        }
        let norms = assemble(problem)?;
        Ok(self.taken(norms, length))
    }

    /// An accepted step without a potential.
    fn taken(&self, norms: Norms, length: f64) -> Trial {
        if norms.is_finite() { Trial::Taken { norms, length, lower: false } } else { Trial::NotFinite }
    }

    /// One step along an increment along which the potential falls: line search on the potential.
    fn descend<P: NewtonProblem>(
        &self,
        problem: &mut P,
        previous: Norms,
        (first, reduction, max_reductions): (f64, f64, u32),
        start: LineStart,
    ) -> Result<Trial, P::Error> {
        let mut last_error = None;
        // The longest step with a sufficient decrease.
        let mut down = None;
        let mut length = first;
        for trial in 0..=MAX_REDUCTIONS_ON_POTENTIAL {
            let norms = match problem.update(length) {
                Ok(()) if trial == 0 => assemble(problem),
                Ok(()) => problem.residual_norms().map(|norms| {
                    Norms::new(ResidualNorms { scale: previous.scale, ..norms }, problem.relative_violation())
                }),
                Err(error) => Err(error),
            };
            match norms.and_then(|norms| problem.potential().map(|potential| (norms, potential))) {
                Ok((norms, Some(potential))) if norms.is_finite() => {
                    last_error = None;
                    let goes_down = start.is_descent(potential, length, problem.slope())
                        || trial == MAX_REDUCTIONS_ON_POTENTIAL
                        || trial == 0 && self.within_tolerance(norms);
                    let is_smaller = norms.measure <= (1.0 - SUFFICIENT_DECREASE * length) * previous.measure;
                    let lower = start.is_lower(potential);
                    if goes_down && down.is_none() {
                        down = Some((length, lower));
                    }
                    if !potential.is_fixed && is_smaller {
                        down = Some((length, lower));
                    } else if !potential.is_fixed && trial < max_reductions {
                        length *= reduction;
                        continue;
                    }
                    if let Some((taken, lower)) = down {
                        if taken != length {
                            problem.update(taken)?;
                        }
                        let norms = if trial == 0 { norms } else { assemble(problem)? };
                        return Ok(if norms.is_finite() {
                            Trial::Taken { norms, length: taken, lower }
                        } else {
                            Trial::NotFinite
                        });
                    }
                }
                Ok(_) => last_error = None,
                Err(error) if problem.is_recoverable(&error) => last_error = Some(error),
                Err(error) => return Err(error),
            }
            length *= reduction;
        }
        last_error.map_or(Ok(Trial::NotAcceptable), Err)
    }

    /// Whether `previous` is the first iterate of this solution (of a step, or after a change of constraints), and only constraints are violated there.
    fn begins_in_balance(&self, previous: Norms) -> bool {
        self.records.len() == 1 && previous.residual < BALANCED_RESIDUAL * previous.measure
    }

    fn within_tolerance(&self, norms: Norms) -> bool {
        let o = self.options;
        norms.residual <= o.absolute_tolerance + o.relative_tolerance * norms.scale
            && norms.violation <= o.relative_tolerance
    }

    fn record(&mut self, norms: Norms, increment: f64, step_length: f64) {
        let Norms { residual, scale, violation, .. } = norms;
        self.records.push(IterationRecord { residual, scale, violation, increment, step_length });
    }
}
