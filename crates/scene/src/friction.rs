//! Friction of a contact (formulation §1.4, §10).

use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// Traction in the equations of the midpoint schemes (formulation §10.2). Other schemes take the one at the end of the step.
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
    /// How mortar contact measures the slip of a step (formulation §8.2).
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
}

impl Friction {
    /// Names of the laws.
    pub const NAMES: &'static [&'static str] = &["coulomb", "static-dynamic", "regularised"];
}

/// Tangential stiffness, stick and stepping of the laws that can stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sticking {
    /// Tangential stiffness (traction per length), positive; `None`: ten times Young's modulus over an edge. Multipliers have none.
    pub penalty: Option<f64>,
    /// How stick is enforced; `None`: by multipliers, or by springs if a `penalty` is given.
    pub stick: Option<Stick>,
    /// Which traction the midpoint schemes take. Multipliers leave no choice.
    pub midpoint: MidpointFriction,
}

impl Sticking {
    /// How stick is enforced.
    pub fn stick(&self) -> Stick {
        let left_out = if self.penalty.is_some() { Stick::Penalty } else { Stick::Multiplier };
        self.stick.unwrap_or(left_out)
    }
    /// Stepping if left out.
    pub const DEFAULT_MIDPOINT: MidpointFriction = MidpointFriction::C;
}

fn default_midpoint() -> MidpointFriction {
    Sticking::DEFAULT_MIDPOINT
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
    /// Which traction the midpoint schemes take.
    #[serde(default = "default_midpoint")]
    pub midpoint: MidpointFriction,
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
    /// Which traction the midpoint schemes take.
    #[serde(default = "default_midpoint")]
    pub midpoint: MidpointFriction,
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

impl Friction {
    /// Stick and its stiffness; `None` for a law that cannot stick.
    pub fn sticking(&self) -> Option<Sticking> {
        match *self {
            Self::Coulomb(CoulombFriction { penalty, stick, midpoint, .. })
            | Self::StaticDynamic(StaticDynamicFriction { penalty, stick, midpoint, .. }) => {
                Some(Sticking { penalty, stick, midpoint })
            }
            Self::Regularised(_) => None,
        }
    }

    /// Slip of `mortar`, if given.
    pub fn slip(&self) -> Option<Slip> {
        match self {
            Self::Coulomb(p) => p.slip,
            Self::StaticDynamic(p) => p.slip,
            Self::Regularised(p) => p.slip,
        }
    }

    pub(crate) fn with_slip(mut self, slip: Option<Slip>) -> Self {
        match &mut self {
            Self::Coulomb(p) => p.slip = slip,
            Self::StaticDynamic(p) => p.slip = slip,
            Self::Regularised(p) => p.slip = slip,
        }
        self
    }
}
