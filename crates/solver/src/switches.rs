//! What of a model acts: switches of stages, releases.

use crate::{Coupling, Model};
use serde::{Deserialize, Serialize};
use stoss_contact::{Auxiliary, Constraint, ContactError, LocalContribution, Report, SlotReport, StepConfiguration};

/// What does not act in a stage, by its index in the [`Model`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Switches {
    /// Loads (gravity is one).
    pub loads: Vec<usize>,
    /// Prescriptions; their components are free.
    pub prescriptions: Vec<usize>,
    /// Contact pairs, ties, joints, potentials.
    pub contacts: Vec<usize>,
}

/// What stops acting for the rest of the run, by its index in the [`Model`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Release {
    /// A bilateral constraint of `Model::contacts`: a joint, a tie.
    Constraint(usize),
    /// A prescription of `Model::prescriptions`; its components are free then.
    Prescription(usize),
}

/// For each load, prescription and contact pair of a model whether it acts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Acting {
    pub loads: Vec<bool>,
    pub prescriptions: Vec<bool>,
    pub contacts: Vec<bool>,
}

impl Acting {
    /// All that neither `off` nor `released` names; the words for what does not exist.
    pub fn new(model: &Model, off: &Switches, released: &[Release]) -> Result<Self, String> {
        let mut acting = Self {
            loads: vec![true; model.loads.len()],
            prescriptions: vec![true; model.prescriptions.len()],
            contacts: vec![true; model.contacts.len()],
        };
        let constraints = released.iter().filter_map(|r| if let Release::Constraint(i) = r { Some(*i) } else { None });
        let supports = released.iter().filter_map(|r| if let Release::Prescription(i) = r { Some(*i) } else { None });
        clear(&mut acting.loads, "load", off.loads.iter().copied())?;
        clear(&mut acting.prescriptions, "prescription", off.prescriptions.iter().copied().chain(supports))?;
        clear(&mut acting.contacts, "contact or constraint", off.contacts.iter().copied().chain(constraints))?;
        Ok(acting)
    }
}

fn clear(flags: &mut [bool], what: &str, indices: impl Iterator<Item = usize>) -> Result<(), String> {
    let count = flags.len();
    for index in indices {
        *flags.get_mut(index).ok_or_else(|| format!("there is no {what} {index}; the model has {count}"))? = false;
    }
    Ok(())
}

/// A coupling that is switched off: it keeps its slots and what it carries from step to step, and does nothing.
#[derive(Debug)]
pub struct Silent(pub(crate) Box<Coupling>);

impl Report for Silent {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn length_scale(&self) -> f64 {
        self.0.length_scale()
    }
    fn report(&self, _q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        Ok(Vec::new())
    }
}

impl Constraint for Silent {
    fn slot_count(&self) -> usize {
        self.0.slot_count()
    }
    fn slot_weight(&self, slot: usize) -> f64 {
        self.0.slot_weight(slot)
    }
    fn is_symmetric(&self, _rule: stoss_contact::ContactRule) -> bool {
        true
    }
    fn stencils(&self, _active: &[bool], _visit: &mut dyn FnMut(&[u32], &[u32])) {}
    fn assemble(
        &self,
        _step: StepConfiguration<'_>,
        _pressures: &[f64],
        _active: &[bool],
        _want_tangent: bool,
        _visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        Ok(())
    }
    fn auxiliaries(&self) -> &[Auxiliary] {
        self.0.auxiliaries()
    }
}

impl Coupling {
    /// Switches it on or off.
    pub(crate) fn set_acting(&mut self, acting: bool) {
        if acting != self.is_off() {
            return;
        }
        // A potential of nothing takes its place for a moment; it holds no memory.
        let old = std::mem::replace(self, Self::potential(Nothing));
        *self = match old {
            Self::Off(silent) => *silent.0,
            other => Self::Off(Silent(Box::new(other))),
        };
    }
}

/// No forces.
#[derive(Debug)]
struct Nothing;

impl stoss_contact::Potential for Nothing {
    fn name(&self) -> &str {
        "nothing"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn begin_step(&mut self, _q_n: &[f64], _reach: f64) -> Result<(), ContactError> {
        Ok(())
    }
    fn stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}
    fn assemble(
        &self,
        _step: StepConfiguration<'_>,
        _want_tangent: bool,
        _visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        Ok(())
    }
    fn energy(&self, _q: &[f64]) -> Result<f64, ContactError> {
        Ok(0.0)
    }
}
