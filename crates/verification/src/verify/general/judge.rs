//! Runs a scene and holds it against what general contact promises: nothing deeper in a body than the layer, energy and momenta to round-off.

use std::time::Duration;

use super::scene::Scene;
use crate::verify::check::{Bound, Check};
use crate::verify::launch::{Launched, launch_within};
use crate::verify::numbers::larger;
use crate::verify::{Bench, Findings, Run};
use crate::workspace::Outcome;

/// Where scenes and results go, below the folder of `verify`.
const FOLDER: &str = "general";

/// Change of the energy, with friction and damping, over the largest kinetic energy of the run.
pub const LEDGER: f64 = 1e-9;

/// Change of momenta over mass times the speed that belongs to the largest kinetic energy, angular ones with an arm of 1.
const MOMENTA: f64 = 1e-11;

/// Overlap of the skins of bodies that touch or nearly touch at the start, whose inner surfaces are what contact keeps apart, in thicknesses: at edges the root of two.
const SKINS: f64 = 1.42;

/// Far more than any scene needs.
const LIMIT: Duration = Duration::from_secs(900);

/// What the tables of a run say.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Nodes inside a body, edges that cut one and nodes that went through one, over all looks of the watch.
    pub intersections: f64,
    /// Nodes that went through a body.
    pub tunnelled: f64,
    /// Depth of the deepest node inside a body.
    pub depth: f64,
    /// Change of the energy over the largest kinetic energy.
    pub ledger: f64,
    /// The larger of the changes of the momenta, over their scale.
    pub momenta: f64,
    /// Halved steps.
    pub cuts: f64,
    /// Steps.
    pub steps: f64,
    /// Mean number of linear solutions a step.
    pub iterations: f64,
    /// Smallest distance of two surfaces; infinite if they never met.
    pub distance: f64,
}

/// Runs a scene in files called after it, and names the run so.
pub fn run(bench: &Bench, name: &str, scene: &Scene) -> Outcome<Launched> {
    let launched = launch_within(bench, FOLDER, &slug(name), &scene.text, &scene.files, LIMIT)?;
    Ok(Launched { run: Run { name: name.to_owned(), ..launched.run }, ..launched })
}

/// Letters and digits of a name, with hyphens between them.
fn slug(name: &str) -> String {
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-")
}

/// Reads the tables of a run.
pub fn figures(run: &Run, scene: &Scene) -> Outcome<Figures> {
    let watch = run.table("watch.csv")?;
    let columns = ["nodes_inside", "cutting_edges", "tunnelled"];
    let mut intersections = 0.0;
    for column in columns {
        intersections += watch.column(column)?.iter().sum::<f64>();
    }
    let tunnelled = watch.column("tunnelled")?.iter().sum();
    let depth = watch.column("depth")?.iter().copied().fold(0.0, larger);
    let balance = run.balance()?;
    let table = run.table("balance.csv")?;
    let kinetic = table.column("kinetic")?.iter().copied().fold(0.0, larger);
    let momentum = (2.0 * kinetic * scene.mass).sqrt();
    let momenta = [balance.linear_drift(Some(momentum)), balance.angular_drift(Some(momentum))];
    let gaps = run.table("contact.csv")?;
    Ok(Figures {
        intersections,
        tunnelled,
        depth,
        ledger: balance.energy_drift(Some(kinetic)),
        momenta: momenta.into_iter().fold(0.0, larger),
        cuts: run.summary_number("cuts")?,
        steps: run.summary_number("steps")?,
        iterations: run.summary_number("mean_iterations")?,
        distance: gaps.column("min_gap")?.iter().copied().fold(f64::INFINITY, f64::min),
    })
}

/// The thickness of the layer, as the summary says it.
fn thickness(run: &Run) -> Outcome<f64> {
    let summary = run.summary()?;
    let words = summary["contacts"][0]["enforcement"].as_str().unwrap_or_default();
    let number = words.strip_prefix("layer of thickness ").and_then(|rest| rest.parse().ok());
    Ok(number.ok_or_else(|| format!("{}: no thickness of general contact in summary.json", run.name))?)
}

/// Runs a scene and adds its rows; nothing if it did not come to its end.
pub fn judge(bench: &Bench, findings: &mut Findings, name: &str, scene: &Scene) -> Outcome<Option<Run>> {
    judge_closely(bench, findings, name, scene, LEDGER)
}

/// Runs a scene and adds its rows as [`judge`], with another bound of the energy.
pub fn judge_closely(
    bench: &Bench,
    findings: &mut Findings,
    name: &str,
    scene: &Scene,
    ledger: f64,
) -> Outcome<Option<Run>> {
    let launched = run(bench, name, scene)?;
    let mut row = |quantity: &str, measured: f64, bound: Bound, note: String| {
        findings.checks.push(Check::new(name, quantity, measured, bound).noted(note));
    };
    let code = launched.run.ending.code.map_or(f64::NAN, f64::from);
    let last = launched.log.lines().next().unwrap_or_default().to_owned();
    let is_done = launched.run.succeeded();
    let note = if is_done { String::new() } else { last };
    row("exit code", code, Bound::Near { value: 0.0, tolerance: 0.0 }, note);
    if !is_done {
        return Ok(None);
    }
    let found = figures(&launched.run, scene)?;
    let Figures { steps, iterations, cuts, distance, .. } = found;
    let note = format!(
        "{steps} steps, {iterations:.1} solutions a step, smallest distance {distance:.2e}, {:.1} s",
        launched.run.ending.seconds
    );
    row("nodes that went through a body", found.tunnelled, Bound::AtMost(0.0), launched.run.reasons());
    let depth = found.depth / thickness(&launched.run)?;
    row("deepest node inside a body, thicknesses", depth, Bound::AtMost(SKINS), launched.run.reasons());
    let verdict = match launched.run.verdict()?.as_str() {
        "sound" => 0.0,
        "doubtful" => 1.0,
        _ => 2.0,
    };
    // Forces of corners and edges that meet have directions that no facet has, and a layer keeps bodies apart by a part of its thickness; the verdict says where that is much.
    row("verdict (0 sound, 1 doubtful, 2 wrong)", verdict, Bound::AtMost(1.0), launched.run.reasons());
    row("halved steps", cuts, Bound::Unbounded, note);
    if scene.keeps_energy {
        row("energy and losses, change", found.ledger, Bound::AtMost(ledger), String::new());
    }
    if scene.keeps_energy && scene.free {
        row("momenta, change", found.momenta, Bound::AtMost(MOMENTA), String::new());
    }
    Ok(Some(launched.run))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_called_after_the_case() {
        assert_eq!(slug("edge on edge, step 0.1"), "edge-on-edge-step-0-1");
    }
}
