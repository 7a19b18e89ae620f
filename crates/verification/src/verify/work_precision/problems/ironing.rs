//! A stiff half cylinder that is pressed into a soft slab and drawn along it with friction.

use super::parts::fixed;
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const DEPTH: f64 = 0.2;
const WAY: f64 = 1.5;
/// It is pressed down until the time 1, and drawn until the end.
const END: f64 = 4.0;
/// General contact acts over a distance.
const GAP: f64 = 1e-3;

const BEST: Choice = Choice::direct("statics", "mortar dual", "hex8", 4, 32);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "ironing",
    title: "Ironing",
    about: "A half cylinder of radius 1 (neo-Hooke, Young's modulus 100) is pressed by 0.2 into a slab 5.5 x 1.5 (Young's modulus 1, Poisson's ratio 0.3 of both, plane strain) and drawn along it by 1.5, friction 0.3; \
            `mesh` elements of the slab a unit of length. Hard: large sliding over facets, at each of which forces jump. Values: the forces of the cylinder at 13 times from when it is down. The own error of the reference is its distance from that of dual multipliers.",
    quantities: &["vertical force", "horizontal force"],
    reference: Reference::Converged {
        by: Choice { method: "mortar", mesh: 12, ..BEST },
        coarser: Choice { mesh: 12, ..BEST },
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex8 mixed", "hex20"],
    meshes: &[2, 3, 4, 6],
    steps: &[16, 32, 64],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[],
    quick: 2,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let gap = if choice.method == "general" { GAP } else { 0.0 };
    let body = |name: &str, young: f64, mesh: String| {
        format!(
            "[[body]]\nname = \"{name}\"\n{}material = {{ law = \"neo-hooke\", young = {young:?}, poisson = 0.3 }}\nmesh = {{ {mesh} }}\n{}",
            choice.cell_keys(),
            fixed(&format!("{name}.all"), "\"y\"")
        )
    };
    let mut text = choice.head("Ironing", END);
    let half = n.div_ceil(2);
    let cylinder = format!(
        "generator = \"cylinder\", radius = 1.0, length = 0.2, part = \"half\", divisions = [{n}, {half}, {half}, 1]"
    );
    let top = -1.0 - gap;
    let slab = format!(
        "generator = \"block\", min = [-2.0, 0.0, {:?}], max = [3.5, 0.2, {top:?}], divisions = [{}, 1, {}]",
        top - 1.5,
        (11 * n).div_ceil(2),
        (3 * n).div_ceil(2)
    );
    text +=
        &[body("cylinder", 100.0, cylinder), body("slab", 1.0, slab), fixed("slab.bottom", "\"x\", \"z\"")].concat();
    let down = -DEPTH - gap;
    text += &format!(
        "[[prescribe]]\nset = \"cylinder.top\"\ncomponents = [\"x\", \"z\"]\ndisplacement = {{ table = [[0.0, 0.0, 0.0], [1.0, 0.0, {down:?}], [{END:?}, {WAY:?}, {down:?}]] }}\n\
         [[probe]]\nname = \"force\"\nset = \"cylinder.top\"\nquantity = \"reaction\"\n"
    );
    let friction = match choice.method {
        "general" => "friction = 0.3\n",
        _ => "friction = { law = \"coulomb\", mu = 0.3 }\n",
    };
    Ok(text + &choice.contact("cylinder.outer", "slab.top", friction)?)
}

/// Forces at the times 1, 1.25 and so on.
fn measure(run: &Run, choice: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let (times, across, along) = (probes.column("time")?, probes.column("force.z")?, probes.column("force.x")?);
    let step = END / f64::from(choice.steps);
    let rows: Vec<usize> = (4..=16)
        .filter_map(|quarter| times.iter().position(|time| (time - 0.25 * f64::from(quarter)).abs() < 1e-6 * step))
        .collect();
    Ok([across, along].map(|force| rows.iter().map(|row| force[*row]).collect()).to_vec())
}
