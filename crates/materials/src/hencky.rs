//! Hencky's law: linear in the logarithmic strain (theory/inelastic#eq-hencky). The elastic part of metals.

use crate::error::{MaterialError, finite, stable, young_poisson};
use crate::logarithmic::{LogModuli, LogStrain};
use crate::state::{finite_energy, finite_pair, finite_stress};
use crate::volume::Logarithmic;
use std::sync::Arc;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, VolumetricSplit,
};

const NAME: &str = "hencky";

/// `W = mu dev E : dev E + K/2 (ln J)^2` with `E = 1/2 ln C`.
///
/// Admissible for `J > 0`. For moderate elastic strains: stress falls in tension beyond a stretch of `e`, and it is elliptic up to stretches of about 1.4 only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hencky {
    bulk: f64,
    mu: f64,
}

impl Hencky {
    /// The law from Lamé's constants (stresses).
    ///
    /// # Errors
    /// Values that are not finite; shear or bulk modulus not positive.
    pub fn new(lambda: f64, mu: f64) -> Result<Self, MaterialError> {
        finite(NAME, &[("lambda", lambda), ("mu", mu)])?;
        let moduli = SmallStrainModuli::from_lame(lambda, mu);
        stable(NAME, moduli, "shear = mu, bulk = lambda + 2/3 mu")?;
        Ok(Self { bulk: moduli.bulk, mu })
    }

    /// The law from Young's modulus (a stress) and Poisson's ratio.
    ///
    /// # Errors
    /// `young <= 0`, or `poisson` not in (-1, 1/2).
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        let moduli = young_poisson(NAME, young, poisson)?;
        Ok(Self { bulk: moduli.bulk, mu: moduli.shear })
    }

    /// Shear modulus.
    pub(crate) fn shear(&self) -> f64 {
        self.mu
    }

    /// `W` and, in the frame of the strain, `dW/dE`.
    fn principal(&self, strain: &LogStrain) -> (f64, SymmetricTensor2) {
        let (e, trace) = (strain.deviator(), strain.trace());
        let energy = self.mu * e.double_contract(&e) + 0.5 * self.bulk * trace * trace;
        (energy, e * (2.0 * self.mu) + SymmetricTensor2::IDENTITY * (self.bulk * trace))
    }
}

impl HyperelasticLaw for Hencky {
    fn name(&self) -> &str {
        NAME
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        finite_energy(self.principal(&LogStrain::new(None, c)?).0)
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        Ok(self.energy_and_stress(c)?.1)
    }
    fn energy_and_stress(&self, c: &SymmetricTensor2) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let strain = LogStrain::new(None, c)?;
        let (energy, t) = self.principal(&strain);
        let mut stress = SymmetricTensor2::ZERO;
        strain.add_stress(&t, &mut stress);
        Ok((finite_energy(energy)?, finite_stress(stress)?))
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let strain = LogStrain::new(None, c)?;
        let (_, t) = self.principal(&strain);
        let mut moduli = LogModuli::shear(2.0 * self.mu);
        moduli.sphere += self.bulk;
        let (mut stress, mut elasticity) = (SymmetricTensor2::ZERO, Tensor4::ZERO);
        strain.add_moduli(&t, &moduli, &mut stress, &mut elasticity);
        finite_pair(stress, elasticity)
    }
    fn volumetric(&self) -> Option<VolumetricSplit> {
        Some(VolumetricSplit {
            rest: Arc::new(Self { bulk: 0.0, ..*self }),
            volume: Arc::new(Logarithmic { lambda: self.bulk }),
        })
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli { shear: self.mu, bulk: self.bulk }
    }
}
