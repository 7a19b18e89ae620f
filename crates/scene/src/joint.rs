//! `[[joint]]` and `[[spring]]`: connections of two parts.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::Series;
use crate::chosen::{Chosen, Rows};
use crate::coupling::Coupling;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stoss_multibody::{CoordinateKind, Directions, JOINTS, JointEntry};

/// Name of the ground, which does not move.
pub const GROUND: &str = "ground";

/// A kind of joint: a row of `stoss_multibody::JOINTS`.
///
/// # How to add one
/// A row of that table; nothing here.
pub type JointKind = Chosen<JointEntry>;

impl Rows for JointEntry {
    const ROWS: &'static [Self] = JOINTS;
    const TITLE: [&'static str; 2] = ["JointKind", "Kinds of joints."];

    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> String {
        let given = match self.directions {
            Directions::None => "",
            Directions::Axis => " Has an `axis`.",
            Directions::Normal => " Its `axis` is the normal of the plane.",
            Directions::Pair => " Has two `axes`.",
        };
        let coordinates: Vec<&str> = self.coordinates.iter().map(|of| noun(*of)).collect();
        let coordinates = match &coordinates[..] {
            [] => String::new(),
            [one] => format!(" Coordinate: {one}."),
            several => format!(" Coordinates: {}.", several.join(", then ")),
        };
        format!("{}{given}{coordinates}", self.about)
    }
}

/// A coordinate in words.
fn noun(kind: CoordinateKind) -> &'static str {
    match kind {
        CoordinateKind::Angle => "an angle",
        CoordinateKind::Displacement => "a displacement",
    }
}

/// `[[joint]]`: a joint between two parts, or between a part and the ground.
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
/// Points and axes are given in space in the initial configuration, and then move with both parts. The relative coordinate of a joint is the motion of the
/// second part relative to the first one, zero at the start; an angle is positive by the right-hand rule about `axis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Name, unique among joints, springs, contacts, prescribed motions and loads: letters, digits, `-` and `_`.
    pub name: String,
    /// Kind of the joint.
    pub kind: JointKind,
    /// The two sides: the name of a rigid body or point mass, an end of a beam or string (`beam.start`, `string.end`), the name of a beam for its node
    /// nearest to `at`, a set of a deformable body (`body.set`), or `ground`.
    pub between: [String; 2],
    /// Position of the joint (three lengths); for `distance` two points, the first on the first part. A point mass or the end of a string must be at this point.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub at: JointPoint,
    /// Direction of the axis, or normal, of kinds that have one, of any length but zero; required for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub axis: Option<[f64; 3]>,
    /// The two axes of kinds that have two, fixed to the first and the second part, perpendicular to 1e-6; required for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub axes: Option<[[f64; 3]; 2]>,
    /// Coupling of sets of deformable bodies to the point of the joint; `distributing` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<Coupling>,
    /// Motor: prescribed motion of the first coordinate; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motor: Option<Motor>,
    /// Pretension of a bolt that is cut in two halves, which a `slider` along its axis connects; none if left out. Not with a motor, limits or friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pretension: Option<Pretension>,
    /// Smallest and largest value of the first coordinate, in degrees or a length; the interval contains 0. No limits if left out. Not with a motor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::Angle, Dimension::Length])))]
    pub limits: Option<[f64; 2]>,
    /// Coefficient of restitution at the limits of the joint, from 0 (plastic) to 1; 0 if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub restitution: Option<f64>,
    /// Friction on the first coordinate; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<JointFriction>,
    /// Spring and damper on the first coordinate; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<JointSpring>,
    /// Motor, limits, friction and spring on the second coordinate; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second: Option<ActingOn>,
}

/// Motor, limits, friction and spring on the second coordinate of a joint, with the keys of the first one: `second = { friction = { viscous = 2.0 }, limits = [-0.1, 0.1] }`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ActingOn {
    /// Prescribed relative motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motor: Option<Motor>,
    /// Smallest and largest value, in degrees or a length; the interval contains 0. Not with a motor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::Angle, Dimension::Length])))]
    pub limits: Option<[f64; 2]>,
    /// Friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<JointFriction>,
    /// Spring and damper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<JointSpring>,
}

impl Joint {
    /// Each relative coordinate with its motor, limits, friction and spring.
    pub fn coordinates(&self) -> Vec<(CoordinateKind, ActingOn)> {
        let Self { motor, limits, friction, spring, .. } = self;
        let first = ActingOn { motor: motor.clone(), limits: *limits, friction: *friction, spring: *spring };
        let acting = [first, self.second.clone().unwrap_or_default()];
        self.kind.coordinates.iter().copied().zip(acting).collect()
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
    /// Angle in degrees, as a function of time; may exceed 360.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Angle)))]
    pub angle: Option<Series>,
    /// Displacement (length), as a function of time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub displacement: Option<Series>,
}

/// Pretension of a bolt that is cut in two: until the lock time a given force along the axis pulls both sides of the cut together. After it the relative displacement
/// is constant, and the bolt force follows from the loads. The axis points from the first side of `between` to the second: here the shank ends below the cut, and the
/// head begins above it.
///
/// ```toml
/// [[joint]]
/// name = "cut"
/// kind = "slider"
/// between = ["shank.cut", "head.cut"]
/// at = [0, 0, 0.5]
/// axis = [0, 0, 1]
/// coupling = "kinematic"
/// pretension = { force = { table = [[0.0, 0.0], [1.0, 2.0e4]] }, lock = 1.0 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Pretension {
    /// Bolt force until the lock, positive in tension, as a function of time. Its work is external work.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Force)))]
    pub force: Series,
    /// Lock time, positive and at most the end of the run; a step ends there.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Time)))]
    pub lock: f64,
}

/// Friction on the coordinate of a joint, a torque for an angle and a force for a displacement: `viscous` times the speed, plus Coulomb friction, either the constant `coulomb` or from the reaction
/// force of the joint, `coefficient * radius * |reaction|` for an angle and `coefficient * |reaction|` for a displacement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JointFriction {
    /// Viscous coefficient: torque per angular velocity (radians per time), or force per velocity; not negative, 0 if left out.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::MomentPerAngularVelocity, Dimension::ForcePerVelocity])))]
    pub viscous: f64,
    /// Constant Coulomb friction, a torque or a force, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::Moment, Dimension::Force])))]
    pub coulomb: Option<f64>,
    /// Radius of the bearing (length), positive; for an angle, with `coefficient`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: Option<f64>,
    /// Coefficient of friction, not negative; for an angle with `radius`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub coefficient: Option<f64>,
}

/// Spring and damper on a coordinate `s` of a joint: torque or force `-stiffness (s - rest) - damping ds/dt`. An angle is in
/// radians in this formula.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JointSpring {
    /// Stiffness: torque per radian or force per length, not negative.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::Moment, Dimension::ForcePerLength])))]
    pub stiffness: f64,
    /// Value of the coordinate without force, in degrees or a length; 0 if left out.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::Angle, Dimension::Length])))]
    pub rest: f64,
    /// Damping: torque per angular velocity (radians per time) or force per velocity, not negative; 0 if left out.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::MomentPerAngularVelocity, Dimension::ForcePerVelocity])))]
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
/// Its force along the line between the points, positive in tension, is `stiffness (l - rest_length) + damping dl/dt`, with the distance `l`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Name, unique as that of a joint.
    pub name: String,
    /// The two sides, as of a joint; sets of deformable bodies have a distributing coupling.
    pub between: [String; 2],
    /// The points on the first and the second side in the initial configuration (three lengths each); they must differ.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub at: [[f64; 3]; 2],
    /// Stiffness: force per length, not negative.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::ForcePerLength)))]
    pub stiffness: f64,
    /// Length without force, not negative; the initial distance of the points if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub rest_length: Option<f64>,
    /// Damping: force per velocity, not negative; 0 if left out.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::ForcePerVelocity)))]
    pub damping: f64,
    /// `true`: no force while the spring is shorter than `rest_length`. `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
}
