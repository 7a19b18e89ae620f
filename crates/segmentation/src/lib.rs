//! Segmentation of facet pairs: which part of a slave facet lies opposite which part of a master facet.
//!
//! Two facets in, quadrilaterals or triangles, convex polygons and triangles out, with the convective coordinates of every vertex on both
//! facets, its origin ([`Provenance`]), and first derivatives with respect to all nodes (theory/segmentation). No
//! contact, no integrals, no mesh.
//!
//! # API
//! ```text
//! SlaveFrame::new(slave: Nodal<Vector3>) -> Result<SlaveFrame>         the segmentation plane of a slave facet
//! segment_pair(&frame, id, &master: &Nodal<Vector3>, &mut Vec<Segment>)  one pair, appends 0 to 4 convex polygons
//! segment_facet(slave, &[MasterFacet], GapRange) -> FacetSegmentation  against a surface, hidden sheets removed
//! check_coverage(&FacetSegmentation, &[MasterFacet], GapRange) -> CoverageReport
//! Segment::vertices() -> &[Vertex]             coordinates on both facets, gap along the normal, provenance
//! Segment::triangles() -> iterator of [usize; 3], a fan, indices into vertices()
//! Segment::project(&frame, &master, xi1) -> Foot          from a point of the slave to the master, along the normal
//! Segment::vertex_derivatives(&frame, &master) -> [PointDerivative; 8]
//! Segment::project_derivative(&frame, &master, xi1, &foot, d xi1) -> d xi2
//! ```
//! Local columns of derivatives: `3 I + c` for component `c` of slave node `I`, `MASTER + 3 K + c` for master node `K`.
//!
//! # Virtual surface (choice)
//! The plane normal to `n0`, the unit outward normal of the slave facet at its centre. Every node, of either side,
//! has one image there that does not depend on which facet it is asked for; edges are straight there. So the images
//! of the facets of a master surface tile the plane as the surface does, and so do the polygons cut from them.
//! Polygons and their triangles are straight in the *slave's* convective coordinates between their vertices; their
//! areas are signed there, so that sums over a surface are exact also where a distorted facet bends an edge.
//!
//! # Degenerate cases
//! Which vertices a polygon has is decided by exact predicates (crate `robust`) on the images; ties are broken as if
//! the master were shifted by an infinitesimal vector, the same for all of its facets. Identical facets and shared
//! edges and vertices are thus no special cases. Neighbouring facets compute a shared vertex to the same bits. A
//! quadrilateral whose image is not convex is split into two triangles; parts that are seen from behind (outward normals not
//! opposed) give nothing.
//!
#![doc = include_str!("../README.md")]

mod clip;
mod coverage;
mod derivative;
mod error;
mod facet;
mod folded;
mod frame;
mod map;
mod overlap;
mod pieces;
mod plane;
mod segment;
mod surface;

pub use coverage::{CoverageReport, OpenEdge, check_coverage};
pub use derivative::{LOCAL, MASTER, PointDerivative};
pub use error::SegmentationError;
pub use facet::{FacetSegmentation, HiddenFacet, MasterFacet};
pub use frame::SlaveFrame;
pub use map::FacetMap;
pub use segment::{Foot, MAX_VERTICES, Provenance, Segment, Vertex, segment_pair, segment_pair_within};
pub use surface::{GapRange, segment_facet, segment_facet_within};
