//! What a contact will be computed with, defaults included, for `stoss check` and `summary.json`.

use crate::scene::Parameter;
#[cfg(feature = "output")]
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A contact as it will be computed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "output", derive(Serialize, Deserialize))]
pub struct ContactPlan {
    /// Name of the contact.
    pub name: String,
    /// The slave surface and why, where the scene leaves it open (`between`).
    #[cfg_attr(feature = "output", serde(default, skip_serializing_if = "Option::is_none"))]
    pub slave: Option<String>,
    /// Contact method, as in the scene.
    pub method: String,
    /// What an active constraint asks for, as in the scene.
    pub constraint: String,
    /// How the normal part is enforced; with its stiffness (traction per length) if it has one.
    pub enforcement: String,
    /// Slave points that may be in contact.
    pub slots: u64,
    /// Equations that a point in contact adds to the system: the pressure, and what the method has beside it.
    pub unknowns_per_slot: u64,
    /// Friction, if there is any.
    pub friction: Option<FrictionPlan>,
    /// Restitution of the law of impact between rigid bodies.
    #[cfg_attr(feature = "output", serde(default, skip_serializing_if = "Option::is_none"))]
    pub restitution: Option<f64>,
    /// Whether the restitution was assumed because the scene gives none.
    #[cfg_attr(feature = "output", serde(default, skip_serializing_if = "std::ops::Not::not"))]
    pub is_assumed: bool,
}

/// Friction of a contact as it will be computed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "output", derive(Serialize, Deserialize))]
pub struct FrictionPlan {
    /// Name of the law.
    pub law: String,
    /// Parameters of the law.
    pub parameters: BTreeMap<String, Parameter>,
    /// Tangential stiffness (traction per length); `None` for a law without stick and for multipliers.
    pub stiffness: Option<f64>,
    /// True if the scene does not give that stiffness.
    pub default_stiffness: bool,
    /// How stick is enforced, as in the scene (general contact in statics: `elastic`); `None` for a law without stick.
    pub stick: Option<String>,
    /// Which traction of a step is in the equations: `end`, or `step` (one for the whole of it).
    pub stepping: String,
    /// How mortar contact measures slip, as in the scene; in dynamics with general contact, below which speeds it is creep.
    pub slip: Option<String>,
}

impl fmt::Display for ContactPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            slave,
            method,
            constraint,
            enforcement,
            slots,
            unknowns_per_slot,
            friction,
            restitution,
            is_assumed,
        } = self;
        if *unknowns_per_slot == 0 {
            write!(f, "{name}: {constraint}, {enforcement}, {slots} points without unknowns")?;
        } else {
            write!(f, "{name}: {method}, {constraint} constraint by {enforcement}, {slots} slave points with ")?;
            write!(f, "{unknowns_per_slot} {} each", if *unknowns_per_slot == 1 { "unknown" } else { "unknowns" })?;
        }
        match friction {
            Some(friction) => write!(f, "; friction {friction}")?,
            None => write!(f, "; no friction")?,
        }
        match restitution {
            Some(e) if *is_assumed => write!(f, "; restitution {e}, assumed")?,
            Some(e) => write!(f, "; restitution {e}")?,
            None => {}
        }
        slave.as_ref().map_or(Ok(()), |slave| write!(f, "; slave {slave}"))
    }
}

impl fmt::Display for FrictionPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list: Vec<String> = self
            .parameters
            .iter()
            .map(|(key, value)| match value {
                Parameter::Number(value) => format!("{key} = {value}"),
                Parameter::List(values) => format!("{key} = {values:?}"),
            })
            .collect();
        write!(f, "{}", self.law)?;
        if !list.is_empty() {
            write!(f, " ({})", list.join(", "))?;
        }
        match (self.stiffness, &self.stick) {
            (Some(stiffness), Some(stick)) => {
                let by = if self.default_stiffness { " by default" } else { "" };
                write!(f, ", stick = {stick}, tangential stiffness {stiffness:.4e}{by}")?;
            }
            (None, Some(stick)) => write!(f, ", stick = {stick}")?,
            (_, None) => write!(f, ", no stick")?,
        }
        let of_the_end = self.stepping == "end";
        write!(f, ", {}", if of_the_end { "traction of the end of a step" } else { "one traction for a step" })?;
        match &self.slip {
            Some(slip) => write!(f, ", slip {slip}"),
            None => Ok(()),
        }
    }
}
