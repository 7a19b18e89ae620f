//! One attempted step: predictor, Newton with a fixed active set, active-set update, repeat.

use crate::assembly::System;
use crate::diagnosis::{largest_residual, slot_name, slot_place};
use crate::failure::AttemptLog;
use crate::iterate::Iterate;
use crate::problem::{Known, StepProblem, start_auxiliaries};
use crate::{CouplingTerm, Decision, DecisionKind, Model, NewtonRow, Phase, StepError, Timings};
use stoss_contact::active_set::ActiveSetTolerance;
use stoss_contact::{ActiveSetControl, ActiveSetOutcome};
use stoss_integrators::Step;
use stoss_newton::{NewtonOptions, NewtonReport, ResidualNorms, StopReason, solve};

/// Largest number of solutions in a step, each with a fixed active set and fixed pairings: room for 20 changes of the
/// set with as many changes of pairings alone in between (theory/constraints#eq-active-set).
const MAX_ROUNDS: usize = 40;

/// Relative residual at which the active set is updated for the first time. The set is settled long before the last digits are;
/// iterating to the end for each trial set would cost two to three solves each. (Two tori with friction: 71 solves for ten steps with 1e-4, 60 with
/// 1e-2, 67 with 1e-1.)
const LOOSE_TOLERANCE: f64 = 1.0e-2;

/// Iterates of a quasi-static step after which the active set is updated without waiting for a solution (theory/constraints#looks).
/// A set that has not settled by then is changed at solutions only, with a memory against cycling.
const EARLY_CHECKS: u32 = 8;

/// Outcome of a successful attempt.
pub(crate) struct Attempt {
    pub iterate: Iterate,
    pub newton: Vec<NewtonRow>,
    pub repaired: usize,
    /// Directions in which the energy falls, see [`crate::StepRecord::unstable`].
    pub unstable: usize,
}

/// What an attempt needs from the run.
pub(crate) struct StepInput<'a> {
    pub step: Step<'a>,
    pub start: Iterate,
    /// Prescribed components with their new positions.
    pub prescribed: Vec<(usize, f64)>,
    /// Whether `start` has the old ones and the others are to follow ([`StepProblem::predict`]).
    pub predict: bool,
    pub newton: NewtonOptions,
}

fn not_converged(report: &NewtonReport, model: &Model, system: &System, iterate: &Iterate) -> StepError {
    let accepted = report.accepted();
    let of_constraints = accepted.is_some_and(|record| record.violation * record.scale > record.residual);
    let (place, at) = largest_residual(model, system, iterate, of_constraints);
    StepError::NotConverged {
        reason: report.reason.to_string(),
        iterations: report.iteration_count(),
        residual: accepted.map_or(f64::NAN, |record| record.relative_residual()),
        place,
        at: Box::new(at),
    }
}

/// The active sets of an attempt.
struct ActiveSets {
    controls: Vec<ActiveSetControl>,
    gaps: Vec<Vec<f64>>,
    /// `c` of each slot.
    factors: Vec<Vec<f64>>,
    /// Rounds that changed the set, changes of pairings.
    changes: usize,
    repairs: usize,
}

/// Result of an update of the active sets and pairings.
#[derive(Clone, Copy, Default)]
struct SetUpdate {
    /// Slots and pairings changed.
    changes: usize,
    /// A set came back: the next solution must be accurate.
    doubtful: bool,
}

impl ActiveSets {
    fn new(model: &Model, iterate: &Iterate) -> Self {
        let control =
            |pair: &CouplingTerm| ActiveSetControl::new(ActiveSetTolerance::for_length_scale(pair.term.length_scale()));
        let gaps: Vec<Vec<f64>> = iterate.pressures.iter().map(|p| vec![0.0; p.len()]).collect();
        Self {
            controls: model.contacts.iter().map(control).collect(),
            factors: model.contacts.iter().zip(&gaps).map(|(c, gaps)| vec![c.complementarity; gaps.len()]).collect(),
            gaps,
            changes: 0,
            repairs: 0,
        }
    }

    /// Updates the active set and renews pairings at a converged iterate.
    fn update(
        &mut self,
        model: &mut Model,
        iterate: &mut Iterate,
        trace: &mut AttemptLog,
    ) -> Result<SetUpdate, StepError> {
        let mut update = SetUpdate::default();
        for c in 0..model.contacts.len() {
            let Some(method) = model.contacts[c].unilateral_mut() else { continue };
            let (active, pressures) = (&mut iterate.active[c], &mut iterate.pressures[c]);
            method.complementarity_gaps(&iterate.q, active, &mut self.gaps[c])?;
            trace.begin(active);
            let outcome = self.controls[c].propose(active, pressures, &self.gaps[c], &self.factors[c]);
            trace.end(c, active);
            let (activated, released) = match outcome {
                ActiveSetOutcome::Unchanged | ActiveSetOutcome::Cycling => (0, 0),
                ActiveSetOutcome::Changed { activated, released } | ActiveSetOutcome::Union { activated, released } => {
                    (activated, released)
                }
            };
            update.doubtful |= matches!(outcome, ActiveSetOutcome::Union { .. });
            for (p, active) in pressures.iter_mut().zip(active.iter()) {
                if !active {
                    *p = 0.0;
                }
            }
            let repairs = method.repair(&iterate.q, active)?;
            self.changes += usize::from(activated + released > 0);
            self.repairs += repairs;
            update.changes += activated + released + repairs;
            if repairs > activated {
                // A slot that closes gets its pairing. All beyond that are changes of the constraints under which the sets were judged.
                self.controls[c].reset();
            } else if outcome == ActiveSetOutcome::Cycling {
                return Err(self.cycling(model, c, &iterate.q));
            }
        }
        Ok(update)
    }

    /// Updates the active set at an iterate, without memory; returns how many slots changed.
    fn follow(&mut self, model: &Model, iterate: &mut Iterate, trace: &mut AttemptLog) -> Result<usize, StepError> {
        let mut changes = 0;
        for (c, pair) in model.contacts.iter().enumerate() {
            let Some(method) = pair.unilateral() else { continue };
            let (active, pressures) = (&mut iterate.active[c], &mut iterate.pressures[c]);
            method.complementarity_gaps(&iterate.q, active, &mut self.gaps[c])?;
            trace.begin(active);
            changes += self.controls[c].follow(active, pressures, &self.gaps[c], &self.factors[c]);
            trace.end(c, active);
            for (p, active) in pressures.iter_mut().zip(active.iter()) {
                if !active {
                    *p = 0.0;
                }
            }
        }
        Ok(changes)
    }

    fn cycling(&self, model: &Model, pair: usize, q: &[f64]) -> StepError {
        let flipping = self.controls[pair].flipping();
        StepError::Cycling {
            pair: model.contacts[pair].name.clone(),
            count: flipping.len(),
            first: flipping.first().map(|&slot| slot_name(model, pair, slot, q)).unwrap_or_default(),
            at: flipping.first().map(|&slot| Box::new(slot_place(model, pair, slot, q))).unwrap_or_default(),
            changes: self.changes,
            repairs: self.repairs,
        }
    }
}

/// Tries the step; its rows follow those that `trace` has. The pairings of `model.contacts` and the pattern of `system` are left in the state of the last iteration. `trace` has
/// what was done, also of an attempt that fails.
pub(crate) fn attempt(
    model: &mut Model,
    system: &mut System,
    input: StepInput<'_>,
    timings: &mut Timings,
    trace: &mut AttemptLog,
) -> Result<Attempt, StepError> {
    let mut iterate = input.start;
    let mut sets = ActiveSets::new(model, &iterate);
    let mut update = SetUpdate::default();
    let has_contact = model.has_unilateral_contact();
    let rows_before = trace.newton.len();
    // What earlier steps factorised would show in the last bits, and a run that is resumed knows nothing of it.
    system.solver.forget();
    system.excess = 0;
    if !model.contacts.is_empty() {
        timings.measure(Phase::Assembly, || system.begin_pattern(model, &iterate.active))?;
        timings.measure(Phase::Contact, || start_auxiliaries(model, &input.step, &mut iterate))?;
    }
    system.base.has_linearised = false;
    if input.predict || model.keeps_apart() {
        let start = (!input.predict).then(|| iterate.clone());
        if start.is_some() {
            iterate.go_back(&input.step.state_n.q, &model.embedding);
        }
        let iterate = &mut iterate;
        let mut problem = StepProblem::new(model, system, input.step, iterate, timings, &mut trace.solves);
        match start {
            Some(start) => problem.go_apart(&start, &input.prescribed)?,
            None => problem.predict_all(&input.prescribed)?,
        }
        start_auxiliaries(model, &input.step, iterate)?;
    }
    // Where forces do not depend on the end of the step, the first iterate is the solution, and what is left of the residual is their round-off.
    let polish = if input.step.rule.force.rule.reads_end() { input.newton.polish } else { 0 };
    let newton = NewtonOptions { polish, ..input.newton };
    // After a set came back, only accurate solutions are judged.
    let (mut loose, mut accurate) = (has_contact, false);
    let mut known = Known::Nothing;
    let mut early = if has_contact && !input.step.rule.has_inertia() { EARLY_CHECKS } else { 0 };
    for _ in 0..MAX_ROUNDS + EARLY_CHECKS as usize {
        let options = if loose {
            NewtonOptions {
                relative_tolerance: LOOSE_TOLERANCE.max(newton.relative_tolerance),
                polish: 0,
                // In statics only a solution tells what a set leads to: at the start of a step, as after a change of the set, a load that is light
                // against the stiffness leaves a residual within the loose tolerance and pressures that say nothing yet.
                min_iterations: u32::from(
                    (update.changes > 0 || trace.newton.len() == rows_before) && !input.step.rule.has_inertia(),
                ),
                max_iterations: if early > 0 { 1 } else { newton.max_iterations },
                ..newton
            }
        } else {
            newton
        };
        let mut problem = StepProblem::new(model, system, input.step, &mut iterate, timings, &mut trace.solves);
        problem.known = known;
        problem.accuracy.ends_at_tolerance = !loose && newton.polish == 0;
        let options = NewtonOptions { tangent_at_solution: problem.counts_directions(), ..options };
        let result = solve(&mut problem, &options);
        let unstable = if result.is_ok() && !loose { problem.unstable_directions() } else { 0 };
        // What follows changes the set, pairings and multipliers, but no positions.
        known = problem.known;
        let report = match &result {
            Ok(report) => report,
            Err(failure) => failure.report(),
        };
        let active = iterate.active.iter().flatten().filter(|&&a| a).count();
        for (k, record) in report.iterations.iter().enumerate() {
            // A further Newton call starts where the last one stopped: its first residual is a new row only if the
            // constraints changed.
            if k == 0 && update.changes == 0 && trace.newton.len() > rows_before {
                continue;
            }
            trace.newton.push(NewtonRow {
                iteration: trace.newton.len() as u32,
                residual: record.relative_residual(),
                increment: record.increment,
                active,
                changes: if k == 0 { update.changes } else { 0 },
            });
        }
        let last = report.accepted().map(|r| ResidualNorms { residual: r.residual, scale: r.scale });
        match result {
            Ok(report) if report.reason.is_converged() => {}
            Err(stoss_newton::NewtonFailure::NotConverged(report))
                if loose && early > 0 && report.reason == StopReason::MaxIterations =>
            {
                early -= 1;
                let changes = timings.measure(Phase::Search, || sets.follow(model, &mut iterate, trace))?;
                update = SetUpdate { changes, doubtful: false };
                if changes > 0 {
                    timings.measure(Phase::Assembly, || system.renew_pattern(model, &iterate.active))?;
                    start_auxiliaries(model, &input.step, &mut iterate)?;
                } else if known == Known::WithoutCouplings {
                    known = last.map_or(known, Known::All);
                }
                continue;
            }
            Ok(report) => return Err(not_converged(&report, model, system, &iterate)),
            Err(stoss_newton::NewtonFailure::Problem { error, .. }) => return Err(error),
            Err(stoss_newton::NewtonFailure::NotConverged(report)) => {
                return Err(not_converged(&report, model, system, &iterate));
            }
        }
        if !has_contact {
            return Ok(Attempt { iterate, newton: std::mem::take(&mut trace.newton), repaired: 0, unstable });
        }
        update = timings.measure(Phase::Search, || sets.update(model, &mut iterate, trace))?;
        accurate |= update.doubtful;
        if update.changes > 0 {
            timings.measure(Phase::Assembly, || system.renew_pattern(model, &iterate.active))?;
            timings.measure(Phase::Contact, || start_auxiliaries(model, &input.step, &mut iterate))?;
            loose = !accurate;
        } else if loose {
            // The next iteration starts from what was assembled last.
            loose = false;
            if known == Known::WithoutCouplings {
                known = last.map_or(known, Known::All);
            }
        } else if !update.doubtful {
            let newton = std::mem::take(&mut trace.newton);
            return Ok(Attempt { iterate, newton, repaired: sets.repairs, unstable });
        }
    }
    Err(StepError::ActiveSet { rounds: MAX_ROUNDS, changes: sets.changes, repairs: sets.repairs })
}

/// A record of a decision.
pub(crate) fn decision(step: u64, time: f64, dt: f64, kind: DecisionKind, reason: impl Into<String>) -> Decision {
    Decision { step, time, dt, kind, reason: reason.into() }
}
