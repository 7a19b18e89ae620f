//! `summary.json`.

use super::{Drift, OutputError};
use crate::build::ContactPlan;
use crate::scene::OnFault;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use stoss_solver::{Decision, Timings, digits};
use stoss_watch::{Severity, Verdict};

/// End of a run.
#[derive(Clone, Debug, Serialize, Deserialize, PartialEq)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Outcome {
    /// Reached the end of the scene.
    Completed,
    /// Stopped at the time that was asked for, before the end of the scene; it can be resumed.
    Stopped {
        /// Last completed step.
        last_step: u64,
        /// Time of the last completed step.
        last_time: f64,
    },
    /// Ended by the user before the scene's end ([`crate::run::RunOptions::stop`]); it can be resumed.
    Interrupted {
        /// Last completed step.
        last_step: u64,
        /// Time of the last completed step.
        last_time: f64,
    },
    /// Still running (or killed).
    Running,
    /// Stopped with an error; everything up to the last completed step is valid.
    Failed {
        /// What happened.
        reason: String,
        /// Last completed step.
        last_step: u64,
        /// Time of the last completed step.
        last_time: f64,
    },
}

/// Peak memory of the process.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, PartialEq)]
pub struct Memory {
    /// Largest resident set in bytes, where the system reports it (Linux).
    pub peak_resident_bytes: Option<u64>,
    /// Bytes of the matrix, its factors and the element data at the end.
    pub system_bytes: usize,
}

/// What a rank of a run on several has needed: memory, and what it received from the others; not what passes between them inside of PETSc.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, PartialEq)]
pub struct RankSummary {
    /// Largest resident set in bytes, where the system reports it.
    pub peak_resident_bytes: Option<u64>,
    /// Collective operations.
    pub operations: u64,
    /// Messages of other ranks.
    pub messages: u64,
    /// Bytes of these messages.
    pub received_bytes: u64,
}

/// What the watch checked, and when.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, PartialEq)]
pub struct WatchSummary {
    /// Steps between two checks of the geometry.
    pub every: u64,
    /// What a verdict `wrong` does.
    pub on_fault: OnFault,
    /// Wall seconds that it took (in this session, if resumed).
    pub seconds: f64,
}

/// Summary of a run.
#[derive(Clone, Debug, Serialize, Deserialize, PartialEq)]
pub struct Summary {
    /// Version of Stoss.
    pub version: String,
    /// Title of the scene.
    pub title: String,
    /// End of the run.
    pub outcome: Outcome,
    /// What the watch found: sound, doubtful or wrong, and why. Of a run that is not completed it is the verdict on the part up to `time`.
    pub verdict: Verdict,
    /// SHA-256 of all that the results depend on: version, parsed scene, mesh files.
    pub scene_hash: String,
    /// Scheme, or "quasi-static".
    pub scheme: String,
    /// Bodies, nodes, elements, free components, largest number of equations.
    pub unknowns: BTreeMap<String, u64>,
    /// Crates and structures used, see `stoss check`.
    pub parts: BTreeMap<String, bool>,
    /// Contacts with all that they are computed with, defaults included.
    pub contacts: Vec<ContactPlan>,
    /// Direct solver.
    pub linear_solver: String,
    /// Counts of the linear solver: analyses, factorisations, solves, refinement steps, fallbacks.
    pub linear_solver_counts: BTreeMap<String, u64>,
    /// Completed steps.
    pub steps: u64,
    /// Halved steps.
    pub cuts: u64,
    /// Mean Newton iterations (linear solves) a step.
    pub mean_iterations: f64,
    /// Largest number of Newton iterations of a step.
    pub max_iterations: u64,
    /// Time reached.
    pub time: f64,
    /// Seconds by phase.
    pub seconds: Timings,
    /// Part of the wall time of the phases' `total` that each takes; `rest` for what belongs to none.
    pub shares: BTreeMap<String, f64>,
    /// Part of it that contact takes: search and contact elements together.
    pub contact_share: f64,
    /// Wall seconds of the whole run (of this session, if resumed).
    pub wall_seconds: f64,
    /// CPU seconds of the whole run (of this session, if resumed).
    pub cpu_seconds: f64,
    /// Memory; of a run on several ranks that of the first.
    pub memory: Memory,
    /// What each rank of a run on several has needed (in this session, if resumed); empty of other runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ranks: Vec<RankSummary>,
    /// Largest drifts: `linear_momentum`, `angular_momentum`, `energy`; those that loads or supports change have a reason in place of a number.
    pub drift: BTreeMap<String, Drift>,
    /// Every decision of step control and active set.
    pub decisions: Vec<Decision>,
    /// How often the watch checked, and what a verdict `wrong` does.
    pub watch: WatchSummary,
    /// Wall seconds that writing the page `report.html` at the end of the run took, if it was written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page_seconds: Option<f64>,
}

impl Outcome {
    /// Name of the outcome in `summary.json`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Stopped { .. } => "stopped",
            Self::Interrupted { .. } => "interrupted",
            Self::Running => "running",
            Self::Failed { .. } => "failed",
        }
    }

    /// What the verdict on a run with this outcome, which has reached a time, is called: of one that is not completed it says up to where.
    pub fn judged(&self, time: f64) -> String {
        match self {
            Self::Completed => "verdict".to_owned(),
            _ => format!("verdict up to t = {}", digits(time)),
        }
    }
}

impl std::fmt::Display for Outcome {
    /// The outcome in words, for instance "failed after step 3 at t = 0.25: ...".
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Completed | Self::Running => f.write_str(self.kind()),
            Self::Stopped { last_step, last_time }
            | Self::Interrupted { last_step, last_time }
            | Self::Failed { last_step, last_time, .. } => {
                write!(f, "{} after step {last_step} at t = {}", self.kind(), digits(*last_time))?;
                if let Self::Failed { reason, .. } = self { write!(f, ": {reason}") } else { Ok(()) }
            }
        }
    }
}

impl Summary {
    /// Reads that of a folder of results.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn read(folder: &Path) -> Result<Self, OutputError> {
        let path = folder.join("summary.json");
        let bytes = std::fs::read(&path).map_err(OutputError::io(&path))?;
        serde_json::from_slice(&bytes).map_err(|e| OutputError::Damaged { path: path.clone(), reason: e.to_string() })
    }

    /// Writes it into a folder of results, as `summary.json`.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join("summary.json");
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| OutputError::Damaged { path: path.clone(), reason: e.to_string() })?;
        let scratch = folder.join(".summary.json.part");
        std::fs::write(&scratch, text + "\n").map_err(OutputError::io(&scratch))?;
        std::fs::rename(&scratch, &path).map_err(OutputError::io(&path))
    }

    /// Adds the seconds that the page of a run took to the summary in its folder; nothing happens without a summary there.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn add_page_seconds(folder: &Path, seconds: f64) -> Result<(), OutputError> {
        let path = folder.join("summary.json");
        if !path.is_file() {
            return Ok(());
        }
        let mut summary = Self::read(folder)?;
        summary.page_seconds = Some(seconds);
        summary.write(folder)
    }

    /// Whether the result is wrong and the scene does not say that this is to be ignored.
    pub fn is_fault(&self) -> bool {
        self.verdict.level == Severity::Wrong && self.watch.on_fault != OnFault::Ignore
    }
}

impl std::fmt::Display for Summary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.outcome {
            Outcome::Completed => write!(f, "completed: ")?,
            Outcome::Stopped { .. } => write!(f, "stopped before the scene's end: ")?,
            Outcome::Interrupted { .. } => write!(f, "interrupted: ")?,
            Outcome::Running => write!(f, "running: ")?,
            Outcome::Failed { .. } => write!(f, "failed: ")?,
        }
        writeln!(
            f,
            "{} steps to t = {} in {:.2} s ({:.2} s CPU), {:.2} Newton iterations a step, {} cuts",
            self.steps,
            digits(self.time),
            self.wall_seconds,
            self.cpu_seconds,
            self.mean_iterations,
            self.cuts
        )?;
        write!(f, "time:")?;
        for (name, share) in self.seconds.shares() {
            write!(f, "  {name} {:.1} %", 100.0 * share)?;
        }
        writeln!(f, "  (contact altogether {:.1} %)", 100.0 * self.contact_share)?;
        if let Some(most) = self.ranks.iter().max_by_key(|rank| rank.received_bytes) {
            let megabytes = |bytes: u64| bytes as f64 / 1e6;
            let peak = self.ranks.iter().filter_map(|rank| rank.peak_resident_bytes).max();
            writeln!(
                f,
                "ranks:  {}, each received up to {:.2} MB in {} operations, {} messages{}",
                self.ranks.len(),
                megabytes(most.received_bytes),
                most.operations,
                most.messages,
                peak.map_or(String::new(), |peak| format!("; memory up to {:.0} MB a rank", megabytes(peak)))
            )?;
        }
        write!(f, "largest relative drift:")?;
        for (name, drift) in &self.drift {
            match drift.relative {
                Some(relative) => write!(f, "  {} {relative:.1e}", name.replace('_', " "))?,
                None => write!(f, "  {} -", name.replace('_', " "))?,
            }
        }
        write!(f, "\n{}: {}", self.outcome.judged(self.time), self.verdict)
    }
}
