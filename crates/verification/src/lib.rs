//! The verification suites: they measure runs of the program and the crates themselves, and compare the results with bounds.
//!
//! A case is data: what is measured, its bound, and where the bound comes from. `cargo xtask verify` runs the suites and `cargo xtask gallery`
//! draws the pictures of `docs/gallery`.

pub mod gallery;
pub mod manifest;
pub mod program;
mod verify;
pub mod workspace;

use stoss_report::{plot, table, vtu};

pub use verify::{RandomRange, Selection, command as verify};

/// Points of the trilinear hexahedra of a frame that has no other elements.
pub(crate) fn hexahedra(grid: &vtu::Grid) -> Vec<[usize; 8]> {
    let of = |nodes: &[u32]| std::array::from_fn(|k| nodes[k] as usize);
    grid.elements.iter().map(of).collect()
}
