//! The catalogue of hyperelastic laws (formulation §2).
//!
//! Every law gives energy, second Piola-Kirchhoff stress and elasticity tensor in closed form, is isotropic, and has no
//! stress and no energy at `C = 1`. Constructors validate their parameters; the implied small-strain moduli can be asked
//! for. Elements know only the trait [`stoss_continuum::HyperelasticLaw`]: this crate can be left out.
//!
//! # How to add a law
//! One file with a struct, a validating constructor and the trait; one `pub use` here; one line in `tests/battery.rs` with the
//! energy written once more over dual numbers; a variant in the scene and an arm in the facade. A law of your own outside
//! of this workspace needs only the trait.

mod error;
mod mooney_rivlin;
mod neo_hooke;
mod ogden;
mod saint_venant_kirchhoff;
mod state;

pub use error::MaterialError;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hooke::NeoHooke;
pub use ogden::Ogden;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
