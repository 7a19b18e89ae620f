//! Mooney-Rivlin, coupled form (formulation (2.1), thesis (3.119)-(3.129) with corrected signs).

use crate::error::{MaterialError, finite, stable};
use crate::neo_hooke::log_jacobian;
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};

const NAME: &str = "mooney-rivlin";

/// `W = c1 (I1 - 3) + c2 (I2 - 3) + c (J - 1)^2 - d ln J` with `d = 2 (c1 + 2 c2)`, so that `C = 1` is free of stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MooneyRivlin {
    c1: f64,
    c2: f64,
    c: f64,
}

impl MooneyRivlin {
    /// From the three constants [stress].
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

    /// Stress, and the factor `2 c (J^2 - J) - d` of `C^-1`.
    fn stress_with(&self, c: &SymmetricTensor2, j: f64, inverse: &SymmetricTensor2) -> (SymmetricTensor2, f64) {
        let factor = 2.0 * self.c * (j * j - j) - self.d();
        let spherical = 2.0 * self.c1 + 2.0 * self.c2 * c.trace();
        (SymmetricTensor2::IDENTITY * spherical - *c * (2.0 * self.c2) + *inverse * factor, factor)
    }
}

impl HyperelasticLaw for MooneyRivlin {
    fn name(&self) -> &str {
        NAME
    }
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let (det_c, log_j) = log_jacobian(right_cauchy_green)?;
        let c = right_cauchy_green;
        Ok(self.c1 * (c.i1() - 3.0) + self.c2 * (c.i2() - 3.0) + self.c * (det_c.sqrt() - 1.0).powi(2)
            - self.d() * log_j)
    }
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        let (det_c, _) = log_jacobian(right_cauchy_green)?;
        Ok(self.stress_with(right_cauchy_green, det_c.sqrt(), &right_cauchy_green.inverse_with_det(det_c)).0)
    }
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let (det_c, _) = log_jacobian(right_cauchy_green)?;
        let j = det_c.sqrt();
        let inverse = right_cauchy_green.inverse_with_det(det_c);
        let (stress, factor) = self.stress_with(right_cauchy_green, j, &inverse);
        let mut elasticity = Tensor4::inverse_derivative(&inverse) * (2.0 * factor);
        elasticity.add_dyad(self.c * (4.0 * j * j - 2.0 * j), &inverse, &inverse);
        elasticity.add_scaled(4.0 * self.c2, &Tensor4::identity_dyad());
        elasticity.add_scaled(-4.0 * self.c2, &Tensor4::symmetric_identity());
        Ok((stress, elasticity))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(2.0 * self.c + 4.0 * self.c2, 2.0 * (self.c1 + self.c2))
    }
}
