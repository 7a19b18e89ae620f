//! A thick tube under pressure that yields inside.

use stoss_reference_cases::mapped::tube;

use super::parts::{End, fixed, ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values};
use crate::workspace::Outcome;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.499_999;
/// So small that strains are.
const YIELD: f64 = 0.001;
const RADII: [f64; 2] = [1.0, 2.0];
/// Radius up to which it yields.
const FRONT: f64 = 1.5;

const BEST: Choice = Choice::direct("statics", "none", "hex27 mixed", 8, 4);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "yielding-tube",
    title: "Elastic-plastic tube under pressure",
    about: "A quarter of a tube of radii 1 and 2 in plane strain (Hencky's law, Young's modulus 1000, Poisson's ratio 0.499999, yield stress 0.001 without hardening) under a pressure inside at which it yields up to the radius 1.5; \
            `mesh` elements through the wall, 1.5 times as many around. Hard: plastic flow without a change of volume, and a front within elements.",
    quantities: &["displacement", "von Mises stress"],
    reference: Reference::Closed {
        source: "R. Hill, The Mathematical Theory of Plasticity (1950), chapter V",
        values: hill,
    },
    scene,
    files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["hex8 mixed", "hex20 mixed", "hex27 mixed", "tet10 mixed"],
    meshes: &[4, 6, 8, 12],
    steps: &[1, 2, 4, 8],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "displacement", at_least: 2.9 }],
    quick: 3,
};

fn file(choice: &Choice) -> String {
    format!("{}.inp", choice.slug())
}

fn files(choice: &Choice) -> Vec<(String, String)> {
    let n = choice.mesh as usize;
    vec![(file(choice), tube(RADII, 0.25, [n, 3 * n / 2, 1]))]
}

/// Shear yield stress.
fn shear() -> f64 {
    YIELD / 3.0_f64.sqrt()
}

fn scene(choice: &Choice) -> Outcome<String> {
    let pressure = shear() * (2.0 * (FRONT / RADII[0]).ln() + 1.0 - (FRONT / RADII[1]).powi(2));
    let mut text = format!(
        "{}[[body]]\nname = \"tube\"\n{}mesh = {{ file = \"{}\" }}\n\
         material = {{ law = \"hencky\", young = {YOUNG:?}, poisson = {POISSON:?}, plasticity = {{ yield_stress = {YIELD:?} }} }}\n\
         [[load]]\nset = \"tube.left\"\npressure = {}\n",
        choice.head("Yielding tube", 1.0),
        choice.cell_keys(),
        file(choice),
        ramp(pressure)
    );
    text += &[fixed("tube.front", "\"y\""), fixed("tube.back", "\"x\""), fixed("tube.all", "\"z\"")].concat();
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let end = End::of(run)?;
    Ok(vec![end.field("displacement")?.values.clone(), end.field("von_mises")?.values.clone()])
}

/// Without a change of volume the displacement is `A / r`, in the elastic part that of the shear stress `k c^2 / r^2`; von Mises' stress is `sqrt(3)` times the shear stress.
fn hill(run: &Run, _: &Choice) -> Outcome<Values> {
    let end = End::of(run)?;
    let moved = 1.5 * shear() * FRONT.powi(2) / YOUNG;
    let displacement = end.grid.points.iter().flat_map(|&[x, y, _]| {
        let squared = x * x + y * y;
        [moved * x / squared, moved * y / squared, 0.0]
    });
    let stress = end.grid.points.iter().map(|&[x, y, _]| YIELD * (FRONT.powi(2) / (x * x + y * y)).min(1.0));
    Ok(vec![displacement.collect(), stress.collect()])
}
