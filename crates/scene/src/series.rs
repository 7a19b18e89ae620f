//! Functions of time.

use crate::read::{Node, Value, with_article};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use stoss_scene_derive::table;
use toml::de::DeValue;

/// A function of time with one or more values: a constant, or `{ table = [[time, value, ...], ...] }`, linear in between and
/// constant before the first and after the last row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum Series {
    /// A constant value.
    Scalar(f64),
    /// Constant values.
    Vector(Vec<f64>),
    /// Rows of a table.
    Table(SeriesTable),
}

/// Rows `[time, value, ...]` with increasing times and equally many values.
#[table(context(usize))]
pub struct SeriesTable {
    /// The rows, at least one.
    #[key(dimension = "time, then as the key", example = "[[0.0, 0.0], [1.0, 1.0]]", with = |node, columns, _| rows(node, *columns))]
    pub table: Vec<Vec<f64>>,
}

impl Series {
    /// Rows `[time, value, ...]`; a constant is one row at time zero.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        match self {
            Self::Scalar(value) => vec![vec![0.0, *value]],
            Self::Vector(values) => vec![std::iter::once(0.0).chain(values.iter().copied()).collect()],
            Self::Table(table) => table.table.clone(),
        }
    }

    /// Number of values.
    pub fn columns(&self) -> usize {
        match self {
            Self::Scalar(_) => 1,
            Self::Vector(values) => values.len(),
            Self::Table(table) => table.table.first().map_or(0, |row| row.len().saturating_sub(1)),
        }
    }

    /// A constant or a table with `columns` values.
    pub(crate) fn of(node: &Node<'_>, columns: usize) -> Option<Self> {
        let plural = if columns == 1 { "value" } else { "values" };
        match node.value {
            DeValue::Table(_) => SeriesTable::read(node, &columns).map(Self::Table),
            DeValue::Array(_) => {
                let values = node.list(Node::number)?;
                if values.len() != columns {
                    return node.fail(
                        format!("has {} values, needs {columns}", values.len()),
                        format!("write a list of {columns} {plural}, or {{ table = [[time, ...], ...] }}"),
                    );
                }
                Some(Self::Vector(values))
            }
            DeValue::Integer(_) | DeValue::Float(_) | DeValue::String(_) => {
                let value = node.number()?;
                if columns != 1 {
                    return node.fail(
                        format!("is one value, needs {columns}"),
                        format!("write a list of {columns} values, or {{ table = [[time, ...], ...] }}"),
                    );
                }
                Some(Self::Scalar(value))
            }
            _ => node.fail(
                format!("must be a constant or a table in time, found {}", with_article(node.value.type_str())),
                "write for instance { table = [[0.0, 0.0], [1.0, 0.1]] }",
            ),
        }
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
