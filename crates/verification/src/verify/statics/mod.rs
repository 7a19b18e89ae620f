//! A hundred static contact scenes with default settings: whether they run, with how many cuts and iterations, and whether their final states are exact.

mod families;
mod scene;

use stoss::solver::{DecisionKind, Simulation};

use super::check::{Bound, Check, number};
use super::facade::simulation;
use super::numbers::larger;
use super::report::{Grid, ReportSection};
use super::{Bench, Findings, Suite};
use crate::workspace::Outcome;
use scene::Scene;

/// Static contact.
pub struct Statics;

/// Time of the processor for a scene: a run that takes longer counts as one that stops.
const LIMIT: f64 = 60.0;

/// Scenes of the hundred that run without a cut, at least, and that stop, at most.
const CLEAN: f64 = 86.0;
const STOPPED: f64 = 11.0;

/// Largest gap of a closed point of mortar contact over the size of a facet, tension over the largest pressure, excess over the cone of friction.
const EXACT: f64 = 1e-7;

impl Suite for Statics {
    fn name(&self) -> &'static str {
        "statics"
    }

    fn about(&self) -> &'static str {
        "A hundred static contact scenes with default settings: without cuts, with exact final states."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let scenes: Vec<Scene> = families::scenes().into_iter().filter(|scene| scene.quick || !bench.quick).collect();
        let mut rows = Vec::new();
        for scene in &scenes {
            let fate = run(scene)?;
            println!("verify: statics: {}: {}", scene.name, fate.text());
            rows.push((scene.name.clone(), fate));
        }
        Ok(findings(&rows, bench.quick))
    }
}

/// What became of a scene.
#[derive(Clone, Debug, Default)]
struct Fate {
    /// Why it stopped; `None` if it went to its end.
    stopped: Option<String>,
    steps: u64,
    cuts: usize,
    /// Trials by smoothed complementarity.
    smoothed: usize,
    iterations: u64,
    seconds: f64,
    strain: f64,
    exactness: Exactness,
}

/// Exactness of the last state.
#[derive(Clone, Copy, Debug, Default)]
struct Exactness {
    /// Largest distance of a closed point from its surface, in edges.
    gap: f64,
    /// Largest tension, over the largest pressure.
    tension: f64,
    /// Largest excess of a traction over its bound, a part of it.
    cone: f64,
}

impl Fate {
    fn is_clean(&self) -> bool {
        self.stopped.is_none() && self.cuts == 0
    }

    fn text(&self) -> String {
        let end = self.stopped.as_ref().map_or_else(|| "to its end".to_owned(), |why| format!("stopped: {why}"));
        format!(
            "{} steps, {} cuts, {} smoothed, {:.1} iterations a step, strain energy {:.10e}, {:.1} s, {end}",
            self.steps,
            self.cuts,
            self.smoothed,
            self.iterations as f64 / self.steps.max(1) as f64,
            self.strain,
            self.seconds
        )
    }
}

fn run(scene: &Scene) -> Outcome<Fate> {
    let mut simulation = simulation(scene.text())?;
    let start = cpu_time::ThreadTime::now();
    let mut fate = Fate::default();
    while !simulation.finished() {
        match simulation.advance() {
            Ok(record) => {
                fate.steps += 1;
                fate.iterations += u64::from(record.iterations);
            }
            Err(error) => {
                let words = error.to_string().replace('\n', " ");
                fate.stopped = Some(format!("at {:.3}: {words}", simulation.clock().time()));
                break;
            }
        }
        if start.elapsed().as_secs_f64() > LIMIT {
            fate.stopped = Some(format!("at {:.3}: more than {LIMIT} s", simulation.clock().time()));
            break;
        }
    }
    fate.seconds = start.elapsed().as_secs_f64();
    let count = |kind| simulation.decisions().iter().filter(|decision| decision.kind == kind).count();
    (fate.cuts, fate.smoothed) = (count(DecisionKind::Cut), count(DecisionKind::Smoothed));
    fate.strain = simulation.balance().strain;
    fate.exactness = exactness(&simulation)?;
    Ok(fate)
}

fn exactness(simulation: &Simulation) -> Outcome<Exactness> {
    let mut found = Exactness::default();
    let largest = simulation.pressures().iter().flatten().fold(0.0_f64, |most, p| most.max(*p));
    for (c, (pressures, closed)) in simulation.pressures().iter().zip(simulation.active()).enumerate() {
        let pair = &simulation.model().contacts[c];
        if pair.unilateral().is_none() {
            continue;
        }
        for (slot, report) in simulation.contact_report(c)?.iter().enumerate().filter(|(slot, _)| closed[*slot]) {
            found.gap = larger(found.gap, report.gap.unwrap_or(0.0).abs() / pair.term.length_scale());
            if largest > 0.0 {
                found.tension = larger(found.tension, -pressures[slot] / largest);
            }
            if let Some(friction) = report.friction.as_ref().filter(|friction| friction.bound > 0.0) {
                let traction = friction.traction[0].hypot(friction.traction[1]);
                found.cone = larger(found.cone, traction / friction.bound - 1.0);
            }
        }
    }
    Ok(found)
}

fn findings(rows: &[(String, Fate)], quick: bool) -> Findings {
    let named = |which: &dyn Fn(&Fate) -> bool| {
        let list: Vec<&str> = rows.iter().filter(|(_, fate)| which(fate)).map(|(name, _)| name.as_str()).collect();
        (list.len() as f64, list.join(" "))
    };
    let check = |quantity: &str, (measured, note): (f64, String), bound| {
        Check::new("statics", quantity, measured, bound).noted(note)
    };
    let all = rows.len() as f64;
    let (clean, _) = named(&Fate::is_clean);
    let with_cuts = named(&|fate| fate.stopped.is_none() && fate.cuts > 0);
    let stopped = named(&|fate| fate.stopped.is_some());
    let least = if quick { all } else { CLEAN };
    let mut findings = Findings::default();
    findings.checks.push(check("scenes without a cut", (clean, format!("of {all}")), Bound::AtLeast(least)));
    findings.checks.push(check("scenes with cuts", with_cuts, Bound::Unbounded));
    findings.checks.push(check("scenes that stop", stopped, Bound::AtMost(if quick { 0.0 } else { STOPPED })));
    let ended = || rows.iter().map(|(_, fate)| fate).filter(|fate| fate.stopped.is_none());
    let largest = |of: &dyn Fn(&Fate) -> f64| ended().fold(0.0, |most, fate| larger(most, of(fate)));
    for (quantity, measured) in [
        ("tension at the end over the largest pressure", largest(&|fate| fate.exactness.tension)),
        ("excess over the cone of friction", largest(&|fate| fate.exactness.cone)),
    ] {
        findings.checks.push(check(quantity, (measured, String::new()), Bound::AtMost(EXACT)));
    }
    let steps: u64 = ended().map(|fate| fate.steps).sum();
    let iterations: u64 = ended().map(|fate| fate.iterations).sum();
    let mean = iterations as f64 / steps.max(1) as f64;
    findings.checks.push(check("iterations a step", (mean, String::new()), Bound::Unbounded));
    let head = ["scene", "steps", "cuts", "smoothed", "iterations a step", "gap", "strain energy", "stopped"];
    let row = |(name, fate): &(String, Fate)| {
        vec![
            name.clone(),
            fate.steps.to_string(),
            fate.cuts.to_string(),
            fate.smoothed.to_string(),
            number(fate.iterations as f64 / fate.steps.max(1) as f64),
            number(fate.exactness.gap),
            format!("{:.10e}", fate.strain),
            fate.stopped.clone().unwrap_or_default(),
        ]
    };
    let grid = Grid {
        caption: "Scenes that go to their end without a cut have neither cuts nor a reason for a stop".into(),
        head: head.map(str::to_owned).to_vec(),
        rows: rows.iter().map(row).collect(),
    };
    findings.sections.push(ReportSection {
        title: "Static contact".into(),
        tables: vec![grid],
        ..ReportSection::default()
    });
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_with_cuts_is_not_clean_and_one_that_stops_neither() {
        let clean = Fate { steps: 2, iterations: 6, ..Fate::default() };
        let cut = Fate { cuts: 1, ..clean.clone() };
        let stopped = Fate { stopped: Some("at 1: no".into()), ..clean.clone() };
        let rows = [("a".to_owned(), clean), ("b".to_owned(), cut), ("c".to_owned(), stopped)];
        let found = findings(&rows, false);
        let measured: Vec<f64> = found.checks.iter().map(|check| check.measured).collect();
        assert_eq!(measured[..3], [1.0, 1.0, 1.0]);
        assert_eq!(found.checks[5].measured, 3.0);
        assert_eq!(found.sections[0].tables[0].rows.len(), 3);
    }
}
