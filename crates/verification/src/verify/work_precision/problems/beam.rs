//! A slender cantilever that a force at its end bends far: the elastica.

use stoss_reference_cases::multibody::elastica::tip;

use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const BEST: Choice =
    Choice { scheme: "statics", method: "none", cell: "line3", mesh: 8, steps: 16, solver: "direct", tolerance: 1e-9 };

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "beam",
    title: "Cantilever that bends far",
    about: "A geometrically exact beam of length 1 with the bending stiffness 1 and axial and shear stiffnesses of 1e4, clamped, under a force of 4 across its end, which turns by 64 degrees. `line2`, `line3`, `line4` \
            are elements of order 1, 2, 3. Values: displacement of the end, moment at the clamp.",
    quantities: &["displacement", "moment"],
    reference: Reference::Closed { source: "elastica by elliptic functions, and F L / EA", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["line2", "line3", "line4"],
    meshes: &[4, 8, 16, 32],
    steps: &[8, 16, 32],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9, 1e-12],
    claims: &[
        Claim { line: "mesh", quantity: "displacement", at_least: 3.8 },
        Claim { line: "line2", quantity: "displacement", at_least: 1.9 },
        Claim { line: "line4", quantity: "displacement", at_least: 3.8 },
    ],
    quick: 4,
};

const FORCE: f64 = 4.0;
const STIFFNESS: f64 = 1e4;

fn scene(choice: &Choice) -> Outcome<String> {
    let order = match choice.cell {
        "line2" => 1,
        "line3" => 2,
        "line4" => 3,
        other => return Err(format!("{other} is no element of a beam").into()),
    };
    Ok(choice.head("Cantilever that bends far", 1.0)
        + &format!(
            "[[beam]]\nname = \"arm\"\npoints = [[0, 0, 0], [1, 0, 0]]\nelements = {}\norder = {order}\nup = [0, 1, 0]\n\
             section = {{ axial = {STIFFNESS:?}, shear = [{STIFFNESS:?}, {STIFFNESS:?}], bending = [1.0, 1.0], torsion = 1.0 }}\n\
             [[joint]]\nname = \"clamp\"\nkind = \"weld\"\nbetween = [\"ground\", \"arm.start\"]\nat = [0, 0, 0]\n\
             [[load]]\nset = \"arm.end\"\nforce = {{ table = [[0.0, 0, 0, 0], [1.0, 0, 0, {FORCE:?}]] }}\n\
             [[probe]]\nname = \"tip\"\nset = \"arm.end\"\nquantity = \"displacement\"\n\
             [[probe]]\nname = \"moment\"\njoint = \"clamp\"\nquantity = \"joint_moment\"\n",
            choice.mesh
        ))
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let moment = last(&probes, &["moment.y"])?[0].abs();
    Ok(vec![last(&probes, &["tip.x", "tip.z"])?, vec![moment]])
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let [x, z] = tip(FORCE).ok_or("no elastica")?;
    Ok(vec![vec![x - 1.0, z + FORCE / STIFFNESS], vec![FORCE * x]])
}
