//! Newton iteration, line search, convergence tests, stop reasons.
//!
//! The iteration `K du = -R`, `q <- q + s du` for a problem that knows its own residual `R`, tangent `K` and iterate `q`
//! (theory/linear-solvers#tolerance). This crate decides when to continue, when to stop and how long a step is, with the reason; it keeps a
//! record of every iteration.
//!
//! * [`NewtonProblem`]: what a problem brings; [`Potential`], if its residual is the slope of one;
//! * [`solve()`], [`NewtonOptions`], [`LineSearch`]: the iteration;
//! * [`NewtonReport`], [`IterationRecord`], [`StopReason`], [`NewtonFailure`]: what it did, and why it ended.
//!
//! It is *not* a solver of linear systems, knows no active set (a problem that changes its set of equations inside
//! `assemble` is a semi-smooth Newton method and welcome) and cuts no time steps: a failure says enough for its caller
//! to do so.
//!
//! # When is it converged?
//! When `residual <= absolute + relative * scale`. For schemes that conserve momentum and energy algebraically that is not
//! enough: the drift of a step is the work of the residual that is left. Hence the iteration goes on ("polish") after
//! the tolerance is reached, as long as an iteration still reduces the residual; with quadratic convergence one more is nearly always enough
//! to arrive at round-off. See [`NewtonOptions::polish`].
//!
//! # What if it cycles?
//! A residual with kinks (stick and slip, closed and open, the facets of a surface) can make Newton's method jump between its smooth pieces without end. When the
//! last residuals, after full steps, are equal to those of two or three iterations before, the next step is half as long: it ends between the pieces, and the
//! iteration continues from there.
//!
#![doc = include_str!("../README.md")]

mod options;
mod problem;
mod report;
mod solve;

pub use options::{LineSearch, NewtonOptions, OVERSHOOT};
pub use problem::{NewtonProblem, Potential, ResidualNorms};
pub use report::{IterationRecord, NewtonFailure, NewtonReport, StopReason};
pub use solve::solve;
