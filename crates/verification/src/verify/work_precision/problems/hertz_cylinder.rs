//! Hertz's contact of two cylinders.

use std::f64::consts::PI;

use super::parts::{End, fixed, flat, moment, ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const LENGTH: f64 = 0.01;
/// Half of the finely meshed zone; half of the contact is about 0.8 of it.
const ZONE: f64 = 0.006;
const APPROACH: f64 = 0.000125;
const GAP: f64 = 1e-6;

/// Nodes so near to the radius are on the surface: those in the middle of edges lie a little beside it.
const ON_SURFACE: f64 = 2e-5;

const BEST: Choice = Choice::direct("statics", "mortar dual", "hex8", 8, 2);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "hertz-cylinder",
    title: "Hertz: line contact of two cylinders",
    about: "A quarter of a neo-Hooke cylinder of radius 1 (Young's modulus 1000, Poisson's ratio 0.3, plane strain) is pressed onto one of radius 2, half of the contact 0.005 wide; `mesh` elements of the \
            upper one, 1.3 times as many of the lower one over 0.006. Hard: where the contact ends is not known, and the pressure has a vertical tangent there. Against the closed form for the force that the support tells; \
            finite strains and sizes add a quarter of a per cent.",
    quantities: &["pressures", "largest pressure", "half width"],
    reference: Reference::Closed { source: "Hertz 1882", values: hertz },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "cat", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex8 mixed", "hex20", "tet10"],
    meshes: &[4, 6, 8, 12],
    steps: &[1, 2, 4],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "pressures", at_least: 0.9 }],
    quick: 2,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let gap = if choice.method == "general" { GAP } else { 0.0 };
    let mut text = choice.head("Hertz", 1.0);
    let scaled = |numbers: [u32; 4]| numbers.map(|of_ten| (of_ten * n).div_ceil(10).max(1));
    let bodies = [
        ("upper", 1.0, [22, 4, 16, 10], ""),
        ("lower", 2.0, [30, 5, 19, 13], "rotation = { axis = [1, 0, 0], degrees = 180, about = [0, 0.005, 0] }\n"),
    ];
    for (name, radius, numbers, placed) in bodies {
        let [x, z, outwards, zone] = scaled(numbers);
        let position = if name == "lower" { format!("position = [0, 0, {:?}]\n", -3.0 - gap) } else { String::new() };
        text += &format!(
            "[[body]]\nname = \"{name}\"\n{}material = {{ law = \"neo-hooke\", young = {YOUNG:?}, poisson = {POISSON:?} }}\n{placed}{position}\
             mesh = {{ generator = \"cylinder\", radius = {radius:?}, length = {LENGTH:?}, part = \"quarter\", divisions = [{x}, {z}, {outwards}, 1], \
             refinement = {{ half_width = {ZONE:?}, elements = {zone} }} }}\n",
            choice.cell_keys()
        );
        text += &[fixed(&format!("{name}.all"), "\"y\""), fixed(&format!("{name}.left"), "\"x\"")].concat();
    }
    text += &fixed("lower.top", "\"z\"");
    text += &format!(
        "[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"z\"]\ndisplacement = {}\n",
        ramp(-APPROACH - gap)
    );
    text += "[[probe]]\nname = \"force\"\nset = \"lower.top\"\nquantity = \"reaction\"\n";
    Ok(text + &choice.contact("upper.outer", "lower.outer", "")?)
}

/// Places and pressures of the nodes of the upper cylinder at one end, outwards.
fn profile(run: &Run) -> Outcome<Vec<(f64, f64)>> {
    End::of(run)?.curve(0, "contact_pressure", |[x, y, z]| {
        flat(y, 0.0) && (x.hypot(z) - 1.0).abs() < ON_SURFACE && x < 1.5 * ZONE
    })
}

/// Half of the width is told by the second moment of the pressures over their resultant, `a^2 / 4`.
fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let points = profile(run)?;
    let largest = points.iter().map(|p| p.1).fold(0.0, f64::max);
    let half = (4.0 * moment(&points, 2) / moment(&points, 0)).sqrt();
    Ok(vec![points.iter().map(|p| p.1).collect(), vec![largest], vec![half]])
}

/// `a^2 = 4 F R / (pi E*)`, `p = 2 F / (pi a) sqrt(1 - x^2 / a^2)`; the support has half of the force.
fn hertz(run: &Run, _: &Choice) -> Outcome<Values> {
    let force = 2.0 * last(&run.table("probes.csv")?, &["force.z"])?[0] / LENGTH;
    let modulus = YOUNG / (1.0 - POISSON * POISSON) / 2.0;
    let a = (4.0 * force / 1.5 / (PI * modulus)).sqrt();
    let largest = 2.0 * force / (PI * a);
    let points = profile(run)?;
    let at = |(x, _): &(f64, f64)| largest * (1.0 - (x / a).powi(2)).max(0.0).sqrt();
    Ok(vec![points.iter().map(at).collect(), vec![largest], vec![a]])
}
