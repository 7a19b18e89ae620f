//! Time-stepping schemes for constrained second-order systems, and the step that they all share.
//!
//! The system is `M v' + F(q) - G^T p = 0`, `Phi(q) = 0` with `F = F_int - F_ext` (theory/integrators#eq-system). Every scheme of this crate is a
//! set of numbers and rules for the residual of one step ([`StepRule`]),
//!
//! `R = M a_alg(q_np1) + w F_rule(q_n, q_np1) + h H_n - c G_rule(q_n, q_np1)^T p`,
//!
//! and for the update of velocity and acceleration. [`evaluate`], [`evaluate_constraints`], [`finish`] and [`start`] carry that out for any
//! [`SecondOrderSystem`], be it a spring with three coordinates or a finite-element model.
//!
//! This crate is not a solver: it knows neither elements nor contact nor matrices, and does not iterate.
//!
//! # How to add a scheme
//! One file in `schemes/` with a type that implements [`Scheme`], its [`Claims`] as data, one row in [`SCHEMES`]. The battery
//! of the crate `model-problems` takes every row of the table and checks each claim, and that what is not claimed does not hold; scenes accept
//! the new name at once.
//!
#![doc = include_str!("../README.md")]

mod registry;
mod rule;
mod scheme;
mod schemes;
mod state;
mod step;
mod system;

pub use registry::{Parameter, SCHEMES, SchemeEntry, SchemeError, entry, scheme};
pub use rule::{Combination, ConstraintTerm, ForceRule, ForceTerm, GradientRule, HistoryTerm, StepRule};
pub use scheme::{Claims, Scheme};
pub use schemes::{
    BackwardEuler, EnergyMomentum, ForceAverage, ForwardEuler, GeneralisedAlpha, Midpoint, Trapezoidal,
    VariationalMidpoint,
};
pub use state::State;
pub use step::{Buffers, EndPoint, Step, evaluate, evaluate_constraints, finish, start};
pub use system::{DampingTangent, SecondOrderSystem, StepConfiguration};
