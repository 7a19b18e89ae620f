//! `[sweep]`: runs of a scene with many values of its parameters.

use crate::read::{Node, PARAMETERS, Table, Value};
use crate::spelling::known;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use stoss_scene_derive::table;

/// `[sweep]`: the cases of `stoss sweep`. Exactly one of `grid` and `cases`. A run of the scene by itself ignores it.
#[table(check = one_of_both, check_all = not_too_many)]
pub struct Sweep {
    /// Values of parameters: each combination is a case. Parameters are in alphabetical order; the last one varies
    /// fastest.
    #[key(default, skip, dimension = "as the parameter", read = |node| entries(node, |node| SweepValues::read(node, &())))]
    pub grid: BTreeMap<String, SweepValues>,
    /// List of cases, each with values of parameters; other parameters keep their value.
    #[key(default, skip, dimension = "as the parameter", read = cases)]
    pub cases: Vec<BTreeMap<String, f64>>,
    /// Columns of result tables whose smallest and largest values are written to `sweep.csv`, as `TABLE.COLUMN`, for instance
    /// `contact.max_pressure`.
    #[key(default, skip, by = |node, _| extreme(node))]
    pub extremes: Vec<String>,
}

/// Values of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum SweepValues {
    /// A list.
    List(Vec<f64>),
    /// Equally spaced values.
    Range(SweepRange),
}

/// Equally spaced values.
#[table(example = "[0.0, 0.1, 0.2] or { from = 0.0, to = 1.0, count = 5 }")]
pub struct SweepRange {
    /// The first value.
    #[key(dimension = "as the parameter", example = "0.0")]
    pub from: f64,
    /// The last value.
    #[key(dimension = "as the parameter", example = "1.0")]
    pub to: f64,
    /// Number of values, both ends included, at least 2.
    #[key(example = "5", range = 2..=Sweep::MAX_CASES as u32)]
    pub count: u32,
}

impl SweepValues {
    /// The values in order.
    pub fn values(&self) -> Vec<f64> {
        match self {
            Self::List(values) => values.clone(),
            Self::Range(SweepRange { from, to, count }) => {
                let last = count.saturating_sub(1).max(1);
                (0..*count)
                    .map(|k| {
                        let s = f64::from(k) / f64::from(last);
                        // Both ends exactly.
                        (1.0 - s) * from + s * to
                    })
                    .collect()
            }
        }
    }
}

impl Sweep {
    /// Largest number of cases of a sweep.
    pub const MAX_CASES: usize = 100_000;

    /// Tables of results of which columns may be named in [`Self::extremes`].
    pub const TABLES: [&'static str; 6] = ["balance", "contact", "joints", "newton", "probes", "watch"];

    /// The parameters that some case gives, in alphabetical order.
    pub fn parameters(&self) -> Vec<&str> {
        let names = self.grid.keys().chain(self.cases.iter().flat_map(BTreeMap::keys));
        let mut names: Vec<&str> = names.map(String::as_str).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Number of cases.
    pub fn count(&self) -> usize {
        if self.grid.is_empty() {
            self.cases.len()
        } else {
            self.grid.values().fold(1, |count: usize, values| {
                count.saturating_mul(match values {
                    SweepValues::List(values) => values.len(),
                    SweepValues::Range(range) => range.count as usize,
                })
            })
        }
    }

    /// All cases in order: the values of the parameters that each gives.
    pub fn all(&self) -> Vec<BTreeMap<String, f64>> {
        if self.grid.is_empty() {
            return self.cases.clone();
        }
        let mut cases = vec![BTreeMap::new()];
        for (name, values) in &self.grid {
            let values = values.values();
            cases = cases
                .iter()
                .flat_map(|case| {
                    values.iter().map(move |&value| {
                        let mut case: BTreeMap<String, f64> = case.clone();
                        case.insert(name.clone(), value);
                        case
                    })
                })
                .collect();
        }
        cases
    }
}

impl<C> Value<C> for SweepValues {
    fn read(node: &Node<'_>, context: &C) -> Option<Self> {
        if !node.value.is_array() {
            return SweepRange::read(node, context).map(Self::Range);
        }
        let list = node.list(Node::number)?;
        if list.is_empty() {
            return node.fail("has no value", "write for instance [0.0, 0.1]");
        }
        Some(Self::List(list))
    }
}

fn cases(node: &Node<'_>) -> Option<Vec<BTreeMap<String, f64>>> {
    let cases = node.list(|n| entries(n, Node::number))?;
    if cases.is_empty() {
        return node.fail("has no case", "write for instance [{ mu = 0.1 }, { mu = 0.2 }]");
    }
    Some(cases)
}

fn one_of_both<C>(_: &SweepKeys, table: &Table<'_>, _: &C) -> Option<()> {
    match (table.has("grid"), table.has("cases")) {
        (true, true) => table.fail("cases", "`grid` is given too", "give one of the two"),
        (false, false) => table.missing("grid", "grid = { mu = [0.0, 0.1, 0.2] }"),
        _ => Some(()),
    }
}

fn not_too_many<C>(sweep: &Sweep, table: &Table<'_>, _: &C) -> Option<()> {
    let (count, most) = (sweep.count(), Sweep::MAX_CASES);
    if count > most {
        let remedy = "give fewer values, or split the sweep";
        return table.node.fail(format!("has {count} cases, more than {most}"), remedy);
    }
    Some(())
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
                format!("add `[{PARAMETERS}]` with `{name} = 1.0`, and use it in the scene as \"{name}\"")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_every_combination_once() {
        let grid = BTreeMap::from([
            ("mu".to_owned(), SweepValues::List(vec![0.0, 0.5])),
            ("radius".to_owned(), SweepValues::Range(SweepRange { from: 1.0, to: 1.3, count: 4 })),
        ]);
        let sweep = Sweep { grid, ..Sweep::default() };
        let cases = sweep.all();
        assert_eq!((sweep.count(), cases.len(), sweep.parameters()), (8, 8, vec!["mu", "radius"]));
        assert_eq!((cases[0]["mu"], cases[0]["radius"]), (0.0, 1.0));
        assert_eq!((cases[3]["mu"], cases[3]["radius"]), (0.0, 1.3));
        assert_eq!((cases[4]["mu"], cases[4]["radius"]), (0.5, 1.0));
        assert!((cases[1]["radius"] - 1.1).abs() < 1e-15);
    }
}
