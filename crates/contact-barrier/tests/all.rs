//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod general;
mod pair;
mod start;
