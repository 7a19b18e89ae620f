//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod conformity;
mod convert;
mod generators;
mod mass;
mod sets_and_checks;
mod surfaces;
mod validity;
