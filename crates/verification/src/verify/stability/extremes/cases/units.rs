//! The same scene in other units: the same result to round-off.

use super::super::case::{Case, Oracle, Touch};
use super::super::scene::{Block, Matter, Scene};

/// Units of length and stress; the unit of time stays.
const UNITS: [(&str, f64, f64); 4] = [
    ("lengths 1e3", 1e3, 1.0),
    ("stresses 1e-6", 1.0, 1e-6),
    ("lengths 1e6", 1e6, 1.0),
    ("lengths 1e-6 stresses 1e6", 1e-6, 1e6),
];

/// Round-off of forty steps; a wrong constant with a unit would change the active set or the iterations.
const BOUND: f64 = 1e-9;

/// A block falls on another one; all lengths times `length`, all stresses times `stress`.
fn scene((scheme, constraint): (&str, &str), length: f64, stress: f64) -> Scene {
    let scaled = |x: [f64; 3]| x.map(|x| x * length);
    let matter = Matter::new(1e3 * stress, stress / (length * length));
    let lower = Block { min: scaled([-1.0, -1.0, -1.0]), max: scaled([1.0, 1.0, 0.0]), divisions: [3, 3, 1] };
    let upper = Block { min: scaled([-0.5, -0.5, 0.02]), max: scaled([0.5, 0.5, 1.02]), divisions: [2, 2, 2] };
    Scene::new(Some(scheme), 0.005, 40, 10)
        .block("lower", lower, matter, [0.0; 3])
        .block("upper", upper, matter, scaled([0.05, 0.03, -1.0]))
        .contact("upper.bottom", "lower.top", constraint)
}

/// All of them: for each scheme a base, then the same in other units.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let combinations =
        [("energy-momentum", "standard"), ("energy-momentum", "modified"), ("generalised-alpha", "standard")];
    for combination in combinations {
        let make = |length: f64, stress: f64| {
            Case::contact("other units", combination, scene(combination, length, stress), Touch::UPPER)
        };
        let case = make(1.0, 1.0);
        let base = case.combination.clone();
        cases.push(case.against(Oracle::Base));
        for (name, length, stress) in UNITS {
            let oracle = Oracle::Same { base: base.clone(), length, bound: BOUND };
            cases.push(make(length, stress).named(format!("{base} {name}")).against(oracle));
        }
    }
    cases
}
