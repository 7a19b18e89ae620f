//! Numbers over which a function is written once for all methods: `f64` and [`Complex64`].
//!
//! Deliberately absent: comparisons, absolute values, conjugates (crate documentation).

use num_complex::Complex64;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real or a complex number with the analytic functions.
///
/// The complex functions keep a tiny imaginary part to full relative accuracy, which is all that the complex step
/// needs. For real arguments outside of the real function's domain (`ln(-1)`) the real one gives NaN, the complex
/// one a value of its principal branch.
pub trait Scalar:
    Copy
    + Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// The real part: for choosing a branch, never for going on with.
    fn real(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Tangent.
    fn tan(self) -> Self;
    /// Inverse tangent.
    fn atan(self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Integer power.
    fn powi(self, exponent: i32) -> Self;
    /// Real power.
    fn powf(self, exponent: f64) -> Self;
}

macro_rules! as_in_std {
    ($($name:ident),*) => {$(
        #[inline]
        fn $name(self) -> f64 {
            self.$name()
        }
    )*};
}

macro_rules! as_in_num_complex {
    ($($name:ident),*) => {$(
        #[inline]
        fn $name(self) -> Self {
            Self::$name(self)
        }
    )*};
}

impl Scalar for f64 {
    as_in_std!(sqrt, exp, ln, sin, cos, tan, atan, sinh, cosh, tanh);

    #[inline]
    fn real(self) -> f64 {
        self
    }
    #[inline]
    fn powi(self, exponent: i32) -> f64 {
        self.powi(exponent)
    }
    #[inline]
    fn powf(self, exponent: f64) -> f64 {
        self.powf(exponent)
    }
}

impl Scalar for Complex64 {
    as_in_num_complex!(sqrt, exp, ln, sin, cos, sinh, cosh);

    #[inline]
    fn real(self) -> f64 {
        self.re
    }

    /// Tangent by the addition theorem: no cancellation near the poles.
    #[inline]
    fn tan(self) -> Self {
        let (t, u) = (self.re.tan(), self.im.tanh());
        let divisor = 1.0 + t * t * u * u;
        Self::new(t / self.im.cosh().powi(2) / divisor, u * (1.0 + t * t) / divisor)
    }

    /// Real and imaginary part one by one: the usual difference of logarithms of `1 +- i z` loses an imaginary part
    /// below 1e-16.
    #[inline]
    fn atan(self) -> Self {
        let Self { re: x, im: y } = self;
        let real = 0.5 * (2.0 * x).atan2(1.0 - x * x - y * y);
        Self::new(real, 0.5 * (2.0 * y / (1.0 + x * x + y * y)).atanh())
    }

    /// Hyperbolic tangent by the formula of the tangent, with `1 - tanh^2 = 1/cosh^2`: no overflow for large arguments.
    #[inline]
    fn tanh(self) -> Self {
        let (t, u) = (self.re.tanh(), self.im.tan());
        let divisor = 1.0 + t * t * u * u;
        Self::new(t * (1.0 + u * u) / divisor, u / self.re.cosh().powi(2) / divisor)
    }

    #[inline]
    fn powi(self, exponent: i32) -> Self {
        Self::powi(&self, exponent)
    }
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        Self::powf(self, exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Name, function, real function, its derivative by hand.
    type Entry = (&'static str, fn(Complex64) -> Complex64, fn(f64) -> f64, fn(f64) -> f64);

    /// Every function of the trait for positive arguments.
    const FUNCTIONS: [Entry; 13] = [
        ("sqrt", Scalar::sqrt, f64::sqrt, |x| 0.5 / x.sqrt()),
        ("exp", Scalar::exp, f64::exp, f64::exp),
        ("ln", Scalar::ln, f64::ln, f64::recip),
        ("sin", Scalar::sin, f64::sin, f64::cos),
        ("cos", Scalar::cos, f64::cos, |x| -x.sin()),
        ("tan", Scalar::tan, f64::tan, |x| x.cos().powi(-2)),
        ("atan", Scalar::atan, f64::atan, |x| 1.0 / (1.0 + x * x)),
        ("sinh", Scalar::sinh, f64::sinh, f64::cosh),
        ("cosh", Scalar::cosh, f64::cosh, f64::sinh),
        ("tanh", Scalar::tanh, f64::tanh, |x| x.cosh().powi(-2)),
        ("powi", |z| Scalar::powi(z, -3), |x| x.powi(-3), |x| -3.0 * x.powi(-4)),
        ("powf", |z| Scalar::powf(z, 1.7), |x| x.powf(1.7), |x| 1.7 * x.powf(0.7)),
        (
            "quotient",
            |z| (z + 2.0) / (z * z - 20.0),
            |x| (x + 2.0) / (x * x - 20.0),
            |x| (x * x - 20.0 - 2.0 * x * (x + 2.0)) / (x * x - 20.0).powi(2),
        ),
    ];

    proptest! {
        #[test]
        fn a_tiny_imaginary_part_carries_the_derivative(x in 0.05..4.0_f64, power in 20..150_i32) {
            let h = 10.0_f64.powi(-power);
            for (name, complex, real, slope) in FUNCTIONS {
                let z = complex(Complex64::new(x, h));
                prop_assert!((z.re - real(x)).abs() <= 2e-15 * (real(x).abs() + slope(x).abs()), "{name} at {x}");
                // Condition of the slope: near its zeros an absolute error of a few ulps of the argument remains.
                let scale = slope(x).abs() * 1.0_f64.max(x) + real(x).abs();
                prop_assert!((z.im / h - slope(x)).abs() <= 1e-14 * scale, "{name} at {x}: {:e}", z.im / h);
            }
        }

        #[test]
        fn inverse_tangent_and_hyperbolic_tangent_far_from_the_real_axis(x in -2.0..2.0_f64, y in -0.7..0.7_f64) {
            // tan(atan z) = z; tanh z = (e^2z - 1)/(e^2z + 1).
            let z = Complex64::new(x, y);
            prop_assert!((Scalar::tan(Scalar::atan(z)) - z).norm() < 1e-13);
            let e = Scalar::exp(z * 2.0);
            prop_assert!((Scalar::tanh(z) - (e - 1.0) / (e + 1.0)).norm() < 1e-14);
        }
    }

    #[test]
    fn negative_and_large_arguments() {
        let at = |x: f64| Complex64::new(x, 1e-100);
        assert_eq!(Scalar::tanh(at(1000.0)), Complex64::new(1.0, 0.0));
        assert_eq!(Scalar::tanh(at(-1000.0)).re, -1.0);
        assert!((Scalar::atan(at(-3.0)).re + 3.0_f64.atan()).abs() < 1e-16);
        assert!((Scalar::powi(at(-2.0), 3).im / 1e-100 - 12.0).abs() < 1e-14);
        assert_eq!(Scalar::powi(at(0.0), 1).im, 1e-100);
    }
}
