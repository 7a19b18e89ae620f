//! A cantilever swings against a stop, in plane strain.

use super::history::{METHODS, SCHEMES, at, parts, probe};
use super::plane;
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex20", 2, 120);

const FINE: Choice = Choice { method: "mortar", mesh: 4, steps: 240, ..BEST };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "cantilever-stop",
    title: "Cantilever against a stop",
    about: "A cantilever 2 x 0.5 in plane strain (Young's modulus 1000, Poisson's ratio 0, density 1), clamped at its left end, turns with 0.1 about it at the start and hits a rigid stop below its right end after 0.25; \
            `mesh` elements over its height. General contact has no sections and takes a slice of the same mesh. What is hard: the end chatters on the stop with the higher modes, so that small steps find other impacts. \
            Values: deflections of the end and of the middle at 8 times, momentum across at these times.",
    quantities: &["deflection", "momentum"],
    reference: Reference::Converged { by: FINE, coarser: Choice { steps: 120, ..FINE } },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8", "hex20"],
    meshes: &[1, 2, 3, 4],
    steps: &[30, 60, 120, 240],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-6, 1e-9],
    claims: &[],
    quick: 2,
};

const END: f64 = 1.2;
const SIZE: [f64; 2] = [2.0, 0.5];
const GAP: f64 = 0.05;

fn scene(choice: &Choice) -> Outcome<String> {
    let ([long, high], mesh) = (SIZE, choice.mesh);
    let mut text = plane::head(choice, "Cantilever against a stop", END);
    let law = "material = { law = \"saint-venant-kirchhoff\", young = 1000.0, poisson = 0.0 }\ndensity = 1.0\nvelocity_gradient = [[0, 0, 0], [-0.1, 0, 0], [0, 0, 0]]\n";
    text += &plane::body(choice, "arm", [[0.0; 2], SIZE], [4 * mesh, mesh], law);
    text += "[[prescribe]]\nset = \"arm.left\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n";
    // Under the last three eighths of the arm.
    text += &format!(
        "[[rigid]]\nname = \"stop\"\nshape = {{ kind = \"box\", size = [1.0, 0.5, 4.0] }}\nposition = [{:?}, {:?}, 0]\nfixed = true\n",
        long - 0.25,
        -0.25 - GAP
    );
    text += &choice.contact(&format!("arm.{}", plane::sides(choice)[0]), "stop.back", "")?;
    for (name, x) in [("end", long), ("middle", 0.5 * long)] {
        text += &(probe(name, "displacement", "arm") + &format!("point = [{x:?}, {high:?}, 0]\n"));
    }
    text += &probe("p", "linear_momentum", "arm");
    Ok(text)
}

fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let of = |column: &str| at(&probes, column, &parts(8, END));
    let momentum = of("p.y")?.into_iter().map(|p| p / plane::thickness(choice)).collect();
    Ok(vec![[of("end.y")?, of("middle.y")?].concat(), momentum])
}
