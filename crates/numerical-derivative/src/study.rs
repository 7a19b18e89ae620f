//! Error against step size: the study of thesis figure D.1.

use crate::{DerivativeError, DifferenceStep, Method, ScalarFunction, derivative};

/// Errors of all methods with one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The step.
    pub step: f64,
    /// Errors in the order of [`Method::ALL`]; [`Row::error`] finds one.
    pub errors: [f64; 4],
}

impl Row {
    /// The error of a method, relative to the exact derivative (absolute if that is zero). NaN if the method has no
    /// value: the step is lost in the round-off of the argument, or the function is known for real arguments only.
    pub fn error(&self, method: Method) -> f64 {
        self.errors[method as usize]
    }
}

/// Errors of all methods at `x` for each of the steps, given the exact derivative.
///
/// # Errors
/// [`DerivativeError::Step`] for a step that is not a positive number.
pub fn study(
    function: &mut impl ScalarFunction,
    exact: f64,
    x: f64,
    steps: &[f64],
) -> Result<Vec<Row>, DerivativeError> {
    let scale = if exact == 0.0 { 1.0 } else { exact.abs() };
    let mut rows = Vec::with_capacity(steps.len());
    for &step in steps {
        let mut errors = [f64::NAN; 4];
        for (error, method) in errors.iter_mut().zip(Method::ALL) {
            match derivative(function, x, method, DifferenceStep::Fixed(step)) {
                Ok(value) => *error = (value - exact).abs() / scale,
                Err(DerivativeError::LostStep { .. } | DerivativeError::RealOnly) => {}
                Err(other) => return Err(other),
            }
        }
        rows.push(Row { step, errors });
    }
    Ok(rows)
}

/// Steps `10^(-k/per_decade)` from `10^first` down to `10^last` (both included).
pub fn steps(first: i32, last: i32, per_decade: u32) -> Vec<f64> {
    let per_decade = per_decade.max(1);
    let count = (first.saturating_sub(last)).max(0).unsigned_abs().saturating_mul(per_decade);
    (0..=count).map(|k| 10.0_f64.powf(f64::from(first) - f64::from(k) / f64::from(per_decade))).collect()
}

/// The best step of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimum {
    /// The step.
    pub step: f64,
    /// The largest error with a step not farther than a factor 3 from it.
    pub error: f64,
}

/// The step around which the largest error is least; `None` if the method has no value.
///
/// The least error itself says little: the round-off error of a single step is random and now and then happens to
/// be almost zero. Steps for which the method has no value do not count.
pub fn optimum(rows: &[Row], method: Method) -> Option<Optimum> {
    let valued = || rows.iter().filter(|row| !row.error(method).is_nan());
    let around = |step: f64| {
        let near = valued().filter(|row| row.step <= 3.0 * step && step <= 3.0 * row.step);
        Optimum { step, error: near.map(|row| row.error(method)).fold(0.0, f64::max) }
    };
    valued().map(|row| around(row.step)).min_by(|a, b| a.error.total_cmp(&b.error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_include_both_ends() {
        let all = steps(0, -2, 2);
        assert_eq!(all.len(), 5);
        for (step, expected) in all.iter().zip([1.0, 0.1 * 10.0_f64.sqrt(), 0.1, 0.01 * 10.0_f64.sqrt(), 0.01]) {
            assert!((step / expected - 1.0).abs() < 1e-14);
        }
        assert_eq!(steps(-3, -3, 4).len(), 1);
        assert_eq!(steps(-3, 0, 4).len(), 1);
    }

    #[test]
    fn the_optimum_ignores_a_lucky_step() {
        let row = |step: f64, error: f64| Row { step, errors: [error, f64::NAN, error, error] };
        let rows = [row(1e-1, 1e-2), row(1e-2, 1e-4), row(1e-3, 1e-3), row(1e-4, 1e-9), row(2e-4, 1e-2)];
        assert_eq!(optimum(&rows, Method::Forward), Some(Optimum { step: 1e-2, error: 1e-4 }));
        assert_eq!(optimum(&rows, Method::Backward), None);
        assert_eq!(optimum(&[], Method::Central), None);
    }

    #[test]
    fn errors_are_relative_unless_the_derivative_is_zero() {
        // Forward difference of x^2 at 3 and at 0 with h = 1/2: 6.5 and 0.5.
        let rows = study(&mut |x: f64| x * x, 6.0, 3.0, &[0.5]).unwrap();
        assert_eq!(rows[0].error(Method::Forward), 0.5 / 6.0);
        assert!(rows[0].error(Method::ComplexStep).is_nan());
        let rows = study(&mut |x: f64| x * x, 0.0, 0.0, &[0.5]).unwrap();
        assert_eq!(rows[0].error(Method::Forward), 0.5);
        assert!(study(&mut |x: f64| x, 1.0, 3.0, &[1e-30]).unwrap()[0].errors.iter().all(|error| error.is_nan()));
        assert!(study(&mut |x: f64| x, 1.0, 3.0, &[0.0]).is_err());
    }
}
