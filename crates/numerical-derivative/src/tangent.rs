//! The quotients: derivative, directional derivative, Jacobian.
//!
//! Differences of one argument are divided by the distance that the rounded arguments have, `(x + h) - x`, so that the
//! round-off of the argument does not enter; along a seed vector they are divided by `h`.

use crate::error::length;
use crate::{DerivativeError, DifferenceStep, Method, ScalarFunction, VectorFunction};
use num_complex::Complex64;

/// `f'(x)`.
///
/// # Errors
/// [`DerivativeError::Step`], [`DerivativeError::LostStep`], [`DerivativeError::RealOnly`]. A function without a value
/// gives NaN.
pub fn derivative(
    function: &mut impl ScalarFunction,
    x: f64,
    method: Method,
    step: DifferenceStep,
) -> Result<f64, DerivativeError> {
    let h = step.size(method, x)?;
    if method == Method::ComplexStep {
        return Ok(function.complex(Complex64::new(x, h))?.im / h);
    }
    let (right, left) = ends(method, x, h)?;
    Ok((function.real(right) - function.real(left)) / (right - left))
}

/// The two arguments of a difference; they differ.
fn ends(method: Method, x: f64, h: f64) -> Result<(f64, f64), DerivativeError> {
    let (right, left) = match method {
        Method::Forward => (x + h, x),
        Method::Backward => (x, x - h),
        _ => (x + h, x - h),
    };
    if right == left { Err(DerivativeError::LostStep { step: h, x }) } else { Ok((right, left)) }
}

/// Memory of [`directional_derivative`] and [`jacobian`]; grows as needed and can be used again.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    x: Vec<f64>,
    right: Vec<f64>,
    left: Vec<f64>,
    complex_x: Vec<Complex64>,
    complex_value: Vec<Complex64>,
}

impl Workspace {
    /// Memory for `R^inputs -> R^outputs`, for all methods.
    pub fn new(inputs: usize, outputs: usize) -> Self {
        let mut workspace = Self::default();
        workspace.fit(inputs, outputs);
        workspace
    }

    fn fit(&mut self, inputs: usize, outputs: usize) {
        self.x.resize(inputs, 0.0);
        self.right.resize(outputs, 0.0);
        self.left.resize(outputs, 0.0);
        self.complex_x.resize(inputs, Complex64::ZERO);
        self.complex_value.resize(outputs, Complex64::ZERO);
    }
}

/// `Df(x) p` into `out` (`m` entries) for a seed vector `p`; one or two evaluations, whatever `n`.
///
/// The step is taken for the largest entries of `x` and `p`: `h p` is as long as a step of one argument.
///
/// # Errors
/// [`DerivativeError::Length`] if `p` is not as long as `x`; [`DerivativeError::Step`], also for a seed that is
/// zero or not finite; [`DerivativeError::RealOnly`]. A function without a value gives NaN.
pub fn directional_derivative(
    function: &mut impl VectorFunction,
    x: &[f64],
    seed: &[f64],
    method: Method,
    step: DifferenceStep,
    workspace: &mut Workspace,
    out: &mut [f64],
) -> Result<(), DerivativeError> {
    length("the seed", seed.len(), x.len())?;
    workspace.fit(x.len(), out.len());
    let h = match step {
        DifferenceStep::Fixed(_) => step.size(method, 0.0)?,
        DifferenceStep::Scaled(_) => {
            let size = step.size(method, largest(x))? / largest(seed);
            DifferenceStep::Fixed(size).size(method, 0.0)?
        }
    };
    if method == Method::ComplexStep {
        let Workspace { complex_x, complex_value, .. } = workspace;
        for ((z, x), p) in complex_x.iter_mut().zip(x).zip(seed) {
            *z = Complex64::new(*x, h * p);
        }
        function.complex(complex_x, complex_value)?;
        for (out, value) in out.iter_mut().zip(complex_value) {
            *out = value.im / h;
        }
        return Ok(());
    }
    let (forth, back) = match method {
        Method::Forward => (h, 0.0),
        Method::Backward => (0.0, -h),
        _ => (h, -h),
    };
    let Workspace { x: moved, right, left, .. } = workspace;
    let mut evaluate = |h: f64, value: &mut [f64]| {
        for ((moved, x), p) in moved.iter_mut().zip(x).zip(seed) {
            *moved = x + h * p;
        }
        function.real(moved, value);
    };
    evaluate(forth, right);
    evaluate(back, left);
    for ((out, right), left) in out.iter_mut().zip(right).zip(left) {
        *out = (*right - *left) / (forth - back);
    }
    Ok(())
}

/// Largest magnitude; NaN if there is one.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| if value.abs() > most || value.is_nan() { value.abs() } else { most })
}

/// `df_i/dx_j` into `out`, row-major: entry `(i, j)` is `out[i * n + j]`; `m = out.len() / n` outputs.
///
/// `n + 1` evaluations for forward and backward differences, `2 n` for central ones, `n` complex ones for the
/// complex step. Each argument has its own step.
///
/// # Errors
/// [`DerivativeError::Length`] if `out` is no multiple of `n`; [`DerivativeError::Step`],
/// [`DerivativeError::LostStep`], [`DerivativeError::RealOnly`]. A function without a value gives NaN.
pub fn jacobian(
    function: &mut impl VectorFunction,
    x: &[f64],
    method: Method,
    step: DifferenceStep,
    workspace: &mut Workspace,
    out: &mut [f64],
) -> Result<(), DerivativeError> {
    let columns = x.len();
    let rows = out.len().checked_div(columns).unwrap_or(0);
    length("the Jacobian", out.len(), rows * columns)?;
    workspace.fit(columns, rows);
    let Workspace { x: moved, right, left, complex_x, complex_value } = workspace;
    moved.copy_from_slice(x);
    if method == Method::ComplexStep {
        for (z, x) in complex_x.iter_mut().zip(x) {
            *z = Complex64::new(*x, 0.0);
        }
    }
    match method {
        Method::Forward => function.real(x, left),
        Method::Backward => function.real(x, right),
        Method::Central | Method::ComplexStep => {}
    }
    for column in 0..columns {
        let h = step.size(method, x[column])?;
        if method == Method::ComplexStep {
            complex_x[column].im = h;
            function.complex(complex_x, complex_value)?;
            complex_x[column].im = 0.0;
            for row in 0..rows {
                out[row * columns + column] = complex_value[row].im / h;
            }
            continue;
        }
        let (forth, back) = ends(method, x[column], h)?;
        if method != Method::Backward {
            moved[column] = forth;
            function.real(moved, right);
        }
        if method != Method::Forward {
            moved[column] = back;
            function.real(moved, left);
        }
        moved[column] = x[column];
        for row in 0..rows {
            out[row * columns + column] = (right[row] - left[row]) / (forth - back);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIFFERENCES: [Method; 3] = [Method::Forward, Method::Backward, Method::Central];

    #[test]
    fn differences_are_exact_for_polynomials_of_their_order() {
        // (x + h)^2: forward 2 x + h, backward 2 x - h, central 2 x; all numbers are dyadic.
        let slopes = DIFFERENCES.map(|method| derivative(&mut |x: f64| x * x, 3.0, method, DifferenceStep::Fixed(0.5)));
        assert_eq!(slopes, [Ok(6.5), Ok(5.5), Ok(6.0)]);
    }

    #[test]
    fn jacobians_are_row_major() {
        let mut f = |x: &[f64], y: &mut [f64]| {
            y[0] = 2.0 * x[0] + 3.0 * x[1];
            y[1] = 5.0 * x[1] - x[2];
        };
        for method in DIFFERENCES {
            let mut out = [f64::NAN; 6];
            let x = [1.0, -2.0, 4.0];
            jacobian(&mut f, &x, method, DifferenceStep::Fixed(0.25), &mut Workspace::default(), &mut out).unwrap();
            assert_eq!(out, [2.0, 3.0, 0.0, 0.0, 5.0, -1.0], "{method}");
            let mut along = [f64::NAN; 2];
            let seed = [1.0, 2.0, -1.0];
            let mut workspace = Workspace::new(3, 2);
            directional_derivative(&mut f, &x, &seed, method, DifferenceStep::Fixed(0.25), &mut workspace, &mut along)
                .unwrap();
            assert_eq!(along, [8.0, 11.0], "{method}");
        }
    }

    #[test]
    fn evaluations_are_counted() {
        for (method, expected) in DIFFERENCES.into_iter().zip([4, 4, 6]) {
            let mut count = 0;
            let mut f = |x: &[f64], y: &mut [f64]| {
                count += 1;
                y[0] = x[0];
            };
            jacobian(&mut f, &[1.0; 3], method, DifferenceStep::default(), &mut Workspace::default(), &mut [0.0; 3])
                .unwrap();
            assert_eq!(count, expected, "{method}");
        }
    }

    #[test]
    fn wrong_use_is_an_error() {
        let mut f = |x: &[f64], y: &mut [f64]| y.fill(x[0]);
        let work = &mut Workspace::default();
        let any = DifferenceStep::default();
        assert_eq!(
            jacobian(&mut f, &[1.0; 3], Method::Forward, any, work, &mut [0.0; 4]),
            Err(DerivativeError::Length { what: "the Jacobian", expected: 3, found: 4 })
        );
        assert!(jacobian(&mut f, &[], Method::Forward, any, work, &mut [0.0; 1]).is_err());
        let complex = Method::ComplexStep;
        assert_eq!(jacobian(&mut f, &[1.0], complex, any, work, &mut [0.0]), Err(DerivativeError::RealOnly));
        let mut along = |seed: &[f64], step| {
            directional_derivative(&mut f, &[1.0, 2.0], seed, Method::Central, step, work, &mut [0.0])
        };
        assert!(
            along(&[1.0], any).is_err() && along(&[0.0, 0.0], any).is_err() && along(&[1.0, f64::NAN], any).is_err()
        );
        assert_eq!(along(&[0.0, 0.0], DifferenceStep::Fixed(0.1)), Ok(()));
        let lost = derivative(&mut |x: f64| x, 2.0, Method::Central, DifferenceStep::Fixed(1e-17));
        assert_eq!(lost, Err(DerivativeError::LostStep { step: 1e-17, x: 2.0 }));
        assert!(lost.unwrap_err().to_string().contains("1e-17"));
        assert!(derivative(&mut |_: f64| f64::NAN, 2.0, Method::Central, any).unwrap().is_nan());
    }
}
