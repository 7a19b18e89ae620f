//! What became of a cell of a map.

use super::case::{Case, Deviation, Seen};
use crate::verify::launch::Launched;
use crate::verify::numbers::larger;
use crate::verify::run::WRONG;
use crate::workspace::Outcome;

/// Exit code of a run that gave up.
const GAVE_UP: i32 = 3;

/// Exit code of a scene that is refused.
const REFUSED: i32 = 2;

/// Largest relative difference between probes of one scene in two systems of units.
const SAME: f64 = 1e-8;

/// One word for a cell, from best to worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Word {
    /// The closed forms hold.
    Right,
    /// They hold, and steps were repeated with smaller ones.
    Cuts,
    /// The verdict is doubtful, whether they hold or not.
    Doubtful,
    /// The run ended with an error that names the cause, or with the verdict wrong.
    Named,
    /// The verdict is sound and a closed form does not hold; also a run that does not end, or ends in another way.
    Silent,
}

/// Words, in the order of [`Word`].
pub const WORDS: [&str; 5] = ["right", "right, steps cut", "doubtful", "named error", "silent"];

impl Word {
    /// As it is written.
    pub fn text(self) -> &'static str {
        WORDS[self as usize]
    }
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Map, axis and value.
    pub key: [String; 3],
    /// Place on the axis.
    pub column: usize,
    /// What became of it.
    pub word: Word,
    /// Exit code; nothing after a signal or the time limit.
    pub exit: Option<i32>,
    /// Verdict of the watch.
    pub verdict: String,
    /// Kinds of its findings.
    pub findings: String,
    /// Steps, cuts, mean iterations a step.
    pub steps: u64,
    /// Steps that were repeated with a smaller size.
    pub cuts: u64,
    /// Linear solutions a step, in the mean.
    pub iterations: f64,
    /// Largest change of the energy, over the start; nothing in statics.
    pub energy: Option<f64>,
    /// The closed form that is farthest off beside its bound, by how much, and the bound.
    pub worst: Option<Deviation>,
    /// The error that the run named.
    pub error: String,
}

/// A record with the last values of the probes.
pub struct Found {
    /// The record.
    pub record: Record,
    /// Last values of the probes, over the units of the scene.
    pub probes: Vec<f64>,
}

/// Reads what a run has left.
pub fn read(case: &Case, launched: &Launched) -> Outcome<Found> {
    let run = &launched.run;
    let exit = run.ending.code;
    let key = [case.map.to_owned(), case.axis.clone(), case.value.clone()];
    let mut record = Record {
        key,
        column: case.column,
        word: Word::Silent,
        exit,
        verdict: String::new(),
        findings: String::new(),
        steps: 0,
        cuts: 0,
        iterations: 0.0,
        energy: None,
        worst: None,
        error: String::new(),
    };
    if matches!(exit, Some(GAVE_UP | REFUSED)) {
        record.error = cause(&launched.log);
        record.word = if record.error.is_empty() { Word::Silent } else { Word::Named };
    }
    if !matches!(exit, Some(0 | WRONG | GAVE_UP)) {
        return Ok(Found { record, probes: Vec::new() });
    }
    let summary = run.summary()?;
    let whole = |key: &str| summary[key].as_u64().unwrap_or_default();
    record.verdict = run.verdict()?;
    let mut kinds: Vec<&str> = summary["verdict"]["reasons"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|reason| reason["kind"].as_str())
        .collect();
    kinds.dedup();
    record.findings = kinds.join(" ");
    record.steps = whole("steps");
    record.cuts = whole("cuts");
    record.iterations = summary["mean_iterations"].as_f64().unwrap_or_default();
    if exit == Some(GAVE_UP) {
        return Ok(Found { record, probes: Vec::new() });
    }
    let seen = Seen { probes: run.table("probes.csv")?, balance: run.table("balance.csv")? };
    if summary["scheme"] != "quasi-static" && !case.problem.text.text().contains("[[stage]]") {
        let [gain, loss] = seen.energy()?;
        record.energy = Some(larger(gain.abs(), loss.abs()));
    }
    record.worst = worst((case.problem.oracle)(&seen)?);
    record.word = word(&record);
    Ok(Found { probes: probes(case, &seen)?, record })
}

/// The deviation that uses most of its bound.
fn worst(deviations: Vec<Deviation>) -> Option<Deviation> {
    deviations.into_iter().max_by(|a, b| a.used().total_cmp(&b.used()))
}

/// Word of a run that went to the end.
fn word(record: &Record) -> Word {
    let holds = record.worst.as_ref().is_none_or(|worst| worst.used() <= 1.0);
    match (record.exit, record.verdict.as_str()) {
        (Some(WRONG), _) => Word::Named,
        (_, "sound") if !holds => Word::Silent,
        (_, "sound") if record.cuts > 0 => Word::Cuts,
        (_, "sound") => Word::Right,
        _ => Word::Doubtful,
    }
}

/// Last values of the probes over their units.
fn probes(case: &Case, seen: &Seen) -> Outcome<Vec<f64>> {
    let Some(units) = case.units else { return Ok(Vec::new()) };
    let mut values = Vec::new();
    for (name, quantity) in &case.problem.text.probes {
        for axis in ["x", "y", "z"] {
            values.push(seen.last(&format!("{name}.{axis}"))? / units.of_quantity(quantity));
        }
    }
    Ok(values)
}

/// Holds a scene in other units against the first one of its row.
pub fn compare(found: &mut Found, base: &[f64]) {
    if found.probes.is_empty() || found.probes.len() != base.len() {
        return;
    }
    let vectors = found.probes.chunks(3).zip(base.chunks(3));
    let differs = |(a, b): (&[f64], &[f64])| {
        let size = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, larger) / size.max(f64::MIN_POSITIVE)
    };
    let same = Deviation::zero("that in other units", vectors.map(differs).fold(0.0, larger), SAME);
    found.record.worst = worst(found.record.worst.take().into_iter().chain([same]).collect());
    found.record.word = word(&found.record);
}

/// The error that the program names, in its first sentence, without the numbers of steps, nodes and places.
fn cause(log: &str) -> String {
    let Some((_, rest)) = log.split_once("error: ") else { return String::new() };
    let line = rest.lines().next().unwrap_or_default();
    let known = [
        ("the system is singular", "the system is singular"),
        ("turned inside out", "elements are turned inside out"),
        ("is inverted", "an element is inverted"),
        ("overlap at the start", "bodies overlap at the start"),
        ("active set", "the active set does not settle"),
        ("Newton: stagnated", "Newton: stagnated"),
        ("Newton: too many iterations", "Newton: too many iterations"),
    ];
    let found = known.iter().find(|(sign, _)| line.contains(sign)).map(|(_, words)| (*words).to_owned());
    found.unwrap_or_else(|| line.rsplit(": ").next().unwrap_or_default().replace([',', '|'], ";"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(exit: i32, verdict: &str, cuts: u64, size: f64) -> Record {
        Record {
            key: ["nts", "gap", "0"].map(str::to_owned),
            column: 0,
            word: Word::Right,
            exit: Some(exit),
            verdict: verdict.into(),
            findings: String::new(),
            steps: 3,
            cuts,
            iterations: 2.0,
            energy: None,
            worst: Some(Deviation { of: "force", size, bound: 0.1 }),
            error: String::new(),
        }
    }

    #[test]
    fn a_closed_form_that_does_not_hold_is_silent_only_under_a_sound_verdict() {
        let of = |exit, verdict, cuts, size| word(&record(exit, verdict, cuts, size));
        assert_eq!(of(0, "sound", 0, 0.05), Word::Right);
        assert_eq!(of(0, "sound", 2, 0.05), Word::Cuts);
        assert_eq!(of(0, "sound", 2, 0.2), Word::Silent);
        assert_eq!(of(0, "sound", 0, f64::NAN), Word::Silent);
        assert_eq!(of(0, "doubtful", 0, 0.2), Word::Doubtful);
        assert_eq!(of(4, "wrong", 0, 0.2), Word::Named);
    }

    #[test]
    fn other_units_have_to_give_the_same() {
        let mut found = Found { record: record(0, "sound", 0, 0.0), probes: vec![1.0, 0.0, 2.0] };
        compare(&mut found, &[1.0, 0.0, 2.0 + 1e-9]);
        assert_eq!(found.record.word, Word::Right);
        compare(&mut found, &[1.0, 1e-7, 2.0]);
        assert_eq!((found.record.word, found.record.worst.unwrap().of), (Word::Silent, "that in other units"));
    }

    #[test]
    fn causes_are_short() {
        let log =
            "error: step 1 from time 0 failed at the step size 1.000e0: the system is singular: a motion, largest in z";
        assert_eq!(cause(log), "the system is singular");
        assert_eq!(
            cause("error: a.toml:3:1: general_contact: `a` and `b` overlap at the start, 5e-4 deep"),
            "bodies overlap at the start"
        );
        assert_eq!(cause("all is well"), "");
    }
}
