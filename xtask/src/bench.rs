//! `cargo xtask bench OTHER`: time and memory of this program over those of another one, run by run, in turn.
//!
//! Ratios of runs that follow each other stand on a busy machine, where seconds do not. CPU seconds, iterations and memory are those that a run writes into `summary.json`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::Value;

use crate::program::Program;
use crate::workspace::{Outcome, Workspace, read};

/// What is measured, and against what.
#[derive(Debug)]
pub struct Bench {
    /// A commit, whose program is built in the release profile, or the path of a program.
    pub other: String,
    /// Pairs of runs of each work.
    pub pairs: u32,
    /// Threads of each run.
    pub threads: u32,
    /// Works of [`WORKS`], or files of scenes, which run to their ends; none: all works.
    pub works: Vec<String>,
}

/// A run that is measured.
struct Work {
    name: &'static str,
    /// Scene below `scenes/`, without its extension.
    scene: &'static str,
    /// `NAME=VALUE` of a parameter.
    set: Option<&'static str>,
    /// Time at which it stops; the scene's end if there is none.
    until: Option<f64>,
}

const fn work(name: &'static str, scene: &'static str, set: Option<&'static str>, until: Option<f64>) -> Work {
    Work { name, scene, set, until }
}

/// What is measured if nothing is named, small ones first.
const WORKS: [Work; 16] = [
    work("ball-plate", "ball-plate", None, None),
    work("general-contact", "general-contact", None, None),
    work("general-chain", "general-chain", None, None),
    work("trebuchet", "trebuchet", None, None),
    work("stack", "stack", None, None),
    work("slide", "slide", None, None),
    work("block-impact-mortar", "block-impact-mortar", None, None),
    work("ironing", "ironing-mortar-friction", None, Some(3.0)),
    work("tori", "tori-friction-03", None, Some(0.3)),
    work("flight-ogden", "flight-ogden", None, None),
    work("cube-20", "large/cube", Some("n=20"), None),
    work("cube-30", "large/cube", Some("n=30"), None),
    work("cube-40", "large/cube", Some("n=40"), None),
    work("sandwich", "large/sandwich", None, None),
    work("ironing-half", "large/ironing", None, Some(0.3)),
    work("cube-60", "large/cube", Some("n=60"), None),
];

/// Parts of a run in the table, with their keys in `summary.json`.
const PHASES: [(&str, &[&str]); 3] =
    [("contact", &["contact", "search"]), ("assembly", &["assembly"]), ("linear", &["factorisation", "solve"])];

/// How linear systems are solved: with their own factors, with those of an iterate nearby, by iteration.
const SOLUTIONS: [&str; 3] = ["solves", "nearby_solves", "iterative_solves"];

/// A finished run.
#[derive(Clone, Debug)]
struct Run {
    cpu: f64,
    phases: [f64; PHASES.len()],
    peak: f64,
    solutions: f64,
}

/// Runs every work with both programs in turn, the order changed in every other pair, and prints a table. False if a run of this program ends with an error.
pub fn command(workspace: &Workspace, bench: &Bench) -> Outcome<bool> {
    let known = |name: &String| WORKS.iter().any(|work| work.name == name) || Path::new(name).is_file();
    if let Some(name) = bench.works.iter().find(|name| !known(name)) {
        let names: Vec<&str> = WORKS.iter().map(|work| work.name).collect();
        return Err(format!("{name} is neither a scene's file nor one of {}", names.join(", ")).into());
    }
    let folder = workspace.target()?.join("bench");
    fs::create_dir_all(&folder)?;
    let other = other_program(workspace, &folder, &bench.other)?;
    let ours = Program::build(workspace)?;
    let programs = [other.as_path(), ours.executable()];
    let phases: Vec<&str> = PHASES.iter().map(|(name, _)| *name).collect();
    println!("CPU seconds of {} and of this program, {} pairs, {} threads", bench.other, bench.pairs, bench.threads);
    println!("| work | other | this | ratio (least to most) | {} | solutions | peak MB |", phases.join(" | "));
    println!("|---|---|---|---|{}---|---|", "---|".repeat(PHASES.len()));
    let mut sound = true;
    let own = WORKS.iter().filter(|work| bench.works.is_empty() || bench.works.iter().any(|name| name == work.name));
    let shipped = own.map(|work| {
        let scene = workspace.path("scenes").join(work.scene).with_extension("toml");
        (work.name.to_owned(), scene, work.set, work.until)
    });
    let files = bench.works.iter().filter_map(|name| std::path::absolute(name).ok()).filter(|path| path.is_file());
    let files =
        files.map(|path| (path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), path, None, None));
    for (name, scene, set, until) in shipped.chain(files) {
        let mut runs: [Vec<Run>; 2] = [Vec::new(), Vec::new()];
        let mut failed = [false; 2];
        for pair in 0..bench.pairs {
            for turn in 0..2 {
                let side = (pair as usize + turn) % 2;
                match run(workspace, programs[side], &scene, &folder.join("run"), set, until, bench.threads)? {
                    Some(run) => runs[side].push(run),
                    None => failed[side] = true,
                }
            }
        }
        sound &= !failed[1];
        println!("{}", row(&name, &runs, failed));
    }
    Ok(sound)
}

/// The program of a commit, or the one at a path.
fn other_program(workspace: &Workspace, folder: &Path, other: &str) -> Outcome<PathBuf> {
    if Path::new(other).is_file() {
        return Ok(std::path::absolute(other)?);
    }
    let git = |arguments: &[&str]| -> Outcome<String> {
        let output = workspace.process(Path::new("git")).args(arguments).output()?;
        if !output.status.success() {
            return Err(format!(
                "{other} is neither a program nor a commit: {}",
                String::from_utf8_lossy(&output.stderr).trim()
            )
            .into());
        }
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "--verify", "--short=12", &format!("{other}^{{commit}}")])?;
    let program = folder.join(format!("stoss-{commit}{}", std::env::consts::EXE_SUFFIX));
    if program.is_file() {
        return Ok(program);
    }
    let (tree, target) = (folder.join("tree"), folder.join("target"));
    let place = tree.display().to_string();
    if tree.exists() {
        git(&["worktree", "remove", "--force", &place])?;
    }
    git(&["worktree", "add", "--detach", &place, &commit])?;
    let built = workspace
        .cargo()
        .args(["build", "--release", "--locked", "--quiet", "-p", "stoss-cli", "--manifest-path"])
        .arg(tree.join("Cargo.toml"))
        .env("CARGO_TARGET_DIR", &target)
        .status()?;
    if !built.success() {
        return Err(format!("the program `stoss` of {commit} does not build").into());
    }
    fs::copy(target.join("release").join(format!("stoss{}", std::env::consts::EXE_SUFFIX)), &program)?;
    git(&["worktree", "remove", "--force", &place])?;
    Ok(program)
}

/// `None` if the run ends before its end, with an error for instance.
fn run(
    workspace: &Workspace,
    program: &Path,
    scene: &Path,
    out: &Path,
    set: Option<&str>,
    until: Option<f64>,
    threads: u32,
) -> Outcome<Option<Run>> {
    if out.exists() {
        fs::remove_dir_all(out)?;
    }
    let mut command = workspace.process(program);
    command.arg("run").arg(scene).args(["--quiet", "--no-report", "--out"]).arg(out);
    command.arg("--threads").arg(threads.to_string());
    if let Some(set) = set {
        command.arg("--set").arg(set);
    }
    if let Some(until) = until {
        command.arg("--until").arg(until.to_string());
    }
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status()?;
    let summary = out.join("summary.json");
    if !summary.is_file() {
        return Ok(None);
    }
    let summary: Value = serde_json::from_str(&read(&summary)?)?;
    let ended = matches!(summary["outcome"]["kind"].as_str(), Some("completed" | "stopped"));
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let cpu = |key: &str| number(&summary["seconds"][key]["cpu"]);
    Ok(ended.then(|| Run {
        cpu: number(&summary["cpu_seconds"]),
        phases: PHASES.map(|(_, keys)| keys.iter().map(|key| cpu(key)).sum()),
        peak: number(&summary["memory"]["peak_resident_bytes"]) / 1e6,
        solutions: SOLUTIONS.iter().map(|kind| number(&summary["linear_solver_counts"][kind])).sum(),
    }))
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    match (values.len() / 2, values.len() % 2) {
        (_, 0) if values.is_empty() => f64::NAN,
        (half, 0) => 0.5 * (values[half - 1] + values[half]),
        (half, _) => values[half],
    }
}

/// A line of the table: medians, and the ratio of each pair.
fn row(name: &str, [other, this]: &[Vec<Run>; 2], [other_failed, failed]: [bool; 2]) -> String {
    if failed || other_failed || this.is_empty() {
        let said = |failed: bool| if failed { "fails" } else { "runs" };
        return format!("| {name} | {} | {} | |{} | |", said(other_failed), said(failed), " |".repeat(PHASES.len()));
    }
    let ratios: Vec<f64> = other.iter().zip(this).map(|(other, this)| this.cpu / other.cpu).collect();
    let (least, most) = ratios.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &r| (a.min(r), b.max(r)));
    let seconds = [other, this].map(|runs| median(runs.iter().map(|run| run.cpu)));
    let phases: Vec<String> = (0..PHASES.len())
        .map(|k| {
            let [a, b] = [other, this].map(|runs| median(runs.iter().map(|run| run.phases[k])));
            if a > 0.01 * seconds[0] { format!("{:.2}", b / a) } else { String::new() }
        })
        .collect();
    format!(
        "| {name} | {:.2} | {:.2} | {:.2} ({least:.2} to {most:.2}) | {} | {} -> {} | {:.0} -> {:.0} |",
        seconds[0],
        seconds[1],
        median(ratios.into_iter()),
        phases.join(" | "),
        other[0].solutions,
        this[0].solutions,
        median(other.iter().map(|run| run.peak)),
        median(this.iter().map(|run| run.peak)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(cpu: f64) -> Run {
        Run { cpu, phases: [0.5 * cpu, 0.25 * cpu, 0.0], peak: 10.0 * cpu, solutions: 3.0 }
    }

    #[test]
    fn a_row_has_the_ratio_of_each_pair() {
        let runs = [vec![at(1.0), at(2.0), at(4.0)], vec![at(0.5), at(1.8), at(2.0)]];
        assert_eq!(
            row("x", &runs, [false; 2]),
            "| x | 2.00 | 1.80 | 0.50 (0.50 to 0.90) | 0.90 | 0.90 |  | 3 -> 3 | 20 -> 18 |"
        );
        assert_eq!(row("x", &[vec![at(1.0)], vec![]], [false, true]), "| x | runs | fails | | | | | | |");
    }

    #[test]
    fn the_scenes_of_all_works_are_there() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
        for work in WORKS {
            assert!(scenes.join(work.scene).with_extension("toml").is_file(), "{}", work.name);
        }
    }
}
