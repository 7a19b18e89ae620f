//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod blocks;
mod contact;
mod friction;
mod prescribed;
mod sheets;
mod tie;
mod transfer;
