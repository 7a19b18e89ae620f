//! Coulomb's law.

use super::check;
use super::law::{FrictionInput, FrictionLaw, FrictionOutput, return_to_bound};
use crate::ContactError;

/// Coulomb's law `|tau| <= mu p` (theory/friction#eq-coulomb).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb {
    mu: f64,
}

impl Coulomb {
    /// With a coefficient `mu >= 0`.
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

    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let slope = if input.pressure > 0.0 { self.mu } else { 0.0 };
        return_to_bound(input.trial, slope * input.pressure, slope, [0.0; 2])
    }
}
