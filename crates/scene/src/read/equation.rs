//! Reads `[[equation]]` and `[[coupling]]`.

use super::node::Node;
use super::prescribe::series;
use super::table::Table;
use super::world::{World, action_name, part_name, set_reference};
use crate::{Component, Coupling, Equation, EquationTerm, PartKind, SetCoupling, split_set};
use std::collections::BTreeSet;
use toml::de::DeValue;

const EXAMPLE: &str =
    "terms = [{ set = \"cell.right\", component = \"x\" }, { set = \"cell.left\", component = \"x\", factor = -1.0 }]";

pub(super) fn equation(table: &Table<'_>, world: &World<'_>) -> Option<Equation> {
    let name = table.required("name", "name = \"lever\"", action_name);
    let terms = table.required("terms", EXAMPLE, |n| {
        let terms = n.list(|n| term(n, world))?;
        if terms.is_empty() {
            return n.fail("has no term", format!("write for instance {EXAMPLE}"));
        }
        Some(terms)
    });
    let value = table.default("value", Equation::default_value(), |n| series(n, 1));
    table.finish();
    Some(Equation { name: name?, terms: terms?, value: value? })
}

fn term(node: &Node<'_>, world: &World<'_>) -> Option<EquationTerm> {
    let table = node.table_like("{ set = \"cell.right\", component = \"x\" }")?;
    let set = table.optional("set", |n| set_reference(n, world));
    let body = table.optional("body", |n| part_name(n, world));
    let point = table.optional("point", Node::vector);
    let component = table.optional("component", |n| n.choice(Component::NAMES, Component::from_name));
    let direction = table.optional("direction", Node::direction);
    let factor = table.default("factor", EquationTerm::default_factor(), Node::not_zero);
    let mean = table.default("mean", false, Node::boolean);
    let place = match ["set", "body", "point"].map(|key| table.has(key)) {
        [true, false, false] | [false, true, true] => Some(()),
        [true, true, _] => table.fail("body", "the set names its body already", "remove it"),
        [true, false, true] => table.fail("point", "a term has either a set or a point", "remove one of them"),
        [false, true, false] => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        [false, false, true] => table.missing("body", "body = \"plate\""),
        [false, false, false] => table.missing("set", "set = \"cell.right\""),
    };
    let along = match (table.has("component"), table.has("direction")) {
        (true, true) => table.fail("direction", "`component` is given too", "remove one of them"),
        (false, false) => table.missing("component", "component = \"x\""),
        _ => Some(()),
    };
    let mean_of = if table.has("mean") && table.has("point") {
        table.fail("mean", "is for sets, and the term has a point", "remove it")
    } else {
        Some(())
    };
    table.finish();
    place?;
    along?;
    mean_of?;
    Some(EquationTerm {
        set: set?,
        body: body?,
        point: point?,
        component: component?,
        direction: direction?,
        factor: factor?,
        mean: mean?,
    })
}

pub(super) fn coupling(table: &Table<'_>, world: &World<'_>) -> Option<SetCoupling> {
    let name = table.required("name", "name = \"hub\"", Node::name);
    let kind = table.required("kind", "kind = \"kinematic\"", |n| n.choice(Coupling::NAMES, Coupling::from_name));
    let part_of =
        |text: &str| split_set(text).and_then(|(part, _)| world.part(part)).map(|part| (part.kind, part.kind.noun()));
    let set = table.required("set", "set = \"plate.hole\"", |n| {
        let text = set_reference(n, world)?;
        match part_of(&text) {
            Some((kind, noun)) if kind != PartKind::Body => n.fail(
                format!("is a set of {noun}: a coupling takes nodes of deformable bodies"),
                "use a [[joint]] between such parts",
            ),
            _ => Some(text),
        }
    });
    let rigid = table.required("rigid", "rigid = \"hub\"", |n| {
        let name = part_name(n, world)?;
        match world.part(&name) {
            Some(part) if part.kind != PartKind::Rigid => n.fail(
                format!("is {}, not a rigid body", part.kind.noun()),
                "name a [[rigid]]; it needs neither mass nor surface",
            ),
            _ => Some(name),
        }
    });
    table.finish();
    Some(SetCoupling { name: name?, kind: kind?, set: set?, rigid: rigid? })
}

/// Names of the parts that equations, couplings and prescribed motions of sets move, which therefore need no mass.
pub(super) fn moved(
    equations: &[Option<Table<'_>>],
    couplings: &[Option<Table<'_>>],
    prescriptions: &[Option<Table<'_>>],
) -> BTreeSet<String> {
    let text = |table: &Table<'_>, key: &'static str| match table.get(key)?.value {
        DeValue::String(text) => Some(text.to_string()),
        _ => None,
    };
    let mut names: BTreeSet<String> = couplings.iter().flatten().filter_map(|table| text(table, "rigid")).collect();
    let sets = prescriptions.iter().flatten().filter_map(|table| text(table, "set"));
    names.extend(sets.filter_map(|set| split_set(&set).map(|(part, _)| part.to_owned())));
    for terms in equations.iter().flatten().filter_map(|table| table.get("terms")) {
        let DeValue::Array(terms) = terms.value else { continue };
        for term in terms {
            let DeValue::Table(term) = term.get_ref() else { continue };
            let of = |key: &str| match term.get(key).map(|value| value.get_ref()) {
                Some(DeValue::String(text)) => Some(text.to_string()),
                _ => None,
            };
            names.extend(of("body"));
            names.extend(of("set").and_then(|set| split_set(&set).map(|(part, _)| part.to_owned())));
        }
    }
    names
}
