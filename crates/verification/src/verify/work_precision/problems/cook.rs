//! Cook's membrane, nearly incompressible, at large strains.

use super::parts::{fixed, vector_ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("statics", "none", "hex27 mixed", 6, 5);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "cook",
    title: "Cook's membrane, nearly incompressible",
    about: "A tapered neo-Hooke panel, 48 long, 44 high at the clamp and 16 at its free end, 1 thick in plane strain (shear modulus 80.1938, lambda 400942: Poisson's ratio 0.4999), under a shear force of 100 at its free end; \
            `mesh` elements along each direction. Hard: cells without a mixed form lock; the upper corner of the clamp has a singular stress.",
    quantities: &["displacement of the corner"],
    reference: Reference::Converged {
        by: Choice { mesh: 32, steps: 2, ..BEST },
        coarser: Choice { mesh: 24, steps: 2, ..BEST },
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["hex8", "hex8 mixed", "hex20", "hex20 mixed", "hex27 mixed", "tet10 mixed", "wedge15 mixed"],
    meshes: &[2, 4, 6, 10],
    steps: &[2, 5, 10],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-3, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "displacement of the corner", at_least: 1.0 }],
    quick: 3,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let outline = [[0.0, 0.0], [48.0, 44.0], [48.0, 60.0], [0.0, 44.0]];
    let corners = [0.0, 1.0].map(|z| outline.map(|[x, y]| [x, y, z])).concat();
    let n = choice.mesh;
    Ok(format!(
        "{}[[body]]\nname = \"panel\"\n{}material = {{ law = \"neo-hooke\", lambda = 400942.0, mu = 80.1938 }}\n\
         mesh = {{ generator = \"hexahedron\", corners = {corners:?}, divisions = [{n}, {n}, 1] }}\n{}{}\
         [[load]]\nset = \"panel.right\"\ntotal_force = {}\n\
         [[probe]]\nname = \"corner\"\nquantity = \"displacement\"\nbody = \"panel\"\npoint = [48, 60, 0]\n",
        choice.head("Cook's membrane", 1.0),
        choice.cell_keys(),
        fixed("panel.left", "\"x\", \"y\""),
        fixed("panel.all", "\"z\""),
        vector_ramp([0.0, 100.0, 0.0])
    ))
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    Ok(vec![last(&run.table("probes.csv")?, &["corner.x", "corner.y"])?])
}
