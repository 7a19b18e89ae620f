//! Coulomb's law.

use super::check;
use super::law::{Coefficient, FrictionLaw, Sliding};
use crate::ContactError;

/// Coulomb's law `|tau| <= mu p` (theory/friction#eq-coulomb).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb {
    mu: f64,
}

impl Coulomb {
    /// The law with a coefficient `mu >= 0`.
    ///
    /// # Errors
    /// [`ContactError::Friction`] if it is negative or not finite.
    pub fn new(mu: f64) -> Result<Self, ContactError> {
        Ok(Self { mu: check("mu", mu, mu >= 0.0, "not negative")? })
    }
}

impl FrictionLaw for Coulomb {
    fn name(&self) -> &str {
        "coulomb"
    }

    fn coefficient(&self, _at: &Sliding) -> Coefficient {
        Coefficient { value: self.mu, ..Coefficient::default() }
    }
}
