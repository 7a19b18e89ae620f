//! A cylinder that is pressed onto another one and then drawn along it: stick in the middle, slip at the edges.

use super::parts::{End, fixed, flat, moment};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, last, no_files};
use crate::workspace::Outcome;
use std::f64::consts::PI;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const FRICTION: f64 = 0.3;
const LENGTH: f64 = 0.02;
/// Half of the finely meshed zone; half of the contact is about 0.8 of it.
const ZONE: f64 = 0.02;
const APPROACH: f64 = 0.00115;
const DRAWN: f64 = 0.0002;
/// General contact acts over a distance.
const GAP: f64 = 1e-5;

/// Nodes so near to the radius are on the surface: those in the middle of edges lie a little beside it.
const ON_SURFACE: f64 = 2e-5;

const BEST: Choice = Choice::direct("statics", "mortar dual", "hex8", 8, 4);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "cattaneo-mindlin",
    title: "Cattaneo-Mindlin: stick and slip under a cylinder",
    about: "A half of a neo-Hooke cylinder of radius 1 (Young's modulus 1000, Poisson's ratio 0.3, plane strain, friction 0.3) is pressed onto another one, half of the contact 0.016 wide, and then drawn along it without full slip; \
            `mesh` elements over 0.02, 1.2 times as many below. Hard: two edges that are not known, of the contact and of the stick in it. Against the closed form for the forces that the support tells.",
    quantities: &["friction tractions", "half width of stick"],
    reference: Reference::Closed {
        source: "Cattaneo 1938, Mindlin 1949, for line contact: K. L. Johnson, Contact mechanics (1985), section 7.2",
        values: closed,
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex20"],
    meshes: &[4, 6, 8, 12],
    steps: &[2, 4, 8, 16],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[],
    quick: 2,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let gap = if choice.method == "general" { GAP } else { 0.0 };
    let mut text = choice.head("Cattaneo and Mindlin", 2.0);
    for (name, part, z) in [("upper", 10, 0.0), ("lower", 12, -2.0 - gap)] {
        let zone = (part * n).div_ceil(10);
        let placed = if name == "lower" {
            format!("rotation = {{ axis = [0, 1, 0], degrees = 180 }}\nposition = [0, 0, {z:?}]\n")
        } else {
            String::new()
        };
        text += &format!(
            "[[body]]\nname = \"{name}\"\n{}material = {{ law = \"neo-hooke\", young = {YOUNG:?}, poisson = {POISSON:?} }}\n{placed}\
             mesh = {{ generator = \"cylinder\", radius = 1.0, length = {LENGTH:?}, part = \"half\", divisions = [{}, {}, {}, 1], \
             refinement = {{ half_width = {ZONE:?}, elements = {zone} }} }}\n{}",
            choice.cell_keys(),
            2 * zone,
            zone.div_ceil(2),
            zone + 3,
            fixed(&format!("{name}.all"), "\"y\"")
        );
    }
    text += &fixed("lower.top", "\"x\", \"z\"");
    text += &format!(
        "[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"x\", \"z\"]\ndisplacement = {{ table = [[0.0, 0.0, 0.0], [1.0, 0.0, {0:?}], [2.0, {DRAWN:?}, {0:?}]] }}\n\
         [[probe]]\nname = \"force\"\nset = \"lower.top\"\nquantity = \"reaction\"\n",
        -APPROACH - gap
    );
    let friction = match choice.method {
        "general" => format!("friction = {FRICTION:?}\n"),
        _ => format!("friction = {{ law = \"coulomb\", mu = {FRICTION:?} }}\n"),
    };
    Ok(text + &choice.contact("upper.outer", "lower.outer", &friction)?)
}

/// Places along the contact, from its middle, and friction tractions of the nodes of the upper cylinder at one end.
fn profile(run: &Run) -> Outcome<Vec<(f64, f64)>> {
    let end = End::of(run)?;
    let points = end.curve(0, "friction_traction", |[x, y, z]| {
        flat(y, 0.0) && (x.hypot(z) - 1.0).abs() < ON_SURFACE && x.abs() < 1.5 * ZONE
    })?;
    let pressures = end.curve(0, "contact_pressure", |[x, y, z]| {
        flat(y, 0.0) && (x.hypot(z) - 1.0).abs() < ON_SURFACE && x.abs() < 1.5 * ZONE
    })?;
    let middle = moment(&pressures, 1) / moment(&pressures, 0);
    Ok(points.into_iter().map(|(x, q)| (x - middle, q)).collect())
}

/// Half of the contact, half of what sticks, and the largest pressure: `a^2 = 4 P R / (pi E*)`, `c^2 = a^2 (1 - Q / (mu P))`, `p = 2 P / (pi a)`.
fn widths(run: &Run) -> Outcome<[f64; 3]> {
    let [q, p]: [f64; 2] =
        last(&run.table("probes.csv")?, &["force.x", "force.z"])?.try_into().map_err(|_| "two columns")?;
    let (p, q) = (p.abs() / LENGTH, q.abs() / LENGTH);
    let modulus = YOUNG / (1.0 - POISSON * POISSON) / 2.0;
    let a = (4.0 * p * 0.5 / (PI * modulus)).sqrt();
    Ok([a, a * (1.0 - q / (FRICTION * p)).max(0.0).sqrt(), 2.0 * p / (PI * a)])
}

/// What sticks is told by the second moment of the tractions over their resultant, `(a^2 + c^2) / 4`.
fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let points = profile(run)?;
    let [a, ..] = widths(run)?;
    let stick = (4.0 * moment(&points, 2) / moment(&points, 0) - a * a).max(0.0).sqrt();
    Ok(vec![points.iter().map(|p| p.1).collect(), vec![stick]])
}

/// `q = mu p (sqrt(1 - x^2 / a^2) - c / a sqrt(1 - x^2 / c^2))`.
fn closed(run: &Run, _: &Choice) -> Outcome<Values> {
    let [a, c, p] = widths(run)?;
    let part = |x: f64, width: f64| (width * width - x * x).max(0.0).sqrt() / a;
    let at = |(x, _): &(f64, f64)| FRICTION * p * (part(*x, a) - part(*x, c));
    Ok(vec![profile(run)?.iter().map(at).collect(), vec![c]])
}
