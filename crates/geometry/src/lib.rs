//! Patches of facets, closest-point projection, pairs of primitives, boxes and a bounding-volume tree.
//!
//! This crate is pure geometry in three dimensions and `f64`: it knows no mesh, no body and no contact. Lengths are in the
//! caller's unit; convective coordinates are free of units and run over
//! the reference facet.
//!
//! * [`Patch`]: a facet, bilinear or a triangle, with its tangents, metric and curvature; projection on the extended patch and the
//!   closest point on the closed patch;
//! * [`closest`]: distance of vertices, edges and triangles, with the weights of the closest points; [`safe_fraction`]: how far
//!   a pair of them may move without contact;
//! * [`Aabb`], [`MovingBox`], [`BoundingVolumeTree`]: boxes at rest and in motion, overlap, pairs, and nearest-first
//!   queries without allocation;
//! * [`Round`]: the cylinder or sphere through points.
//!
#![doc = include_str!("../README.md")]

mod aabb;
mod advancement;
mod bounding_volume;
mod closest;
mod patch;
mod polynomial;
mod primitive_distance;
mod project;
mod round;
mod tree;

pub use aabb::Aabb;
pub use advancement::safe_fraction;
pub use bounding_volume::{BoundingVolume, MovingBox};
pub use closest::{ClosestPoint, PatchFeature};
pub use patch::{Patch, SurfaceFrame};
pub use primitive_distance::{ClosestPair, FreeDirections, PairFeature, PairKind, closest, combine};
pub use project::Projection;
pub use round::Round;
pub use tree::BoundingVolumeTree;
