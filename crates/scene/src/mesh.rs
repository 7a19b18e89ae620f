//! Mesh of a body: a generator with parameters, or a file.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A generator with its parameters, or a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
#[allow(
    clippy::large_enum_variant,
    reason = "a scene has a handful of meshes; a box would only be in the way of matching"
)]
pub enum MeshSource {
    /// `{ file = "part.msh" }`.
    File(MeshFile),
    /// `{ generator = "block", ... }`.
    Generator(Generator),
}

/// A mesh from a file: Gmsh MSH 2.2 or 4.1 (`.msh`), Abaqus (`.inp`) or VTK (`.vtu`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Path, relative to the folder of the scene file.
    pub file: String,
    /// Group of elements that forms the body: a physical volume of Gmsh, an instance or element set of Abaqus, `array=value` of a VTU
    /// file. Sets are restricted to it. The whole file if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// Factor on the coordinates, for instance to convert the unit of length; positive, 1 if left out.
    #[serde(default = "MeshFile::default_scale")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub scale: f64,
}

impl MeshFile {
    pub(crate) fn default_scale() -> f64 {
        1.0
    }
}

/// Mesh generators. Lengths are positive, divisions are numbers of elements and at least 1.
///
/// # How to add one
/// A variant here, its reading in `read/mesh.rs` (the exhaustive name list there is the one that errors print), its arm in the
/// facade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "generator", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Generator {
    /// An axis-parallel box, given either by `size` (then its centre is the origin) or by `min` and `max`.
    /// Sets: `left`, `right` (x), `front`, `back` (y), `bottom`, `top` (z).
    Block(Block),
    /// A hollow ball about the origin, a cubed sphere. Sets: `outer`, `inner`.
    HollowBall(HollowBall),
    /// A hollow torus about the z-axis. Sets: `outer`, `inner`.
    HollowTorus(HollowTorus),
    /// A block with eight given corners. Sets as for `block`, by the natural directions.
    Hexahedron(Hexahedron),
    /// A block with a spherical bottom that touches z = 0 on its axis. Sets as for `block`.
    Indenter(Indenter),
    /// A solid ball about the origin, or a part of it, of hexahedra without degenerate ones. Sets: `outer`; of a part also `top` (z = 0), `left`
    /// (x = 0), `front` (y = 0).
    Ball(Ball),
    /// A solid cylinder about the y-axis, from y = 0, or a part of it. Sets: `outer`, `front`, `back` (y); of a part also `top` (z = 0), `left`
    /// (x = 0).
    Cylinder(Cylinder),
    /// A rectangle of the x-y plane, for scenes with a `section`. Sets: `left`, `right` (x), `bottom`, `top` (y).
    Rectangle(Rectangle),
    /// A disc of the x-y plane about the origin, or a part of it, for scenes with a `section`. Sets: `outer`; of a part also `top` (y = 0), `left` (x = 0).
    Disc(Disc),
    /// An L in the x-y plane, its outer corner at the origin. Sets: `left`, `front`, `bottom`, `top`, `end-x`, `end-y`, `notch`.
    LShape(LShape),
}

impl Generator {
    /// Names of all generators.
    pub const NAMES: &'static [&'static str] = &[
        "block",
        "hollow-ball",
        "hollow-torus",
        "hexahedron",
        "indenter",
        "ball",
        "cylinder",
        "rectangle",
        "disc",
        "l-shape",
    ];

    /// Whether the mesh is plane, for scenes with a `section`.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Rectangle(_) | Self::Disc(_))
    }
}

fn uniform_2() -> [f64; 2] {
    [1.0; 2]
}

fn uniform() -> [f64; 3] {
    [1.0; 3]
}

/// Parameters of the generator `block`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Edge lengths along x, y, z of a box with its centre at the origin. Either this, or `min` and `max`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub size: Option<[f64; 3]>,
    /// Smallest coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub min: Option<[f64; 3]>,
    /// Largest coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub max: Option<[f64; 3]>,
    /// Numbers of elements along x, y, z.
    pub divisions: [usize; 3],
    /// Grading along each axis: the size of the last element over that of the first, in geometric progression, from 1e-6 to 1e6; 1 if left out.
    #[serde(default = "uniform")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub grading: [f64; 3],
}

impl Block {
    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        match (self.size, self.min, self.max) {
            (_, Some(min), Some(max)) => (min, max),
            (size, _, _) => {
                let size = size.unwrap_or_default();
                (size.map(|l| -0.5 * l), size.map(|l| 0.5 * l))
            }
        }
    }
}

/// Parameters of the generator `hollow-ball`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HollowBall {
    /// Diameter of the hole.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub inner_diameter: f64,
    /// Outer diameter, larger than the inner one.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub outer_diameter: f64,
    /// Numbers of elements along an edge of the cubed sphere, and through the wall: `6 n^2 layers` elements.
    pub divisions: [usize; 2],
}

/// Parameters of the generator `hollow-torus`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HollowTorus {
    /// Radius of the circle through the middle of the tube.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub ring_radius: f64,
    /// Outer radius of the tube, smaller than the ring's radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub tube_outer_radius: f64,
    /// Inner radius of the tube, smaller than its outer one.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub tube_inner_radius: f64,
    /// Numbers of elements along the ring (at least 3), around the tube (at least 3), and through the wall.
    pub divisions: [usize; 3],
}

/// Parameters of the generator `hexahedron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Hexahedron {
    /// The eight corners: the bottom counter-clockwise seen from the top, then the top.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub corners: [[f64; 3]; 8],
    /// Numbers of elements along the natural directions.
    pub divisions: [usize; 3],
    /// Grading along each direction, as for `block`.
    #[serde(default = "uniform")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub grading: [f64; 3],
}

/// Parameters of the generator `indenter`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Indenter {
    /// Widths along x and y; the axis is in the middle.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub size: [f64; 2],
    /// Height of the plane top over the lowest point.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub height: f64,
    /// Radius of the bottom.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Numbers of elements along x, y, z.
    pub divisions: [usize; 3],
    /// Grading along each direction, as for `block`.
    #[serde(default = "uniform")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub grading: [f64; 3],
}

named! {
    /// Part of a round body that is meshed; the cut surfaces are symmetry planes.
    Part {
        /// The whole body.
        Full = "full",
        /// z <= 0.
        Half = "half",
        /// z <= 0, x >= 0.
        Quarter = "quarter",
        /// z <= 0, x >= 0, y >= 0; of a ball only.
        Eighth = "eighth",
    }
}

/// Finer mesh around the lowest point (or line) of a round body, for contact there: elements of equal size within `half_width`, growing
/// in geometric progression beyond it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Distance from the lowest point, along the surface, over which the elements have equal size.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub half_width: f64,
    /// Number of elements over this distance, less than the first of the `divisions`.
    pub elements: usize,
}

/// Parameters of the generator `ball`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Part that is meshed: `full` if left out.
    #[serde(default = "Part::default_part")]
    pub part: Part,
    /// Numbers of elements of an eighth: horizontally (x and y), vertically (z), and from the cube in the middle to the surface.
    pub divisions: [usize; 3],
    /// A finer mesh at the lowest point; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<Refinement>,
}

/// Parameters of the generator `cylinder`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Length along y.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub length: f64,
    /// Part that is meshed: `full` if left out; not `eighth`.
    #[serde(default = "Part::default_part")]
    pub part: Part,
    /// Numbers of elements of a quarter: horizontally (x), vertically (z), from the square in the middle to the surface, and along y.
    pub divisions: [usize; 4],
    /// A finer mesh at the lowest line; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<Refinement>,
}

/// Parameters of the generator `rectangle`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rectangle {
    /// Smallest coordinates x and y.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub min: [f64; 2],
    /// Largest coordinates.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub max: [f64; 2],
    /// Numbers of elements along x and y.
    pub divisions: [usize; 2],
    /// Grading along each axis, as for `block`.
    #[serde(default = "uniform_2")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub grading: [f64; 2],
}

/// Parameters of the generator `disc`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Radius.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub radius: f64,
    /// Part that is meshed, with y for z: `full` if left out; `half` (y <= 0), `quarter` (also x >= 0).
    #[serde(default = "Part::default_part")]
    pub part: Part,
    /// Numbers of elements of a quarter: along x, along y, from the square in the middle to the rim.
    pub divisions: [usize; 3],
    /// A finer mesh at the lowest point; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<Refinement>,
}

impl Part {
    pub(crate) fn default_part() -> Self {
        Self::Full
    }
}

/// Parameters of the generator `l-shape`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LShape {
    /// Outer lengths of the arms along x and y, larger than the width.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub length: [f64; 2],
    /// Width of both arms in the plane.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub width: f64,
    /// Thickness along z.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub thickness: f64,
    /// Elements along the x-arm beyond the corner, along the y-arm beyond the corner, across the width, through the
    /// thickness.
    pub divisions: [usize; 4],
}
