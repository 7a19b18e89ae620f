//! Saint Venant-Kirchhoff (theory/kinematics#eq-svk; thesis (3.104)-(3.108)).

use crate::closed_form::{self, ClosedForm, Moduli, evaluations};
use crate::error::{MaterialError, finite, stable, young_poisson};
use crate::state::Strain;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, Strains, SymmetricTensor2, Tensor4, Wanted,
};
use stoss_tensor::{
    components::{double_contraction, trace},
    wide::Number,
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

/// Admissible for `det C > 0` as any other law, though the formula does not need it: an inverted or collapsed state has to be found for this law too.
impl ClosedForm for SaintVenantKirchhoff {
    const ENERGY_OF_LOGARITHM: bool = false;
    const STRESS_OF_LOGARITHM: bool = false;

    #[inline(always)]
    fn stored<T: Number>(&self, strain: &Strain<T>) -> T {
        // E = A/2
        let trace = trace(&strain.a);
        trace * (0.125 * self.lambda) * trace + double_contraction(&strain.a, &strain.a) * (0.25 * self.mu)
    }
    #[inline(always)]
    fn stress_of<T: Number>(&self, strain: &Strain<T>) -> [T; 6] {
        let spherical = trace(&strain.a) * (0.5 * self.lambda);
        let mut stress = strain.a;
        for (v, s) in stress.iter_mut().enumerate() {
            *s = if v < 3 { spherical + *s * self.mu } else { *s * self.mu };
        }
        stress
    }
    #[inline(always)]
    fn moduli_of<T: Number>(&self, strain: &Strain<T>) -> Moduli<T> {
        let nothing = strain.determinant.like(0.0);
        Moduli { inverse_derivative: nothing, inverse_square: nothing, sphere: self.lambda, unit: 2.0 * self.mu }
    }
}

impl HyperelasticLaw for SaintVenantKirchhoff {
    fn name(&self) -> &str {
        NAME
    }
    evaluations!();
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(self.lambda, self.mu)
    }
    fn is_quadratic(&self) -> bool {
        true
    }
}
