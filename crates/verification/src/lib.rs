//! The verification suites: they measure runs of the program and the crates themselves, and hold the result against what was promised.
//!
//! A case is data: what is measured, its bound, and where the bound comes from. `cargo xtask verify` runs the suites and `cargo xtask gallery`
//! draws the pictures of `docs/gallery`.

pub mod gallery;
pub mod manifest;
pub mod program;
mod verify;
pub mod workspace;

use stoss_report::{plot, table, vtu};

pub use verify::{RandomRange, command as verify};
