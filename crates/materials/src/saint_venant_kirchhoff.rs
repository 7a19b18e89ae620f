//! Saint Venant-Kirchhoff (theory/kinematics#eq-svk; thesis (3.104)-(3.108)).

use crate::error::{MaterialError, finite, stable, young_poisson};
use crate::state::{finite_energy, finite_stress, positive_det};
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, green_lagrange,
};

const NAME: &str = "saint-venant-kirchhoff";

/// `W = lambda/2 (tr E)^2 + mu E:E`, `S = lambda (tr E) 1 + 2 mu E`.
///
/// Quadratic in `C`, so that the discrete gradient is the stress at the mean strain. The energy stays finite
/// (`9/8 lambda + 3/4 mu`) when the body is crushed to nothing: not for strong compression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaintVenantKirchhoff {
    lambda: f64,
    mu: f64,
}

impl SaintVenantKirchhoff {
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
}

impl HyperelasticLaw for SaintVenantKirchhoff {
    fn name(&self) -> &str {
        NAME
    }
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        // Not needed by the formula: an inverted or collapsed state has to be found for this law too.
        positive_det(right_cauchy_green)?;
        let e = green_lagrange(right_cauchy_green);
        finite_energy(0.5 * self.lambda * e.trace().powi(2) + self.mu * e.double_contract(&e))
    }
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        positive_det(right_cauchy_green)?;
        let e = green_lagrange(right_cauchy_green);
        finite_stress(SymmetricTensor2::IDENTITY * (self.lambda * e.trace()) + e * (2.0 * self.mu))
    }
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let mut elasticity = Tensor4::identity_dyad() * self.lambda;
        elasticity.add_scaled(2.0 * self.mu, &Tensor4::symmetric_identity());
        Ok((self.stress(right_cauchy_green)?, elasticity))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(self.lambda, self.mu)
    }
    fn is_quadratic(&self) -> bool {
        true
    }
}
