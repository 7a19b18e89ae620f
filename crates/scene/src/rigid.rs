//! `[[rigid]]`: surface, placement, mass, initial velocity of a rigid body.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::body::is_default;
use crate::{MeshSource, Rotations};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[rigid]]`: a rigid body.
///
/// ```toml
/// [[rigid]]
/// name = "wheel"
/// shape = { kind = "cylinder", radius = 0.5, length = 0.1, divisions = [32, 1, 4] }
/// density = 7850.0
/// position = [0, 0, 0.5]
/// angular_velocity = [0, 0, 20]
///
/// [[rigid]]
/// name = "top"
/// position = [0, 0, 1]
/// mass = 2.0
/// inertia = [0.04, 0.04, 0.02]
/// angular_velocity = [0, 0, 50]
/// ```
///
/// At most one of `shape`, `mesh` and `surface` is given; without any the body has no surface, and cannot be in contact. Its mass properties either follow
/// from the enclosed volume with a `density`, or are given by `mass` with `euler` or `inertia`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rigid {
    /// Name, unique among all parts: letters, digits, `-` and `_`. Sets of its surface are called `name.set`; `name.all` is all of it.
    pub name: String,
    /// Surface: a simple shape with its dimensions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// Surface: the boundary of a mesh from a generator or a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshSource>,
    /// Surface: triangles from an STL file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceFile>,
    /// Translation, after the rotation (a length each).
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub position: [f64; 3],
    /// Rotation, or a list of rotations that are applied one after the other; none if left out.
    #[serde(default, skip_serializing_if = "Rotations::is_empty")]
    pub rotation: Rotations,
    /// Density (mass per volume), positive; needs a closed surface. Mass, centre of mass and inertia follow from the volume.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Density)))]
    pub density: Option<f64>,
    /// Mass, positive, instead of `density`. In dynamic scenes with `euler` or `inertia`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Mass)))]
    pub mass: Option<f64>,
    /// Principal values `E_i = int rho x_i^2 dV` of the Euler tensor about the centre of mass (mass times length^2), positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::MomentOfInertia)))]
    pub euler: Option<[f64; 3]>,
    /// Principal moments of inertia `I_i = E_j + E_k` about the centre of mass (mass times length^2), positive, each less than the sum of the other two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::MomentOfInertia)))]
    pub inertia: Option<[f64; 3]>,
    /// Centre of mass in space, the body being placed. With `mass` only; if left out the middle of the box around the
    /// surface, or `position` if there is no surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub centre: Option<[f64; 3]>,
    /// Principal axes in space, after placement: three unit vectors, perpendicular and right-handed to 1e-6. With `mass` only; if left out
    /// the axes x, y, z rotated by `rotation`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub axes: Option<[[f64; 3]; 3]>,
    /// Initial velocity of the centre of mass (length per time); zero if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub velocity: [f64; 3],
    /// Initial angular velocity about the centre of mass (radians per time); zero if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::AngularVelocity)))]
    pub angular_velocity: [f64; 3],
    /// Coefficient of restitution in contacts that give none themselves, from 0 (plastic) to 1; of two rigid bodies the larger one counts. 0 if left out. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub restitution: Option<f64>,
    /// `true`: the body does not move, and needs no mass. `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fixed: bool,
}

impl Rigid {
    /// True if it has a shape, a mesh or a surface from a file.
    pub fn has_surface(&self) -> bool {
        self.shape.is_some() || self.mesh.is_some() || self.surface.is_some()
    }

    /// Principal values of the Euler tensor that are given: `euler`, or `E_i = (I_j + I_k - I_i) / 2` from `inertia`.
    pub fn principal_euler(&self) -> Option<[f64; 3]> {
        self.euler.or_else(|| self.inertia.map(euler_from_inertia))
    }
}

/// `E_i = (I_j + I_k - I_i) / 2`.
pub(crate) fn euler_from_inertia(inertia: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| 0.5 * (inertia[(i + 1) % 3] + inertia[(i + 2) % 3] - inertia[i]))
}

/// A simple shape, for instance `{ kind = "sphere", radius = 1.0, divisions = 8 }`. Lengths are positive; divisions are numbers of facets, at least 1.
///
/// # How to add one
/// A variant with its parameters here, its reading in `read/rigid.rs`, its arm in the facade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Shape {
    /// A sphere about the origin.
    Sphere(SphereShape),
    /// An axis-parallel box about the origin. Sets: `left`, `right` (x), `front`, `back` (y), `bottom`, `top` (z).
    Box(BoxShape),
    /// A cylinder about the z-axis, its centre at the origin. Sets: `side`, `bottom`, `top`.
    Cylinder(CylinderShape),
    /// A cone or truncated cone about the z-axis: its tip at the origin pointing to -z, its base at z = `height`. Sets: `side`, `base`, and `tip` of a truncated
    /// cone.
    Cone(ConeShape),
    /// A rectangle in the plane z = 0 about the origin, with the outward normal +z. It encloses no volume.
    Plane(PlaneShape),
}

impl Shape {
    /// Names of all shapes.
    pub const NAMES: &'static [&'static str] = &["sphere", "box", "cylinder", "cone", "plane"];

    /// True if it encloses a volume.
    pub fn is_closed(&self) -> bool {
        !matches!(self, Self::Plane(_))
    }
}

/// Parameters of the shape `sphere`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SphereShape {
    /// Radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Number of facets along an edge of the cubed sphere, which has `6 n^2` facets.
    pub divisions: u32,
}

/// Parameters of the shape `box`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Edge lengths along x, y, z.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub size: [f64; 3],
    /// Numbers of facets along x, y, z.
    #[serde(default = "BoxShape::default_divisions")]
    pub divisions: [u32; 3],
}

impl BoxShape {
    pub(crate) fn default_divisions() -> [u32; 3] {
        [1; 3]
    }
}

/// Parameters of the shape `cylinder`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CylinderShape {
    /// Radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Length along z.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub length: f64,
    /// Numbers of facets around the axis (at least 3), along the length, and from the axis to the rim of the ends.
    pub divisions: [u32; 3],
}

/// Parameters of the shape `cone`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ConeShape {
    /// Radius of the base.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Distance between base and tip.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub height: f64,
    /// Radius of the flat end of a truncated cone, less than `radius`; 0 (a sharp tip) if left out.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub tip_radius: f64,
    /// Numbers of facets around the axis (at least 3), from the tip to the base along the side, and from the axis to the rim of the ends.
    pub divisions: [u32; 3],
}

/// Parameters of the shape `plane`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {
    /// Edge lengths along x and y.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub size: [f64; 2],
    /// Numbers of facets along x and y.
    #[serde(default = "PlaneShape::default_divisions")]
    pub divisions: [u32; 2],
}

impl PlaneShape {
    pub(crate) fn default_divisions() -> [u32; 2] {
        [1; 2]
    }
}

/// A surface of triangles: STL, text or binary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SurfaceFile {
    /// Path (`.stl`), relative to the folder of the scene file.
    pub file: String,
    /// Factor on the coordinates before placement, positive; 1 if left out.
    #[serde(default = "SurfaceFile::default_scale")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub scale: f64,
}

impl SurfaceFile {
    pub(crate) fn default_scale() -> f64 {
        1.0
    }
}
