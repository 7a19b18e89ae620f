//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod fuzz;
mod malformed;
mod parameters;
mod scenes;
mod sets;
mod support;
