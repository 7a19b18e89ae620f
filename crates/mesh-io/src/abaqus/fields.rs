//! Fields of a line: numbers, labels, ranges.

use crate::MeshIoError;
use crate::lines::Lines;

/// A label without white space at its ends and without quotes.
pub(super) fn unquote(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(text)
}

/// Fields between commas, trimmed; commas within quotes do not count.
pub(super) fn fields(text: &str) -> impl Iterator<Item = &str> {
    let mut quoted = false;
    text.split(move |c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    })
    .map(str::trim)
}

/// A number and the instance before it, if there is one: `12` or `part-1-1.12`.
pub(super) fn number(field: &str) -> Option<(u64, Option<&str>)> {
    match field.rsplit_once('.') {
        Some((instance, number)) if instance.contains(char::is_alphabetic) => {
            Some((number.parse().ok()?, Some(instance)))
        }
        _ => Some((field.parse().ok()?, None)),
    }
}

/// A line of GENERATE: first, last, increment (1 if it is left out).
pub(super) fn range(lines: &Lines, data: &str) -> Result<[u64; 3], MeshIoError> {
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
    Ok([first, last, step])
}

/// `N` numbers; those that are left out are zero.
pub(super) fn reals<const N: usize>(lines: &Lines, data: &str, what: &str) -> Result<[f64; N], MeshIoError> {
    let mut values = [0.0; N];
    for (value, field) in values.iter_mut().zip(fields(data)) {
        if !field.is_empty() {
            *value = lines.parse_real(Some(field), what)?;
        }
    }
    Ok(values)
}
