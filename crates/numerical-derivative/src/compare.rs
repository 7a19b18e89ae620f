//! An analytic Jacobian against a numerical one.

use crate::error::length;
use crate::{DerivativeError, DifferenceStep, Method, VectorFunction, Workspace, jacobian};
use std::fmt;

/// The entry in which two Jacobians differ most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Row of the worst entry, from 0.
    pub row: usize,
    /// Column of the worst entry, from 0.
    pub column: usize,
    /// Analytic value of the worst entry.
    pub analytic: f64,
    /// Numerical value of the worst entry.
    pub numerical: f64,
    /// Largest magnitude of an entry of the numerical Jacobian.
    pub scale: f64,
    /// `|analytic - numerical| / scale`; infinite if an entry is not finite, zero if both Jacobians are zero.
    pub relative_error: f64,
}

impl fmt::Display for Comparison {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { row, column, analytic, numerical, relative_error, .. } = self;
        write!(
            out,
            "relative error {relative_error:.2e}, worst at ({row}, {column}): {analytic:e}, numerically {numerical:e}"
        )
    }
}

/// Compares two row-major Jacobians of `columns` columns, relative to the largest entry of the numerical one.
///
/// # Errors
/// [`DerivativeError::Length`] if they are empty, of different lengths, or no multiple of `columns`.
pub fn compare_jacobians(analytic: &[f64], numerical: &[f64], columns: usize) -> Result<Comparison, DerivativeError> {
    length("the analytic Jacobian", analytic.len(), numerical.len())?;
    let rows = numerical.len().checked_div(columns).unwrap_or(0).max(1);
    length("the numerical Jacobian", numerical.len(), rows * columns.max(1))?;
    // A NaN or an infinite entry is worse than any other; it is not finite minus anything either.
    let distance = |k: usize| {
        let distance = (analytic[k] - numerical[k]).abs();
        if distance.is_nan() { f64::INFINITY } else { distance }
    };
    let mut worst = 0;
    let mut scale = 0.0_f64;
    for k in 0..numerical.len() {
        scale = scale.max(numerical[k].abs());
        if distance(k) > distance(worst) {
            worst = k;
        }
    }
    let relative_error = match distance(worst) {
        0.0 => 0.0,
        distance if distance.is_finite() => distance / scale,
        _ => f64::INFINITY,
    };
    Ok(Comparison {
        row: worst / columns,
        column: worst % columns,
        analytic: analytic[worst],
        numerical: numerical[worst],
        scale,
        relative_error,
    })
}

/// Compares an analytic Jacobian (row-major, `m * n` entries) with the numerical one at `x` (`n` entries).
///
/// # Errors
/// The errors of [`jacobian`] and of [`compare_jacobians`].
pub fn check_jacobian(
    function: &mut impl VectorFunction,
    x: &[f64],
    analytic: &[f64],
    method: Method,
    step: DifferenceStep,
) -> Result<Comparison, DerivativeError> {
    let mut numerical = vec![0.0; analytic.len()];
    jacobian(function, x, method, step, &mut Workspace::default(), &mut numerical)?;
    compare_jacobians(analytic, &numerical, x.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_entry_is_told() {
        let worst = compare_jacobians(&[1.0, 2.0, 3.5, 4.0, 5.0, -8.0], &[1.0, 2.0, 3.0, 4.0, 5.0, -8.0], 3).unwrap();
        assert_eq!((worst.row, worst.column, worst.relative_error, worst.scale), (0, 2, 0.0625, 8.0));
        assert_eq!((worst.analytic, worst.numerical), (3.5, 3.0));
        assert!(worst.to_string().contains("(0, 2)"));
        assert_eq!(compare_jacobians(&[0.0; 2], &[0.0; 2], 1).unwrap().relative_error, 0.0);
        assert_eq!(compare_jacobians(&[0.0, 1.0], &[0.0; 2], 1).unwrap().relative_error, f64::INFINITY);
    }

    #[test]
    fn a_nan_is_worst_wherever_it_is() {
        for place in 0..4 {
            for value in [f64::NAN, f64::INFINITY] {
                let mut odd = [1.0, 2.0, 3.0, 4.0];
                odd[place] = value;
                for worst in [compare_jacobians(&odd, &[1.1; 4], 2), compare_jacobians(&[1.1; 4], &odd, 2)] {
                    let worst = worst.unwrap();
                    assert_eq!((2 * worst.row + worst.column, worst.relative_error), (place, f64::INFINITY));
                }
            }
        }
    }

    #[test]
    fn lengths_must_fit() {
        for (analytic, numerical, columns) in [(2, 3, 1), (0, 0, 1), (3, 3, 2), (3, 3, 0), (0, 0, 0)] {
            let (analytic, numerical) = (vec![0.0; analytic], vec![0.0; numerical]);
            assert!(compare_jacobians(&analytic, &numerical, columns).is_err(), "{columns}");
        }
    }

    #[test]
    fn a_wrong_analytic_entry_is_found() {
        let f = |x: &[f64], y: &mut [f64]| {
            y[0] = x[0] * x[1];
            y[1] = x[0] + x[1] * x[1];
        };
        let right = [3.0, 2.0, 1.0, 6.0];
        let check = |jacobian: &[f64]| {
            check_jacobian(&mut { f }, &[2.0, 3.0], jacobian, Method::Central, DifferenceStep::default())
        };
        assert!(check(&right).unwrap().relative_error < 1e-10);
        let wrong = check(&[3.0, 2.0, 1.0, 6.1]).unwrap();
        assert_eq!((wrong.row, wrong.column), (1, 1));
        assert!((wrong.relative_error - 0.1 / 6.0).abs() < 1e-9);
    }
}
