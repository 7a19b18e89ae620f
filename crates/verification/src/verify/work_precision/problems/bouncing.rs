//! Rigid boxes bounce flat on a floor, each in another phase of the step.

use stoss_reference_cases::impacts::Bounces;

use super::history::{METHODS, SCHEMES, apart, at, floor, probe, restitution};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex8", 1, 130);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "bouncing",
    title: "Boxes that bounce",
    about: "Four rigid boxes (mass 1, edges 0.2) fall flat from a height of 1 and a few steps more, each in another phase of the step, under a gravity of 1, and bounce with the restitution 0.8. No two meet the floor \
            in one step. What is hard: the impact lies anywhere in a step. Values: heights to which the energy of each box suffices after its first and second impact; its height in the middle of the flights after them.",
    quantities: &["apex", "height"],
    reference: Reference::Closed { source: "e^2k h, and the parabolas between the impacts", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8"],
    meshes: &[1],
    steps: &[65, 130, 260, 520],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[Claim { line: "step", quantity: "height", at_least: 0.9 }],
    quick: 4,
};

const END: f64 = 6.5;
const EDGE: f64 = 0.2;
const RESTITUTION: f64 = 0.8;

/// The flight of each box: in a step it falls by the square root of two times the step before it meets the floor.
fn flights(choice: &Choice) -> Vec<Bounces> {
    let step = END / f64::from(choice.steps);
    let height = |(_, shift): (usize, f64)| 1.0 + 2.0_f64.sqrt() * step * shift;
    apart().map(|phase| Bounces { height: height(phase), gravity: 1.0, restitution: RESTITUTION }).collect()
}

/// Middles of the flights after the first and the second impact.
fn middles(flight: &Bounces) -> [f64; 2] {
    [0, 1].map(|k| 0.5 * (flight.impact(k) + flight.impact(k + 1)))
}

fn scene(choice: &Choice) -> Outcome<String> {
    let mut text = choice.head("Boxes that bounce", END) + "[gravity]\nacceleration = [0, 0, -1]\n" + &floor(4.0);
    let law = restitution(choice, RESTITUTION)?;
    for (k, flight) in flights(choice).iter().enumerate() {
        text += &format!(
            "[[rigid]]\nname = \"box{k}\"\nshape = {{ kind = \"box\", size = [{EDGE:?}, {EDGE:?}, {EDGE:?}] }}\nmass = 1.0\n\
             inertia = [{0:?}, {0:?}, {0:?}]\nposition = [{k}, 0, {1:?}]\n",
            EDGE * EDGE / 6.0,
            flight.height + 0.5 * EDGE
        );
        text += &choice.contact(&format!("box{k}.bottom"), "floor.all", &law)?;
        text += &probe(&format!("k{k}"), "kinetic_energy", &format!("box{k}"));
        text += &probe(&format!("x{k}"), "position", &format!("box{k}"));
    }
    Ok(text)
}

fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let (mut apexes, mut heights) = (Vec::new(), Vec::new());
    for (k, flight) in flights(choice).iter().enumerate() {
        let times = middles(flight);
        let kinetic = at(&probes, &format!("k{k}"), &times)?;
        let places = at(&probes, &format!("x{k}.z"), &times)?;
        heights.extend(places.iter().map(|z| z - 0.5 * EDGE));
        apexes.extend(kinetic.iter().zip(places).map(|(kinetic, z)| kinetic + z - 0.5 * EDGE));
    }
    Ok(vec![apexes, heights])
}

fn closed(_: &Run, choice: &Choice) -> Outcome<Values> {
    let (mut apexes, mut heights) = (Vec::new(), Vec::new());
    for flight in flights(choice) {
        apexes.extend([1, 2].map(|k| flight.apex(k)));
        heights.extend(middles(&flight).into_iter().zip([0, 1]).map(|(time, k)| flight.place(k, time)));
    }
    Ok(vec![apexes, heights])
}
