//! Mooney-Rivlin, coupled form (theory/kinematics#eq-mooney-rivlin; thesis (3.119)-(3.129) with corrected signs).

use crate::closed_form::{self, ClosedForm, Moduli, evaluations};
use crate::error::{MaterialError, finite, stable};
use crate::state::Strain;
use crate::volume::Quadratic;
use std::sync::Arc;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, Strains, SymmetricTensor2, Tensor4, VolumetricSplit, Wanted,
};
use stoss_tensor::{
    components::{second, trace},
    wide::Number,
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
    /// The law from its three constants (stresses).
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

    /// The factor `2 c (J^2 - J) - d` of `C^-1`.
    #[inline(always)]
    fn factor<T: Number>(&self, j: T) -> T {
        j * (2.0 * self.c) * (j - j.like(1.0)) - j.like(self.d())
    }
}

impl ClosedForm for MooneyRivlin {
    const ENERGY_OF_LOGARITHM: bool = true;
    const STRESS_OF_LOGARITHM: bool = false;

    /// `d/2 (tr A - 2 ln J) + c2 I2(A) + c (J - 1)^2`, `A = C - 1`: `I2 - 3 = 2 tr A + I2(A)`.
    #[inline(always)]
    fn stored<T: Number>(&self, strain: &Strain<T>) -> T {
        let volume = strain.log_j.each(f64::exp_m1);
        (trace(&strain.a) - strain.log_j * 2.0) * (0.5 * self.d())
            + second(strain.a) * self.c2
            + volume * self.c * volume
    }
    #[inline(always)]
    fn stress_of<T: Number>(&self, strain: &Strain<T>) -> [T; 6] {
        let c = &strain.c;
        let factor = self.factor(strain.determinant.sqrt());
        let spherical = trace(c) * (2.0 * self.c2) + factor.like(2.0 * self.c1);
        let mut stress = strain.inverse;
        for (v, s) in stress.iter_mut().enumerate() {
            let of_strain = c[v] * (2.0 * self.c2);
            *s = if v < 3 { spherical - of_strain + *s * factor } else { *s * factor - of_strain };
        }
        stress
    }
    #[inline(always)]
    fn moduli_of<T: Number>(&self, strain: &Strain<T>) -> Moduli<T> {
        let j = strain.determinant.sqrt();
        Moduli {
            inverse_derivative: self.factor(j) * 2.0,
            inverse_square: (j * 4.0 * j - j * 2.0) * self.c,
            sphere: 4.0 * self.c2,
            unit: -4.0 * self.c2,
        }
    }
}

impl HyperelasticLaw for MooneyRivlin {
    fn name(&self) -> &str {
        NAME
    }
    evaluations!();
    fn volumetric(&self) -> Option<VolumetricSplit> {
        Some(VolumetricSplit { rest: Arc::new(Self { c: 0.0, ..*self }), volume: Arc::new(Quadratic { c: self.c }) })
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(2.0 * self.c + 4.0 * self.c2, 2.0 * (self.c1 + self.c2))
    }
}
