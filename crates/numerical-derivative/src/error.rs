//! What can go wrong.

use std::fmt;

/// Why there is no numerical derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DerivativeError {
    /// The complex step of a function that is only known for real arguments.
    RealOnly,
    /// A step that is zero, negative, infinite or NaN, or an argument from which none can be made.
    Step {
        /// The step.
        step: f64,
    },
    /// A step so small that it is lost in the round-off of the argument.
    LostStep {
        /// The step.
        step: f64,
        /// The argument.
        x: f64,
    },
    /// A vector or a matrix of the wrong length.
    Length {
        /// Name of the vector or matrix.
        what: &'static str,
        /// The length that was needed.
        expected: usize,
        /// The length that was given.
        found: usize,
    },
}

impl fmt::Display for DerivativeError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RealOnly => write!(out, "the complex step needs a function of complex arguments"),
            Self::Step { step } => write!(out, "the step {step:e} is not a positive number"),
            Self::LostStep { step, x } => write!(out, "the step {step:e} is lost in the round-off of {x:e}"),
            Self::Length { what, expected, found } => write!(out, "{what} has {found} entries instead of {expected}"),
        }
    }
}

impl std::error::Error for DerivativeError {}

/// `Ok` if the lengths agree.
pub(crate) fn length(what: &'static str, found: usize, expected: usize) -> Result<(), DerivativeError> {
    if found == expected { Ok(()) } else { Err(DerivativeError::Length { what, expected, found }) }
}
