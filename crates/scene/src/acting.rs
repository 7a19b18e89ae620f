//! What acts on a coordinate of a joint: motor, limits, friction, spring, pretension.

use crate::Series;
use crate::read::{Node, Table};
use crate::world::{World, before_end};
use stoss_multibody::CoordinateKind;
use stoss_scene_derive::table;

/// Motor, limits, friction and spring on the second coordinate of a joint, with the keys of the first one: `second = { friction = { viscous = 2.0 }, limits = [-0.1, 0.1] }`.
#[table(example = "{ friction = { viscous = 0.1 } }", context(Coordinate), check = acting)]
pub struct ActingOn {
    /// Prescribed relative motion.
    pub motor: Option<Motor>,
    /// Smallest and largest value, in degrees or a length; the interval contains 0. Not with a motor.
    #[key(dimension = [Angle, Length], read = limits)]
    pub limits: Option<[f64; 2]>,
    /// Friction.
    pub friction: Option<JointFriction>,
    /// Spring and damper.
    pub spring: Option<JointSpring>,
}

/// Prescribed relative motion of a joint, from zero at the start: exactly one of the two.
#[table(example = "{ angle = { table = [[0.0, 0.0], [1.0, 90.0]] } }", context(Coordinate), check = motor)]
pub struct Motor {
    /// Angle in degrees, as a function of time; may exceed 360.
    #[key(dimension = Angle, read = |node| Series::of(node, 1))]
    pub angle: Option<Series>,
    /// Displacement (length), as a function of time.
    #[key(dimension = Length, read = |node| Series::of(node, 1))]
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
#[table(example = "{ force = { table = [[0.0, 0.0], [1.0, 2e4]] }, lock = 1.0 }", context(World<'_>))]
pub struct Pretension {
    /// Bolt force until the lock, positive in tension, as a function of time. Its work is external work.
    #[key(dimension = Force, example = "{ table = [[0.0, 0.0], [1.0, 2e4]] }", read = |node| Series::of(node, 1))]
    pub force: Series,
    /// Lock time, positive and at most the end of the run; a step ends there.
    #[key(dimension = Time, example = "1.0", by = before_end)]
    pub lock: f64,
}

/// Friction on the coordinate of a joint, a torque for an angle and a force for a displacement: `viscous` times the speed, plus Coulomb friction, either the constant `coulomb` or from the reaction
/// force of the joint, `coefficient * radius * |reaction|` for an angle and `coefficient * |reaction|` for a displacement.
#[table(example = "{ viscous = 0.1 }", context(Coordinate), check = friction)]
#[derive(Copy)]
pub struct JointFriction {
    /// Viscous coefficient: torque per angular velocity (radians per time), or force per velocity; not negative, 0 if left out.
    #[key(default, dimension = [MomentPerAngularVelocity, ForcePerVelocity], not_negative)]
    pub viscous: f64,
    /// Constant Coulomb friction, a torque or a force, not negative.
    #[key(dimension = [Moment, Force], not_negative)]
    pub coulomb: Option<f64>,
    /// Radius of the bearing (length), positive; for an angle, with `coefficient`.
    #[key(dimension = Length, positive)]
    pub radius: Option<f64>,
    /// Coefficient of friction, not negative; for an angle with `radius`.
    #[key(dimension = Number, not_negative)]
    pub coefficient: Option<f64>,
}

/// Spring and damper on a coordinate `s` of a joint: torque or force `-stiffness (s - rest) - damping ds/dt`. An angle is in
/// radians in this formula.
#[table(example = "{ stiffness = 10.0 }")]
#[derive(Copy)]
pub struct JointSpring {
    /// Stiffness: torque per radian or force per length, not negative.
    #[key(dimension = [Moment, ForcePerLength], example = "10.0", not_negative)]
    pub stiffness: f64,
    /// Value of the coordinate without force, in degrees or a length; 0 if left out.
    #[key(default, dimension = [Angle, Length])]
    pub rest: f64,
    /// Damping: torque per angular velocity (radians per time) or force per velocity, not negative; 0 if left out.
    #[key(default, dimension = [MomentPerAngularVelocity, ForcePerVelocity], not_negative)]
    pub damping: f64,
}

/// What the keys of a coordinate must know of it.
#[derive(Clone, Copy)]
pub(crate) struct Coordinate {
    pub(crate) kind: Option<CoordinateKind>,
    /// Whether it is an angle beside which the joint has a displacement as its second coordinate.
    pub(crate) slides_too: bool,
}

impl Coordinate {
    fn is(self, kind: CoordinateKind) -> bool {
        self.kind == Some(kind)
    }
}

fn acting(_: &ActingOnKeys, table: &Table<'_>, _: &Coordinate) -> Option<()> {
    if !["motor", "limits", "friction", "spring"].iter().any(|key| table.has(key)) {
        return table.missing("friction", "friction = { viscous = 0.1 }");
    }
    limits_act(table)
}

/// Reports limits beside a motor.
pub(crate) fn limits_act(table: &Table<'_>) -> Option<()> {
    if table.has("limits") && table.has("motor") {
        return table.fail("limits", "has no effect: the motor prescribes the motion", "remove it, or the motor");
    }
    Some(())
}

fn motor(_: &MotorKeys, table: &Table<'_>, coordinate: &Coordinate) -> Option<()> {
    use CoordinateKind::{Angle, Displacement};
    if coordinate.is(Displacement) && table.has("angle") {
        return table.fail("angle", "the coordinate is a displacement, not an angle", "write `displacement`");
    }
    if coordinate.is(Angle) && table.has("displacement") {
        let remedy = match coordinate.slides_too {
            true => "write second = { motor = { displacement = ... } }",
            false => "write `angle`",
        };
        return table.fail("displacement", "the coordinate is an angle, not a displacement", remedy);
    }
    match (table.has("angle"), table.has("displacement")) {
        (true, true) => table.fail("displacement", "`angle` is given too", "remove one of them"),
        (false, false) if coordinate.is(Displacement) => {
            table.missing("displacement", "displacement = { table = [[0.0, 0.0], [1.0, 0.1]] }")
        }
        (false, false) => table.missing("angle", "angle = { table = [[0.0, 0.0], [1.0, 90.0]] }"),
        _ => Some(()),
    }
}

/// Smallest and largest value of a coordinate.
pub(crate) fn limits(node: &Node<'_>) -> Option<[f64; 2]> {
    let limits: [f64; 2] = node.array(Node::number)?;
    if limits[0] >= limits[1] {
        return node.fail("must be a smaller and a larger value", "write for instance [-30, 30]");
    }
    if limits[0] > 0.0 || limits[1] < 0.0 {
        return node.fail("must contain 0, the value at the start", "measure from the initial position");
    }
    Some(limits)
}

fn friction(_: &JointFrictionKeys, table: &Table<'_>, coordinate: &Coordinate) -> Option<()> {
    use CoordinateKind::{Angle, Displacement};
    if coordinate.is(Displacement) && table.has("radius") {
        return table.fail("radius", "a displacement has no radius", "remove it");
    }
    match (table.has("coulomb"), table.has("coefficient"), table.has("radius")) {
        (true, true, _) => table.fail("coefficient", "`coulomb` is given too", "remove one of them"),
        (_, true, false) if coordinate.is(Angle) => table.missing("radius", "radius = 0.01"),
        (_, false, true) if !coordinate.is(Displacement) => {
            table.fail("radius", "has no effect without `coefficient`", "remove it, or add the coefficient")
        }
        (false, false, false) if !table.has("viscous") => table.missing("viscous", "viscous = 0.1"),
        _ => Some(()),
    }
}
