//! `[[string]]` and `[[mass]]`.

use crate::Kind;
use crate::beam::{elements, points};
use crate::body::Mass;
use crate::read::Table;
use crate::rigid::joined_name;
use crate::vector::{norm, sub};
use crate::world::Setting;
use stoss_scene_derive::table;

/// `[[string]]`: an elastic string (cable), with axial stiffness only.
///
/// ```toml
/// [[string]]
/// name = "rope"
/// from = [0, 0, 0]
/// to = [3, 0, 0]
/// elements = 20
/// axial = 1.0e4
/// mass = 0.2
/// natural_length = 2.9
/// ```
///
/// Sets: `start`, `end`, `all`.
#[table(context(Setting<'_>), check = string)]
pub struct ElasticString {
    /// Name, unique among all parts: letters, digits, `-` and `_`.
    #[key(example = "\"rope\"", name)]
    pub name: String,
    /// Vertices of the initial polygon, two or more. Either these, or `from` and `to`.
    #[key(default, skip, dimension = Length, read = points)]
    pub points: Vec<[f64; 3]>,
    /// Start of a straight string.
    #[key(dimension = Length)]
    pub from: Option<[f64; 3]>,
    /// End of a straight string.
    #[key(dimension = Length)]
    pub to: Option<[f64; 3]>,
    /// Number of elements over the whole length, distributed over the straight pieces by their lengths; at least one for each piece.
    #[key(example = "10", with = |node, _, keys| elements(node, keys.points.as_deref()))]
    pub elements: u32,
    /// Polynomial degree of the shape functions: 1, 2 or 3; 1 if left out.
    #[key(default = ElasticString::DEFAULT_ORDER, range = 1..=3)]
    pub order: u32,
    /// Axial stiffness `E A` (force), positive. Either this, or `young` and `area`.
    #[key(dimension = Force, positive)]
    pub axial: Option<f64>,
    /// Young's modulus (stress), positive.
    #[key(dimension = Stress, positive)]
    pub young: Option<f64>,
    /// Area of the cross-section (length^2), positive; for `young` and `density`.
    #[key(dimension = Area, positive)]
    pub area: Option<f64>,
    /// Mass per unstretched length. Either this, or `density` and `area`; one of them is positive and required in dynamic scenes.
    #[key(dimension = LineDensity, by = |node, setting| setting.mass_value(node))]
    pub mass: Option<f64>,
    /// Density: mass per unstretched volume.
    #[key(dimension = Density, by = |node, setting| setting.mass_value(node))]
    pub density: Option<f64>,
    /// Mass matrix: `lumped` if left out, or `consistent`. With the latter what stops a node jerks its neighbours: a rope that falls on a floor is pulled down by it.
    #[key(default = ElasticString::DEFAULT_MASS_MATRIX)]
    pub mass_matrix: Mass,
    /// Unstretched length of the whole string, positive; the length of the polygon if left out.
    #[key(dimension = Length, positive)]
    pub natural_length: Option<f64>,
    /// `true`: the string goes slack, without force in compression. `false` if left out.
    #[key(default, skip)]
    pub tension_only: bool,
    /// Initial velocity of the whole string (length per time); zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = Velocity)]
    pub velocity: [f64; 3],
}

impl ElasticString {
    /// The mass matrix if none is given.
    pub const DEFAULT_MASS_MATRIX: Mass = Mass::Lumped;

    /// Linear elements.
    pub const DEFAULT_ORDER: u32 = 1;

    /// Vertices of the initial polygon: `points`, or `from` and `to`.
    pub fn corners(&self) -> Vec<[f64; 3]> {
        match (self.from, self.to) {
            (Some(from), Some(to)) => vec![from, to],
            _ => self.points.clone(),
        }
    }

    /// Natural length: as given, or that of the polygon.
    pub fn natural_length(&self) -> f64 {
        let polygon = || self.corners().windows(2).map(|ends| norm(sub(ends[1], ends[0]))).sum();
        self.natural_length.unwrap_or_else(polygon)
    }

    /// Axial stiffness `E A`.
    pub fn axial_stiffness(&self) -> f64 {
        self.axial.unwrap_or_else(|| self.young.unwrap_or_default() * self.area.unwrap_or_default())
    }

    /// Mass per natural length, if it has one.
    pub fn mass_per_length(&self) -> Option<f64> {
        self.mass.or_else(|| Some(self.density? * self.area?))
    }
}

/// `[[mass]]`: a point mass, without rotation.
///
/// ```toml
/// [[mass]]
/// name = "bob"
/// at = [0, 0, -1]
/// mass = 0.5
/// velocity = [1, 0, 0]
/// ```
#[table(context(Setting<'_>), check = mass)]
pub struct PointMass {
    /// Name, unique among all parts: letters, digits, `-` and `_`. It has the set `name.all`.
    #[key(example = "\"bob\"", read = joined_name)]
    pub name: String,
    /// Initial position.
    #[key(dimension = Length, example = "[0, 0, 0]")]
    pub at: [f64; 3],
    /// Mass, positive.
    #[key(dimension = Mass, example = "1.0", not_negative)]
    pub mass: f64,
    /// Initial velocity (length per time); zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = Velocity)]
    pub velocity: [f64; 3],
}

fn string(keys: &ElasticStringKeys, table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
    let axis = match (table.has("points"), table.has("from"), table.has("to")) {
        (true, false, false) => Some(()),
        (false, true, true) => match (keys.from, keys.to) {
            (Some(from), Some(to)) if from == to => {
                table.fail("to", "is the same point as `from`", "choose another end")
            }
            _ => Some(()),
        },
        (true, from, _) => {
            let key = if from { "from" } else { "to" };
            table.fail(key, "`points` are given too", "remove `points`, or `from` and `to`")
        }
        (false, true, false) => table.missing("to", "to = [1, 0, 0]"),
        (false, false, true) => table.missing("from", "from = [0, 0, 0]"),
        (false, false, false) => table.missing("points", "points = [[0, 0, 0], [1, 0, 0]]"),
    };
    let section = section(table, setting);
    setting.at_rest(table, &["velocity"]).and(axis).and(section)
}

fn section(table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
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
        (true, false) => table.missing("area", "area = 1e-5"),
        (false, true) => table.fail("area", "has no effect without `young` or `density`", "remove it"),
        _ => Some(()),
    }
}

fn mass(keys: &PointMassKeys, table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
    if keys.mass == Some(0.0) && !setting.is_held && setting.kind != Some(Kind::QuasiStatic) {
        return table.fail("mass", "must be positive", "write a number larger than 0");
    }
    setting.at_rest(table, &["velocity"])
}
