//! Mesh of a body: a generator with parameters, or a file.

use crate::names::named;
use crate::read::{Limit, Node, Table, Value, divisions};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use stoss_scene_derive::table;

/// A generator with its parameters, or a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
#[table]
pub struct MeshFile {
    /// Path, relative to the folder of the scene file.
    #[key(example = "\"part.msh\"", read = mesh_file)]
    pub file: String,
    /// Group of elements that forms the body: a physical volume of Gmsh, an instance or element set of Abaqus, `array=value` of a VTU
    /// file. Sets are restricted to it. The whole file if left out.
    pub group: Option<String>,
    /// Factor on the coordinates, for instance to convert the unit of length; positive, 1 if left out.
    #[key(default = 1.0, dimension = Number, positive)]
    pub scale: f64,
}

/// Mesh generators. Lengths are positive, divisions are numbers of elements and at least 1.
///
/// # How to add one
/// A variant here, its arm in the facade.
#[table(tag = "generator")]
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
    /// Whether the mesh is plane, for scenes with a `section`.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Rectangle(_) | Self::Disc(_))
    }
}

/// Parameters of the generator `block`.
#[table(check = block)]
pub struct Block {
    /// Edge lengths along x, y, z of a box with its centre at the origin. Either this, or `min` and `max`.
    #[key(dimension = Length, positive)]
    pub size: Option<[f64; 3]>,
    /// Smallest coordinates.
    #[key(dimension = Length)]
    pub min: Option<[f64; 3]>,
    /// Largest coordinates.
    #[key(dimension = Length)]
    pub max: Option<[f64; 3]>,
    /// Numbers of elements along x, y, z.
    #[key(example = "[4, 4, 4]", read = |node| divisions(node, [1; 3], product, ELEMENTS))]
    pub divisions: [usize; 3],
    /// Grading along each axis: the size of the last element over that of the first, in geometric progression, from 1e-6 to 1e6; 1 if left out.
    #[key(default = [1.0; 3], dimension = Number, with = |node, _, keys| grading(node, keys.divisions))]
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
#[table(check_all = hollow_ball)]
pub struct HollowBall {
    /// Diameter of the hole.
    #[key(dimension = Length, example = "0.8", positive)]
    pub inner_diameter: f64,
    /// Outer diameter, larger than the inner one.
    #[key(dimension = Length, example = "1.0", positive)]
    pub outer_diameter: f64,
    /// Numbers of elements along an edge of the cubed sphere, and through the wall: `6 n^2 layers` elements.
    #[key(example = "[6, 2]", read = |node| divisions(node, [1; 2], |[n, layers]| 6.0 * n * n * layers, ELEMENTS))]
    pub divisions: [usize; 2],
}

/// Parameters of the generator `hollow-torus`.
#[table(check_all = hollow_torus)]
pub struct HollowTorus {
    /// Radius of the circle through the middle of the tube.
    #[key(dimension = Length, example = "38", positive)]
    pub ring_radius: f64,
    /// Outer radius of the tube, smaller than the ring's radius.
    #[key(dimension = Length, example = "12", positive)]
    pub tube_outer_radius: f64,
    /// Inner radius of the tube, smaller than its outer one.
    #[key(dimension = Length, example = "7.5", positive)]
    pub tube_inner_radius: f64,
    /// Numbers of elements along the ring (at least 3), around the tube (at least 3), and through the wall.
    #[key(example = "[78, 20, 2]", read = |node| divisions(node, [3, 3, 1], product, ELEMENTS))]
    pub divisions: [usize; 3],
}

/// Parameters of the generator `hexahedron`.
#[table]
pub struct Hexahedron {
    /// The eight corners: the bottom counter-clockwise seen from the top, then the top.
    #[key(dimension = Length, example = "[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], ...]")]
    pub corners: [[f64; 3]; 8],
    /// Numbers of elements along the natural directions.
    #[key(example = "[1, 1, 1]", read = |node| divisions(node, [1; 3], product, ELEMENTS))]
    pub divisions: [usize; 3],
    /// Grading along each direction, as for `block`.
    #[key(default = [1.0; 3], dimension = Number, with = |node, _, keys| grading(node, keys.divisions))]
    pub grading: [f64; 3],
}

/// Parameters of the generator `indenter`.
#[table(check_all = indenter)]
pub struct Indenter {
    /// Widths along x and y; the axis is in the middle.
    #[key(dimension = Length, example = "[2, 2]", positive)]
    pub size: [f64; 2],
    /// Height of the plane top over the lowest point.
    #[key(dimension = Length, example = "1.5", positive)]
    pub height: f64,
    /// Radius of the bottom.
    #[key(dimension = Length, example = "2", positive)]
    pub radius: f64,
    /// Numbers of elements along x, y, z.
    #[key(example = "[10, 10, 7]", read = |node| divisions(node, [1; 3], product, ELEMENTS))]
    pub divisions: [usize; 3],
    /// Grading along each direction, as for `block`.
    #[key(default = [1.0; 3], dimension = Number, with = |node, _, keys| grading(node, keys.divisions))]
    pub grading: [f64; 3],
}

named! {
    /// Part of a round body that is meshed; the cut surfaces are symmetry planes.
    Portion {
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
#[table]
#[derive(Copy)]
pub struct Refinement {
    /// Distance from the lowest point, along the surface, over which the elements have equal size.
    #[key(dimension = Length, example = "0.03", positive)]
    pub half_width: f64,
    /// Number of elements over this distance, less than the first of the `divisions`.
    #[key(example = "8")]
    pub elements: usize,
}

/// Parameters of the generator `ball`.
#[table]
pub struct Ball {
    /// Radius.
    #[key(dimension = Length, example = "1", positive)]
    pub radius: f64,
    /// Part that is meshed: `full` if left out.
    #[key(default = Portion::Full)]
    pub part: Portion,
    /// Numbers of elements of an eighth: horizontally (x and y), vertically (z), and from the cube in the middle to the surface.
    #[key(example = "[6, 4, 6]", read = |node| divisions(node, [1; 3], ball_elements, ELEMENTS))]
    pub divisions: [usize; 3],
    /// A finer mesh at the lowest point; none if left out.
    #[key(with = |node, _, keys| refinement(node, keys.radius, keys.divisions.map(|d| d[0])))]
    pub refinement: Option<Refinement>,
}

/// Parameters of the generator `cylinder`.
#[table]
pub struct Cylinder {
    /// Radius.
    #[key(dimension = Length, example = "1", positive)]
    pub radius: f64,
    /// Length along y.
    #[key(dimension = Length, example = "1", positive)]
    pub length: f64,
    /// Part that is meshed: `full` if left out; not `eighth`.
    #[key(default = Portion::Full, by = round_part)]
    pub part: Portion,
    /// Numbers of elements of a quarter: horizontally (x), vertically (z), from the square in the middle to the surface, and along y.
    #[key(example = "[6, 4, 6, 1]", read = |node| divisions(node, [1; 4], cylinder_elements, ELEMENTS))]
    pub divisions: [usize; 4],
    /// A finer mesh at the lowest line; none if left out.
    #[key(with = |node, _, keys| refinement(node, keys.radius, keys.divisions.map(|d| d[0])))]
    pub refinement: Option<Refinement>,
}

/// Parameters of the generator `rectangle`.
#[table(check_all = rectangle)]
pub struct Rectangle {
    /// Smallest coordinates x and y.
    #[key(dimension = Length, example = "[0, 0]")]
    pub min: [f64; 2],
    /// Largest coordinates.
    #[key(dimension = Length, example = "[1, 1]")]
    pub max: [f64; 2],
    /// Numbers of elements along x and y.
    #[key(example = "[4, 4]", read = |node| divisions(node, [1; 2], product, ELEMENTS))]
    pub divisions: [usize; 2],
    /// Grading along each axis, as for `block`.
    #[key(default = [1.0; 2], dimension = Number, with = |node, _, keys| grading(node, keys.divisions))]
    pub grading: [f64; 2],
}

/// Parameters of the generator `disc`.
#[table]
pub struct Disc {
    /// Radius.
    #[key(dimension = Length, example = "1", positive)]
    pub radius: f64,
    /// Part that is meshed, with y for z: `full` if left out; `half` (y <= 0), `quarter` (also x >= 0).
    #[key(default = Portion::Full, by = round_part)]
    pub part: Portion,
    /// Numbers of elements of a quarter: along x, along y, from the square in the middle to the rim.
    #[key(example = "[6, 6, 6]", read = |node| divisions(node, [1; 3], |[x, y, out]| 4.0 * (x * y + (x + y) * out), ELEMENTS))]
    pub divisions: [usize; 3],
    /// A finer mesh at the lowest point; none if left out.
    #[key(with = |node, _, keys| refinement(node, keys.radius, keys.divisions.map(|d| d[0])))]
    pub refinement: Option<Refinement>,
}

/// Parameters of the generator `l-shape`.
#[table(check_all = l_shape)]
pub struct LShape {
    /// Outer lengths of the arms along x and y, larger than the width.
    #[key(dimension = Length, example = "[4, 3]", positive)]
    pub length: [f64; 2],
    /// Width of both arms in the plane.
    #[key(dimension = Length, example = "1", positive)]
    pub width: f64,
    /// Thickness along z.
    #[key(dimension = Length, example = "1", positive)]
    pub thickness: f64,
    /// Elements along the x-arm beyond the corner, along the y-arm beyond the corner, across the width, through the
    /// thickness.
    #[key(example = "[3, 2, 1, 1]", read = |node| divisions(node, [1; 4], |[x, y, across, through]| (x + y + across) * across * through, ELEMENTS))]
    pub divisions: [usize; 4],
}

impl<C> Value<C> for MeshSource {
    fn read(node: &Node<'_>, context: &C) -> Option<Self> {
        let table = node.table()?;
        match (table.has("file"), table.get("generator")) {
            (true, Some(generator)) => generator.fail("a mesh has either a generator or a file", "remove one of them"),
            (false, None) => table.missing("generator", "generator = \"block\"` or `file = \"part.msh\""),
            (true, None) => MeshFile::from_table(&table, context).map(Self::File),
            (false, Some(_)) => Generator::from_table(&table, context).map(Self::Generator),
        }
    }
}

/// What a mesh has too many of, if its divisions are a mistake.
const ELEMENTS: Limit = Limit { noun: "elements", most: 2e7 };

fn mesh_file(node: &Node<'_>) -> Option<String> {
    let file = node.text()?;
    let lower = file.to_lowercase();
    if ![".msh", ".inp", ".vtu"].iter().any(|extension| lower.ends_with(extension)) {
        return node.fail("is not a known mesh format", "use a Gmsh (.msh), Abaqus (.inp) or VTK (.vtu) file");
    }
    Some(file)
}

fn product<const N: usize>(counts: [f64; N]) -> f64 {
    counts.iter().product()
}

fn ball_elements([across, up, out]: [f64; 3]) -> f64 {
    8.0 * (across * across * up + (across * across + 2.0 * across * up) * out)
}

fn cylinder_elements([across, up, out, along]: [f64; 4]) -> f64 {
    4.0 * (across * up + (across + up) * out) * along
}

/// Gradings, 1 where there is a single element.
fn grading<const N: usize>(node: &Node<'_>, divisions: Option<[usize; N]>) -> Option<[f64; N]> {
    let grading: [f64; N] = node.array(|n| {
        let value = n.positive()?;
        if !(1e-6..=1e6).contains(&value) {
            return n.fail("must lie between 1e-6 and 1e6", "choose a weaker grading");
        }
        Some(value)
    })?;
    if let Some(i) = (0..N).find(|&i| grading[i] != 1.0 && divisions.is_some_and(|d| d[i] == 1)) {
        let message = format!("entry {} must be 1 where there is a single element", i + 1);
        return node.fail(message, "set it to 1 or use more divisions");
    }
    Some(grading)
}

/// A part of what is round in a plane.
fn round_part<C>(node: &Node<'_>, context: &C) -> Option<Portion> {
    let part = Portion::read(node, context)?;
    if part == Portion::Eighth {
        return node.fail("is a part of a ball only", "choose \"quarter\", \"half\" or \"full\"");
    }
    Some(part)
}

/// Refinement of a round body with this radius and this first entry of the divisions.
fn refinement(node: &Node<'_>, radius: Option<f64>, across: Option<usize>) -> Option<Refinement> {
    let table = node.table()?;
    let refinement = Refinement::from_table(&table, &())?;
    if let Some(arc) = radius.map(|r| std::f64::consts::FRAC_PI_4 * r)
        && refinement.half_width >= arc
    {
        let message = format!("must be smaller than an eighth of the circle, {arc}");
        return table.fail("half_width", message, "reduce it, or leave out the refinement");
    }
    if let Some(across) = across
        && refinement.elements >= across
    {
        let message = format!("must be below the first of the divisions, {across}");
        return table.fail("elements", message, "reduce it, or use more divisions");
    }
    Some(refinement)
}

fn block<C>(keys: &BlockKeys, table: &Table<'_>, _: &C) -> Option<()> {
    let given = match (table.has("size"), table.has("min"), table.has("max")) {
        (true, false, false) | (false, true, true) => Some(()),
        (false, false, false) => table.missing("size", "size = [1, 1, 1]"),
        (true, _, _) => {
            table.fail("size", "a block has either `size` or `min` and `max`", "remove `size`, or `min` and `max`")
        }
        (false, true, false) => table.missing("max", "max = [1, 1, 1]"),
        (false, false, true) => table.missing("min", "min = [0, 0, 0]"),
    };
    if let (Some(Some(min)), Some(Some(max))) = (keys.min, keys.max) {
        ordered(table, min, max)?;
    }
    given
}

/// Reports corners that do not span a box.
fn ordered<const N: usize>(table: &Table<'_>, min: [f64; N], max: [f64; N]) -> Option<()> {
    if let Some(i) = (0..N).find(|&i| min[i] >= max[i]) {
        let axis = ["x", "y", "z"][i];
        return table.fail("max", format!("must exceed `min` = {min:?} in {axis}"), "exchange or correct the corners");
    }
    Some(())
}

fn rectangle<C>(mesh: &Rectangle, table: &Table<'_>, _: &C) -> Option<()> {
    ordered(table, mesh.min, mesh.max)
}

/// Reports `smaller` unless it is below `larger`.
fn less(table: &Table<'_>, smaller: (&'static str, f64), larger: (&str, f64)) -> Option<()> {
    if smaller.1 >= larger.1 {
        let message = format!("must be smaller than `{}` = {}", larger.0, larger.1);
        return table.fail(smaller.0, message, format!("reduce it or increase `{}`", larger.0));
    }
    Some(())
}

fn hollow_ball<C>(mesh: &HollowBall, table: &Table<'_>, _: &C) -> Option<()> {
    less(table, ("inner_diameter", mesh.inner_diameter), ("outer_diameter", mesh.outer_diameter))
}

fn hollow_torus<C>(mesh: &HollowTorus, table: &Table<'_>, _: &C) -> Option<()> {
    let tube = ("tube_outer_radius", mesh.tube_outer_radius);
    let outer = less(table, tube, ("ring_radius", mesh.ring_radius));
    less(table, ("tube_inner_radius", mesh.tube_inner_radius), tube)?;
    outer
}

fn indenter<C>(mesh: &Indenter, table: &Table<'_>, _: &C) -> Option<()> {
    let corner = 0.5 * (mesh.size[0] * mesh.size[0] + mesh.size[1] * mesh.size[1]).sqrt();
    if mesh.radius <= corner {
        let message = format!("must exceed the distance {corner} of the corners from the axis");
        return table.fail("radius", message, "increase the radius or reduce `size`");
    }
    let rim = mesh.radius - (mesh.radius * mesh.radius - corner * corner).sqrt();
    if mesh.height <= rim {
        let message = format!("must exceed the height {rim} of the bottom's corners");
        return table.fail("height", message, "increase the height or the radius");
    }
    Some(())
}

fn l_shape<C>(mesh: &LShape, table: &Table<'_>, _: &C) -> Option<()> {
    if mesh.length.iter().any(|&l| l <= mesh.width) {
        let message = format!("both lengths must exceed the width {}", mesh.width);
        return table.fail("length", message, "increase the lengths or reduce `width`");
    }
    Some(())
}
