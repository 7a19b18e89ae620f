//! Numbers in sentences.

/// A time with six significant digits at most.
pub(crate) fn short_time(time: f64) -> String {
    // cannot fail: what was written as a number is read as one.
    let rounded: f64 = format!("{time:.5e}").parse().unwrap_or(time);
    let is_plain = rounded == 0.0 || (1.0e-4..1.0e7).contains(&rounded.abs());
    if is_plain { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Two or three digits.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e4).contains(&size) { format!("{value:.1e}") } else { format!("{value:.3}") }
}
