//! Small systems with known or fine reference solutions, driven by the same schemes and the same step as finite-element models.
//!
//! | problem | what it shows |
//! |---|---|
//! | [`SpringPendulum`] | order; blow-up of schemes that do not bound the energy when it is stiff (theory/integrators#spring) |
//! | [`SpringPair`] | the same without a support: linear momentum too |
//! | [`StringPendulum`] | the same with a chain of finite string elements |
//! | [`MassPoint`] | a unilateral constraint, standard and modified (theory/constraints#mass-point) |
//! | [`Pendulum`] | an index-3 differential-algebraic system that stays on its manifold |
//! | [`ReducedPendulum`] | the same with its index reduced: it drifts from the manifold |
//! | [`BouncingBar`] | impact of an elastic bar with a closed-form solution |
//!
//! [`simulate`] runs any of them with any scheme. This crate is not a multibody program: matrices are dense.
//!
//! # How to add a problem
//! One file in `problems/` with a type that implements [`ModelProblem`]. Its constraints, if any, must be at most quadratic: then the
//! midpoint Jacobian is their exact discrete gradient.
//!
#![doc = include_str!("../README.md")]

mod dense;
mod error;
mod problem;
mod problems;
mod simulate;

pub use error::ModelError;
pub use problem::{ConstraintForm, ModelProblem};
pub use problems::{
    AugmentedSpringPendulum, BouncingBar, MassPoint, Pendulum, ReducedPendulum, SpringPair, SpringPendulum,
    StringPendulum,
};
pub use simulate::{Effort, Sample, simulate};
