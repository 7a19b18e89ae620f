//! Rigid blocks slide on a rough floor until they rest, each with another phase of the step in which it stops.

use super::history::{METHODS, SCHEMES, at, floor, phases, probe};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex8", 1, 60);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "sliding-block",
    title: "Blocks that slide to rest",
    about: "Four rigid blocks 1 x 1 x 0.2 (mass 1) slide with the speed 1 and a little more, on a floor with Coulomb friction (mu 0.25, gravity 10), each of which stops in another phase of the step. What is hard: slip ends anywhere in a step. Values: ways until they rest, ways at 0.2 while all slide.",
    quantities: &["way to rest", "way while sliding"],
    reference: Reference::Closed { source: "v^2 / (2 mu g), and v t - mu g t^2 / 2", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8"],
    meshes: &[1],
    steps: &[15, 30, 60, 120, 240],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[Claim { line: "step", quantity: "way to rest", at_least: 1.9 }],
    quick: 4,
};

const END: f64 = 0.6;
const FRICTION: f64 = 0.25;
const GRAVITY: f64 = 10.0;
/// All slide until then.
const SLIDING: f64 = 0.2;

/// Speeds at the start: those of blocks that stop after 0.4 and parts of a step.
fn speeds(choice: &Choice) -> Vec<f64> {
    let step = END / f64::from(choice.steps);
    phases().map(|(_, phase)| FRICTION * GRAVITY * (0.4 + phase * step)).collect()
}

fn scene(choice: &Choice) -> Outcome<String> {
    let mut text = choice.head("Blocks that slide to rest", END);
    text += &format!("[gravity]\nacceleration = [0, 0, {:?}]\n", -GRAVITY);
    text += &floor(20.0);
    for (k, speed) in speeds(choice).into_iter().enumerate() {
        text += &format!(
            "[[rigid]]\nname = \"block{k}\"\nshape = {{ kind = \"box\", size = [1, 1, 0.2] }}\ndensity = 5.0\nposition = [0, {}, 0.1]\nvelocity = [{speed:?}, 0, 0]\n",
            2 * k
        );
        if choice.method != "general" {
            let law = format!("friction = {{ law = \"coulomb\", mu = {FRICTION:?} }}\n");
            text += &choice.contact(&format!("block{k}.bottom"), "floor.all", &law)?;
        }
        text += &probe(&format!("x{k}"), "position", &format!("block{k}"));
    }
    if choice.method == "general" {
        text += &choice.contact("", "", &format!("friction = {FRICTION:?}\n"))?;
    }
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let (mut to_rest, mut sliding) = (Vec::new(), Vec::new());
    for (k, _) in phases() {
        let ways = at(&probes, &format!("x{k}.x"), &[SLIDING, END])?;
        sliding.push(ways[0]);
        to_rest.push(ways[1]);
    }
    Ok(vec![to_rest, sliding])
}

fn closed(_: &Run, choice: &Choice) -> Outcome<Values> {
    let braking = FRICTION * GRAVITY;
    let to_rest = speeds(choice).into_iter().map(|v| 0.5 * v * v / braking).collect();
    let sliding = speeds(choice).into_iter().map(|v| (v - 0.5 * braking * SLIDING) * SLIDING).collect();
    Ok(vec![to_rest, sliding])
}
