//! What a scene does not ask for is neither linked nor allocated nor called.

mod acting;
mod comparison;
mod linked;
mod parts;
mod samples;
mod sets;

use std::collections::BTreeMap;

use super::check::{Bound, Check};
use super::report::{Grid, ReportSection};
use super::{Bench, Findings, Suite};
use crate::workspace::Outcome;
use acting::Acting;
use comparison::Comparison;
use linked::{Tree, abilities};
use samples::Sample;

/// Crates, structures and kernels of scenes against what the scenes ask for, and the facade's feature sets.
pub struct Lean;

/// Energies below this part of another are round-off.
const ROUND_OFF: f64 = 1e-12;

impl Suite for Lean {
    fn name(&self) -> &'static str {
        "lean"
    }

    fn about(&self) -> &'static str {
        "Crates that are linked, structures that are allocated, phases and kernels that are called, against what each scene asks \
         for; crates and program size of each feature set of the facade."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        let mut trees = BTreeMap::new();
        let mut rows = Vec::new();
        for sample in samples::samples(bench)? {
            match inspect(bench, &sample, &mut trees) {
                Ok(inspected) => {
                    findings.checks.extend(inspected.checks(&sample.name));
                    rows.push(inspected.row(&sample.name));
                }
                Err(error) => {
                    let check = Check::new(&sample.name, "could be run", f64::NAN, Bound::AtLeast(1.0));
                    findings.checks.push(check.noted(error.to_string()));
                }
            }
        }
        let (checks, sets) = sets::measure(bench)?;
        findings.checks.extend(checks);
        let scenes = Grid {
            caption: "What each scene links, allocates and calls; what deviates from what it asks for is in brackets. \
                      Crates: those of the smallest feature set that runs the scene. Bytes: of the system before its factors, of what terms remember. Calls: search, assembly, factorisation, solve"
                .into(),
            head: ["scene", "steps", "features", "crates", "allocated", "called", "acts", "bytes", "calls"].map(str::to_owned).to_vec(),
            rows,
        };
        findings.sections.push(ReportSection { title: "Lean".into(), reading: "What a scene does not use must neither be compiled nor allocated nor called. Counted: crates in the build, bytes, and calls of the parts.".into(), tables: vec![scenes, sets], ..ReportSection::default() });
        Ok(findings)
    }
}

/// What was found for one scene.
struct Inspected {
    steps: u64,
    features: Vec<&'static str>,
    crates: usize,
    /// Number of crates that deviate, and which.
    linked: (usize, String),
    allocated: Comparison,
    called: Comparison,
    acting: Comparison,
    calls: [u64; 4],
    /// Bytes of the system, and of what terms remember.
    bytes: [usize; 2],
}

/// Runs a scene in memory and compares.
fn inspect(bench: &Bench, sample: &Sample, trees: &mut BTreeMap<Vec<&'static str>, Tree>) -> Outcome<Inspected> {
    let scene = stoss_scene::parse(&sample.text, &sample.name).map_err(|error| error.to_string())?;
    let asked = parts::asked(&scene)?;
    let built = stoss::build::build(&scene, &bench.workspace.path("scenes")).map_err(|error| error.to_string())?;
    let mut simulation = built.simulation;
    let mut active = false;
    while simulation.step() < sample.steps && !simulation.finished() {
        let record = simulation.advance()?;
        active |= record.contact.is_some_and(|contact| contact.active > 0);
    }
    let mut found = parts::found(&simulation, active);
    if !active {
        // Which gradient contact takes shows when it has closed.
        found.called.contact.clone_from(&asked.called.contact);
        let balance = simulation.balance();
        if simulation.solves() == 0 && balance.strain < ROUND_OFF * balance.kinetic {
            // Bodies that move uniformly are in balance without a solution.
            found.called.factorisation |= asked.called.factorisation;
            found.called.solve |= asked.called.solve;
        }
    }
    let [allocated, called] = found.against(&asked);
    let features = parts::features(&scene);
    if !trees.contains_key(&features) {
        trees.insert(features.clone(), Tree::of_facade(&bench.workspace, &features)?);
    }
    let tree = &trees[&features];
    let deviations = tree.against(&abilities(&features));
    Ok(Inspected {
        steps: simulation.step(),
        crates: tree.linked().len(),
        linked: (deviations.count(), deviations.words()),
        features,
        allocated,
        called,
        acting: Acting::found(&simulation).against(&Acting::asked(&scene)),
        calls: parts::calls(&simulation),
        bytes: [simulation.plan().memory_bytes, acting::remembered(simulation.model())],
    })
}

impl Inspected {
    /// One row for crates, one for structures, one for calls, one for what acts.
    fn checks(&self, scene: &str) -> [Check; 4] {
        let check = |quantity: String, count: usize, note: String| {
            Check::new(scene, quantity, count as f64, Bound::AtMost(0.0)).noted(note)
        };
        let compared = |kind: &str, comparison: &Comparison| {
            let Comparison { items, deviations, .. } = comparison;
            check(format!("{kind} unused or missing, of {items}"), deviations.len(), deviations.join("; "))
        };
        let (count, words) = &self.linked;
        [
            check(format!("crates unused or missing, of {}", self.crates), *count, words.clone()),
            compared("structures", &self.allocated),
            compared("phases and kernels", &self.called),
            compared("terms and states", &self.acting),
        ]
    }

    fn row(&self, scene: &str) -> Vec<String> {
        let with = |words: &str, deviations: &str| match deviations {
            "" => words.to_owned(),
            deviations => format!("{words} [{deviations}]"),
        };
        let cell = |comparison: &Comparison| with(&comparison.words, &comparison.deviations.join("; "));
        vec![
            scene.to_owned(),
            self.steps.to_string(),
            self.features.join(", "),
            with(&self.crates.to_string(), &self.linked.1),
            cell(&self.allocated),
            cell(&self.called),
            cell(&self.acting),
            self.bytes.map(|bytes| bytes.to_string()).join(", "),
            self.calls.map(|calls| calls.to_string()).join(", "),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_fall_short_and_stand_in_the_table() {
        let good = Comparison { items: 11, words: "mass matrix".into(), deviations: Vec::new() };
        let bad = Comparison { items: 7, words: "search".into(), deviations: vec!["unused: search".into()] };
        let inspected = Inspected {
            steps: 2,
            features: vec!["scene", "nts"],
            crates: 80,
            linked: (0, String::new()),
            allocated: good,
            acting: Comparison { items: 7, words: "friction".into(), deviations: Vec::new() },
            called: bad,
            bytes: [5, 6],
            calls: [1, 2, 3, 4],
        };
        let checks = inspected.checks("a");
        assert_eq!(checks.each_ref().map(Check::holds), [true, true, false, true]);
        assert_eq!(checks[2].note, "unused: search");
        let row =
            ["a", "2", "scene, nts", "80", "mass matrix", "search [unused: search]", "friction", "5, 6", "1, 2, 3, 4"];
        assert_eq!(inspected.row("a"), row);
    }
}
