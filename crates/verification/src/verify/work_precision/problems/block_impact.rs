//! A block falls obliquely on a larger one, in plane strain.

use super::history::{METHODS, SCHEMES, at, parts, probe};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice {
    scheme: "energy-momentum",
    method: "nts",
    cell: "hex8",
    mesh: 8,
    steps: 96,
    solver: "direct",
    tolerance: 1e-9,
};

const FINE: Choice = Choice { method: "mortar", mesh: 24, steps: 192, ..BEST };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "block-impact",
    title: "Block against block",
    about: "An elastic block 1 x 1 (Young's modulus 1e6, Poisson's ratio 0.3, density 1000) hits a free one 2 x 1 off its middle with the velocity (1, -2), in plane strain and without friction; the meshes do not match. \
            General contact has no sections and takes a slice of the same mesh. What is hard: edges press with a singular pressure, and both blocks vibrate. Values: momentum of the upper block across the interface at 12 times, \
            the impulse that it got, its angular momentum and its energy at the end.",
    quantities: &["momentum", "impulse", "angular momentum", "energy"],
    reference: Reference::Converged { by: FINE, coarser: Choice { mesh: 16, steps: 192, ..FINE } },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8", "hex20", "hex27"],
    meshes: &[4, 6, 8, 12, 16],
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

fn block(choice: &Choice, name: &str, [min, max]: [[f64; 2]; 2], [along, high]: [u32; 2]) -> String {
    let ([x0, y0], [x1, y1]) = (min, max);
    let thick = thickness(choice);
    let (mesh, held) = match choice.method {
        "general" => (
            format!(
                "generator = \"block\", min = [{x0:?}, {y0:?}, 0], max = [{x1:?}, {y1:?}, {thick:?}], divisions = [{along}, {high}, 1]"
            ),
            format!("[[prescribe]]\nset = \"{name}.all\"\ncomponents = [\"z\"]\nfixed = true\n"),
        ),
        _ => (
            format!("generator = \"rectangle\", min = {min:?}, max = {max:?}, divisions = [{along}, {high}]"),
            String::new(),
        ),
    };
    let velocity = if name == "upper" { "velocity = [1, -2, 0]\n" } else { "" };
    format!(
        "[[body]]\nname = \"{name}\"\n{}mesh = {{ {mesh} }}\nmaterial = {{ law = \"neo-hooke\", young = 1e6, poisson = 0.3 }}\ndensity = 1000.0\n{velocity}{held}",
        choice.cell_keys()
    )
}

/// Thickness of what is modelled.
fn thickness(choice: &Choice) -> f64 {
    if choice.method == "general" { 1.0 / f64::from(choice.mesh) } else { 1.0 }
}

fn scene(choice: &Choice) -> Outcome<String> {
    let head = choice.head("Block against block", END);
    let mut text = match choice.method {
        "general" => head,
        _ => head.replacen("[time]", "section = \"plane-strain\"\n[time]", 1),
    };
    text += &block(choice, "lower", [[0.0, 0.0], [2.0, 1.0]], lower(choice.mesh));
    text += &block(choice, "upper", [[0.2, 1.02], [1.2, 2.02]], [choice.mesh; 2]);
    text += &choice.contact("upper.bottom", "lower.top", "")?;
    text += &probe("p", "linear_momentum", "upper");
    text += &probe("j", "angular_momentum", "upper");
    text += &probe("e", "energy", "upper");
    Ok(text)
}

fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let of = |column: &str, times: &[f64]| -> Outcome<Vec<f64>> {
        Ok(at(&probes, column, times)?.into_iter().map(|value| value / thickness(choice)).collect())
    };
    let momentum = of("p.y", &parts(12, END))?;
    let impulse = of("p.y", &[0.0, END])?;
    Ok(vec![momentum, vec![impulse[1] - impulse[0]], of("j.z", &[END])?, of("e", &[END])?])
}
