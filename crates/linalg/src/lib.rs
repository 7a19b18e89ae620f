//! Fixed sparsity patterns, deterministic scatter, the trait of a linear solver, multifrontal solver, smoothed aggregation, faer backends, refinement, and what the ranks of a distributed run tell
//! each other.
//!
//! The stages are types: stencils -> [`SparsityPattern`] and [`ScatterMap`] (once per pattern) -> [`SparseMatrix`] (values
//! added per iteration) -> [`LinearSolver`] (analyse once, factorise, solve). Every solution's residual is measured row by
//! row on the original system and refined; a NaN is an error, not a result.
//!
//! It is *not* a linear-algebra library (small dense matrices are nalgebra's, in the crates that need them) and knows
//! nothing of what the equations mean. faer is used in [`faer_backend`] only.
//!
//! **Invariant: the bits depend on the data only.** Sums run in a fixed order. faer runs sequentially, because its last bits change with its
//! degree of parallelism; the multifrontal solver has tasks of its own, whose shapes and sums do not depend on the number of threads.
//!
#![doc = include_str!("../README.md")]

pub mod faer_backend;
pub mod matrix_market;
pub mod multifrontal;
pub mod vector;

mod auto;
mod communicator;
mod direct;
mod equation;
mod error;
mod gathered;
mod gmres;
mod iterative;
mod matrix;
mod pattern;
mod recording;
mod refinement;
mod scaling;
mod scatter;
mod solver;
mod threads;

pub use auto::AutoSolver;
pub use communicator::{Communicator, Serial, Traffic};
pub use direct::{DirectSolver, Factorisation};
pub use equation::EquationPlace;
pub use error::{LinalgError, SystemArray};
pub use faer_backend::{DenseSolver, FaerSolver};
pub use gathered::GatheredSolver;
pub use matrix::SparseMatrix;
pub use multifrontal::MultifrontalSolver;
pub use pattern::{NONE, SparsityPattern};
pub use recording::{Recorder, RecordingSolver, SolvedSystem};
pub use scatter::ScatterMap;
pub use solver::{LinearSolver, MatrixKind, SolveReport, SolverOptions, SolverStatistics};
pub use threads::Threads;
