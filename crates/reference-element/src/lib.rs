//! Cells, shape functions, quadrature: everything about an element that does not depend on where its nodes are.
//!
//! * [`CellKind`], [`CellTable`]: the cells as data: hex8, hex20, hex27, tet4, tet10, wedge6, wedge15;
//! * [`FaceKind`], [`FaceNodes`]: the faces of cells: tri3, quad4, tri6, quad8, quad9;
//! * [`FacetKind`], [`Nodal`]: the linear facets of contact surfaces as data, for surfaces of any mixture of kinds;
//! * [`FacePiece`]: a linear facet that is a piece of a face;
//! * [`hex8`], [`quad4`], [`tri3`]: the linear ones with arrays of their own size;
//! * [`quadrature`]: Gauss rules on the line, the square, the cube, the tetrahedron and the wedge as constants;
//! * [`triangle`]: Gauss rules on the triangle, for the pieces of clipped facets.
//!
//! # What it is not
//! No physical coordinates, no Jacobians, no materials: see `stoss-mesh` for geometry and `stoss-fe-solid` for integrals.
//! All functions take and return plain arrays; nothing here allocates.
//!
//! # How to add a cell
//! Write its [`CellTable`] in `src/cells/`, add a variant to [`CellKind`] and a line to `CellKind::table`; the battery in `tests/battery.rs` runs
//! over all kinds. `docs/how-to-add/element.md` does so for a cell.
//!
//! # How to add a kind of facet
//! Write `src/<facet>.rs` as [`quad4`], add a variant to [`FacetKind`] with its data, raise [`MAX_NODES`] if it has more nodes, and add it to the
//! battery. Curved edges and second derivatives other than the mixed one would be new to closest points (`stoss-geometry`), to segmentation and to
//! node-to-surface contact.
//!
#![doc = include_str!("../README.md")]

mod cell;
mod cells;
mod face;
mod facet;
pub mod hex8;
mod layer;
mod line;
mod piece;
pub mod quad4;
pub mod quadrature;
mod table;
pub mod tri3;
pub mod triangle;

pub use face::{FaceGradient, FaceKind, FaceNodes, FaceShape, MAX_FACE_NODES, Trace};
pub use facet::{FacetKind, FacetNodes, MAX_NODES, Nodal};
pub use piece::FacePiece;
pub use table::{
    CellKind, CellTable, Face, Family, Integration, MAX_CELL_NODES, QuadratureRule, ShapeFunctions, ShapeGradient,
};
