//! Strain and stress measures, the trait of a hyperelastic law, the discrete-gradient stress, energies of the change of volume.
//!
//! The trait [`HyperelasticLaw`] lives here, one layer below the catalogue, so that a law of a user's own needs no catalogue.
//! This crate contains no law.
//!
//! * [`HyperelasticLaw`]: energy, stress and elasticity tensor as functions of the right Cauchy-Green tensor; [`SmallStrainModuli`];
//! * [`Strains`], [`Wanted`]: what a law is asked for at several strains side by side;
//! * [`VolumetricEnergy`], [`VolumetricSplit`]: a law as the sum of an energy of the change of volume and of the rest;
//! * [`Material`], [`StepLaw`]: a law with a state, and what it is in one step: a hyperelastic law again;
//! * [`energy_momentum_stress`], [`energy_momentum_stress_and_tangent`]: the stress of a step, whose work is the change of the energy;
//! * [`green_lagrange`], [`logarithmic_strain`], [`cauchy_stress`], [`von_mises`], [`principal_values`]: measures.
//!
#![doc = include_str!("../README.md")]

pub mod discrete_gradient;
mod material;
mod measures;
mod moduli;
mod several;
pub mod volume;

pub use discrete_gradient::{
    StepStart, energy_momentum_stress, energy_momentum_stress_and_tangent, energy_momentum_stresses,
};
pub use material::{
    Loss, Material, Mechanisms, PointStep, Response, SMALLEST_STRAIN_INCREMENT_WITH_STATE, StateEntry, StateOutput,
    StepLaw, StepStress, Want,
};
pub use measures::{cauchy_stress, green_lagrange, logarithmic_strain, principal_values, von_mises};
pub use moduli::SmallStrainModuli;
pub use several::{Strains, Wanted};
pub use stoss_tensor::{INDEX_PAIRS, SymmetricTensor2, Tensor2, Tensor4, components, wide};
pub use volume::{VolumetricEnergy, VolumetricSplit};

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

/// A hyperelastic law `W(C)`, `S = 2 dW/dC`, `CC = 2 dS/dC` (theory/kinematics#eq-stress).
///
/// `C = F^T F` is symmetric and positive definite; energy and stress vanish at `C = 1`. Stresses and moduli have one unit, which is that of
/// the parameters; energies are per reference volume, which is the same unit. Evaluation is a pure function of `C`, called
/// from several threads.
///
/// Stress and tangent must be derivatives of the one energy: the energy-momentum scheme conserves that energy. The quotient of
/// [`discrete_gradient`] divides the round-off of the energy by the strain increment, so that near `C = 1` an energy computed from
/// `C - 1` is worth its formula.
///
/// # How to implement
/// Always: [`name`](Self::name), [`energy`](Self::energy), [`stress`](Self::stress),
/// [`stress_and_elasticity`](Self::stress_and_elasticity), [`small_strain_moduli`](Self::small_strain_moduli). If it pays:
/// [`energy_and_stress`](Self::energy_and_stress), [`evaluate`](Self::evaluate). Only if true: [`is_quadratic`](Self::is_quadratic). For nearly incompressible solids:
/// [`volumetric`](Self::volumetric).
///
/// # Errors
/// All evaluations give [`ConstitutiveError::NonPositiveJacobian`] for `det C <= 0` and [`ConstitutiveError::NonFinite`] for a
/// state or a result that is infinite or NaN. An inverted `F` cannot be seen in `C`; elements check `det F`.
pub trait HyperelasticLaw: std::fmt::Debug + Send + Sync {
    /// Name for reports.
    fn name(&self) -> &str;
    /// `W(C)`, energy per reference volume.
    ///
    /// # Errors
    /// Inadmissible states, as for the trait.
    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError>;
    /// Second Piola-Kirchhoff stress `S = 2 dW/dC`.
    ///
    /// # Errors
    /// Inadmissible states, as for the trait.
    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError>;
    /// Energy and stress together; worth its own formula where both share work.
    ///
    /// # Errors
    /// Inadmissible states, as for the trait.
    fn energy_and_stress(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        Ok((self.energy(right_cauchy_green)?, self.stress(right_cauchy_green)?))
    }
    /// Stress and elasticity tensor `CC = 2 dS/dC` (`dS = CC : dE`) together.
    ///
    /// # Errors
    /// Inadmissible states, as for the trait.
    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError>;
    /// All that is wanted at several strains, with the bits of the methods for one: worth formulas of its own that take them side by side ([`wide`]).
    ///
    /// # Errors
    /// The number of the first strain that is inadmissible, and why it is.
    fn evaluate(&self, strains: &Strains<'_>, wanted: Wanted<'_>) -> Result<(), (usize, ConstitutiveError)> {
        strains.one_by_one(self, wanted)
    }
    /// Moduli at `C = 1`.
    fn small_strain_moduli(&self) -> SmallStrainModuli;
    /// True if `W` is at most quadratic in `C` (the quotient of the discrete gradient is then zero and is skipped).
    fn is_quadratic(&self) -> bool {
        false
    }
    /// The law as `W(C) + U(J)` for elements that average the change of volume ([`volume`]), if it has this form. All of a large bulk modulus must be in `U`.
    fn volumetric(&self) -> Option<VolumetricSplit> {
        None
    }
    /// The law with its state, if it has one. The other methods are then those of a virgin point without flow.
    fn history(&self) -> Option<&dyn Material> {
        None
    }
    /// Strain increments up to this have no quotient in the discrete gradient, see [`discrete_gradient::SMALLEST_STRAIN_INCREMENT`].
    fn smallest_strain_increment(&self) -> f64 {
        discrete_gradient::SMALLEST_STRAIN_INCREMENT
    }
}
