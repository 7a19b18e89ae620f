//! Sweeps: one scene with many values of its parameters, a folder a case and a row a case in `sweep.csv`.
//!
//! A case is an ordinary run with `--set`, so that any program can do it; this module says which runs there are ([`SweepPlan::command`]),
//! which of them are done ([`SweepPlan::state`]), and gathers what they left ([`SweepPlan::collect`]).
//!
//! # What it is not
//! No scheduler: who does the runs, and how many at once, is the caller's affair.

use crate::error::{OutputError, RunError};
use crate::output::{Outcome, Summary};
use crate::scene::{OwnNames, Problem, Scene, SceneErrors, parse_set};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stoss_solver::digits;

/// Name of the table of a sweep.
pub const TABLE: &str = "sweep.csv";

/// A sweep as its scene describes it.
#[derive(Clone, Debug)]
pub struct SweepPlan {
    scene: PathBuf,
    set: Vec<(String, String)>,
    parameters: Vec<String>,
    extremes: Vec<String>,
    cases: Vec<Case>,
}

/// One case of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Number of the case, from 1.
    pub number: usize,
    /// Values of the parameters that it gives.
    pub values: BTreeMap<String, f64>,
    /// Values of all parameters with those; only those if the scene cannot be read.
    used: BTreeMap<String, f64>,
    /// SHA-256 of the version and of the scene as it is read with these values; or why it cannot be read.
    scene: Result<String, String>,
}

/// State of a case of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseState {
    /// A case of which nothing is there, or what is there is of another scene.
    New,
    /// A case that was begun, and can go on from its checkpoint.
    Begun,
    /// A case that has run to its end, right or wrong.
    Done,
    /// A case that stopped with an error, or whose scene is wrong.
    Failed,
}

/// What is remembered of a case beside its folder.
#[derive(Debug, Serialize, Deserialize)]
struct Mark {
    scene: String,
    values: BTreeMap<String, f64>,
}

impl Case {
    /// The case in words, for instance `mu=0.1 radius=2`.
    pub fn label(&self) -> String {
        self.values.iter().map(|(name, value)| format!("{name}={}", digits(*value))).collect::<Vec<_>>().join(" ")
    }

    /// Folder of its results within the folder of the sweep.
    pub fn folder(&self, out: &Path) -> PathBuf {
        out.join("cases").join(format!("{:04}", self.number))
    }

    /// File for what its run prints.
    pub fn log(&self, out: &Path) -> PathBuf {
        self.folder(out).with_extension("log")
    }

    fn mark(&self, out: &Path) -> PathBuf {
        self.folder(out).with_extension("json")
    }

    fn summary(&self, out: &Path) -> Option<Summary> {
        Summary::read(&self.folder(out)).ok()
    }

    /// The last error that its run printed.
    fn error(&self, out: &Path) -> Option<String> {
        let log = std::fs::read(self.log(out)).ok()?;
        let log = String::from_utf8_lossy(&log);
        log.lines().rev().find_map(|line| line.strip_prefix("error: ")).map(str::to_owned)
    }
}

impl SweepPlan {
    /// Reads the sweep of a scene file; `set` has parameters with other values than the file gives, in all cases.
    ///
    /// # Errors
    /// [`RunError`] if the scene cannot be read, has no sweep, or if the sweep gives a parameter that `set` gives too.
    pub fn read(path: &Path, set: &[(String, String)]) -> Result<Self, RunError> {
        let text = crate::run::read_text(path)?;
        let file = path.display().to_string();
        let scene = parse_set(&text, &file, &OwnNames::default(), set).map_err(RunError::Scene)?;
        let Some(sweep) = &scene.sweep else {
            let remedy =
                "add for instance `[sweep]` with `grid = { mu = [0.0, 0.1, 0.2] }`, with parameters of the scene";
            let problem = Problem::at(&scene, "sweep", "", "the scene has no sweep", remedy);
            return Err(match SceneErrors::new(vec![problem], &text) {
                Some(errors) => RunError::Scene(errors),
                None => RunError::Option(remedy.to_owned()),
            });
        };
        let parameters: Vec<String> = sweep.parameters().into_iter().map(str::to_owned).collect();
        if let Some((name, _)) = set.iter().find(|(name, _)| parameters.contains(name)) {
            return Err(RunError::Option(format!("--set {name}: the sweep gives this parameter; remove the option")));
        }
        let cases = sweep.all().into_iter().enumerate().map(|(k, values)| {
            let mut all = set.to_vec();
            all.extend(assignments(&values));
            let (scene, used) = match parse_set(&text, &file, &OwnNames::default(), &all) {
                Ok(scene) => (Ok(hash(&scene)), scene.parameters),
                Err(errors) => {
                    let first = errors.problems().first().map(ToString::to_string).unwrap_or_default();
                    (Err(first), values.clone())
                }
            };
            Case { number: k + 1, values, used, scene }
        });
        let (set, extremes) = (set.to_vec(), sweep.extremes.clone());
        Ok(Self { scene: path.to_path_buf(), set, parameters, extremes, cases: cases.collect() })
    }

    /// The cases in order.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// Arguments of the program `stoss` that do a case, or go on with it.
    pub fn command(&self, out: &Path, case: &Case) -> Vec<String> {
        let mut words = vec!["run".to_owned(), self.scene.display().to_string()];
        words.extend(["--out".to_owned(), case.folder(out).display().to_string()]);
        for (name, value) in self.set.iter().cloned().chain(assignments(&case.values)) {
            words.extend(["--set".to_owned(), format!("{name}={value}")]);
        }
        if self.state(out, case) == CaseState::Begun {
            words.push("--resume".to_owned());
        }
        words
    }

    /// State of a case.
    pub fn state(&self, out: &Path, case: &Case) -> CaseState {
        let Ok(scene) = &case.scene else { return CaseState::Failed };
        let mark = std::fs::read(case.mark(out)).ok().and_then(|bytes| serde_json::from_slice::<Mark>(&bytes).ok());
        if mark.is_none_or(|mark| mark.scene != *scene) {
            return CaseState::New;
        }
        match case.summary(out).map(|summary| summary.outcome) {
            Some(Outcome::Completed) => CaseState::Done,
            Some(Outcome::Failed { .. }) => CaseState::Failed,
            // The watch stops a run that is wrong; nothing else stops one that no `--until` was given.
            Some(Outcome::Stopped { .. }) => CaseState::Done,
            Some(Outcome::Interrupted { .. } | Outcome::Running) if case.folder(out).join("checkpoint").is_file() => {
                CaseState::Begun
            }
            Some(_) => CaseState::New,
            None if case.error(out).is_some() => CaseState::Failed,
            None => CaseState::New,
        }
    }

    /// Begins a case, before it is run: remembers of which scene its folder will be. What an earlier, other case of this number has
    /// left besides is removed.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn begin(&self, out: &Path, case: &Case) -> Result<(), OutputError> {
        let folder = out.join("cases");
        std::fs::create_dir_all(&folder).map_err(OutputError::io(&folder))?;
        if self.state(out, case) != CaseState::Begun {
            for path in [case.log(out), case.folder(out).join("summary.json")] {
                match std::fs::remove_file(&path) {
                    Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                        return Err(OutputError::io(&path)(error));
                    }
                    _ => {}
                }
            }
        }
        let mark = Mark { scene: case.scene.clone().unwrap_or_default(), values: case.values.clone() };
        let path = case.mark(out);
        // Strings and finite numbers: printing cannot fail.
        let text = serde_json::to_string_pretty(&mark).unwrap_or_default();
        std::fs::write(&path, text + "\n").map_err(OutputError::io(&path))
    }

    /// Gathers the results of all cases into `sweep.csv`, and returns how each one ended, with the reason if it failed or is not sound.
    ///
    /// # Errors
    /// [`OutputError::Io`] if the table cannot be written.
    pub fn collect(&self, out: &Path) -> Result<Vec<CaseResult>, OutputError> {
        let results: Vec<CaseResult> = self.cases.iter().map(|case| self.result(out, case)).collect();
        let mut probes: Vec<String> = Vec::new();
        for name in results.iter().flat_map(|result| result.last.iter().map(|(name, _)| name)) {
            if !probes.contains(name) {
                probes.push(name.clone());
            }
        }
        let mut head: Vec<String> = vec!["case".into()];
        head.extend(self.parameters.iter().cloned());
        head.extend(["outcome", "verdict", "reason", "time", "steps", "wall_seconds"].map(String::from));
        head.extend(probes.iter().map(|name| format!("last.{name}")));
        head.extend(self.extremes.iter().flat_map(|name| [format!("min.{name}"), format!("max.{name}")]));
        let mut text = head.iter().map(|name| cell(name)).collect::<Vec<_>>().join(",") + "\n";
        for (case, result) in self.cases.iter().zip(&results) {
            let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
            let mut row = vec![case.number.to_string()];
            row.extend(self.parameters.iter().map(|name| number(case.used.get(name).copied())));
            row.extend([result.outcome.to_owned(), result.verdict.clone(), cell(&result.reason)]);
            row.extend([
                result.time.map_or_else(String::new, digits),
                result.steps.map_or_else(String::new, |steps| steps.to_string()),
            ]);
            row.push(number(result.wall_seconds));
            let last = |name: &String| result.last.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
            row.extend(probes.iter().map(|name| number(last(name))));
            row.extend(
                result.extremes.iter().flat_map(|range| range.map_or([None; 2], |range| range.map(Some)).map(number)),
            );
            text += &(row.join(",") + "\n");
        }
        std::fs::create_dir_all(out).map_err(OutputError::io(out))?;
        let (path, scratch) = (out.join(TABLE), out.join(".sweep.csv.part"));
        std::fs::write(&scratch, text).map_err(OutputError::io(&scratch))?;
        std::fs::rename(&scratch, &path).map_err(OutputError::io(&path))?;
        Ok(results)
    }

    fn result(&self, out: &Path, case: &Case) -> CaseResult {
        let none = vec![None; self.extremes.len()];
        let mut result = CaseResult { outcome: "missing", extremes: none, ..CaseResult::default() };
        let state = self.state(out, case);
        if let Err(problem) = &case.scene {
            result.outcome = "failed";
            result.reason.clone_from(problem);
        }
        if case.scene.is_err() || state == CaseState::New {
            return result;
        }
        let Some(summary) = case.summary(out) else {
            result.outcome = "failed";
            result.reason = case.error(out).unwrap_or_default();
            return result;
        };
        result.outcome = summary.outcome.kind();
        result.verdict = summary.verdict.level.to_string();
        let ended = match &summary.outcome {
            Outcome::Failed { reason, .. } => Some(reason.clone()),
            Outcome::Running => Some("its process is running still, or was killed".to_owned()),
            _ => None,
        };
        // Why it failed, then what was found up to there.
        let found = summary.verdict.reasons.first().map(|found| match ended {
            Some(_) => format!("{}: {}", summary.outcome.judged(summary.time), found.sentence),
            None => found.sentence.clone(),
        });
        result.reason = ended.into_iter().chain(found).collect::<Vec<_>>().join("; ");
        result.time = Some(summary.time);
        result.steps = Some(summary.steps);
        result.wall_seconds = Some(summary.wall_seconds);
        let folder = case.folder(out);
        if let Some(table) = Columns::read(&folder.join("probes.csv")) {
            result.last = table.last();
        }
        for (place, name) in self.extremes.iter().enumerate() {
            let range = name
                .split_once('.')
                .and_then(|(table, column)| Columns::read(&folder.join(table).with_extension("csv"))?.range(column));
            if range.is_none() && result.reason.is_empty() {
                result.reason = format!("there is no column {name} with numbers");
            }
            result.extremes[place] = range;
        }
        result
    }
}

/// End and results of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaseResult {
    /// `completed`, `stopped`, `interrupted`, `running`, `failed`, or `missing` if it was not run.
    pub outcome: &'static str,
    /// `sound`, `doubtful` or `wrong`; empty without results. Of a case that is not completed it is the verdict on the part up to `time`.
    pub verdict: String,
    /// Why it failed or is not sound; empty otherwise.
    pub reason: String,
    /// Time reached.
    pub time: Option<f64>,
    /// Completed steps.
    pub steps: Option<u64>,
    /// Wall seconds of its last session.
    pub wall_seconds: Option<f64>,
    /// Last values of the columns of `probes.csv`.
    pub last: Vec<(String, f64)>,
    /// Smallest and largest value of each chosen column.
    pub extremes: Vec<Option<[f64; 2]>>,
}

/// `name`, `value` as `--set` takes them, with all digits.
fn assignments(values: &BTreeMap<String, f64>) -> impl Iterator<Item = (String, String)> + '_ {
    values.iter().map(|(name, value)| (name.clone(), format!("{value:e}")))
}

/// Hash of the version and the scene, without the sweep itself: other cases may be added.
fn hash(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.sweep = None;
    let mut hash = Sha256::new();
    hash.update(env!("CARGO_PKG_VERSION"));
    // A scene that was read has no key that is no string: printing cannot fail.
    hash.update(serde_json::to_string(&scene).unwrap_or_default());
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A cell of a comma-separated table, in quotes where it needs them (RFC 4180), on one line.
fn cell(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.contains([',', '"']) { format!("\"{}\"", line.replace('"', "\"\"")) } else { line }
}

/// The numbers of a table of results.
struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<Option<f64>>>,
}

impl Columns {
    fn read(path: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(path).ok()?;
        let mut lines = text.lines();
        let names = lines.next()?.split(',').map(str::to_owned).collect();
        let rows = lines.map(|line| line.split(',').map(|cell| cell.parse().ok()).collect()).collect();
        Some(Self { names, rows })
    }

    /// The columns after step and time, with their values in the last row.
    fn last(&self) -> Vec<(String, f64)> {
        let Some(row) = self.rows.last() else { return Vec::new() };
        let cells = self.names.iter().zip(row).filter(|(name, _)| !matches!(name.as_str(), "step" | "time"));
        cells.filter_map(|(name, value)| Some((name.clone(), (*value)?))).collect()
    }

    /// Smallest and largest value of a column, NaN left out.
    fn range(&self, name: &str) -> Option<[f64; 2]> {
        let column = self.names.iter().position(|known| known == name)?;
        let values = self.rows.iter().filter_map(|row| *row.get(column)?).filter(|value| !value.is_nan());
        values.fold(None, |range, value| match range {
            None => Some([value; 2]),
            Some([low, high]) => Some([value.min(low), value.max(high)]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_quoted_where_they_must() {
        assert_eq!(cell("a b"), "a b");
        assert_eq!(cell("a,\nb \"c\""), "\"a, b \"\"c\"\"\"");
    }

    #[test]
    fn ranges_leave_nan_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("contact.csv");
        std::fs::write(&path, "step,time,min_gap,x\n0,0e0,inf,NaN\n1,1e0,-2.5e-1,\n").unwrap();
        let table = Columns::read(&path).unwrap();
        assert_eq!(table.range("min_gap"), Some([-0.25, f64::INFINITY]));
        assert_eq!((table.range("x"), table.range("y")), (None, None));
        assert_eq!(table.last(), vec![("min_gap".to_owned(), -0.25)]);
    }
}
