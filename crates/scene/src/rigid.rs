//! `[[rigid]]`: surface, placement, mass, initial velocity of a rigid body.

use crate::read::{Limit, Node, Table, divisions};
use crate::vector::{cross, dot};
use crate::world::Setting;
use crate::{GROUND, Kind, MeshSource, Rotations};
use stoss_scene_derive::table;

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
#[table(context(Setting<'_>), check = rigid)]
pub struct Rigid {
    /// Name, unique among all parts: letters, digits, `-` and `_`. Sets of its surface are called `name.set`; `name.all` is all of it.
    #[key(example = "\"punch\"", read = joined_name)]
    pub name: String,
    /// Surface: a simple shape with its dimensions.
    pub shape: Option<Shape>,
    /// Surface: the boundary of a mesh from a generator or a file.
    pub mesh: Option<MeshSource>,
    /// Surface: triangles from an STL file.
    pub surface: Option<SurfaceFile>,
    /// Translation, after the rotation (a length each).
    #[key(default, dimension = Length)]
    pub position: [f64; 3],
    /// Rotation, or a list of rotations that are applied one after the other; none if left out.
    #[key(default, skip)]
    pub rotation: Rotations,
    /// Density (mass per volume), positive; needs a closed surface. Mass, centre of mass and inertia follow from the volume.
    #[key(dimension = Density, with = density)]
    pub density: Option<f64>,
    /// Mass, positive, instead of `density`. In dynamic scenes with `euler` or `inertia`.
    #[key(dimension = Mass, by = |node, setting| setting.mass_value(node))]
    pub mass: Option<f64>,
    /// Principal values `E_i = int rho x_i^2 dV` of the Euler tensor about the centre of mass (mass times length^2), positive.
    #[key(dimension = MomentOfInertia, positive)]
    pub euler: Option<[f64; 3]>,
    /// Principal moments of inertia `I_i = E_j + E_k` about the centre of mass (mass times length^2), positive, each less than the sum of the other two.
    #[key(dimension = MomentOfInertia, read = principal_moments)]
    pub inertia: Option<[f64; 3]>,
    /// Centre of mass in space, the body being placed. With `mass` only; if left out the middle of the box around the
    /// surface, or `position` if there is no surface.
    #[key(dimension = Length)]
    pub centre: Option<[f64; 3]>,
    /// Principal axes in space, after placement: three unit vectors, perpendicular and right-handed to 1e-6. With `mass` only; if left out
    /// the axes x, y, z rotated by `rotation`.
    #[key(dimension = Number, read = principal_axes)]
    pub axes: Option<[[f64; 3]; 3]>,
    /// Initial velocity of the centre of mass (length per time); zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = Velocity)]
    pub velocity: [f64; 3],
    /// Initial angular velocity about the centre of mass (radians per time); zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = AngularVelocity)]
    pub angular_velocity: [f64; 3],
    /// Coefficient of restitution in contacts that give none themselves, from 0 (plastic) to 1; of two rigid bodies the larger one counts. 0 if left out. Dynamic scenes only.
    #[key(dimension = Number, with = restitution)]
    pub restitution: Option<f64>,
    /// `true`: the body does not move, and needs no mass. `false` if left out.
    #[key(default, skip)]
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
/// A variant with its parameters here, its arm in the facade.
#[table(tag = "kind", example = "{ kind = \"sphere\", radius = 1.0, divisions = 8 }")]
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
    /// True if it encloses a volume.
    pub fn is_closed(&self) -> bool {
        !matches!(self, Self::Plane(_))
    }
}

/// Parameters of the shape `sphere`.
#[table]
pub struct SphereShape {
    /// Radius.
    #[key(dimension = Length, example = "1.0", positive)]
    pub radius: f64,
    /// Number of facets along an edge of the cubed sphere, which has `6 n^2` facets.
    #[key(example = "8", read = sphere_divisions)]
    pub divisions: u32,
}

/// Parameters of the shape `box`.
#[table]
pub struct BoxShape {
    /// Edge lengths along x, y, z.
    #[key(dimension = Length, example = "[1, 1, 1]", positive)]
    pub size: [f64; 3],
    /// Numbers of facets along x, y, z.
    #[key(default = [1; 3], read = |node| divisions(node, [1; 3], |[x, y, z]| 2.0 * (x * y + y * z + z * x), FACETS))]
    pub divisions: [u32; 3],
}

/// Parameters of the shape `cylinder`.
#[table]
pub struct CylinderShape {
    /// Radius.
    #[key(dimension = Length, example = "0.5", positive)]
    pub radius: f64,
    /// Length along z.
    #[key(dimension = Length, example = "1.0", positive)]
    pub length: f64,
    /// Numbers of facets around the axis (at least 3), along the length, and from the axis to the rim of the ends.
    #[key(example = "[32, 4, 4]", read = round_divisions)]
    pub divisions: [u32; 3],
}

/// Parameters of the shape `cone`.
#[table]
pub struct ConeShape {
    /// Radius of the base.
    #[key(dimension = Length, example = "0.5", positive)]
    pub radius: f64,
    /// Distance between base and tip.
    #[key(dimension = Length, example = "1.0", positive)]
    pub height: f64,
    /// Radius of the flat end of a truncated cone, less than `radius`; 0 (a sharp tip) if left out.
    #[key(default, dimension = Length, with = tip_radius)]
    pub tip_radius: f64,
    /// Numbers of facets around the axis (at least 3), from the tip to the base along the side, and from the axis to the rim of the ends.
    #[key(example = "[32, 4, 4]", read = round_divisions)]
    pub divisions: [u32; 3],
}

/// Parameters of the shape `plane`.
#[table]
pub struct PlaneShape {
    /// Edge lengths along x and y.
    #[key(dimension = Length, example = "[1, 1]", positive)]
    pub size: [f64; 2],
    /// Numbers of facets along x and y.
    #[key(default = [1; 2], read = |node| divisions(node, [1; 2], |[x, y]| x * y, FACETS))]
    pub divisions: [u32; 2],
}

/// A surface of triangles: STL, text or binary.
#[table(example = "{ file = \"tool.stl\" }")]
pub struct SurfaceFile {
    /// Path (`.stl`), relative to the folder of the scene file.
    #[key(example = "\"tool.stl\"", read = surface_file)]
    pub file: String,
    /// Factor on the coordinates before placement, positive; 1 if left out.
    #[key(default = 1.0, dimension = Number, positive)]
    pub scale: f64,
}

/// Keys of the three kinds of surfaces.
pub(crate) const SURFACES: [&str; 3] = ["shape", "mesh", "surface"];
/// What a surface has too many of, if its divisions are a mistake.
const FACETS: Limit = Limit { noun: "facets", most: 2e7 };
const VELOCITIES: [&str; 2] = ["velocity", "angular_velocity"];

/// A name that joints use without a set, which must not be the one of the ground.
pub(crate) fn joined_name(node: &Node<'_>) -> Option<String> {
    let name = node.name()?;
    if name == GROUND {
        return node.fail("is reserved for the ground in joints", "choose another name");
    }
    Some(name)
}

/// Coefficient of restitution, which statics has not.
fn restitution(node: &Node<'_>, setting: &Setting<'_>, _: &RigidKeys) -> Option<f64> {
    if setting.kind == Some(Kind::QuasiStatic) {
        return node.fail("is for dynamic scenes only", "remove it");
    }
    node.restitution()
}

fn density(node: &Node<'_>, setting: &Setting<'_>, keys: &RigidKeys) -> Option<f64> {
    let value = setting.mass_value(node)?;
    match keys.volume() {
        Volume::None => node.fail(
            "needs a volume, and the body has no surface",
            "give `mass` and `inertia` instead, or a `shape`, `mesh` or `surface`",
        ),
        Volume::Open => node.fail("needs a volume, and a plane has none", "give `mass` and `inertia` instead"),
        Volume::Closed => Some(value),
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Volume {
    /// A body without a surface.
    None,
    /// A body whose surface is not closed.
    Open,
    Closed,
}

impl RigidKeys {
    /// What its surface encloses; a wrong surface counts as closed.
    fn volume(&self) -> Volume {
        match (&self.shape, &self.mesh, &self.surface) {
            (Some(None), Some(None), Some(None)) => Volume::None,
            (Some(Some(shape)), ..) if !shape.is_closed() => Volume::Open,
            _ => Volume::Closed,
        }
    }
}

fn rigid(keys: &RigidKeys, table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
    let given: Vec<&'static str> = SURFACES.into_iter().filter(|&key| table.has(key)).collect();
    let one_surface = match given.as_slice() {
        [first, second, ..] => {
            table.fail(second, format!("`{first}` is given too: a rigid body has one surface"), "remove one of them")
        }
        _ => Some(()),
    };
    let fixed = keys.fixed == Some(true);
    let inertia =
        inertia(table, setting, setting.needs_mass() && keys.fixed == Some(false) && !setting.is_held, keys.volume());
    let mut at_rest = setting.at_rest(table, &VELOCITIES);
    if fixed && setting.kind != Some(Kind::QuasiStatic) {
        for key in VELOCITIES.into_iter().filter(|&key| table.has(key)) {
            at_rest = table.fail(key, "a fixed body has no velocity", "remove it, or `fixed`");
        }
    }
    one_surface?;
    at_rest?;
    inertia
}

fn inertia(table: &Table<'_>, setting: &Setting<'_>, needs_mass: bool, volume: Volume) -> Option<()> {
    let with_mass = ["euler", "inertia", "centre", "axes"].into_iter().find(|&key| table.has(key));
    match (table.has("density"), table.has("mass"), with_mass) {
        (true, true, _) => {
            return table.fail("mass", "follows from `density`", "remove one of them");
        }
        (true, false, Some(key)) if volume == Volume::Closed => {
            return table.fail(key, "follows from `density`", "remove it, or give `mass` in place of `density`");
        }
        (false, false, _) if needs_mass => {
            let (key, example) = match volume {
                Volume::Closed => ("density", "density = 7850.0"),
                _ => ("mass", "mass = 1.0"),
            };
            return setting.missing_mass(table, key, example);
        }
        (false, false, Some(key)) => {
            return table.fail(key, "has no effect without `mass`", "remove it, or add the mass");
        }
        _ => {}
    }
    if table.has("euler") && table.has("inertia") {
        return table.fail("inertia", "follows from `euler`", "remove one of them");
    }
    if table.has("mass") && with_mass.is_none_or(|key| key != "euler" && key != "inertia") && needs_mass {
        // In statics there is no rotary inertia.
        if setting.kind == Some(Kind::Dynamic) {
            return table.missing("inertia", "inertia = [0.1, 0.1, 0.1]` or `euler = [0.05, 0.05, 0.05]");
        }
    }
    Some(())
}

fn principal_moments(node: &Node<'_>) -> Option<[f64; 3]> {
    let moments: [f64; 3] = node.array(Node::positive)?;
    let euler = euler_from_inertia(moments);
    if let Some(i) = (0..3).find(|&i| euler[i] <= 0.0) {
        let [j, k] = [moments[(i + 1) % 3], moments[(i + 2) % 3]];
        return node.fail(
            format!("entry {} must be below the sum of the other two, {}", i + 1, j + k),
            "no body has such moments of inertia: correct them",
        );
    }
    Some(moments)
}

fn principal_axes(node: &Node<'_>) -> Option<[[f64; 3]; 3]> {
    let axes: [[f64; 3]; 3] = node.array(Node::direction)?;
    for i in 0..3 {
        for j in 0..=i {
            let expected = if i == j { 1.0 } else { 0.0 };
            let product = dot(axes[i], axes[j]);
            if (product - expected).abs() > 1e-6 {
                let message = if i == j {
                    format!("entry {} is not a unit vector: its square is {product}", i + 1)
                } else {
                    format!("entries {} and {} are not perpendicular: their product is {product}", j + 1, i + 1)
                };
                return node.fail(message, "give three perpendicular unit vectors, to 1e-6");
            }
        }
    }
    if dot(cross(axes[0], axes[1]), axes[2]) < 0.0 {
        return node.fail("is left-handed", "reverse one of the axes");
    }
    Some(axes)
}

fn surface_file(node: &Node<'_>) -> Option<String> {
    let file = node.text()?;
    if !file.to_lowercase().ends_with(".stl") {
        return node.fail("is not a known surface format", "use an STL file (.stl)");
    }
    Some(file)
}

fn sphere_divisions(node: &Node<'_>) -> Option<u32> {
    let count = node.count()?;
    FACETS.keep(node, 6.0 * f64::from(count).powi(2))?;
    Some(count)
}

/// Facets around the axis, along the side, and from the axis to the edge of both ends.
fn round_divisions(node: &Node<'_>) -> Option<[u32; 3]> {
    divisions(node, [3, 1, 1], |[around, along, radial]| around * (along + 2.0 * radial), FACETS)
}

fn tip_radius<C>(node: &Node<'_>, _: &C, keys: &ConeShapeKeys) -> Option<f64> {
    let tip = node.not_negative()?;
    match keys.radius {
        Some(radius) if tip >= radius => node.fail(
            format!("must be below the radius of the base, {radius}"),
            "reduce it, or take the shape \"cylinder\"",
        ),
        _ => Some(tip),
    }
}
