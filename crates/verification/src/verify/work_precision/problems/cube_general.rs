//! A cube that is pressed onto a plate.

use super::parts::{fixed, ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

/// General contact acts over a distance.
const GAP: f64 = 1e-3;

const BEST: Choice =
    Choice { scheme: "statics", method: "general", cell: "hex8", mesh: 4, steps: 4, solver: "direct", tolerance: 1e-9 };

/// Contact without a distance.
const EXACT: Choice = Choice { method: "mortar", cell: "hex20", steps: 2, ..BEST };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "cube-general",
    title: "Cube on a plate under general contact",
    about: "A quarter of a neo-Hooke cube of side 1 is pressed by 0.05 onto a plate 2 x 2 x 0.5 (Young's modulus 1000, Poisson's ratio 0.3 of both); `mesh` elements over half of the cube, 1.5 times as many over half of the plate. \
            Hard: sharp edges stand on a face, with a singular pressure. General contact has a layer, the pressure of which ends beyond the edge. Values: the force, and the displacements of the middle and of the corner of the cube's bottom.",
    quantities: &["force", "displacements of the bottom"],
    reference: Reference::Converged { by: Choice { mesh: 8, ..EXACT }, coarser: Choice { mesh: 6, ..EXACT } },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex8 mixed", "hex20"],
    meshes: &[2, 3, 4, 6],
    steps: &[1, 2, 4, 8],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "force", at_least: 0.9 }],
    quick: 3,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let gap = if choice.method == "general" { GAP } else { 0.0 };
    let finer = n + n.div_ceil(2);
    let mut text = choice.head("Cube on a plate", 1.0);
    for (name, low, high, divisions) in [
        ("cube", [0.0, 0.0, gap], [0.5, 0.5, 1.0 + gap], [n, n, 2 * n]),
        ("plate", [0.0, 0.0, -0.5], [1.0, 1.0, 0.0], [finer, finer, finer.div_ceil(2)]),
    ] {
        text += &format!(
            "[[body]]\nname = \"{name}\"\n{}material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"block\", min = {low:?}, max = {high:?}, divisions = {divisions:?} }}\n",
            choice.cell_keys()
        );
        text += &[fixed(&format!("{name}.left"), "\"x\""), fixed(&format!("{name}.front"), "\"y\"")].concat();
    }
    text += &fixed("plate.bottom", "\"z\"");
    text += &format!("[[prescribe]]\nset = \"cube.top\"\ncomponents = [\"z\"]\ndisplacement = {}\n", ramp(-0.05 - gap));
    text += "[[probe]]\nname = \"force\"\nset = \"plate.bottom\"\nquantity = \"reaction\"\n";
    for (name, x) in [("middle", 0.0), ("corner", 0.5)] {
        text += &format!(
            "[[probe]]\nname = \"{name}\"\nquantity = \"position\"\nbody = \"cube\"\npoint = [{x:?}, {x:?}, {gap:?}]\n"
        );
    }
    Ok(text + &choice.contact("cube.bottom", "plate.top", "")?)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let corner = last(&probes, &["corner.x", "corner.z"])?;
    let moved = vec![last(&probes, &["middle.z"])?[0], corner[0] - 0.5, corner[1]];
    Ok(vec![last(&probes, &["force.z"])?, moved])
}
