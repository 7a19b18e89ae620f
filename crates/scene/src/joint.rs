//! `[[joint]]` and `[[spring]]`: connections of two parts.

use crate::acting::{Coordinate, limits, limits_act};
use crate::chosen::{Chosen, Rows, of_which};
use crate::coupling::Coupling;
use crate::read::{Node, Table, Value};
use crate::spelling::known;
use crate::vector::{norm, perpendicular, sub};
use crate::world::{World, action_name};
use crate::{ActingOn, JointFriction, JointSpring, Kind, Motor, PartKind, Pretension, split_set};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use stoss_multibody::{CoordinateKind, Directions, JOINTS, JointEntry};
use stoss_scene_derive::table;
use toml::de::DeValue;

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
#[table(context(World<'_>), check = joint)]
pub struct Joint {
    /// Name, unique among joints, springs, contacts, prescribed motions and loads: letters, digits, `-` and `_`.
    #[key(example = "\"elbow\"", read = action_name)]
    pub name: String,
    /// Kind of the joint.
    #[key(example = "\"hinge\"")]
    pub kind: JointKind,
    /// The two sides: the name of a rigid body or point mass, an end of a beam or string (`beam.start`, `string.end`), the name of a beam for its node
    /// nearest to `at`, a set of a deformable body (`body.set`), or `ground`.
    #[key(example = "[\"lever\", \"ground\"]", with = |node, world, keys| between(node, world, keys.oriented()))]
    pub between: [String; 2],
    /// Position of the joint (three lengths); for `distance` two points, the first on the first part. A point mass or the end of a string must be at this point.
    #[key(dimension = Length, example = "[0, 0, 0]", with = point)]
    pub at: JointPoint,
    /// Direction of the axis, or normal, of kinds that have one, of any length but zero; required for them.
    #[key(dimension = Number, direction)]
    pub axis: Option<[f64; 3]>,
    /// The two axes of kinds that have two, fixed to the first and the second part, perpendicular to 1e-6; required for them.
    #[key(dimension = Number, read = two_axes)]
    pub axes: Option<[[f64; 3]; 2]>,
    /// Coupling of sets of deformable bodies to the point of the joint; `distributing` if left out.
    pub coupling: Option<Coupling>,
    /// Motor: prescribed motion of the first coordinate; none if left out.
    #[key(with = |node, _, keys| Motor::read(node, &keys.coordinate(0)))]
    pub motor: Option<Motor>,
    /// Pretension of a bolt that is cut in two halves, which a `slider` along its axis connects; none if left out. Not with a motor, limits or friction.
    pub pretension: Option<Pretension>,
    /// Smallest and largest value of the first coordinate, in degrees or a length; the interval contains 0. No limits if left out. Not with a motor.
    #[key(dimension = [Angle, Length], read = limits)]
    pub limits: Option<[f64; 2]>,
    /// Coefficient of restitution at the limits of the joint, from 0 (plastic) to 1; 0 if left out. Dynamic scenes only.
    #[key(dimension = Number, restitution)]
    pub restitution: Option<f64>,
    /// Friction on the first coordinate; none if left out.
    #[key(with = |node, _, keys| JointFriction::read(node, &keys.coordinate(0)))]
    pub friction: Option<JointFriction>,
    /// Spring and damper on the first coordinate; none if left out.
    pub spring: Option<JointSpring>,
    /// Motor, limits, friction and spring on the second coordinate; none if left out.
    #[key(with = |node, _, keys| ActingOn::read(node, &keys.coordinate(1)))]
    pub second: Option<ActingOn>,
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
#[table(context(World<'_>), check = spring)]
pub struct Spring {
    /// Name, unique as that of a joint.
    #[key(example = "\"strut\"", read = action_name)]
    pub name: String,
    /// The two sides, as of a joint; sets of deformable bodies have a distributing coupling.
    #[key(example = "[\"wheel\", \"ground\"]", with = |node, world, _| between(node, world, None))]
    pub between: [String; 2],
    /// The points on the first and the second side in the initial configuration (three lengths each); they must differ.
    #[key(dimension = Length, example = "[[0, 0, 0], [0, 0, 1]]", read = two_points)]
    pub at: [[f64; 3]; 2],
    /// Stiffness: force per length, not negative.
    #[key(dimension = ForcePerLength, example = "1e4", not_negative)]
    pub stiffness: f64,
    /// Length without force, not negative; the initial distance of the points if left out.
    #[key(dimension = Length, not_negative)]
    pub rest_length: Option<f64>,
    /// Damping: force per velocity, not negative; 0 if left out.
    #[key(default, dimension = ForcePerVelocity, not_negative)]
    pub damping: f64,
    /// `true`: no force while the spring is shorter than `rest_length`. `false` if left out.
    #[key(default, skip)]
    pub tension_only: bool,
}

impl JointKeys {
    /// The kind, if it needs an orientation of both sides.
    fn oriented(&self) -> Option<JointKind> {
        self.kind.filter(|kind| kind.needs_orientation())
    }

    fn coordinate(&self, number: usize) -> Coordinate {
        let coordinate = |number| self.kind.and_then(|kind| kind.coordinates.get(number).copied());
        let slides_too = number == 0 && coordinate(1) == Some(CoordinateKind::Displacement);
        Coordinate { kind: coordinate(number), slides_too }
    }
}

/// Whether a joint of a kind has a key.
type HasKey = fn(&JointEntry) -> bool;

/// Keys that not every kind of joint has.
const OF_KINDS: [(&str, HasKey); 8] = [
    ("axis", has_axis),
    ("axes", has_axes),
    ("motor", has_coordinate),
    ("pretension", slides),
    ("limits", has_coordinate),
    ("friction", has_coordinate),
    ("spring", has_coordinate),
    ("second", |kind| kind.coordinates.len() > 1),
];

fn has_coordinate(kind: &JointEntry) -> bool {
    !kind.coordinates.is_empty()
}

fn joint(keys: &JointKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let place = match (keys.at, &keys.between) {
        (Some(at), Some(between)) => in_place(table, between, at.both(), world),
        _ => Some(()),
    };
    let mut of_kind = Some(());
    if let Some(kind) = keys.kind {
        for (key, has) in OF_KINDS.into_iter().filter(|(key, has)| table.has(key) && !has(&kind)) {
            let message = format!("is for the kinds {}, not for `{kind}`", of_which(has));
            of_kind = table.fail(key, message, "remove it, or choose another kind of joint");
        }
        for (key, has, example) in
            [("axis", has_axis as HasKey, "axis = [0, 0, 1]"), ("axes", has_axes, "axes = [[1, 0, 0], [0, 1, 0]]")]
        {
            if has(&kind) && !table.has(key) {
                of_kind = table.missing(key, example);
            }
        }
    }
    let coupling = match (&keys.coupling, &keys.between) {
        (Some(Some(_)), Some(sides)) if !sides.iter().any(|side| may_be_deformable(side, world)) => {
            table.fail("coupling", "is for sets of deformable bodies, and the joint has none", "remove it")
        }
        _ => Some(()),
    };
    let limits = limits_act(table);
    let pretension = if keys.kind.is_some_and(|kind| slides(&kind)) { pretension_acts(table) } else { Some(()) };
    [place, of_kind, coupling, limits, restitution_acts(keys, table, world), pretension].into_iter().collect()
}

/// A part that is not known may be a deformable body.
fn may_be_deformable(side: &str, world: &World<'_>) -> bool {
    split_set(side).is_some_and(|(name, _)| world.part(name).is_none_or(|part| part.kind == PartKind::Body))
}

fn restitution_acts(keys: &JointKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    if !table.has("restitution") {
        return Some(());
    }
    if world.kind == Some(Kind::QuasiStatic) {
        return table.fail("restitution", "is for dynamic scenes only", "remove it");
    }
    let second_has_limits = matches!(&keys.second, Some(Some(second)) if second.limits.is_some());
    if !table.has("limits") && !second_has_limits {
        let remedy = "remove it, or add `limits`";
        return table.fail("restitution", "is a number of limits, and the joint has none", remedy);
    }
    Some(())
}

/// Once the joint is locked, each of these keys would determine the same coordinate.
fn pretension_acts(table: &Table<'_>) -> Option<()> {
    match ["motor", "limits", "friction"].into_iter().find(|&key| table.has(key)) {
        Some(key) if table.has("pretension") => table.fail(
            "pretension",
            format!("cannot be combined with `{key}`: after the lock both would prescribe the motion"),
            format!("remove it, or the {key}"),
        ),
        _ => Some(()),
    }
}

fn spring(keys: &SpringKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    match (keys.at, &keys.between) {
        (Some(at), Some(between)) => in_place(table, between, at, world),
        _ => Some(()),
    }
}

/// The point of a joint, or the two of a kind that has two.
fn point(node: &Node<'_>, _: &World<'_>, keys: &JointKeys) -> Option<JointPoint> {
    // Without a kind it is not known how many points there are.
    if keys.kind?.has_two_points() {
        two_points(node).map(JointPoint::Two)
    } else {
        one_point(node).map(JointPoint::One)
    }
}

fn has_axis(kind: &JointEntry) -> bool {
    matches!(kind.directions, Directions::Axis | Directions::Normal)
}

fn has_axes(kind: &JointEntry) -> bool {
    kind.directions == Directions::Pair
}

/// Whether a displacement is all that it leaves free.
pub(crate) fn slides(kind: &JointEntry) -> bool {
    kind.coordinates == [CoordinateKind::Displacement]
}

/// Two sides that are not the same. `oriented`: the kind of joint, if both must have an orientation.
fn between(node: &Node<'_>, world: &World<'_>, oriented: Option<JointKind>) -> Option<[String; 2]> {
    let sides: [String; 2] = node.array(|n| side(n, world, oriented))?;
    if sides[0] == sides[1] {
        return node.fail("joins a part to itself", "name two sides, for instance [\"lever\", \"ground\"]");
    }
    Some(sides)
}

fn side(node: &Node<'_>, world: &World<'_>, oriented: Option<JointKind>) -> Option<String> {
    if node.string_value() == Some(GROUND) {
        return Some(GROUND.to_owned());
    }
    let text = world.sets.reference(node)?;
    let (name, set) = match split_set(&text) {
        Some((name, set)) => (name, Some(set)),
        None => (text.as_str(), None),
    };
    if set.is_none() && world.parts_complete && world.part(name).is_none() {
        let names = world.parts.iter().map(|part| part.name.as_str()).chain([GROUND]);
        return node.fail(format!("there is no part `{name}`"), known(name, names));
    }
    let Some(part) = world.find(node, name)? else { return Some(text) };
    let noun = part.kind.noun();
    match (part.kind, set) {
        (PartKind::Body, None) => {
            return node.fail(format!("is {noun}: a joint needs a set of it"), format!("write \"{name}.set\""));
        }
        (PartKind::Beam, Some(set)) if !matches!(set, "start" | "end") => {
            return node.fail(
                format!("`{name}` is {noun}, joined at one of its ends or at the node nearest to `at`"),
                format!("write \"{name}.start\", \"{name}.end\" or \"{name}\""),
            );
        }
        (PartKind::String, set) if !matches!(set, Some("start" | "end")) => {
            return node.fail(
                format!("`{name}` is {noun}, joined at one of its ends"),
                format!("write \"{name}.start\" or \"{name}.end\""),
            );
        }
        (PartKind::Rigid | PartKind::Mass, Some(_)) => {
            return node.fail(format!("`{name}` is {noun}, joined as a whole"), format!("write \"{name}\""));
        }
        _ => {}
    }
    if let Some(kind) = oriented
        && matches!(part.kind, PartKind::Mass | PartKind::String)
    {
        return node.fail(
            format!("`{name}` is {noun}, which has no orientation for the joint `{kind}`"),
            format!("use one of the kinds {}", of_which::<JointEntry>(|kind| !kind.needs_orientation())),
        );
    }
    Some(text)
}

/// Reports a point that is not where a point mass or the end of a string is, which cannot carry it at a distance.
fn in_place(table: &Table<'_>, between: &[String; 2], at: [[f64; 3]; 2], world: &World<'_>) -> Option<()> {
    for (side, point) in between.iter().zip(at) {
        let (name, end) = split_set(side).map_or((side.as_str(), 0), |(name, set)| (name, usize::from(set == "end")));
        let Some(place) = world.part(name).and_then(|part| part.ends).map(|ends| ends[end]) else { continue };
        if norm(sub(place, point)) > 1e-6 * norm(place).max(norm(point)) {
            return table.fail("at", format!("is not where `{side}` is, {place:?}"), "correct the point or the part");
        }
    }
    Some(())
}

/// True for a list that starts with a list.
fn is_nested(node: &Node<'_>) -> bool {
    matches!(node.value, DeValue::Array(items) if items.first().is_some_and(|item| item.get_ref().is_array()))
}

fn one_point(node: &Node<'_>) -> Option<[f64; 3]> {
    if is_nested(node) {
        let two = of_which(JointEntry::has_two_points);
        return node.fail("must be one point", format!("write for instance [0, 0, 1]; two have the kinds {two}"));
    }
    node.vector()
}

fn two_points(node: &Node<'_>) -> Option<[[f64; 3]; 2]> {
    if node.value.is_array() && !is_nested(node) {
        return node.fail("must be two points, one on each part", "write for instance [[0, 0, 0], [0, 0, 1]]");
    }
    let points: [[f64; 3]; 2] = node.array(Node::vector)?;
    if points[0] == points[1] {
        return node.fail("is the same point twice", "give a point on each part");
    }
    Some(points)
}

fn two_axes(node: &Node<'_>) -> Option<[[f64; 3]; 2]> {
    let axes: [[f64; 3]; 2] = node.array(Node::direction)?;
    if !perpendicular(axes[0], axes[1]) {
        return node.fail("must be perpendicular, to 1e-6", "correct one of the axes");
    }
    Some(axes)
}
