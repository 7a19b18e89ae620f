//! Axis-aligned boxes.

use nalgebra::Vector3;

/// An axis-aligned box, closed. The empty box has `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Vector3<f64>,
    /// Largest coordinates.
    pub max: Vector3<f64>,
}

impl Aabb {
    /// The box that contains nothing; the neutral element of [`Aabb::union`].
    pub fn empty() -> Self {
        Self { min: Vector3::repeat(f64::INFINITY), max: Vector3::repeat(f64::NEG_INFINITY) }
    }

    /// The smallest box around points.
    pub fn from_points<'a>(points: impl IntoIterator<Item = &'a Vector3<f64>>) -> Self {
        points.into_iter().fold(Self::empty(), |b, p| Self { min: b.min.inf(p), max: b.max.sup(p) })
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The box grown by `distance` on all sides.
    pub fn inflated(&self, distance: f64) -> Self {
        Self { min: self.min.add_scalar(-distance), max: self.max.add_scalar(distance) }
    }

    /// Whether the closed boxes share a point.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|i| self.min[i] <= other.max[i] && other.min[i] <= self.max[i])
    }

    /// Whether the point is in the closed box.
    pub fn contains(&self, x: &Vector3<f64>) -> bool {
        (0..3).all(|i| self.min[i] <= x[i] && x[i] <= self.max[i])
    }

    /// Centre; not a number for the empty box.
    pub fn centre(&self) -> Vector3<f64> {
        (self.min + self.max) * 0.5
    }

    /// Squared distance from `x` to the box, zero inside, infinite for the empty box.
    pub fn distance_squared(&self, x: &Vector3<f64>) -> f64 {
        (0..3)
            .map(|i| {
                let d = (self.min[i] - x[i]).max(x[i] - self.max[i]).max(0.0);
                d * d
            })
            .sum()
    }
}
