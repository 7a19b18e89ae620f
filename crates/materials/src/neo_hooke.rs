//! Neo-Hooke (theory/kinematics#eq-neo-hooke; thesis (3.130)-(3.133)).

use crate::closed_form::{self, ClosedForm, Moduli, evaluations};
use crate::error::{MaterialError, finite, stable, young_poisson};
use crate::state::Strain;
use crate::volume::Logarithmic;
use std::sync::Arc;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, Strains, SymmetricTensor2, Tensor4, VolumetricSplit, Wanted,
};
use stoss_tensor::{components::trace, wide::Number};

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
    /// The law from Lamé's constants (stresses).
    ///
    /// # Errors
    /// Values that are not finite; shear or bulk modulus not positive.
    pub fn new(lambda: f64, mu: f64) -> Result<Self, MaterialError> {
        finite(NAME, &[("lambda", lambda), ("mu", mu)])?;
        stable(NAME, SmallStrainModuli::from_lame(lambda, mu), "shear = mu, bulk = lambda + 2/3 mu")?;
        Ok(Self { lambda, mu })
    }

    /// The law from Young's modulus (a stress) and Poisson's ratio.
    ///
    /// # Errors
    /// `young <= 0`, or `poisson` not in (-1, 1/2).
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        let moduli = young_poisson(NAME, young, poisson)?;
        Self::new(moduli.lame_lambda(), moduli.shear)
    }
}

impl ClosedForm for NeoHooke {
    const ENERGY_OF_LOGARITHM: bool = true;
    const STRESS_OF_LOGARITHM: bool = true;

    /// `mu/2 (tr A - 2 ln J) + lambda/2 (ln J)^2`, `A = C - 1`.
    #[inline(always)]
    fn stored<T: Number>(&self, strain: &Strain<T>) -> T {
        let log_j = strain.log_j;
        (trace(&strain.a) - log_j * 2.0) * (0.5 * self.mu) + log_j * (0.5 * self.lambda) * log_j
    }
    #[inline(always)]
    fn stress_of<T: Number>(&self, strain: &Strain<T>) -> [T; 6] {
        let mut stress = strain.inverse;
        let (mu, factor) = (strain.log_j.like(self.mu), strain.log_j * self.lambda - strain.log_j.like(self.mu));
        for (v, s) in stress.iter_mut().enumerate() {
            *s = if v < 3 { mu + *s * factor } else { *s * factor };
        }
        stress
    }
    #[inline(always)]
    fn moduli_of<T: Number>(&self, strain: &Strain<T>) -> Moduli<T> {
        let log_j = strain.log_j;
        Moduli {
            inverse_derivative: (log_j * self.lambda - log_j.like(self.mu)) * 2.0,
            inverse_square: log_j.like(self.lambda),
            sphere: 0.0,
            unit: 0.0,
        }
    }
}

impl HyperelasticLaw for NeoHooke {
    fn name(&self) -> &str {
        NAME
    }
    evaluations!();
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
