//! `[[beam]]`: axis, section, material, initial velocity of a beam.

use crate::Kind;
use crate::catalogue::poisson;
use crate::read::{Node, Table, Value};
use crate::vector::{cross, dot, norm, parallel, perpendicular, scaled, sub};
use crate::world::Setting;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use stoss_scene_derive::table;

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
#[table(context(Setting<'_>), check = beam)]
pub struct Beam {
    /// Name, unique among all parts: letters, digits, `-` and `_`.
    #[key(example = "\"mast\"", name)]
    pub name: String,
    /// Vertices of the axis, two or more, joined by straight pieces. Either these, or an `arc`.
    #[key(default, skip, dimension = Length, read = points)]
    pub points: Vec<[f64; 3]>,
    /// A circular axis, instead of `points`.
    pub arc: Option<Arc>,
    /// Number of elements over the whole length, distributed over the straight pieces by their lengths; at least one for each piece.
    #[key(example = "10", with = |node, _, keys| elements(node, keys.points.as_deref()))]
    pub elements: u32,
    /// Polynomial degree of the shape functions: 1, 2 or 3; 2 if left out.
    #[key(default = Beam::DEFAULT_ORDER, range = 1..=3)]
    pub order: u32,
    /// Cross-section: a shape with dimensions, or stiffnesses.
    #[key(example = "{ shape = \"circle\", radius = 0.01 }")]
    pub section: Section,
    /// Young's modulus (stress), positive; for a section with a `shape`.
    #[key(dimension = Stress, positive)]
    pub young: Option<f64>,
    /// Poisson's ratio, between -1 and 0.5; 0.3 if left out. For a section with a `shape`.
    #[key(dimension = Number, read = poisson)]
    pub poisson: Option<f64>,
    /// Density (mass per volume), for a section with a `shape`. Positive, and required in dynamic scenes and with gravity.
    #[key(dimension = Density, by = |node, setting| setting.mass_value(node))]
    pub density: Option<f64>,
    /// Shear correction factor `k` of the shear stiffness `k G A`, in (0, 1]; 5/6 if left out. For a section with a `shape`.
    #[key(dimension = Number, read = shear_factor)]
    pub shear_factor: Option<f64>,
    /// Torsion constant `J` (length^4) of the torsional stiffness `G J`, positive; that of Saint-Venant torsion if left out. For a section with a `shape`.
    #[key(dimension = SecondMoment, positive)]
    pub torsion_constant: Option<f64>,
    /// Direction whose part normal to the axis gives `d1`; nowhere parallel to the axis. Not needed for isotropic sections (circles, tubes).
    #[key(dimension = Number, with = |node, _, keys| up(node, keys))]
    pub up: Option<[f64; 3]>,
    /// Initial velocity `v0` (length per time) in `v(X) = v0 + omega x (X - c)`; zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = Velocity)]
    pub velocity: [f64; 3],
    /// Initial angular velocity `omega` (radians per time) of axis and sections; zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = AngularVelocity)]
    pub angular_velocity: [f64; 3],
    /// Point `c` about which `angular_velocity` acts; the origin if left out.
    #[key(default, skip, dimension = Length)]
    pub velocity_about: [f64; 3],
}

impl Beam {
    /// Quadratic elements.
    pub const DEFAULT_ORDER: u32 = 2;
    /// Poisson's ratio if left out.
    pub const DEFAULT_POISSON: f64 = 0.3;
    /// Shear correction factor if left out.
    pub const DEFAULT_SHEAR_FACTOR: f64 = 5.0 / 6.0;
}

/// An arc of a circle: from `start` around the axis through `centre`.
#[table(example = "{ centre = [0, 0, 0], start = [1, 0, 0], axis = [0, 0, 1], degrees = 90 }", check = arc)]
#[derive(Copy)]
pub struct Arc {
    /// Centre of the circle.
    #[key(dimension = Length, example = "[0, 0, 0]")]
    pub centre: [f64; 3],
    /// First point; its distance from the centre is the radius, and the vector from the centre is perpendicular to `axis`.
    #[key(dimension = Length, example = "[1, 0, 0]")]
    pub start: [f64; 3],
    /// Direction of the axis, of any length but zero.
    #[key(dimension = Number, example = "[0, 0, 1]", direction)]
    pub axis: [f64; 3],
    /// Angle in degrees, positive by the right-hand rule; not zero, at most 360 in magnitude. The ends of a full circle are not joined.
    #[key(dimension = Angle, example = "90", read = arc_degrees)]
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
#[derive(Clone, Debug, PartialEq, Serialize)]
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
#[table(tag = "shape")]
pub enum SectionShape {
    /// A rectangle.
    Rectangle(RectangleSection),
    /// A full circle.
    Circle(CircleSection),
    /// A circular ring.
    Tube(TubeSection),
}

/// Parameters of the section `rectangle`.
#[table]
pub struct RectangleSection {
    /// Width along `d1` and height along `d2` (lengths).
    #[key(dimension = Length, example = "[0.02, 0.05]", positive)]
    pub size: [f64; 2],
}

/// Parameters of the section `circle`.
#[table]
pub struct CircleSection {
    /// Radius (length).
    #[key(dimension = Length, example = "0.01", positive)]
    pub radius: f64,
}

/// Parameters of the section `tube`.
#[table]
pub struct TubeSection {
    /// Outer radius (length).
    #[key(dimension = Length, example = "0.01", positive)]
    pub radius: f64,
    /// Wall thickness (length), less than the radius.
    #[key(dimension = Length, example = "0.002", with = tube_thickness)]
    pub thickness: f64,
}

/// Stiffnesses and inertias of a cross-section, constant along the beam. `d1` and `d2` are principal axes through the centroid.
#[table(context(Setting<'_>), check = stiffness)]
#[derive(Copy)]
pub struct SectionStiffness {
    /// Axial stiffness `E A` (force), positive.
    #[key(dimension = Force, example = "1e6", positive)]
    pub axial: f64,
    /// Shear stiffnesses `k G A` along `d1` and `d2` (forces), positive.
    #[key(dimension = Force, example = "[1e5, 1e5]", positive)]
    pub shear: [f64; 2],
    /// Bending stiffnesses `E I` about `d1` and `d2` (force times area), positive.
    #[key(dimension = BendingStiffness, example = "[1e3, 1e3]", positive)]
    pub bending: [f64; 2],
    /// Torsional stiffness `G J` (force times area), positive.
    #[key(dimension = BendingStiffness, example = "8e2", positive)]
    pub torsion: f64,
    /// Mass per length; positive and required in dynamic scenes.
    #[key(dimension = LineDensity, by = |node, setting| setting.mass_value(node))]
    pub mass: Option<f64>,
    /// Rotary inertia per length about `d1` and `d2`: `rho I_1`, `rho I_2` (mass times length), positive; about `d3` it is their sum. Required in dynamic
    /// scenes.
    #[key(dimension = RotaryInertia, not_negative)]
    pub rotary: Option<[f64; 2]>,
}

/// Two or more points, no two neighbours the same, none at which the way turns back.
pub(crate) fn points(node: &Node<'_>) -> Option<Vec<[f64; 3]>> {
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

/// More elements in one beam or string than this are a mistake.
const MAX_ELEMENTS: u32 = 10_000_000;

/// Number of elements over an axis with these corners, if it is given by corners.
pub(crate) fn elements(node: &Node<'_>, corners: Option<&[[f64; 3]]>) -> Option<u32> {
    let count = node.whole_within(1..=MAX_ELEMENTS)?;
    match corners {
        Some(corners) if (count as usize) + 1 < corners.len() => node.fail(
            format!("must be at least {}, one for each straight piece", corners.len() - 1),
            "use more elements, or fewer points",
        ),
        _ => Some(count),
    }
}

fn arc<C>(keys: &ArcKeys, table: &Table<'_>, _: &C) -> Option<()> {
    let (Some(centre), Some(start), Some(axis)) = (keys.centre, keys.start, keys.axis) else { return Some(()) };
    let radius = sub(start, centre);
    if radius == [0.0; 3] {
        return table.fail("start", "is the centre", "choose a point at the distance of the radius");
    }
    if !perpendicular(radius, axis) {
        let message = "is not in the plane through the centre perpendicular to `axis`";
        return table.fail("start", message, "correct the start, the centre or the axis");
    }
    Some(())
}

fn arc_degrees(node: &Node<'_>) -> Option<f64> {
    let degrees = node.not_zero()?;
    if degrees.abs() > 360.0 {
        return node.fail("exceeds 360 degrees", "write at most 360");
    }
    Some(degrees)
}

impl Value<Setting<'_>> for Section {
    fn read(node: &Node<'_>, setting: &Setting<'_>) -> Option<Self> {
        let table = node.table_like("{ shape = \"circle\", radius = 0.01 }")?;
        match (table.has("axial"), table.has("shape")) {
            (true, false) => SectionStiffness::from_table(&table, setting).map(Self::Stiffness),
            (false, false) => table
                .missing("shape", "shape = \"rectangle\", size = [0.02, 0.05]` or the stiffnesses `axial = 1e6, ..."),
            _ => SectionShape::from_table(&table, setting).map(Self::Shape),
        }
    }
}

fn tube_thickness<C>(node: &Node<'_>, _: &C, keys: &TubeSectionKeys) -> Option<f64> {
    let thickness = node.positive()?;
    match keys.radius {
        Some(radius) if thickness >= radius => node.fail(
            format!("must be below the radius {radius}"),
            "reduce it, or write shape = \"circle\" for a full section",
        ),
        _ => Some(thickness),
    }
}

fn stiffness(keys: &SectionStiffnessKeys, table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
    let mass = setting.demand_mass(table, "mass", "mass = 2.0");
    if setting.kind == Some(Kind::Dynamic) {
        match keys.rotary {
            Some(None) => return table.missing("rotary", "rotary = [1e-3, 1e-3]"),
            Some(Some(rotary)) if rotary.contains(&0.0) => {
                return table.fail("rotary", "must be positive", "write two numbers larger than 0");
            }
            _ => {}
        }
    }
    mass
}

fn shear_factor(node: &Node<'_>) -> Option<f64> {
    let factor = node.positive()?;
    if factor > 1.0 {
        return node.fail("must not exceed 1", "leave it out for 5/6");
    }
    Some(factor)
}

/// The direction of `d1`, which is not along the axis.
fn up(node: &Node<'_>, keys: &BeamKeys) -> Option<[f64; 3]> {
    let up = node.direction()?;
    let remedy = "choose a direction across the axis of the beam";
    let points = keys.points.as_deref().unwrap_or_default();
    if let Some(i) = (1..points.len()).find(|&i| parallel(sub(points[i], points[i - 1]), up)) {
        return node.fail(format!("is parallel to the piece from entry {i} to {}", i + 1), remedy);
    }
    if let Some(Some(arc)) = keys.arc
        && let Some(fraction) = arc.parallel_to(up)
    {
        return node.fail(format!("is parallel to the arc at {} degrees", fraction * arc.degrees.abs()), remedy);
    }
    Some(up)
}

/// What a section with a shape has beside it, and one with stiffnesses has not.
const BESIDE_SHAPES: [&str; 5] = ["young", "poisson", "density", "shear_factor", "torsion_constant"];

fn beam(keys: &BeamKeys, table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
    let axis = match (table.has("points"), table.has("arc")) {
        (true, true) => table.fail("arc", "`points` are given too", "remove one of them"),
        (false, false) => table.missing("points", "points = [[0, 0, 0], [1, 0, 0]]"),
        _ => Some(()),
    };
    let material = match &keys.section {
        Some(Section::Shape(_)) => {
            let young = if table.has("young") { Some(()) } else { table.missing("young", "young = 2.1e11") };
            setting.demand_mass(table, "density", "density = 7850.0").and(young)
        }
        Some(Section::Stiffness(_)) => {
            let mut none = Some(());
            for key in BESIDE_SHAPES.into_iter().filter(|&key| table.has(key)) {
                let remedy = match key {
                    "density" => "write `mass` and `rotary` in the section",
                    _ => "remove it, or give the section a `shape`",
                };
                none = table.fail(key, "is for a section with a shape", remedy);
            }
            none
        }
        // Without a section it is not known which other keys are right.
        None => Some(()),
    };
    let at_rest = setting.at_rest(table, &["velocity", "angular_velocity", "velocity_about"]);
    if !table.has("up") && keys.section.as_ref().is_some_and(|section| !section.is_isotropic()) {
        return table.missing("up", "up = [0, 0, 1]");
    }
    axis.and(material).and(at_rest)
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
