//! `[[string]]` and `[[mass]]`.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::body::{Mass, is_default};
use crate::vector::{norm, sub};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[string]]`: an elastic string (cable), with axial stiffness only.
///
/// ```toml
/// [[string]]
/// name = "rope"
/// from = [0, 0, 0]
/// to = [3, 0, 0]
/// elements = 20
/// axial = 1.0e4
/// mass = 0.2
/// natural_length = 2.9
/// ```
///
/// Sets: `start`, `end`, `all`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ElasticString {
    /// Name, unique among all parts: letters, digits, `-` and `_`.
    pub name: String,
    /// Vertices of the initial polygon, two or more. Either these, or `from` and `to`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub points: Vec<[f64; 3]>,
    /// Start of a straight string.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub from: Option<[f64; 3]>,
    /// End of a straight string.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub to: Option<[f64; 3]>,
    /// Number of elements over the whole length, distributed over the straight pieces by their lengths; at least one for each piece.
    pub elements: u32,
    /// Polynomial degree of the shape functions: 1, 2 or 3; 1 if left out.
    #[serde(default = "ElasticString::default_order")]
    pub order: u32,
    /// Axial stiffness `E A` (force), positive. Either this, or `young` and `area`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Force)))]
    pub axial: Option<f64>,
    /// Young's modulus (stress), positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub young: Option<f64>,
    /// Area of the cross-section (length^2), positive; for `young` and `density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Area)))]
    pub area: Option<f64>,
    /// Mass per unstretched length. Either this, or `density` and `area`; one of them is positive and required in dynamic scenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::LineDensity)))]
    pub mass: Option<f64>,
    /// Density: mass per unstretched volume.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Density)))]
    pub density: Option<f64>,
    /// Mass matrix: `lumped` if left out, or `consistent`. With the latter what stops a node jerks its neighbours: a rope that falls on a floor is pulled down by it.
    #[serde(default = "ElasticString::default_mass_matrix")]
    pub mass_matrix: Mass,
    /// Unstretched length of the whole string, positive; the length of the polygon if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub natural_length: Option<f64>,
    /// `true`: the string goes slack, without force in compression. `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
    /// Initial velocity of the whole string (length per time); zero if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub velocity: [f64; 3],
}

impl ElasticString {
    /// The mass matrix if none is given.
    pub const DEFAULT_MASS_MATRIX: Mass = Mass::Lumped;

    fn default_mass_matrix() -> Mass {
        Self::DEFAULT_MASS_MATRIX
    }

    /// Linear elements.
    pub const DEFAULT_ORDER: u32 = 1;

    fn default_order() -> u32 {
        Self::DEFAULT_ORDER
    }

    /// Vertices of the initial polygon: `points`, or `from` and `to`.
    pub fn corners(&self) -> Vec<[f64; 3]> {
        match (self.from, self.to) {
            (Some(from), Some(to)) => vec![from, to],
            _ => self.points.clone(),
        }
    }

    /// Natural length: as given, or that of the polygon.
    pub fn natural_length(&self) -> f64 {
        let polygon = || self.corners().windows(2).map(|ends| norm(sub(ends[1], ends[0]))).sum();
        self.natural_length.unwrap_or_else(polygon)
    }

    /// Axial stiffness `E A`.
    pub fn axial_stiffness(&self) -> f64 {
        self.axial.unwrap_or_else(|| self.young.unwrap_or_default() * self.area.unwrap_or_default())
    }

    /// Mass per natural length, if it has one.
    pub fn mass_per_length(&self) -> Option<f64> {
        self.mass.or_else(|| Some(self.density? * self.area?))
    }
}

/// `[[mass]]`: a point mass, without rotation.
///
/// ```toml
/// [[mass]]
/// name = "bob"
/// at = [0, 0, -1]
/// mass = 0.5
/// velocity = [1, 0, 0]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PointMass {
    /// Name, unique among all parts: letters, digits, `-` and `_`. It has the set `name.all`.
    pub name: String,
    /// Initial position.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub at: [f64; 3],
    /// Mass, positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Mass)))]
    pub mass: f64,
    /// Initial velocity (length per time); zero if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub velocity: [f64; 3],
}
