//! Reads `[[string]]` and `[[mass]]`.

use super::beam::{elements, order, points};
use super::node::Node;
use super::rigid::joined_name;
use super::table::Table;
use super::world::Setting;
use crate::{ElasticString, Kind, Mass, PointMass};

/// The string and its name, which is needed even if the rest is bad.
pub(super) fn string(table: &Table<'_>, setting: Setting) -> (Option<ElasticString>, Option<String>) {
    let name = table.required("name", "name = \"rope\"", Node::name);
    let points = table.optional("points", points);
    let from = table.optional("from", Node::vector);
    let to = table.optional("to", |n| {
        let to = n.vector()?;
        if from == Some(Some(to)) {
            return n.fail("is the same point as `from`", "choose another end");
        }
        Some(to)
    });
    let axis = match (table.has("points"), table.has("from"), table.has("to")) {
        (true, false, false) | (false, true, true) => Some(()),
        (true, from, _) => table.fail(
            if from { "from" } else { "to" },
            "`points` are given too",
            "remove `points`, or `from` and `to`",
        ),
        (false, true, false) => table.missing("to", "to = [1, 0, 0]"),
        (false, false, true) => table.missing("from", "from = [0, 0, 0]"),
        (false, false, false) => table.missing("points", "points = [[0, 0, 0], [1, 0, 0]]"),
    };
    let corners = points.as_ref().and_then(|points| points.as_ref()).map(Vec::len);
    let elements = elements(table, corners);
    let order = order(table, ElasticString::DEFAULT_ORDER);
    let section = section(table, setting);
    let natural_length = table.optional("natural_length", Node::positive);
    let mass_matrix =
        table.default("mass_matrix", ElasticString::DEFAULT_MASS_MATRIX, |n| n.choice(Mass::NAMES, Mass::from_name));
    let tension_only = table.default("tension_only", false, Node::boolean);
    let velocity = table.default("velocity", [0.0; 3], Node::vector);
    let at_rest = setting.at_rest(table, &["velocity"]);
    table.finish();
    let string = (|| {
        axis?;
        at_rest?;
        let section = section?;
        Some(ElasticString {
            name: name.clone()?,
            points: points?.unwrap_or_default(),
            from: from?,
            to: to?,
            elements: elements?,
            order: order?,
            axial: section.axial,
            young: section.young,
            area: section.area,
            mass: section.mass,
            density: section.density,
            mass_matrix: mass_matrix?,
            natural_length: natural_length?,
            tension_only: tension_only?,
            velocity: velocity?,
        })
    })();
    (string, name)
}

struct StringSection {
    axial: Option<f64>,
    young: Option<f64>,
    area: Option<f64>,
    mass: Option<f64>,
    density: Option<f64>,
}

fn section(table: &Table<'_>, setting: Setting) -> Option<StringSection> {
    let axial = table.optional("axial", Node::positive);
    let young = table.optional("young", Node::positive);
    let area = table.optional("area", Node::positive);
    let mass = table.optional("mass", |n| setting.mass_value(n));
    let density = table.optional("density", |n| setting.mass_value(n));
    let [has_axial, has_young, has_area, has_mass, has_density] =
        ["axial", "young", "area", "mass", "density"].map(|key| table.has(key));
    match (has_axial, has_young) {
        (true, true) => return table.fail("young", "`axial` is given too", "remove one of them"),
        (false, false) => return table.missing("axial", "axial = 1e4` or `young = 1e9, area = 1e-5"),
        _ => {}
    }
    if has_mass && has_density {
        return table.fail("density", "`mass` is given too", "remove one of them");
    }
    if !has_mass && !has_density && setting.needs_mass() {
        return setting.missing_mass(table, "mass", "mass = 0.2");
    }
    match (has_young || has_density, has_area) {
        (true, false) => return table.missing("area", "area = 1e-5"),
        (false, true) => {
            return table.fail("area", "has no effect without `young` or `density`", "remove it");
        }
        _ => {}
    }
    Some(StringSection { axial: axial?, young: young?, area: area?, mass: mass?, density: density? })
}

/// The point mass and its name, which is needed even if the rest is bad. `is_held`: something else says how it moves, so that it needs no mass.
pub(super) fn mass(table: &Table<'_>, setting: Setting, is_held: bool) -> (Option<PointMass>, Option<String>) {
    let name = table.required("name", "name = \"bob\"", joined_name);
    let at = table.required("at", "at = [0, 0, 0]", Node::vector);
    let mass = table.required("mass", "mass = 1.0", |n| {
        if is_held || setting.kind == Some(Kind::QuasiStatic) { n.not_negative() } else { n.positive() }
    });
    let velocity = table.default("velocity", [0.0; 3], Node::vector);
    let at_rest = setting.at_rest(table, &["velocity"]);
    table.finish();
    let point_mass = (|| {
        at_rest?;
        Some(PointMass { name: name.clone()?, at: at?, mass: mass?, velocity: velocity? })
    })();
    (point_mass, name)
}
