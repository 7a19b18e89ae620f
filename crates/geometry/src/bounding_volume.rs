//! What bounding-volume trees are made of: boxes, and boxes that move.

use crate::Aabb;
use nalgebra::Vector3;

/// A volume around something, of which a [`crate::BoundingVolumeTree`] is made.
pub trait BoundingVolume: Copy {
    /// The volume that contains nothing; the neutral element of `union`.
    fn empty() -> Self;
    /// A volume around both.
    fn union(&self, other: &Self) -> Self;
    /// Whether the two may have a point in common.
    fn overlaps(&self, other: &Self) -> bool;
    /// A point in the middle, by which trees are split.
    fn centre(&self) -> Vector3<f64>;
}

impl BoundingVolume for Aabb {
    fn empty() -> Self {
        Self::empty()
    }

    fn union(&self, other: &Self) -> Self {
        self.union(other)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.overlaps(other)
    }

    fn centre(&self) -> Vector3<f64> {
        self.centre()
    }
}

/// A set of points that move along straight lines during the same time: a box around their starts, and one around their displacements.
///
/// Two of them overlap if their *relative* motion may bring them together. So what flies, turns or bends together stays apart, however far it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingBox {
    /// Where the points start.
    pub start: Aabb,
    /// Box of the motions of the points.
    pub motion: Aabb,
}

impl MovingBox {
    /// A point that moves from `start` by `motion`, and everything within `distance` of it.
    pub fn new(start: &Vector3<f64>, motion: &Vector3<f64>, distance: f64) -> Self {
        Self {
            start: Aabb { min: *start, max: *start }.inflated(distance),
            motion: Aabb { min: *motion, max: *motion },
        }
    }
}

impl BoundingVolume for MovingBox {
    fn empty() -> Self {
        Self { start: Aabb::empty(), motion: Aabb::empty() }
    }

    fn union(&self, other: &Self) -> Self {
        Self { start: self.start.union(&other.start), motion: self.motion.union(&other.motion) }
    }

    /// Whether `x_a - x_b + t (d_a - d_b)` may be zero for some `t` in `[0, 1]`, bounded component by component.
    fn overlaps(&self, other: &Self) -> bool {
        let ([x, y], [d, e]) = ([&self.start, &other.start], [&self.motion, &other.motion]);
        (0..3).all(|i| {
            let least = x.min[i] - y.max[i] + (d.min[i] - e.max[i]).min(0.0);
            let most = x.max[i] - y.min[i] + (d.max[i] - e.min[i]).max(0.0);
            least <= 0.0 && most >= 0.0
        })
    }

    fn centre(&self) -> Vector3<f64> {
        self.start.centre()
    }
}
