//! Reads `[[joint]]` and `[[spring]]`.

use super::conditions::restitution;
use super::node::{Node, known};
use super::prescribe::series;
use super::table::Table;
use super::world::{World, action_name};
use crate::chosen::of_which;
use crate::vector::{norm, perpendicular, sub};
use crate::{
    ActingOn, Coupling, GROUND, Joint, JointFriction, JointKind, JointPoint, JointSpring, Kind, Motor, PartKind,
    Pretension, Spring, split_set,
};
use stoss_multibody::{CoordinateKind, Directions, JointEntry};
use toml::de::DeValue;

pub(super) fn joint(table: &Table<'_>, world: &World<'_>) -> Option<Joint> {
    let name = table.required("name", "name = \"elbow\"", action_name);
    let kind = table.required("kind", "kind = \"hinge\"", |n| n.choice(&JointKind::names(), JointKind::from_name));
    let between = table.required("between", "between = [\"lever\", \"ground\"]", |n| {
        between(n, world, kind.filter(|kind| kind.needs_orientation()))
    });
    let at = match kind {
        Some(kind) if kind.has_two_points() => {
            table.required("at", "at = [[0, 0, 0], [0, 0, 1]]", two_points).map(JointPoint::Two)
        }
        Some(_) => table.required("at", "at = [0, 0, 0]", one_point).map(JointPoint::One),
        None => {
            // How many points there are is not known.
            let _ = table.get("at");
            None
        }
    };
    let at = at.and_then(|at| in_place(table, between.as_ref(), at.both(), world).map(|()| at));
    let axis = only_for(table, "axis", kind, has_axis).and_then(|()| match kind {
        Some(kind) if has_axis(&kind) => table.required("axis", "axis = [0, 0, 1]", Node::direction).map(Some),
        _ => table.optional("axis", Node::direction),
    });
    let axes = only_for(table, "axes", kind, has_axes).and_then(|()| match kind {
        Some(kind) if has_axes(&kind) => table.required("axes", "axes = [[1, 0, 0], [0, 1, 0]]", two_axes).map(Some),
        _ => table.optional("axes", two_axes),
    });
    let coupling = coupling(table, between.as_ref(), world);
    let coordinate = kind.and_then(|kind| kind.coordinates.first().copied());
    let on_first = |key| only_for(table, key, kind, |kind| !kind.coordinates.is_empty());
    let motor = on_first("motor").and_then(|()| table.optional("motor", |n| motor(n, coordinate, kind)));
    let pretension = only_for(table, "pretension", kind, slides)
        .and_then(|()| table.optional("pretension", |n| pretension(n, table, world)));
    let limits = on_first("limits").and_then(|()| table.optional("limits", |n| limits(n, table.has("motor"))));
    let friction = on_first("friction").and_then(|()| table.optional("friction", |n| friction(n, coordinate)));
    let spring = on_first("spring").and_then(|()| table.optional("spring", joint_spring));
    let second = only_for(table, "second", kind, |kind| kind.coordinates.len() > 1).and_then(|()| {
        let coordinate = kind.and_then(|kind| kind.coordinates.get(1).copied());
        table.optional("second", |n| second(n, coordinate))
    });
    let has_limits = table.has("limits") || matches!(&second, Some(Some(second)) if second.limits.is_some());
    let restitution = table.optional("restitution", |n| {
        if world.kind == Some(Kind::QuasiStatic) {
            return n.fail("is for dynamic scenes only", "remove it");
        }
        if !has_limits {
            return n.fail("is a number of limits, and the joint has none", "remove it, or add `limits`");
        }
        restitution(n)
    });
    table.finish();
    Some(Joint {
        name: name?,
        kind: kind?,
        between: between?,
        at: at?,
        axis: axis?,
        axes: axes?,
        coupling: coupling?,
        motor: motor?,
        pretension: pretension?,
        limits: limits?,
        restitution: restitution?,
        friction: friction?,
        spring: spring?,
        second: second?,
    })
}

fn has_axis(kind: &JointEntry) -> bool {
    matches!(kind.directions, Directions::Axis | Directions::Normal)
}

fn has_axes(kind: &JointEntry) -> bool {
    kind.directions == Directions::Pair
}

/// Whether a displacement is all that it leaves free.
pub(super) fn slides(kind: &JointEntry) -> bool {
    kind.coordinates == [CoordinateKind::Displacement]
}

/// Reports a key that the joint's kind does not have.
fn only_for(
    table: &Table<'_>,
    key: &'static str,
    kind: Option<JointKind>,
    has: impl Fn(&JointEntry) -> bool,
) -> Option<()> {
    match kind {
        Some(kind) if table.has(key) && !has(&kind) => table.fail(
            key,
            format!("is for the kinds {}, not for `{kind}`", of_which(has)),
            "remove it, or choose another kind of joint",
        ),
        _ => {
            // The key is known, for the remedy of those that are not.
            let _ = table.get(key);
            Some(())
        }
    }
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
fn in_place(table: &Table<'_>, between: Option<&[String; 2]>, at: [[f64; 3]; 2], world: &World<'_>) -> Option<()> {
    for (side, point) in between.into_iter().flatten().zip(at) {
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

fn coupling(table: &Table<'_>, between: Option<&[String; 2]>, world: &World<'_>) -> Option<Option<Coupling>> {
    table.optional("coupling", |n| {
        let coupling = n.choice(Coupling::NAMES, Coupling::from_name)?;
        // A part that is not known may be a deformable body.
        let deformable = |side: &String| {
            split_set(side).is_some_and(|(name, _)| world.part(name).is_none_or(|part| part.kind == PartKind::Body))
        };
        if between.is_some_and(|sides| !sides.iter().any(deformable)) {
            return n.fail("is for sets of deformable bodies, and the joint has none", "remove it");
        }
        Some(coupling)
    })
}

/// What acts on the second coordinate.
fn second(node: &Node<'_>, coordinate: Option<CoordinateKind>) -> Option<ActingOn> {
    let table = node.table_like("{ friction = { viscous = 0.1 } }")?;
    let motor = table.optional("motor", |n| motor(n, coordinate, None));
    let limits = table.optional("limits", |n| limits(n, table.has("motor")));
    let friction = table.optional("friction", |n| friction(n, coordinate));
    let spring = table.optional("spring", joint_spring);
    let one = match ["motor", "limits", "friction", "spring"].iter().any(|key| table.has(key)) {
        true => Some(()),
        false => table.missing("friction", "friction = { viscous = 0.1 }"),
    };
    table.finish();
    one?;
    Some(ActingOn { motor: motor?, limits: limits?, friction: friction?, spring: spring? })
}

/// A motor of a coordinate; `kind` that of the joint if it is the first one.
fn motor(node: &Node<'_>, coordinate: Option<CoordinateKind>, kind: Option<JointKind>) -> Option<Motor> {
    use CoordinateKind::{Angle, Displacement};
    let table = node.table_like("{ angle = { table = [[0.0, 0.0], [1.0, 90.0]] } }")?;
    let angle = table.optional("angle", |n| {
        if coordinate == Some(Displacement) {
            return n.fail("the coordinate is a displacement, not an angle", "write `displacement`");
        }
        series(n, 1)
    });
    let displacement = table.optional("displacement", |n| {
        if coordinate == Some(Angle) {
            let remedy = match kind {
                Some(kind) if kind.coordinates.get(1) == Some(&Displacement) => {
                    "write second = { motor = { displacement = ... } }"
                }
                _ => "write `angle`",
            };
            return n.fail("the coordinate is an angle, not a displacement", remedy);
        }
        series(n, 1)
    });
    let one = match (table.has("angle"), table.has("displacement")) {
        (true, true) if coordinate.is_none() => {
            table.fail("displacement", "`angle` is given too", "remove one of them")
        }
        (false, false) if coordinate == Some(Displacement) => {
            table.missing("displacement", "displacement = { table = [[0.0, 0.0], [1.0, 0.1]] }")
        }
        (false, false) => table.missing("angle", "angle = { table = [[0.0, 0.0], [1.0, 90.0]] }"),
        _ => Some(()),
    };
    table.finish();
    one?;
    Some(Motor { angle: angle?, displacement: displacement? })
}

fn pretension(node: &Node<'_>, joint: &Table<'_>, world: &World<'_>) -> Option<Pretension> {
    let table = node.table_like("{ force = { table = [[0.0, 0.0], [1.0, 2e4]] }, lock = 1.0 }")?;
    let force = table.required("force", "force = { table = [[0.0, 0.0], [1.0, 2e4]] }", |n| series(n, 1));
    let lock = table.required("lock", "lock = 1.0", |n| {
        let time = n.positive()?;
        match world.end {
            Some(end) if time > end => {
                n.fail(format!("is after the end of the run, {end}"), "choose a time in the run")
            }
            _ => Some(time),
        }
    });
    table.finish();
    // Once the joint is locked, each of them would determine the same coordinate.
    if let Some(key) = ["motor", "limits", "friction"].into_iter().find(|&key| joint.has(key)) {
        let remedy = format!("remove it, or the {key}");
        return node
            .fail(format!("cannot be combined with `{key}`: after the lock both would prescribe the motion"), remedy);
    }
    Some(Pretension { force: force?, lock: lock? })
}

fn limits(node: &Node<'_>, has_motor: bool) -> Option<[f64; 2]> {
    let limits: [f64; 2] = node.array(Node::number)?;
    if limits[0] >= limits[1] {
        return node.fail("must be a smaller and a larger value", "write for instance [-30, 30]");
    }
    if limits[0] > 0.0 || limits[1] < 0.0 {
        return node.fail("must contain 0, the value at the start", "measure from the initial position");
    }
    if has_motor {
        return node.fail("has no effect: the motor prescribes the motion", "remove it, or the motor");
    }
    Some(limits)
}

fn friction(node: &Node<'_>, coordinate: Option<CoordinateKind>) -> Option<JointFriction> {
    use CoordinateKind::{Angle, Displacement};
    let table = node.table_like("{ viscous = 0.1 }")?;
    let viscous = table.default("viscous", 0.0, Node::not_negative);
    let coulomb = table.optional("coulomb", Node::not_negative);
    let coefficient = table.optional("coefficient", Node::not_negative);
    let radius = table.optional("radius", |n| {
        if coordinate == Some(Displacement) {
            return n.fail("a displacement has no radius", "remove it");
        }
        n.positive()
    });
    let fits = match (table.has("coulomb"), table.has("coefficient"), table.has("radius")) {
        (true, true, _) => table.fail("coefficient", "`coulomb` is given too", "remove one of them"),
        (_, true, false) if coordinate == Some(Angle) => table.missing("radius", "radius = 0.01"),
        (_, false, true) if coordinate != Some(Displacement) => {
            table.fail("radius", "has no effect without `coefficient`", "remove it, or add the coefficient")
        }
        (false, false, false) if !table.has("viscous") => table.missing("viscous", "viscous = 0.1"),
        _ => Some(()),
    };
    table.finish();
    fits?;
    Some(JointFriction { viscous: viscous?, coulomb: coulomb?, radius: radius?, coefficient: coefficient? })
}

fn joint_spring(node: &Node<'_>) -> Option<JointSpring> {
    let table = node.table_like("{ stiffness = 10.0 }")?;
    let stiffness = table.required("stiffness", "stiffness = 10.0", Node::not_negative);
    let rest = table.default("rest", 0.0, Node::number);
    let damping = table.default("damping", 0.0, Node::not_negative);
    table.finish();
    Some(JointSpring { stiffness: stiffness?, rest: rest?, damping: damping? })
}

pub(super) fn spring(table: &Table<'_>, world: &World<'_>) -> Option<Spring> {
    let name = table.required("name", "name = \"strut\"", action_name);
    let between = table.required("between", "between = [\"wheel\", \"ground\"]", |n| between(n, world, None));
    let at = table.required("at", "at = [[0, 0, 0], [0, 0, 1]]", two_points);
    let at = at.and_then(|at| in_place(table, between.as_ref(), at, world).map(|()| at));
    let stiffness = table.required("stiffness", "stiffness = 1e4", Node::not_negative);
    let rest_length = table.optional("rest_length", Node::not_negative);
    let damping = table.default("damping", 0.0, Node::not_negative);
    let tension_only = table.default("tension_only", false, Node::boolean);
    table.finish();
    Some(Spring {
        name: name?,
        between: between?,
        at: at?,
        stiffness: stiffness?,
        rest_length: rest_length?,
        damping: damping?,
        tension_only: tension_only?,
    })
}

/// The kind of a joint, if it can be read; nothing is reported.
pub(super) fn raw_kind(table: &Table<'_>) -> Option<JointKind> {
    match table.get("kind")?.value {
        DeValue::String(name) => JointKind::from_name(name),
        _ => None,
    }
}
