//! Reads `[[rigid]]`.

use super::body::rotations;
use super::conditions::restitution;
use super::mesh;
use super::node::Node;
use super::table::Table;
use super::world::Setting;
use crate::rigid::euler_from_inertia;
use crate::vector::{cross, dot};
use crate::{
    BoxShape, ConeShape, CylinderShape, GROUND, Kind, PlaneShape, Rigid, Rotations, Shape, SphereShape, SurfaceFile,
};

/// Keys of the three kinds of surfaces.
pub(super) const SURFACES: [&str; 3] = ["shape", "mesh", "surface"];
/// More facets in one shape than this are a mistake in `divisions`.
const MAX_FACETS: f64 = 2e7;

/// The rigid body and its name, which is needed even if the rest is bad. `held`: its motion is prescribed from the first step to the last one.
pub(super) fn rigid(table: &Table<'_>, setting: Setting, held: bool) -> (Option<Rigid>, Option<String>) {
    let name = table.required("name", "name = \"punch\"", joined_name);
    let shape = table.optional("shape", shape);
    let mesh = table.optional("mesh", mesh::mesh);
    let surface = table.optional("surface", surface_file);
    let given: Vec<&'static str> = SURFACES.into_iter().filter(|&key| table.has(key)).collect();
    let one_surface = match given.as_slice() {
        [] | [_] => Some(()),
        [first, second, ..] => {
            table.fail(second, format!("`{first}` is given too: a rigid body has one surface"), "remove one of them")
        }
    };
    let position = table.default("position", [0.0; 3], Node::vector);
    let rotation = table.default("rotation", Rotations::default(), rotations);
    let fixed = table.default("fixed", false, Node::boolean);
    let restitution = table.optional("restitution", |n| {
        if setting.kind == Some(Kind::QuasiStatic) {
            return n.fail("is for dynamic scenes only", "remove it");
        }
        restitution(n)
    });
    let volume = match (given.is_empty(), &shape) {
        (true, _) => Volume::None,
        (false, Some(Some(shape))) if !shape.is_closed() => Volume::Open,
        _ => Volume::Closed,
    };
    let needs_mass = setting.needs_mass() && fixed == Some(false) && !held;
    let inertia = inertia(table, setting, needs_mass, volume);
    let velocity = table.default("velocity", [0.0; 3], Node::vector);
    let angular_velocity = table.default("angular_velocity", [0.0; 3], Node::vector);
    let mut at_rest = setting.at_rest(table, &VELOCITIES);
    if fixed == Some(true) && setting.kind != Some(Kind::QuasiStatic) {
        for key in VELOCITIES.into_iter().filter(|&key| table.has(key)) {
            at_rest = table.fail(key, "a fixed body has no velocity", "remove it, or `fixed`");
        }
    }
    table.finish();
    let rigid = (|| {
        at_rest?;
        one_surface?;
        let Inertia { density, mass, euler, inertia, centre, axes } = inertia?;
        Some(Rigid {
            name: name.clone()?,
            shape: shape?,
            mesh: mesh?,
            surface: surface?,
            position: position?,
            rotation: rotation?,
            density,
            mass,
            euler,
            inertia,
            centre,
            axes,
            velocity: velocity?,
            angular_velocity: angular_velocity?,
            restitution: restitution?,
            fixed: fixed?,
        })
    })();
    (rigid, name)
}

const VELOCITIES: [&str; 2] = ["velocity", "angular_velocity"];

/// A name that joints use without a set, which must not be the one of the ground.
pub(super) fn joined_name(node: &Node<'_>) -> Option<String> {
    let name = node.name()?;
    if name == GROUND {
        return node.fail("is reserved for the ground in joints", "choose another name");
    }
    Some(name)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Volume {
    /// A body without a surface.
    None,
    /// A body whose surface is not closed.
    Open,
    Closed,
}

struct Inertia {
    density: Option<f64>,
    mass: Option<f64>,
    euler: Option<[f64; 3]>,
    inertia: Option<[f64; 3]>,
    centre: Option<[f64; 3]>,
    axes: Option<[[f64; 3]; 3]>,
}

fn inertia(table: &Table<'_>, setting: Setting, needs_mass: bool, volume: Volume) -> Option<Inertia> {
    let density = table.optional("density", |n| {
        let value = setting.mass_value(n)?;
        match volume {
            Volume::None => n.fail(
                "needs a volume, and the body has no surface",
                "give `mass` and `inertia` instead, or a `shape`, `mesh` or `surface`",
            ),
            Volume::Open => n.fail("needs a volume, and a plane has none", "give `mass` and `inertia` instead"),
            Volume::Closed => Some(value),
        }
    });
    let mass = table.optional("mass", |n| setting.mass_value(n));
    let euler = table.optional("euler", |n| n.array(Node::positive));
    let moments = table.optional("inertia", principal_moments);
    let centre = table.optional("centre", Node::vector);
    let axes = table.optional("axes", principal_axes);
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
    Some(Inertia { density: density?, mass: mass?, euler: euler?, inertia: moments?, centre: centre?, axes: axes? })
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

fn surface_file(node: &Node<'_>) -> Option<SurfaceFile> {
    let table = node.table_like("{ file = \"tool.stl\" }")?;
    let file = table.required("file", "file = \"tool.stl\"", |n| {
        let file = n.text()?;
        if !file.to_lowercase().ends_with(".stl") {
            return n.fail("is not a known surface format", "use an STL file (.stl)");
        }
        Some(file)
    });
    let scale = table.default("scale", SurfaceFile::default_scale(), Node::positive);
    table.finish();
    Some(SurfaceFile { file: file?, scale: scale? })
}

fn shape(node: &Node<'_>) -> Option<Shape> {
    let table = node.table_like("{ kind = \"sphere\", radius = 1.0, divisions = 8 }")?;
    let reader = table.required("kind", "kind = \"sphere\"", |n| {
        n.choice(Shape::NAMES, |name| match name {
            "sphere" => Some(sphere as fn(&Table<'_>) -> Option<Shape>),
            "box" => Some(cuboid),
            "cylinder" => Some(cylinder),
            "cone" => Some(cone),
            "plane" => Some(plane),
            _ => None,
        })
    });
    // Without a kind it is not known which other keys are right.
    let shape = reader?(&table);
    table.finish();
    shape
}

/// Numbers of facets, each at least its minimum, of which `total` makes a surface.
fn divisions<const N: usize>(node: &Node<'_>, minima: [u32; N], total: impl Fn([f64; N]) -> f64) -> Option<[u32; N]> {
    let counts: [u32; N] = node.array(Node::count)?;
    if let Some(i) = (0..N).find(|&i| counts[i] < minima[i]) {
        return node.fail(format!("entry {} must be at least {}", i + 1, minima[i]), "use more divisions");
    }
    facets(node, total(counts.map(f64::from)))?;
    Some(counts)
}

fn facets(node: &Node<'_>, facets: f64) -> Option<()> {
    if facets > MAX_FACETS {
        return node.fail(format!("gives {facets:.1e} facets"), format!("at most {MAX_FACETS:.0e} are possible"));
    }
    Some(())
}

fn sphere(table: &Table<'_>) -> Option<Shape> {
    let radius = table.required("radius", "radius = 1.0", Node::positive);
    let divisions = table.required("divisions", "divisions = 8", |n| {
        let count = n.count()?;
        facets(n, 6.0 * f64::from(count).powi(2))?;
        Some(count)
    });
    Some(Shape::Sphere(SphereShape { radius: radius?, divisions: divisions? }))
}

fn cuboid(table: &Table<'_>) -> Option<Shape> {
    let size = table.required("size", "size = [1, 1, 1]", |n| n.array(Node::positive));
    let divisions = table.default("divisions", BoxShape::default_divisions(), |n| {
        divisions(n, [1; 3], |[x, y, z]| 2.0 * (x * y + y * z + z * x))
    });
    Some(Shape::Box(BoxShape { size: size?, divisions: divisions? }))
}

/// Facets around the axis, along the side, and from the axis to the edge of the `ends`.
fn round_divisions(table: &Table<'_>, ends: f64) -> Option<[u32; 3]> {
    table.required("divisions", "divisions = [32, 4, 4]", |n| {
        divisions(n, [3, 1, 1], |[around, along, radial]| around * (along + ends * radial))
    })
}

fn cylinder(table: &Table<'_>) -> Option<Shape> {
    let radius = table.required("radius", "radius = 0.5", Node::positive);
    let length = table.required("length", "length = 1.0", Node::positive);
    let divisions = round_divisions(table, 2.0);
    Some(Shape::Cylinder(CylinderShape { radius: radius?, length: length?, divisions: divisions? }))
}

fn cone(table: &Table<'_>) -> Option<Shape> {
    let radius = table.required("radius", "radius = 0.5", Node::positive);
    let height = table.required("height", "height = 1.0", Node::positive);
    let tip_radius = table.default("tip_radius", 0.0, |n| {
        let tip = n.not_negative()?;
        match radius {
            Some(radius) if tip >= radius => n.fail(
                format!("must be below the radius of the base, {radius}"),
                "reduce it, or take the shape \"cylinder\"",
            ),
            _ => Some(tip),
        }
    });
    let divisions = round_divisions(table, 2.0);
    Some(Shape::Cone(ConeShape { radius: radius?, height: height?, tip_radius: tip_radius?, divisions: divisions? }))
}

fn plane(table: &Table<'_>) -> Option<Shape> {
    let size = table.required("size", "size = [1, 1]", |n| n.array(Node::positive));
    let divisions =
        table.default("divisions", PlaneShape::default_divisions(), |n| divisions(n, [1; 2], |[x, y]| x * y));
    Some(Shape::Plane(PlaneShape { size: size?, divisions: divisions? }))
}
