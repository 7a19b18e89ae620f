//! Materials of bodies: a law and its parameters (theory/kinematics#laws).

#[cfg(feature = "schema")]
use crate::Dimension;
#[cfg(feature = "schema")]
use crate::catalogue;
use crate::catalogue::{Parameter, given};
use crate::{Fibres, Moduli, Mullins, Plasticity};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_materials::{History, LAWS, LawEntry};
use stoss_registry::Refusal;

/// A law with its parameters: of the table `stoss_materials::LAWS`, or a user's own one, registered by the program ([`crate::parse_with`]), which the schema does not have.
///
/// # How to add one
/// A row of that table; nothing here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AnyMaterial")]
pub struct Material {
    /// Name of the law.
    pub law: String,
    /// What it has beside an elastic law.
    #[serde(flatten)]
    pub inelasticity: Inelasticity,
    /// Its parameters by key.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Parameter>,
}

/// What a material has beside an elastic law of the catalogue; each may be left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inelasticity {
    /// Plasticity, of `hencky` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plasticity: Option<Plasticity>,
    /// Maxwell branches, pairs of a share of the shear modulus and a relaxation time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub prony: Vec<[f64; 2]>,
    /// What the moduli of the law are, with `prony`: `instantaneous` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moduli: Option<Moduli>,
    /// Softening.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mullins: Option<Mullins>,
    /// Fibres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fibres: Option<Fibres>,
}

impl Inelasticity {
    /// The inelasticity as the catalogue of laws has it.
    pub fn history(&self) -> History {
        History {
            plasticity: self.plasticity.as_ref().map(Plasticity::yielding),
            prony: self.prony.iter().map(|&[share, time]| (share, time)).collect(),
            moduli: self.moduli.unwrap_or(Moduli::Instantaneous).into(),
            mullins: self.mullins.map(Into::into),
            fibres: self.fibres.as_ref().map(Fibres::families),
        }
    }

    /// Refuses what the law of these parameters cannot have.
    pub(crate) fn check(&self, entry: &LawEntry, parameters: &BTreeMap<String, Parameter>) -> Result<(), Refusal> {
        self.history().of(entry.with(given(parameters))?).map(|_| ())
    }
}

impl Material {
    /// Names of the laws of the catalogue.
    pub fn names() -> impl Iterator<Item = &'static str> {
        LAWS.iter().map(|entry| entry.name)
    }
}

/// A material before it is known that the parameters fit a law of the catalogue.
#[derive(Deserialize)]
struct AnyMaterial {
    law: String,
    #[serde(flatten)]
    inelasticity: Inelasticity,
    #[serde(flatten)]
    parameters: BTreeMap<String, Parameter>,
}

impl TryFrom<AnyMaterial> for Material {
    type Error = String;

    fn try_from(AnyMaterial { law, inelasticity, parameters }: AnyMaterial) -> Result<Self, String> {
        let material = Self { law, inelasticity, parameters };
        if let Some(entry) = stoss_materials::entry(&material.law) {
            let refused = |refusal| format!("law {}: {refusal}", material.law);
            material.inelasticity.check(entry, &material.parameters).map_err(refused)?;
        }
        Ok(material)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Material {
    fn schema_name() -> Cow<'static, str> {
        "Material".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let about = |mut schema: Schema, text: &str| {
            schema.insert("description".to_owned(), text.into());
            schema
        };
        let mut history = serde_json::Map::new();
        let branches = json_schema!({
            "type": "array", "items": {
                "type": "array", "items": { "type": "number", "format": "double" }, "minItems": 2, "maxItems": 2,
            },
            "x-dimension": [Dimension::Number, Dimension::Time],
            "description": "Maxwell branches: pairs of a share of the shear modulus and a relaxation time. The shares sum up to less than 1. The change of volume stays elastic.",
        });
        let moduli = about(
            generator.subschema_for::<Moduli>(),
            "What the moduli of the law are, with `prony`: `instantaneous` if left out.",
        );
        let mullins = about(generator.subschema_for::<Mullins>(), "Softening of filled rubber; none if left out.");
        let fibres = about(generator.subschema_for::<Fibres>(), "Fibres in the material; none if left out.");
        for (key, schema) in [("prony", branches), ("moduli", moduli), ("mullins", mullins), ("fibres", fibres)] {
            history.insert(key.to_owned(), schema.to_value());
        }
        let plasticity = about(generator.subschema_for::<Plasticity>(), "Von Mises plasticity; none if left out.");
        let laws: Vec<_> = LAWS
            .iter()
            .map(|row| {
                let mut properties = match row.name {
                    // Not the sum of a volumetric part and a rest.
                    "saint-venant-kirchhoff" => serde_json::Map::new(),
                    _ => history.clone(),
                };
                if row.name == "hencky" {
                    properties.insert("plasticity".to_owned(), plasticity.clone().to_value());
                }
                catalogue::schema(row, properties)
            })
            .collect();
        json_schema!({
            "description": "Law with its parameters. The shear and bulk moduli at small strains that follow from them must be positive.",
            "oneOf": laws,
        })
    }
}
