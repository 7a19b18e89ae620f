//! A viscoelastic block that creeps under a shear force.

use super::parts::{fixed, vector_ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

/// Share of the Maxwell branch of the instantaneous shear modulus, which is 1, and its relaxation time.
const SHARE: f64 = 0.6;
const RELAXATION: f64 = 0.2;
/// So small that the shear is linear in it.
const FORCE: f64 = 1e-4;
/// The force grows until the time 1 and is held until 2.
const END: f64 = 2.0;

const BEST: Choice =
    Choice { scheme: "statics", method: "none", cell: "hex8", mesh: 1, steps: 32, solver: "direct", tolerance: 1e-9 };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "creep",
    title: "Creep of a viscoelastic block",
    about: "A unit cube (neo-Hooke, shear modulus 1, Poisson's ratio 0.45, a Maxwell branch with six tenths of the modulus and a relaxation time of 0.2) under a shear force that grows to 1e-4 until the time 1 and is held until 2. \
            Values: the displacement at the times 0.5, 1, 1.5, 2; the stress is uniform, so that steps alone count. Under prescribed strains that are linear in a step the stress is exact; here strains are unknown and curved in time.",
    quantities: &["displacement"],
    reference: Reference::Closed {
        source: "standard linear solid: its creep compliance, integrated over the growth of the force",
        values: compliance,
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["hex8", "hex20", "tet10"],
    meshes: &[1],
    steps: &[4, 8, 16, 32, 64, 128],
    solvers: &["direct"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[Claim { line: "step", quantity: "displacement", at_least: 1.9 }],
    quick: 4,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let mut text = format!(
        "{}[[body]]\nname = \"block\"\n{}mesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}\n\
         material = {{ law = \"neo-hooke\", young = 2.9, poisson = 0.45, prony = [[{SHARE:?}, {RELAXATION:?}]] }}\n\
         [[load]]\nset = \"block.top\"\ntotal_force = {}\n\
         [[probe]]\nname = \"top\"\nset = \"block.top\"\nquantity = \"displacement\"\n",
        choice.head("Creep", END),
        choice.cell_keys(),
        vector_ramp([FORCE, 0.0, 0.0])
    );
    text += &[fixed("block.bottom", "\"x\""), fixed("block.all", "\"y\", \"z\"")].concat();
    Ok(text)
}

/// Displacements at the quarters of the run.
fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let moved = probes.column("top.x")?;
    let at = |quarter: usize| moved.get(quarter * choice.steps as usize / 4).copied();
    Ok(vec![(1..=4).map(at).collect::<Option<_>>().ok_or("fewer rows than steps")?])
}

/// The compliance is `1/G - (1/G - 1) exp(-t/T)` with the final modulus `G` and `T = relaxation time / G`; under a force that grows at the rate 1 the shear is its integral.
fn compliance(_: &Run, _: &Choice) -> Outcome<Values> {
    let last = 1.0 - SHARE;
    let time = RELAXATION / last;
    let grown = |t: f64| t / last - (1.0 / last - 1.0) * time * (1.0 - (-t / time).exp());
    let moved = |t: f64| FORCE * (grown(t) - if t > 1.0 { grown(t - 1.0) } else { 0.0 });
    Ok(vec![[0.5, 1.0, 1.5, 2.0].map(moved).to_vec()])
}
