//! Time and load stepping, active set, step control, balance of energy and momenta, checkpoints.
//!
//! A [`Model`] (bodies, loads, prescribed motion, contact methods) and [`Settings`] make a [`Simulation`]; every call of
//! [`Simulation::advance`] does one step, or fails with the state of the last completed step intact. Whoever calls writes the
//! files; this crate prints nothing and knows no format but that of its own checkpoints.
//!
//! Quasi-static and dynamic problems differ in one argument (the scheme) and take the same path: without a scheme there is
//! no inertia, no mass matrix is built, and all forces are taken at the end of the step.
//!
//! * [`Model`]: bodies ([`Body`]), parts, contacts, ties and joints ([`CouplingTerm`]), loads, prescribed motion;
//! * [`Settings`], [`StepControl`]: scheme, step sizes, Newton's method, linear solver;
//! * [`Simulation`]: steps, state, pressures, reactions; [`Balance`], [`StepRecord`]: what a step did;
//! * [`Checkpoint`]: all that a run needs to go on.
//!
//! It is not a catalogue: material laws and contact methods come in through traits.
//!
#![doc = include_str!("../README.md")]

mod accuracy;
mod anchor;
mod anchored;
mod assembly;
mod balance;
mod books;
mod checkpoint;
mod closed;
mod contributions;
mod control;
mod curvature;
mod damping;
mod dealt;
mod departure;
mod diagnosis;
mod downhill;
mod embedding;
mod error;
mod failure;
mod groups;
mod held;
mod inertia;
mod iterate;
mod loads;
mod mass_solve;
mod masses;
mod matrix;
mod model;
mod moment;
mod numbering;
mod partition;
mod place;
mod places;
mod problem;
mod record;
mod rotation;
mod rows;
mod run_state;
mod shares;
mod simulation;
mod sliding_support;
mod smooth;
mod stabilise;
mod step;
mod switches;
mod system;
mod table;
mod terms;
mod timing;
mod words;

pub use balance::Balance;
pub use books::{Books, Posting};
pub use checkpoint::{Checkpoint, CheckpointError};
pub use control::{Automatic, Clock, StepChange, StepControl};
pub use departure::Departure;
pub use embedding::Embedding;
pub use error::{SimulationError, StepError, Unknown};
pub use failure::{FailedAttempt, FailureKind, SlotChanges};
pub use loads::{Load, LoadKind};
pub use model::{Body, CouplingTerm, Damping, Model, Prescription};
pub use place::Place;
pub use record::{ContactSummary, Decision, DecisionKind, NewtonRow, PairSummary, StepRecord};
pub use rotation::AxisRotation;
pub use run_state::{Ledger, Log, NodalForces, SlotState, StageState};
pub use shares::RankFault;
pub use simulation::{FirstStage, InsideOutTreatment, Plan, Settings, Simulation, Stage, Steered};
pub use sliding_support::SlidingSupport;
pub use stabilise::Stabilise;
pub use stoss_term::{BodyPair, SurfaceForce, SurfaceNode};
pub use switches::{Release, Switches};
pub use table::{Table, TableError};
pub use timing::{Phase, PhaseTime, Timings};
pub use words::{digits, short, significant};
