//! The tests of the crate in one binary: linking one for each file takes longer than running them.

mod abaqus;
mod cells;
mod deck;
mod fuzz;
mod gmsh;
mod grid;
mod stl;
#[cfg(feature = "vtkhdf")]
mod vtkhdf;
mod vtu;
mod write;
