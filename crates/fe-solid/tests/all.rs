//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod cells;
mod common;
mod conservation;
mod derivatives;
mod errors;
mod inelastic;
mod kernel;
mod loads;
mod mass_and_momenta;
mod mixed;
mod patch;
mod share;
mod theta;
mod threads;
mod viscous;
