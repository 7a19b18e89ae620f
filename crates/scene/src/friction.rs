//! Friction of a contact (theory/friction).

use crate::ContactMethod;
#[cfg(feature = "schema")]
use crate::catalogue;
use crate::catalogue::Parameter;
use crate::catalogue::{law_parameters, of_row};
use crate::names::named;
use crate::read::{Node, Table, Value};
use crate::world::World;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_contact::friction::{FrictionEntry, LAWS, entry};
use stoss_scene_derive::table;

named! {
    /// Enforcement of stick.
    Stick {
        /// Penalty method: tangential springs between slave and master; a sticking node moves elastically by its traction over `penalty`.
        Penalty = "penalty",
        /// Exactly, by two Lagrange multipliers for each node: one Newton iteration; the result does not depend on `penalty`.
        Multiplier = "multiplier",
    }
}

named! {
    /// Measure of the slip in a step of mortar contact (theory/friction#mortar).
    Slip {
        /// From invariants of gap vector and facet under rigid motions; momenta and work are exact. The default.
        Objective = "objective",
        /// From the change of the gap vector, as in the thesis: a rotation with an open gap counts as slip, and angular momentum is not exact.
        Direct = "direct",
    }
}

/// Keys of stick, for laws with stick.
#[table]
#[derive(Copy)]
pub struct Sticking {
    /// Tangential stiffness (traction per length), positive; not with `stick = "multiplier"`. Ten times Young's modulus of the softer body over an edge length if left
    /// out.
    #[key(dimension = StressPerLength, positive)]
    pub penalty: Option<f64>,
    /// Enforcement of stick; `multiplier` if left out, or `penalty` if a `penalty` is given.
    pub stick: Option<Stick>,
}

impl Sticking {
    /// How stick is enforced.
    pub fn stick(&self) -> Stick {
        let left_out = if self.penalty.is_some() { Stick::Penalty } else { Stick::Multiplier };
        self.stick.unwrap_or(left_out)
    }

    /// One of the keys that is given, if any is.
    pub fn key(&self) -> Option<&'static str> {
        [("penalty", self.penalty.is_some()), ("stick", self.stick.is_some())]
            .into_iter()
            .find_map(|(key, given)| given.then_some(key))
    }
}

/// A friction law with its parameters: of the table `stoss_contact::friction::LAWS`, or a user's own one, registered by the program ([`crate::parse_with`]), which the
/// schema does not have. The keys of stick and the slip belong to the contact.
///
/// # How to add one
/// A row of that table; nothing here.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Friction {
    /// Name of the law.
    pub law: String,
    /// Keys of stick, as they are given.
    #[serde(flatten)]
    pub given: Sticking,
    /// Measure of the slip, for `mortar` only; `objective` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
    /// Parameters of the law by key.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Parameter>,
}

impl Friction {
    /// Coulomb's law with a coefficient.
    pub fn coulomb(mu: f64) -> Self {
        let parameters = BTreeMap::from([("mu".to_owned(), Parameter::Number(mu))]);
        Self { law: "coulomb".to_owned(), given: Sticking::default(), slip: None, parameters }
    }

    /// Names of the laws of the catalogue.
    pub fn names() -> impl Iterator<Item = &'static str> {
        LAWS.iter().map(|entry| entry.law.name)
    }

    /// Stick and its stiffness; `None` for a law of the catalogue that cannot stick.
    pub fn sticking(&self) -> Option<Sticking> {
        entry(&self.law).is_none_or(FrictionEntry::sticks).then_some(self.given)
    }

    /// The parameter that is the largest traction over pressure and its value, for a law of the catalogue that has one.
    pub fn coefficient(&self) -> Option<(&'static str, f64)> {
        let key = entry(&self.law)?.coefficient?;
        match self.parameters.get(key) {
            Some(Parameter::Number(value)) => Some((key, *value)),
            _ => None,
        }
    }
}

impl Friction {
    /// Friction of a contact by a method, if that is known.
    pub(crate) fn of(node: &Node<'_>, method: Option<ContactMethod>, world: &World<'_>) -> Option<Self> {
        let table = node.table_like("{ law = \"coulomb\", mu = 0.3 }")?;
        let mut names: Vec<&str> = Self::names().collect();
        names.extend_from_slice(world.own_friction);
        let law = table.required("law", "law = \"coulomb\"", |n| {
            n.choice(&names, |name| names.contains(&name).then(|| name.to_owned()))
        });
        // Without a law it is not known which other keys are right.
        let law = law?;
        let slip = table.optional("slip", |n| match method.filter(|method| !method.has("slip")) {
            Some(method) => n.fail(method.lacks("slip"), "remove it, or choose another `method`"),
            None => Slip::read(n, world),
        });
        let entry = entry(&law);
        let sticks = entry.is_none_or(FrictionEntry::sticks);
        let given = if sticks { keys_of_stick(&table) } else { Some(Sticking::default()) };
        let parameters = match entry {
            Some(entry) => of_row(&table, &entry.law),
            None => law_parameters(&table),
        };
        table.finish();
        Some(Self { law, given: given?, slip: slip?, parameters: parameters? })
    }
}

/// The keys of stick among others.
fn keys_of_stick(table: &Table<'_>) -> Option<Sticking> {
    let given = StickingKeys::read(table, &()).build()?;
    if given.stick() == Stick::Multiplier && given.penalty.is_some() {
        let message = "has no effect with stick = \"multiplier\", which is exact";
        return table.fail("penalty", message, "remove it, or set stick = \"penalty\"");
    }
    Some(given)
}

#[cfg(feature = "schema")]
impl JsonSchema for Friction {
    fn schema_name() -> Cow<'static, str> {
        "Friction".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        /// The key of all laws beside those of stick.
        #[derive(JsonSchema)]
        #[expect(dead_code, reason = "schema only")]
        struct Measure {
            /// Measure of the slip, for `mortar` only; `objective` if left out.
            slip: Option<Slip>,
        }
        let [sticking, measure] =
            [catalogue::properties::<Sticking>(generator), catalogue::properties::<Measure>(generator)];
        let laws: Vec<_> = LAWS
            .iter()
            .map(|entry| {
                let of_stick = entry.sticks().then(|| sticking.clone()).into_iter().flatten();
                catalogue::schema(&entry.law, measure.clone().into_iter().chain(of_stick).collect())
            })
            .collect();
        json_schema!({ "description": "A friction law with its parameters.", "oneOf": laws })
    }
}
