//! A cantilever of two bars of meshes that do not match, tied to each other.

use super::parts::{fixed, vector_ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const BEST: Choice =
    Choice { scheme: "statics", method: "tie", cell: "hex20", mesh: 3, steps: 2, solver: "direct", tolerance: 1e-9 };

/// One body, not tied.
const WHOLE: Choice = Choice { method: "none", cell: "hex27", ..BEST };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "tied-bars",
    title: "Tied bars under bending",
    about: "A neo-Hooke cantilever 8 x 1 x 1 (Young's modulus 1000, Poisson's ratio 0.3) of two halves under a dead force of 0.5 at its tip, which goes down by two thirds of its length; \
            `mesh` elements over the height of the first half, 1.5 times as many of the second one. Hard: the whole moment passes through a tie of meshes that do not match. Method none is one body.",
    quantities: &["displacement of the tip", "displacement at the tie"],
    reference: Reference::Converged { by: Choice { mesh: 10, ..WHOLE }, coarser: Choice { mesh: 8, ..WHOLE } },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["tie", "tie dual", "none"],
    cells: &["hex8", "hex20", "hex20 reduced", "hex27", "tet10"],
    meshes: &[1, 2, 3, 4],
    steps: &[1, 2, 4],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "displacement of the tip", at_least: 1.5 }],
    quick: 3,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let body = |name: &str, [start, end]: [f64; 2], [along, n]: [u32; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\n{}material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"block\", min = [{start:?}, 0, 0], max = [{end:?}, 0.5, 1], divisions = [{along}, {}, {n}] }}\n{}",
            choice.cell_keys(),
            n.div_ceil(2),
            fixed(&format!("{name}.front"), "\"y\"")
        )
    };
    let mut text = choice.head("Tied bars", 1.0);
    let tip = if choice.method == "none" {
        text += &body("root", [0.0, 8.0], [4 * n, n]);
        "root"
    } else {
        let finer = n + n.div_ceil(2);
        text += &[body("root", [0.0, 4.0], [2 * n, n]), body("arm", [4.0, 8.0], [2 * finer, finer])].concat();
        let form = match choice.method {
            "tie" => "standard",
            "tie dual" => "dual",
            other => return Err(format!("{other} ties no surfaces").into()),
        };
        text += &format!("[[tie]]\nslave = \"arm.left\"\nmaster = \"root.right\"\nmultipliers = \"{form}\"\n");
        "arm"
    };
    text += &fixed("root.left", "\"x\", \"y\", \"z\"");
    // Half of the width is modelled.
    text += &format!("[[load]]\nset = \"{tip}.right\"\ntotal_force = {}\n", vector_ramp([0.0, 0.0, -0.25]));
    for (name, body, x) in [("tip", tip, 8), ("middle", "root", 4)] {
        text += &format!(
            "[[probe]]\nname = \"{name}\"\nquantity = \"displacement\"\nbody = \"{body}\"\npoint = [{x}, 0, 1]\n"
        );
    }
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    Ok(vec![last(&probes, &["tip.x", "tip.z"])?, last(&probes, &["middle.x", "middle.z"])?])
}
