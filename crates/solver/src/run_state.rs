//! What a run carries from step to step, beside positions and velocities; what a checkpoint has of it.

use crate::{Balance, Books, Decision, Departure, Release, Switches, Timings};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stoss_term::{HeldNodes, SurfaceForce};

/// The present stage, and what does not act in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageState {
    /// Number of the stage, from 1.
    pub number: u32,
    /// Things that are switched off in it.
    pub off: Switches,
    /// What has been released.
    pub released: Vec<Release>,
    /// Where components were whose prescription was switched on and begins there.
    pub departures: Vec<Departure>,
    /// Whether the stage is static and begins with the positions of a motion, which are no equilibrium: its first step goes to one.
    pub from_motion: bool,
    /// (component, prescription, column), sorted; follows from the model.
    #[serde(skip)]
    pub(crate) prescribed: Vec<(u32, u32, u32)>,
    /// What terms are told of what acts; follows from the model.
    #[serde(skip)]
    pub(crate) held: HeldNodes,
    /// Loads that act with their whole value in the next step, see [`crate::Simulation::loads_at_once`].
    #[serde(skip)]
    pub(crate) sudden: Vec<usize>,
}

/// Multipliers and flags of the slots of each coupling in the last step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlotState {
    /// Pressure of each slot.
    pub pressures: Vec<Vec<f64>>,
    /// Mean pressures of the slots, see [`crate::Simulation::mean_pressures`]; empty where the law of impact did not act in the last step.
    pub mean_pressures: Vec<Vec<f64>>,
    /// Whether each slot acts.
    pub active: Vec<Vec<bool>>,
}

/// Energies and momenta.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Momenta and energies of the last step.
    pub balance: Balance,
    /// Energy that each coupling stores, and the part of it in springs of friction.
    pub stored: Vec<[f64; 2]>,
    /// Books of the steps of this process.
    #[serde(skip)]
    pub(crate) books: Books,
    /// Stored energies of bodies and parts; empty where they are not known.
    #[serde(skip)]
    pub(crate) energies: Vec<f64>,
}

/// Forces at nodes in the last step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NodalForces {
    /// Forces of supports.
    pub reactions: Vec<f64>,
    /// Forces of contact, see [`crate::Simulation::contact_force`].
    pub contact: Vec<f64>,
    /// What [`crate::Simulation::moved_contact_force`] tells.
    #[serde(skip)]
    pub(crate) moved: BTreeMap<u32, SurfaceForce>,
    /// Embedded nodes that have a contact force.
    #[serde(skip)]
    pub(crate) pushed: Vec<u32>,
}

/// Times, decisions and counts of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Log {
    /// Seconds.
    pub timings: Timings,
    /// Decisions so far.
    pub decisions: Vec<Decision>,
    /// Linear solves, failed attempts included.
    pub solves: u64,
}
