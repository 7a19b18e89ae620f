//! The iteration itself.

use crate::{
    IterationRecord, LineSearch, NewtonFailure, NewtonOptions, NewtonProblem, NewtonReport, Potential, ResidualNorms,
    StopReason,
};

/// Iterates until a stop reason applies. On success the problem's iterate is the solution. After a failure it is undefined:
/// the caller restores its last good state.
///
/// On success residual and tangent held by the problem belong to the solution, and `iterations.last()` is its record,
/// unless the last step was taken back: then its record has step length zero.
///
/// # Errors
/// [`NewtonFailure::NotConverged`] with the reason, or [`NewtonFailure::Problem`] with the problem's own error.
pub fn solve<P: NewtonProblem>(
    problem: &mut P,
    options: &NewtonOptions,
) -> Result<NewtonReport, NewtonFailure<P::Error>> {
    let mut course = Course { options, records: Vec::with_capacity(options.max_iterations as usize + 1) };
    match course.run(problem) {
        Ok(reason) if reason.is_converged() => Ok(course.report(reason)),
        Ok(reason) => Err(NewtonFailure::NotConverged(course.report(reason))),
        Err(error) => Err(NewtonFailure::Problem { error, report: course.report(StopReason::ProblemError) }),
    }
}

/// Newton's method may go round for ever among the pieces of a residual with kinks (stick and slip, the facets of a surface), each of
/// which leads to the next. A step of this length ends between them.
const SHORT_STEP: f64 = 0.5;

/// Relative difference of residuals that are taken for the same.
const SAME_RESIDUAL: f64 = 0.02;

/// A residual below this share of what the violation of constraints counts for is none. The forces that the constraints will need are still to come,
/// and neither the residual nor its scale says how large they are: contact that closes on bodies without load has both as small as one likes.
const IN_BALANCE: f64 = 1e-3;

/// A violation of constraints above this is none of round-off, however small the increment of the positions was: multipliers alone may have changed, such as that of
/// a friction that sticks and will slide.
const NO_ROUND_OFF: f64 = 1e-6;

/// At most so many reductions of a step on a potential; the last one is taken if it does not fall then, which it must but for round-off.
const MAX_DESCENTS: u32 = 20;

/// So many times the limit on iterations that go down on a lasting potential come on top of it. They lead to a minimum, which may be far where a surface snaps through or slips off; a shorter
/// load step would not bring it nearer.
const MORE_DESCENTS: u32 = 4;

/// Part of the residual by which it must at least be smaller after a full step, and after a shorter one in proportion, where a potential does not last.
const PROMISED_REST: f64 = 0.1;

/// Part of the fall that the slope of a potential promises and that a step must have at least (Armijo).
const PROMISED_FALL: f64 = 1e-4;

/// Behind a minimum the potential rises again: a step that ends where it rises by more than this part of what it fell at the start has gone too far, nearly twice as far as a parabola has its minimum.
const TOO_FAR: f64 = 0.9;

/// Potential and slope where a step begins.
#[derive(Clone, Copy)]
struct Hill {
    at_start: Potential,
    slope: f64,
}

impl Hill {
    /// Whether a step of this length that ends at `potential`, with this slope there, has gone down. Where round-off hides it, the slope tells that the step went too far.
    fn is_descent(self, potential: Potential, length: f64, slope: f64) -> bool {
        let excess = potential.value - self.at_start.value - PROMISED_FALL * length * self.slope;
        excess <= 0.0 && self.is_lower(potential)
            || excess <= self.at_start.round_off.max(potential.round_off) && slope <= -TOO_FAR * self.slope
    }

    /// Whether it is lower there by more than round-off.
    fn is_lower(self, potential: Potential) -> bool {
        potential.value < self.at_start.value - self.at_start.round_off.max(potential.round_off)
    }
}

/// Norms of an iterate.
#[derive(Clone, Copy)]
struct Norms {
    /// The larger of the residual and of the violation times the scale, of which no more than the whole counts: what has to fall.
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
    // Not `max`, which loses a residual that is NaN; a violation is looked at by `Norms::is_finite`.
    if part * scale > residual { part * scale } else { residual }
}

fn assemble<P: NewtonProblem>(problem: &mut P) -> Result<Norms, P::Error> {
    let norms = problem.assemble()?;
    Ok(Norms::new(norms, problem.relative_violation()))
}

/// What became of a step.
enum Step {
    Taken {
        norms: Norms,
        length: f64,
        /// Whether the potential fell, if there is one.
        lower: bool,
    },
    NotAcceptable,
    NotFinite,
}

struct Course<'a> {
    options: &'a NewtonOptions,
    records: Vec<IterationRecord>,
}

impl Course<'_> {
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
            if solves >= o.max_iterations + descents.min(MORE_DESCENTS * o.max_iterations) {
                return Ok(StopReason::MaxIterations);
            }
            solves += 1;
            let line_search = problem.line_search(o.line_search);
            let downhill = matches!(line_search, LineSearch::Best { .. });
            let increment = if downhill { problem.solve_downhill() } else { problem.solve() }?;
            if !increment.is_finite() {
                return Ok(StopReason::NotFinite);
            }
            let previous = norms;
            let at_start = if downhill { problem.potential()? } else { None };
            // An increment that goes uphill says that the problem could not help it.
            let hill =
                at_start.map(|at_start| Hill { at_start, slope: problem.slope() }).filter(|hill| hill.slope <= 0.0);
            let first = problem.longest_step()?.min(if self.cycles() { SHORT_STEP } else { 1.0 });
            let (length, lower) = match self.step(problem, line_search, previous, (first, hill))? {
                Step::Taken { norms: new, length, lower } => {
                    norms = new;
                    (length, lower)
                }
                Step::NotAcceptable => return Ok(StopReason::LineSearchFailed),
                Step::NotFinite => return Ok(StopReason::NotFinite),
            };
            if self.begins_in_balance(previous) {
                divergence = divergence.max(o.divergence_factor * norms.scale);
                smallest = norms.measure;
            }
            descents += u32::from(lower && at_start.is_some_and(|potential| potential.is_lasting));
            self.record(norms, increment, length);
            if self.within_tolerance(norms) {
                continue;
            }
            // Full steps only: a short step says nothing about what a full one would gain.
            let fell = norms.measure <= o.polish_factor * previous.measure || length < 1.0;
            let at_round_off = norms.measure <= o.stagnation_residual * norms.scale
                || (increment <= o.stagnation_increment * problem.iterate_norm()
                    && increment > 0.0
                    && problem.is_linearised()
                    && norms.violation <= NO_ROUND_OFF);
            if !fell && at_round_off {
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

    /// Further iterations below the tolerance. Nothing that happens here turns success into failure, but an error at the
    /// restored iterate.
    fn polish<P: NewtonProblem>(&mut self, problem: &mut P, mut norms: Norms) -> Result<StopReason, P::Error> {
        let o = self.options;
        for _ in 0..o.polish {
            if norms.measure <= o.round_off_level * norms.scale {
                return Ok(StopReason::ConvergedToRoundOff);
            }
            let Ok(increment) = problem.solve() else {
                return Ok(StopReason::Converged);
            };
            let trial = match problem.longest_step().and_then(|longest| problem.update(longest)) {
                Ok(()) => assemble(problem),
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
                    // Clearly worse than before: take it back.
                    problem.update(0.0)?;
                    problem.assemble()?;
                    self.record(Norms { residual: rejected, ..norms }, increment, 0.0);
                    return Ok(StopReason::Converged);
                }
            }
        }
        Ok(StopReason::Converged)
    }

    /// Whether the last two residuals, all after full steps, are those of the same number of iterations before, two or three.
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

    /// One step along the increment: `first` times it, or a shorter one where the line search is on and has to act.
    fn step<P: NewtonProblem>(
        &self,
        problem: &mut P,
        line_search: LineSearch,
        previous: Norms,
        (first, hill): (f64, Option<Hill>),
    ) -> Result<Step, P::Error> {
        if let (Some(hill), LineSearch::Best { reduction, max_reductions }) = (hill, line_search) {
            return self.descend(problem, previous, (first, reduction, max_reductions), hill);
        }
        let full = match problem.update(first) {
            Ok(()) => assemble(problem),
            Err(error) => Err(error),
        };
        let (max_growth, small, reduction, max_reductions, take_best) = match line_search {
            LineSearch::Backtracking { max_growth, small, reduction, max_reductions } => {
                (max_growth, small, reduction, max_reductions, false)
            }
            LineSearch::Best { reduction, max_reductions } => (1.0, 0.0, reduction, max_reductions, true),
            LineSearch::Off => {
                let norms = full?;
                return Ok(self.taken(norms, first));
            }
        };
        let limit = max_growth * previous.measure.max(small * previous.scale);
        // Then any step is as good as any other: all bring forces that were not there.
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
                Ok(()) => problem.residual_norm().map(|r| measure(r, previous.scale, problem.relative_violation())),
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
        last_error.map_or(Ok(Step::NotAcceptable), Err)
    }

    /// A step without a potential.
    fn taken(&self, norms: Norms, length: f64) -> Step {
        if norms.is_finite() { Step::Taken { norms, length, lower: false } } else { Step::NotFinite }
    }

    /// One step along an increment that goes downhill.
    fn descend<P: NewtonProblem>(
        &self,
        problem: &mut P,
        previous: Norms,
        (first, reduction, max_reductions): (f64, f64, u32),
        hill: Hill,
    ) -> Result<Step, P::Error> {
        let mut last_error = None;
        // The longest step that goes down.
        let mut down = None;
        let mut length = first;
        for trial in 0..=MAX_DESCENTS {
            let norms = match problem.update(length) {
                Ok(()) if trial == 0 => assemble(problem),
                Ok(()) => problem.residual_norm().map(|residual| {
                    Norms::new(ResidualNorms { residual, scale: previous.scale }, problem.relative_violation())
                }),
                Err(error) => Err(error),
            };
            match norms.and_then(|norms| problem.potential().map(|potential| (norms, potential))) {
                Ok((norms, Some(potential))) if norms.is_finite() => {
                    last_error = None;
                    let goes_down = hill.is_descent(potential, length, problem.slope())
                        || trial == MAX_DESCENTS
                        || trial == 0 && self.within_tolerance(norms);
                    let is_smaller = norms.measure <= (1.0 - PROMISED_REST * length) * previous.measure;
                    let lower = hill.is_lower(potential);
                    if goes_down && down.is_none() {
                        down = Some((length, lower));
                    }
                    if !potential.is_lasting && is_smaller {
                        down = Some((length, lower));
                    } else if !potential.is_lasting && trial < max_reductions {
                        length *= reduction;
                        continue;
                    }
                    if let Some((taken, lower)) = down {
                        if taken != length {
                            problem.update(taken)?;
                        }
                        let norms = if trial == 0 { norms } else { assemble(problem)? };
                        return Ok(if norms.is_finite() {
                            Step::Taken { norms, length: taken, lower }
                        } else {
                            Step::NotFinite
                        });
                    }
                }
                Ok(_) => last_error = None,
                Err(error) if problem.is_recoverable(&error) => last_error = Some(error),
                Err(error) => return Err(error),
            }
            length *= reduction;
        }
        last_error.map_or(Ok(Step::NotAcceptable), Err)
    }

    /// Whether `previous` is the first iterate of this solution (of a step, or after a change of constraints), and only constraints are violated there.
    fn begins_in_balance(&self, previous: Norms) -> bool {
        self.records.len() == 1 && previous.residual < IN_BALANCE * previous.measure
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
