//! A static step of bodies that contact alone holds and that nothing touches yet: springs hold them, whose stiffness falls to nothing inside the step (theory/constraints#anchored).

use crate::anchor::Anchor;
use crate::assembly::System;
use crate::failure::AttemptLog;
use crate::problem::StepProblem;
use crate::step::{Attempt, StepInput, attempt};
use crate::{Model, StepError, Timings};
use stoss_newton::NewtonOptions;

/// Stiffness of the springs in parts of the mean diagonal of the tangent, one solution after the other.
const STIFFNESSES: [f64; 5] = [1.0e-2, 1.0e-3, 1.0e-4, 1.0e-5, 1.0e-6];

/// Stiffnesses that follow these if the matrix without springs is singular then: where one body is far stiffer than what it comes to rest on, the mean is that of the stiff one.
const WEAKER: [f64; 5] = [1.0e-7, 1.0e-8, 1.0e-9, 1.0e-10, 1.0e-11];

/// Relative tolerance of the solutions with springs.
const TOLERANCE: f64 = 1.0e-4;

impl StepProblem<'_> {
    /// Adds the forces of the springs to the residual, and to the matrix if it is new.
    pub(crate) fn add_anchor(&mut self, want_tangent: bool) {
        let Some(mut anchor) = self.system.present.anchor.take() else { return };
        if want_tangent && anchor.stiffness == 0.0 {
            anchor.stiffness = anchor.part * self.mean_diagonal();
        }
        let s = &mut *self.system;
        for &component in &s.matrix.numbering.free {
            let c = component as usize;
            s.buffers.residual[c] += anchor.stiffness * (self.iterate.q[c] - anchor.from[c]);
        }
        if want_tangent {
            let diagonal: Vec<(usize, f64)> = s.matrix.diagonal().collect();
            diagonal.iter().for_each(|&(at, value)| s.matrix.values_mut()[at] = value + anchor.stiffness);
        }
        s.present.anchor = Some(anchor);
    }
}

/// Tries the step as [`attempt`] does, from where springs have led it.
pub(crate) fn attempt_anchored(
    model: &mut Model,
    system: &mut System,
    input: StepInput<'_>,
    timings: &mut Timings,
    trace: &mut AttemptLog,
) -> Result<Attempt, StepError> {
    let StepInput { step, mut start, prescribed, mut predict, newton } = input;
    let loose = NewtonOptions { relative_tolerance: TOLERANCE.max(newton.relative_tolerance), polish: 0, ..newton };
    // That it is in balance does not tell that it is held: the matrix does.
    let last = NewtonOptions { min_iterations: newton.min_iterations.max(1), ..newton };
    let mut singular = None;
    for (k, &part) in STIFFNESSES.iter().chain(&WEAKER).enumerate() {
        system.present.anchor = Some(Anchor { part, stiffness: 0.0, from: start.q.clone() });
        let input = StepInput { step, start, prescribed: prescribed.clone(), predict, newton: loose };
        let found = attempt(model, system, input, timings, trace);
        system.present.anchor = None;
        let found = match (found, singular) {
            (Err(_), Some(first)) => return Err(first),
            (found, first) => {
                singular = first;
                found?
            }
        };
        trace.newton = found.newton;
        (start, predict) = (found.iterate, false);
        if k + 1 < STIFFNESSES.len() {
            continue;
        }
        let input = StepInput { step, start: start.clone(), prescribed: prescribed.clone(), predict, newton: last };
        match attempt(model, system, input, timings, trace) {
            Err(error @ StepError::Singular { .. }) => singular = singular.or(Some(error)),
            found => return found,
        }
    }
    // The loop ends with a singular matrix alone.
    let input = StepInput { step, start, prescribed, predict, newton: last };
    singular.map_or_else(|| attempt(model, system, input, timings, trace), Err)
}
