//! What stands in data lines: numbers, labels, ranges.

use std::path::Path;

use super::keyword::{fields, unquote};
use super::sets::{Labels, Level, Sets};
use crate::MeshIoError;
use crate::lines::Lines;

/// What a set holds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Node,
    Element,
}

/// The labels of a set that must exist.
pub(super) fn find<'s>(
    path: &Path,
    sets: &'s Sets,
    field: &str,
    level: Level,
    line: usize,
    kind: Kind,
) -> Result<&'s Labels, MeshIoError> {
    let name = unquote(field);
    let found = sets.find(name, level).or_else(|| name.rsplit_once('.').and_then(|(_, n)| sets.find(n, Level::Part)));
    found.map(|set| &set.labels).ok_or_else(|| MeshIoError::Unknown {
        path: path.to_owned(),
        line,
        kind: if kind == Kind::Node { "node set (or number)" } else { "element set (or number)" },
        number: name.to_owned(),
    })
}

/// A number and whether the name of an instance stands before it: `12` or `part-1-1.12`.
pub(super) fn number(field: &str) -> Option<(u64, bool)> {
    match field.rsplit_once('.') {
        Some((instance, number)) if instance.contains(char::is_alphabetic) => Some((number.parse().ok()?, true)),
        _ => Some((field.parse().ok()?, false)),
    }
}

/// A line of GENERATE: first, last, increment (1 if it is left out).
pub(super) fn range(lines: &Lines, data: &str) -> Result<(u64, u64, u64), MeshIoError> {
    let mut fields = fields(data);
    let first = lines.parse(fields.next(), "the first number")?;
    let last = lines.parse(fields.next(), "the last number")?;
    let step = match fields.next() {
        None | Some("") => 1,
        Some(field) => lines.parse(Some(field), "the increment")?,
    };
    if step == 0 || last < first {
        return Err(lines.error(data, "GENERATE needs first <= last and a positive increment"));
    }
    Ok((first, last, step))
}

/// Exactly `N` numbers.
pub(super) fn reals<const N: usize>(lines: &Lines, data: &str) -> Result<[f64; N], MeshIoError> {
    let mut values = [0.0; N];
    let mut fields = fields(data);
    for value in &mut values {
        *value = lines.parse_real(fields.next(), "a number of the placement")?;
    }
    Ok(values)
}
