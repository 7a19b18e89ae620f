//! The kinds of joints as rows of a table: their equations, functions that are at most quadratic in the vectors, lengths all of them; what they leave free; what a scene gives for them.

use super::coordinate::CoordinateKind;
use crate::{Embedded, JointFrame};

/// What a joint leaves free. Side b moves relative to side a; axes are those of the frames, `a_1` the first of side a. [`JointKind::entry`] is its row in [`JOINTS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// The points coincide: 3 equations `x_b - x_a = 0`.
    Ball,
    /// Turns about `a_1 = b_1`: the equations of the ball and `a_1 . b_2 = a_1 . b_3 = 0`, 5.
    Hinge,
    /// Slides along `a_1` without turning: `(x_b - x_a) . a_2 = (x_b - x_a) . a_3 = 0`, `a_1 . b_2 = a_1 . b_3 = a_2 . b_3 = 0`, 5.
    Slider,
    /// Slides along `a_1` and turns about it, 4.
    Cylindrical,
    /// Cardan joint: the points coincide and the axis `a_1` stays at right angles to `b_2`, 4. Both frames are given with the same directions: `a_1` is the pin of side a, `b_2` that of b.
    Universal,
    /// The points stay in a plane with the normal `a_1`, which is also one of b: `(x_b - x_a) . a_1 = a_1 . b_2 = a_1 . b_3 = 0`, 3.
    Planar,
    /// A joint without relative rotation, `a_1 . b_2 = a_1 . b_3 = a_2 . b_3 = 0`, 3; translations are free.
    Orientation,
    /// The axis `a_1` is one of b, `a_1 . b_2 = a_1 . b_3 = 0`, 2; the rotation about it and translations are free.
    Parallel,
    /// A joint without an equation: the rotation about `a_1`, in the plane across it, is measured and can be driven and braked; everything is free.
    Rotation,
    /// A joint in which nothing moves, 6.
    Weld,
    /// The points keep their distance: `(|x_b - x_a|^2 - L^2) / (2 L) = 0`, 1.
    Distance {
        /// `L`.
        length: f64,
    },
}

/// The equations between the points of both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Points {
    /// The points coincide: `x_b - x_a = 0`.
    Coincide,
    /// `(x_b - x_a) . a_k = 0` for these axes of side a.
    Across(&'static [usize]),
    /// The distance of the points is constant.
    Apart,
}

/// The directions that tell how a joint lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Directions {
    /// No direction.
    None,
    /// An axis, `a_1`: what the joint holds lies along it.
    Axis,
    /// A normal, `a_1`: what the joint holds lies in the plane across it.
    Normal,
    /// Two axes at right angles, one fixed to each side: `a_1` and `b_2`.
    Pair,
}

/// A row of the table of joints.
#[derive(Debug)]
pub struct JointEntry {
    /// Name in scenes and messages.
    pub name: &'static str,
    /// What is common and what is free, a sentence.
    pub about: &'static str,
    /// What tells how it lies.
    pub directions: Directions,
    /// What it leaves free and can be measured, driven and braked: of a cylindrical joint the angle about `a_1` and the displacement along it, of a universal joint
    /// the angle about `a_1` from side a to the cross and the one about `b_2` from the cross to side b.
    pub coordinates: &'static [CoordinateKind],
    /// The kind; a length in it is any.
    kind: JointKind,
    /// The equations of the points; they come first.
    points: Points,
    /// Axes `(i, j)` with `a_i . b_j = 0`: the other equations.
    right: &'static [(usize, usize)],
    /// Axes that are the same on both sides at the start.
    common: &'static [usize],
}

/// Every kind of joint.
pub const JOINTS: &[JointEntry] = &[
    JointEntry {
        name: "ball",
        about: "Ball joint (spherical): the point `at` is common.",
        directions: Directions::None,
        coordinates: &[],
        kind: JointKind::Ball,
        points: Points::Coincide,
        right: &[],
        common: &[],
    },
    JointEntry {
        name: "hinge",
        about: "Hinge (revolute): common point and axis; the rotation about the axis is free.",
        directions: Directions::Axis,
        coordinates: &[CoordinateKind::Angle],
        kind: JointKind::Hinge,
        points: Points::Coincide,
        right: &[(0, 1), (0, 2)],
        common: &[0],
    },
    JointEntry {
        name: "slider",
        about: "Slider (prismatic): common axis, no relative rotation; the translation along the axis is free.",
        directions: Directions::Axis,
        coordinates: &[CoordinateKind::Displacement],
        kind: JointKind::Slider,
        points: Points::Across(&[1, 2]),
        right: &[(0, 1), (0, 2), (1, 2)],
        common: &[0, 1, 2],
    },
    JointEntry {
        name: "cylindrical",
        about: "Cylindrical joint: common axis; rotation about it and translation along it are free.",
        directions: Directions::Axis,
        coordinates: &[CoordinateKind::Angle, CoordinateKind::Displacement],
        kind: JointKind::Cylindrical,
        points: Points::Across(&[1, 2]),
        right: &[(0, 1), (0, 2)],
        common: &[0],
    },
    JointEntry {
        name: "universal",
        about: "Universal (Cardan) joint: common point, and two axes, one fixed to each part, that stay perpendicular; it turns about both.",
        directions: Directions::Pair,
        coordinates: &[CoordinateKind::Angle, CoordinateKind::Angle],
        kind: JointKind::Universal,
        points: Points::Coincide,
        right: &[(0, 1)],
        common: &[],
    },
    JointEntry {
        name: "weld",
        about: "Rigid connection: no relative motion.",
        directions: Directions::None,
        coordinates: &[],
        kind: JointKind::Weld,
        points: Points::Coincide,
        right: &[(0, 1), (0, 2), (1, 2)],
        common: &[0, 1, 2],
    },
    JointEntry {
        name: "distance",
        about: "Rigid link: constant distance of two points.",
        directions: Directions::None,
        coordinates: &[],
        kind: JointKind::Distance { length: 1.0 },
        points: Points::Apart,
        right: &[],
        common: &[],
    },
    JointEntry {
        name: "planar",
        about: "Planar joint: common plane; two translations in it and the rotation about its normal are free.",
        directions: Directions::Normal,
        coordinates: &[],
        kind: JointKind::Planar,
        points: Points::Across(&[0]),
        right: &[(0, 1), (0, 2)],
        common: &[0],
    },
    JointEntry {
        name: "orientation",
        about: "Common orientation: no relative rotation; all translations are free.",
        directions: Directions::None,
        coordinates: &[],
        kind: JointKind::Orientation,
        points: Points::Across(&[]),
        right: &[(0, 1), (0, 2), (1, 2)],
        common: &[0, 1, 2],
    },
    JointEntry {
        name: "parallel",
        about: "Common direction: the axis keeps its direction on both sides; the rotation about it and all translations are free.",
        directions: Directions::Axis,
        coordinates: &[CoordinateKind::Angle],
        kind: JointKind::Parallel,
        points: Points::Across(&[]),
        right: &[(0, 1), (0, 2)],
        common: &[0],
    },
    JointEntry {
        name: "rotation",
        about: "Nothing in common: the rotation about the axis of the first side can be driven, limited and braked; all other motions are free. The second side should tilt by less than a right angle against the axis.",
        directions: Directions::Axis,
        coordinates: &[CoordinateKind::Angle],
        kind: JointKind::Rotation,
        points: Points::Across(&[]),
        right: &[],
        common: &[],
    },
];

impl JointEntry {
    /// The kind, for points that are so far `apart` (a length), which counts only where a distance is kept.
    pub fn kind(&self, apart: f64) -> JointKind {
        match self.kind {
            JointKind::Distance { .. } => JointKind::Distance { length: apart },
            kind => kind,
        }
    }

    /// True if it has a point on each side, and not one that is common.
    pub fn has_two_points(&self) -> bool {
        self.points == Points::Apart
    }

    /// True if it says something of rotations, so that both sides must have an orientation.
    pub fn needs_orientation(&self) -> bool {
        !self.right.is_empty() || !self.coordinates.is_empty()
    }
}

/// Forms of a joint: `x_b - x_a`, the axes of a, those of b, and the three constant directions.
pub(crate) const ARM: usize = 0;
pub(crate) const A: [usize; 3] = [1, 2, 3];
pub(crate) const B: [usize; 3] = [4, 5, 6];
pub(crate) const E: [usize; 3] = [7, 8, 9];

/// A function `constant + sum factor u . v` of two forms each.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Function {
    pub constant: f64,
    pub products: Vec<(f64, usize, usize)>,
}

impl Function {
    fn of(factor: f64, u: usize, v: usize) -> Self {
        Self { constant: 0.0, products: vec![(factor, u, v)] }
    }
}

impl JointKind {
    /// Row of the kind in [`JOINTS`].
    pub fn entry(self) -> &'static JointEntry {
        let is_own = |entry: &&JointEntry| std::mem::discriminant(&entry.kind) == std::mem::discriminant(&self);
        // cannot fail: every kind has a row, as a test says.
        JOINTS.iter().find(is_own).unwrap_or(&JOINTS[0])
    }

    /// Name for messages.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Number of its equations.
    pub fn equations(self) -> usize {
        self.point_equations() + self.entry().right.len()
    }

    /// The coordinates of its row.
    pub fn coordinates(self) -> &'static [CoordinateKind] {
        self.entry().coordinates
    }

    /// The invariants of a coordinate: sine and cosine of an angle, or a displacement.
    ///
    /// With `b_2` at right angles to `a_1` the angle about `a_1` has `s = a_3 . b_2`, `c = a_2 . b_2` in all of these joints; of a rotation that is not about `a_1` alone they are those of the part of `b_2` across `a_1`. The second one of a universal joint is that of
    /// side b against the cross with the pins `a_1` and `b_2`, about `b_2`: `s = a_1 . b_3`, `c = a_1 . b_1`.
    pub(crate) fn invariants(self, coordinate: usize) -> Vec<Function> {
        match (self.coordinates().get(coordinate), coordinate) {
            (Some(CoordinateKind::Angle), 0) => vec![Function::of(1.0, A[2], B[1]), Function::of(1.0, A[1], B[1])],
            (Some(CoordinateKind::Angle), _) => vec![Function::of(1.0, A[0], B[2]), Function::of(1.0, A[0], B[0])],
            (Some(CoordinateKind::Displacement), _) => vec![Function::of(1.0, ARM, A[0])],
            (None, _) => Vec::new(),
        }
    }

    /// Number of the first equations whose multipliers are components of the force between the points along orthonormal directions.
    pub(crate) fn point_equations(self) -> usize {
        match self.entry().points {
            Points::Coincide => 3,
            Points::Across(axes) => axes.len(),
            Points::Apart => 1,
        }
    }

    /// The equations; products of directions are multiplied by `length`.
    pub(crate) fn functions(self, length: f64) -> Vec<Function> {
        let row = self.entry();
        let points: Vec<Function> = match (row.points, self) {
            (Points::Coincide, _) => E.map(|e| Function::of(1.0, ARM, e)).to_vec(),
            (Points::Across(axes), _) => axes.iter().map(|&k| Function::of(1.0, ARM, A[k])).collect(),
            (Points::Apart, Self::Distance { length }) => {
                vec![Function { constant: -0.5 * length, products: vec![(0.5 / length, ARM, ARM)] }]
            }
            // A distance alone has points apart.
            (Points::Apart, _) => Vec::new(),
        };
        let directions = row.right.iter().map(|&(i, j)| Function::of(length, A[i], B[j]));
        points.into_iter().chain(directions).collect()
    }

    /// Axes that are the same on both sides.
    pub(crate) fn common_axes(self) -> &'static [usize] {
        self.entry().common
    }
}

/// The forms in the order of [`ARM`], [`A`], [`B`], [`E`].
pub(crate) fn forms(a: &JointFrame, b: &JointFrame) -> [Embedded; 10] {
    let e = |k: usize| Embedded::ground(std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }));
    let [a1, a2, a3] = a.axes.clone();
    let [b1, b2, b3] = b.axes.clone();
    [b.point.plus(-1.0, &a.point), a1, a2, a3, b1, b2, b3, e(0), e(1), e(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_its_row() {
        for entry in JOINTS {
            let kind = entry.kind(0.7);
            assert_eq!((kind.name(), kind.entry().name), (entry.name, entry.name));
            assert_eq!(kind.functions(1.0).len(), kind.equations());
            assert_eq!(kind.equations() + degrees_of_freedom(entry), 6, "{}", entry.name);
        }
        let distance = JOINTS.iter().find(|entry| entry.name == "distance").map(|entry| entry.kind(0.7));
        assert_eq!(distance, Some(JointKind::Distance { length: 0.7 }));
    }

    /// What each kind leaves of six (theory/multibody#joints).
    fn degrees_of_freedom(entry: &JointEntry) -> usize {
        match entry.kind {
            JointKind::Weld => 0,
            JointKind::Hinge | JointKind::Slider => 1,
            JointKind::Cylindrical | JointKind::Universal => 2,
            JointKind::Ball | JointKind::Planar | JointKind::Orientation => 3,
            JointKind::Parallel => 4,
            JointKind::Rotation => 6,
            JointKind::Distance { .. } => 5,
        }
    }
}
