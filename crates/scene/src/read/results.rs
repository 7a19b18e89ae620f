//! Reads `[[probe]]`, `[output]`, `[watch]`, `[expect]`.

use super::World;
use super::conditions::{body_name, component, set_reference};
use super::node::{Node, known};
use super::table::Table;
use crate::{Expect, ExpectedValue, Field, Interval, Kind, OnFault, Outcome, Output, Probe, Quantity, Verdict, Watch};

/// The probe, and its name with its quantity, which `[expect]` needs even if the rest is bad.
pub(super) fn probe(table: &Table<'_>, world: &World<'_>) -> (Option<Probe>, Option<(String, Option<Quantity>)>) {
    let name = table.required("name", "name = \"tip\"", Node::name);
    let quantity = table.required("quantity", "quantity = \"displacement\"", |n| {
        let quantity = n.choice(Quantity::NAMES, Quantity::from_name)?;
        if quantity.is_dynamic() && world.kind == Some(Kind::QuasiStatic) {
            return n.fail("needs inertia", "choose another quantity, or set [scene] kind = \"dynamic\"");
        }
        if quantity == Quantity::ContactForce && !world.has_contact && !world.has_tie {
            return n.fail("needs contact, and the scene has none", "add a [[contact]] or choose another quantity");
        }
        if matches!(quantity, Quantity::Reaction | Quantity::ReactionMoment) && !world.has_support {
            return n.fail(
                "needs prescribed motion, and the scene has none",
                "add a [[prescribe]] or choose another quantity",
            );
        }
        Some(quantity)
    });
    let set = table.optional("set", |n| set_reference(n, world));
    let body = table.optional("body", |n| body_name(n, world));
    let point = table.optional("point", Node::vector);
    let place = match quantity {
        Some(quantity) if !quantity.is_nodal() => {
            let mut place = Some(());
            for key in ["set", "point"].into_iter().filter(|&key| table.has(key)) {
                place = table.fail(
                    key,
                    format!("`{quantity}` belongs to a body or to everything"),
                    "remove it; name a `body` if it is not for everything",
                );
            }
            place
        }
        Some(_) => nodal_place(table),
        None => Some(()),
    };
    table.finish();
    let known_as = name.clone().map(|name| (name, quantity));
    let probe = (|| {
        place?;
        Some(Probe { name: name?, quantity: quantity?, set: set?, body: body?, point: point? })
    })();
    (probe, known_as)
}

fn nodal_place(table: &Table<'_>) -> Option<()> {
    match (table.has("set"), table.has("body"), table.has("point")) {
        (true, false, false) | (false, true, true) => Some(()),
        (true, _, true) => table.fail("point", "a probe has either a set or a point", "remove one of them"),
        (true, true, false) => table.fail("body", "the set names its body already", "remove it"),
        (false, false, true) => table.missing("body", "body = \"plate\""),
        (false, true, false) => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        (false, false, false) => {
            table.missing("set", "set = \"ball.outer\"` or `body = \"ball\"` with `point = [x, y, z]")
        }
    }
}

pub(super) fn output(node: &Node<'_>, world: &World<'_>) -> Option<Output> {
    let table = node.table()?;
    let every = table.default("every", Output::DEFAULT_EVERY, Node::count);
    let fields = table.optional("fields", |n| fields(n, world));
    let checkpoint_every = table.default("checkpoint_every", Output::DEFAULT_CHECKPOINT_EVERY, Node::count);
    table.finish();
    Some(Output { every: every?, fields: fields?, checkpoint_every: checkpoint_every? })
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
        if matches!(field, Field::ContactPressure | Field::Gap) && !world.has_contact {
            return n.fail("needs contact, and the scene has none", "remove it or add a [[contact]]");
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
            applies = table.fail(key, "the scene has no contact", "remove it or add a [[contact]]");
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
    let name = table.required("name", "name = \"tip\"", |n| {
        let name = n.text()?;
        if world.probes_complete && !world.probes.iter().any(|(probe, _)| *probe == name) {
            if world.probes.is_empty() {
                return n.fail("the scene has no probe", "add a [[probe]] of this name");
            }
            return n
                .fail("is no probe of this scene", known(&name, world.probes.iter().map(|(probe, _)| probe.as_str())));
        }
        Some(name)
    });
    let quantity =
        name.as_ref().and_then(|name| world.probes.iter().find(|(probe, _)| probe == name)).and_then(|p| p.1);
    let time = table.required("time", "time = 1.0", |n| {
        let time = n.not_negative()?;
        if let Some(end) = world.end
            && time > end
        {
            return n.fail(format!("is after the end of the run, {end}"), "choose a time in the run");
        }
        Some(time)
    });
    let component = table.optional("component", component);
    let columns = quantity.map(Quantity::columns);
    let component_fits = match (columns, table.has("component")) {
        (Some(3), false) => table.missing("component", "component = \"z\""),
        (Some(1), true) => table.fail("component", "the quantity has a single value", "remove it"),
        _ => Some(()),
    };
    let value = table.required("value", "value = 0.1", Node::number);
    let tolerance = table.required("tolerance", "tolerance = 1e-6", Node::positive);
    table.finish();
    component_fits?;
    Some(ExpectedValue { name: name?, time: time?, component: component?, value: value?, tolerance: tolerance? })
}
