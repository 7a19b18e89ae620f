//! Laws of the first isochoric invariant alone: Yeoh, Gent, Arruda-Boyce (theory/kinematics#first-invariant).

use crate::error::{MaterialError, finite, stable};
use crate::state::{Invariants, finite_energy, finite_pair, finite_stress};
use crate::volume::Logarithmic;
use std::sync::Arc;
use stoss_continuum::volume::pressure_stress;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, VolumetricEnergy, VolumetricSplit,
};

/// Coefficients of Arruda and Boyce's series of the inverse Langevin function.
const LANGEVIN: [f64; 5] = [1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];

/// `f(x)` of `x = J^(-2/3) I1 - 3`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve {
    /// `c1 x + c2 x^2 + c3 x^3`.
    Yeoh([f64; 3]),
    /// `-mu/2 limit ln(1 - x/limit)`, for `x < limit`.
    Gent { mu: f64, limit: f64 },
    /// `mu sum_i C_i / lock^(2i-2) ((3 + x)^i - 3^i)`.
    ArrudaBoyce { mu: f64, lock: f64 },
}

impl Curve {
    /// `f`, `f'`, `f''`, each to round-off of itself for small `x`; nothing that is a number where there is none.
    fn at(&self, x: f64) -> [f64; 3] {
        match *self {
            Self::Yeoh([a, b, c]) => {
                [x * (a + x * (b + x * c)), a + x * (2.0 * b + 3.0 * x * c), 2.0 * b + 6.0 * c * x]
            }
            Self::Gent { mu, limit } => {
                let left = 1.0 - x / limit;
                if left <= 0.0 {
                    return [f64::NAN; 3];
                }
                [-0.5 * mu * limit * (-x / limit).ln_1p(), 0.5 * mu / left, 0.5 * mu / (limit * left * left)]
            }
            Self::ArrudaBoyce { mu, lock } => {
                let (y, mut out, mut scale) = (3.0 + x, [0.0; 3], mu);
                for (i, c) in (1_i32..).zip(LANGEVIN) {
                    let n = f64::from(i);
                    // (y^i - 3^i)/(y - 3) = sum_k y^k 3^(i-1-k)
                    let quotient: f64 = (0..i).map(|k| y.powi(k) * 3.0_f64.powi(i - 1 - k)).sum();
                    out[0] += scale * c * x * quotient;
                    out[1] += scale * c * n * y.powi(i - 1);
                    out[2] += if i > 1 { scale * c * n * (n - 1.0) * y.powi(i - 2) } else { 0.0 };
                    scale /= lock * lock;
                }
                out
            }
        }
    }
}

/// `W = f(J^(-2/3) I1 - 3) + kappa/2 (ln J)^2`.
///
/// Admissible for `J > 0`; Gent's law up to its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstInvariant {
    name: &'static str,
    curve: Curve,
    kappa: f64,
}

impl FirstInvariant {
    /// Yeoh's law `c1 x + c2 x^2 + c3 x^3` (stresses), with the bulk modulus `kappa`.
    ///
    /// # Errors
    /// Values that are not finite; `c1` or `kappa` not positive.
    pub fn yeoh(c: [f64; 3], kappa: f64) -> Result<Self, MaterialError> {
        let name = "yeoh";
        finite(name, &[("c1", c[0]), ("c2", c[1]), ("c3", c[2]), ("kappa", kappa)])?;
        Self { name, curve: Curve::Yeoh(c), kappa }.checked("shear = 2 c1, bulk = kappa")
    }

    /// Gent's law `-mu/2 limit ln(1 - x/limit)`.
    ///
    /// # Errors
    /// Values that are not finite; `mu`, `limit` or `kappa` not positive.
    pub fn gent(mu: f64, limit: f64, kappa: f64) -> Result<Self, MaterialError> {
        let name = "gent";
        finite(name, &[("mu", mu), ("limit", limit), ("kappa", kappa)])?;
        if limit <= 0.0 {
            return Err(MaterialError::OutOfRange { law: name, parameter: "limit", value: limit, range: "positive" });
        }
        Self { name, curve: Curve::Gent { mu, limit }, kappa }.checked("shear = mu, bulk = kappa")
    }

    /// Arruda and Boyce's law of eight chains with the locking stretch `lock`, by five terms of its series.
    ///
    /// # Errors
    /// Values that are not finite; `mu` or `kappa` not positive, `lock` not above 1.
    pub fn arruda_boyce(mu: f64, lock: f64, kappa: f64) -> Result<Self, MaterialError> {
        let name = "arruda-boyce";
        finite(name, &[("mu", mu), ("lock", lock), ("kappa", kappa)])?;
        if lock <= 1.0 {
            return Err(MaterialError::OutOfRange { law: name, parameter: "lock", value: lock, range: "above 1" });
        }
        Self { name, curve: Curve::ArrudaBoyce { mu, lock }, kappa }.checked("shear = a multiple of mu, bulk = kappa")
    }

    fn checked(self, remedy: &'static str) -> Result<Self, MaterialError> {
        stable(self.name, self.small_strain_moduli(), remedy)?;
        Ok(self)
    }

    fn volume(&self) -> Logarithmic {
        Logarithmic { lambda: self.kappa }
    }

    /// `J^(-2/3)` and `x`, which is `j (I1 - 3) + 3 (j - 1)`, of the order of `C - 1` in each term.
    fn strain(i: &Invariants) -> (f64, f64) {
        let less = (-2.0 / 3.0 * i.log_j).exp_m1();
        (1.0 + less, (1.0 + less) * i.trace_a + 3.0 * less)
    }

    fn energy_of(&self, x: f64, i: &Invariants) -> Result<f64, ConstitutiveError> {
        finite_energy(self.curve.at(x)[0] + 0.5 * self.kappa * i.log_j * i.log_j)
    }

    /// Stress, `f'`, `f''`, and `s = 2 dx/dC`.
    fn stress_of(
        &self,
        c: &SymmetricTensor2,
        inverse: &SymmetricTensor2,
        i: &Invariants,
    ) -> (SymmetricTensor2, [f64; 2], SymmetricTensor2) {
        let (j, x) = Self::strain(i);
        let [_, first, second] = self.curve.at(x);
        let s = (SymmetricTensor2::IDENTITY - *inverse * (c.trace() / 3.0)) * (2.0 * j);
        (s * first + *inverse * (self.kappa * i.log_j), [first, second], s)
    }
}

impl HyperelasticLaw for FirstInvariant {
    fn name(&self) -> &str {
        self.name
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let i = Invariants::new(c)?;
        self.energy_of(Self::strain(&i).1, &i)
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        let i = Invariants::new(c)?;
        finite_stress(self.stress_of(c, &c.inverse_with_det(i.det_c), &i).0)
    }
    fn energy_and_stress(&self, c: &SymmetricTensor2) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let i = Invariants::new(c)?;
        let stress = self.stress_of(c, &c.inverse_with_det(i.det_c), &i).0;
        Ok((self.energy_of(Self::strain(&i).1, &i)?, finite_stress(stress)?))
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let i = Invariants::new(c)?;
        let inverse = c.inverse_with_det(i.det_c);
        let (stress, [first, second], s) = self.stress_of(c, &inverse, &i);
        let isochoric = Self::strain(&i).0 * c.trace();
        let of_inverse = Tensor4::inverse_derivative(&inverse);
        let mut elasticity = of_inverse * (-4.0 / 3.0 * isochoric * first);
        elasticity.add_dyad(-4.0 / 9.0 * isochoric * first, &inverse, &inverse);
        elasticity.add_dyad(-2.0 / 3.0 * first, &s, &inverse);
        elasticity.add_dyad(-2.0 / 3.0 * first, &inverse, &s);
        elasticity.add_dyad(second, &s, &s);
        // As for any energy of the change of volume.
        let j = i.det_c.sqrt();
        let (p, slope) = self.volume().pressure(j);
        elasticity.add_scaled(1.0, &pressure_stress(p, c, j).1);
        elasticity.add_dyad(slope * i.det_c, &inverse, &inverse);
        finite_pair(stress, elasticity)
    }
    fn volumetric(&self) -> Option<VolumetricSplit> {
        Some(VolumetricSplit { rest: Arc::new(Self { kappa: 0.0, ..*self }), volume: Arc::new(self.volume()) })
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli { shear: 2.0 * self.curve.at(0.0)[1], bulk: self.kappa }
    }
}
