//! Pairs of primitives: closest points, collision detection, candidates; each against exact arithmetic or brute force.

#[path = "primitives/exact.rs"]
mod exact;

#[path = "primitives/distance.rs"]
mod distance;

#[path = "primitives/advancement.rs"]
mod advancement;
