//! The events of a run as records for programs: what `stoss run --json` prints, one JSON object a line.
//!
//! Every object has the key `event`. A stream begins with `start` (unless the run does not begin) and its last object is `end` or `error`.
//! Programs should ignore keys and events that they do not know: later versions may have more.
//!
//! # What it is not
//! No callback and no log: [`crate::run::run_scene`] hands out its own [`Event`]s, and these are made from them.

use crate::output::{Summary, Watched};
use crate::run::{Event, RunError};
use crate::scene::Problem;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stoss_solver::StepRecord;
use stoss_watch::Verdict;

/// One line of `stoss run --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "event", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum EventRecord {
    /// The run begins.
    Start {
        /// Title of the scene.
        title: String,
        /// Folder of the results.
        out: String,
        /// Time at which the run ends.
        end: f64,
        /// Nominal size of a step.
        step: f64,
        /// Whether it continues from a checkpoint.
        resumed: bool,
    },
    /// A warning: no error, but it needs attention.
    Warning {
        /// The warning in words.
        message: String,
    },
    /// A step was completed; its results are in the folder.
    Step(StepEvent),
    /// The run stopped or came out wrong, and this is why. The file `diagnosis.json` in the folder has all of it.
    Diagnosis(DiagnosisEvent),
    /// Ctrl-C or SIGTERM: the run will end after the present step.
    Interrupting,
    /// The run has ended, at its end or before.
    End(EndEvent),
    /// The run did not begin, or stopped early.
    Error(ErrorEvent),
}

/// A completed step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct StepEvent {
    /// Number of the step, from 1.
    pub step: u64,
    /// Number of the stage, from 1.
    pub stage: u32,
    /// Time at its end.
    pub time: f64,
    /// Size of the step.
    pub dt: f64,
    /// Time at which the run ends.
    pub end: f64,
    /// Linear solves.
    pub iterations: u32,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Strain energy.
    pub strain: f64,
    /// Column `total` of `balance.csv`.
    pub total: f64,
    /// Contact, if the scene has any.
    pub contact: Option<ContactEvent>,
    /// Largest drift so far of what scheme, loads and supports leave constant, a part of its scale; null if nothing is.
    pub drift: Option<f64>,
    /// What drifts so: `linear momentum`, `angular momentum` or `energy`.
    pub drift_of: Option<String>,
    /// Deepest penetration of bodies so far, a length.
    pub depth: f64,
    /// Deepest penetration in edges of the facets there.
    pub relative_depth: f64,
    /// What the step control decided on the way to this step.
    pub decisions: Vec<DecisionEvent>,
}

/// Why a run stopped or came out wrong: the likely cause.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct DiagnosisEvent {
    /// Name of the cause, for instance `no-support`.
    pub cause: String,
    /// Certainty of the cause: `high`, `medium` or `low`.
    pub confidence: String,
    /// Place in words.
    pub place: String,
    /// The cause in words of the scene.
    pub sentence: String,
    /// What to try, the most promising first.
    pub remedies: Vec<String>,
}

/// Contact at the end of a step, all pairs together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ContactEvent {
    /// Closed contacts.
    pub active: usize,
    /// Contacts that closed in the step.
    pub closed: usize,
    /// Contacts that opened in the step.
    pub released: usize,
    /// Smallest gap; null if nothing is near.
    pub min_gap: Option<f64>,
    /// Largest pressure, per current area.
    pub max_pressure: f64,
}

/// A decision of the step control or of the active set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct DecisionEvent {
    /// `cut`, `grow`, `restart`, `warning`, `stage` or `release`.
    pub kind: String,
    /// Time at the start of the step that was being done.
    pub time: f64,
    /// Why.
    pub reason: String,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct EndEvent {
    /// `completed`, `stopped` (by `--until` or the watch) or `interrupted`.
    pub outcome: String,
    /// Completed steps.
    pub steps: u64,
    /// Time reached.
    pub time: f64,
    /// Folder of the results.
    pub out: String,
    /// Verdict of the watch: `sound`, `doubtful` or `wrong`; of a run that is not completed on the part up to `time`.
    pub verdict: String,
    /// Why it is not sound, the worst first.
    pub reasons: Vec<String>,
    /// Wall seconds of this session.
    pub wall_seconds: f64,
    /// Exit code of the program.
    pub exit_code: u8,
}

/// Why a run did not begin, or stopped early.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ErrorEvent {
    /// The error in words.
    pub message: String,
    /// `failed` if the simulation stopped early; null if the run did not begin, or its results could not be written.
    pub outcome: Option<String>,
    /// Problems of the scene; empty if it is none of the scene.
    pub problems: Vec<ProblemEvent>,
    /// Last completed step, if the simulation stopped early.
    pub last_step: Option<u64>,
    /// Time of the last completed step.
    pub last_time: Option<f64>,
    /// Verdict of the watch up to there: `sound`, `doubtful` or `wrong`.
    pub verdict: Option<String>,
    /// Why it is not sound, the worst first.
    pub reasons: Vec<String>,
    /// Exit code of the program.
    pub exit_code: u8,
}

/// A problem of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ProblemEvent {
    /// The scene's file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of the key; empty for errors of syntax.
    pub key: String,
    /// The value as written; empty if there is none.
    pub value: String,
    /// The problem in words.
    pub message: String,
    /// Remedy: what to do.
    pub remedy: String,
}

impl EventRecord {
    /// The record of an event of a run; `None` for an event that has no record.
    pub fn of(event: &Event<'_>) -> Option<Self> {
        match event {
            Event::Start { title, out, end, step, resumed } => Some(Self::Start {
                title: (*title).to_owned(),
                out: out.display().to_string(),
                end: *end,
                step: *step,
                resumed: *resumed,
            }),
            Event::Warning(text) => Some(Self::Warning { message: (*text).to_owned() }),
            Event::Step { record, end, extent, watched } => {
                Some(Self::Step(step_event(record, *end, *extent, watched)))
            }
            Event::Diagnosis(diagnosis) => diagnosis.findings.first().map(|first| {
                let name = |value: serde_json::Result<serde_json::Value>| {
                    // Units of an enum: printing cannot fail, and gives a string.
                    value.ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
                };
                Self::Diagnosis(DiagnosisEvent {
                    cause: name(serde_json::to_value(first.cause)),
                    confidence: name(serde_json::to_value(first.confidence)),
                    place: first.place.text.clone(),
                    sentence: first.sentence.clone(),
                    remedies: first.remedies.iter().map(|remedy| remedy.text.clone()).collect(),
                })
            }),
        }
    }

    /// The record of a run that ended, and the exit code that the program gives for it.
    pub fn end(summary: &Summary, out: &std::path::Path, exit_code: u8) -> Self {
        Self::End(EndEvent {
            outcome: summary.outcome.kind().to_owned(),
            steps: summary.steps,
            time: summary.time,
            out: out.display().to_string(),
            verdict: summary.verdict.level.to_string(),
            reasons: sentences(&summary.verdict),
            wall_seconds: summary.wall_seconds,
            exit_code,
        })
    }

    /// The record of a run that failed, and the exit code that the program gives for it.
    pub fn error(error: &RunError, exit_code: u8) -> Self {
        let problems = match error {
            RunError::Scene(errors) => errors.problems().iter().map(problem_event).collect(),
            _ => Vec::new(),
        };
        let last = match error {
            RunError::Simulation { last_step, last_time, verdict, .. } => Some((*last_step, *last_time, verdict)),
            _ => None,
        };
        Self::Error(ErrorEvent {
            message: error.to_string(),
            outcome: last.map(|_| "failed".to_owned()),
            problems,
            last_step: last.map(|(step, ..)| step),
            last_time: last.map(|(_, time, _)| time),
            verdict: last.map(|(.., verdict)| verdict.level.to_string()),
            reasons: last.map(|(.., verdict)| sentences(verdict)).unwrap_or_default(),
            exit_code,
        })
    }

    /// One line of JSON, without a line feed. Numbers that are not finite are `null`.
    pub fn to_line(&self) -> String {
        // Strings, numbers and lists with string keys: printing cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Why a verdict is not sound, the worst first.
fn sentences(verdict: &Verdict) -> Vec<String> {
    verdict.reasons.iter().map(|found| found.sentence.clone()).collect()
}

fn step_event(record: &StepRecord, end: f64, extent: f64, watched: &Watched) -> StepEvent {
    StepEvent {
        step: record.step,
        stage: record.stage,
        time: record.time,
        dt: record.dt,
        end,
        iterations: record.iterations,
        kinetic: record.balance.kinetic / extent,
        strain: record.balance.strain / extent,
        total: record.balance.total() / extent,
        contact: record.contact.as_ref().map(|contact| ContactEvent {
            active: contact.active,
            closed: contact.closed,
            released: contact.released,
            min_gap: contact.min_gap.is_finite().then_some(contact.min_gap),
            max_pressure: contact.max_pressure,
        }),
        drift: watched.drift.map(|(_, drift)| drift).filter(|drift| drift.is_finite()),
        drift_of: watched.drift.map(|(name, _)| name.to_owned()),
        depth: watched.depth,
        relative_depth: watched.relative_depth,
        decisions: record
            .decisions
            .iter()
            .map(|decision| DecisionEvent {
                kind: format!("{:?}", decision.kind).to_lowercase(),
                time: decision.time,
                reason: decision.reason.clone(),
            })
            .collect(),
    }
}

fn problem_event(problem: &Problem) -> ProblemEvent {
    ProblemEvent {
        file: problem.file.clone(),
        line: problem.line,
        column: problem.column,
        key: problem.key.clone(),
        value: problem.value.clone(),
        message: problem.message.clone(),
        remedy: problem.remedy.clone(),
    }
}

/// JSON schema (draft 2020-12) of [`EventRecord`]; ends with a line feed.
#[cfg(feature = "schema")]
pub fn json_schema() -> String {
    // A schema is a JSON value with string keys: printing cannot fail.
    let mut text = serde_json::to_string_pretty(&schemars::schema_for!(EventRecord)).unwrap_or_default();
    text.push('\n');
    text
}
