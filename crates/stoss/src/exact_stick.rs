//! A warning of runs whose steps are cut again and again while friction sticks exactly.

use crate::scene::{Scene, Stick};
use stoss_solver::{Decision, DecisionKind, Simulation, StepRecord};

/// Steps cut while such friction acts from which on it is worth a warning.
const MANY_CUTS: usize = 5;

/// Start of the warning, by which a second one is avoided.
const CUT: &str = "steps were cut";

/// Counts the cuts of a run.
#[derive(Debug, Default)]
pub(crate) struct CutsOfStick {
    cuts: usize,
}

impl CutsOfStick {
    /// Warns after a step, once in a run, if many were cut while contacts with friction by multipliers were closed.
    pub fn look(&mut self, scene: &Scene, simulation: &mut Simulation, record: &StepRecord) {
        let cuts = record.decisions.iter().filter(|decision| decision.kind == DecisionKind::Cut).count();
        if cuts == 0 {
            return;
        }
        let sticks = |item: &crate::scene::Contact| {
            item.friction.as_ref().and_then(|law| law.sticking()).is_some_and(|of| of.stick() == Stick::Multiplier)
        };
        // The pairs of the scene are the first of the model.
        let acts = |c: usize| simulation.active().get(c).is_some_and(|active| active.iter().any(|&active| active));
        let contacts = scene.contacts.iter().enumerate().filter(|(c, item)| sticks(item) && acts(*c));
        let keys: Vec<String> = contacts.map(|(c, _)| format!("`contact[{c}].friction.stick = \"penalty\"`")).collect();
        if keys.is_empty() {
            return;
        }
        self.cuts += cuts;
        let is_told = |of: &Decision| of.kind == DecisionKind::Warning && of.reason.starts_with(CUT);
        if self.cuts < MANY_CUTS || simulation.decisions().iter().any(is_told) {
            return;
        }
        simulation.warn(format!(
            "{CUT} {} times while friction sticks exactly, by multipliers: if it goes on like this, set {}. A spring then holds what sticks, which converges in larger steps. This warning is given once in a run",
            self.cuts,
            keys.join(" and ")
        ));
    }
}
