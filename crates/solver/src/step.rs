//! One attempted step: predictor, Newton with a fixed active set, active-set update, repeat.

use crate::assembly::{Iterate, System};
use crate::problem::StepProblem;
use crate::{Decision, DecisionKind, Model, NewtonRow, Phase, StepError, Timings};
use stoss_contact::active_set::ActiveSetTolerance;
use stoss_contact::{ActiveSetControl, ActiveSetOutcome};
use stoss_integrators::Step;
use stoss_newton::{NewtonOptions, NewtonReport, solve};

/// Changes of the active set tried in a step before it is given up (formulation §9.1).
const MAX_SET_CHANGES: usize = 20;

/// Residual at which the active set is looked at for the first time. The set is settled long before the last digits are;
/// iterating to the end for each trial set would cost two to three solves each.
const LOOSE_TOLERANCE: f64 = 1.0e-4;

/// Outcome of a successful attempt.
pub(crate) struct Attempt {
    pub iterate: Iterate,
    pub newton: Vec<NewtonRow>,
    pub solves: u32,
    pub repaired: usize,
}

/// What an attempt needs from the run.
pub(crate) struct StepInput<'a> {
    pub step: Step<'a>,
    pub start: Iterate,
    pub newton: NewtonOptions,
}

fn not_converged(report: &NewtonReport) -> StepError {
    StepError::NotConverged {
        reason: report.reason.to_string(),
        iterations: report.iteration_count(),
        residual: report.final_residual(),
    }
}

/// Tries the step. The pairings of `model.contacts` and the pattern of `system` are left in the state of the last iteration.
pub(crate) fn attempt(
    model: &mut Model,
    system: &mut System,
    input: StepInput<'_>,
    timings: &mut Timings,
) -> Result<Attempt, StepError> {
    let mut iterate = input.start;
    let mut controls: Vec<ActiveSetControl> = model
        .contacts
        .iter()
        .map(|pair| ActiveSetControl::new(ActiveSetTolerance::for_length_scale(pair.method.length_scale())))
        .collect();
    let mut gaps: Vec<Vec<f64>> = iterate.pressures.iter().map(|p| vec![0.0; p.len()]).collect();
    let factors: Vec<Vec<f64>> =
        model.contacts.iter().zip(&gaps).map(|(pair, gaps)| vec![pair.complementarity; gaps.len()]).collect();
    let mut rows = Vec::new();
    let (mut solves, mut repaired, mut changes) = (0, 0, 0);
    let has_contact = !model.contacts.is_empty();
    if has_contact {
        system.renew_pattern(model, &iterate.active)?;
    }
    let mut loose = has_contact;
    for _ in 0..2 * MAX_SET_CHANGES {
        let options = if loose {
            NewtonOptions {
                relative_tolerance: LOOSE_TOLERANCE.max(input.newton.relative_tolerance),
                polish: 0,
                ..input.newton
            }
        } else {
            input.newton
        };
        let mut problem = StepProblem { model, system, step: input.step, iterate: &mut iterate, timings, solves: 0 };
        let result = solve(&mut problem, &options);
        solves += problem.solves;
        let report = match &result {
            Ok(report) => report,
            Err(failure) => failure.report(),
        };
        let active = iterate.active.iter().flatten().filter(|&&a| a).count();
        for (k, record) in report.iterations.iter().enumerate() {
            // A further Newton call starts where the last one stopped: its first residual is a new row only if the
            // constraints changed.
            if k == 0 && changes == 0 && !rows.is_empty() {
                continue;
            }
            rows.push(NewtonRow {
                iteration: rows.len() as u32,
                residual: record.residual,
                increment: record.increment,
                active,
                changes: if k == 0 { changes } else { 0 },
            });
        }
        match result {
            Ok(report) if report.reason.is_converged() => {}
            Ok(report) => return Err(not_converged(&report)),
            Err(stoss_newton::NewtonFailure::Problem { error, .. }) => return Err(error),
            Err(stoss_newton::NewtonFailure::NotConverged(report)) => return Err(not_converged(&report)),
        }
        if !has_contact {
            return Ok(Attempt { iterate, newton: rows, solves, repaired });
        }
        changes = 0;
        let repairs = timings.measure(Phase::Search, || -> Result<usize, StepError> {
            let mut repairs = 0;
            for (c, pair) in model.contacts.iter_mut().enumerate() {
                pair.method.complementarity_gaps(&iterate.q, &iterate.active[c], &mut gaps[c])?;
                let active = &mut iterate.active[c];
                match controls[c].propose(active, &iterate.pressures[c], &gaps[c], &factors[c]) {
                    ActiveSetOutcome::Unchanged => {}
                    ActiveSetOutcome::Changed { activated, released } => changes += activated + released,
                    ActiveSetOutcome::Cycling => return Err(StepError::ActiveSet { changes: MAX_SET_CHANGES }),
                }
                for (p, active) in iterate.pressures[c].iter_mut().zip(active.iter()) {
                    if !active {
                        *p = 0.0;
                    }
                }
                repairs += pair.method.repair(&iterate.q, active)?;
            }
            Ok(repairs)
        })?;
        repaired += repairs;
        changes += repairs;
        if changes > 0 {
            timings.measure(Phase::Assembly, || system.renew_pattern(model, &iterate.active))?;
            loose = true;
        } else if loose {
            loose = false;
        } else {
            return Ok(Attempt { iterate, newton: rows, solves, repaired });
        }
    }
    Err(StepError::ActiveSet { changes: MAX_SET_CHANGES })
}

/// A record of a decision.
pub(crate) fn decision(step: u64, time: f64, dt: f64, kind: DecisionKind, reason: impl Into<String>) -> Decision {
    Decision { step, time, dt, kind, reason: reason.into() }
}
