//! Functions whose derivative can be taken.

use crate::{DerivativeError, Scalar};
use num_complex::Complex64;

/// A function of one variable. Closures over `f64` are such functions, and what is wrapped into [`Analytic`].
///
/// A function without a value at `x` gives NaN, and so does its derivative there.
pub trait ScalarFunction {
    /// The value at a real argument.
    fn real(&mut self, x: f64) -> f64;

    /// The value at a complex argument.
    ///
    /// # Errors
    /// [`DerivativeError::RealOnly`] if there is none (the default).
    fn complex(&mut self, _x: Complex64) -> Result<Complex64, DerivativeError> {
        Err(DerivativeError::RealOnly)
    }
}

/// A function `R^n -> R^m`. Closures over slices of `f64` are such functions, and what is wrapped into [`Analytic`].
///
/// A function without a value at `x` gives NaN, and so does its derivative there.
pub trait VectorFunction {
    /// Writes the value at a real argument: `x` has `n` entries, `value` has `m`; all of them must be written.
    fn real(&mut self, x: &[f64], value: &mut [f64]);

    /// Writes the value at a complex argument.
    ///
    /// # Errors
    /// [`DerivativeError::RealOnly`] if there is none (the default).
    fn complex(&mut self, _x: &[Complex64], _value: &mut [Complex64]) -> Result<(), DerivativeError> {
        Err(DerivativeError::RealOnly)
    }
}

impl<F: FnMut(f64) -> f64> ScalarFunction for F {
    fn real(&mut self, x: f64) -> f64 {
        self(x)
    }
}

impl<F: FnMut(&[f64], &mut [f64])> VectorFunction for F {
    fn real(&mut self, x: &[f64], value: &mut [f64]) {
        self(x, value);
    }
}

/// A holomorphic function of one variable, written once for real and complex arguments.
pub trait AnalyticScalar {
    /// The value.
    fn at<S: Scalar>(&self, x: S) -> S;
}

/// A holomorphic function `R^n -> R^m`, written once for real and complex arguments.
pub trait AnalyticVector {
    /// Writes the value: `x` has `n` entries, `value` has `m`; all of them must be written.
    fn at<S: Scalar>(&self, x: &[S], value: &mut [S]);
}

/// Makes a [`ScalarFunction`] of an [`AnalyticScalar`], or a [`VectorFunction`] of an [`AnalyticVector`], for all
/// methods.
#[derive(Clone, Copy, Debug)]
pub struct Analytic<F>(pub F);

impl<F: AnalyticScalar> ScalarFunction for Analytic<F> {
    fn real(&mut self, x: f64) -> f64 {
        self.0.at(x)
    }
    fn complex(&mut self, x: Complex64) -> Result<Complex64, DerivativeError> {
        Ok(self.0.at(x))
    }
}

impl<F: AnalyticVector> VectorFunction for Analytic<F> {
    fn real(&mut self, x: &[f64], value: &mut [f64]) {
        self.0.at(x, value);
    }
    fn complex(&mut self, x: &[Complex64], value: &mut [Complex64]) -> Result<(), DerivativeError> {
        self.0.at(x, value);
        Ok(())
    }
}
