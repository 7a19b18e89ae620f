//! What materials of bodies have beside an elastic law: plasticity, Maxwell branches, softening (theory/inelastic).

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stoss_materials::{Hardening as Curve, Moduli as Given, Mullins as Softening, Overstress, Plasticity as Yielding};

named! {
    /// What the moduli of a law with `prony` are.
    Moduli {
        /// Those of fast strains: the branches take their shares out of them.
        Instantaneous = "instantaneous",
        /// Those that are left when all branches have relaxed.
        LongTerm = "long-term",
    }
}

impl From<Moduli> for Given {
    fn from(moduli: Moduli) -> Self {
        match moduli {
            Moduli::Instantaneous => Self::Instantaneous,
            Moduli::LongTerm => Self::LongTerm,
        }
    }
}

/// Von Mises plasticity. The yield stress is that of the Kirchhoff stress, plastic strains are logarithmic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Plasticity {
    /// Yield stress of the virgin material, positive (stress). Not together with `hardening`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub yield_stress: Option<f64>,
    /// Isotropic hardening as a table of points `[plastic strain, yield stress]`, from the strain 0 on; linear between the points, constant behind the last one. In place of `yield_stress`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = [Dimension::Number, Dimension::Stress])))]
    pub hardening: Vec<[f64; 2]>,
    /// Slope of linear isotropic hardening (stress); 0 if left out.
    #[serde(default, skip_serializing_if = "crate::body::is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub hardening_modulus: f64,
    /// Yield stress that exponential hardening tends to (Voce), positive (stress); together with `saturation_rate`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub saturation_stress: Option<f64>,
    /// How fast it does: `1 - exp(-saturation_rate a)` of the way at the plastic strain `a`; positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub saturation_rate: Option<f64>,
    /// Slope of linear kinematic hardening in uniaxial stress, not negative (stress); 0 if left out.
    #[serde(default, skip_serializing_if = "crate::body::is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub kinematic_modulus: f64,
    /// Overstress that grows with the rate; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
}

/// Overstress `stress (a' / rate)^exponent` above the yield stress, of the rate `a'` of the equivalent plastic strain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// Overstress at the rate `rate`, positive (stress).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub stress: f64,
    /// Rate of the equivalent plastic strain, positive (1/time).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Rate)))]
    pub rate: f64,
    /// Exponent, positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub exponent: f64,
}

/// Softening of filled rubber below the largest energy so far (Ogden and Roxburgh).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Mullins {
    /// Above 1: the stress goes down to `1 - 1/r` of that of the virgin material.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub r: f64,
    /// Energy per volume over which it does, positive (stress).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub m: f64,
    /// Part of the largest energy that is added to `m`, not negative; 0 if left out.
    #[serde(default, skip_serializing_if = "crate::body::is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub beta: f64,
}

impl Plasticity {
    /// The key that does not fit the others, what is wrong with it, and what to do.
    pub(crate) fn misfit(&self) -> Option<[&'static str; 3]> {
        let voce = [self.saturation_stress, self.saturation_rate];
        let table = !self.hardening.is_empty();
        if table && (self.yield_stress.is_some() || voce.iter().any(Option::is_some) || self.hardening_modulus != 0.0) {
            let remedy = "remove the table, or yield_stress, hardening_modulus, saturation_stress and saturation_rate";
            return Some(["hardening", "has all of isotropic hardening, and other keys say it too", remedy]);
        }
        if !table && self.yield_stress.is_none() {
            return Some(["yield_stress", "is missing", "add it, for instance `yield_stress = 400.0`"]);
        }
        match voce {
            [Some(_), None] => Some(["saturation_rate", "is missing", "add it, for instance `saturation_rate = 17.0`"]),
            [None, Some(_)] => {
                Some(["saturation_stress", "is missing", "add it, for instance `saturation_stress = 700.0`"])
            }
            _ => None,
        }
    }

    /// As the catalogue of laws has it.
    pub(crate) fn yielding(&self) -> Yielding {
        let hardening = if self.hardening.is_empty() {
            let s0 = self.yield_stress.unwrap_or(f64::NAN);
            Curve::Voce {
                s0,
                h: self.hardening_modulus,
                saturation: self.saturation_stress.unwrap_or(s0),
                rate: self.saturation_rate.unwrap_or(1.0),
            }
        } else {
            Curve::Table(self.hardening.iter().map(|&[a, stress]| (a, stress)).collect())
        };
        let overstress = self.rate.map(|Rate { stress, rate, exponent }| Overstress { stress, rate, exponent });
        Yielding { hardening, kinematic: self.kinematic_modulus, overstress }
    }
}

impl From<Mullins> for Softening {
    fn from(Mullins { r, m, beta }: Mullins) -> Self {
        Self { r, m, beta }
    }
}
