//! What the closed-form laws need of a state of strain, to round-off also near `C = 1`, and the checks of admissibility.

use stoss_continuum::{ConstitutiveError, SymmetricTensor2, Tensor4};
use stoss_tensor::{components, wide::Number};

/// Up to this change of volume `|det C - 1|` it is computed from `C - 1`. Any bound between about 0.1 and 1 will do: beyond it `det C`
/// itself has no cancellation.
const MODERATE: f64 = 0.5;

/// Invariants of `C`, and of `A = C - 1`.
///
/// Near the reference state an energy is of second order in `A`. Summing terms of order one (`I1 - 3`, `ln det C`) leaves an
/// error of `1e-16` of the modulus, which the quotient of the energy-momentum stress divides by the strain increment, down to
/// `1e-6`: the stress then carries `1e-10` of the modulus, small vibrations gain energy and Newton's iteration stalls. From the invariants
/// of `A`, which floating-point subtraction gives exactly there, the error is smaller by `|A|`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Invariants {
    /// `det C`, positive and finite.
    pub det_c: f64,
    /// `ln J = ln(det C) / 2`.
    pub log_j: f64,
    /// `tr A = I1 - 3`.
    pub trace_a: f64,
}

impl Invariants {
    /// Invariants of `C`, or why it has none.
    #[inline]
    pub fn new(c: &SymmetricTensor2) -> Result<Self, ConstitutiveError> {
        let det_c = positive_det(c)?;
        let a = *c - SymmetricTensor2::IDENTITY;
        Ok(Self { det_c, log_j: log_j(&a.0, det_c), trace_a: a.trace() })
    }
}

/// What laws in closed form read of `C`, a strain or several side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strain<T> {
    /// `C`.
    pub c: [T; 6],
    /// `A = C - 1`.
    pub a: [T; 6],
    /// `C^-1`.
    pub inverse: [T; 6],
    /// `det C`.
    pub determinant: T,
    /// `ln J`, see [`Invariants::log_j`]; not a number if it is not asked for.
    pub log_j: T,
}

impl<T: Number> Strain<T> {
    /// The strain of any `C`; numbers that are not admissible are the caller's to find.
    #[inline(always)]
    pub fn new(c: [T; 6], with_logarithm: bool) -> Self {
        let determinant = components::determinant(c);
        let inverse = components::inverse(c, determinant);
        let one = determinant.like(1.0);
        let a = [c[0] - one, c[1] - one, c[2] - one, c[3], c[4], c[5]];
        let log_j = if with_logarithm { log_j(&a, determinant) } else { determinant.like(f64::NAN) };
        Self { c, a, inverse, determinant, log_j }
    }
}

impl Strain<f64> {
    /// The strain of an admissible `C`, or why it is not.
    #[inline]
    pub fn admissible(c: &SymmetricTensor2, with_logarithm: bool) -> Result<Self, ConstitutiveError> {
        positive_det(c)?;
        Ok(Self::new(c.0, with_logarithm))
    }
}

/// `ln J` of `A = C - 1` and `det C`.
#[inline(always)]
fn log_j<T: Number>(a: &[T; 6], determinant: T) -> T {
    // det(1 + A) = 1 + I1(A) + I2(A) + I3(A)
    let change = components::trace(a) + components::second(*a) + components::determinant(*a);
    change.each_with(determinant, |change, det_c| {
        0.5 * if change.abs() <= MODERATE { change.ln_1p() } else { det_c.ln() }
    })
}

/// `det C` if positive and finite.
#[inline]
pub(crate) fn positive_det(c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
    let det_c = c.det();
    if det_c > 0.0 && det_c.is_finite() {
        Ok(det_c)
    } else if det_c <= 0.0 {
        Err(ConstitutiveError::NonPositiveJacobian { det_c })
    } else {
        Err(ConstitutiveError::NonFinite)
    }
}

/// The energy, unless it overflowed.
#[inline]
pub(crate) fn finite_energy(energy: f64) -> Result<f64, ConstitutiveError> {
    if energy.is_finite() { Ok(energy) } else { Err(ConstitutiveError::NonFinite) }
}

/// The stress, unless it overflowed.
#[inline]
pub(crate) fn finite_stress(stress: SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
    if stress.is_finite() { Ok(stress) } else { Err(ConstitutiveError::NonFinite) }
}

/// Stress and elasticity tensor, unless one overflowed.
#[inline]
pub(crate) fn finite_pair(
    stress: SymmetricTensor2,
    elasticity: Tensor4,
) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
    if stress.is_finite() && elasticity.is_finite() {
        Ok((stress, elasticity))
    } else {
        Err(ConstitutiveError::NonFinite)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn logarithm_of_a_spherical_state(e in 1e-14..0.5_f64, sign in prop::bool::ANY) {
            // C = (1 + a) 1: ln J = 3/2 ln(1 + a), to round-off of a itself; a is exact because it is read off C.
            let c = SymmetricTensor2::IDENTITY * if sign { 1.0 + e } else { 1.0 - e };
            let a = c.0[0] - 1.0;
            let i = Invariants::new(&c).unwrap();
            let exact = 1.5 * a.ln_1p();
            prop_assert!((i.log_j - exact).abs() <= 1e-14 * exact.abs());
            prop_assert!((i.trace_a - 3.0 * a).abs() <= 1e-15 * a.abs());
        }
    }

    #[test]
    fn both_formulas_of_the_logarithm_agree() {
        for (j_square, volume) in [(1.4999, "below"), (1.5001, "above"), (0.5001, "below"), (0.4999, "above")] {
            let i = Invariants::new(&SymmetricTensor2([j_square, 1.0, 1.0, 0.0, 0.0, 0.0])).unwrap();
            assert!((i.log_j - 0.5 * f64::ln(j_square)).abs() < 1e-15, "{volume} the switch");
        }
    }

    #[test]
    fn inadmissible_states() {
        let error = |c| Invariants::new(&SymmetricTensor2(c)).unwrap_err();
        assert_eq!(error([1.0, 1.0, -2.0, 0.0, 0.0, 0.0]), ConstitutiveError::NonPositiveJacobian { det_c: -2.0 });
        assert_eq!(error([0.0; 6]), ConstitutiveError::NonPositiveJacobian { det_c: 0.0 });
        assert_eq!(error([f64::INFINITY, 1.0, 1.0, 0.0, 0.0, 0.0]), ConstitutiveError::NonFinite);
        assert_eq!(error([1.0, 1.0, 1.0, 0.0, f64::NAN, 0.0]), ConstitutiveError::NonFinite);
    }
}
