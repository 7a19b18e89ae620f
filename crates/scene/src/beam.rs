//! `[[beam]]`: axis, section, material, initial velocity of a beam.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::body::is_default;
use crate::vector::{cross, dot, norm, scaled, sub};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[beam]]`: a geometrically exact beam with axial, shear, bending and torsional stiffness.
///
/// ```toml
/// [[beam]]
/// name = "mast"
/// points = [[0, 0, 0], [0, 0, 2]]
/// elements = 8
/// section = { shape = "rectangle", size = [0.02, 0.05] }
/// young = 2.1e11
/// density = 7850.0
/// up = [1, 0, 0]
/// ```
///
/// The axis is a polygon of `points` or an `arc`. The directors of a section are `d3` along the axis, `d1` (the part of `up` normal to the axis, normalised) and
/// `d2 = d3 x d1`. Sets: `start`, `end`, `all`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Beam {
    /// Name, unique among all parts: letters, digits, `-` and `_`.
    pub name: String,
    /// Vertices of the axis, two or more, joined by straight pieces. Either these, or an `arc`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub points: Vec<[f64; 3]>,
    /// A circular axis, instead of `points`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arc: Option<Arc>,
    /// Number of elements over the whole length, distributed over the straight pieces by their lengths; at least one for each piece.
    pub elements: u32,
    /// Polynomial degree of the shape functions: 1, 2 or 3; 2 if left out.
    #[serde(default = "Beam::default_order")]
    pub order: u32,
    /// Cross-section: a shape with dimensions, or stiffnesses.
    pub section: Section,
    /// Young's modulus (stress), positive; for a section with a `shape`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub young: Option<f64>,
    /// Poisson's ratio, between -1 and 0.5; 0.3 if left out. For a section with a `shape`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub poisson: Option<f64>,
    /// Density (mass per volume), for a section with a `shape`. Positive, and required in dynamic scenes and with gravity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Density)))]
    pub density: Option<f64>,
    /// Shear correction factor `k` of the shear stiffness `k G A`, in (0, 1]; 5/6 if left out. For a section with a `shape`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub shear_factor: Option<f64>,
    /// Torsion constant `J` (length^4) of the torsional stiffness `G J`, positive; that of Saint-Venant torsion if left out. For a section with a `shape`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::SecondMoment)))]
    pub torsion_constant: Option<f64>,
    /// Direction whose part normal to the axis gives `d1`; nowhere parallel to the axis. Not needed for isotropic sections (circles, tubes).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub up: Option<[f64; 3]>,
    /// Initial velocity `v0` (length per time) in `v(X) = v0 + omega x (X - c)`; zero if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub velocity: [f64; 3],
    /// Initial angular velocity `omega` (radians per time) of axis and sections; zero if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::AngularVelocity)))]
    pub angular_velocity: [f64; 3],
    /// Point `c` about which `angular_velocity` acts; the origin if left out.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub velocity_about: [f64; 3],
}

impl Beam {
    /// Quadratic elements.
    pub const DEFAULT_ORDER: u32 = 2;
    /// Poisson's ratio if left out.
    pub const DEFAULT_POISSON: f64 = 0.3;
    /// Shear correction factor if left out.
    pub const DEFAULT_SHEAR_FACTOR: f64 = 5.0 / 6.0;

    fn default_order() -> u32 {
        Self::DEFAULT_ORDER
    }
}

/// An arc of a circle: from `start` around the axis through `centre`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Arc {
    /// Centre of the circle.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub centre: [f64; 3],
    /// First point; its distance from the centre is the radius, and the vector from the centre is perpendicular to `axis`.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub start: [f64; 3],
    /// Direction of the axis, of any length but zero.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub axis: [f64; 3],
    /// Angle in degrees, positive by the right-hand rule; not zero, at most 360 in magnitude. The ends of a full circle are not joined.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Angle)))]
    pub degrees: f64,
}

impl Arc {
    /// Radius vector of the start and the direction of the axis times it: the point at the angle `phi` is
    /// `centre + cos(phi) e1 + sin(phi) e2`.
    fn basis(&self) -> [[f64; 3]; 2] {
        let e1 = sub(self.start, self.centre);
        let axis = scaled(self.axis, 1.0 / norm(self.axis));
        [e1, cross(axis, e1)]
    }

    /// The fraction of the angle at which the tangent is parallel to `up` to 1e-6, if there is one.
    pub(crate) fn parallel_to(&self, up: [f64; 3]) -> Option<f64> {
        let [e1, e2] = self.basis();
        let radius = norm(e1);
        if dot(up, self.axis).abs() > 1e-6 * norm(up) * norm(self.axis) {
            return None;
        }
        // The tangent `cos e2 - sin e1` is parallel to `up` where tan phi = -(up . e1) / (up . e2): every half turn.
        let first = (-dot(up, e1) / radius).atan2(dot(up, e2) / radius).to_degrees() * self.degrees.signum();
        let angle = self.degrees.abs();
        let first = first.rem_euclid(180.0);
        let first = if first > 180.0 - 1e-4 { 0.0 } else { first };
        (first <= angle + 1e-4).then(|| (first / angle).min(1.0))
    }
}

/// Cross-section of a beam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum Section {
    /// `{ shape = "rectangle", size = [0.02, 0.05] }`
    Shape(SectionShape),
    /// `{ axial = 1e6, shear = [1e5, 1e5], bending = [1e3, 1e3], torsion = 8e2 }`
    Stiffness(SectionStiffness),
}

impl Section {
    /// True if the bending and shear stiffnesses are the same in all directions.
    pub fn is_isotropic(&self) -> bool {
        let same = |[a, b]: [f64; 2]| a == b;
        match self {
            Self::Shape(SectionShape::Rectangle(RectangleSection { size })) => same(*size),
            Self::Shape(_) => true,
            Self::Stiffness(s) => same(s.shear) && same(s.bending) && s.rotary.is_none_or(same),
        }
    }
}

/// Shape of a cross-section. Lengths are positive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SectionShape {
    /// A rectangle.
    Rectangle(RectangleSection),
    /// A full circle.
    Circle(CircleSection),
    /// A circular ring.
    Tube(TubeSection),
}

/// Parameters of the section `rectangle`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RectangleSection {
    /// Width along `d1` and height along `d2` (lengths).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub size: [f64; 2],
}

/// Parameters of the section `circle`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CircleSection {
    /// Radius (length).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
}

/// Parameters of the section `tube`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TubeSection {
    /// Outer radius (length).
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Wall thickness (length), less than the radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub thickness: f64,
}

impl SectionShape {
    /// Names of all shapes.
    pub const NAMES: &'static [&'static str] = &["rectangle", "circle", "tube"];
}

/// Stiffnesses and inertias of a cross-section, constant along the beam. `d1` and `d2` are principal axes through the centroid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SectionStiffness {
    /// Axial stiffness `E A` (force), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Force)))]
    pub axial: f64,
    /// Shear stiffnesses `k G A` along `d1` and `d2` (forces), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Force)))]
    pub shear: [f64; 2],
    /// Bending stiffnesses `E I` about `d1` and `d2` (force times area), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::BendingStiffness)))]
    pub bending: [f64; 2],
    /// Torsional stiffness `G J` (force times area), positive.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::BendingStiffness)))]
    pub torsion: f64,
    /// Mass per length; positive and required in dynamic scenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::LineDensity)))]
    pub mass: Option<f64>,
    /// Rotary inertia per length about `d1` and `d2`: `rho I_1`, `rho I_2` (mass times length), positive; about `d3` it is their sum. Required in dynamic
    /// scenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::RotaryInertia)))]
    pub rotary: Option<[f64; 2]>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_parallel_to_a_direction() {
        for degrees in [-90.0, 90.0, 200.0, 360.0] {
            let arc = Arc { centre: [0.0; 3], start: [2.0, 0.0, 0.0], axis: [0.0, 0.0, 1.0], degrees };
            assert_eq!(arc.parallel_to([0.1, 0.0, 1.0]), None);
            for k in 0..36 {
                let angle = f64::from(k) * 10.0;
                let (sin, cos) = angle.to_radians().sin_cos();
                // Tangents at the angle phi are (-sin phi, cos phi) or against it.
                let way = if degrees > 0.0 { angle } else { -angle };
                let meets = way.rem_euclid(180.0) <= degrees.abs() + 1e-3 || way.rem_euclid(180.0) > 180.0 - 1e-3;
                let found = arc.parallel_to([-3.0 * sin, 3.0 * cos, 0.0]);
                assert_eq!(found.is_some(), meets, "{degrees} {angle}");
                if let Some(fraction) = found {
                    let ([e1, e2], (s, c)) = (arc.basis(), (fraction * degrees).to_radians().sin_cos());
                    let tangent: [f64; 3] = std::array::from_fn(|i| (c * e2[i] - s * e1[i]) / norm(e1));
                    assert!((tangent[0] * cos + tangent[1] * sin).abs() < 1e-6, "{degrees} {angle} {tangent:?}");
                }
            }
        }
    }
}
