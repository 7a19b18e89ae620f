//! Parameters that are no material.

use stoss_continuum::SmallStrainModuli;

/// Why parameters are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A parameter is NaN or infinite.
    #[error("{law}: {parameter} = {value} is not a finite number")]
    NotFinite {
        /// The law.
        law: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// A parameter is outside of its range.
    #[error("{law}: {parameter} = {value} is out of range; it must be {range}")]
    OutOfRange {
        /// The law.
        law: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Value of the parameter.
        value: f64,
        /// The range.
        range: &'static str,
    },
    /// Lists of different lengths, or empty.
    #[error("{law}: mu has {mu} and alpha has {alpha} entries; both need the same number, at least one")]
    Lengths {
        /// The law.
        law: &'static str,
        /// Entries of `mu`.
        mu: usize,
        /// Entries of `alpha`.
        alpha: usize,
    },
    /// A part with a history on a law that has no energy of the change of volume of its own, or that cannot take it.
    #[error("{law} cannot have {part}: it is not the sum of an energy of the change of volume and a rest")]
    NoSplit {
        /// The law.
        law: &'static str,
        /// Name of what was to be added.
        part: &'static str,
    },
    /// The body would not be stable at the reference state.
    #[error(
        "{law}: the parameters imply the shear modulus {shear} and the bulk modulus {bulk} at small strains; both must be positive ({remedy})"
    )]
    UnstableModuli {
        /// The law.
        law: &'static str,
        /// Implied shear modulus.
        shear: f64,
        /// Implied bulk modulus.
        bulk: f64,
        /// Which combination of parameters each modulus is.
        remedy: &'static str,
    },
}

/// Refuses NaN and infinity.
pub(crate) fn finite(law: &'static str, parameters: &[(&'static str, f64)]) -> Result<(), MaterialError> {
    match parameters.iter().find(|(_, value)| !value.is_finite()) {
        Some(&(parameter, value)) => Err(MaterialError::NotFinite { law, parameter, value }),
        None => Ok(()),
    }
}

/// Refuses moduli that are not positive.
pub(crate) fn stable(law: &'static str, moduli: SmallStrainModuli, remedy: &'static str) -> Result<(), MaterialError> {
    let SmallStrainModuli { shear, bulk } = moduli;
    if shear > 0.0 && bulk > 0.0 && shear.is_finite() && bulk.is_finite() {
        Ok(())
    } else {
        Err(MaterialError::UnstableModuli { law, shear, bulk, remedy })
    }
}

/// Refuses Young's modulus and Poisson's ratio outside of `E > 0`, `-1 < nu < 1/2`.
pub(crate) fn young_poisson(law: &'static str, young: f64, poisson: f64) -> Result<SmallStrainModuli, MaterialError> {
    finite(law, &[("young", young), ("poisson", poisson)])?;
    if young <= 0.0 {
        return Err(MaterialError::OutOfRange { law, parameter: "young", value: young, range: "positive" });
    }
    if !(poisson > -1.0 && poisson < 0.5) {
        return Err(MaterialError::OutOfRange {
            law,
            parameter: "poisson",
            value: poisson,
            range: "above -1 and below 0.5",
        });
    }
    Ok(SmallStrainModuli::from_young_poisson(young, poisson))
}
