//! Patches of facets, closest-point projection, boxes and a bounding-volume tree.
//!
//! This crate is pure geometry in three dimensions and `f64`: it knows no mesh, no body and no contact. Lengths are in the
//! caller's unit; convective coordinates are free of units and run over
//! the reference facet.
//!
//! * [`Patch`]: a facet, bilinear or a triangle, with its tangents, metric and curvature; projection on the extended patch and the
//!   closest point on the closed patch;
//! * [`Aabb`], [`BoundingVolumeTree`]: boxes, overlap and nearest-first queries without allocation.

mod aabb;
mod advancement;
mod closest;
mod patch;
mod polynomial;
mod primitive_distance;
mod project;
mod tree;

pub use aabb::Aabb;
pub use advancement::safe_fraction;
pub use closest::{ClosestPoint, PatchFeature};
pub use patch::{Patch, SurfaceFrame};
pub use primitive_distance::{ClosestPair, FreeDirections, PairFeature, PairKind, closest, combine};
pub use project::Projection;
pub use tree::BoundingVolumeTree;
