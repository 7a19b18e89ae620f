//! An elastic bar flies into a rigid wall with its end and leaves it: the wave equation.

use stoss_reference_cases::impacts::bar_on_wall;

use super::history::{METHODS, SCHEMES, at, floor, parts, probe};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex8", 32, 192);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "bar-impact",
    title: "Bar against a wall",
    about: "A bar of length 1 (Young's modulus and density 1, Poisson's ratio 0: the speed of waves is 1) meets a rigid wall flat with the speed 1e-4, and leaves it after two passages of the wave. What is hard: the \
            wave has a front. Values: momentum at 12 times over that of the flight, mean force in the middle half of the contact over rho c v A, momentum of the rebound, energy afterwards over that before.",
    quantities: &["momentum", "force", "rebound", "energy"],
    reference: Reference::Closed { source: "wave equation: force rho c v A for 2 L / c", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8", "hex20", "tet4", "tet10"],
    meshes: &[8, 16, 24, 32],
    steps: &[24, 48, 96, 192],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-6, 1e-9, 1e-12],
    // The law of impact takes the energy of the nodes at the surface, half an element at any step size.
    claims: &[
        Claim { line: "mesh", quantity: "energy", at_least: 0.98 },
        Claim { line: "mesh", quantity: "momentum", at_least: 0.6 },
    ],
    quick: 3,
};

const SPEED: f64 = 1e-4;
/// Of the impact and of the run.
const TIMES: [f64; 2] = [0.5, 3.0];

fn scene(choice: &Choice) -> Outcome<String> {
    let Choice { mesh, .. } = choice;
    let wide = 1.0 / f64::from(*mesh);
    let mut text = choice.head("Bar against a wall", TIMES[1]);
    text.push_str(&format!(
        "[[body]]\nname = \"bar\"\n{}mesh = {{ generator = \"block\", min = [0, 0, 0], max = [{wide:?}, {wide:?}, 1], divisions = [1, 1, {mesh}] }}\nposition = [0, 0, {:?}]\n\
         material = {{ law = \"saint-venant-kirchhoff\", young = 1.0, poisson = 0.0 }}\ndensity = 1.0\nvelocity = [0, 0, {:?}]\n",
        choice.cell_keys(),
        SPEED * TIMES[0],
        -SPEED
    ));
    text += &floor(2.0);
    text += &choice.contact("bar.bottom", "floor.all", "")?;
    text += &probe("p", "linear_momentum", "bar");
    text += &probe("e", "energy", "bar");
    Ok(text)
}

/// Momentum over that of the flight, and energy over that of the flight, from the tables.
fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let mass = f64::from(choice.mesh).powi(-2);
    let momentum = |times: &[f64]| -> Outcome<Vec<f64>> {
        Ok(at(&probes, "p.z", times)?.into_iter().map(|p| p / (mass * SPEED)).collect())
    };
    let [before, after] = [0.5, 1.5].map(|passages| TIMES[0] + passages);
    let middle = momentum(&[before, after])?;
    let energy = at(&probes, "e", &[TIMES[1]])?[0] / (0.5 * mass * SPEED * SPEED);
    Ok(vec![momentum(&parts(12, TIMES[1]))?, vec![middle[1] - middle[0]], momentum(&[TIMES[1]])?, vec![energy]])
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let momentum = parts(12, TIMES[1]).into_iter().map(|time| bar_on_wall(time - TIMES[0])).collect();
    Ok(vec![momentum, vec![1.0], vec![1.0], vec![1.0]])
}
