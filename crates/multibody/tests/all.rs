//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod beam_condition;
mod bend;
mod common;
mod coordinates;
mod couplings;
mod dynamics;
mod joint_forces;
mod linear_equations;
mod lines;
mod parts;
mod pendulums;
mod redundancy;
mod statics;
