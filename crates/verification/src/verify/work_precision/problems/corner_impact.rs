//! Tilted rigid cubes meet a floor with a corner, each in another phase of the step.

use stoss_reference_cases::impacts::{Corner, lowest_corner};

use super::history::{METHODS, SCHEMES, apart, at, floor, probe, restitution};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex8", 1, 64);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "corner-impact",
    title: "Cubes that meet a floor with a corner",
    about: "Four rigid cubes (mass 1, edges 1), turned by 40 degrees about (1, 2, 0.5), meet a frictionless floor with a corner, each in another phase of the step, with the speed 1 and the restitution 1 (general \
            contact: a layer of modulus 1e4). What is hard: they turn within the step of the impact. Values: velocities of the centres afterwards, angular velocities.",
    quantities: &["velocity", "spin"],
    reference: Reference::Closed { source: "impulse (1 + e) v / (1/m + |r x n|^2 / J) at the corner", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8"],
    meshes: &[1],
    steps: &[16, 32, 64, 128, 256],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[
        Claim { line: "step", quantity: "velocity", at_least: 0.95 },
        Claim { line: "step", quantity: "spin", at_least: 0.95 },
    ],
    quick: 5,
};

const END: f64 = 0.32;
const AXIS: [f64; 3] = [1.0, 2.0, 0.5];
const DEGREES: f64 = 40.0;
/// Flight until the first one meets the floor, less a part of a step.
const FLIGHT: f64 = 0.02;

/// The impact of each of them.
fn impact() -> Corner {
    Corner { mass: 1.0, inertia: 1.0 / 6.0, arm: lowest_corner(AXIS, DEGREES), speed: 1.0, restitution: 1.0 }
}

fn scene(choice: &Choice) -> Outcome<String> {
    let (step, corner) = (END / f64::from(choice.steps), impact());
    let mut text = choice.head("Cubes that meet a floor with a corner", END) + &floor(10.0);
    for (k, shift) in apart() {
        text += &format!(
            "[[rigid]]\nname = \"cube{k}\"\nshape = {{ kind = \"box\", size = [1, 1, 1] }}\nmass = 1.0\ninertia = [{0:?}, {0:?}, {0:?}]\n\
             position = [{1}, 0, {2:?}]\nrotation = {{ axis = {AXIS:?}, degrees = {DEGREES:?} }}\nvelocity = [0, 0, {3:?}]\n",
            corner.inertia,
            3 * k,
            corner.speed * (FLIGHT + shift * step) - corner.arm[2],
            -corner.speed
        );
        if choice.method != "general" {
            let law = restitution(choice, corner.restitution)?;
            text += &choice.contact(&format!("cube{k}.all"), "floor.all", &law)?;
        }
        text += &probe(&format!("v{k}"), "velocity", &format!("cube{k}"));
        text += &probe(&format!("w{k}"), "angular_velocity", &format!("cube{k}"));
    }
    if choice.method == "general" {
        text += &choice.contact("", "", "modulus = 1e4\n")?;
    }
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let (mut velocities, mut spins) = (Vec::new(), Vec::new());
    for (k, _) in apart() {
        velocities.extend(at(&probes, &format!("v{k}.z"), &[END])?);
        for component in ["x", "y", "z"] {
            spins.extend(at(&probes, &format!("w{k}.{component}"), &[END])?);
        }
    }
    Ok(vec![velocities, spins])
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let (velocity, spin) = impact().after();
    Ok(vec![apart().map(|_| velocity).collect(), apart().flat_map(|_| spin).collect()])
}
