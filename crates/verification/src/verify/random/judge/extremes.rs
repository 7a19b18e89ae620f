//! Extremes of columns.

use super::is_worse;

/// The largest value with its place; no number is the largest.
pub fn worst(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold(
        (0, 0.0),
        |(row, most), (k, value)| {
            if is_worse(value, most) { (k, value) } else { (row, most) }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_is_found_with_its_place() {
        assert_eq!(worst([1.0, 3.0, 2.0].into_iter()), (1, 3.0));
        assert_eq!(worst(std::iter::empty()), (0, 0.0));
        assert!(worst([1.0, f64::NAN, 2.0].into_iter()).1.is_nan());
    }
}
