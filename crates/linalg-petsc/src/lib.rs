//! Ranks by MPI, and PETSc as the solver of a matrix that is spread over them. Empty without the feature `petsc`.
//!
//! It is *not* a binding of PETSc or MPI: `petsc.c` has what Stoss needs of both, `ffi` makes it safe.
//!
//! **Invariant: every method is collective.** All ranks call the same ones in the same order, and an error is one on all of them.
//!
#![doc = include_str!("../README.md")]

#[cfg(feature = "petsc")]
mod ffi;
#[cfg(feature = "petsc")]
mod method;
#[cfg(feature = "petsc")]
mod mpi;
#[cfg(feature = "petsc")]
mod rows;
#[cfg(feature = "petsc")]
mod solver;

#[cfg(feature = "petsc")]
pub use method::Method;
#[cfg(feature = "petsc")]
pub use mpi::Mpi;
#[cfg(feature = "petsc")]
pub use solver::PetscSolver;
