//! Friction of a contact (theory/friction).

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::Parameter;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
        /// Return mapping at the midpoint, the traction at the end extrapolated: it can leave the friction cone and oscillate.
        A = "a",
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

/// A friction law with its parameters.
///
/// # How to add one
/// A variant with a struct of parameters here, its reading in `read/friction.rs`, its arm in the facade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Friction {
    /// Coulomb friction: the tangential traction does not exceed `mu` times the pressure.
    Coulomb(CoulombFriction),
    /// Coulomb friction with a coefficient that decreases with the slip speed `v`,
    /// `mu_dynamic + (mu_static - mu_dynamic) exp(-(v / speed)^2)`.
    StaticDynamic(StaticDynamicFriction),
    /// Regularised Coulomb friction without stick: traction `mu p v / sqrt(v^2 + speed^2)`.
    Regularised(RegularisedFriction),
    /// A user's own law, registered by the program; see [`crate::parse_with`]. Not in the schema, which has the catalogue only.
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

/// Parameters of stick, for laws with stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sticking {
    /// Tangential stiffness (traction per length), positive; `None`: ten times Young's modulus over an edge length. Not used with multipliers.
    pub penalty: Option<f64>,
    /// Enforcement of stick; `None`: by multipliers, or by springs if a `penalty` is given.
    pub stick: Option<Stick>,
    /// Friction traction of the midpoint schemes; `None`: the one at the end. Not used with exact stick.
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
    pub const DEFAULT_MIDPOINT: MidpointFriction = MidpointFriction::B;
}

/// Parameters of `coulomb`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CoulombFriction {
    /// Coefficient of friction, not negative.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub mu: f64,
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
    /// Measure of the slip, for `mortar` only; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
}

/// Parameters of `static-dynamic`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StaticDynamicFriction {
    /// Static coefficient of friction, not below `mu_dynamic`.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub mu_static: f64,
    /// Dynamic coefficient of friction, for fast slip; not negative.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub mu_dynamic: f64,
    /// Slip speed of the transition (length per time), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub speed: f64,
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
    /// Measure of the slip, for `mortar` only; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
}

/// Parameters of `regularised`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RegularisedFriction {
    /// Coefficient of friction, not negative.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub mu: f64,
    /// Slip speed below which friction is viscous (length per time), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub speed: f64,
    /// Measure of the slip, for `mortar` only; `objective` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip: Option<Slip>,
}

/// A user's own friction law, with any parameters. The four keys below belong to the contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AnyFriction")]
pub struct OwnFriction {
    /// Name of the law.
    pub law: String,
    /// Tangential stiffness (traction per length), positive; ten times Young's modulus of the softer body over an edge length if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub penalty: Option<f64>,
    /// How stick is enforced, if given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stick: Option<Stick>,
    /// Which traction the midpoint schemes take, if given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub midpoint: Option<MidpointFriction>,
    /// Measure of the slip, for `mortar` only; `objective` if left out.
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
