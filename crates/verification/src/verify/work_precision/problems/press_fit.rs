//! Two tubes that are fitted onto each other with an interference.

use stoss_reference_cases::mapped::tube;

use super::parts::{End, fixed};
use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values};
use crate::workspace::Outcome;

const YOUNG: f64 = 210_000.0;
const POISSON: f64 = 0.3;
/// Radii of the bore, the interface and the outside.
const RADII: [f64; 3] = [10.0, 20.0, 30.0];
/// So small that what finite strains add, about its part of the radius, does not count.
const INTERFERENCE: f64 = 1e-5;
/// Nodes so near to the radius are on the surface: those in the middle of edges lie a little beside it.
const ON_SURFACE: f64 = 0.02;

/// Row of the table.
pub const PROBLEM: Problem = Problem {
    name: "press-fit",
    title: "Press fit of two tubes",
    about: "Quarters of two steel tubes of radii 10-20 and 20-30 in plane strain, fitted with an interference of 1e-5; their meshes do not match, `mesh` elements of the outer one around, 1.2 times as many of the inner one. \
            Hard: a round interface of flat or quadratic faces.",
    quantities: &["pressure", "displacement"],
    reference: Reference::Closed { source: "Lame: thick tubes under pressure, plane strain", values: lame },
    scene,
    files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["nts", "mortar", "mortar dual", "general"],
    cells: &["hex8", "hex20", "hex20 reduced", "hex27", "hex8 mixed", "tet10"],
    meshes: &[5, 10, 20, 40],
    steps: &[1, 2, 4],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[
        Claim { line: "mesh", quantity: "pressure", at_least: 1.5 },
        Claim { line: "mesh", quantity: "displacement", at_least: 2.0 },
    ],
    quick: 2,
};

const BEST: Choice = Choice {
    scheme: "statics",
    method: "mortar",
    cell: "hex20",
    solver: "direct",
    mesh: 20,
    steps: 1,
    tolerance: 1e-9,
};

/// Elements through the wall and around, of the inner and of the outer tube.
fn divisions(choice: &Choice) -> [[usize; 3]; 2] {
    let n = choice.mesh as usize;
    [[2 * n / 5, 6 * n / 5, 1], [2 * n / 5, n, 1]]
}

fn files(choice: &Choice) -> Vec<(String, String)> {
    let [inner, outer] = divisions(choice);
    let [a, b, c] = RADII;
    let name = |body: &str| file(choice, body);
    vec![(name("inner"), tube([a, b], 5.0, inner)), (name("outer"), tube([b, c], 5.0, outer))]
}

fn file(choice: &Choice, body: &str) -> String {
    format!("{}-{body}.inp", choice.slug())
}

fn scene(choice: &Choice) -> Outcome<String> {
    if choice.method == "general" {
        return Err("general contact has no interference, and refuses bodies that overlap at the start".into());
    }
    let mut text = choice.head("Press fit", 1.0);
    for body in ["inner", "outer"] {
        text += &format!(
            "[[body]]\nname = \"{body}\"\nmesh = {{ file = \"{}\" }}\n{}\
             material = {{ law = \"neo-hooke\", young = {YOUNG:?}, poisson = {POISSON:?} }}\n",
            file(choice, body),
            choice.cell_keys()
        );
        for (set, component) in [("front", "\"y\""), ("back", "\"x\""), ("bottom", "\"z\""), ("top", "\"z\"")] {
            text += &fixed(&format!("{body}.{set}"), component);
        }
    }
    let rest = format!("overlap = \"keep\"\ninterference = {INTERFERENCE:?}\n");
    Ok(text + &choice.contact("inner.right", "outer.left", &rest)?)
}

/// Pressures of the nodes of the inner tube at the interface; displacements of all nodes in the plane.
fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let end = End::of(run)?;
    let (pressure, displacement) = (end.field("contact_pressure")?, end.field("displacement")?);
    let pressures = interface(&end).into_iter().map(|n| pressure.values[n]).collect();
    let moved = (0..end.body.len()).flat_map(|n| [displacement.row(n)[0], displacement.row(n)[1]]).collect();
    Ok(vec![pressures, moved])
}

fn interface(end: &End) -> Vec<usize> {
    end.points(0, |[x, y, _]| (x.hypot(y) - RADII[1]).abs() < ON_SURFACE)
}

/// `u = (1 + nu) / E ((1 - 2 nu) A r + B / r)` with the stresses `A -+ B / r^2`, of each tube under the pressure of the interface, which follows from the interference.
fn lame(run: &Run, _: &Choice) -> Outcome<Values> {
    let [a, b, c] = RADII.map(|r| r * r);
    let moved = |r: f64, [uniform, inverse]: [f64; 2]| {
        (1.0 + POISSON) / YOUNG * ((1.0 - 2.0 * POISSON) * uniform * r + inverse / r)
    };
    // Under a unit pressure.
    let inner = [-b / (b - a), -a * b / (b - a)];
    let outer = [b / (c - b), b * c / (c - b)];
    let pressure = INTERFERENCE / (moved(RADII[1], outer) - moved(RADII[1], inner));
    let end = End::of(run)?;
    let displacement = |n: usize| {
        let [x, y, _] = end.grid.points[n];
        let r = x.hypot(y);
        let u = pressure * moved(r, if end.body[n] == 0 { inner } else { outer });
        [u * x / r, u * y / r]
    };
    Ok(vec![vec![pressure; interface(&end).len()], (0..end.body.len()).flat_map(displacement).collect()])
}
