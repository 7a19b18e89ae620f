//! Friction of a contact (theory/friction).

use crate::Parameter;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

named! {
    /// How stick is enforced.
    Stick {
        /// By a tangential spring between slave and master: a sticking node moves by traction over `penalty`, and no farther.
        Penalty = "penalty",
        /// Exactly, by an augmented Lagrangian: a few more solutions a step, the result does not depend on `penalty`.
        Augmented = "augmented",
        /// Exactly, by two multipliers a node, unknowns of the step: one Newton method, the result does not depend on `penalty`.
        Multiplier = "multiplier",
    }
}

named! {
    /// Traction in the equations of the midpoint schemes (theory/friction#midpoint). Other schemes take the one at the end of the step.
    MidpointFriction {
        /// Return at the midpoint, the end traction extrapolated: it leaves the cone and alternates.
        A = "a",
        /// Return over the step, its result in the equations: robust, damps stick.
        B = "b",
        /// Mean of the tractions at both ends, of second order; too small where the pressure alternates from step to step. The default.
        C = "c",
    }
}

named! {
    /// How mortar contact measures the slip of a step (theory/friction#mortar).
    Slip {
        /// By products of gap vector and facet that no rigid motion changes; momenta and work are exact. The default.
        Objective = "objective",
        /// By the change of the gap vector, as in the thesis: a rotation with a gap counts as slip, angular momentum is not exact.
        Direct = "direct",
        /// By the change of the integrals: statics and backward Euler only.
        Yang = "yang",
    }
}

/// A law of friction with its parameters.
///
/// # How to add one
/// A variant with a struct of parameters here, its reading in `read/friction.rs`, its arm in the facade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Friction {
    /// Coulomb's law: the tangential traction does not exceed `mu` times the pressure.
    Coulomb(CoulombFriction),
    /// Coulomb's law with a coefficient that falls with the speed `v` of the slip,
    /// `mu_dynamic + (mu_static - mu_dynamic) exp(-(v / speed)^2)`.
    StaticDynamic(StaticDynamicFriction),
    /// Coulomb's law without stick: traction `mu p v / sqrt(v^2 + speed^2)`.
    Regularised(RegularisedFriction),
    /// A law that the program brings with it; see [`crate::parse_with`]. Not in the schema, which knows the catalogue only.
    #[serde(untagged)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    Own(OwnFriction),
}

impl Friction {
    /// Names of the laws of the catalogue.
    pub const NAMES: &'static [&'static str] = &["coulomb", "static-dynamic", "regularised"];

    /// Name of the law in a scene.
    pub fn law(&self) -> &str {
        match self {
            Self::Coulomb(_) => "coulomb",
            Self::StaticDynamic(_) => "static-dynamic",
            Self::Regularised(_) => "regularised",
            Self::Own(own) => &own.law,
        }
    }

    /// Parameters of the law by key, without those of stick and slip.
    pub fn parameters(&self) -> BTreeMap<String, Parameter> {
        let numbers = |list: &[(&str, f64)]| {
            list.iter().map(|&(key, value)| (key.to_owned(), Parameter::Number(value))).collect()
        };
        match self {
            Self::Coulomb(p) => numbers(&[("mu", p.mu)]),
            Self::StaticDynamic(p) => {
                numbers(&[("mu_static", p.mu_static), ("mu_dynamic", p.mu_dynamic), ("speed", p.speed)])
            }
            Self::Regularised(p) => numbers(&[("mu", p.mu), ("speed", p.speed)]),
            Self::Own(own) => own.parameters.clone(),
        }
    }
}

/// Tangential stiffness, stick and stepping of the laws that can stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sticking {
    /// Tangential stiffness (traction per length), positive; `None`: ten times Young's modulus over an edge. Multipliers have none.
    pub penalty: Option<f64>,
    /// How stick is enforced; `None`: by multipliers, or by springs if a `penalty` is given.
    pub stick: Option<Stick>,
    /// Which traction the midpoint schemes take; `None`: the mean of both ends. Exact stick leaves no choice.
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
        self.midpoint.unwrap_or(Self::DEFAULT_MIDPOINT)
    }
    /// Stepping if left out.
    pub const DEFAULT_MIDPOINT: MidpointFriction = MidpointFriction::C;
}

/// Parameters of `coulomb`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CoulombFriction {
    /// Coefficient, not negative.
    pub mu: f64,
    /// Tangential stiffness (traction per length), positive, not for `multiplier`; ten times Young's modulus of the softer body over an edge if left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penalty: Option<f64>,
    /// How stick is enforced; by multipliers if left out, or by springs if a `penalty` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stick: Option<Stick>,
    /// Which traction the midpoint schemes take, with springs; `c` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub midpoint: Option<MidpointFriction>,
    /// Slip of `mortar`; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
}

/// Parameters of `static-dynamic`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StaticDynamicFriction {
    /// Coefficient at rest, not below `mu_dynamic`.
    pub mu_static: f64,
    /// Coefficient of fast slip, not negative.
    pub mu_dynamic: f64,
    /// Speed of the transition (length per time), positive.
    pub speed: f64,
    /// Tangential stiffness (traction per length), positive, not for `multiplier`; ten times Young's modulus of the softer body over an edge if left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penalty: Option<f64>,
    /// How stick is enforced; by multipliers if left out, or by springs if a `penalty` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stick: Option<Stick>,
    /// Which traction the midpoint schemes take, with springs; `c` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub midpoint: Option<MidpointFriction>,
    /// Slip of `mortar`; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
}

/// Parameters of `regularised`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RegularisedFriction {
    /// Coefficient, not negative.
    pub mu: f64,
    /// Speed below which it is viscous (length per time), positive.
    pub speed: f64,
    /// Slip of `mortar`; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
}

/// A law of friction that is not in the catalogue, with whatever parameters stand beside its name. The four keys below belong to the contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AnyFriction")]
pub struct OwnFriction {
    /// Name of the law.
    pub law: String,
    /// Tangential stiffness (traction per length), positive; ten times Young's modulus of the softer body over an edge if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub penalty: Option<f64>,
    /// How stick is enforced, if given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stick: Option<Stick>,
    /// Which traction the midpoint schemes take, if given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub midpoint: Option<MidpointFriction>,
    /// Slip of `mortar`; `objective` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
    /// Parameters of the law by key.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Parameter>,
}

/// As [`OwnFriction`], before it is known that the law is not one of the catalogue with parameters that do not fit.
#[derive(Deserialize)]
struct AnyFriction {
    law: String,
    penalty: Option<f64>,
    stick: Option<Stick>,
    midpoint: Option<MidpointFriction>,
    slip: Option<Slip>,
    #[serde(flatten)]
    parameters: BTreeMap<String, Parameter>,
}

impl TryFrom<AnyFriction> for OwnFriction {
    type Error = String;

    fn try_from(friction: AnyFriction) -> Result<Self, String> {
        let AnyFriction { law, penalty, stick, midpoint, slip, parameters } = friction;
        if Friction::NAMES.contains(&law.as_str()) {
            return Err(format!("the parameters do not fit the law {law}"));
        }
        Ok(Self { law, penalty, stick, midpoint, slip, parameters })
    }
}

impl OwnFriction {
    /// One of the keys of stick that is given, if any is.
    pub fn sticking_key(&self) -> Option<&'static str> {
        [("penalty", self.penalty.is_some()), ("stick", self.stick.is_some()), ("midpoint", self.midpoint.is_some())]
            .into_iter()
            .find_map(|(key, given)| given.then_some(key))
    }
}

impl Friction {
    /// Stick and its stiffness; `None` for a law of the catalogue that cannot stick.
    pub fn sticking(&self) -> Option<Sticking> {
        match *self {
            Self::Coulomb(CoulombFriction { penalty, stick, midpoint, .. })
            | Self::StaticDynamic(StaticDynamicFriction { penalty, stick, midpoint, .. }) => {
                Some(Sticking { penalty, stick, midpoint })
            }
            Self::Regularised(_) => None,
            Self::Own(OwnFriction { penalty, stick, midpoint, .. }) => Some(Sticking { penalty, stick, midpoint }),
        }
    }

    /// Slip of `mortar`, if given.
    pub fn slip(&self) -> Option<Slip> {
        match self {
            Self::Coulomb(p) => p.slip,
            Self::StaticDynamic(p) => p.slip,
            Self::Regularised(p) => p.slip,
            Self::Own(p) => p.slip,
        }
    }

    pub(crate) fn with_slip(mut self, slip: Option<Slip>) -> Self {
        match &mut self {
            Self::Coulomb(p) => p.slip = slip,
            Self::StaticDynamic(p) => p.slip = slip,
            Self::Regularised(p) => p.slip = slip,
            Self::Own(p) => p.slip = slip,
        }
        self
    }
}
