//! Meshes of hexahedra, tetrahedra and wedges: nodes, connectivity, named sets, boundary facets, generators, quality; surfaces and mass
//! properties of rigid bodies.
//!
//! * [`Mesh`], [`Elements`], [`Facet`]: the data, sets by name, boundary facets, rigid placement;
//! * [`Region`]: sets from a box or a plane;
//! * [`generate`]: block, hexahedron, indenter, hollow ball, hollow torus, ball, cylinder, L-shaped block;
//! * [`SurfaceMesh`]: triangles and quadrilaterals without a volume mesh, with its generators in [`surface`];
//! * [`MassProperties`]: mass, centre and Euler tensor of a surface's inside, of a mesh, of simple shapes;
//! * [`QualityReport`], [`Mesh::quality`], [`Validity`], [`Mesh::check`]: quality, and everything that makes a mesh unusable as a named error.
//!
//! # What it is not
//! No files (`stoss-mesh-io`), no physics, no current configuration: coordinates are those of the reference configuration.
//! Each body keeps its own mesh; there is no merging.
//!
#![doc = include_str!("../README.md")]

mod check;
mod conformity;
mod convert;
mod element;
mod elements;
mod error;
mod facet;
pub mod generate;
mod mesh;
mod pieces;
mod quality;
mod region;
pub mod slice;
pub mod surface;
mod transform;
mod validity;
mod vector;

pub use check::Coincident;
pub use element::ElementCoordinates;
pub use elements::{CellBlock, Elements};
pub use error::{ElementPoint, MeshError, NON_CONFORMING_REMEDY, SetKind};
pub use facet::{Facet, FacetIndex};
pub use mesh::{ALL, BOUNDARY, Mesh};
pub use quality::QualityReport;
pub use region::Region;
pub use surface::{MassProperties, SurfaceMesh};
pub use transform::Rotation;
pub use validity::Validity;

/// The largest number of elements that a generator makes.
pub const MAX_ELEMENTS: usize = 20_000_000;
