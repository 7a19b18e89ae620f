//! The shipped scenes and what their `[expect]` says.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::check::{Bound, Check};
use super::conserved;
use super::run::WRONG;
use super::{Bench, Findings, Run, Suite, quadratic};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Every scene.
pub struct Scenes;

/// Exit code of a run that had to give up.
const GAVE_UP: i32 = 3;

impl Suite for Scenes {
    fn name(&self) -> &'static str {
        "scenes"
    }

    fn about(&self) -> &'static str {
        "Every shipped scene, held against its [expect] table."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        let table = conserved::figures(&bench.workspace.read(conserved::FILE)?);
        for (file, scene) in &chosen(bench)? {
            let Some(Value::Table(expect)) = scene.get("expect") else { continue };
            let run = bench.run_shipped(file)?;
            let gives_up = expect.get("outcome").and_then(Value::as_str) == Some("failed");
            // A shortened run may end before what makes it wrong.
            let found = run.verdict().unwrap_or_default();
            let ending = run.completed(if gives_up { GAVE_UP } else { if found == "wrong" { WRONG } else { 0 } });
            let ended = ending.holds();
            findings.checks.push(ending);
            findings.checks.push(verdict(&run, expect.get("verdict").and_then(Value::as_str), &found));
            if !ended {
                continue;
            }
            let mut left_out = Vec::new();
            for (key, value) in expect.iter().filter(|(key, _)| *key != "verdict") {
                for item in items(key, value) {
                    match measure(&run, expect, &item) {
                        Ok(Some((measured, bound))) => {
                            findings.checks.push(Check::new(&run.name, item.quantity(), measured, bound));
                        }
                        Ok(None) => left_out.push(item.quantity()),
                        Err(error) => {
                            let failed = Check::new(&run.name, item.quantity(), f64::NAN, Bound::AtLeast(0.0));
                            findings.checks.push(failed.noted(error.to_string()));
                        }
                    }
                }
            }
            if !left_out.is_empty() {
                let count = left_out.len() as f64;
                let row = Check::new(&run.name, "expectations left out", count, Bound::Unbounded);
                findings.checks.push(row.noted(format!("{}: {}", run.note(), left_out.join(", "))));
            }
            if let (Some(figures), None) = (table.get(&run.name), run.until) {
                let scale = |key: &str| expect.get(key).and_then(number);
                let scales = ["linear_momentum_scale", "angular_momentum_scale", "energy_scale"].map(scale);
                findings.checks.extend(conserved::checks(&run, figures, scales)?);
            }
            if has_friction(scene) {
                let is_linear =
                    has_mortar(scene) && scene.get("time").and_then(|time| time.get("integrator")).is_some();
                let rate = if is_linear { quadratic::Rate::Linear } else { quadratic::Rate::Quadratic };
                quadratic::rows_at(&run, &mut findings, rate)?;
            }
            if has_mortar(scene) {
                findings.checks.push(run.coverage()?);
            }
            bench.show(&run, &mut findings);
        }
        Ok(findings)
    }
}

/// Shipped scenes that expect something, in quick mode without the large ones.
fn chosen(bench: &Bench) -> Outcome<Vec<(PathBuf, Table)>> {
    let mut chosen = Vec::new();
    for file in bench.workspace.scenes()? {
        if bench.quick && is_large(&file) {
            continue;
        }
        let text = bench.workspace.read(&file)?;
        let scene: Table = text.parse().map_err(|error| format!("{}: {error}", file.display()))?;
        if scene.get("expect").is_some_and(Value::is_table) {
            chosen.push((file, scene));
        }
    }
    Ok(chosen)
}

/// The verdict of the watch against the one that the scene expects: sound if it says nothing. A shortened run may be better than the whole one.
fn verdict(run: &Run, expected: Option<&str>, found: &str) -> Check {
    const WORDS: [&str; 3] = ["sound", "doubtful", "wrong"];
    let place = |word: &str| WORDS.iter().position(|known| *known == word).map_or(f64::NAN, |place| place as f64);
    let expected = place(expected.unwrap_or("sound"));
    let bound = match run.until {
        Some(_) => Bound::AtMost(expected),
        None => Bound::Near { value: expected, tolerance: 0.0 },
    };
    Check::new(&run.name, "verdict (0 sound, 1 doubtful, 2 wrong)", place(found), bound).noted(run.reasons())
}

/// True if a contact of the scene has friction.
fn has_friction(scene: &Table) -> bool {
    let contacts = scene.get("contact").and_then(Value::as_array);
    contacts.is_some_and(|list| list.iter().any(|contact| contact.get("friction").is_some()))
}

/// Whether there is a contact whose slave facets are cut into segments.
fn has_mortar(scene: &Table) -> bool {
    let contacts = scene.get("contact").and_then(Value::as_array);
    contacts.is_some_and(|list| list.iter().any(|c| c.get("method").and_then(Value::as_str) == Some("mortar")))
}

/// Scenes of minutes or hours, which quick mode leaves out: the tori, the chain of ten of them, the ball on a plane, the rotating indenter (suite `mortar` has a short form of it).
pub fn is_large(scene: &Path) -> bool {
    scene.file_stem().is_some_and(|name| {
        let name = name.to_string_lossy();
        ["tori", "general-chain", "hertz-ball", "rotating-indenter", "ball-plate-tetrahedra", "ironing-tetrahedra"]
            .iter()
            .any(|large| name.starts_with(large))
    })
}

/// One expectation; the list of probes is several.
struct Item<'a> {
    key: &'a str,
    value: &'a Value,
}

/// The expectations behind a key: none for a scale, which belongs to another key.
fn items<'a>(key: &'a str, value: &'a Value) -> Vec<Item<'a>> {
    match value.as_array() {
        _ if key.ends_with("_scale") => Vec::new(),
        Some(values) => values.iter().map(|value| Item { key, value }).collect(),
        None => vec![Item { key, value }],
    }
}

impl Item<'_> {
    /// Name of the quantity in the table.
    fn quantity(&self) -> String {
        let entry = |key: &str| self.value.get(key).map(|value| value.to_string().replace('"', "")).unwrap_or_default();
        match self.key {
            "probe" => format!("probe {} {} at t = {}", entry("name"), entry("component"), entry("time")),
            key => key.replace('_', " "),
        }
    }

    /// The number itself, or the number behind a key.
    fn number(&self, key: Option<&str>) -> Result<f64, String> {
        let value = key.map_or(Some(self.value), |key| self.value.get(key));
        let number = value.and_then(number);
        number.ok_or_else(|| format!("[expect] {} {} is no number", self.key, key.unwrap_or_default()))
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|integer| integer as f64))
}

/// The measured value and its bound; nothing if a shortened run cannot tell.
fn measure(run: &Run, expect: &Table, item: &Item) -> Outcome<Option<(f64, Bound)>> {
    let scale = |key: &str| expect.get(key).and_then(number);
    let energy_scale = scale("energy_scale");
    let whole = run.until.is_none();
    let in_time = |time: f64| run.until.is_none_or(|until| time <= until);
    let at_most = || item.number(None).map(Bound::AtMost);
    let truth = |holds: bool| (f64::from(u8::from(holds)), Bound::AtLeast(1.0));
    let measured = match item.key {
        "outcome" if whole => {
            let summary = run.summary()?;
            let found = summary["outcome"]["kind"].as_str().ok_or("summary.json has no outcome")?.to_owned();
            truth(Some(found.as_str()) == item.value.as_str())
        }
        "steps" if whole => (run.summary_number("steps")?, Bound::Near { value: item.number(None)?, tolerance: 0.0 }),
        "max_cuts" => (run.summary_number("cuts")?, at_most()?),
        "max_newton_mean" => (run.summary_number("mean_iterations")?, at_most()?),
        "energy_drift" => (run.balance()?.energy_drift(energy_scale), at_most()?),
        "energy_drift_at_least" if whole => {
            (run.balance()?.energy_drift(energy_scale), Bound::AtLeast(item.number(None)?))
        }
        "energy_change_without_closing" => {
            let balance = run.balance()?;
            (balance.largest_change(&run.closings(&balance)?, false, energy_scale), at_most()?)
        }
        "energy_gain" => {
            let changes = run.balance()?.energy_changes(energy_scale);
            (changes.into_iter().fold(0.0, larger), at_most()?)
        }
        "linear_momentum_drift" => (run.balance()?.linear_drift(scale("linear_momentum_scale")), at_most()?),
        "angular_momentum_drift" => (run.balance()?.angular_drift(scale("angular_momentum_scale")), at_most()?),
        "first_contact" if in_time(item.number(Some("to"))?) => {
            let (from, to) = (item.number(Some("from"))?, item.number(Some("to"))?);
            let contact = run.table("contact.csv")?;
            let touching = contact.column("active")?.iter().position(|active| *active > 0.0);
            let first = touching.map_or(Ok(f64::NAN), |row| contact.column("time").map(|time| time[row]))?;
            (first, Bound::Near { value: 0.5 * (from + to), tolerance: 0.5 * (to - from) })
        }
        "contact_at_end" if whole => {
            let contact = run.table("contact.csv")?;
            let touches = contact.column("active")?.last().is_some_and(|active| *active > 0.0);
            truth(Some(touches) == item.value.as_bool())
        }
        "probe" if in_time(item.number(Some("time"))?) => {
            let bound = Bound::Near { value: item.number(Some("value"))?, tolerance: item.number(Some("tolerance"))? };
            (probe(run, item)?, bound)
        }
        "outcome" | "steps" | "energy_drift_at_least" | "first_contact" | "contact_at_end" | "probe" => {
            return Ok(None);
        }
        unknown => return Err(format!("`cargo xtask verify` does not know [expect] {unknown}").into()),
    };
    Ok(Some(measured))
}

/// Value of a probe in the row whose time is nearest.
fn probe(run: &Run, item: &Item) -> Outcome<f64> {
    let word = |key: &str| item.value.get(key).and_then(Value::as_str);
    let name = word("name").ok_or("[[expect.probe]] without name")?;
    let column = word("component").map_or(name.to_owned(), |component| format!("{name}.{component}"));
    let wanted = item.number(Some("time"))?;
    let table = run.table("probes.csv")?;
    let (time, values) = (table.column("time")?, table.column(&column)?);
    let nearest = time.iter().zip(values).min_by(|a, b| (a.0 - wanted).abs().total_cmp(&(b.0 - wanted).abs()));
    Ok(*nearest.ok_or("probes.csv has no row")?.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Ending;
    use crate::workspace::write;

    /// A run of two steps, written by hand.
    fn run(name: &str, until: Option<f64>) -> Run {
        let folder = std::env::temp_dir().join(format!("stoss-xtask-{name}-{}", std::process::id()));
        let files = [
            (
                "summary.json",
                "{\"steps\": 2, \"cuts\": 1, \"mean_iterations\": 3.5, \"outcome\": {\"kind\": \"completed\"}}",
            ),
            (
                "balance.csv",
                "step,time,lx,ly,lz,jx,jy,jz,total\n0,0,1,0,0,0,0,1,4\n1,0.1,1,0,0,0,0,1,4\n2,0.2,1,0.5,0,0,0,1,3\n",
            ),
            ("contact.csv", "step,time,active,closed\n1,0.1,0,0\n2,0.2,1,1\n"),
            ("probes.csv", "step,time,tip.x,w\n0,0,0,7\n1,0.1,2,8\n2,0.2,4,9\n"),
        ];
        for (file, text) in files {
            write(&folder.join(file), text).unwrap();
        }
        Run { name: name.into(), folder, ending: Ending { code: Some(0), seconds: 0.0 }, until }
    }

    /// Measured value and verdict of each expectation, in the order of the keys.
    fn verdicts(run: &Run, expect: &str) -> Vec<Option<(f64, bool)>> {
        let expect: Table = expect.parse().unwrap();
        let all = expect.iter().flat_map(|(key, value)| items(key, value));
        let found =
            all.map(|item| measure(run, &expect, &item).unwrap().map(|(value, bound)| (value, bound.holds(value))));
        found.collect()
    }

    #[test]
    fn every_expectation_is_measured() {
        let run = run("whole", None);
        let cases = [
            ("outcome = \"completed\"", 1.0, true),
            ("outcome = \"failed\"", 0.0, false),
            ("steps = 2", 2.0, true),
            ("steps = 3", 2.0, false),
            ("max_cuts = 0", 1.0, false),
            ("max_newton_mean = 4", 3.5, true),
            ("energy_drift = 0.2", 0.25, false),
            ("energy_drift = 0.2\nenergy_scale = 10.0", 0.1, true),
            ("energy_drift_at_least = 0.2", 0.25, true),
            ("energy_change_without_closing = 1e-10", 0.0, true),
            ("energy_gain = 0.0", 0.0, true),
            ("linear_momentum_drift = 0.1\nlinear_momentum_scale = 5.0", 0.1, true),
            ("angular_momentum_drift = 1e-12", 0.0, true),
            ("first_contact = { from = 0.15, to = 0.25 }", 0.2, true),
            ("first_contact = { from = 0.05, to = 0.15 }", 0.2, false),
            ("contact_at_end = true", 1.0, true),
            ("contact_at_end = false", 0.0, false),
            ("[[probe]]\nname = \"tip\"\ncomponent = \"x\"\ntime = 0.11\nvalue = 2.5\ntolerance = 0.1", 2.0, false),
            ("[[probe]]\nname = \"w\"\ntime = 0.2\nvalue = 9.0\ntolerance = 0.1", 9.0, true),
        ];
        for (expect, value, verdict) in cases {
            assert_eq!(verdicts(&run, expect), [Some((value, verdict))], "{expect}");
        }
        std::fs::remove_dir_all(&run.folder).unwrap();
    }

    #[test]
    fn a_shortened_run_leaves_out_what_it_cannot_tell() {
        let run = run("short", Some(0.1));
        let expect = "steps = 9\nenergy_drift_at_least = 1.0\nfirst_contact = { from = 0.15, to = 0.25 }\n\
                      [[probe]]\nname = \"tip\"\ncomponent = \"x\"\ntime = 0.2\nvalue = 4.0\ntolerance = 0.1";
        assert_eq!(verdicts(&run, expect), [None; 4]);
        assert_eq!(verdicts(&run, "max_cuts = 1"), [Some((1.0, true))]);
        std::fs::remove_dir_all(&run.folder).unwrap();
    }

    #[test]
    fn an_unknown_expectation_is_an_error() {
        let value = Value::Float(1.0);
        let item = Item { key: "beauty", value: &value };
        let run = run("unknown", None);
        assert!(measure(&run, &Table::new(), &item).is_err());
        std::fs::remove_dir_all(&run.folder).unwrap();
    }
}
