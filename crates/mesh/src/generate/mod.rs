//! Mesh generators.
//!
//! Each generator is a struct of its parameters with a method `generate` that validates them and returns a mesh whose elements
//! have positive orientation and whose surfaces are named facet sets.
//!
//! | generator | sets |
//! |---|---|
//! | [`Block`], [`Hexahedron`], [`Indenter`] | `left` (x-), `right` (x+), `front` (y-), `back` (y+), `bottom` (z-), `top` (z+) |
//! | [`HollowBall`], [`HollowTorus`] | `outer`, `inner` |
//! | [`Ball`] | `outer`; of a part also `top` (z = 0), `left` (x = 0), `front` (y = 0) |
//! | [`Cylinder`] | `outer`, `front`, `back` (ends along y); of a part also `top` (z = 0), `left` (x = 0) |
//! | [`Rectangle`] | `left`, `right` (x), `bottom`, `top` (y): a layer for [`Mesh::slice`](crate::Mesh::slice) |
//! | [`Disc`] | `outer`; of a part also `top` (y = 0), `left` (x = 0): a layer as well |
//! | [`LBlock`] | `left`, `front`, `bottom`, `top`, `end-x`, `end-y`, `notch`; elements `corner`, `arm-x`, `arm-y` |
//!
//! Unstructured meshing is not here; use a mesher and `stoss-mesh-io`.
//!
//! # How to add a generator
//! Write `generate/<name>.rs` with such a struct; reject bad parameters through `validate`; number surfaces with
//! [`Mesh::facet`](crate::Mesh::facet); finish with `finish`, which checks the orientation; add a line to the table above and a
//! row to the battery in `tests/generators.rs`.

mod ball;
mod block;
pub(crate) mod cube;
mod grid;
mod l_block;
mod plane;
mod round;
mod torus;
pub(crate) mod validate;

pub use ball::HollowBall;
pub use block::{Block, Hexahedron, Indenter};
pub use l_block::LBlock;
pub use plane::{Disc, Rectangle};
pub use round::{Ball, Cylinder, Portion, Refinement};
pub use torus::HollowTorus;

use crate::{Mesh, MeshError};

/// Sorts the sets and checks finiteness and orientation.
fn finish(mut mesh: Mesh) -> Result<Mesh, MeshError> {
    mesh.facet_sets.values_mut().for_each(crate::check::normalise);
    for set in mesh.element_sets.values_mut() {
        set.sort_unstable();
        set.dedup();
    }
    mesh.check_geometry()?;
    Ok(mesh)
}
