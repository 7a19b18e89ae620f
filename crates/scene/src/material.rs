//! Hyperelastic laws and their parameters (theory/kinematics#laws).

#[cfg(feature = "schema")]
use crate::Dimension;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Hyperelastic law with its parameters. The shear and bulk moduli at small strains that follow from them must be positive.
///
/// # How to add one
/// A variant with a struct of parameters here, its reading in `read/material.rs`, its arm in the facade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Material {
    /// Saint Venant-Kirchhoff law: `W = lambda/2 (tr E)^2 + mu E:E`. For small strains with large rotations; it softens in compression.
    SaintVenantKirchhoff(ElasticModuli),
    /// Compressible neo-Hooke law: `W = mu/2 (I1 - 3) + lambda/2 (ln J)^2 - mu ln J`.
    NeoHooke(ElasticModuli),
    /// Compressible Mooney-Rivlin law: `W = c1 (I1 - 3) + c2 (I2 - 3) + c (J - 1)^2 - 2 (c1 + 2 c2) ln J`.
    MooneyRivlin(MooneyRivlin),
    /// Ogden law with isochoric terms and a volumetric part; see its parameters.
    Ogden(Ogden),
    /// A user's own law, registered by the program; see [`crate::parse_with`]. Not in the schema, which has the catalogue only.
    #[serde(untagged)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    Own(OwnMaterial),
}

impl Material {
    /// Names of the laws of the catalogue.
    pub const NAMES: &'static [&'static str] = &["saint-venant-kirchhoff", "neo-hooke", "mooney-rivlin", "ogden"];

    /// Name of the law in a scene.
    pub fn law(&self) -> &str {
        match self {
            Self::Own(own) => &own.law,
            Self::SaintVenantKirchhoff(_) => "saint-venant-kirchhoff",
            Self::NeoHooke(_) => "neo-hooke",
            Self::MooneyRivlin(_) => "mooney-rivlin",
            Self::Ogden(_) => "ogden",
        }
    }
}

/// Two elastic moduli: `young` and `poisson`, or `lambda` and `mu`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ElasticModuli {
    /// Young's modulus `E` (stress), positive; together with `poisson`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub young: Option<f64>,
    /// Poisson's ratio, in (-1, 1/2); together with `young`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub poisson: Option<f64>,
    /// First Lame parameter (stress), larger than `-2/3 mu`; together with `mu`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub lambda: Option<f64>,
    /// Shear modulus (stress), positive; together with `lambda`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub mu: Option<f64>,
}

impl ElasticModuli {
    /// Lame's parameters `(lambda, mu)`: as given, or `lambda = E nu / ((1 + nu)(1 - 2 nu))`, `mu = E / (2 (1 + nu))`.
    pub fn lame(&self) -> (f64, f64) {
        match (self.lambda, self.mu) {
            (Some(lambda), Some(mu)) => (lambda, mu),
            _ => {
                let (e, nu) = (self.young.unwrap_or_default(), self.poisson.unwrap_or_default());
                (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)))
            }
        }
    }
}

/// Parameters of the law `mooney-rivlin` (theory/kinematics#eq-mooney-rivlin): shear modulus `2 (c1 + c2)`, first Lame parameter `2 c + 4 c2`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MooneyRivlin {
    /// Factor of the first invariant (stress).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub c1: f64,
    /// Factor of the second invariant (stress).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub c2: f64,
    /// Volumetric parameter (stress).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub c: f64,
}

/// Parameters of the law `ogden` (theory/kinematics#eq-ogden):
/// `W = sum_p mu_p/alpha_p (sum_a lbar_a^alpha_p - 3) + kappa (ln(J)/beta + (J^-beta - 1)/beta^2)` with the isochoric principal
/// stretches `lbar_a`. Shear modulus `1/2 sum_p mu_p alpha_p`, bulk modulus `kappa`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ogden {
    /// Moduli of the terms (stress); one or more.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub mu: Vec<f64>,
    /// Exponents of the terms, none zero; as many as `mu`.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub alpha: Vec<f64>,
    /// Bulk modulus (stress), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub kappa: f64,
    /// Exponent of the volumetric part, not zero.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub beta: f64,
}

/// A user's own law, with any parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AnyMaterial")]
pub struct OwnMaterial {
    /// Name of the law.
    pub law: String,
    /// Its parameters by key.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Parameter>,
}

/// A parameter of a law that is not in the catalogue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Parameter {
    /// `key = 1.0`
    Number(f64),
    /// `key = [1.0, 2.0]`
    List(Vec<f64>),
}

/// As [`OwnMaterial`], before it is known that the law is not one of the catalogue with parameters that do not fit.
#[derive(Deserialize)]
struct AnyMaterial {
    law: String,
    #[serde(flatten)]
    parameters: BTreeMap<String, Parameter>,
}

impl TryFrom<AnyMaterial> for OwnMaterial {
    type Error = String;

    fn try_from(material: AnyMaterial) -> Result<Self, String> {
        let AnyMaterial { law, parameters } = material;
        if Material::NAMES.contains(&law.as_str()) {
            return Err(format!("the parameters do not fit the law {law}"));
        }
        Ok(Self { law, parameters })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lame_parameters_of_the_literature() {
        // theory/kinematics#moduli: E = 2250, nu = 0.3
        let moduli = ElasticModuli { young: Some(2250.0), poisson: Some(0.3), ..Default::default() };
        let (lambda, mu) = moduli.lame();
        approx::assert_relative_eq!(lambda, 1298.0769, max_relative = 1e-7);
        approx::assert_relative_eq!(mu, 865.3846, max_relative = 1e-7);
        let same = ElasticModuli { lambda: Some(lambda), mu: Some(mu), ..Default::default() };
        assert_eq!(same.lame(), (lambda, mu));
    }
}
