//! A Maxwell branch: an isochoric spring of logarithmic strain behind a dashpot (theory/inelastic#viscoelasticity). A branch of [`crate::Inelastic`].

use crate::error::{MaterialError, finite};
use crate::logarithmic::LogModuli;
use crate::plasticity::LogResponse;
use stoss_continuum::{StepStress, SymmetricTensor2};

/// A spring and a dashpot one behind the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Maxwell {
    /// Shear modulus of the spring (stress).
    pub shear: f64,
    /// Relaxation time.
    pub time: f64,
}

/// `c0 = (1 - e^-y)/y`, `c1 = (1 - c0)/y`, `e^-y` and `c1 - c0^2/2`, each to round-off for every `y >= 0`.
#[derive(Clone, Copy)]
struct Exponentials {
    c0: f64,
    c1: f64,
    decay: f64,
    square: f64,
}

impl Exponentials {
    fn new(y: f64) -> Self {
        let decay = (-y).exp();
        if y < 0.05 {
            let series = |from: f64| {
                // 1 - y/from (1 - y/(from + 1) (...)), seven factors
                (0..7).rev().fold(1.0, |rest, k| 1.0 - y / (from + f64::from(k)) * rest)
            };
            // sum_k (2 - 2^(k+1)) (-y)^k / (k + 2)!, from k = 1
            let (mut power, mut square) = (0.5, 0.0);
            for k in 1..10_i32 {
                power *= -y / f64::from(k + 2);
                square += (2.0 - f64::from(1 << (k + 1))) * power;
            }
            return Self { c0: series(2.0), c1: 0.5 * series(3.0), decay, square };
        }
        let c0 = -(-y).exp_m1() / y;
        let c1 = (1.0 - c0) / y;
        Self { c0, c1, decay, square: c1 - 0.5 * c0 * c0 }
    }
}

impl Maxwell {
    pub(crate) fn check(&self) -> Result<(), MaterialError> {
        for (parameter, value) in [("prony", self.shear), ("prony", self.time)] {
            finite("prony", &[(parameter, value)])?;
            if value <= 0.0 {
                let range = "pairs [g, tau] of a positive share and a positive relaxation time";
                return Err(MaterialError::OutOfRange { law: "prony", parameter, value, range });
            }
        }
        Ok(())
    }

    /// The law of a step at the strain `e` for the elastic strain `start` at its begin (deviators in one frame).
    pub(crate) fn respond(
        &self,
        e: &SymmetricTensor2,
        start: &SymmetricTensor2,
        stress: StepStress,
        dt: f64,
    ) -> LogResponse {
        let mu = self.shear;
        if stress == StepStress::Frozen {
            return LogResponse {
                energy: mu * e.double_contract(e),
                stress: *e * (2.0 * mu),
                moduli: LogModuli::shear(2.0 * mu),
            };
        }
        let Exponentials { c0, c1, decay, .. } = Exponentials::new(dt / self.time);
        let [k0, k1] = if stress == StepStress::End { [decay, c0] } else { [c0, 2.0 * c1] };
        let d = *e - *start;
        LogResponse {
            energy: 2.0 * mu * (k0 * start.double_contract(&d) + 0.5 * k1 * d.double_contract(&d)),
            stress: *start * (2.0 * mu * k0) + d * (2.0 * mu * k1),
            moduli: LogModuli::shear(2.0 * mu * k1),
        }
    }

    /// The elastic strain at the end of a step, and what was lost along the straight path.
    pub(crate) fn end(&self, e: &SymmetricTensor2, start: &SymmetricTensor2, dt: f64) -> (SymmetricTensor2, f64) {
        let Exponentials { c0, decay, square, .. } = Exponentials::new(dt / self.time);
        // 1 - e^-y, without a difference for small y
        let gone = -(-dt / self.time).exp_m1();
        let d = *e - *start;
        let lost = 0.5 * gone * (1.0 + decay) * start.double_contract(start)
            + c0 * gone * start.double_contract(&d)
            + square * d.double_contract(&d);
        (*start * decay + d * c0, 2.0 * self.shear * lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_formulas_of_the_exponentials_agree() {
        // Where they meet, and against the series with many terms.
        for y in [1e-12, 1e-6, 1e-3, 0.01, 0.049_999, 0.050_001, 0.3] {
            let found = Exponentials::new(y);
            let series = |first: u32| {
                // sum_k (-y)^k first! / (k + first)!
                let (mut term, mut sum) = (1.0, 1.0);
                for k in 1..40 {
                    term *= -y / f64::from(k + first);
                    sum += term;
                }
                sum
            };
            let (c0, c1) = (series(1), 0.5 * series(2));
            assert!((found.c0 - c0).abs() < 1e-15 && (found.c1 - c1).abs() < 2e-15 / y.clamp(0.05, 1.0), "{y}");
            // c1 - c0^2/2 = y/3 - y^2/4 + ...
            let direct = c1 - 0.5 * c0 * c0;
            assert!((found.square - direct).abs() < 4e-15, "{y}: {} {direct}", found.square);
        }
    }
}
