//! A block falls obliquely on a larger one, in plane strain.

use super::history::{METHODS, SCHEMES, at, parts, probe};
use super::plane;
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex8", 8, 96);

const FINE: Choice = Choice { method: "mortar", mesh: 16, steps: 192, ..BEST };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "block-impact",
    title: "Block against block",
    about: "An elastic block 1 x 1 (Young's modulus 1e6, Poisson's ratio 0.3, density 1000) hits a free one 2 x 1 off its middle with the velocity (1, -2), in plane strain and without friction; the meshes do not match. \
            General contact has no sections and takes a slice of the same mesh. What is hard: edges press with a singular pressure, and both blocks vibrate. Values: momentum of the upper block across the interface at 12 times, \
            the impulse that it got, its angular momentum and its energy at the end.",
    quantities: &["momentum", "impulse", "angular momentum", "energy"],
    reference: Reference::Converged { by: FINE, coarser: Choice { mesh: 12, ..FINE } },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8", "hex20"],
    meshes: &[4, 6, 8, 10],
    steps: &[24, 48, 96, 192],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-6, 1e-9],
    claims: &[],
    quick: 2,
};

const END: f64 = 0.12;

/// Elements of the lower block along its length and height: coarser ones, of another number than those of the upper block above them.
fn lower(mesh: u32) -> [u32; 2] {
    [7 * mesh / 5, 7 * mesh / 10]
}

fn scene(choice: &Choice) -> Outcome<String> {
    let law = "material = { law = \"neo-hooke\", young = 1e6, poisson = 0.3 }\ndensity = 1000.0\n";
    let mut text = plane::head(choice, "Block against block", END);
    text += &plane::body(choice, "lower", [[0.0, 0.0], [2.0, 1.0]], lower(choice.mesh), law);
    let flies = format!("{law}velocity = [1, -2, 0]\n");
    text += &plane::body(choice, "upper", [[0.2, 1.02], [1.2, 2.02]], [choice.mesh; 2], &flies);
    let [below, above] = plane::sides(choice);
    text += &choice.contact(&format!("upper.{below}"), &format!("lower.{above}"), "")?;
    text += &probe("p", "linear_momentum", "upper");
    text += &probe("j", "angular_momentum", "upper");
    text += &probe("e", "energy", "upper");
    Ok(text)
}

fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let of = |column: &str, times: &[f64]| -> Outcome<Vec<f64>> {
        Ok(at(&probes, column, times)?.into_iter().map(|value| value / plane::thickness(choice)).collect())
    };
    let momentum = of("p.y", &parts(12, END))?;
    let impulse = of("p.y", &[0.0, END])?;
    Ok(vec![momentum, vec![impulse[1] - impulse[0]], of("j.z", &[END])?, of("e", &[END])?])
}
