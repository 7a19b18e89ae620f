//! `[[rigid]]`: surface, placement, mass, initial velocity of a rigid body.

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
/// It has at most one of `shape`, `mesh` and `surface`; without any it has no surface, and cannot be in contact. Its mass properties are either
/// those of the enclosed volume with a `density`, or given by `mass` with `euler` or `inertia`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rigid {
    /// Name, unique among all parts: letters, digits, `-` and `_`. Sets of its surface are called `name.set`; `name.all` is all of it.
    pub name: String,
    /// A simple shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// Generator or file of a mesh, of which the boundary is the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshSource>,
    /// A surface of triangles from a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceFile>,
    /// Translation, after the rotation (length).
    #[serde(default)]
    pub position: [f64; 3],
    /// Rotation, or a list of rotations that are done one after the other.
    #[serde(default, skip_serializing_if = "Rotations::is_empty")]
    pub rotation: Rotations,
    /// Mass per volume, positive; needs a closed surface. Mass, centre and inertia are those of the volume.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Mass, positive. In dynamic scenes with `euler` or `inertia`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    /// Principal values `E_i = int rho x_i^2 dV` of the Euler tensor about the centre of mass, positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub euler: Option<[f64; 3]>,
    /// Principal moments of inertia `I_i = E_j + E_k` about the centre of mass, each below the sum of the other two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<[f64; 3]>,
    /// Centre of mass in space, the body being placed. With `mass` only; if left out the middle of the box around the
    /// surface, or `position` if there is no surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// Principal axes in space, the body being placed: three unit vectors, perpendicular and right-handed to 1e-6. With `mass` only; if left out
    /// the axes x, y, z turned by `rotation`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<[[f64; 3]; 3]>,
    /// Initial velocity of the centre of mass. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    pub velocity: [f64; 3],
    /// Initial angular velocity (1/time), about the centre of mass. Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    pub angular_velocity: [f64; 3],
    /// `true`: the body does not move. It needs no mass then.
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

/// A simple shape, for instance `{ kind = "sphere", radius = 1.0, divisions = 8 }`. Lengths are positive, divisions numbers of facets and at least 1.
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
    /// A cone about the z-axis, whole or cut off: its tip in the origin, pointing to -z, its base at z = `height`. Sets: `side`, `base`, and `tip` where it is
    /// cut off.
    Cone(ConeShape),
    /// A rectangle in the plane z = 0 about the origin, whose outside is z > 0. It is not closed: it has no volume.
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
    pub radius: f64,
    /// Facets along an edge of the cubed sphere: `6 n^2` facets.
    pub divisions: u32,
}

/// Parameters of the shape `box`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Edge lengths along x, y, z.
    pub size: [f64; 3],
    /// Facets along x, y, z.
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
    pub radius: f64,
    /// Length along z.
    pub length: f64,
    /// Facets around the axis, at least 3, along the length, and from the axis to the edge of the ends.
    pub divisions: [u32; 3],
}

/// Parameters of the shape `cone`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ConeShape {
    /// Radius of the base.
    pub radius: f64,
    /// Distance of base and tip.
    pub height: f64,
    /// Radius of the flat end where the tip is cut off, below `radius`; 0, a sharp tip, if left out.
    #[serde(default)]
    pub tip_radius: f64,
    /// Facets around the axis, at least 3, from the tip to the base along the side, and from the axis to the edge of the ends.
    pub divisions: [u32; 3],
}

/// Parameters of the shape `plane`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {
    /// Edge lengths along x and y.
    pub size: [f64; 2],
    /// Facets along x and y.
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
    /// Factor of the coordinates, positive, before they are placed.
    #[serde(default = "SurfaceFile::default_scale")]
    pub scale: f64,
}

impl SurfaceFile {
    pub(crate) fn default_scale() -> f64 {
        1.0
    }
}
