//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod active_set;
mod closest;
mod common;
mod friction;
mod slave;
mod sliding;
mod surface;
