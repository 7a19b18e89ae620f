//! Materials of bodies: a law and its parameters (theory/kinematics#laws).

#[cfg(feature = "schema")]
use crate::Dimension;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_materials::{Given, LAWS};

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

    /// The parameters as the catalogue takes them.
    pub fn given(&self) -> impl Iterator<Item = (&str, Given<'_>)> {
        self.parameters.iter().map(|(name, value)| {
            let given = match value {
                Parameter::Number(value) => Given::Number(*value),
                Parameter::List(values) => Given::List(values),
            };
            (name.as_str(), given)
        })
    }
}

/// A parameter of a law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Parameter {
    /// `key = 1.0`
    Number(f64),
    /// `key = [1.0, 2.0]`
    List(Vec<f64>),
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
            entry.with(material.given()).map_err(|refusal| format!("law {}: {refusal}", material.law))?;
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
        let laws: Vec<_> = LAWS
            .iter()
            .map(|entry| {
                let mut properties = serde_json::Map::new();
                properties.insert("law".into(), serde_json::json!({ "const": entry.name }));
                for parameter in entry.parameters() {
                    let dimension = match parameter.unit {
                        stoss_materials::Unit::Stress => Dimension::Stress,
                        stoss_materials::Unit::Number => Dimension::Number,
                    };
                    let value = match parameter.is_list {
                        true => serde_json::json!({
                            "type": "array", "items": { "type": "number", "format": "double" }, "minItems": 1,
                            "description": parameter.about, "x-dimension": dimension,
                        }),
                        false => serde_json::json!({
                            "type": "number", "format": "double", "description": parameter.about, "x-dimension": dimension,
                        }),
                    };
                    properties.insert(parameter.name.into(), value);
                }
                // Of several ways to give the parameters none is needed.
                let needed = if let [way] = entry.ways { *way } else { &[] };
                let required: Vec<&str> = std::iter::once("law").chain(needed.iter().map(|p| p.name)).collect();
                serde_json::json!({
                    "description": entry.about, "type": "object", "properties": properties,
                    "required": required, "additionalProperties": false,
                })
            })
            .collect();
        json_schema!({
            "description": "Law with its parameters. The shear and bulk moduli at small strains that follow from them must be positive.",
            "oneOf": laws,
        })
    }
}
