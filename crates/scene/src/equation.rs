//! `[[equation]]`: linear equations between displacements, multi-point constraints.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::{Component, Series};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[equation]]`: a linear equation between displacements, `sum factor * displacement = value`, at all times. If sets of several nodes are among its terms there is an equation for each node: nodes of
/// different sets belong together that are at the same place relative to the centre of their set.
///
/// ```toml
/// [[equation]]
/// name = "lever"
/// terms = [
///   { set = "left.end", component = "x" },
///   { set = "right.end", component = "x", factor = -2.0 },
/// ]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Equation {
    /// Name, unique as that of a joint.
    pub name: String,
    /// The terms of the sum, at least one.
    pub terms: Vec<EquationTerm>,
    /// Value of the sum (length, times the factors), a constant or a table over time; 0 if left out.
    #[serde(default = "Equation::default_value")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub value: Series,
}

impl Equation {
    pub(crate) fn default_value() -> Series {
        Series::Scalar(0.0)
    }

    /// Whether its value changes with time.
    pub fn moves(&self) -> bool {
        self.value.rows().windows(2).any(|pair| pair[0].get(1) != pair[1].get(1))
    }
}

/// A term of an equation: factor times displacement of nodes along a direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EquationTerm {
    /// Set of nodes, `part.set`; of a rigid body without a surface, and of a point mass, `part.all` is its point. This or `body` and `point`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// Name of a part, with `point`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// A point in the reference configuration after placement (three lengths): the nearest node of `body`, of a rigid body the point itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub point: Option<[f64; 3]>,
    /// Component of the displacement; this or `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub component: Option<Component>,
    /// Direction of the displacement, of any length: its component along the unit vector is taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub direction: Option<[f64; 3]>,
    /// Factor, not zero; 1 if left out.
    #[serde(default = "EquationTerm::default_factor")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub factor: f64,
    /// `true`: the mean displacement of the nodes of the set, by area where it has facets, is one term. `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mean: bool,
}

impl EquationTerm {
    pub(crate) fn default_factor() -> f64 {
        1.0
    }

    /// Factors of the three components.
    pub fn factors(&self) -> [f64; 3] {
        let direction = match (self.direction, self.component) {
            (Some(d), _) => {
                let largest = d.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
                let d = d.map(|x| x / largest);
                let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
                d.map(|x| x / size)
            }
            (None, Some(component)) => std::array::from_fn(|i| f64::from(u8::from(i == component.index()))),
            (None, None) => [0.0; 3],
        };
        direction.map(|d| self.factor * d)
    }
}
