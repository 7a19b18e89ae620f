//! What a run left, read completely: nothing that is missing, unreadable or not a number gets past this.

use super::super::super::Run;
use super::super::super::balance::Balance;
use super::super::super::launch::Launched;
use super::geometry::Configuration;
use super::scene::Scene;
use crate::vtu::{self, Grid};
use crate::workspace::read;

/// Exit code of a run that had to give up.
const GAVE_UP: i32 = 3;

/// The words that introduce the cause in the error of a failed step.
const CAUSE: &str = "at the step size";

/// A run that ended in an allowed way.
#[derive(Debug)]
pub struct Evidence {
    /// The run.
    pub run: Run,
    /// Momenta and energy.
    pub balance: Balance,
    /// Smallest step.
    pub least_step: f64,
    /// Least energy that friction dissipates in a step, over the largest energy of the run or what friction dissipates in it.
    pub least_dissipation: f64,
    /// The frames.
    pub frames: Vec<Configuration>,
    /// Displacements of the last frame.
    pub displacement: Vec<f64>,
    /// The cause of a named error.
    pub error: Option<String>,
}

impl Evidence {
    /// Reads everything that the run of a scene, with contact or without, has to leave; the error is what must not be.
    pub fn read(scene: &Scene, has_contact: bool, launched: Launched) -> Result<Self, String> {
        let Launched { run, hung, log } = launched;
        if hung {
            return Err("does not end".into());
        }
        let error = match run.ending.code {
            Some(0) => None,
            Some(GAVE_UP) => Some(cause(&log).ok_or("exit code 3 without a named cause")?),
            Some(101) => return Err(format!("panics: {}", log.trim())),
            Some(code) => return Err(format!("exit code {code}: {}", log.trim())),
            None => return Err("killed by a signal".into()),
        };
        let words = |error: Box<dyn std::error::Error>| error.to_string();
        let text = |file: &str| read(&run.folder.join(file)).map_err(words);
        let mut tables = vec!["balance.csv", "newton.csv"];
        if has_contact {
            tables.push("contact.csv");
        }
        if scene.text().contains("[[probe]]") {
            tables.push("probes.csv");
        }
        for file in tables {
            finite(&text(file)?).map_err(|error| format!("{file}: {error}"))?;
        }
        let balance = run.balance().map_err(words)?;
        let sizes = run.table("balance.csv").map_err(words)?;
        let least_step = sizes.column("dt")?.iter().skip(1).copied().fold(f64::INFINITY, f64::min);
        let dissipation = sizes.column("dissipation")?;
        let largest = balance.total.iter().chain(dissipation).fold(f64::MIN_POSITIVE, |most, e| most.max(e.abs()));
        let least_dissipation = dissipation.windows(2).map(|pair| (pair[1] - pair[0]) / largest).fold(0.0, f64::min);
        let summary = run.summary().map_err(words)?;
        let outcome = summary["outcome"]["kind"].as_str().unwrap_or("missing").to_owned();
        let expected = if error.is_some() { "failed" } else { "completed" };
        if outcome != expected {
            return Err(format!("summary.json says {outcome}, the exit code {expected}"));
        }
        let steps = run.summary_number("steps").map_err(words)?;
        if steps != balance.step.len() as f64 - 1.0 {
            return Err(format!("{steps} steps, but balance.csv has {} rows", balance.step.len()));
        }
        let grids: Vec<Grid> = run
            .frames()
            .map_err(words)?
            .iter()
            .map(|file| vtu::load(file).map_err(words))
            .collect::<Result<_, String>>()?;
        if scene.text().contains("every = 1\n") && grids.len() != balance.step.len() {
            return Err(format!("{} frames of {} states", grids.len(), balance.step.len()));
        }
        for field in ["displacement", "velocity", "von_mises"] {
            let values = grids.iter().filter_map(|grid| grid.point_data.get(field)).flat_map(|array| &array.values);
            if values.clone().any(|value| !value.is_finite()) {
                return Err(format!("{field} is not finite in a frame"));
            }
        }
        let frames = grids.iter().map(Configuration::new).collect::<Result<Vec<_>, _>>()?;
        let last = grids.last().ok_or("no frames")?;
        let displacement = last.point_data["displacement"].values.clone();
        Ok(Self { run, balance, least_step, least_dissipation, frames, displacement, error })
    }

    /// Last entry of a column of the probes.
    pub fn probe(&self, column: &str) -> crate::workspace::Outcome<f64> {
        let table = self.run.table("probes.csv")?;
        Ok(*table.column(column)?.last().ok_or("probes.csv has no row")?)
    }
}

/// The cause that the program names, without numbers of elements and steps.
fn cause(log: &str) -> Option<String> {
    let line = log.lines().find(|line| line.contains(CAUSE))?;
    let (_, rest) = line.split_once(CAUSE)?;
    let (_, cause) = rest.split_once(": ")?;
    Some(cause.trim().to_owned())
}

/// Every entry of a table is a finite number; a gap without a partner may be infinite.
fn finite(text: &str) -> Result<(), String> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().ok_or("empty")?.split(',').collect();
    for (row, line) in lines.enumerate() {
        let entries: Vec<&str> = line.split(',').collect();
        if entries.len() != head.len() {
            return Err(format!("row {row} is incomplete"));
        }
        for (name, entry) in head.iter().zip(entries) {
            let value: f64 = entry.parse().map_err(|_| format!("{name} = {entry} in row {row}"))?;
            if !(value.is_finite() || name.rsplit('.').next() == Some("min_gap") && value == f64::INFINITY) {
                return Err(format!("{name} = {entry} in row {row}"));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_gap_may_be_infinite_and_nothing_nan() {
        assert!(finite("step,min_gap,a/b.min_gap\n1,inf,inf\n2,0.5,0.5\n").is_ok());
        for bad in ["step,min_gap\n1,NaN\n", "step,total\n1,inf\n", "step,total\n1\n", "step,total\n1,x\n", ""] {
            assert!(finite(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_cause_of_a_failed_step_is_found() {
        let log = "warning: x\nerror: step 9 from time 0.5 failed even at the step size 2.4e-7: body 'b': element 0 is inverted\n";
        assert_eq!(cause(log).unwrap(), "body 'b': element 0 is inverted");
        assert_eq!(cause("error: something else"), None);
    }
}
