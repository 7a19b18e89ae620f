//! Numbers in messages.

/// A number in a message: rounded to a millionth of `scale` (the step size for times, the model's size for places; the number itself if that is
/// not positive), without zeros at its end, and with an exponent if it is very small or very large.
pub fn short(value: f64, scale: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let scale = if scale > 0.0 && scale.is_finite() { scale } else { value.abs().max(f64::MIN_POSITIVE) };
    let places = (6.0 - scale.log10().floor()).clamp(0.0, 330.0) as usize;
    // cannot fail: what was written as a number is read as one.
    let rounded: f64 = format!("{value:.places$}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1.0e-4..1.0e7 => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_their_scale_has() {
        for (value, scale, expected) in [
            (0.950_000_000_000_000_1, 0.01, "0.95"),
            (3.0e-7, 1.0e-8, "3e-7"),
            (2.3e-6 + 1e-21, 1.0e-6, "2.3e-6"),
            (123.456_7, 1.0e-4, "123.4567"),
            (1.0e-17, 1.0, "0"),
            (-1.0e-17, 1.0, "0"),
            (-0.25, 2.0, "-0.25"),
            (1.0 / 3.0, 1.0, "0.333333"),
            (12_345_678.9, 1.0e3, "1.23456789e7"),
            (1.0 / 3.0, 0.0, "0.3333333"),
            (0.0, 0.0, "0"),
            (f64::NAN, 1.0, "NaN"),
        ] {
            assert_eq!(short(value, scale), expected);
        }
    }
}
