//! What is switched off in a stage, and what is released.

use serde::{Deserialize, Serialize};

/// What is switched off in a stage, by index in the model.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Switches {
    /// Loads (gravity is one).
    pub loads: Vec<usize>,
    /// Prescriptions; their components are free.
    pub prescriptions: Vec<usize>,
    /// Contact pairs, ties, joints, potentials.
    pub contacts: Vec<usize>,
    /// Parts without vectors of their own: springs, dampers.
    pub parts: Vec<usize>,
}

/// What is released for the rest of the run, by index in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Release {
    /// A bilateral constraint of `Model::contacts`: a joint, a tie.
    Constraint(usize),
    /// A prescription of `Model::prescriptions`; its components are free then.
    Prescription(usize),
    /// A part of `Model::parts` without vectors of its own: a spring, a damper.
    Part(usize),
}

/// Flags of the loads, prescriptions, contact pairs and parts of a model that act.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Acting {
    pub loads: Vec<bool>,
    pub prescriptions: Vec<bool>,
    pub contacts: Vec<bool>,
    pub parts: Vec<bool>,
}

impl Acting {
    /// What acts of so many loads, prescriptions, contact pairs and parts: all that neither `off` nor `released` names; the words for what does not exist.
    pub fn new(
        [loads, prescriptions, contacts, parts]: [usize; 4],
        off: &Switches,
        released: &[Release],
    ) -> Result<Self, String> {
        let mut acting = Self {
            loads: vec![true; loads],
            prescriptions: vec![true; prescriptions],
            contacts: vec![true; contacts],
            parts: vec![true; parts],
        };
        let constraints = released.iter().filter_map(|r| if let Release::Constraint(i) = r { Some(*i) } else { None });
        let supports = released.iter().filter_map(|r| if let Release::Prescription(i) = r { Some(*i) } else { None });
        let springs = released.iter().filter_map(|r| if let Release::Part(i) = r { Some(*i) } else { None });
        clear(&mut acting.loads, "load", off.loads.iter().copied())?;
        clear(&mut acting.prescriptions, "prescription", off.prescriptions.iter().copied().chain(supports))?;
        clear(&mut acting.contacts, "contact or constraint", off.contacts.iter().copied().chain(constraints))?;
        clear(&mut acting.parts, "part", off.parts.iter().copied().chain(springs))?;
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
