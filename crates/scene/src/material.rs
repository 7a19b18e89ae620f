//! Materials of bodies: a law and its parameters (theory/kinematics#laws).

#[cfg(feature = "schema")]
use crate::catalogue;
use crate::catalogue::{Parameter, given};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_materials::LAWS;

/// A law with its parameters: of the table `stoss_materials::LAWS`, or a user's own one, registered by the program ([`crate::parse_with`]), which the schema does not have.
///
/// # How to add one
/// A row of that table; nothing here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AnyMaterial")]
pub struct Material {
    /// Name of the law.
    pub law: String,
    /// Its parameters by key.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Parameter>,
}

impl Material {
    /// Names of the laws of the catalogue.
    pub fn names() -> impl Iterator<Item = &'static str> {
        LAWS.iter().map(|entry| entry.name)
    }
}

/// As [`Material`], before it is known that the parameters fit a law of the catalogue.
#[derive(Deserialize)]
struct AnyMaterial {
    law: String,
    #[serde(flatten)]
    parameters: BTreeMap<String, Parameter>,
}

impl TryFrom<AnyMaterial> for Material {
    type Error = String;

    fn try_from(AnyMaterial { law, parameters }: AnyMaterial) -> Result<Self, String> {
        let material = Self { law, parameters };
        if let Some(entry) = stoss_materials::entry(&material.law) {
            entry.with(given(&material.parameters)).map_err(|refusal| format!("law {}: {refusal}", material.law))?;
        }
        Ok(material)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Material {
    fn schema_name() -> Cow<'static, str> {
        "Material".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let laws: Vec<_> = LAWS.iter().map(|row| catalogue::schema(row, serde_json::Map::new())).collect();
        json_schema!({
            "description": "Law with its parameters. The shear and bulk moduli at small strains that follow from them must be positive.",
            "oneOf": laws,
        })
    }
}
