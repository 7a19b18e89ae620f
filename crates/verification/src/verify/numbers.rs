//! Sizes of numbers and vectors. NaN wins every comparison: a measurement with a NaN must not pass.

/// The larger number as by `f64::max`, but NaN wins.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The largest of numbers that are not negative; 0 if there is none.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, larger)
}

/// Euclidean norm.
pub fn norm<const N: usize>(vector: [f64; N]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

/// Euclidean norm of `a - b`.
pub fn distance<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    norm(std::array::from_fn::<f64, N, _>(|i| a[i] - b[i]))
}

/// Largest component of `a - b`, without its sign.
pub fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    largest((0..3).map(|i| (a[i] - b[i]).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_the_largest() {
        assert!(larger(1.0, f64::NAN).is_nan() && larger(f64::NAN, 1.0).is_nan());
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan() && apart([f64::NAN, 0.0, 0.0], [1.0; 3]).is_nan());
        assert_eq!((largest([1.0, 3.0, 2.0]), largest([])), (3.0, 0.0));
    }

    #[test]
    fn sizes_of_vectors() {
        assert_eq!((norm([2.0, 3.0, 6.0]), distance([1.0, 5.0], [4.0, 1.0])), (7.0, 5.0));
        assert_eq!(apart([1.0, 2.0, 3.0], [1.0, 0.0, 4.0]), 2.0);
    }
}
