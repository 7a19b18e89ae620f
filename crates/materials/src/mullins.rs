//! Softening of filled rubber by the largest energy so far (Mullins; theory/inelastic#softening). A part of [`crate::Inelastic`].

use crate::error::{MaterialError, finite};
use std::f64::consts::PI;

const NAME: &str = "mullins";

/// `eta = 1 - erf((M - W)/(m + beta M))/r` for `W < M`, the largest energy of the rest of a law so far (Ogden and Roxburgh 1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mullins {
    /// Parameter `r`, above 1; the stress goes down to `1 - 1/r` of that of the virgin material at most.
    pub r: f64,
    /// An energy per volume (a stress), positive.
    pub m: f64,
    /// A number, not negative.
    pub beta: f64,
}

/// The error function, by its series with positive terms or its continued fraction: to a few units of round-off.
fn erf(x: f64) -> f64 {
    let (size, sign) = (x.abs(), x.signum());
    if size < 2.5 {
        // 2/sqrt(pi) exp(-x^2) sum_n 2^n x^(2n+1) / (2n+1)!!
        let (mut term, mut sum) = (size, size);
        for n in 1..60 {
            term *= 2.0 * size * size / f64::from(2 * n + 1);
            sum += term;
        }
        return sign * 2.0 / PI.sqrt() * (-size * size).exp() * sum;
    }
    let fraction = (1..80).rev().fold(0.0, |rest, k| 0.5 * f64::from(k) / (size + rest));
    sign * (1.0 - (-size * size).exp() / (PI.sqrt() * (size + fraction)))
}

/// Gauss' rule of six points on (-1, 1), one half.
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_3),
];

/// `int_a^b erf`, to round-off of itself: a difference of primitives would have that of one, which is much for small energies.
fn erf_integral(a: f64, b: f64) -> f64 {
    if b - a > 0.25 {
        let primitive = |x: f64| x * erf(x) + (-x * x).exp() / PI.sqrt();
        return primitive(b) - primitive(a);
    }
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    GAUSS.iter().map(|(x, weight)| weight * half * (erf(middle + half * x) + erf(middle - half * x))).sum()
}

/// `eta`, its slope, and `g`, of an energy `W`.
pub(crate) struct Softened {
    pub factor: f64,
    pub slope: f64,
    pub energy: f64,
}

impl Mullins {
    pub(crate) fn check(&self) -> Result<(), MaterialError> {
        finite(NAME, &[("r", self.r), ("m", self.m), ("beta", self.beta)])?;
        let refuse = |parameter, value, range| Err(MaterialError::OutOfRange { law: NAME, parameter, value, range });
        if self.r <= 1.0 {
            return refuse("r", self.r, "above 1");
        }
        if self.m <= 0.0 {
            return refuse("m", self.m, "positive");
        }
        if self.beta < 0.0 {
            return refuse("beta", self.beta, "zero or positive");
        }
        Ok(())
    }

    /// `g(W) = int_0^W eta`, for the largest energy `most`.
    pub(crate) fn at(&self, w: f64, most: f64) -> Softened {
        let width = self.m + self.beta * most;
        // int_0^w eta, w not above `most`
        let below = |w: f64| w - width / self.r * erf_integral((most - w) / width, most / width);
        if w >= most {
            return Softened { factor: 1.0, slope: 0.0, energy: below(most) + (w - most) };
        }
        let x = (most - w) / width;
        Softened {
            factor: 1.0 - erf(x) / self.r,
            slope: 2.0 / (PI.sqrt() * self.r * width) * (-x * x).exp(),
            energy: below(w),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_function() {
        // Abramowitz and Stegun, table 7.1.
        for (x, value) in
            [(0.0, 0.0), (0.5, 0.520_499_877_8), (1.0, 0.842_700_792_9), (1.5, 0.966_105_146_5), (2.0, 0.995_322_265_0)]
        {
            assert!((erf(x) - value).abs() < 1e-10 && (erf(-x) + value).abs() < 1e-10, "{x}: {}", erf(x));
        }
        // Both formulas where they meet, with the slope between.
        let slope = 2.0 / PI.sqrt() * (-6.25_f64).exp();
        assert!((erf(2.5) - erf(2.5 - 1e-9) - slope * 1e-9).abs() < 1e-15);
    }

    #[test]
    fn integral_of_the_error_function() {
        // By points, and by its primitive.
        for (a, b) in [(0.0, 0.25), (0.3, 0.54), (1.0, 1.2), (2.3, 2.55)] {
            let primitive = |x: f64| x * erf(x) + (-x * x).exp() / PI.sqrt();
            assert!((erf_integral(a, b) - (primitive(b) - primitive(a))).abs() < 2e-15, "{a} {b}");
        }
        // Near zero: b^2 / sqrt(pi).
        assert!((erf_integral(0.0, 1e-9) / (1e-18 / PI.sqrt()) - 1.0).abs() < 1e-14);
    }
}
