//! Dynamics: a block of one element that lies on a plate of one, in equilibrium with its weight at the start, stays there.

use super::super::case::{Deviation, Problem, Seen};
use super::super::text::{Block, PLAIN, Text};
use super::YOUNG;
use crate::verify::numbers::largest;

/// The scene for a method: a static stage, then so many steps of the energy-momentum scheme, each of a sixth of the time that a wave takes through the block.
pub fn problem(method: &str, steps: u32) -> Problem {
    let (step, gravity) = (0.005, 1.0);
    let end = 1.0 + f64::from(steps) * step;
    let block = |name, corners| Block {
        name,
        corners,
        divisions: [1; 3],
        young: YOUNG,
        poisson: 0.3,
        density: 1.0,
        more: String::new(),
    };
    let held = |name: &str, set: &str, components: &str| {
        format!(
            "[[prescribe]]\nname = \"{name}\"\nset = \"block.bottom & {set}\"\ncomponents = {components}\nfixed = true"
        )
    };
    let text = Text::dynamics(PLAIN, "energy-momentum", step, end)
        .block(&block("plate", [[-0.5, -0.5, -0.5], [1.5, 1.5, 0.0]]))
        .block(&block("block", [[0.0; 3], [1.0; 3]]))
        .fixed("plate.bottom", &["x", "y", "z"])
        .table("[gravity]\nacceleration = [0.0, 0.0, -1.0]")
        .table(&held("corner", "x < 0.5 & y < 0.5", "[\"x\", \"y\"]"))
        .table(&held("edge", "x > 0.5 & y < 0.5", "[\"y\"]"))
        .table("[[stage]]\nname = \"settle\"\nkind = \"quasi-static\"\nuntil = 1.0\nstep = 1.0\nstabilise = { fraction = 2e-4 }")
        .table(&format!("[[stage]]\nname = \"rest\"\nkind = \"dynamic\"\nuntil = {end:?}\noff = [\"corner\", \"edge\"]"))
        .contact(method, ["block.bottom", "plate.top"], 0.0)
        .probe("place", "position", "set = \"block.all\"")
        .probe("force", "contact_force", "set = \"block.bottom\"");
    let oracle = Box::new(move |seen: &Seen| {
        let (time, place) = (seen.probes.column("time")?, seen.vectors("place")?);
        let force = seen.probes.column("force.z")?;
        let settled = time.iter().rposition(|t| *t <= 1.0 + 1e-9).ok_or("no settled state")?;
        let moved = |i: usize| largest(place[settled..].iter().map(|x| (x[i] - place[settled][i]).abs()));
        let mean = force[settled + 1..].iter().sum::<f64>() / (force.len() - settled - 1) as f64;
        // It sags by `g / 2 E` of its height.
        let sag = 0.5 * gravity / YOUNG;
        Ok(vec![
            Deviation::zero("height", moved(2) / sag, 0.05),
            // What supports carried in the static stage, to its tolerance, moves what nothing holds along the plane.
            Deviation::zero("place", moved(0).max(moved(1)), 1e-4),
            Deviation::of("mean force", mean, gravity, 0.01),
        ])
    });
    Problem { text, oracle }
}
