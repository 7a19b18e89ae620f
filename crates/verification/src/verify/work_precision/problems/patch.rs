//! Two blocks under a uniform pressure whose meshes do not match: one state of stress everywhere.

use super::parts::{End, fixed, flat, ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const PRESSURE: f64 = 10.0;
/// General contact acts over a distance.
const GAP: f64 = 1e-3;

const BEST: Choice =
    Choice { scheme: "statics", method: "mortar", cell: "hex8", mesh: 4, steps: 2, solver: "direct", tolerance: 1e-9 };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "patch",
    title: "Patch of two blocks",
    about: "Two neo-Hooke cubes of side 1 (Young's modulus 1000, Poisson's ratio 0.3) on each other under a pressure of 10, free to widen; for `mesh` elements along an edge of the lower one the upper one \
            has half as many more. Hard: nodes of both sides lie nowhere opposite each other. Exact: uniform stress, which mortar contact has to give to round-off.",
    quantities: &["stress", "contact pressure"],
    reference: Reference::Closed {
        source: "uniaxial stress: mu (s^2 - 1) + lambda ln J across it is zero",
        values: uniform,
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "cat", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex8 mixed", "hex20", "hex27", "tet4", "tet10"],
    meshes: &[2, 4, 6, 8],
    steps: &[1, 2, 4],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[],
    quick: 3,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let mut text = choice.head("Patch", 1.0);
    let bottom = if choice.method == "general" { 1.0 + GAP } else { 1.0 };
    for (name, z, n) in [("lower", 0.0, n), ("upper", bottom, n + n / 2)] {
        text += &format!(
            "[[body]]\nname = \"{name}\"\n{}material = {{ law = \"neo-hooke\", young = {YOUNG:?}, poisson = {POISSON:?} }}\n\
             mesh = {{ generator = \"block\", min = [0, 0, {z:?}], max = [1, 1, {:?}], divisions = [{n}, {n}, 2] }}\n",
            choice.cell_keys(),
            z + 1.0
        );
        text += &[fixed(&format!("{name}.left"), "\"x\""), fixed(&format!("{name}.front"), "\"y\"")].concat();
    }
    text += &fixed("lower.bottom", "\"z\"");
    text += &format!("[[load]]\nset = \"upper.top\"\npressure = {}\n", ramp(PRESSURE));
    Ok(text + &choice.contact("upper.bottom", "lower.top", "")?)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let end = End::of(run)?;
    let (stress, pressure) = (end.field("cauchy_stress")?, end.field("contact_pressure")?);
    let normal = (0..end.body.len()).map(|n| stress.row(n)[2]).collect();
    Ok(vec![normal, interface(&end).into_iter().map(|n| pressure.values[n]).collect()])
}

fn interface(end: &End) -> Vec<usize> {
    end.points(1, |[_, _, z]| flat(z, 1.0) || flat(z, 1.0 + GAP))
}

/// Kirchhoff stresses are `mu (s^2 - 1) + lambda ln J`; the one across the load is zero, the one along it is the pressure times the stretch.
fn uniform(run: &Run, _: &Choice) -> Outcome<Values> {
    let (mu, lambda) = (YOUNG / 2.0 / (1.0 + POISSON), YOUNG * POISSON / (1.0 + POISSON) / (1.0 - 2.0 * POISSON));
    // Of the stretch across the load: that along it, and the nominal stress, which grows from 0.
    let along = |across: f64| (-mu * (across * across - 1.0) / lambda).exp() / (across * across);
    let nominal = |across: f64| mu * (across * across - along(across).powi(2)) / along(across);
    let (mut low, mut high) = (1.0, 1.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if nominal(middle) < PRESSURE { low = middle } else { high = middle }
    }
    let cauchy = PRESSURE / (low * low);
    let end = End::of(run)?;
    Ok(vec![vec![-cauchy; end.body.len()], vec![cauchy; interface(&end).len()]])
}
