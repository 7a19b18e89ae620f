//! Why a run stopped, or why its result is wrong: where, what, the likely cause, and what to try.
//!
//! The solver leaves facts ([`stoss_solver::FailedAttempt`]), the watch a verdict. Each function in `CAUSES` looks at these, the scene and the model for
//! the signs of one cause and gives a [`LikelyCause`] or none; the most certain one comes first. What they know of the case is in [`DiagnosedRun`].
//!
//! # What it is not
//! No cure: nothing is tried again, and nothing of a run depends on it.
//!
//! # How to add a cause
//! A variant of [`Cause`] with its title, a function in the module of its sense, a line in `CAUSES`, a scene in `tests/failing`.

mod case;
mod changes;
mod contact;
mod convergence;
mod density;
mod elements;
mod energy;
mod followed;
mod members;
mod motion;
mod redundant;
mod rim;
mod sudden;
mod supports;
mod surfaces;
mod text;
mod toml;
mod too_large;

pub use case::DiagnosedRun;

use crate::error::OutputError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file in a folder of results.
pub const FILE: &str = "diagnosis.json";

/// Name of the page that shows it to people; the program `stoss` writes it.
pub const PAGE: &str = "diagnosis.html";

/// What looks for the signs of a cause.
type Look = fn(&DiagnosedRun<'_>) -> Vec<LikelyCause>;

/// Functions that look for the signs of a cause.
const CAUSES: [Look; 19] = [
    supports::supports,
    density::density,
    too_large::step,
    too_large::load,
    surfaces::overlap,
    surfaces::facing_away,
    surfaces::missing_contact,
    elements::sliver,
    elements::incompressible,
    elements::single_rows,
    redundant::redundant,
    sudden::at_once,
    convergence::exact_stick,
    convergence::tolerance,
    convergence::slowly,
    contact::locked_by_friction,
    rim::at_rim,
    contact::cycles,
    energy::scheme_gains,
];

/// A cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Cause {
    /// A body may slide, in statics.
    NoSupport,
    /// A body may turn, and not slide, in statics.
    FreeRotation,
    /// Bodies overlap at the start.
    OverlapAtStart,
    /// A contact names surfaces that are turned away from each other.
    SurfacesFaceAway,
    /// Bodies penetrate each other and no contact is named.
    MissingContact,
    /// The density does not fit the modulus.
    Density,
    /// The scheme adds energy to the bodies.
    SchemeGainsEnergy,
    /// An element of the mesh is nearly degenerate.
    Sliver,
    /// Friction locks a wedge.
    FrictionLocks,
    /// The step is too large for the motion in it.
    StepTooLarge,
    /// Nearly incompressible.
    Incompressible,
    /// The stress of a load is of the order of Young's modulus.
    LoadTooLarge,
    /// A load that is applied in full at the start, in statics.
    LoadAtOnce,
    /// Hexahedra with reduced integration in a single row.
    ZeroEnergyModes,
    /// A contact or support that is redundant.
    RedundantConstraints,
    /// Exact stick for which no state of stick and slip is found.
    ExactStick,
    /// Nodes of a slave come and go at the rim of their master.
    OpenRim,
    /// Contact points that open and close, or stick and slide, with every iteration.
    ContactCycles,
    /// The residual is small and does not fall to the tolerance.
    ToleranceNotReached,
    /// The residual falls slowly, and iterations end first.
    SlowConvergence,
    /// No cause that is known.
    Unknown,
}

impl Cause {
    /// Whether it is something that happens in the step that failed, not something unusual in the scene that was there before.
    fn is_of_the_step(self) -> bool {
        match self {
            Self::NoSupport
            | Self::FreeRotation
            | Self::StepTooLarge
            | Self::LoadTooLarge
            | Self::LoadAtOnce
            | Self::RedundantConstraints
            | Self::FrictionLocks
            | Self::ExactStick
            | Self::OpenRim
            | Self::ContactCycles
            | Self::ToleranceNotReached
            | Self::SlowConvergence => true,
            Self::OverlapAtStart
            | Self::SurfacesFaceAway
            | Self::MissingContact
            | Self::Density
            | Self::SchemeGainsEnergy
            | Self::Sliver
            | Self::Incompressible
            | Self::ZeroEnergyModes
            | Self::Unknown => false,
        }
    }
}

/// Certainty of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Confidence {
    /// Cannot be excluded.
    Low,
    /// The signs fit.
    Medium,
    /// The signs fit, and what happened is what the cause does.
    High,
}

/// Where in the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Where {
    /// The place in words.
    pub text: String,
    /// Name of a body or of another part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Number of a node in its body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<u32>,
    /// Number of an element in its body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub element: Option<usize>,
    /// Name of a contact, tie or joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair: Option<String>,
    /// Position at the end of the last completed step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
}

/// A change of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Change {
    /// A key gets another value.
    Set {
        /// Path of the key, for instance `contact[0].friction.mu`.
        key: String,
        /// The value as TOML.
        value: String,
    },
    /// Something is added at the end of the scene.
    Add {
        /// Text of the addition as TOML.
        toml: String,
    },
}

/// Something to try.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remedy {
    /// The remedy in words.
    pub text: String,
    /// Changes of the scene; empty if the remedy is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<Change>,
}

impl Remedy {
    fn words(text: impl Into<String>) -> Self {
        Self { text: text.into(), changes: Vec::new() }
    }

    /// Sets one key; `why` follows the key and its value.
    fn set(key: impl Into<String>, value: impl Into<String>, why: &str) -> Self {
        let (key, value) = (key.into(), value.into());
        let why = if why.is_empty() { String::new() } else { format!(" ({why})") };
        Self { text: format!("set `{key} = {value}`{why}"), changes: vec![Change::Set { key, value }] }
    }
}

/// A cause and why it is thought to be the one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LikelyCause {
    /// The cause.
    pub cause: Cause,
    /// Certainty of the finding.
    pub confidence: Confidence,
    /// Place in the scene.
    pub place: Where,
    /// The cause in words of the scene.
    pub sentence: String,
    /// Signs of it, with numbers.
    pub evidence: Vec<String>,
    /// What to try, the most promising first.
    pub remedies: Vec<Remedy>,
}

/// A failed attempt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attempt {
    /// Step size.
    pub dt: f64,
    /// What the solver said.
    pub reason: String,
    /// Relative residuals from iteration to iteration.
    pub residuals: Vec<f64>,
    /// Points of contact that opened and closed, and how often, those that did so most first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changing: Vec<(String, u32)>,
}

/// What is known of a run that stopped or whose result is wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// Title of the scene.
    pub title: String,
    /// What happened: the error, or the worst that the watch found.
    pub what: String,
    /// Last completed step.
    pub step: u64,
    /// Time of the last completed step.
    pub time: f64,
    /// Place where it happened.
    pub place: Where,
    /// What is new in the step that failed: a stage, a load, a contact that closes, friction that begins, a release.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    /// Likely causes, the most certain first, of those as certain as each other first what belongs to the step that failed; at least one if the run stopped with an error.
    pub findings: Vec<LikelyCause>,
    /// The last failed attempts.
    pub attempts: Vec<Attempt>,
}

impl Diagnosis {
    /// The diagnosis of a case. Without an error and with a sound verdict there may be no finding at all.
    pub fn of(case: &DiagnosedRun<'_>) -> Self {
        let mut findings: Vec<LikelyCause> = CAUSES.iter().flat_map(|look| look(case)).collect();
        findings.iter_mut().for_each(|finding| followed::keep(case, &mut finding.remedies));
        let of_step = |finding: &LikelyCause| finding.cause.is_of_the_step();
        findings.sort_by(|a, b| {
            let by_step = || of_step(b).cmp(&of_step(a));
            b.confidence.cmp(&a.confidence).then_with(by_step).then(a.cause.cmp(&b.cause))
        });
        let (what, changes) = (case.what(), changes::changes(case));
        // What a run that ended well enough was found to do is reported by its verdict.
        if findings.is_empty() && case.is_stopped() {
            findings.push(unknown(case));
        }
        let place = match case.place() {
            place if place.text.is_empty() => findings.first().map(|first| first.place.clone()).unwrap_or_default(),
            place => place,
        };
        let (step, time) = (case.simulation.step(), case.simulation.state().time);
        Self {
            title: case.scene.header.title.clone(),
            what,
            step,
            time,
            place,
            changes,
            findings,
            attempts: case.attempts(),
        }
    }

    /// Whether somebody should read it: a cause was found of what happened, or nothing is known of what stopped the run, or a cause is certain, or a density is likely
    /// wrong, although nothing happened: with such a density nothing does.
    pub fn is_worth_reading(&self) -> bool {
        let is_told = |finding: &LikelyCause| match finding.cause {
            Cause::Density => finding.confidence >= Confidence::Medium,
            _ => finding.confidence == Confidence::High,
        };
        if self.what.is_empty() { self.findings.iter().any(is_told) } else { !self.findings.is_empty() }
    }

    /// Writes it into a folder of results.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join(FILE);
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| OutputError::Damaged { path: path.clone(), reason: e.to_string() })?;
        std::fs::write(&path, text + "\n").map_err(OutputError::io(&path))
    }

    /// Reads that of a folder of results; nothing if there is none, as after a run that ended well.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn read(folder: &Path) -> Result<Option<Self>, OutputError> {
        let path = folder.join(FILE);
        if !path.is_file() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(&path).map_err(OutputError::io(&path))?;
        let unreadable = |e: serde_json::Error| OutputError::Unreadable { path, reason: e.to_string() };
        serde_json::from_str(&text).map(Some).map_err(unreadable)
    }

    /// Removes that of the part of a run that was done before it was resumed.
    pub(crate) fn remove(folder: &Path) -> Result<(), OutputError> {
        if !folder.join(FILE).is_file() {
            return Ok(());
        }
        for path in [folder.join(FILE), folder.join(PAGE)].into_iter().filter(|path| path.is_file()) {
            std::fs::remove_file(&path).map_err(OutputError::io(&path))?;
        }
        Ok(())
    }
}

/// What is said of a run that stopped if no cause was found.
fn unknown(case: &DiagnosedRun<'_>) -> LikelyCause {
    // No step size changes a matrix that is singular at its start.
    let at_any_size = case.failure().is_some_and(|failure| failure.at_any_size);
    let mut remedies: Vec<Remedy> = case.smaller_step().filter(|_| !at_any_size).into_iter().collect();
    let time = &case.scene.time;
    if case.failure().is_some()
        && !at_any_size
        && !case.is_automatic()
        && time.max_cuts < crate::scene::Time::DEFAULT_MAX_CUTS
    {
        let cuts = crate::scene::Time::DEFAULT_MAX_CUTS.to_string();
        remedies.push(Remedy::set("time.max_cuts", cuts, "the default: a failing step may be halved ten times"));
    }
    let smallest = case.smallest_failed();
    let evidence = smallest
        .filter(|_| remedies.is_empty() && !at_any_size)
        .map(|dt| format!("smaller steps, down to {}, failed too", toml::plain(dt)));
    if !remedies.is_empty() {
        remedies
            .push(Remedy::words("look at the last frames near this place, in `report.html` or with `stoss picture`"));
    } else {
        remedies.push(Remedy::words(
            "look at the last frames near this place, in `report.html` or with `stoss picture`: do the bodies move as they should up to there?",
        ));
        if smallest.is_some() {
            let at = toml::plain(case.simulation.state().time);
            let changes = changes::changes(case);
            remedies.push(Remedy::words(match changes.is_empty() {
                true => format!("check what changes at t = {at}: loads, prescribed motions, contacts"),
                false => format!("look at what is new in the step from t = {at}: {}", changes.join("; ")),
            }));
            remedies.push(Remedy::words(
                "look at the residuals of the last attempts in `diagnosis.html`: if they grow from the first iteration on, check materials and elements; if they stagnate, contact and friction",
            ));
        }
    }
    LikelyCause {
        cause: Cause::Unknown,
        confidence: Confidence::Low,
        place: case.place(),
        sentence: "none of the known causes fits this run".to_owned(),
        evidence: std::iter::once(case.what()).chain(evidence).collect(),
        remedies,
    }
}
