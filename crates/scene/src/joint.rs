//! `[[joint]]` and `[[spring]]`: what joins two parts.

use crate::Series;
use crate::coupling::Coupling;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The name that stands for what does not move.
pub const GROUND: &str = "ground";

named! {
    /// Kinds of joints.
    JointKind {
        /// Common point `at`.
        Ball = "ball",
        /// Common point and axis: one rotation is free.
        Hinge = "hinge",
        /// Common axis and no rotation: one translation is free.
        Slider = "slider",
        /// Common axis: rotation about it and translation along it are free.
        Cylindrical = "cylindrical",
        /// Common point, and two axes, the first of the first part and the second of the second, that stay perpendicular.
        Universal = "universal",
        /// No relative motion.
        Weld = "weld",
        /// Constant distance of two points.
        Distance = "distance",
        /// Common plane: two translations in it and the rotation about its normal are free.
        Planar = "planar",
    }
}

impl JointKind {
    /// True if the joint constrains rotations, so that both sides must have an orientation.
    pub fn needs_orientation(self) -> bool {
        !matches!(self, Self::Ball | Self::Distance)
    }

    /// True if it has an `axis`.
    pub fn has_axis(self) -> bool {
        matches!(self, Self::Hinge | Self::Slider | Self::Cylindrical | Self::Planar)
    }

    /// The relative coordinates that it leaves free and that motors, limits, friction and springs act on: of `cylindrical` the angle and the displacement, of
    /// `universal` the angle about the first axis and the one about the second.
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
}

/// What a relative coordinate of a joint is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateKind {
    /// An angle.
    Angle,
    /// A displacement.
    Displacement,
}

/// `[[joint]]`: a joint between two parts, or a part and the ground.
///
/// ```toml
/// [[joint]]
/// name = "elbow"
/// kind = "hinge"
/// between = ["upper", "lower"]
/// at = [0, 0, 1]
/// axis = [0, 1, 0]
/// motor = { angle = { table = [[0.0, 0.0], [1.0, 90.0]] } }
///
/// [[joint]]
/// name = "hanger"
/// kind = "ball"
/// between = ["block.top", "ground"]
/// at = [0, 0, 2]
/// coupling = "kinematic"
/// ```
///
/// Points and axes are given in space, in the initial configuration, and are then carried by both parts. The relative coordinate of a joint is that of the
/// second part against the first one, zero at the start; an angle is positive by the right-hand rule about `axis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Name, unique among joints, springs and what else has a name that `[[event]]` or `off` of `[[stage]]` may use.
    pub name: String,
    /// Kind of the joint.
    pub kind: JointKind,
    /// The two sides: a rigid body or point mass by its name, an end of a beam or string (`beam.start`, `string.end`), a beam by its name for the node that is
    /// nearest to `at`, a set of a deformable body (`body.set`), or `ground`.
    pub between: [String; 2],
    /// The point of the joint; of a `distance` two points, the first on the first part. A point mass or the end of a string must be there.
    pub at: JointPoint,
    /// Direction of the axis of `hinge`, `slider` and `cylindrical`, normal of `planar`; of any length but zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// Axes of `universal`, of the first and the second part, perpendicular to 1e-6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<[[f64; 3]; 2]>,
    /// How sets of deformable bodies are coupled to the joint's point; `distributing` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<Coupling>,
    /// Prescribed relative motion of the first coordinate: the angle of `hinge` and `cylindrical`, the displacement of `slider`, the angle of `universal` about its first axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motor: Option<Motor>,
    /// Pretension of a bolt whose two halves a `slider` along its axis connects. Not with a motor, limits or friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pretension: Option<Pretension>,
    /// Smallest and largest value of the first coordinate, around zero: degrees or a length. Not with a motor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
    /// Friction of the first coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<JointFriction>,
    /// Spring and damper of the first coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<JointSpring>,
    /// What acts on the second coordinate: the displacement of `cylindrical`, the angle of `universal` about its second axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second: Option<ActingOn>,
}

/// What acts on the second coordinate of a joint, with the keys of the first one: `second = { friction = { viscous = 2.0 }, limits = [-0.1, 0.1] }`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ActingOn {
    /// Prescribed relative motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motor: Option<Motor>,
    /// Smallest and largest value, around zero: degrees or a length. Not with a motor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
    /// Friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<JointFriction>,
    /// Spring and damper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<JointSpring>,
}

impl Joint {
    /// Each relative coordinate with what acts on it.
    pub fn coordinates(&self) -> Vec<(CoordinateKind, ActingOn)> {
        let Self { motor, limits, friction, spring, .. } = self;
        let first = ActingOn { motor: motor.clone(), limits: *limits, friction: *friction, spring: *spring };
        let acting = [first, self.second.clone().unwrap_or_default()];
        self.kind.coordinates().iter().copied().zip(acting).collect()
    }
}

/// One point, or the two of a `distance`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum JointPoint {
    /// `[0, 0, 1]`
    One([f64; 3]),
    /// `[[0, 0, 0], [0, 0, 1]]`
    Two([[f64; 3]; 2]),
}

impl JointPoint {
    /// The point on the first and the one on the second part, which are the same but for a `distance`.
    pub fn both(self) -> [[f64; 3]; 2] {
        match self {
            Self::One(point) => [point; 2],
            Self::Two(points) => points,
        }
    }
}

/// Prescribed relative motion of a joint, from zero at the start: exactly one of the two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Angle in degrees, one value; not limited to a turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle: Option<Series>,
    /// Displacement, one value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Series>,
}

/// Pretension of a bolt that is cut in two: a force along the axis pulls both sides of the cut together until the lock. From then on the relative displacement
/// keeps the value that it has, and the force of the bolt follows from the loads.
///
/// ```toml
/// [[joint]]
/// name = "cut"
/// kind = "slider"
/// between = ["head.cut", "shank.cut"]
/// at = [0, 0, 0.5]
/// axis = [0, 0, 1]
/// pretension = { force = { table = [[0.0, 0.0], [1.0, 2.0e4]] }, lock = 1.0 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Pretension {
    /// Force of the bolt until the lock, positive in tension, one value. Its work is external work.
    pub force: Series,
    /// Time of the lock, positive and at most the end of the run; a step ends there.
    pub lock: f64,
}

/// Friction of an angle (a torque) or a displacement (a force) against the motion: `viscous` times the speed, and either `coulomb` or what the reaction
/// of the joint gives, `coefficient radius |reaction|` of an angle and `coefficient |reaction|` of a displacement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JointFriction {
    /// Torque per angular speed (radians per time), or force per speed; not negative.
    #[serde(default)]
    pub viscous: f64,
    /// Constant torque or force, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<f64>,
    /// Radius of the bearing of an angle, positive; with `coefficient`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Coefficient of friction, not negative; with `radius` of an angle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coefficient: Option<f64>,
}

/// Spring and damper of a coordinate: torque or force `-stiffness (s - rest) - damping ds/dt`, where `s` is the relative coordinate, an angle in
/// radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JointSpring {
    /// Torque per radian or force per length, not negative.
    pub stiffness: f64,
    /// Coordinate without force: degrees of an angle, or a length; 0 if left out.
    #[serde(default)]
    pub rest: f64,
    /// Torque per angular speed (radians per time) or force per speed, not negative; 0 if left out.
    #[serde(default)]
    pub damping: f64,
}

/// `[[spring]]`: a spring and damper between two points.
///
/// ```toml
/// [[spring]]
/// name = "strut"
/// between = ["wheel", "ground"]
/// at = [[0, 0, 0.5], [0, 0, 1.5]]
/// stiffness = 2.0e4
/// damping = 150.0
/// ```
///
/// Its force along the line between the points is `stiffness (l - rest_length) + damping dl/dt`, with the distance `l`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Name, unique as that of a joint.
    pub name: String,
    /// The two sides, as those of a joint; sets of deformable bodies are coupled in the mean.
    pub between: [String; 2],
    /// The points on the first and the second side in the initial configuration, not the same.
    pub at: [[f64; 3]; 2],
    /// Force per length, not negative.
    pub stiffness: f64,
    /// Length without force, not negative; the distance of the points if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_length: Option<f64>,
    /// Force per speed, not negative; 0 if left out.
    #[serde(default)]
    pub damping: f64,
    /// `true`: without force while it is shorter than `rest_length`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
}
