//! The four methods and their steps.

use crate::DerivativeError;
use std::fmt;

/// Method by which a derivative is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// `(f(x + h) - f(x))/h`, first order.
    Forward,
    /// `(f(x) - f(x - h))/h`, first order.
    Backward,
    /// `(f(x + h) - f(x - h))/(2 h)`, second order, twice the evaluations.
    Central,
    /// `Im f(x + i h)/h`, second order without any cancellation; holomorphic functions only.
    ComplexStep,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 4] = [Self::Forward, Self::Backward, Self::Central, Self::ComplexStep];

    /// Name for tables and legends.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::Central => "central",
            Self::ComplexStep => "complex step",
        }
    }

    /// Order of the truncation error in the step.
    pub fn order(self) -> u32 {
        match self {
            Self::Forward | Self::Backward => 1,
            Self::Central | Self::ComplexStep => 2,
        }
    }

    /// The step for an argument (and a function) of order one.
    ///
    /// A difference of order `p` has a truncation error of about `h^p` and a round-off error of about `eps/h`,
    /// which is least together at `h = eps^(1/(p+1))`: `sqrt(eps) = 1.5e-8` and `cbrt(eps) = 6e-6`, with the errors
    /// `sqrt(eps)` and `eps^(2/3) = 4e-11`. The complex step subtracts nothing, so that the step only has to be so
    /// small that its square is lost against one, and so large that neither it nor its cube underflows: `1e-100`.
    pub fn unit_step(self) -> f64 {
        match self {
            Self::Forward | Self::Backward => f64::EPSILON.sqrt(),
            Self::Central => f64::EPSILON.cbrt(),
            Self::ComplexStep => 1e-100,
        }
    }

    /// Relative error that the method can reach at its best step: [`Method::unit_step`] has the reason.
    pub fn attainable_error(self) -> f64 {
        match self {
            Self::Forward | Self::Backward => f64::EPSILON.sqrt(),
            Self::Central => f64::EPSILON.cbrt().powi(2),
            Self::ComplexStep => f64::EPSILON,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

/// Size of the step of a difference in an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DifferenceStep {
    /// `h = unit_step max(|x|, length)`: `length` is the size of arguments over which the function changes by its own
    /// size; it matters for arguments near zero.
    Scaled(f64),
    /// A step of this size for all arguments.
    Fixed(f64),
}

impl Default for DifferenceStep {
    /// Scaled, for arguments of order one or larger.
    fn default() -> Self {
        Self::Scaled(1.0)
    }
}

impl DifferenceStep {
    /// The step for an argument of this magnitude.
    ///
    /// # Errors
    /// [`DerivativeError::Step`] if that is not a positive number.
    pub fn size(self, method: Method, magnitude: f64) -> Result<f64, DerivativeError> {
        let step = match self {
            // A NaN must not be lost in the maximum.
            Self::Scaled(length) if magnitude.is_finite() => method.unit_step() * magnitude.abs().max(length),
            Self::Scaled(_) => f64::NAN,
            Self::Fixed(step) => step,
        };
        if step > 0.0 && step.is_finite() { Ok(step) } else { Err(DerivativeError::Step { step }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_follow_the_larger_of_argument_and_length() {
        let h = Method::Central.unit_step();
        assert_eq!(DifferenceStep::default().size(Method::Central, 0.0), Ok(h));
        assert_eq!(DifferenceStep::default().size(Method::Central, -8.0), Ok(8.0 * h));
        assert_eq!(DifferenceStep::Scaled(0.25).size(Method::Central, 0.0), Ok(0.25 * h));
        assert_eq!(DifferenceStep::Fixed(0.5).size(Method::Central, 1e9), Ok(0.5));
        assert!((h.powi(3) / f64::EPSILON - 1.0).abs() < 1e-14);
    }

    #[test]
    fn what_is_no_step_is_refused() {
        for step in [
            DifferenceStep::Fixed(0.0),
            DifferenceStep::Fixed(-1.0),
            DifferenceStep::Fixed(f64::NAN),
            DifferenceStep::Scaled(0.0),
        ] {
            assert!(step.size(Method::Forward, 0.0).is_err(), "{step:?}");
        }
        assert!(DifferenceStep::default().size(Method::Forward, f64::NAN).is_err());
        assert!(DifferenceStep::default().size(Method::Forward, f64::INFINITY).is_err());
    }
}
