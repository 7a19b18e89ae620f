//! The equations of each kind of joint: functions that are at most quadratic in the vectors, lengths all of them.

use super::coordinate::CoordinateKind;
use crate::{Embedded, Frame};

/// What a joint leaves free. Side b moves relative to side a; axes are those of the frames, `a_1` the first of side a.
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
    /// Nothing moves, 6.
    Weld,
    /// The points keep their distance: `(|x_b - x_a|^2 - L^2) / (2 L) = 0`, 1.
    Distance {
        /// `L`.
        length: f64,
    },
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
    /// Name for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Hinge => "hinge",
            Self::Slider => "slider",
            Self::Cylindrical => "cylindrical",
            Self::Universal => "universal",
            Self::Planar => "planar",
            Self::Weld => "weld",
            Self::Distance { .. } => "distance",
        }
    }

    /// Number of its equations.
    pub fn equations(self) -> usize {
        match self {
            Self::Ball | Self::Planar => 3,
            Self::Hinge | Self::Slider => 5,
            Self::Cylindrical | Self::Universal => 4,
            Self::Weld => 6,
            Self::Distance { .. } => 1,
        }
    }

    /// What it leaves free and can be measured, driven and braked: of a cylindrical joint the angle about `a_1` and the displacement along it, of a universal joint
    /// the angle about `a_1` from side a to the cross and the one about `b_2` from the cross to side b.
    pub fn coordinates(self) -> &'static [CoordinateKind] {
        use CoordinateKind::{Angle, Displacement};
        match self {
            Self::Hinge => &[Angle],
            Self::Slider => &[Displacement],
            Self::Cylindrical => &[Angle, Displacement],
            Self::Universal => &[Angle, Angle],
            _ => &[],
        }
    }

    /// The invariants of a coordinate: sine and cosine of an angle, or a displacement.
    ///
    /// With `b_2` at right angles to `a_1` the angle about `a_1` has `s = a_3 . b_2`, `c = a_2 . b_2` in all of these joints. The second one of a universal joint is that of
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
        match self {
            Self::Ball | Self::Hinge | Self::Universal | Self::Weld => 3,
            Self::Slider | Self::Cylindrical => 2,
            Self::Planar | Self::Distance { .. } => 1,
        }
    }

    /// The equations; products of directions are multiplied by `length`.
    pub(crate) fn functions(self, length: f64) -> Vec<Function> {
        let point = || E.map(|e| Function::of(1.0, ARM, e)).to_vec();
        let along = |axes: &[usize]| axes.iter().map(|&k| Function::of(1.0, ARM, A[k])).collect::<Vec<_>>();
        let right =
            |pairs: &[(usize, usize)]| pairs.iter().map(|&(i, j)| Function::of(length, A[i], B[j])).collect::<Vec<_>>();
        let axis: &[(usize, usize)] = &[(0, 1), (0, 2)];
        let all: &[(usize, usize)] = &[(0, 1), (0, 2), (1, 2)];
        let (mut functions, directions) = match self {
            Self::Ball => (point(), Vec::new()),
            Self::Hinge => (point(), right(axis)),
            Self::Slider => (along(&[1, 2]), right(all)),
            Self::Cylindrical => (along(&[1, 2]), right(axis)),
            Self::Universal => (point(), right(&axis[..1])),
            Self::Planar => (along(&[0]), right(axis)),
            Self::Weld => (point(), right(all)),
            Self::Distance { length } => {
                (vec![Function { constant: -0.5 * length, products: vec![(0.5 / length, ARM, ARM)] }], Vec::new())
            }
        };
        functions.extend(directions);
        functions
    }

    /// Axes that are the same on both sides.
    pub(crate) fn common_axes(self) -> &'static [usize] {
        match self {
            Self::Ball | Self::Universal | Self::Distance { .. } => &[],
            Self::Hinge | Self::Cylindrical | Self::Planar => &[0],
            Self::Slider | Self::Weld => &[0, 1, 2],
        }
    }
}

/// The forms in the order of [`ARM`], [`A`], [`B`], [`E`].
pub(crate) fn forms(a: &Frame, b: &Frame) -> [Embedded; 10] {
    let e = |k: usize| Embedded::ground(std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }));
    let [a1, a2, a3] = a.axes.clone();
    let [b1, b2, b3] = b.axes.clone();
    [b.point.plus(-1.0, &a.point), a1, a2, a3, b1, b2, b3, e(0), e(1), e(2)]
}
