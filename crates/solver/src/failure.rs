//! Records of attempted steps that failed, from which the cause can be found.
//!
//! Not a diagnosis: what the facts mean for a scene is not known here.

use crate::error::StepError;
use crate::shares::RankFault;
use crate::{Model, NewtonRow, Place};
use serde::{Deserialize, Serialize};
use stoss_fe_solid::SolidError;

/// Most slots of a failed attempt whose changes are kept.
const MOST_SLOTS: usize = 8;

/// Kind of failure; see [`StepError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum FailureKind {
    /// An element is inverted at a Gauss point.
    InvertedElement,
    /// Elements are turned inside out at a vertex.
    InsideOut,
    /// Newton did not converge.
    NotConverged,
    /// The matrix is singular.
    Singular,
    /// The active set cycles.
    Cycling,
    /// The active set did not settle.
    Unsettled,
    /// A point flows by more than is allowed in a step.
    PlasticIncrement,
    /// Any other; the reason is in [`FailedAttempt::reason`].
    Other,
}

/// A slot whose state changed while an attempt was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SlotChanges {
    /// Number of the pair in [`Model::contacts`].
    pub pair: usize,
    /// Slot of the pair.
    pub slot: usize,
    /// How often it closed or opened.
    pub changes: u32,
}

/// A failed attempt at a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedAttempt {
    /// Step that was tried.
    pub step: u64,
    /// Time at its start.
    pub time: f64,
    /// Size of the step.
    pub dt: f64,
    /// Kind of the failure.
    pub kind: FailureKind,
    /// The cause as a message.
    pub reason: String,
    /// Place of the failure.
    pub place: Place,
    /// The matrix of the state at the start of a static step is singular, which no step size changes.
    pub at_any_size: bool,
    /// Newton history.
    pub newton: Vec<NewtonRow>,
    /// The slots that changed most often, those first.
    pub slots: Vec<SlotChanges>,
}

/// Record of an attempt while it is made.
#[derive(Debug, Default)]
pub(crate) struct AttemptLog {
    /// Linear solutions.
    pub solves: u32,
    pub newton: Vec<NewtonRow>,
    /// How often each slot of each pair closed or opened; empty as long as none did.
    changes: Vec<Vec<u32>>,
    before: Vec<bool>,
}

impl AttemptLog {
    /// The active set of a pair is about to change.
    pub fn begin(&mut self, active: &[bool]) {
        self.before.clear();
        self.before.extend_from_slice(active);
    }

    /// The active set of a pair may have changed since [`Self::begin`].
    pub fn end(&mut self, pair: usize, active: &[bool]) {
        if self.before == active {
            return;
        }
        if self.changes.len() <= pair {
            self.changes.resize(pair + 1, Vec::new());
        }
        let counts = &mut self.changes[pair];
        counts.resize(active.len(), 0);
        for ((count, before), now) in counts.iter_mut().zip(&self.before).zip(active) {
            *count += u32::from(before != now);
        }
    }

    /// Whether the first matrix of the attempt was singular.
    pub fn first_was_singular(&self, cause: &StepError) -> bool {
        matches!(cause, StepError::Singular { .. }) && self.solves <= 1
    }

    /// The attempt failed.
    pub fn failed(self, model: &Model, (step, time, dt): (u64, f64, f64), cause: &StepError) -> FailedAttempt {
        let changed = self.changes.iter().enumerate().flat_map(|(pair, counts)| {
            let some = counts.iter().enumerate().filter(|(_, changes)| **changes > 0);
            some.map(move |(slot, &changes)| SlotChanges { pair, slot, changes })
        });
        let mut slots: Vec<SlotChanges> = changed.collect();
        slots.sort_by_key(|slot| std::cmp::Reverse(slot.changes));
        slots.truncate(MOST_SLOTS);
        let (kind, place) = classified(model, cause);
        let (reason, newton) = (cause.to_string(), self.newton);
        FailedAttempt { step, time, dt, kind, reason, place, at_any_size: false, newton, slots }
    }
}

fn of_element(model: &Model, body: &str, element: usize) -> Place {
    let number = model.bodies.iter().position(|other| other.solid.name() == body);
    Place { element: number.map(|number| (number, element)), ..Place::default() }
}

fn classified(model: &Model, cause: &StepError) -> (FailureKind, Place) {
    match cause {
        StepError::Term(fault) => match (fault.cause(), fault.cause::<RankFault>()) {
            (None, Some(RankFault { element: Some((body, element)), .. })) => {
                (FailureKind::InvertedElement, of_element(model, body, *element))
            }
            (
                Some(
                    SolidError::InvertedElement { body, element, .. }
                    | SolidError::CollapsedElement { body, element, .. }
                    | SolidError::Constitutive { body, element, .. },
                ),
                _,
            ) => (FailureKind::InvertedElement, of_element(model, body, *element)),
            _ => (FailureKind::Other, Place::default()),
        },
        StepError::InsideOut { body, found, .. } => {
            let place = of_element(model, body, found.element);
            let corner = |(body, element): (usize, usize)| {
                model.bodies[body].solid.elements().iter().nth(element)?.get(found.node).copied()
            };
            // Elements count nodes of the model.
            (FailureKind::InsideOut, Place { node: place.element.and_then(corner), ..place })
        }
        StepError::NotConverged { at, .. } => (FailureKind::NotConverged, **at),
        StepError::Singular { at, .. } => (FailureKind::Singular, **at),
        StepError::Cycling { at, .. } => (FailureKind::Cycling, **at),
        StepError::Blocked { at, .. } => (FailureKind::Other, **at),
        StepError::PlasticIncrement { .. } => (FailureKind::PlasticIncrement, Place::default()),
        StepError::ActiveSet { .. } => (FailureKind::Unsettled, Place::default()),
        _ => (FailureKind::Other, Place::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_that_change_most_come_first() {
        let mut trace = AttemptLog::default();
        let sets = [[false, true, true], [true, true, true], [false, true, false], [true, true, false]];
        for pair in sets.windows(2) {
            trace.begin(&pair[0]);
            trace.end(1, &pair[1]);
        }
        let cause = StepError::ActiveSet { rounds: 3, changes: 3, repairs: 0 };
        let failed = trace.failed(&Model::default(), (4, 0.5, 0.1), &cause);
        let counts: Vec<_> = failed.slots.iter().map(|s| (s.pair, s.slot, s.changes)).collect();
        assert_eq!(counts, [(1, 0, 3), (1, 2, 1)]);
        assert_eq!((failed.kind, failed.step), (FailureKind::Unsettled, 4));
    }
}
