//! Cells, shape functions, quadrature: everything about an element that does not depend on where its nodes are.
//!
//! * [`hex8`]: the trilinear hexahedron: vertices, shape functions and gradients, outward facets;
//! * [`quad4`]: the bilinear quadrilateral, which is the facet of the hexahedron;
//! * [`tri3`]: the linear triangle;
//! * [`FacetKind`], [`Nodal`]: facets as data, for surfaces of any mixture of kinds;
//! * [`quadrature`]: Gauss rules on the line, the square and the cube as constants;
//! * [`triangle`]: Gauss rules on the triangle, for the pieces of clipped facets;
//! * [`CellKind`]: the list of cells.
//!
//! # What it is not
//! No physical coordinates, no Jacobians, no materials: see `stoss-mesh` for geometry and `stoss-fe-solid` for integrals.
//! All functions take and return plain arrays; nothing here allocates.
//!
//! # How to add a cell
//! Write `src/<cell>.rs` with the five items that [`hex8`] has (`VERTICES`, `FACETS`, `shape`, `shape_gradient`, and the
//! facet's own cell), add a variant to [`CellKind`] (its exhaustive matches then fail to compile in every place that needs a
//! line), and add one call of the battery in `tests/battery.rs`.
//!
//! # How to add a kind of facet
//! Write `src/<facet>.rs` as [`quad4`], add a variant to [`FacetKind`] with its data, raise [`MAX_NODES`] if it has more nodes, and add it to the
//! battery. Curved edges and second derivatives other than the mixed one would be new to closest points (`stoss-geometry`), to segmentation and to
//! node-to-surface contact.

mod cell;
mod facet;
pub mod hex8;
pub mod quad4;
pub mod quadrature;
pub mod tri3;
pub mod triangle;

pub use cell::CellKind;
pub use facet::{FacetKind, FacetNodes, MAX_NODES, Nodal};
