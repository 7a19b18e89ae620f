//! One finished run of a scene and the files that it left.

use std::path::PathBuf;

use super::balance::Balance;
use super::check::{Bound, Check};
use super::newton::{self, StepResiduals};
use super::numbers::largest;
use crate::program::Ending;
use crate::table::Table;
use crate::vtu::{self, Grid};
use crate::workspace::{Outcome, read};

/// Exit code of a run that is wrong by the watch.
pub const WRONG: i32 = 4;

/// Part of a facet's area that is round-off.
const COVERAGE: f64 = 1e-12;

/// A run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Name of the scene.
    pub name: String,
    /// Output folder.
    pub folder: PathBuf,
    /// How the program ended.
    pub ending: Ending,
    /// The time at which the run was stopped; `None` if it went to the end of the scene.
    pub until: Option<f64>,
}

impl Run {
    /// Row that the program ended with this exit code. A run that was to complete, and of which the watch says that it is wrong, is reported:
    /// its verdict is for the suite `scenes`, in which a scene says what it expects.
    pub fn completed(&self, expected: i32) -> Check {
        let code = self.ending.code.map_or(f64::NAN, f64::from);
        if (expected, self.ending.code) == (0, Some(WRONG)) {
            let note = format!("wrong by the watch: {}", self.reasons());
            return Check::new(&self.name, "exit code", code, Bound::Unbounded).noted(note);
        }
        let check = Check::new(&self.name, "exit code", code, Bound::Near { value: expected.into(), tolerance: 0.0 });
        let note = match check.holds() {
            true => self.note(),
            false => format!("see {}", self.folder.with_extension("log").display()),
        };
        check.noted(note)
    }

    /// Says that the run was shortened, if it was.
    pub fn note(&self) -> String {
        self.until.map(|time| format!("shortened to t = {time}")).unwrap_or_default()
    }

    /// True if the program went to the end. What the watch found is a row of its own.
    pub fn succeeded(&self) -> bool {
        matches!(self.ending.code, Some(0 | WRONG))
    }

    /// What the watch found, in one word.
    pub fn verdict(&self) -> Outcome<String> {
        let summary = self.summary()?;
        Ok(summary["verdict"]["level"].as_str().ok_or("summary.json has no verdict")?.to_owned())
    }

    /// The first reason of the verdict, in the words of the watch.
    pub fn reasons(&self) -> String {
        let summary = self.summary().unwrap_or_default();
        summary["verdict"]["reasons"][0]["sentence"].as_str().unwrap_or_default().to_owned()
    }

    /// `balance.csv`.
    pub fn balance(&self) -> Outcome<Balance> {
        Balance::new(&self.table("balance.csv")?).map_err(|error| self.complaint("balance.csv", &error))
    }

    /// Rows of the drift of both momenta, over their largest size in the run.
    pub fn momentum_drifts(&self, balance: &Balance, bound: f64) -> [Check; 2] {
        let drifts = [("linear", balance.linear_drift(None)), ("angular", balance.angular_drift(None))];
        drifts.map(|(momentum, drift)| {
            Check::new(&self.name, format!("{momentum} momentum drift"), drift, Bound::AtMost(bound)).noted(self.note())
        })
    }

    /// `newton.csv`, step by step.
    pub fn newton(&self) -> Outcome<Vec<StepResiduals>> {
        newton::steps(&self.table("newton.csv")?).map_err(|error| self.complaint("newton.csv", &error))
    }

    /// For every row of the balance whether a node closed in that step, from `contact.csv`.
    pub fn closings(&self, balance: &Balance) -> Outcome<Vec<bool>> {
        let contact = self.table("contact.csv")?;
        let marks = closing_marks(&contact, &balance.step);
        marks.map_err(|error| self.complaint("contact.csv", &error))
    }

    /// Row of the invariant of mortar contact: what the program found in all steps.
    pub fn coverage(&self) -> Outcome<Check> {
        let contact = self.table("contact.csv")?;
        let defects = contact.column("coverage_defect")?;
        let worst = largest(defects.iter().copied());
        let quantity = "part of a slave facet without segment or with two";
        Ok(Check::new(&self.name, quantity, worst, Bound::AtMost(COVERAGE))
            .noted(format!("worst of {} steps", defects.len())))
    }

    /// A number of `summary.json`.
    pub fn summary_number(&self, key: &str) -> Outcome<f64> {
        let value = self.summary()?;
        let number = value.get(key).and_then(serde_json::Value::as_f64);
        number.ok_or_else(|| self.complaint("summary.json", &format!("no number {key:?}")))
    }

    /// `summary.json`.
    pub fn summary(&self) -> Outcome<serde_json::Value> {
        Ok(serde_json::from_str(&read(&self.folder.join("summary.json"))?)?)
    }

    /// A table of the folder.
    pub fn table(&self, file: &str) -> Outcome<Table> {
        Table::read(&self.folder.join(file))
    }

    /// Frames in the order of their names.
    pub fn frames(&self) -> Outcome<Vec<PathBuf>> {
        let folder = self.folder.join("frames");
        let mut frames: Vec<PathBuf> = std::fs::read_dir(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension().is_some_and(|kind| kind == "vtu"))
            .collect();
        frames.sort();
        Ok(frames)
    }

    /// The last frame.
    pub fn last_frame(&self) -> Outcome<Grid> {
        let frames = self.frames()?;
        let last = frames.last().ok_or_else(|| format!("{}: no frames", self.folder.display()))?;
        vtu::load(last)
    }

    fn complaint(&self, file: &str, error: &str) -> Box<dyn std::error::Error> {
        format!("{}: {error}", self.folder.join(file).display()).into()
    }
}

/// Rows of the balance whose step closed a node.
fn closing_marks(contact: &Table, steps: &[f64]) -> Result<Vec<bool>, String> {
    let (number, closed) = (contact.column("step")?, contact.column("closed")?);
    let closing: Vec<f64> =
        number.iter().zip(closed).filter(|(_, closed)| **closed > 0.0).map(|(step, _)| *step).collect();
    Ok(steps.iter().map(|step| closing.contains(step)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_coverage_of_all_steps_is_taken() {
        let folder = std::env::temp_dir().join(format!("stoss-xtask-coverage-{}", std::process::id()));
        let file = folder.join("contact.csv");
        let ending = Ending { code: Some(0), seconds: 0.0 };
        let run = Run { name: "coverage".into(), folder: folder.clone(), ending, until: None };
        for (rows, holds) in [("1,1e-15\n2,0\n", true), ("1,1e-9\n2,0\n", false), ("1,NaN\n2,0\n", false)] {
            crate::workspace::write(&file, &format!("step,coverage_defect\n{rows}")).unwrap();
            assert_eq!(run.coverage().unwrap().holds(), holds, "{rows}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn closings_are_matched_by_step_number() {
        let contact = Table::parse("step,time,active,closed\n2,0.2,1,1\n3,0.3,1,0\n4,0.4,3,2\n").unwrap();
        let marks = closing_marks(&contact, &[0.0, 1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(marks, [false, false, true, false, true]);
    }
}
