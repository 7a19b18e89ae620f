//! Mooney-Rivlin, coupled form (theory/kinematics#eq-mooney-rivlin; thesis (3.119)-(3.129) with corrected signs).

use crate::error::{MaterialError, finite, stable};
use crate::state::{Invariants, finite_energy, finite_pair, finite_stress, positive_det};
use crate::volume::Quadratic;
use std::sync::Arc;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, VolumetricSplit,
};

const NAME: &str = "mooney-rivlin";

/// `W = c1 (I1 - 3) + c2 (I2 - 3) + c (J - 1)^2 - d ln J` with `d = 2 (c1 + 2 c2)`, so that `C = 1` is free of stress.
///
/// Admissible for `J > 0`; the energy tends to infinity for `J -> 0` if `c1 + 2 c2 > 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MooneyRivlin {
    c1: f64,
    c2: f64,
    c: f64,
}

impl MooneyRivlin {
    /// From the three constants (stresses).
    ///
    /// # Errors
    /// Values that are not finite; shear modulus `2 (c1 + c2)` or bulk modulus `2 c + 4 c2 + 4/3 (c1 + c2)` not positive.
    pub fn new(c1: f64, c2: f64, c: f64) -> Result<Self, MaterialError> {
        finite(NAME, &[("c1", c1), ("c2", c2), ("c", c)])?;
        let law = Self { c1, c2, c };
        stable(NAME, law.small_strain_moduli(), "shear = 2 (c1 + c2), bulk = 2 c + 4 c2 + 4/3 (c1 + c2)")?;
        Ok(law)
    }

    fn d(&self) -> f64 {
        2.0 * (self.c1 + 2.0 * self.c2)
    }

    /// `d/2 (tr A - 2 ln J) + c2 I2(A) + c (J - 1)^2`, `A = C - 1`: `I2 - 3 = 2 tr A + I2(A)`.
    #[inline]
    fn energy_with(&self, i: &Invariants) -> f64 {
        let volume = i.log_j.exp_m1();
        0.5 * self.d() * (i.trace_a - 2.0 * i.log_j) + self.c2 * i.second_a + self.c * volume * volume
    }

    /// Stress, and the factor `2 c (J^2 - J) - d` of `C^-1`.
    #[inline]
    fn stress_with(&self, c: &SymmetricTensor2, j: f64, inverse: &SymmetricTensor2) -> (SymmetricTensor2, f64) {
        let factor = 2.0 * self.c * j * (j - 1.0) - self.d();
        let spherical = 2.0 * self.c1 + 2.0 * self.c2 * c.trace();
        (SymmetricTensor2::IDENTITY * spherical - *c * (2.0 * self.c2) + *inverse * factor, factor)
    }
}

impl HyperelasticLaw for MooneyRivlin {
    fn name(&self) -> &str {
        NAME
    }
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        finite_energy(self.energy_with(&Invariants::new(right_cauchy_green)?))
    }
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        let det_c = positive_det(right_cauchy_green)?;
        let inverse = right_cauchy_green.inverse_with_det(det_c);
        finite_stress(self.stress_with(right_cauchy_green, det_c.sqrt(), &inverse).0)
    }
    fn energy_and_stress(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let i = Invariants::new(right_cauchy_green)?;
        let inverse = right_cauchy_green.inverse_with_det(i.det_c);
        let stress = self.stress_with(right_cauchy_green, i.det_c.sqrt(), &inverse).0;
        Ok((finite_energy(self.energy_with(&i))?, finite_stress(stress)?))
    }
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let det_c = positive_det(right_cauchy_green)?;
        let j = det_c.sqrt();
        let inverse = right_cauchy_green.inverse_with_det(det_c);
        let (stress, factor) = self.stress_with(right_cauchy_green, j, &inverse);
        let mut elasticity = Tensor4::inverse_derivative(&inverse) * (2.0 * factor);
        elasticity.add_dyad(self.c * (4.0 * j * j - 2.0 * j), &inverse, &inverse);
        elasticity.add_scaled(4.0 * self.c2, &Tensor4::identity_dyad());
        elasticity.add_scaled(-4.0 * self.c2, &Tensor4::symmetric_identity());
        finite_pair(stress, elasticity)
    }
    fn volumetric(&self) -> Option<VolumetricSplit> {
        Some(VolumetricSplit { rest: Arc::new(Self { c: 0.0, ..*self }), volume: Arc::new(Quadratic { c: self.c }) })
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(2.0 * self.c + 4.0 * self.c2, 2.0 * (self.c1 + self.c2))
    }
}
