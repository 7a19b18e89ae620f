//! Friction of a contact (theory/friction).

use crate::catalogue::{Parameter, given};
use crate::names::named;
#[cfg(feature = "schema")]
use crate::{Dimension, catalogue};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_contact::friction::{FrictionEntry, LAWS, entry};

named! {
    /// Enforcement of stick.
    Stick {
        /// Penalty method: tangential springs between slave and master; a sticking node moves elastically by its traction over `penalty`.
        Penalty = "penalty",
        /// Exactly, by an augmented Lagrangian: several solutions in each step; the result does not depend on `penalty`.
        Augmented = "augmented",
        /// Exactly, by two Lagrange multipliers for each node: one Newton iteration; the result does not depend on `penalty`.
        Multiplier = "multiplier",
    }
}

named! {
    /// Friction traction in the equations of the midpoint schemes (theory/friction#midpoint). Other schemes use the traction at the end of the step.
    MidpointFriction {
        /// Return mapping over the step, its result used in the equations: in slip exactly the law, whatever the pressure does from step to step; damps stick. The default.
        B = "b",
        /// Mean of the tractions at both ends of the step, second order where the pressure is smooth; too small where it alternates from step to step.
        C = "c",
    }
}

named! {
    /// Measure of the slip in a step of mortar contact (theory/friction#mortar).
    Slip {
        /// From invariants of gap vector and facet under rigid motions; momenta and work are exact. The default.
        Objective = "objective",
        /// From the change of the gap vector, as in the thesis: a rotation with an open gap counts as slip, and angular momentum is not exact.
        Direct = "direct",
        /// From the change of the mortar integrals (Yang, Laursen and Meng): statics and backward Euler only.
        Yang = "yang",
    }
}

/// Keys of stick, for laws with stick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct Sticking {
    /// Tangential stiffness (traction per length), positive; not with `stick = "multiplier"`. Ten times Young's modulus of the softer body over an edge length if left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::StressPerLength)))]
    pub penalty: Option<f64>,
    /// Enforcement of stick; `multiplier` if left out, or `penalty` if a `penalty` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stick: Option<Stick>,
    /// Friction traction of the midpoint schemes, with `stick = "penalty"` only; `b` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub midpoint: Option<MidpointFriction>,
}

impl Sticking {
    /// How stick is enforced.
    pub fn stick(&self) -> Stick {
        let left_out = if self.penalty.is_some() { Stick::Penalty } else { Stick::Multiplier };
        self.stick.unwrap_or(left_out)
    }

    /// Which traction the midpoint schemes take.
    pub fn midpoint(&self) -> MidpointFriction {
        self.midpoint.unwrap_or(MidpointFriction::B)
    }

    /// One of the keys that is given, if any is.
    pub fn key(&self) -> Option<&'static str> {
        [("penalty", self.penalty.is_some()), ("stick", self.stick.is_some()), ("midpoint", self.midpoint.is_some())]
            .into_iter()
            .find_map(|(key, given)| given.then_some(key))
    }
}

/// A friction law with its parameters: of the table `stoss_contact::friction::LAWS`, or a user's own one, registered by the program ([`crate::parse_with`]), which the
/// schema does not have. The keys of stick and the slip belong to the contact.
///
/// # How to add one
/// A row of that table; nothing here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AnyFriction")]
pub struct Friction {
    /// Name of the law.
    pub law: String,
    /// Keys of stick, as they are given.
    #[serde(flatten)]
    pub given: Sticking,
    /// Measure of the slip, for `mortar` only; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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

/// A law of friction before it is known that the parameters fit a law of the catalogue.
#[derive(Deserialize)]
struct AnyFriction {
    law: String,
    #[serde(flatten)]
    given: Sticking,
    slip: Option<Slip>,
    #[serde(flatten)]
    parameters: BTreeMap<String, Parameter>,
}

impl TryFrom<AnyFriction> for Friction {
    type Error = String;

    fn try_from(friction: AnyFriction) -> Result<Self, String> {
        let AnyFriction { law, given: sticking, slip, parameters } = friction;
        if let Some(entry) = entry(&law) {
            entry.law.with(given(&parameters)).map_err(|refusal| format!("law {law}: {refusal}"))?;
            if let (false, Some(key)) = (entry.sticks(), sticking.key()) {
                return Err(format!("law {law}: {key}: belongs to stick, and the law has none; remove it"));
            }
        }
        Ok(Self { law, given: sticking, slip, parameters })
    }
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
        let mut properties = |schema: Schema| match schema.get("properties") {
            Some(serde_json::Value::Object(properties)) => properties.clone(),
            _ => serde_json::Map::new(),
        };
        let [sticking, measure] =
            [Sticking::json_schema(generator), Measure::json_schema(generator)].map(&mut properties);
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
