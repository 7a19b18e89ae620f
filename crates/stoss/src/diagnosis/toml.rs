//! Values as they are written in a scene.

/// A number.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A list of strings.
pub(super) fn strings(list: &[&str]) -> String {
    let list: Vec<String> = list.iter().map(|text| format!("\"{text}\"")).collect();
    format!("[{}]", list.join(", "))
}

/// Three numbers.
pub(super) fn vector(value: [f64; 3]) -> String {
    format!("[{}, {}, {}]", number(value[0]), number(value[1]), number(value[2]))
}

/// The next smaller number with two digits.
pub(super) fn down(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return value;
    }
    let unit = 10f64.powi(value.log10().floor() as i32 - 1);
    short((value / unit * (1.0 + 1e-12)).floor() * unit)
}

/// A number for people: with a power of ten only where it is needed.
pub(super) fn plain(value: f64) -> String {
    let value = short(value);
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// The number without the last digits, which are round-off.
pub(super) fn short(value: f64) -> f64 {
    // cannot fail: what was written as a number is read as one.
    format!("{value:.6e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_down_and_read_back() {
        for (value, wanted) in [(0.1763, 0.17), (0.05, 0.05), (2.0, 2.0), (7.9e-9, 7.9e-9), (123.0, 120.0)] {
            assert_eq!(down(value), wanted);
            assert_eq!(number(down(value)).parse::<f64>(), Ok(wanted));
        }
        assert_eq!([7.85, 7850.0, 7.85e-9, 2.1e11, 0.0].map(plain), ["7.85", "7850", "7.85e-9", "2.1e11", "0"]);
        assert_eq!(vector([0.0, 0.3 - 0.1, 1.0].map(short)), "[0.0, 0.2, 1.0]");
    }
}
