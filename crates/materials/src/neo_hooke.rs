//! Neo-Hooke (theory/kinematics#eq-neo-hooke; thesis (3.130)-(3.133)).

use crate::error::{MaterialError, finite, stable, young_poisson};
use crate::state::{Invariants, finite_energy, finite_stress};
use crate::volume::Logarithmic;
use std::sync::Arc;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, VolumetricSplit,
};

const NAME: &str = "neo-hooke";

/// `W = mu/2 (I1 - 3) + lambda/2 (ln J)^2 - mu ln J`, `S = mu (1 - C^-1) + lambda ln J C^-1`.
///
/// Admissible for `J > 0`. The energy tends to infinity for `J -> 0` if `lambda >= 0`; for a negative `lambda` (Poisson's ratio below zero) it
/// tends to minus infinity (theory/kinematics#compression).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHooke {
    lambda: f64,
    mu: f64,
}

impl NeoHooke {
    /// From Lamé's constants (stresses).
    ///
    /// # Errors
    /// Values that are not finite; shear or bulk modulus not positive.
    pub fn new(lambda: f64, mu: f64) -> Result<Self, MaterialError> {
        finite(NAME, &[("lambda", lambda), ("mu", mu)])?;
        stable(NAME, SmallStrainModuli::from_lame(lambda, mu), "shear = mu, bulk = lambda + 2/3 mu")?;
        Ok(Self { lambda, mu })
    }

    /// From Young's modulus (a stress) and Poisson's ratio.
    ///
    /// # Errors
    /// `young <= 0`, or `poisson` not in (-1, 1/2).
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        let moduli = young_poisson(NAME, young, poisson)?;
        Self::new(moduli.lame_lambda(), moduli.shear)
    }

    /// `mu/2 (tr A - 2 ln J) + lambda/2 (ln J)^2`, `A = C - 1`.
    #[inline]
    fn energy_with(&self, i: &Invariants) -> f64 {
        0.5 * self.mu * (i.trace_a - 2.0 * i.log_j) + 0.5 * self.lambda * i.log_j * i.log_j
    }

    #[inline]
    fn stress_with(&self, log_j: f64, inverse: &SymmetricTensor2) -> SymmetricTensor2 {
        SymmetricTensor2::IDENTITY * self.mu + *inverse * (self.lambda * log_j - self.mu)
    }

    /// In its place: moduli are long enough for copies to be seen in the time.
    #[inline]
    fn write_stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
        (stress, elasticity): &mut (SymmetricTensor2, Tensor4),
    ) -> Result<(), ConstitutiveError> {
        let i = Invariants::new(right_cauchy_green)?;
        let inverse = right_cauchy_green.inverse_with_det(i.det_c);
        *stress = self.stress_with(i.log_j, &inverse);
        *elasticity = Tensor4::inverse_derivative(&inverse) * (2.0 * (self.lambda * i.log_j - self.mu));
        elasticity.add_dyad(self.lambda, &inverse, &inverse);
        if stress.is_finite() && elasticity.is_finite() { Ok(()) } else { Err(ConstitutiveError::NonFinite) }
    }
}

impl HyperelasticLaw for NeoHooke {
    fn name(&self) -> &str {
        NAME
    }
    #[inline]
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        finite_energy(self.energy_with(&Invariants::new(right_cauchy_green)?))
    }
    #[inline]
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        let i = Invariants::new(right_cauchy_green)?;
        finite_stress(self.stress_with(i.log_j, &right_cauchy_green.inverse_with_det(i.det_c)))
    }
    #[inline]
    fn energy_and_stress(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let i = Invariants::new(right_cauchy_green)?;
        let stress = self.stress_with(i.log_j, &right_cauchy_green.inverse_with_det(i.det_c));
        Ok((finite_energy(self.energy_with(&i))?, finite_stress(stress)?))
    }
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let mut out = (SymmetricTensor2::ZERO, Tensor4::ZERO);
        self.write_stress_and_elasticity(right_cauchy_green, &mut out)?;
        Ok(out)
    }
    fn stresses_and_elasticities(
        &self,
        right_cauchy_green: &[SymmetricTensor2],
        out: &mut [(SymmetricTensor2, Tensor4)],
    ) -> Result<(), (usize, ConstitutiveError)> {
        let mut all = right_cauchy_green.iter().zip(out).enumerate();
        all.try_for_each(|(k, (c, out))| self.write_stress_and_elasticity(c, out).map_err(|error| (k, error)))
    }
    fn volumetric(&self) -> Option<VolumetricSplit> {
        Some(VolumetricSplit {
            rest: Arc::new(Self { lambda: 0.0, ..*self }),
            volume: Arc::new(Logarithmic { lambda: self.lambda }),
        })
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(self.lambda, self.mu)
    }
}
