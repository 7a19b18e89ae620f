//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod battery;
mod energy_momentum;
mod inelastic;
mod inelastic_closed_forms;
