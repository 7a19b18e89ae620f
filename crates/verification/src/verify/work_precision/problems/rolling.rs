//! A rigid cylinder rolls down an incline.

use super::history::{METHODS, SCHEMES, at, floor, parts, probe};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "nts", "hex8", 32, 200);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "rolling",
    title: "Cylinder that rolls down an incline",
    about: "A rigid cylinder (mass 1, radius 0.5, `mesh` facets around) rolls with the speed 1 and then down an incline of 20 degrees (gravity 9.81, mu 0.6). What is hard: facets. A polygon that goes over its corners \
            loses energy at each, a part that falls with the square of its angle, all in all of the first order in the facets. Values: way at 8 times, angular velocity at these times.",
    quantities: &["way", "spin"],
    reference: Reference::Closed { source: "acceleration 2/3 g sin of a full cylinder", values: closed },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: SCHEMES,
    methods: METHODS,
    cells: &["hex8"],
    meshes: &[16, 32, 64, 128],
    steps: &[50, 100, 200, 400],
    solvers: &["direct"],
    tolerances: &[1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "way", at_least: 0.8 }],
    quick: 2,
};

const RADIUS: f64 = 0.5;
const GRAVITY: f64 = 9.81;
const DEGREES: f64 = 20.0;
const FRICTION: f64 = 0.6;
const SPEED: f64 = 1.0;
const START: f64 = -2.0;

fn scene(choice: &Choice) -> Outcome<String> {
    let (sine, cosine) = DEGREES.to_radians().sin_cos();
    let mut text = choice.head("Cylinder that rolls down an incline", 1.0);
    text += &format!("[gravity]\nacceleration = [{:?}, 0, {:?}]\n", GRAVITY * sine, -GRAVITY * cosine);
    text += &floor(5.0);
    text += &format!(
        "[[rigid]]\nname = \"wheel\"\nshape = {{ kind = \"cylinder\", radius = {RADIUS:?}, length = 0.4, divisions = [{}, 1, 1] }}\n\
         rotation = {{ axis = [1, 0, 0], degrees = 90 }}\nposition = [{START:?}, 0, {RADIUS:?}]\nmass = 1.0\ninertia = [{1:?}, {1:?}, {1:?}]\n\
         velocity = [{SPEED:?}, 0, 0]\nangular_velocity = [0, {2:?}, 0]\n",
        choice.mesh,
        0.5 * RADIUS * RADIUS,
        SPEED / RADIUS
    );
    let law = match choice.method {
        "general" => format!("friction = {FRICTION:?}\n"),
        _ => format!("friction = {{ law = \"coulomb\", mu = {FRICTION:?} }}\n"),
    };
    text += &choice.contact("wheel.side", "floor.all", &law)?;
    text += &probe("x", "position", "wheel");
    text += &probe("w", "angular_velocity", "wheel");
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let times = parts(8, 1.0);
    let way = at(&probes, "x.x", &times)?.into_iter().map(|x| x - START).collect();
    Ok(vec![way, at(&probes, "w.y", &times)?])
}

fn closed(_: &Run, _: &Choice) -> Outcome<Values> {
    let acceleration = 2.0 / 3.0 * GRAVITY * DEGREES.to_radians().sin();
    let at_times = |value: fn(f64, f64) -> f64| parts(8, 1.0).into_iter().map(|t| value(acceleration, t)).collect();
    Ok(vec![at_times(|a, t| (SPEED + 0.5 * a * t) * t), at_times(|a, t| (SPEED + a * t) / RADIUS)])
}
