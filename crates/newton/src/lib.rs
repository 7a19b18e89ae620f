//! Newton iteration, line search, convergence tests, stop reasons.
//!
//! The iteration `K du = -R`, `q <- q + s du` for a problem that knows its own residual `R`, tangent `K` and iterate `q`
//! (formulation §9, "Newton"). This crate decides when to go on, when to stop, how long a step is and why; it keeps a
//! record of every iteration.
//!
//! It is *not* a solver of linear systems, knows no active set (a problem that changes its set of equations inside
//! `assemble` is a semi-smooth Newton method and welcome) and cuts no time steps: a failure says enough for its caller
//! to do so.
//!
//! # When is it converged?
//! When `residual <= absolute + relative * scale`. For schemes that conserve momentum and energy algebraically that is not
//! enough: the drift of a step is the work of the residual that is left. Hence the iteration goes on ("polish") after
//! the tolerance is reached, as long as an iteration still pays; with quadratic convergence one more is nearly always enough
//! to arrive at round-off. See [`NewtonOptions::polish`].

mod options;
mod problem;
mod report;
mod solve;

pub use options::{LineSearch, NewtonOptions};
pub use problem::{NewtonProblem, ResidualNorms};
pub use report::{IterationRecord, NewtonFailure, NewtonReport, StopReason};
pub use solve::solve;
