//! A belt over a pulley that does not turn: Euler and Eytelwein.

use std::f64::consts::PI;

use crate::verify::Run;
use crate::verify::multibody::pulley::{WEIGHT, laid_over};
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const BEST: Choice =
    Choice { scheme: "statics", method: "nts", cell: "line2", mesh: 12, steps: 10, solver: "direct", tolerance: 1e-9 };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "belt",
    title: "Belt over a pulley",
    about: "An elastic string with a weight of 10 at one end lies over half of a fixed pulley (radius 1, 1440 facets, friction 0.3) and is pulled down at its other end until all of it slides. `mesh` is the number of its pieces \
            on the pulley. Values: force at the pulled end, force on the pulley.",
    quantities: &["pull", "force on the pulley"],
    reference: Reference::Closed { source: "exp(mu pi) times the weight; the sum of both ends", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "cat", "mortar", "general"],
    cells: &["line2"],
    meshes: &[6, 9, 12, 18, 24],
    steps: &[5, 10, 20, 40],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "pull", at_least: 1.7 }],
    quick: 4,
};

const FRICTION: f64 = 0.3;
const FACETS: usize = 1440;
/// The pulled end goes down by so much.
const PULL: f64 = 0.2;

fn scene(choice: &Choice) -> Outcome<String> {
    if choice.method != "nts" {
        return Err("a string has no facets: only `nts` takes it".into());
    }
    Ok(choice.head("Belt over a pulley", 1.0) + &laid_over(choice.mesh as usize, FRICTION, FACETS, -PULL))
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let values = last(&run.table("probes.csv")?, &["pull.y", "pulley.y"])?;
    Ok(values.into_iter().map(|value| vec![value.abs()]).collect())
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let pull = WEIGHT * (FRICTION * PI).exp();
    Ok(vec![vec![pull], vec![WEIGHT + pull]])
}
