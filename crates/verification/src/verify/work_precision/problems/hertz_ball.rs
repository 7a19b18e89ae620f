//! Hertz's contact of a ball and a rigid plane.

use std::f64::consts::PI;

use super::parts::{End, fixed, flat, moment, ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
/// Half of the finely meshed zone; the radius of the contact is about 0.8 of it.
const ZONE: f64 = 0.03;
const APPROACH: f64 = 0.0006;
/// General contact acts over a distance.
const GAP: f64 = 1e-5;

/// Nodes so near to the radius are on the surface: those in the middle of edges lie a little beside it.
const ON_SURFACE: f64 = 1e-4;

const BEST: Choice = Choice::direct("statics", "mortar dual", "hex8", 4, 2);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "hertz-ball",
    title: "Hertz: point contact of a ball",
    about: "An eighth of a neo-Hooke ball of radius 1 (Young's modulus 1000, Poisson's ratio 0.3) is pressed onto a rigid plane by 0.0006; `mesh` elements over 0.03, the radius of the contact is 0.024. \
            Hard: few elements in the contact, most of them far from it. Radius and pressure against the closed form for the force that the support tells, the force against that for the approach; \
            the finite ball is about a per cent off.",
    quantities: &["radius", "largest pressure", "force"],
    reference: Reference::Closed { source: "Hertz 1882", values: hertz },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "cat", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex8 mixed", "hex20"],
    meshes: &[2, 3, 4, 6],
    steps: &[1, 2, 4],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[],
    quick: 2,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let gap = if choice.method == "general" { GAP } else { 0.0 };
    let mut text = choice.head("Hertz", 1.0);
    let material = format!("material = {{ law = \"neo-hooke\", young = {YOUNG:?}, poisson = {POISSON:?} }}\n");
    text += &format!(
        "[[body]]\nname = \"ball\"\n{}{material}\
         mesh = {{ generator = \"ball\", radius = 1.0, part = \"eighth\", divisions = [{}, {}, {}], refinement = {{ half_width = {ZONE:?}, elements = {n} }} }}\n\
         [[body]]\nname = \"plane\"\n{material}mesh = {{ generator = \"block\", min = [-0.1, -0.1, {:?}], max = [0.4, 0.4, {:?}], divisions = [1, 1, 1] }}\n",
        choice.cell_keys(),
        (9 * n).div_ceil(5) + 2,
        (2 * n).div_ceil(5),
        (7 * n).div_ceil(5) + 2,
        -1.2 - gap,
        -1.0 - gap
    );
    text += &fixed("plane.all", "\"x\", \"y\", \"z\"");
    text += &[fixed("ball.left", "\"x\""), fixed("ball.front", "\"y\"")].concat();
    text +=
        &format!("[[prescribe]]\nset = \"ball.top\"\ncomponents = [\"z\"]\ndisplacement = {}\n", ramp(-APPROACH - gap));
    text += "[[probe]]\nname = \"force\"\nset = \"plane.all\"\nquantity = \"reaction\"\n";
    Ok(text + &choice.contact("ball.outer", "plane.top", "")?)
}

/// Distances from the axis and pressures of the nodes of the ball in the plane y = 0, outwards.
fn profile(run: &Run) -> Outcome<Vec<(f64, f64)>> {
    End::of(run)?
        .curve(0, "contact_pressure", |[x, y, z]| flat(y, 0.0) && (x.hypot(z) - 1.0).abs() < ON_SURFACE && z < -0.5)
}

fn force(run: &Run) -> Outcome<f64> {
    Ok(4.0 * last(&run.table("probes.csv")?, &["force.z"])?[0])
}

/// The radius is told by the second moment of the pressures over their resultant, `2 a^2 / 5`.
fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let points = profile(run)?;
    let largest = points.iter().map(|p| p.1).fold(0.0, f64::max);
    let radius = (2.5 * moment(&points, 3) / moment(&points, 1)).sqrt();
    Ok(vec![vec![radius], vec![largest], vec![force(run)?]])
}

/// `a^3 = 3 F R / (4 E*)`, `p = 3 F / (2 pi a^2)`; `F = 4/3 E* sqrt(R) d^(3/2)` for the approach d.
fn hertz(run: &Run, _: &Choice) -> Outcome<Values> {
    let (force, modulus) = (force(run)?, YOUNG / (1.0 - POISSON * POISSON));
    let a = (0.75 * force / modulus).cbrt();
    Ok(vec![vec![a], vec![1.5 * force / (PI * a * a)], vec![4.0 / 3.0 * modulus * APPROACH.powf(1.5)]])
}
