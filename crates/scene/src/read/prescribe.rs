//! Reads `[[prescribe]]` and functions of time.

use super::node::Node;
use super::table::Table;
use super::world::{World, action_name, set_reference};
use crate::conditions::Table as Rows;
use crate::{Component, PartKind, Prescribe, PrescribedRotation, Series, split_set};
use toml::de::DeValue;

/// A constant or a table with `columns` values.
pub(super) fn series(node: &Node<'_>, columns: usize) -> Option<Series> {
    let plural = if columns == 1 { "value" } else { "values" };
    match node.value {
        DeValue::Table(_) => {
            let table = node.table()?;
            let rows = table.required("table", "table = [[0.0, 0.0], [1.0, 1.0]]", |n| rows(n, columns));
            table.finish();
            Some(Series::Table(Rows { table: rows? }))
        }
        DeValue::Array(_) => {
            let values = node.list(Node::number)?;
            if values.len() != columns {
                return node.fail(
                    format!("has {} values, needs {columns}", values.len()),
                    format!("write a list of {columns} {plural}, or {{ table = [[time, ...], ...] }}"),
                );
            }
            Some(Series::Vector(values))
        }
        DeValue::Integer(_) | DeValue::Float(_) | DeValue::String(_) => {
            let value = node.number()?;
            if columns != 1 {
                return node.fail(
                    format!("is one value, needs {columns}"),
                    format!("write a list of {columns} values, or {{ table = [[time, ...], ...] }}"),
                );
            }
            Some(Series::Scalar(value))
        }
        _ => node.fail(
            format!("must be a constant or a table in time, found a {}", node.value.type_str()),
            "write for instance { table = [[0.0, 0.0], [1.0, 0.1]] }",
        ),
    }
}

fn rows(node: &Node<'_>, columns: usize) -> Option<Vec<Vec<f64>>> {
    let previous = std::cell::Cell::new(f64::NEG_INFINITY);
    let rows = node.list(|n| {
        let row = n.list(Node::number)?;
        if row.len() != columns + 1 {
            return n.fail(
                format!("has {} entries, needs {}: the time and {columns} more", row.len(), columns + 1),
                format!("write rows of {} entries", columns + 1),
            );
        }
        if row[0] <= previous.get() {
            return n.fail(
                format!("the time {} is not later than that of the row before, {}", row[0], previous.get()),
                "sort the rows by time and give every time once",
            );
        }
        previous.set(row[0]);
        Some(row)
    })?;
    if rows.is_empty() {
        return node.fail("has no row", "write rows of a time and its values, for instance [[0.0, 0.0], [1.0, 0.1]]");
    }
    Some(rows)
}

pub(super) fn prescribe(table: &Table<'_>, world: &World<'_>) -> Option<Prescribe> {
    let name = table.optional("name", action_name);
    let ramp_until = table.optional("ramp_until", end_of_ramp);
    let rigid = table.optional("rigid", |n| rigid_part(n, world));
    let set = if table.has("rigid") {
        table.optional("set", |n| n.fail("is not needed: the rigid body moves as a whole", "remove it, or `rigid`"))
    } else {
        table.required("set", "set = \"plate.rim\"", |n| moved_set(n, world)).map(Some)
    };
    if table.has("rotation") {
        let (rotation, translation) = rigid_motion(table)?;
        return Some(Prescribe {
            name: name?,
            set: set?,
            rigid: rigid?,
            components: Vec::new(),
            normal: None,
            displacement: None,
            fixed: false,
            rotation: Some(rotation),
            translation,
            ramp_until: None,
        });
    }
    let fixed = table.default("fixed", false, Node::boolean);
    let normal = table.optional("normal", Node::direction);
    let components = if table.has("normal") {
        across(table)
    } else if table.has("rigid") && fixed == Some(true) {
        table.default("components", Vec::new(), |n| {
            n.fail("is not needed: a rigid body is fixed as a whole", "remove it, or write a `displacement`")
        })
    } else {
        table.required("components", "components = [\"x\", \"z\"]", components)
    };
    let count = if table.has("normal") { Some(1) } else { components.as_ref().map(Vec::len) };
    let translation: Option<()> = if table.has("translation") {
        table.fail("translation", "belongs to a `rotation`", "call it `displacement`, or add a `rotation`")
    } else {
        Some(())
    };
    let displacement = table.optional("displacement", |n| series(n, count?));
    let one_kind = match (fixed, table.has("displacement")) {
        (Some(true), true) => table.fail(
            "fixed",
            "cannot be combined with `displacement`",
            "remove `fixed`, or `displacement` if nothing is to move",
        ),
        (Some(false), false) => table.fail(
            "displacement",
            "is missing",
            "add it, for instance `displacement = { table = [[0.0, 0.0], [1.0, 0.1]] }`, or `fixed = true`",
        ),
        _ => Some(()),
    };
    table.finish();
    one_kind?;
    translation?;
    let ramp_until = ramp_until?;
    if ramp_until.is_some() {
        let inclined = normal.flatten().is_some_and(|n| n.iter().filter(|&&n| n != 0.0).count() > 1);
        if table.has("rigid") || inclined {
            return table.fail(
                "ramp_until",
                "is for sets of nodes that are prescribed along axes of space",
                "remove it, and let the displacement begin where the nodes are when it is switched on",
            );
        }
    }
    Some(Prescribe {
        name: name?,
        set: set?,
        rigid: rigid?,
        components: components?,
        normal: normal?,
        displacement: displacement?,
        fixed: fixed?,
        rotation: None,
        translation: None,
        ramp_until,
    })
}

/// A time, which may be infinite.
fn end_of_ramp(node: &Node<'_>) -> Option<f64> {
    let time = node.extended()?;
    if time.is_nan() || time <= 0.0 {
        return node.fail("must be a time after the start", "write the time at which the ramp ends, or inf");
    }
    Some(time)
}

/// What excludes a normal; no components.
fn across(table: &Table<'_>) -> Option<Vec<Component>> {
    let mut alone = Some(Vec::new());
    for (key, remedy) in [
        (
            "components",
            "remove it: a normal prescribes the displacement along itself; hold components by a [[prescribe]] of their own",
        ),
        ("rigid", "name a `set`, or let the rigid body slide on a [[joint]] to the ground"),
    ] {
        if table.has(key) {
            alone = table.fail(key, "cannot be combined with `normal`", remedy);
        }
    }
    alone
}

/// The name of a rigid body that is not fixed.
fn rigid_part(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    match world.find(node, &name)? {
        Some(part) if part.kind != PartKind::Rigid => {
            let message = format!("is {}, not a rigid body", part.kind.noun());
            node.fail(message, format!("write `set = \"{name}.set\"` with one of its sets"))
        }
        Some(part) if part.fixed => {
            node.fail("is fixed by its own key", "remove `fixed = true` there, or this [[prescribe]]")
        }
        _ => Some(name),
    }
}

/// A set of nodes that can be prescribed by components.
fn moved_set(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    match split_set(&text).and_then(|(part, _)| world.part(part)) {
        Some(part) if part.kind == PartKind::Rigid => node.fail(
            format!("`{}` is a rigid body, which is prescribed as a whole", part.name),
            format!("write `rigid = \"{}\"` instead of `set`", part.name),
        ),
        _ => Some(text),
    }
}

/// A rotation with or without a translation.
fn rigid_motion(table: &Table<'_>) -> Option<(PrescribedRotation, Option<Series>)> {
    let rotation = table.required("rotation", "", |n| {
        let inner = n.table()?;
        let axis = inner.required("axis", "axis = [0, 0, 1]", Node::direction);
        let degrees = inner.required("degrees", "degrees = { table = [[0.0, 0.0], [1.0, 90.0]] }", |n| series(n, 1));
        let about = inner.default("about", [0.0; 3], Node::vector);
        inner.finish();
        Some(PrescribedRotation { axis: axis?, degrees: degrees?, about: about? })
    });
    let translation = table.optional("translation", |n| series(n, 3));
    let mut alone = Some(());
    for (key, remedy) in [
        ("components", "remove it: a rotation prescribes all three components"),
        ("normal", "remove it: a rotation prescribes all three components"),
        ("displacement", "call it `translation`, with three values"),
        ("fixed", "remove it, or the rotation"),
        ("ramp_until", "remove it: a rotation begins where its angle and its translation are at that time"),
    ] {
        if table.has(key) {
            alone = table.fail(key, "cannot be combined with `rotation`", remedy);
        }
    }
    table.finish();
    alone?;
    Some((rotation?, translation?))
}

fn components(node: &Node<'_>) -> Option<Vec<Component>> {
    let components = node.list(component)?;
    if components.is_empty() {
        return node.fail("names no component", "write for instance [\"x\", \"y\", \"z\"]");
    }
    if let Some(i) = (1..components.len()).find(|&i| components[..i].contains(&components[i])) {
        return node.fail(format!("names `{}` twice", components[i]), "name every component at most once");
    }
    Some(components)
}

pub(super) fn component(node: &Node<'_>) -> Option<Component> {
    node.choice(Component::NAMES, Component::from_name)
}
