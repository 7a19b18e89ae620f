//! Neo-Hooke (formulation §2.2, thesis (3.130)-(3.133)).

use crate::error::{MaterialError, finite, stable, young_poisson};
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};

const NAME: &str = "neo-hooke";

/// `W = mu/2 (I1 - 3) + lambda/2 (ln J)^2 - mu ln J`, `S = mu (1 - C^-1) + lambda ln J C^-1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHooke {
    lambda: f64,
    mu: f64,
}

/// `(det C, ln J)`, or why there is none.
#[inline]
pub(crate) fn log_jacobian(c: &SymmetricTensor2) -> Result<(f64, f64), ConstitutiveError> {
    let det_c = c.det();
    if det_c > 0.0 && det_c.is_finite() {
        Ok((det_c, 0.5 * det_c.ln()))
    } else if det_c <= 0.0 {
        Err(ConstitutiveError::NonPositiveJacobian { det_c })
    } else {
        Err(ConstitutiveError::NonFinite)
    }
}

impl NeoHooke {
    /// From Lamé's constants [stress].
    ///
    /// # Errors
    /// Values that are not finite; shear or bulk modulus not positive.
    pub fn new(lambda: f64, mu: f64) -> Result<Self, MaterialError> {
        finite(NAME, &[("lambda", lambda), ("mu", mu)])?;
        stable(NAME, SmallStrainModuli::from_lame(lambda, mu), "shear = mu, bulk = lambda + 2/3 mu")?;
        Ok(Self { lambda, mu })
    }

    /// From Young's modulus [stress] and Poisson's ratio.
    ///
    /// # Errors
    /// `young <= 0`, or `poisson` not in (-1, 1/2).
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        let moduli = young_poisson(NAME, young, poisson)?;
        Self::new(moduli.lame_lambda(), moduli.shear)
    }

    #[inline]
    fn energy_with(&self, c: &SymmetricTensor2, log_j: f64) -> f64 {
        0.5 * self.mu * (c.trace() - 3.0) + (0.5 * self.lambda * log_j - self.mu) * log_j
    }

    #[inline]
    fn stress_with(&self, log_j: f64, inverse: &SymmetricTensor2) -> SymmetricTensor2 {
        SymmetricTensor2::IDENTITY * self.mu + *inverse * (self.lambda * log_j - self.mu)
    }
}

impl HyperelasticLaw for NeoHooke {
    fn name(&self) -> &str {
        NAME
    }
    #[inline]
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        Ok(self.energy_with(right_cauchy_green, log_jacobian(right_cauchy_green)?.1))
    }
    #[inline]
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        let (det_c, log_j) = log_jacobian(right_cauchy_green)?;
        Ok(self.stress_with(log_j, &right_cauchy_green.inverse_with_det(det_c)))
    }
    #[inline]
    fn energy_and_stress(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let (det_c, log_j) = log_jacobian(right_cauchy_green)?;
        Ok((
            self.energy_with(right_cauchy_green, log_j),
            self.stress_with(log_j, &right_cauchy_green.inverse_with_det(det_c)),
        ))
    }
    #[inline]
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let (det_c, log_j) = log_jacobian(right_cauchy_green)?;
        let inverse = right_cauchy_green.inverse_with_det(det_c);
        let mut elasticity = Tensor4::inverse_derivative(&inverse) * (2.0 * (self.lambda * log_j - self.mu));
        elasticity.add_dyad(self.lambda, &inverse, &inverse);
        Ok((self.stress_with(log_j, &inverse), elasticity))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(self.lambda, self.mu)
    }
}
