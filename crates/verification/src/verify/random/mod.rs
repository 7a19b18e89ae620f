//! Whole runs of scenes from a generator, judged by their balance and by the watch.
//!
//! `cargo xtask verify random --seed S --count N` runs the seeds `S` to `S + N - 1`, and those of [`SEEDS`], which failed once. A run fails if the
//! program refuses the scene, panics, hangs or is killed, if a table cannot be read, or if a promise of the scheme is broken. That a run stops with a
//! named error, or that the watch finds it wrong, is counted in the table by scheme and method. A failing scene is shrunk and kept as a file.

mod scene;
mod shrink;

use std::collections::BTreeMap;

use super::check::{Bound, Check, number};
use super::launch::{Launched, launch};
use super::report::{Grid, Section};
use super::{Bench, Findings, Suite};
use crate::verify::numbers::larger;
use crate::workspace::{Outcome, write};
use scene::Case;

/// Random whole runs.
pub struct Random;

/// Seeds that failed once, a line each; what follows the number says why.
const SEEDS: &str = include_str!("seeds.txt");

/// Where scenes and results go, below the folder of `verify`.
const FOLDER: &str = "random";

/// Bound of what a scheme keeps, over the scale of the run: some hundred tolerances of Newton's method.
const KEPT: f64 = 1e-8;

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

/// What became of a run.
#[derive(Clone, Debug, PartialEq)]
enum Fate {
    /// It ended, with this verdict of the watch and this depth in edge lengths.
    Judged { verdict: String, depth: f64 },
    /// It stopped with a named error at this part of its time.
    Stopped { verdict: String, depth: f64 },
    /// What must not be.
    Failed(String),
}

/// A row of the table.
#[derive(Clone, Debug, Default)]
struct Count {
    runs: usize,
    stopped: usize,
    doubtful: usize,
    wrong: usize,
    deepest: f64,
}

impl Suite for Random {
    fn name(&self) -> &'static str {
        "random"
    }

    fn about(&self) -> &'static str {
        "Whole runs of random scenes: no panic, no hang, promises of the scheme kept, penetration found."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let Range { seed, count } = bench.random;
        let mut seeds = kept(SEEDS)?;
        seeds.extend(seed..seed + count);
        let mut counts: BTreeMap<(String, String), Count> = BTreeMap::new();
        let (mut failures, mut stops, mut missed) = (Vec::new(), Vec::new(), Vec::new());
        for &seed in &seeds {
            let case = Case::new(seed);
            let name = format!("seed-{seed}");
            let fate = run(bench, &name, &case)?;
            let row = counts.entry((case.scheme.clone(), case.method.clone())).or_default();
            row.runs += 1;
            let (verdict, depth) = match &fate {
                Fate::Failed(reason) => {
                    let file = shrink::shrink(bench, &case, reason)?;
                    failures.push(format!("seed {seed}: {reason}; shrunk: {}", file.display()));
                    continue;
                }
                Fate::Stopped { verdict, depth } => {
                    row.stopped += 1;
                    stops.push(seed.to_string());
                    (verdict, *depth)
                }
                Fate::Judged { verdict, depth } => (verdict, *depth),
            };
            row.deepest = larger(row.deepest, depth);
            row.doubtful += usize::from(verdict == "doubtful");
            row.wrong += usize::from(verdict == "wrong");
            if depth > 0.3 && verdict != "wrong" {
                missed.push(seed.to_string());
            }
        }
        let row = |quantity: &str, list: &[String], bound: Bound| {
            Check::new("random", quantity, list.len() as f64, bound).noted(list.join("; "))
        };
        let mut findings = Findings::default();
        findings.checks.push(row("failed runs", &failures, Bound::AtMost(0.0)));
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

fn run(bench: &Bench, name: &str, case: &Case) -> Outcome<Fate> {
    let launched = launch(bench, FOLDER, name, &toml::to_string(&case.scene)?, &[])?;
    let fate = fate(case, &launched);
    if matches!(fate, Ok(Fate::Judged { .. } | Fate::Stopped { .. })) {
        // A thousand folders are not of use to anyone.
        std::fs::remove_dir_all(&launched.run.folder)?;
    }
    Ok(fate.unwrap_or_else(|error| Fate::Failed(error.to_string())))
}

fn fate(case: &Case, launched: &Launched) -> Outcome<Fate> {
    let failed = |reason: &str| {
        let last = launched.log.lines().last().unwrap_or_default();
        Ok(Fate::Failed(format!("{reason}: {last}")))
    };
    let stopped = match launched.run.ending.code {
        _ if launched.hung => return failed("hangs"),
        Some(0 | 4) => false,
        Some(3) => true,
        Some(2) => return failed("the scene is refused"),
        Some(code) => return failed(&format!("exit code {code}")),
        None => return failed("killed by a signal"),
    };
    if let Some(broken) = broken(case, launched)? {
        return Ok(Fate::Failed(broken));
    }
    let verdict = launched.run.verdict()?;
    let depth = launched.run.table("watch.csv")?.column("relative_depth")?.iter().copied().fold(0.0, larger);
    Ok(if stopped { Fate::Stopped { verdict, depth } } else { Fate::Judged { verdict, depth } })
}

/// The promise of the scheme that a run breaks: momenta, and of the energy-momentum scheme that energy never rises.
fn broken(case: &Case, launched: &Launched) -> Outcome<Option<String>> {
    let Ok(scheme) = stoss_integrators::scheme(&case.scheme) else { return Ok(None) };
    let claims = scheme.claims();
    let balance = launched.run.balance()?;
    // Coordinate augmentation is the midpoint rule for the contact (guide, [[contact]]).
    let energy = claims.energy && case.method != "cat";
    let rise = balance.energy_changes(None).into_iter().fold(0.0, larger);
    let rows = [
        ("linear momentum", claims.linear_momentum, balance.linear_drift(momentum(case))),
        ("angular momentum", claims.angular_momentum, balance.angular_drift(momentum(case))),
        ("gain of energy in a step", energy, rise),
    ];
    let found = rows.into_iter().find(|(_, promised, drift)| *promised && !Bound::AtMost(KEPT).holds(*drift));
    Ok(found.map(|(name, _, drift)| format!("{name}: {}", number(drift))))
}

/// Scale of momenta: bodies that fly towards each other may have none together. Sizes are about one.
fn momentum(case: &Case) -> Option<f64> {
    let bodies = case.scene.get("body")?.as_array()?;
    let size = |body: &toml::Value| -> Option<f64> {
        let speed = body.get("velocity")?.as_array()?.iter().filter_map(toml::Value::as_float);
        Some(body.get("density")?.as_float()? * speed.map(|v| v * v).sum::<f64>().sqrt())
    };
    Some(bodies.iter().filter_map(size).sum())
}

fn section(counts: &BTreeMap<(String, String), Count>) -> Section {
    let head = ["scheme", "method", "runs", "stopped", "doubtful", "wrong", "deepest (edges)"];
    let rows = counts.iter().map(|((scheme, method), count)| {
        let numbers = [count.runs, count.stopped, count.doubtful, count.wrong].map(|n| n.to_string());
        [vec![scheme.clone(), method.clone()], numbers.to_vec(), vec![number(count.deepest)]].concat()
    });
    let table = Grid {
        caption: "Runs by scheme and contact method".into(),
        head: head.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    };
    for row in &table.rows {
        println!("verify: random: {}", row.join("  "));
    }
    Section { title: "Random scenes".into(), reading: "Random bodies, meshes, laws, speeds and methods, judged by the watch, which shares no code with the contact search. Runs that stop or are doubtful or wrong are counted, and each can be run again by its seed.".into(), figures: Vec::new(), tables: vec![table] }
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
}
