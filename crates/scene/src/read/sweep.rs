//! Reads `[sweep]`.

use super::node::{Node, known};
use super::values::TABLE;
use crate::{Sweep, SweepRange, SweepValues};
use std::collections::BTreeMap;

pub(super) fn sweep(node: &Node<'_>) -> Option<Sweep> {
    let table = node.table()?;
    let grid = table.default("grid", BTreeMap::new(), |n| entries(n, values));
    let cases = table.default("cases", Vec::new(), |n| {
        let cases = n.list(|n| entries(n, Node::number))?;
        if cases.is_empty() {
            return n.fail("has no case", "write for instance [{ mu = 0.1 }, { mu = 0.2 }]");
        }
        Some(cases)
    });
    let extremes = table.default("extremes", Vec::new(), |n| n.list(extreme));
    let one = match (table.has("grid"), table.has("cases")) {
        (true, true) => table.fail("cases", "`grid` is given too", "give one of the two"),
        (false, false) => table.missing("grid", "grid = { mu = [0.0, 0.1, 0.2] }"),
        _ => Some(()),
    };
    table.finish();
    one?;
    let sweep = Sweep { grid: grid?, cases: cases?, extremes: extremes? };
    if sweep.count() > Sweep::MAX_CASES {
        return node.fail(
            format!("has {} cases, more than {}", sweep.count(), Sweep::MAX_CASES),
            "give fewer values, or split the sweep",
        );
    }
    Some(sweep)
}

/// A table with parameters of the scene as keys; at least one.
fn entries<'a, T>(node: &Node<'a>, read: impl Fn(&Node<'a>) -> Option<T>) -> Option<BTreeMap<String, T>> {
    let table = node.table_like("{ mu = 0.1 }")?;
    let parameters = &node.report.parameters;
    let mut good = true;
    let mut entries = BTreeMap::new();
    for (name, value) in table.rest() {
        if !parameters.contains_key(name) {
            let remedy = if parameters.is_empty() {
                format!("add `[{TABLE}]` with `{name} = 1.0`, and use it in the scene as \"{name}\"")
            } else {
                known(name, parameters.keys().map(String::as_str))
            };
            good &= value.fail::<()>("is not a parameter of the scene", remedy).is_some();
            continue;
        }
        match read(&value) {
            Some(value) => {
                entries.insert(name.to_owned(), value);
            }
            None => good = false,
        }
    }
    if good && entries.is_empty() {
        return node.fail("names no parameter", "write for instance { mu = 0.1 }");
    }
    good.then_some(entries)
}

fn values(node: &Node<'_>) -> Option<SweepValues> {
    if node.value.is_array() {
        let list = node.list(Node::number)?;
        if list.is_empty() {
            return node.fail("has no value", "write for instance [0.0, 0.1]");
        }
        return Some(SweepValues::List(list));
    }
    let table = node.table_like("[0.0, 0.1, 0.2] or { from = 0.0, to = 1.0, count = 5 }")?;
    let from = table.required("from", "from = 0.0", Node::number);
    let to = table.required("to", "to = 1.0", Node::number);
    let count = table.required("count", "count = 5", |n| n.whole(2..=Sweep::MAX_CASES as u64));
    table.finish();
    Some(SweepValues::Range(SweepRange { from: from?, to: to?, count: count? as u32 }))
}

/// `TABLE.COLUMN`.
fn extreme(node: &Node<'_>) -> Option<String> {
    let text = node.text()?;
    match text.split_once('.') {
        Some((table, column)) if Sweep::TABLES.contains(&table) && !column.is_empty() => Some(text),
        _ => {
            let table = text.split('.').next().unwrap_or_default();
            let remedy = known(table, Sweep::TABLES);
            node.fail("is not a column of a result table", format!("write TABLE.COLUMN; {remedy}"))
        }
    }
}
