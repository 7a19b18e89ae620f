//! The table `[general_contact]`.

use crate::Integrator;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// What happens to bodies that overlap at the start.
    #[derive(Default)]
    Initial {
        /// They are refused.
        #[default]
        Refuse = "refuse",
        /// Bodies that may be moved are moved apart before the start, without stress.
        Separate = "separate",
    }
}

/// `[general_contact]`: contact of everything with everything, without slave and master. It is on by default where several parts have surfaces, no pair is named with `[[contact]]`, and
/// the scheme carries it. Facets that a `[[contact]]` or a `[[tie]]` pairs are left out for each other, and parts that a joint connects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GeneralContact {
    /// `false` switches it off.
    #[serde(default = "GeneralContact::yes", skip_serializing_if = "GeneralContact::is_yes")]
    pub enabled: bool,
    /// Thickness of the layer on the surfaces, a length: forces begin at this distance. By default 0.04 of the shortest edge of a facet, or half of the smallest distance of two parts of
    /// the surface of a body that are no neighbours, if that is less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// Modulus of the layer in multiples of Young's modulus of the softer body of a pair, positive.
    #[serde(default = "GeneralContact::one")]
    pub stiffness: f64,
    /// Coefficient of friction of all pairs of bodies that `pairs` does not name.
    #[serde(default)]
    pub friction: f64,
    /// Speed of slip in dynamics below which friction falls to zero, positive: there bodies creep instead of sticking. By default, for each two bodies, a hundredth of the largest speed of a point of one against a point of the other at the start, or, if they do not move against each other, a tenth of the thickness over the time of the run; needed with friction where nothing moves against anything else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip_velocity: Option<f64>,
    /// Time of a viscous layer, not negative: it damps the motion in the layer. Its loss is in the balance of energy.
    #[serde(default)]
    pub damping: f64,
    /// Whether a body is in contact with itself.
    #[serde(default = "GeneralContact::yes", rename = "self")]
    pub with_itself: bool,
    /// What happens to bodies that overlap at the start.
    #[serde(default)]
    pub initial: Initial,
    /// What takes part: names of parts, and sets of them (`part.set`); by default all bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub include: Vec<String>,
    /// What does not, even if it is included.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub exclude: Vec<String>,
    /// Pairs of bodies that differ.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<GeneralPair>,
}

/// A pair of bodies in `[general_contact]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GeneralPair {
    /// The two parts, which may be the same.
    pub between: [String; 2],
    /// Coefficient of friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Modulus of the layer, a pressure. Two rigid bodies need it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus: Option<f64>,
}

impl GeneralContact {
    fn one() -> f64 {
        1.0
    }

    fn yes() -> bool {
        true
    }

    fn is_yes(yes: &bool) -> bool {
        *yes
    }
}

impl Default for GeneralContact {
    fn default() -> Self {
        Self {
            enabled: true,
            thickness: None,
            stiffness: 1.0,
            friction: 0.0,
            slip_velocity: None,
            damping: 0.0,
            with_itself: true,
            initial: Initial::default(),
            include: Vec::new(),
            exclude: Vec::new(),
            pairs: Vec::new(),
        }
    }
}

/// Whether a scene that does not mention general contact has it: no pair is named, several parts have surfaces, some of them deformable, and all schemes carry it.
pub(crate) fn is_default<'a>(
    names_pairs: bool,
    surfaces: usize,
    deformable: usize,
    mut schemes: impl Iterator<Item = &'a Integrator>,
) -> bool {
    !names_pairs && surfaces > 1 && deformable > 0 && schemes.all(Integrator::carries_general_contact)
}
