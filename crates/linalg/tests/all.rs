//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod assembly;
mod common;
mod inertia;
mod matrix_market;
mod multifrontal;
mod nearby;
mod ranks;
mod solvers;
