//! The rows of the maps: what is varied, from where to where.

use super::case::{Case, Problem};
use super::problems::cantilever;
use super::problems::fit;
use super::problems::flight::Flight;
use super::problems::impact::Impact;
use super::problems::press::Press;
use super::problems::rest;
use super::problems::slide;
use super::text::{PLAIN, Units};

/// Methods of contact, each a map.
const CONTACT: [&str; 5] = ["nts", "cat", "mortar", "mortar dual", "general"];

/// Schemes whose flights are a map each.
const SCHEMES: [&str; 5] = ["energy-momentum", "midpoint", "generalised-alpha", "backward-euler", "newmark"];

/// Cells whose cantilevers are the map `cells`, with their keys.
const CELLS: [(&str, &str); 8] = [
    ("hex8", ""),
    ("hex8 mixed", "volumetric = \"mixed\"\n"),
    ("hex20", "cell = \"hex20\"\n"),
    ("hex20 mixed", "cell = \"hex20\"\nvolumetric = \"mixed\"\n"),
    ("hex27", "cell = \"hex27\"\n"),
    ("hex27 mixed", "cell = \"hex27\"\nvolumetric = \"mixed\"\n"),
    ("tet10", "cell = \"tet10\"\n"),
    ("tet10 mixed", "cell = \"tet10\"\nvolumetric = \"mixed\"\n"),
];

const STIFFNESS: [f64; 5] = [1.0, 1e2, 1e4, 1e6, 1e8];
const MASS: [f64; 5] = [1.0, 1e2, 1e3, 1e4, 1e6];
const STEP: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];
const POISSON: [f64; 6] = [0.0, 0.3, 0.49, 0.499, 0.499_99, 0.499_999_9];
const SLENDERNESS: [f64; 5] = [1.0, 10.0, 100.0, 300.0, 1000.0];
const MESH: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 20.0];
const FRICTION: [f64; 6] = [0.0, 0.1, 0.3, 0.6, 1.0, 2.0];
const SPEED: [f64; 6] = [1e-3, 0.01, 0.05, 0.1, 0.2, 0.5];
/// Gaps and overlaps in edges of the smaller elements, which are a half.
const EDGES: [f64; 7] = [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5];
const EDGE: f64 = 0.5;
const REST: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];

/// Units of length, mass and time, from the scale of atoms to that of stars.
const UNITS: [(&str, Units); 6] = [
    ("1", Units { length: 1.0, mass: 1.0, time: 1.0 }),
    ("nano", Units { length: 1e-9, mass: 1e-27, time: 1e-9 }),
    ("micro", Units { length: 1e-6, mass: 1e-15, time: 1e-3 }),
    ("kilo", Units { length: 1e3, mass: 1e12, time: 1e3 }),
    ("giga", Units { length: 1e9, mass: 1e30, time: 1e6 }),
    ("odd", Units { length: 1e-9, mass: 1e9, time: 1e9 }),
];

/// Cells of the maps, row after row.
#[derive(Default)]
struct Rows(Vec<Case>);

impl Rows {
    fn add(&mut self, map: &'static str, axis: &str, values: &[f64], problem: impl Fn(f64) -> Problem) {
        for (column, &value) in values.iter().enumerate() {
            let name = short(value);
            self.0.push(Case { map, axis: axis.into(), column, value: name, problem: problem(value), units: None });
        }
    }

    fn units(&mut self, map: &'static str, axis: &str, problem: impl Fn(Units) -> Problem) {
        for (column, (name, units)) in UNITS.into_iter().enumerate() {
            let value = name.to_owned();
            self.0.push(Case { map, axis: axis.into(), column, value, problem: problem(units), units: Some(units) });
        }
    }
}

/// A value as it stands in a cell.
fn short(value: f64) -> String {
    let plain = value == 0.0 || (1e-2..1e3).contains(&value);
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// All cells of all maps.
pub fn cases() -> Vec<Case> {
    let mut rows = Rows::default();
    for method in CONTACT {
        statics(&mut rows, method);
        gaps(&mut rows, method);
        impacts(&mut rows, method);
    }
    statics(&mut rows, "tie");
    ties(&mut rows);
    for scheme in SCHEMES {
        flights(&mut rows, scheme, scheme, false);
    }
    for (name, keys) in CELLS {
        rows.add("cells", &format!("{name}, slenderness"), &SLENDERNESS, |v| {
            cantilever::problem(keys, 10.0_f64.max(v), 0.3)
        });
        rows.add("cells", &format!("{name}, Poisson's ratio"), &POISSON, |v| cantilever::problem(keys, 10.0, v));
    }
    rows.0
}

/// A block pressed on another one.
fn statics(rows: &mut Rows, method: &'static str) {
    let press = Press::default();
    let fine = |n: f64| [[2 * n as u32, 2, 1], [2, 2, 1]];
    rows.add(method, "statics: stiffer upper", &STIFFNESS, |v| Press { stiffness: [v, 1.0], ..press }.problem(method));
    rows.add(method, "statics: stiffer lower", &STIFFNESS, |v| Press { stiffness: [1.0, v], ..press }.problem(method));
    rows.add(method, "statics: Poisson's ratio", &POISSON, |v| Press { poisson: v, ..press }.problem(method));
    rows.add(method, "statics: Poisson's ratio, mixed", &POISSON, |v| {
        Press { poisson: v, is_mixed: true, ..press }.problem(method)
    });
    rows.add(method, "statics: slenderness", &SLENDERNESS, |v| {
        Press { height: 1.0 / v, divisions: [[3, 3, 1], [4, 4, 2]], ..press }.problem(method)
    });
    rows.add(method, "statics: finer slave", &MESH, |v| {
        Press { divisions: fine(v), tolerance: 0.1, ..press }.problem(method)
    });
    rows.add(method, "statics: finer master", &MESH, |v| {
        Press { divisions: fine(v), lower_is_slave: true, tolerance: 0.1, ..press }.problem(method)
    });
}

/// Gaps, overlaps, friction and rest.
fn gaps(rows: &mut Rows, method: &'static str) {
    rows.add(method, "statics: gap", &EDGES, |v| fit::problem(method, EDGE * v, EDGE * v + 0.02));
    rows.add(method, "statics: overlap", &EDGES, |v| fit::problem(method, -EDGE * v, 0.0));
    rows.add(method, "statics: friction", &FRICTION, |v| slide::pulled(method, v, PLAIN));
    rows.units(method, "statics: units", |units| slide::pulled(method, 0.3, units));
    rows.add(method, "sliding: friction", &FRICTION, |v| slide::dynamic(method, v, 20));
    rows.add(method, "rest: steps", &REST, |v| rest::problem(method, v as u32));
}

/// A cube falls on a block.
fn impacts(rows: &mut Rows, method: &'static str) {
    let impact = Impact::default();
    let fine = |n: f64| [[2 * n as u32, 2, 1], [2, 2, 1]];
    rows.add(method, "impact: stiffer upper", &STIFFNESS, |v| Impact { stiffness: [v, 1.0], ..impact }.problem(method));
    rows.add(method, "impact: stiffer lower", &STIFFNESS, |v| Impact { stiffness: [1.0, v], ..impact }.problem(method));
    rows.add(method, "impact: heavier upper", &MASS, |v| Impact { density: [v, 1.0], ..impact }.problem(method));
    rows.add(method, "impact: heavier lower", &MASS, |v| Impact { density: [1.0, v], ..impact }.problem(method));
    rows.add(method, "impact: step", &STEP, |v| {
        Impact { crossings: v, speed: 0.012, steps: 20, ..impact }.problem(method)
    });
    rows.add(method, "impact: Poisson's ratio", &POISSON, |v| Impact { poisson: v, ..impact }.problem(method));
    rows.add(method, "impact: slenderness", &SLENDERNESS, |v| {
        Impact { height: 1.0 / v, divisions: [[2, 2, 1]; 2], ..impact }.problem(method)
    });
    rows.add(method, "impact: finer slave", &MESH, |v| Impact { divisions: fine(v), ..impact }.problem(method));
    rows.add(method, "impact: finer master", &MESH, |v| {
        Impact { divisions: fine(v), lower_is_slave: true, steps: 15, ..impact }.problem(method)
    });
    rows.units(method, "impact: units", |units| Impact { units, ..impact }.problem(method));
    rows.add(method, "impact: speed", &SPEED, |v| Impact { speed: v, gap: Some(0.01), ..impact }.problem(method));
    let at = |gap: f64| Impact { speed: 0.06, gap: Some(gap), ..impact };
    rows.add(method, "impact: gap", &EDGES, |v| at(EDGE * v).problem(method));
    rows.add(method, "impact: overlap", &EDGES[1..], |v| at(-EDGE * v).problem(method));
}

/// Two tied halves of a bar.
fn ties(rows: &mut Rows) {
    let flight = Flight::default();
    let map = "tie";
    rows.units(map, "statics: units", |units| Press { units, ..Press::default() }.problem(map));
    let tied = |flight: Flight| flight.problem("energy-momentum", true);
    rows.add(map, "flight: stiffness", &STIFFNESS, |v| tied(Flight { other: [v, 1.0], ..flight }));
    rows.add(map, "flight: mass", &MASS, |v| tied(Flight { other: [1.0, v], ..flight }));
    rows.add(map, "flight: finer slave", &MESH, |v| tied(Flight { other_divisions: [1, v as u32, 1], ..flight }));
    flights(rows, map, "energy-momentum", true);
}

/// Flights of a bar.
fn flights(rows: &mut Rows, map: &'static str, scheme: &str, is_tied: bool) {
    let flight = Flight::default();
    rows.add(map, "flight: step", &STEP, |v| Flight { crossings: v, ..flight }.problem(scheme, is_tied));
    rows.add(map, "flight: Poisson's ratio", &POISSON, |v| Flight { poisson: v, ..flight }.problem(scheme, is_tied));
    rows.add(map, "flight: Poisson's ratio, mixed", &POISSON, |v| {
        Flight { poisson: v, is_mixed: true, ..flight }.problem(scheme, is_tied)
    });
    rows.add(map, "flight: slenderness", &SLENDERNESS, |v| {
        Flight { size: [1.0, 1.0, 1.0 / v], divisions: [2, 2, 1], ..flight }.problem(scheme, is_tied)
    });
    rows.add(map, "flight: spin", &SPEED, |v| Flight { spin: v, ..flight }.problem(scheme, is_tied));
    rows.add(map, "flight: steps", &REST, |v| Flight { steps: v as u32, ..flight }.problem(scheme, is_tied));
    rows.units(map, "flight: units", |units| Flight { units, ..flight }.problem(scheme, is_tied));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_cell_has_a_scene_and_a_name_of_its_own() {
        let cases = cases();
        let names: BTreeSet<String> = cases.iter().map(Case::name).collect();
        assert_eq!(names.len(), cases.len());
        for case in &cases {
            case.problem.text.text().parse::<toml::Table>().unwrap_or_else(|error| panic!("{}: {error}", case.name()));
        }
    }

    #[test]
    fn values_are_short() {
        assert_eq!(
            [0.0, 0.3, 0.4999999, 1e-12, 1e8, 300.0].map(short),
            ["0", "0.3", "0.4999999", "1e-12", "1e8", "300"]
        );
    }
}
