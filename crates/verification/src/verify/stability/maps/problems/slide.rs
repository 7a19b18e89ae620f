//! Friction: a flat block that slides on a fixed plate under its weight, and one that is pressed on it and pulled until it slides.

use super::super::case::{Deviation, Problem, Seen};
use super::super::text::{Block, PLAIN, Text, Units};
use super::YOUNG;

/// Part of the speed, or of the friction, that a run may be off.
const TOLERANCE: f64 = 0.05;

fn block<'a>(name: &'a str, corners: [[f64; 3]; 2], divisions: [u32; 3], density: f64, more: &str) -> Block<'a> {
    Block { name, corners, divisions, young: 10.0 * YOUNG, poisson: 0.0, density, more: more.into() }
}

/// Dynamics: a block that rests under its weight is let go with the speed `v`, and has `v - mu g t` until it stands still. Its weight is `1e-5` of its modulus.
pub fn dynamic(method: &str, friction: f64, steps: u32) -> Problem {
    let (speed, gravity, height) = (1.0, 1.0, 0.2);
    // In all steps together the coefficient 1 would stop it.
    let step = speed / (gravity * f64::from(steps) * friction.max(1.0));
    let end = 1.0 + f64::from(steps) * step;
    let text = Text::dynamics(PLAIN, "energy-momentum", step, end)
        .block(&block("plate", [[-0.5, -0.5, -0.2], [5.5, 1.5, 0.0]], [6, 2, 1], 1.0, ""))
        .block(&block("block", [[0.0; 3], [1.0, 1.0, height]], [2, 2, 1], 1.0, "velocity = [1.0, 0.0, 0.0]\n"))
        .fixed("plate.bottom", &["x", "y", "z"])
        .table("[gravity]\nacceleration = [0.0, 0.0, -1.0]")
        .table("[[prescribe]]\nname = \"hold\"\nset = \"block.left\"\ncomponents = [\"x\", \"y\"]\nfixed = true")
        .table("[[stage]]\nname = \"settle\"\nkind = \"quasi-static\"\nuntil = 1.0\nstep = 1.0\nstabilise = { fraction = 2e-4 }")
        .table(&format!("[[stage]]\nname = \"slide\"\nkind = \"dynamic\"\nuntil = {end:?}\noff = [\"hold\"]"))
        .contact(method, ["block.bottom", "plate.top"], friction)
        .probe("momentum", "linear_momentum", "body = \"block\"")
        .probe("base", "position", "set = \"block.bottom\"");
    let expected = (speed - friction * gravity * (end - 1.0)).max(0.0);
    let oracle = Box::new(move |seen: &Seen| {
        let now = seen.last("momentum.x")? / height;
        let base = seen.last("base.z")?;
        Ok(vec![
            Deviation::zero("speed", (now - expected) / speed, TOLERANCE),
            Deviation::zero("height", base / height, TOLERANCE),
        ])
    });
    Problem { text, oracle }
}

/// Statics: a block under the pressure `p = 5e-4 E` is pulled at its top; when it slides the friction is `mu p`. A tenth as high as long, it does not tip. No node of the block lies on an edge
/// of the plate, where round-off would say to which facet it belongs.
pub fn pulled(method: &str, friction: f64, units: Units) -> Problem {
    let (height, pressure) = (0.1, 5.0);
    let way = (0.02 + 8.0 * friction * pressure * height / YOUNG) * units.length;
    let time = units.time;
    let text = Text::statics(units, 0.125, 2.0)
        .block(&block("plate", [[-0.5, -0.5, -0.2], [1.5, 1.5, 0.0]], [5, 5, 1], 0.0, ""))
        .block(&block("block", [[0.0; 3], [1.0, 1.0, height]], [3, 3, 1], 0.0, ""))
        .fixed("plate.bottom", &["x", "y", "z"])
        .fixed("block.top", &["y"])
        .table(&format!(
            "[[prescribe]]\nset = \"block.top\"\ncomponents = [\"x\"]\n\
             displacement = {{ table = [[0, 0], [{time:?}, 0], [{:?}, {way:?}]] }}",
            2.0 * time
        ))
        .pressed("block.top", pressure, 1.0)
        .contact(method, ["block.bottom", "plate.top"], friction)
        .probe("force", "contact_force", "set = \"block.bottom\"")
        .probe("base", "displacement", "set = \"block.bottom\"");
    let oracle = Box::new(move |seen: &Seen| {
        let [along, normal] = ["force.x", "force.z"].map(|column| seen.last(column));
        Ok(vec![
            Deviation::zero("friction", (-along? / units.force() / pressure - friction) / friction.max(0.1), TOLERANCE),
            Deviation::of("normal force", normal? / units.force(), pressure, 1e-5),
        ])
    });
    Problem { text, oracle }
}
