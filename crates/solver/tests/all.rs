//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod field;
mod history;
mod rigid;
mod stages;
