//! A trebuchet of rigid parts throws a stone.

use stoss_reference_cases::multibody::trebuchet::{Points, Trebuchet};

use super::history::{SCHEMES, at, parts, probe};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "none", "hex8", 1, 200);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "trebuchet",
    title: "Trebuchet",
    about: "A rigid lever (arms 0.86 and 0.23, 0.35 kg) on a hinge, a hanging weight of 50 kg, a stone of 0.65 kg on a sling of 0.34, from rest, for 0.5 s; m, kg, s. What is hard: the sling, a distance joint, goes round \
            fast at the end. Values: places of the stone at 10 times, places of the weight.",
    quantities: &["stone", "weight"],
    reference: Reference::Closed {
        source: "Lagrange's equations of three angles by the method of Runge and Kutta, energy kept to 1e-14",
        values: closed,
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: &["none"],
    cells: &["hex8"],
    meshes: &[1],
    steps: &[50, 100, 200, 400, 800],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[
        Claim { line: "step", quantity: "stone", at_least: 1.95 },
        Claim { line: "midpoint", quantity: "stone", at_least: 1.95 },
        Claim { line: "generalised-alpha", quantity: "stone", at_least: 1.95 },
        Claim { line: "newmark", quantity: "stone", at_least: 1.95 },
    ],
    quick: 5,
};

const END: f64 = 0.5;
const MACHINE: Trebuchet = Trebuchet {
    arms: [0.86, 0.23],
    lever: 0.35,
    weight: 50.0,
    inertia: 0.37,
    hanger: 0.2,
    stone: 0.65,
    sling: 0.34,
    gravity: 9.81,
    start: [0.35, 0.0, 0.175],
};

fn scene(choice: &Choice) -> Outcome<String> {
    let Points { long, short, lever, weight, stone } = MACHINE.points(MACHINE.start);
    let place = |[x, z]: [f64; 2]| format!("[{x:?}, 0, {z:?}]");
    let mut text = choice.head("Trebuchet", END);
    text += &format!("[gravity]\nacceleration = [0, 0, {:?}]\n", -MACHINE.gravity);
    let rigid = [("lever", MACHINE.lever, MACHINE.rod(), lever), ("weight", MACHINE.weight, MACHINE.inertia, weight)];
    for (name, mass, inertia, at) in rigid {
        text += &format!(
            "[[rigid]]\nname = \"{name}\"\nmass = {mass:?}\ninertia = [{inertia:?}, {inertia:?}, {inertia:?}]\nposition = {}\n",
            place(at)
        );
    }
    text += &format!("[[mass]]\nname = \"stone\"\nmass = {:?}\nat = {}\n", MACHINE.stone, place(stone));
    for (name, between, at) in [("pivot", ["ground", "lever"], [0.0; 2]), ("hanger", ["lever", "weight"], short)] {
        text += &format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"hinge\"\nbetween = {between:?}\nat = {}\naxis = [0, 1, 0]\n",
            place(at)
        );
    }
    text += &format!(
        "[[joint]]\nname = \"sling\"\nkind = \"distance\"\nbetween = [\"lever\", \"stone\"]\nat = [{}, {}]\n",
        place(long),
        place(stone)
    );
    text += &(probe("stone", "position", "stone") + &probe("weight", "position", "weight"));
    Ok(text)
}

/// Values of the stone, then of the weight: x at all times, then z.
fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let places = |name: &str| -> Outcome<Vec<f64>> {
        let [x, z] = ["x", "z"].map(|i| at(&probes, &format!("{name}.{i}"), &parts(10, END)));
        Ok([x?, z?].concat())
    };
    Ok(vec![places("stone")?, places("weight")?])
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let angles = |time: &f64| {
        let [lever, hanger, sling, ..] = MACHINE.state(*time, 4000);
        MACHINE.points([lever, hanger, sling])
    };
    let points: Vec<Points> = parts(10, END).iter().map(angles).collect();
    let places = |of: fn(&Points) -> [f64; 2]| {
        [0, 1].map(|i| points.iter().map(move |p| of(p)[i])).into_iter().flatten().collect()
    };
    Ok(vec![places(|p| p.stone), places(|p| p.weight)])
}
