//! Loads that are applied in full at the start: smaller steps do not divide them.

use super::Simulation;
use crate::StepError;
use crate::switches::Acting;

impl Simulation {
    /// Loads that act with their whole present value in the next step whatever its size, by their numbers in `Model::loads`: in statics those that are not zero where
    /// the run, or the stage that switches them on, begins.
    pub fn loads_at_once(&self) -> &[usize] {
        if self.how.scheme.is_none() { &self.stage.sudden } else { &[] }
    }

    /// Loads that are to act and begin at the present time with another value than zero; none of what acted `before`.
    pub(super) fn sudden_loads(&self, acting: &Acting, before: Option<&Acting>) -> Vec<usize> {
        let begins = |l: usize| acting.loads[l] && before.is_none_or(|before| !before.loads[l]);
        let is_there = |l: usize| {
            let magnitude = &self.model.loads[l].magnitude;
            (0..magnitude.columns()).any(|column| magnitude.value(self.state.time, column) != 0.0)
        };
        (0..self.model.loads.len()).filter(|&l| begins(l) && is_there(l)).collect()
    }

    /// What to do about loads that are applied in full at the start if a step failed at every size, as the end of a sentence.
    pub(super) fn undivided(&self, cause: &StepError) -> String {
        let is_undefined = matches!(cause, StepError::Term(fault) if fault.is_undefined());
        let deforms = is_undefined
            || matches!(
                cause,
                StepError::NotConverged { .. }
                    | StepError::InsideOut { .. }
                    | StepError::ActiveSet { .. }
                    | StepError::Cycling { .. }
            );
        let names: Vec<&str> = self.loads_at_once().iter().map(|&l| self.model.loads[l].name.as_str()).collect();
        if !deforms || names.is_empty() {
            return String::new();
        }
        let (is, them) = if names.len() == 1 { ("is", "it") } else { ("are", "them") };
        format!(
            "; {} {is} applied in full at the start, which smaller steps do not change: give {them} as a table that begins with zero, so that every step adds a part",
            names.join(", ")
        )
    }
}
