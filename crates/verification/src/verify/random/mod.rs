//! Whole runs of scenes from a generator, judged by what is known of them, beside the verdict of the watch.
//!
//! `cargo xtask verify random --seed S --count N` runs the seeds `S` to `S + N - 1`, and those of [`SEEDS`], which failed once. A run fails if the
//! program refuses the scene, panics, hangs or is killed, if a table cannot be read, or if a promise of the scheme is broken. Of all others the [`judge`], which
//! shares no code with the watch, says whether they are right; its answers are counted against the verdicts. A run that is wrong and called sound, or right and called
//! wrong, is shrunk and kept as a file, as one that failed is.

mod families;
mod judge;
mod known;
mod scene;
mod shrink;

use std::collections::BTreeMap;

use super::check::{Bound, Check, number};
use super::launch::{Launched, launch};
use super::report::{Grid, ReportSection};
use super::{Bench, Findings, Suite};
use crate::verify::numbers::larger;
use crate::workspace::{Outcome, write};
use judge::{Answer, Judgement};
use scene::Case;

/// Random whole runs.
pub struct Random;

/// Seeds that failed once, a line each; what follows the number says why.
const SEEDS: &str = include_str!("seeds.txt");

/// Where scenes and results go, below the folder of `verify`.
const FOLDER: &str = "random";

/// Largest number of scenes of each kind of fault that are shrunk; the others are kept as they are.
const SHRUNK: usize = 5;

/// Which scenes are run.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// The first seed.
    pub seed: u64,
    /// How many seeds in a row.
    pub count: u64,
}

impl Default for Range {
    fn default() -> Self {
        Self { seed: 1, count: 30 }
    }
}

/// What must not be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    /// The program refuses the scene, panics, hangs, or breaks a promise of the scheme.
    Failed,
    /// Wrong by the judge, and sound by the watch.
    Missed,
    /// Right by the judge, and wrong by the watch.
    FalseAlarm,
}

/// What became of a run.
#[derive(Clone, Debug)]
enum Shot {
    /// A run that ended, or stopped with a named error, with this verdict of the watch, in the words of its first reason.
    Judged { is_stopped: bool, verdict: String, words: String, judgement: Judgement },
    /// A run that failed.
    Failed(String),
}

/// A row of the table: runs by the answer of the judge and the verdict of the watch.
#[derive(Clone, Debug, Default)]
struct Count {
    runs: usize,
    stopped: usize,
    /// Right, unknown, wrong; sound, doubtful, wrong.
    ended: [[usize; 3]; 3],
    deepest: f64,
}

/// The verdicts in the order of [`Count::ended`].
const VERDICTS: [&str; 3] = ["sound", "doubtful", "wrong"];

impl Shot {
    fn fault(&self) -> Option<Fault> {
        match self {
            Self::Failed(_) => Some(Fault::Failed),
            Self::Judged { is_stopped: true, .. } => None,
            Self::Judged { verdict, judgement, .. } => match (judgement.answer(), verdict.as_str()) {
                (Answer::Wrong, "sound") => Some(Fault::Missed),
                (Answer::Right, "wrong") => Some(Fault::FalseAlarm),
                _ => None,
            },
        }
    }

    /// What is wrong, or why the watch says so.
    fn reason(&self) -> String {
        match self {
            Self::Failed(reason) => reason.clone(),
            Self::Judged { verdict, words, judgement, .. } => match judgement.answer() {
                Answer::Right => format!("{verdict}: {words}"),
                _ => judgement.text(),
            },
        }
    }
}

impl Suite for Random {
    fn name(&self) -> &'static str {
        "random"
    }

    fn about(&self) -> &'static str {
        "Whole runs of random scenes: no panic, no hang, promises of the scheme kept, nothing wrong called sound and nothing right called wrong."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let Range { seed, count } = bench.random;
        let mut seeds = kept(SEEDS)?;
        seeds.extend(seed..seed + count);
        let mut counts: BTreeMap<String, Count> = BTreeMap::new();
        let mut faults: BTreeMap<Fault, Vec<String>> = BTreeMap::new();
        let (mut stops, mut doubts, mut missed) = (Vec::new(), Vec::new(), Vec::new());
        for &seed in &seeds {
            let case = Case::new(seed)?;
            let shot = run(bench, &format!("seed-{seed}"), &case)?;
            let line = format!("seed {seed} ({} {} {})", case.family, case.scheme, case.method);
            if let Some(fault) = shot.fault() {
                let list = faults.entry(fault).or_default();
                let file = if list.len() < SHRUNK {
                    shrink::shrink(bench, &case, fault, &shot.reason())?
                } else {
                    keep(bench, &case, &shot.reason())?
                };
                list.push(format!("{line}: {}; {}", shot.reason(), file.display()));
                println!("verify: random: {fault:?}: {line}: {}", shot.reason());
            }
            let row = counts.entry(case.family.clone()).or_default();
            row.runs += 1;
            let Shot::Judged { is_stopped, verdict, words, judgement } = &shot else { continue };
            row.deepest = larger(row.deepest, judgement.depth);
            if judgement.depth > 0.3 && verdict != "wrong" {
                missed.push(seed.to_string());
            }
            if *is_stopped {
                row.stopped += 1;
                stops.push(seed.to_string());
                continue;
            }
            let column = VERDICTS.iter().position(|word| word == verdict).ok_or("an unknown verdict")?;
            row.ended[judgement.answer() as usize][column] += 1;
            if judgement.answer() == Answer::Right && verdict == "doubtful" {
                doubts.push(format!("{line}: {words}"));
                println!("verify: random: right and doubtful: {line}: {words}");
            }
        }
        let row = |quantity: &str, list: &[String], bound: Bound| {
            Check::new("random", quantity, list.len() as f64, bound).noted(list.join("; "))
        };
        let mut findings = Findings::default();
        for (fault, quantity) in [
            (Fault::Failed, "failed runs"),
            (Fault::Missed, "wrong and called sound"),
            (Fault::FalseAlarm, "right and called wrong"),
        ] {
            findings.checks.push(row(quantity, faults.get(&fault).map_or(&[], Vec::as_slice), Bound::AtMost(0.0)));
        }
        findings.checks.push(row("right and called doubtful", &doubts, Bound::Unbounded));
        findings.checks.push(row("deeper than 0.3 edges and not wrong", &missed, Bound::AtMost(0.0)));
        let part = stops.len() as f64 / seeds.len().max(1) as f64;
        findings.checks.push(Check::new("random", "part that stops", part, Bound::Unbounded).noted(stops.join(" ")));
        findings.sections.push(section(&counts));
        Ok(findings)
    }
}

/// Numbers at the beginnings of lines.
fn kept(text: &str) -> Outcome<Vec<u64>> {
    let lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let first = lines.map(|line| line.split_whitespace().next().unwrap_or_default().parse::<u64>());
    Ok(first.collect::<Result<_, _>>()?)
}

fn run(bench: &Bench, name: &str, case: &Case) -> Outcome<Shot> {
    let launched = launch(bench, FOLDER, name, &toml::to_string(&case.scene)?, &[])?;
    let shot = judged(case, &launched).unwrap_or_else(|error| Shot::Failed(error.to_string()));
    if matches!(shot, Shot::Judged { .. }) {
        // A thousand folders are not of use to anyone.
        std::fs::remove_dir_all(&launched.run.folder)?;
    }
    Ok(shot)
}

fn judged(case: &Case, launched: &Launched) -> Outcome<Shot> {
    let failed = |reason: &str| {
        let last = launched.log.lines().last().unwrap_or_default();
        Ok(Shot::Failed(format!("{reason}: {last}")))
    };
    let is_stopped = match launched.run.ending.code {
        _ if launched.hung => return failed("hangs"),
        Some(0 | 4) => false,
        Some(3) => true,
        Some(2) => return failed("the scene is refused"),
        Some(code) => return failed(&format!("exit code {code}")),
        None => return failed("killed by a signal"),
    };
    let judgement = judge::judge(case, &launched.run)?;
    if let Some(broken) = judgement.broken() {
        return Ok(Shot::Failed(broken.text()));
    }
    let (verdict, words) = (launched.run.verdict()?, launched.run.reasons());
    Ok(Shot::Judged { is_stopped, verdict, words, judgement })
}

fn section(counts: &BTreeMap<String, Count>) -> ReportSection {
    let mut head = vec!["family".to_owned(), "runs".into(), "stopped".into()];
    for answer in ["right", "unknown", "wrong"] {
        head.extend(VERDICTS.map(|verdict| format!("{answer}, {verdict}")));
    }
    head.push("deepest (edges)".into());
    let rows = counts.iter().map(|(family, count)| {
        let mut row = vec![family.clone(), count.runs.to_string(), count.stopped.to_string()];
        row.extend(count.ended.as_flattened().iter().map(usize::to_string));
        row.push(number(count.deepest));
        row
    });
    let table = Grid {
        caption: "Runs by family, answer of the judge and verdict of the watch".into(),
        rows: rows.collect(),
        head,
    };
    println!("verify: random: {}", table.head.join("  "));
    for row in &table.rows {
        println!("verify: random: {}", row.join("  "));
    }
    ReportSection { title: "Random scenes".into(), reading: "Random bodies, meshes, laws, speeds, joints, loads and methods. The judge knows what must come out of a scene, or measures it by brute force; the watch gives the verdict that a user sees. Nothing wrong may be sound, nothing right wrong. Each run can be run again by its seed.".into(), figures: Vec::new(), tables: vec![table] }
}

/// Writes a scene as a file that a user can run.
fn keep(bench: &Bench, case: &Case, reason: &str) -> Outcome<std::path::PathBuf> {
    let path = bench.folder.join(FOLDER).join(format!("shrunk-{}.toml", case.seed));
    write(&path, &format!("# Seed {}: {reason}\n{}", case.seed, toml::to_string(&case.scene)?))?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kept_seeds_are_the_first_words_of_lines() {
        assert_eq!(kept("# failed once\n\n12 panic\n7\n").unwrap(), [12, 7]);
        assert!(kept("twelve").is_err());
        assert!(kept(SEEDS).is_ok());
    }

    #[test]
    fn what_is_wrong_and_sound_or_right_and_wrong_is_a_fault() {
        let shot = |figure: f64, verdict: &str, is_stopped: bool| {
            let judgement = Judgement { criteria: vec![judge::Criterion::new("a", figure, [1.0, 2.0])], depth: 0.0 };
            Shot::Judged { is_stopped, verdict: verdict.into(), words: String::new(), judgement }.fault()
        };
        assert_eq!(shot(3.0, "sound", false), Some(Fault::Missed));
        assert_eq!(shot(0.0, "wrong", false), Some(Fault::FalseAlarm));
        let none = [(3.0, "doubtful", false), (1.5, "sound", false), (0.0, "sound", false), (3.0, "sound", true)];
        assert!(none.into_iter().all(|(figure, verdict, is_stopped)| shot(figure, verdict, is_stopped).is_none()));
    }
}
