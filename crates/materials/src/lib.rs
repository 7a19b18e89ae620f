//! The catalogue of material laws (theory/kinematics#laws, theory/inelastic).
//!
//! Every elastic law gives energy, second Piola-Kirchhoff stress and elasticity tensor in closed form, is isotropic, and has no
//! stress and no energy at `C = 1`. Constructors validate their parameters; the implied small-strain moduli can be asked
//! for. Elements know only the trait [`stoss_continuum::HyperelasticLaw`]: this crate can be left out.
//!
//! * [`SaintVenantKirchhoff`]: linear in the Green-Lagrange strain;
//! * [`NeoHooke`], [`MooneyRivlin`]: coupled forms with the logarithm of the change of volume;
//! * [`Ogden`]: powers of the principal stretches, decoupled, any number of terms;
//! * [`FirstInvariant`]: Yeoh, Gent, Arruda-Boyce, of the first isochoric invariant;
//! * [`Hencky`]: linear in the logarithmic strain, the elastic part of metals;
//! * [`Inelastic`]: a law with [`Plasticity`], Maxwell branches, [`Mullins`] softening or [`Fibres`], which has a state ([`stoss_continuum::Material`]);
//! * [`MaterialError`]: parameters that are refused.
//!
//! Not here: elements, and where states are kept.
//!
//! # How to add a law
//! One file with a struct, a validating constructor and the trait; one `pub use` here; one line in `tests/battery.rs` with the
//! energy written once more over dual numbers; a row of [`LAWS`]. Two habits are worth the
//! trouble:
//! * compute the energy from `C - 1`, not from terms of order one that cancel at `C = 1`: the energy-momentum stress divides
//!   its round-off by the strain increment;
//! * give an error, not infinity or NaN, beyond the range of the formula: the step control answers errors.
//!
//! A law of your own outside of this workspace needs only the trait, and can be put through the same battery:
//!
//! ```
//! use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};
//!
//! /// `W = mu/2 (I1 - 3 - ln det C)`.
//! #[derive(Debug)]
//! struct Foam {
//!     mu: f64,
//! }
//!
//! fn finite<T>(value: T, is_finite: bool) -> Result<T, ConstitutiveError> {
//!     if is_finite { Ok(value) } else { Err(ConstitutiveError::NonFinite) }
//! }
//!
//! impl HyperelasticLaw for Foam {
//!     fn name(&self) -> &str {
//!         "foam"
//!     }
//!     fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
//!         let det_c = c.det();
//!         if det_c <= 0.0 {
//!             return Err(ConstitutiveError::NonPositiveJacobian { det_c });
//!         }
//!         let a = *c - SymmetricTensor2::IDENTITY;
//!         let change = a.trace() + a.i2() + a.det(); // det C - 1
//!         let log = if change.abs() < 0.5 { change.ln_1p() } else { det_c.ln() };
//!         let w = 0.5 * self.mu * (a.trace() - log);
//!         finite(w, w.is_finite())
//!     }
//!     fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
//!         Ok(self.stress_and_elasticity(c)?.0)
//!     }
//!     fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
//!         self.energy(c)?; // refuses what is not admissible
//!         let inverse = c.inverse();
//!         let stress = (SymmetricTensor2::IDENTITY - inverse) * self.mu;
//!         let elasticity = Tensor4::inverse_derivative(&inverse) * (-2.0 * self.mu);
//!         finite((stress, elasticity), stress.is_finite() && elasticity.is_finite())
//!     }
//!     fn small_strain_moduli(&self) -> SmallStrainModuli {
//!         SmallStrainModuli::from_lame(0.0, self.mu)
//!     }
//! }
//!
//! stoss_testkit::laws::battery(&Foam { mu: 80.0 }, 1e-13);
//! ```
//!
#![doc = include_str!("../README.md")]

mod closed_form;
mod error;
mod fibres;
mod first_invariant;
mod hardening;
mod hencky;
mod history;
mod inelastic;
mod logarithmic;
mod maxwell;
mod mooney_rivlin;
mod mullins;
mod neo_hooke;
mod ogden;
mod plasticity;
mod registry;
mod saint_venant_kirchhoff;
mod state;
mod volume;

pub use error::MaterialError;
pub use fibres::Fibres;
pub use first_invariant::FirstInvariant;
pub use hardening::Hardening;
pub use hencky::Hencky;
pub use history::{FibreFamilies, History};
pub use inelastic::{Inelastic, Moduli};
pub use mooney_rivlin::MooneyRivlin;
pub use mullins::Mullins;
pub use neo_hooke::NeoHooke;
pub use ogden::Ogden;
pub use plasticity::{Overstress, Plasticity};
pub use registry::{LAWS, LawEntry, entry};
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use stoss_registry::{Given, Parameter, Refusal, Unit, Values};
