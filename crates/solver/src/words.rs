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

/// A number with twelve significant digits at most: round-off in the last digits of a double is not shown. See [`significant`].
pub fn digits(value: f64) -> String {
    significant(value, 12)
}

/// A number with so many significant digits at most, one or more, without zeros at its end, and with an exponent if it is very small or very large.
pub fn significant(value: f64, digits: usize) -> String {
    // cannot fail: what was written as a number is read as one.
    let rounded: f64 = format!("{value:.places$e}", places = digits.max(1) - 1).parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1.0e-4..1.0e9 => rounded.to_string(),
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

    #[test]
    fn round_off_is_not_shown() {
        for (value, expected) in [
            (6.000_000_000_000_001e-4, "0.0006"),
            (0.1 + 0.2, "0.3"),
            (1.0 / 120.0, "0.00833333333333"),
            (2.300_000_000_000_000_4e-5, "2.3e-5"),
            (-0.0, "0"),
            (123_456_789.123_456_78, "123456789.123"),
            (2e20, "2e20"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(digits(value), expected);
        }
        for (value, digits, expected) in
            [(-1.313_859_4, 7, "-1.313859"), (1_234_567_890.0, 6, "1.23457e9"), (0.06, 0, "0.06")]
        {
            assert_eq!(significant(value, digits), expected);
        }
    }
}
