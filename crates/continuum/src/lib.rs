//! Strain and stress measures, the trait of a hyperelastic law, the discrete-gradient stress.
//!
//! The trait [`HyperelasticLaw`] lives here, one layer below the catalogue, so that a law of a user's own needs no catalogue.
//! This crate contains no law.

pub mod discrete_gradient;
mod measures;
mod moduli;

pub use discrete_gradient::{energy_momentum_stress, energy_momentum_stress_and_tangent};
pub use measures::{cauchy_stress, green_lagrange, von_mises};
pub use moduli::SmallStrainModuli;
pub use stoss_tensor::{SymmetricTensor2, Tensor2, Tensor4};

/// Why a law has no value at a state.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstitutiveError {
    /// `det C <= 0`.
    #[error("det C = {det_c:e} is not positive")]
    NonPositiveJacobian {
        /// The determinant found.
        det_c: f64,
    },
    /// Energy or stress overflowed or is not a number.
    #[error("the state of strain is out of the law's range (non-finite result)")]
    NonFinite,
}

/// A hyperelastic law `W(C)`, `S = 2 dW/dC`, `CC = 2 dS/dC` (formulation §2).
pub trait HyperelasticLaw: std::fmt::Debug + Send + Sync {
    /// Name for reports.
    fn name(&self) -> &str;
    /// `W(C)`, energy per reference volume.
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError>;
    /// Second Piola-Kirchhoff stress.
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError>;
    /// Energy and stress together; worth its own formula where both share work.
    ///
    /// # Errors
    /// As for the two.
    fn energy_and_stress(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        Ok((self.energy(right_cauchy_green)?, self.stress(right_cauchy_green)?))
    }
    /// Stress and elasticity tensor `2 dS/dC` together.
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError>;
    /// Moduli at `C = 1`.
    fn small_strain_moduli(&self) -> SmallStrainModuli;
    /// True if `W` is at most quadratic in `C` (the quotient of the discrete gradient is then zero and is skipped).
    fn is_quadratic(&self) -> bool {
        false
    }
}
