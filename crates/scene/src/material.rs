//! Materials of bodies: a law and its parameters (theory/kinematics#laws).

#[cfg(feature = "schema")]
use crate::catalogue;
use crate::catalogue::{Parameter, given};
use crate::catalogue::{law_parameters, of_row};
use crate::read::{Node, Table, Value};
use crate::world::Setting;
use crate::{Fibres, Moduli, Mullins, Plasticity};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_materials::{History, LAWS, LawEntry};
use stoss_registry::Refusal;
use stoss_scene_derive::table;

/// A law with its parameters: of the table `stoss_materials::LAWS`, or a user's own one, registered by the program ([`crate::parse_with`]), which the schema does not have.
///
/// # How to add one
/// A row of that table; nothing here.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
#[table(check = inelasticity)]
pub struct Inelasticity {
    /// Von Mises plasticity; none if left out.
    pub plasticity: Option<Plasticity>,
    /// Maxwell branches: pairs of a share of the shear modulus and a relaxation time. The shares sum up to less than 1. The change of volume stays elastic.
    #[key(default, skip, dimension = [Number, Time], positive)]
    pub prony: Vec<[f64; 2]>,
    /// What the moduli of the law are, with `prony`: `instantaneous` if left out.
    pub moduli: Option<Moduli>,
    /// Softening of filled rubber; none if left out.
    pub mullins: Option<Mullins>,
    /// Fibres in the material; none if left out.
    pub fibres: Option<Fibres>,
}

/// The moduli say something of the branches.
fn inelasticity<C>(keys: &InelasticityKeys, table: &Table<'_>, _: &C) -> Option<()> {
    match (&keys.moduli, &keys.prony) {
        (Some(Some(_)), Some(prony)) if prony.is_empty() => {
            table.fail("moduli", "has no effect without `prony`", "remove it, or add prony = [[0.3, 0.01]]")
        }
        _ => Some(()),
    }
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

impl Value<Setting<'_>> for Material {
    fn read(node: &Node<'_>, setting: &Setting<'_>) -> Option<Self> {
        let table = node.table()?;
        let mut names: Vec<&str> = Self::names().collect();
        names.extend_from_slice(setting.own_materials);
        let law = table.required("law", "law = \"neo-hooke\"", |n| {
            n.choice(&names, |name| names.contains(&name).then(|| name.to_owned()))
        });
        // Without a law it is not known which other keys are right.
        let law = law?;
        let Some(entry) = stoss_materials::entry(&law) else {
            let parameters = law_parameters(&table);
            table.finish();
            return Some(Self { law, inelasticity: Inelasticity::default(), parameters: parameters? });
        };
        let keys = InelasticityKeys::read(&table, setting);
        let fits = inelasticity(&keys, &table, setting);
        let parameters = of_row(&table, entry);
        table.finish();
        fits?;
        let (inelasticity, parameters) = (keys.build()?, parameters?);
        match inelasticity.check(entry, &parameters) {
            Ok(()) => Some(Self { law, inelasticity, parameters }),
            Err(refusal) => table.fail(refusal.parameter, refusal.message, refusal.remedy),
        }
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Material {
    fn schema_name() -> Cow<'static, str> {
        "Material".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let keys = catalogue::properties::<Inelasticity>(generator);
        let laws: Vec<_> = LAWS
            .iter()
            .map(|row| {
                let mut keys = keys.clone();
                match row.name {
                    // Not the sum of a volumetric part and a rest.
                    "saint-venant-kirchhoff" => keys.clear(),
                    "hencky" => {}
                    _ => drop(keys.remove("plasticity")),
                }
                catalogue::schema(row, keys)
            })
            .collect();
        json_schema!({
            "description": "Law with its parameters. The shear and bulk moduli at small strains that follow from them must be positive.",
            "oneOf": laws,
        })
    }
}
