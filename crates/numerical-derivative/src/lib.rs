//! Numerical tangents (thesis D.1): forward, backward and central differences, and the complex step.
//!
//! * [`derivative`]: of a function of one variable;
//! * [`directional_derivative`], [`jacobian`]: of `R^n -> R^m`, along a seed vector or all of it;
//! * [`check_jacobian`], [`compare_jacobians`]: an analytic Jacobian against a numerical one, with the worst entry;
//! * [`study`], [`optimum`]: error against step size.
//!
//! What it is *not*: automatic differentiation, sparse Jacobians, derivatives of higher order.
//!
//! # One body for all methods
//! A function that is written over [`Scalar`] and wrapped into [`Analytic`] serves all four [`Method`]s; a closure
//! over `f64` serves the three differences, and the complex step answers [`DerivativeError::RealOnly`].
//!
//! ```
//! use stoss_numerical_derivative::{Analytic, AnalyticScalar, DifferenceStep, Method, Scalar, derivative};
//!
//! /// The example of thesis D.1.
//! struct Example;
//!
//! impl AnalyticScalar for Example {
//!     fn at<S: Scalar>(&self, x: S) -> S {
//!         x.sin() + x.powi(4)
//!     }
//! }
//!
//! let exact = 2.0_f64.cos() + 32.0;
//! let slope = derivative(&mut Analytic(Example), 2.0, Method::ComplexStep, DifferenceStep::default())?;
//! assert!((slope / exact - 1.0).abs() < 1e-15);
//! let slope = derivative(&mut |x: f64| x.sin() + x.powi(4), 2.0, Method::Central, DifferenceStep::default())?;
//! assert!((slope / exact - 1.0).abs() < 1e-9);
//! # Ok::<(), stoss_numerical_derivative::DerivativeError>(())
//! ```
//!
//! # Where the complex step is wrong
//! `Im f(x + i h)/h` is the derivative only of functions that are holomorphic at `x`. It is wrong, without any
//! warning, for `|z|`, norms with conjugates (`sqrt(z conj(z))`: write `sqrt(z z)`), `max`, `min`, comparisons of
//! complex numbers and everything that drops the imaginary part. [`Scalar`] therefore has none of these. A branch
//! chosen by [`Scalar::real`] is right, but on the seam itself, where there is no derivative. Eigenvalue routines
//! for symmetric real matrices use conjugates, too.
//!
#![doc = include_str!("../README.md")]

mod compare;
mod error;
mod function;
mod method;
mod scalar;
mod study;
mod tangent;

pub use compare::{Comparison, check_jacobian, compare_jacobians};
pub use error::DerivativeError;
pub use function::{Analytic, AnalyticScalar, AnalyticVector, ScalarFunction, VectorFunction};
pub use method::{DifferenceStep, Method};
pub use num_complex::Complex64;
pub use scalar::Scalar;
pub use study::{Optimum, Row, optimum, steps, study};
pub use tangent::{Workspace, derivative, directional_derivative, jacobian};
