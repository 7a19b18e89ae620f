//! What output shows of the states of a law. Not how it gets to nodes and places in elements (`recovery`).

use crate::SolidBody;
use stoss_continuum::StateOutput;

/// Where an output is among all numbers that output shows of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputPlace {
    pub(crate) first: usize,
    /// Number of components of the output.
    pub len: usize,
    /// Number of components of all outputs.
    pub(crate) all: usize,
    pub(crate) jumps: bool,
}

impl SolidBody {
    /// What output shows of the states.
    pub fn state_outputs(&self) -> &[StateOutput] {
        self.history().map_or(&[], |material| material.outputs())
    }

    /// Where an output is among all numbers of a point, by its name; nothing if the law has none of this name.
    pub fn state_output(&self, name: &str) -> Option<OutputPlace> {
        let (mut first, mut found) = (0, None);
        for output in self.state_outputs() {
            if output.entry.name == name {
                found = Some((first, output));
            }
            first += output.entry.len;
        }
        let (at, output) = found?;
        Some(OutputPlace { first: at, len: output.entry.len, all: first, jumps: output.jumps })
    }

    /// Writes all numbers of [`Self::state_outputs`] of a state.
    pub(crate) fn write_outputs(&self, before: &[f64], state: &[f64], out: &mut [f64]) {
        if let Some(material) = self.history() {
            material.output(before, state, out);
        }
    }
}
