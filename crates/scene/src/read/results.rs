//! Reads `[[probe]]`, `[output]`, `[watch]`, `[expect]`.

use super::joint::slides;
use super::node::{Node, known};
use super::table::Table;
use super::world::{KnownProbe, World, part_name, set_reference};
use crate::chosen::of_which;
use crate::{
    Expect, ExpectedValue, Extremum, Field, FrameFormat, Interval, Kind, OnFault, Outcome, Output, PartKind, Probe,
    ProbeComponent, Quantity, Verdict, Watch,
};
use stoss_multibody::{CoordinateKind, JointEntry};

/// The probe, and its name with the components of its values, which `[expect]` needs even if the rest is bad.
pub(super) fn probe(table: &Table<'_>, world: &World<'_>) -> (Option<Probe>, Option<KnownProbe>) {
    let name = table.required("name", "name = \"tip\"", Node::name);
    let quantity = table.required("quantity", "quantity = \"displacement\"", |n| {
        let quantity = n.choice(Quantity::NAMES, Quantity::from_name)?;
        if quantity.is_dynamic() && world.kind == Some(Kind::QuasiStatic) {
            return n.fail("needs inertia", "choose another quantity, or set [scene] kind = \"dynamic\"");
        }
        if matches!(quantity, Quantity::ContactForce | Quantity::ContactMoment)
            && !world.has_contact
            && !world.has_general_contact
            && !world.has_tie
        {
            return n.fail("needs contact, and the scene has none", "add a [[contact]] or choose another quantity");
        }
        if matches!(quantity, Quantity::Reaction | Quantity::ReactionMoment) && !world.has_prescribed {
            let remedy = if world.has_elastic_support && quantity == Quantity::Reaction {
                "choose `support_force`, the force of [[support]], or add a [[prescribe]]"
            } else {
                "add a [[prescribe]] or choose another quantity"
            };
            return n.fail("needs prescribed motion, and the scene has none", remedy);
        }
        if quantity == Quantity::SupportForce && !world.has_elastic_support {
            return n.fail(
                "needs an elastic support, and the scene has none",
                "add a [[support]], or choose `reaction` for the forces of [[prescribe]]",
            );
        }
        Some(quantity)
    });
    let set = table.optional("set", |n| set_reference(n, world));
    let body = table.optional("body", |n| part_name(n, world));
    let point = table.optional("point", Node::vector);
    let joint = table.optional("joint", |n| joint(n, quantity, world));
    let equation = table.optional("equation", |n| equation(n, world));
    let reduce = table.optional("reduce", |n| {
        let reduce = n.choice(Extremum::NAMES, Extremum::from_name)?;
        match quantity {
            Some(quantity) if !quantity.has_extrema() => {
                let names = Quantity::NAMES.iter().copied();
                let names = names.filter(|name| Quantity::from_name(name).is_some_and(Quantity::has_extrema));
                let list = names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
                n.fail(format!("`{quantity}` has no value at each node"), format!("extrema are available of {list}"))
            }
            _ => Some(reduce),
        }
    });
    let component = reduced_component(table, quantity);
    let place = match quantity {
        // Reported already.
        Some(quantity) if table.has("reduce") && !quantity.has_extrema() => Some(()),
        Some(quantity) if table.has("reduce") => {
            let part = body.as_ref().and_then(|body| body.as_deref()).and_then(|name| world.part(name));
            extremum_place(table, quantity, part.map(|part| part.kind))
        }
        Some(quantity) if quantity.is_of_material() => {
            let part = body.as_ref().and_then(|body| body.as_deref()).and_then(|name| world.part(name));
            material_place(table, quantity, part.map(|part| part.kind))
        }
        Some(quantity) if quantity.is_of_equation() => {
            let keys = ["set", "body", "point", "joint"];
            let place = refuse(table, &keys, || format!("`{quantity}` belongs to an equation"));
            if table.has("equation") { place } else { table.missing("equation", "equation = \"lever\"") }
        }
        Some(quantity) if quantity.is_of_joint() => {
            let place = refuse(table, &["set", "body", "point"], || format!("`{quantity}` belongs to a joint"));
            if table.has("joint") { place } else { table.missing("joint", "joint = \"elbow\"") }
        }
        Some(quantity) => {
            let joint = refuse(table, &["joint"], || format!("`{quantity}` does not belong to a joint"));
            let part = body.as_ref().and_then(|body| body.as_deref()).and_then(|name| world.part(name));
            let place = match quantity {
                Quantity::AngularVelocity => rigid_place(table, part.map(|part| part.kind)),
                quantity if quantity.is_nodal() => nodal_place(table, quantity, part.map(|part| part.kind)),
                _ => refuse(table, &["set", "point"], || format!("`{quantity}` belongs to a body or to everything")),
            };
            joint.and(place)
        }
        None => Some(()),
    };
    let of_equation = match quantity {
        Some(quantity) if !quantity.is_of_equation() => {
            refuse(table, &["equation"], || format!("`{quantity}` does not belong to an equation"))
        }
        _ => Some(()),
    };
    table.finish();
    let components = if table.has("reduce") { Some(&[][..]) } else { quantity.map(Quantity::components) };
    let known_as = name.clone().map(|name| (name, components));
    let probe = (|| {
        place?;
        of_equation?;
        Some(Probe {
            name: name?,
            quantity: quantity?,
            set: set?,
            body: body?,
            point: point?,
            joint: joint?,
            equation: equation?,
            reduce: reduce?,
            component: component?,
        })
    })();
    (probe, known_as)
}

/// Reports keys that the quantity does not have.
fn refuse(table: &Table<'_>, keys: &[&'static str], message: impl Fn() -> String) -> Option<()> {
    let mut good = Some(());
    for key in keys.iter().copied().filter(|&key| table.has(key)) {
        good = table.fail(key, message(), "remove it; name a `body` if it is not for everything");
    }
    good
}

fn joint(node: &Node<'_>, quantity: Option<Quantity>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    match world.joints.iter().find(|(joint, _)| *joint == name) {
        Some((_, Some(kind)))
            if quantity == Some(Quantity::JointAngle) && kind.coordinates.first() != Some(&CoordinateKind::Angle) =>
        {
            node.fail(
                format!("is a joint `{kind}`, which has no angle"),
                format!(
                    "choose one of the kinds {}",
                    of_which::<JointEntry>(|kind| kind.coordinates.first() == Some(&CoordinateKind::Angle))
                ),
            )
        }
        Some((_, Some(kind))) if quantity == Some(Quantity::JointDisplacement) && !slides(kind) => node.fail(
            format!("is a joint `{kind}`, for whose displacement there is no probe"),
            format!("choose one of the kinds {}; a second coordinate is in joints.csv", of_which(slides)),
        ),
        Some(_) => Some(name),
        None if !world.actions_complete => Some(name),
        None if world.joints.is_empty() => node.fail("the scene has no joint", "add a [[joint]] of this name"),
        None => {
            node.fail("is not a joint of this scene", known(&name, world.joints.iter().map(|(name, _)| name.as_str())))
        }
    }
}

fn equation(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    if world.equations.contains(&name) || !world.actions_complete {
        return Some(name);
    }
    if world.equations.is_empty() {
        return node.fail("the scene has no equation", "add an [[equation]] of this name");
    }
    node.fail("is not an equation of this scene", known(&name, world.equations.iter().map(String::as_str)))
}

/// The key `component` of an extremum: positions and stresses have no length.
fn reduced_component(table: &Table<'_>, quantity: Option<Quantity>) -> Option<Option<ProbeComponent>> {
    let component = table.optional("component", |n| {
        if !table.has("reduce") {
            return n.fail("is for extrema: the columns of all components are there", "remove it, or add `reduce`");
        }
        match quantity.map(Quantity::components) {
            None => n.choice(ProbeComponent::NAMES, ProbeComponent::from_name),
            Some([]) => n.fail("the quantity has a single value", "remove it"),
            Some(all) => component_of(n, all),
        }
    });
    let needed = matches!(quantity, Some(Quantity::Position | Quantity::CauchyStress));
    if needed && table.has("reduce") && !table.has("component") {
        let first = quantity.and_then(|quantity| quantity.components().last()).map_or("z", |last| last.name());
        return table.missing("component", &format!("component = \"{first}\""));
    }
    component
}

fn component_of(node: &Node<'_>, all: &[ProbeComponent]) -> Option<ProbeComponent> {
    let names: Vec<&str> = all.iter().map(|component| component.name()).collect();
    node.choice(&names, |name| ProbeComponent::from_name(name).filter(|component| all.contains(component)))
}

/// The place of an extremum: the nodes of a set, or of a part.
fn extremum_place(table: &Table<'_>, quantity: Quantity, part: Option<PartKind>) -> Option<()> {
    for key in ["point", "joint"] {
        if table.has(key) {
            return table.fail(key, "an extremum belongs to a set or a body", "remove it");
        }
    }
    match (table.has("set"), table.has("body")) {
        (true, true) => table.fail("body", "the set names its body already", "remove it"),
        (false, false) => table.missing("body", "body = \"ball\"` or `set = \"ball.outer\""),
        _ => match part {
            Some(kind) if quantity.is_of_material() && kind != PartKind::Body => {
                let message = format!("is {}: `{quantity}` belongs to a deformable body", kind.noun());
                table.fail("body", message, "name a deformable body")
            }
            _ => Some(()),
        },
    }
}

/// The place of a stress or strain: a point of a deformable body.
fn material_place(table: &Table<'_>, quantity: Quantity, part: Option<PartKind>) -> Option<()> {
    for key in ["set", "joint"] {
        if table.has(key) {
            let remedy = "write `body` and `point`, or `reduce = \"max\"` for the largest value of a set";
            return table.fail(key, format!("`{quantity}` belongs to a point of a body"), remedy);
        }
    }
    if !table.has("body") {
        return table.missing("body", "body = \"plate\"");
    }
    match part {
        Some(kind) if kind != PartKind::Body => {
            let message = format!("is {}: `{quantity}` belongs to a deformable body", kind.noun());
            table.fail("body", message, "name a deformable body")
        }
        _ if !table.has("point") => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        _ => Some(()),
    }
}

/// The place of an angular velocity: a rigid body, of this kind if it is known.
fn rigid_place(table: &Table<'_>, part: Option<PartKind>) -> Option<()> {
    let place = refuse(table, &["set", "point"], || "an angular velocity belongs to a rigid body".to_owned());
    match part {
        Some(kind) if kind != PartKind::Rigid => {
            table.fail("body", format!("is {}, not a rigid body", kind.noun()), "name a rigid body")
        }
        None if !table.has("body") => table.missing("body", "body = \"wheel\""),
        _ => place,
    }
}

/// The place of a quantity of nodes. `part`: the kind of the part that `body` names, if it is known.
fn nodal_place(table: &Table<'_>, quantity: Quantity, part: Option<PartKind>) -> Option<()> {
    if let (Some(kind @ (PartKind::Rigid | PartKind::Mass)), false) = (part, table.has("set")) {
        let at_points = matches!(quantity, Quantity::Displacement | Quantity::Position | Quantity::Velocity);
        if table.has("point") && !(kind == PartKind::Rigid && at_points) {
            return table.fail(
                "point",
                format!("`{quantity}` of {} is a quantity of the whole part", kind.noun()),
                "remove the point",
            );
        }
        return Some(());
    }
    match (table.has("set"), table.has("body"), table.has("point")) {
        (true, false, false) | (false, true, true) => Some(()),
        (true, _, true) => table.fail("point", "a probe has either a set or a point", "remove one of them"),
        (true, true, false) => table.fail("body", "the set names its body already", "remove it"),
        (false, false, true) => table.missing("body", "body = \"plate\""),
        // An unknown part may be a rigid body.
        (false, true, false) if part.is_none() => Some(()),
        (false, true, false) => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        (false, false, false) => {
            table.missing("set", "set = \"ball.outer\"` or `body = \"ball\"` with `point = [x, y, z]")
        }
    }
}

pub(super) fn output(node: &Node<'_>, world: &World<'_>) -> Option<Output> {
    let table = node.table()?;
    let every = table.default("every", Output::DEFAULT_EVERY, Node::count);
    let interval = table.optional("interval", Node::positive);
    let times = table.optional("times", |n| {
        let times = n.list(|n| time_in_run(n, world))?;
        if times.is_empty() {
            return n.fail("has no time", "name times, or write last_only = true instead");
        }
        Some(times)
    });
    let last_only = table.default("last_only", false, Node::boolean);
    let formats = |n: &Node<'_>| n.choice(FrameFormat::NAMES, FrameFormat::from_name);
    let format = table.default("format", FrameFormat::default(), formats);
    let fields = table.optional("fields", |n| fields(n, world));
    let checkpoint_every = table.default("checkpoint_every", Output::DEFAULT_CHECKPOINT_EVERY, Node::count);
    let mut ways = ["every", "interval", "times", "last_only"].into_iter().filter(|&key| table.has(key));
    let one = match (ways.next(), ways.next()) {
        (Some(first), Some(second)) => table.fail(
            second,
            format!("cannot be combined with `{first}`"),
            "keep one of `every`, `interval`, `times` and `last_only`",
        ),
        _ => Some(()),
    };
    table.finish();
    one?;
    Some(Output {
        every: every?,
        interval: interval?,
        times: times?,
        last_only: last_only?,
        format: format?,
        fields: fields?,
        checkpoint_every: checkpoint_every?,
    })
}

/// A time from the start to the end of the run.
fn time_in_run(node: &Node<'_>, world: &World<'_>) -> Option<f64> {
    let time = node.not_negative()?;
    match world.end.filter(|&end| time > end) {
        Some(end) => node.fail(format!("is after the end of the run, {end}"), "choose a time in the run"),
        None => Some(time),
    }
}

pub(super) fn watch(node: &Node<'_>) -> Option<Watch> {
    let table = node.table()?;
    let every = table.optional("every", Node::count);
    let limit = table.default("limit", Watch::DEFAULT_LIMIT, Node::positive);
    let on_fault = table.default("on_fault", OnFault::default(), |n| n.choice(OnFault::NAMES, OnFault::from_name));
    table.finish();
    Some(Watch { every: every?, limit: limit?, on_fault: on_fault? })
}

fn fields(node: &Node<'_>, world: &World<'_>) -> Option<Vec<Field>> {
    let fields = node.list(|n| {
        let field = n.choice(Field::NAMES, Field::from_name)?;
        if field == Field::Velocity && world.kind == Some(Kind::QuasiStatic) {
            return n.fail("does not exist in a quasi-static scene", "remove it");
        }
        let of_contact = matches!(field, Field::ContactPressure | Field::ContactMultiplier | Field::Gap);
        if of_contact && !(world.has_contact || world.has_general_contact) {
            let remedy = "remove it, or add a [[contact]] or [general_contact]";
            return n.fail("needs contact, and the scene has none", remedy);
        }
        if field == Field::Reaction && !world.has_prescribed {
            return n.fail("needs prescribed motion, and the scene has none", "remove it or add a [[prescribe]]");
        }
        Some(field)
    })?;
    if let Some(i) = (1..fields.len()).find(|&i| fields[..i].contains(&fields[i])) {
        return node.fail(format!("names `{}` twice", fields[i]), "name every field at most once");
    }
    Some(fields)
}

/// Keys of `[expect]` that have a meaning only with inertia.
const DYNAMIC: [&str; 9] = [
    "energy_drift",
    "energy_drift_at_least",
    "energy_change_without_closing",
    "energy_gain",
    "energy_scale",
    "linear_momentum_drift",
    "linear_momentum_scale",
    "angular_momentum_drift",
    "angular_momentum_scale",
];

/// Keys of `[expect]` that have a meaning only with contact.
const CONTACT: [&str; 3] = ["energy_change_without_closing", "first_contact", "contact_at_end"];

pub(super) fn expect(node: &Node<'_>, world: &World<'_>) -> Option<Expect> {
    let table = node.table()?;
    let outcome = table.optional("outcome", |n| n.choice(Outcome::NAMES, Outcome::from_name));
    let verdict = table.optional("verdict", |n| n.choice(Verdict::NAMES, Verdict::from_name));
    let steps = table.optional("steps", |n| n.whole(1..=u64::MAX));
    let max_cuts = table.optional("max_cuts", |n| n.whole(0..=u64::MAX));
    let bound = |key: &'static str| table.optional(key, Node::positive);
    let expect = (
        bound("max_newton_mean"),
        bound("energy_drift"),
        bound("energy_drift_at_least"),
        bound("energy_change_without_closing"),
        bound("energy_gain"),
        bound("energy_scale"),
        bound("linear_momentum_drift"),
        bound("linear_momentum_scale"),
        bound("angular_momentum_drift"),
        bound("angular_momentum_scale"),
    );
    let first_contact = table.optional("first_contact", interval);
    let contact_at_end = table.optional("contact_at_end", Node::boolean);
    let probes: Vec<Option<ExpectedValue>> =
        table.tables("probe").into_iter().map(|probe| expected_value(&probe?, world)).collect();
    let mut applies = Some(());
    if world.kind == Some(Kind::QuasiStatic) {
        for key in DYNAMIC.into_iter().filter(|&key| table.has(key)) {
            applies = table.fail(key, "a quasi-static scene conserves nothing", "remove it");
        }
    }
    if !world.has_contact {
        for key in CONTACT.into_iter().filter(|&key| table.has(key)) {
            applies = table.fail(
                key,
                "the scene has no [[contact]], to which this belongs",
                "remove it or add a [[contact]]",
            );
        }
    }
    table.finish();
    if let (Some(Some(most)), Some(Some(least))) = (expect.1, expect.2)
        && least > most
    {
        return table.fail(
            "energy_drift_at_least",
            format!("contradicts `energy_drift` = {most:e}"),
            "remove one of them",
        );
    }
    applies?;
    Some(Expect {
        outcome: outcome?,
        verdict: verdict?,
        steps: steps?,
        max_cuts: max_cuts?,
        max_newton_mean: expect.0?,
        energy_drift: expect.1?,
        energy_drift_at_least: expect.2?,
        energy_change_without_closing: expect.3?,
        energy_gain: expect.4?,
        energy_scale: expect.5?,
        linear_momentum_drift: expect.6?,
        linear_momentum_scale: expect.7?,
        angular_momentum_drift: expect.8?,
        angular_momentum_scale: expect.9?,
        first_contact: first_contact?,
        contact_at_end: contact_at_end?,
        probes: probes.into_iter().collect::<Option<_>>()?,
    })
}

fn interval(node: &Node<'_>) -> Option<Interval> {
    let table = node.table()?;
    let from = table.required("from", "from = 0.0", Node::not_negative);
    let to = table.required("to", "to = 1.0", Node::not_negative);
    table.finish();
    let (from, to) = (from?, to?);
    if from > to {
        return table.fail("to", format!("is before `from` = {from}"), "exchange the two times");
    }
    Some(Interval { from, to })
}

fn expected_value(table: &Table<'_>, world: &World<'_>) -> Option<ExpectedValue> {
    let name = table.required("name", "name = \"tip\"", |n| probe_of(n, world));
    let time = table.required("time", "time = 1.0", |n| time_in_run(n, world));
    let component = component_fits(table, name.as_deref(), world);
    let value = table.required("value", "value = 0.1", Node::number);
    let tolerance = table.required("tolerance", "tolerance = 1e-6", Node::positive);
    table.finish();
    Some(ExpectedValue { name: name?, time: time?, component: component?, value: value?, tolerance: tolerance? })
}

/// The name of a probe of this scene.
pub(super) fn probe_of(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    if world.probes_complete && !world.probes.iter().any(|(probe, _)| *probe == name) {
        if world.probes.is_empty() {
            return node.fail("the scene has no probe", "add a [[probe]] of this name");
        }
        return node
            .fail("is not a probe of this scene", known(&name, world.probes.iter().map(|(probe, _)| probe.as_str())));
    }
    Some(name)
}

/// The key `component`, there if and only if the probe has several values.
pub(super) fn component_fits(
    table: &Table<'_>,
    probe: Option<&str>,
    world: &World<'_>,
) -> Option<Option<ProbeComponent>> {
    let known = probe.and_then(|name| world.probes.iter().find(|(probe, _)| probe == name)).and_then(|p| p.1);
    match (known, table.has("component")) {
        (Some([]), true) => table.fail("component", "the quantity has a single value", "remove it"),
        (Some([.., last]), false) => table.missing("component", &format!("component = \"{last}\"")),
        (Some(all), true) => table.optional("component", |n| component_of(n, all)),
        _ => table.optional("component", |n| n.choice(ProbeComponent::NAMES, ProbeComponent::from_name)),
    }
}
