//! A free bar that spins and stretches: smooth, so that each scheme shows its order.

use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "none", "hex8", 4, 32);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "spinning-bar",
    title: "Bar that spins and stretches",
    about: "A neo-Hooke bar 1 x 1 x 4 (Young's modulus 2250, Poisson's ratio 0.3, density 0.1) flies freely, turns by half a radian and stretches meanwhile. Values: positions of three corners at the end.",
    quantities: &["positions"],
    reference: Reference::Converged { by: Choice { steps: 4096, ..BEST }, coarser: Choice { steps: 2048, ..BEST } },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["energy-momentum", "midpoint", "backward-euler", "generalised-alpha", "newmark"],
    methods: &["none"],
    cells: &["hex8"],
    meshes: &[4],
    steps: &[16, 32, 64, 128, 256],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[Claim { line: "step", quantity: "positions", at_least: 1.9 }],
    quick: 4,
};

const END: f64 = 0.016;

const PROBES: [(&str, &str); 3] = [("a", "[0, 0, 0]"), ("b", "[1, 0, 4]"), ("c", "[0, 1, 4]")];

fn scene(choice: &Choice) -> Outcome<String> {
    let Choice { mesh, .. } = choice;
    let mut text = choice.head("Spinning bar", END);
    text.push_str(&format!(
        "[[body]]\nname = \"bar\"\n{}mesh = {{ generator = \"block\", size = [1, 1, 4], divisions = [1, 1, {mesh}] }}\n\
         material = {{ law = \"neo-hooke\", young = 2250.0, poisson = 0.3 }}\ndensity = 0.1\nangular_velocity = [30, 0, 10]\n\
         velocity_gradient = [[0, 0, 0], [0, 0, 0], [0, 0, 20]]\n",
        choice.cell_keys()
    ));
    for (name, at) in PROBES {
        text.push_str(&format!(
            "[[probe]]\nname = \"{name}\"\nquantity = \"position\"\nbody = \"bar\"\npoint = {at}\n"
        ));
    }
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let mut places = Vec::new();
    for (name, _) in PROBES {
        places.extend(last(&probes, &["x", "y", "z"].map(|i| format!("{name}.{i}")))?);
    }
    Ok(vec![places])
}
