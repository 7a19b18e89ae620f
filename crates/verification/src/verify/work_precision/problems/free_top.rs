//! A free rigid body with three different moments of inertia.

use stoss_reference_cases::multibody::top::FreeTop;

use super::history::{SCHEMES, at, parts, probe};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "none", "hex8", 1, 320);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "free-top",
    title: "Free top",
    about: "A rigid body with the moments of inertia 0.3, 0.5, 0.6 turns freely by nearly three turns, and tumbles. Smooth. Values: angular velocity about its principal axes at 8 times; kinetic energy.",
    quantities: &["angular velocity", "energy"],
    reference: Reference::Closed {
        source: "Jacobi's elliptic functions (Landau and Lifshitz, Mechanics, section 37)",
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
    steps: &[40, 80, 160, 320, 640],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[
        Claim { line: "step", quantity: "angular velocity", at_least: 1.95 },
        Claim { line: "midpoint", quantity: "angular velocity", at_least: 1.95 },
        Claim { line: "generalised-alpha", quantity: "angular velocity", at_least: 1.95 },
    ],
    quick: 5,
};

const END: f64 = 8.0;
const TOP: FreeTop = FreeTop { inertia: [0.3, 0.5, 0.6], start: [1.0, 2.0] };

fn scene(choice: &Choice) -> Outcome<String> {
    let ([w1, w3], inertia) = (TOP.start, TOP.inertia);
    let mut text = choice.head("Free top", END);
    text += &format!(
        "[[rigid]]\nname = \"top\"\nmass = 1.0\ninertia = {inertia:?}\nshape = {{ kind = \"box\", size = [2, 2, 2] }}\nangular_velocity = [{w1:?}, 0, {w3:?}]\n"
    );
    // Points on the principal axes, for their directions.
    for (k, point) in ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"].iter().enumerate() {
        text += &(probe(&format!("d{k}"), "position", "top") + &format!("point = {point}\n"));
    }
    text += &probe("w", "angular_velocity", "top");
    text += &probe("k", "kinetic_energy", "top");
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let times = parts(8, END);
    let vectors = |name: &str| -> Outcome<Vec<Vec<f64>>> {
        ["x", "y", "z"].iter().map(|i| at(&probes, &format!("{name}.{i}"), &times)).collect()
    };
    let w = vectors("w")?;
    let mut about_axes = Vec::new();
    for k in 0..3 {
        let d = vectors(&format!("d{k}"))?;
        about_axes.extend((0..times.len()).map(|t| (0..3).map(|i| w[i][t] * d[i][t]).sum::<f64>()));
    }
    Ok(vec![about_axes, at(&probes, "k", &[END])?])
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let times = parts(8, END);
    let about_axes = (0..3).flat_map(|k| times.iter().map(move |time| TOP.angular_velocity(*time)[k])).collect();
    let [w1, w3] = TOP.start;
    Ok(vec![about_axes, vec![0.5 * (TOP.inertia[0] * w1 * w1 + TOP.inertia[2] * w3 * w3)]])
}
