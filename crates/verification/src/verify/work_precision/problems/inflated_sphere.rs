//! A hollow ball, nearly incompressible, that a pressure widens.

use stoss_reference_cases::mapped::sector;

use super::parts::{End, fixed, ramp};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values};
use crate::workspace::Outcome;

/// Shear modulus 1.
const POISSON: f64 = 0.499_99;
const RADII: [f64; 2] = [1.0, 2.0];
/// Stretch of the inner radius, which fixes the pressure.
const STRETCH: f64 = 1.4;

const BEST: Choice = Choice::direct("statics", "none", "hex27 mixed", 3, 2);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "inflated-sphere",
    title: "Inflated hollow sphere, nearly incompressible",
    about: "A hollow neo-Hooke sphere of radii 1 and 2 (shear modulus 1, Poisson's ratio 0.49999), a 24th of which is modelled, under a follower pressure inside that widens the bore by 0.4; `mesh` elements through the wall and along each side. \
            Hard: large strains without a change of volume. Smooth, so that cells show their order.",
    quantities: &["displacement", "von Mises stress"],
    reference: Reference::Closed {
        source: "incompressible sphere: Green and Zerna, Theoretical elasticity (1954)",
        values: incompressible,
    },
    scene,
    files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["hex8", "hex8 mixed", "hex20 mixed", "hex27 mixed", "tet10 mixed"],
    meshes: &[2, 3, 4, 6],
    steps: &[1, 2, 4],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-3, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "displacement", at_least: 2.9 }],
    quick: 3,
};

fn file(choice: &Choice) -> String {
    format!("{}.inp", choice.slug())
}

fn files(choice: &Choice) -> Vec<(String, String)> {
    let n = choice.mesh as usize;
    vec![(file(choice), sector(RADII, [n, n]))]
}

/// Radius after the motion of the one that was r: the volume inside changes by the same everywhere.
fn widened(r: f64) -> f64 {
    (r.powi(3) + RADII[0].powi(3) * (STRETCH.powi(3) - 1.0)).cbrt()
}

fn scene(choice: &Choice) -> Outcome<String> {
    // Integral of 2 (s_r - s_t) / r over the wall.
    let part = |stretch: f64| 2.0 / stretch + 0.5 / stretch.powi(4);
    let pressure = part(widened(RADII[1]) / RADII[1]) - part(STRETCH);
    let mut text = format!(
        "{}[[body]]\nname = \"ball\"\n{}mesh = {{ file = \"{}\" }}\nmaterial = {{ law = \"neo-hooke\", lambda = {:?}, mu = 1.0 }}\n\
         [[load]]\nset = \"ball.left\"\nfollower_pressure = {}\n",
        choice.head("Inflated sphere", 1.0),
        choice.cell_keys(),
        file(choice),
        2.0 * POISSON / (1.0 - 2.0 * POISSON),
        ramp(pressure)
    );
    text += &[fixed("ball.front", "\"y\""), fixed("ball.bottom", "\"z\"")].concat();
    for (set, normal) in [("back", "[1, -1, 0]"), ("top", "[1, 0, -1]")] {
        text += &format!("[[prescribe]]\nset = \"ball.{set}\"\nnormal = {normal}\nfixed = true\n");
    }
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let end = End::of(run)?;
    Ok(vec![end.field("displacement")?.values.clone(), end.field("von_mises")?.values.clone()])
}

/// With the stretch `t` of the hoops the stresses differ by `mu (t^2 - t^-4)`.
fn incompressible(run: &Run, _: &Choice) -> Outcome<Values> {
    let end = End::of(run)?;
    let radius = |x: &[f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let displacement = end.grid.points.iter().flat_map(|x| {
        let r = radius(x);
        x.map(|c| (widened(r) / r - 1.0) * c)
    });
    let stress = end.grid.points.iter().map(|x| {
        let stretch = widened(radius(x)) / radius(x);
        stretch.powi(2) - stretch.powi(-4)
    });
    Ok(vec![displacement.collect(), stress.collect()])
}
