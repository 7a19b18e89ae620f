//! Reads `[[beam]]`, and the axes of beams and strings.

use super::catalogue::poisson;
use super::node::Node;
use super::table::Table;
use super::world::Setting;
use crate::vector::{dot, norm, parallel, perpendicular, scaled, sub};
use crate::{Arc, Beam, CircleSection, Kind, RectangleSection, Section, SectionShape, SectionStiffness, TubeSection};

const VELOCITIES: [&str; 3] = ["velocity", "angular_velocity", "velocity_about"];
/// More elements in one beam or string than this are a mistake.
const MAX_ELEMENTS: u64 = 10_000_000;

/// The beam and its name, which is needed even if the rest is bad.
pub(super) fn beam(table: &Table<'_>, setting: Setting) -> (Option<Beam>, Option<String>) {
    let name = table.required("name", "name = \"mast\"", Node::name);
    let points = table.optional("points", points);
    let arc = table.optional("arc", arc);
    let axis = match (table.has("points"), table.has("arc")) {
        (true, true) => table.fail("arc", "`points` are given too", "remove one of them"),
        (false, false) => table.missing("points", "points = [[0, 0, 0], [1, 0, 0]]"),
        _ => Some(()),
    };
    let pieces = points.as_ref().and_then(|points| points.as_ref()).map(Vec::len);
    let elements = elements(table, pieces);
    let order = order(table, Beam::DEFAULT_ORDER);
    let section = table.required("section", "section = { shape = \"circle\", radius = 0.01 }", |n| section(n, setting));
    let stiffness = matches!(section, Some(Section::Stiffness(_)));
    let material = match section {
        // Without a section it is not known which other keys are right.
        None => Material::skipped(table),
        Some(_) if stiffness => Material::refused(table),
        Some(_) => Material::read(table, setting),
    };
    let up = up(table, section.as_ref(), points.as_ref(), arc.as_ref());
    let velocity = table.default("velocity", [0.0; 3], Node::vector);
    let angular_velocity = table.default("angular_velocity", [0.0; 3], Node::vector);
    let velocity_about = table.default("velocity_about", [0.0; 3], Node::vector);
    let at_rest = setting.at_rest(table, &VELOCITIES);
    table.finish();
    let beam = (|| {
        axis?;
        at_rest?;
        let material = material?;
        Some(Beam {
            name: name.clone()?,
            points: points?.unwrap_or_default(),
            arc: arc?,
            elements: elements?,
            order: order?,
            section: section?,
            young: material.young,
            poisson: material.poisson,
            density: material.density,
            shear_factor: material.shear_factor,
            torsion_constant: material.torsion_constant,
            up: up?,
            velocity: velocity?,
            angular_velocity: angular_velocity?,
            velocity_about: velocity_about?,
        })
    })();
    (beam, name)
}

/// Two or more points, no two neighbours the same, none at which the way turns back.
pub(super) fn points(node: &Node<'_>) -> Option<Vec<[f64; 3]>> {
    let points = node.list(Node::vector)?;
    if points.len() < 2 {
        return node.fail(format!("has {} points, needs at least 2", points.len()), "add the other end");
    }
    if let Some(i) = (1..points.len()).find(|&i| points[i] == points[i - 1]) {
        return node.fail(format!("entries {i} and {} are the same point", i + 1), "remove one of them");
    }
    let back = |i: &usize| {
        let (a, b) = (sub(points[*i], points[i - 1]), sub(points[i + 1], points[*i]));
        parallel(a, b) && dot(scaled(a, 1.0 / norm(a)), b) < 0.0
    };
    if let Some(i) = (1..points.len() - 1).find(back) {
        return node.fail(format!("turns back at entry {}", i + 1), "correct the points");
    }
    Some(points)
}

/// Number of elements over an axis with so many corners.
pub(super) fn elements(table: &Table<'_>, corners: Option<usize>) -> Option<u32> {
    table.required("elements", "elements = 10", |n| {
        let count = n.whole(1..=MAX_ELEMENTS)?;
        match corners {
            Some(corners) if (count as usize) < corners - 1 => n.fail(
                format!("must be at least {}, one for each straight piece", corners - 1),
                "use more elements, or fewer points",
            ),
            _ => Some(count as u32),
        }
    })
}

/// Degree of the shape functions.
pub(super) fn order(table: &Table<'_>, default: u32) -> Option<u32> {
    table.default("order", default, |n| n.whole(1..=3).map(|order| order as u32))
}

fn arc(node: &Node<'_>) -> Option<Arc> {
    let table = node.table_like("{ centre = [0, 0, 0], start = [1, 0, 0], axis = [0, 0, 1], degrees = 90 }")?;
    let centre = table.required("centre", "centre = [0, 0, 0]", Node::vector);
    let axis = table.required("axis", "axis = [0, 0, 1]", Node::direction);
    let start = table.required("start", "start = [1, 0, 0]", |n| {
        let start = n.vector()?;
        if let (Some(centre), Some(axis)) = (centre, axis) {
            let radius = sub(start, centre);
            if radius == [0.0; 3] {
                return n.fail("is the centre", "choose a point at the distance of the radius");
            }
            if !perpendicular(radius, axis) {
                return n.fail(
                    "is not in the plane through the centre perpendicular to `axis`",
                    "correct the start, the centre or the axis",
                );
            }
        }
        Some(start)
    });
    let degrees = table.required("degrees", "degrees = 90", |n| {
        let degrees = n.not_zero()?;
        if degrees.abs() > 360.0 {
            return n.fail("exceeds 360 degrees", "write at most 360");
        }
        Some(degrees)
    });
    table.finish();
    Some(Arc { centre: centre?, start: start?, axis: axis?, degrees: degrees? })
}

fn section(node: &Node<'_>, setting: Setting) -> Option<Section> {
    let table = node.table_like("{ shape = \"circle\", radius = 0.01 }")?;
    let section = if table.has("axial") && !table.has("shape") {
        stiffness(&table, setting).map(Section::Stiffness)
    } else {
        let example = "shape = \"rectangle\", size = [0.02, 0.05]` or the stiffnesses `axial = 1e6, ...";
        let reader = table.required("shape", example, |n| {
            n.choice(SectionShape::NAMES, |name| match name {
                "rectangle" => Some(rectangle as fn(&Table<'_>) -> Option<SectionShape>),
                "circle" => Some(circle),
                "tube" => Some(tube),
                _ => None,
            })
        });
        reader?(&table).map(Section::Shape)
    };
    table.finish();
    section
}

fn rectangle(table: &Table<'_>) -> Option<SectionShape> {
    let size = table.required("size", "size = [0.02, 0.05]", |n| n.array(Node::positive));
    Some(SectionShape::Rectangle(RectangleSection { size: size? }))
}

fn circle(table: &Table<'_>) -> Option<SectionShape> {
    let radius = table.required("radius", "radius = 0.01", Node::positive);
    Some(SectionShape::Circle(CircleSection { radius: radius? }))
}

fn tube(table: &Table<'_>) -> Option<SectionShape> {
    let radius = table.required("radius", "radius = 0.01", Node::positive);
    let thickness = table.required("thickness", "thickness = 0.002", |n| {
        let thickness = n.positive()?;
        match radius {
            Some(radius) if thickness >= radius => n.fail(
                format!("must be below the radius {radius}"),
                "reduce it, or write shape = \"circle\" for a full section",
            ),
            _ => Some(thickness),
        }
    });
    Some(SectionShape::Tube(TubeSection { radius: radius?, thickness: thickness? }))
}

fn stiffness(table: &Table<'_>, setting: Setting) -> Option<SectionStiffness> {
    let axial = table.required("axial", "axial = 1e6", Node::positive);
    let shear = table.required("shear", "shear = [1e5, 1e5]", |n| n.array(Node::positive));
    let bending = table.required("bending", "bending = [1e3, 1e3]", |n| n.array(Node::positive));
    let torsion = table.required("torsion", "torsion = 8e2", Node::positive);
    let mass = setting.mass(table, "mass", "mass = 2.0");
    let rotary = if setting.kind == Some(Kind::Dynamic) {
        table.required("rotary", "rotary = [1e-3, 1e-3]", |n| n.array(Node::positive)).map(Some)
    } else {
        table.optional("rotary", |n| n.array(Node::not_negative))
    };
    Some(SectionStiffness {
        axial: axial?,
        shear: shear?,
        bending: bending?,
        torsion: torsion?,
        mass: mass?,
        rotary: rotary?,
    })
}

/// What a section with a shape needs beside it.
#[derive(Default)]
struct Material {
    young: Option<f64>,
    poisson: Option<f64>,
    density: Option<f64>,
    shear_factor: Option<f64>,
    torsion_constant: Option<f64>,
}

impl Material {
    const KEYS: [&'static str; 5] = ["young", "poisson", "density", "shear_factor", "torsion_constant"];

    fn read(table: &Table<'_>, setting: Setting) -> Option<Self> {
        let young = table.required("young", "young = 2.1e11", Node::positive);
        let poisson = table.optional("poisson", poisson);
        let density = setting.mass(table, "density", "density = 7850.0");
        let shear_factor = table.optional("shear_factor", |n| {
            let factor = n.positive()?;
            if factor > 1.0 {
                return n.fail("must not exceed 1", "leave it out for 5/6");
            }
            Some(factor)
        });
        let torsion_constant = table.optional("torsion_constant", Node::positive);
        Some(Self {
            young: Some(young?),
            poisson: poisson?,
            density: density?,
            shear_factor: shear_factor?,
            torsion_constant: torsion_constant?,
        })
    }

    /// Beside stiffnesses nothing of it has a meaning.
    fn refused(table: &Table<'_>) -> Option<Self> {
        let mut none = Some(Self::default());
        for key in Self::KEYS.into_iter().filter(|&key| table.has(key)) {
            let remedy = match key {
                "density" => "write `mass` and `rotary` in the section",
                _ => "remove it, or give the section a `shape`",
            };
            none = table.fail(key, "is for a section with a shape", remedy);
        }
        // The keys are known, for the remedy of those that are not.
        Self::KEYS.into_iter().for_each(|key| drop(table.get(key)));
        none
    }

    /// The section is bad: what is beside it cannot be judged.
    fn skipped(table: &Table<'_>) -> Option<Self> {
        Self::KEYS.into_iter().for_each(|key| drop(table.get(key)));
        None
    }
}

/// The direction of `d1`, needed where the section is not the same in all directions.
fn up(
    table: &Table<'_>,
    section: Option<&Section>,
    points: Option<&Option<Vec<[f64; 3]>>>,
    arc: Option<&Option<Arc>>,
) -> Option<Option<[f64; 3]>> {
    if !table.has("up") && section.is_some_and(|section| !section.is_isotropic()) {
        return table.missing("up", "up = [0, 0, 1]");
    }
    table.optional("up", |n| {
        let up = n.direction()?;
        let remedy = "choose a direction across the axis of the beam";
        if let Some(Some(points)) = points
            && let Some(i) = (1..points.len()).find(|&i| parallel(sub(points[i], points[i - 1]), up))
        {
            return n.fail(format!("is parallel to the piece from entry {i} to {}", i + 1), remedy);
        }
        if let Some(Some(arc)) = arc
            && let Some(fraction) = arc.parallel_to(up)
        {
            return n.fail(format!("is parallel to the arc at {} degrees", fraction * arc.degrees.abs()), remedy);
        }
        Some(up)
    })
}
