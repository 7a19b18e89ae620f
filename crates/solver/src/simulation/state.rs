//! What a running simulation consists of, beside its model and the system of equations.

use crate::{Balance, Books, Coupling, Decision, Departure, FailedAttempt, InsideOutRule, Model, Release, StepControl};
use crate::{Switches, Timings};
use std::collections::BTreeMap;
use stoss_integrators::Scheme;
use stoss_newton::NewtonOptions;
use stoss_term::{Support, SurfaceForce};

/// How steps are done.
#[derive(Debug)]
pub(super) struct How {
    pub control: StepControl,
    pub scheme: Option<Box<dyn Scheme>>,
    pub newton: NewtonOptions,
    pub inside_out: InsideOutRule,
}

/// The present stage, and what does not act in it.
#[derive(Clone, Debug)]
pub(super) struct StageState {
    /// Number of the stage, from 1.
    pub number: u32,
    pub off: Switches,
    pub released: Vec<Release>,
    /// (component, prescription, column), sorted.
    pub prescribed: Vec<(u32, u32, u32)>,
    /// What terms are told of what acts.
    pub support: Support,
    pub departures: Vec<Departure>,
    pub sudden: Vec<usize>,
}

/// Multipliers and flags of the slots of each coupling in the last step.
#[derive(Clone, Debug)]
pub(super) struct SlotState {
    pub pressures: Vec<Vec<f64>>,
    /// See [`crate::Simulation::mean_pressures`]; empty where the law of impact did not act in the last step.
    pub mean_pressures: Vec<Vec<f64>>,
    pub active: Vec<Vec<bool>>,
}

impl SlotState {
    /// Those that always hold are active.
    pub fn new(model: &Model) -> Self {
        let count = |pair: &Coupling| pair.term.slot_count();
        Self {
            pressures: model.contacts.iter().map(|pair| vec![0.0; count(pair)]).collect(),
            mean_pressures: Vec::new(),
            active: model.contacts.iter().map(|pair| vec![pair.bilateral().is_some(); count(pair)]).collect(),
        }
    }
}

/// Energies and momenta.
#[derive(Clone, Debug)]
pub(super) struct Ledger {
    pub balance: Balance,
    pub books: Books,
    /// Of each coupling: energy that it stores, and the part of it in springs of friction.
    pub stored: Vec<[f64; 2]>,
    /// Stored energies of bodies and parts; empty where they are not known.
    pub energies: Vec<f64>,
}

/// Forces at nodes in the last step.
#[derive(Clone, Debug)]
pub(super) struct NodalForces {
    pub reactions: Vec<f64>,
    pub contact: Vec<f64>,
    /// What [`crate::Simulation::moved_contact_force`] tells.
    pub moved: BTreeMap<u32, SurfaceForce>,
    /// Embedded nodes that have a contact force.
    pub pushed: Vec<u32>,
}

impl NodalForces {
    pub fn new(model: &Model) -> Self {
        let components = model.reference.len();
        let has_supports = model.prescriptions.iter().any(|p| !p.nodes.is_empty());
        Self {
            reactions: vec![0.0; if has_supports { components } else { 0 }],
            contact: vec![0.0; if model.contacts.is_empty() { 0 } else { components }],
            moved: BTreeMap::new(),
            pushed: Vec::new(),
        }
    }
}

/// What was done.
#[derive(Debug, Default)]
pub(super) struct Log {
    pub timings: Timings,
    pub decisions: Vec<Decision>,
    /// Of the step that was tried last.
    pub failures: Vec<FailedAttempt>,
    /// Linear solves.
    pub solves: u64,
}
