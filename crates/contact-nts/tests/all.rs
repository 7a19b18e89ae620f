//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod augmented;
mod common;
mod elements;
mod enforcement;
mod friction;
mod invariant_oracle;
mod method;
mod pairing;
mod rules;
