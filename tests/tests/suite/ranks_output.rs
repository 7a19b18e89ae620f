//! Folders of runs on several ranks, which are threads here: the first rank writes what one rank alone writes, the others write nothing, and an error of one is an error of all, with none that waits.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use stoss::linalg::Threads;
use stoss::mesh_io::read_vtu;
use stoss::output::{Outcome, OutputError, Summary};
use stoss::ranks::Ranks;
use stoss::run::{RunError, RunOptions, run_scene};

/// A bar that is bent and yields: the states of its elements are on all ranks, in frames, probes and the checkpoint.
const BAR: &str = r#"
[scene]
title = "Bar"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [4, 1, 1], divisions = [6, 2, 2] }
material = { law = "hencky", young = 1000.0, poisson = 0.3, plasticity = { yield_stress = 5.0, hardening_modulus = 50.0 } }
[[prescribe]]
set = "bar.left"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "bar.right"
components = ["y"]
displacement = { table = [[0, 0], [1, -0.4]] }
[[probe]]
name = "end"
set = "bar.right"
quantity = "reaction"
[[probe]]
name = "flow"
body = "bar"
quantity = "equivalent_plastic_strain"
point = [0.2, 0.1, 0.1]
[output]
every = 2
checkpoint_every = 2
fields = ["displacement", "cauchy_stress", "equivalent_plastic_strain"]
"#;

struct Place {
    folder: tempfile::TempDir,
    scene: PathBuf,
}

impl Place {
    fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, text).unwrap();
        Self { folder, scene }
    }

    /// Folder of a rank: of runs that write as they should only that of the first exists.
    fn out(&self, name: &str, rank: usize) -> PathBuf {
        self.folder.path().join(format!("{name}.{rank}"))
    }

    /// Runs on so many ranks, with what `change` does to the options of each.
    fn run(
        &self,
        name: &str,
        count: usize,
        change: impl Fn(usize, &mut RunOptions) + Sync,
    ) -> Vec<Result<Summary, RunError>> {
        Threads::run(count, |communicator| {
            let rank = communicator.rank();
            let ranks = if count == 1 { Ranks::default() } else { Ranks::gathered(communicator) };
            let mut options = RunOptions { out: self.out(name, rank), ranks, ..RunOptions::default() };
            change(rank, &mut options);
            run_scene(&self.scene, &options, &mut |_| {})
        })
    }
}

/// Names of all files, folders first.
fn files(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            names.extend(files(&entry.path()).into_iter().map(|inner| format!("{name}/{inner}")));
        } else {
            names.push(name);
        }
    }
    names.sort();
    names
}

/// Columns of a table without its names, as numbers; what is none is NaN.
fn columns(file: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(file).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    (0..rows[0].len()).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
}

/// Checks that numbers are the same but for round-off, measured against the largest of all of a list.
fn assert_close(what: &str, a: &[f64], b: &[f64], scale: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    let off = a.iter().zip(b).filter(|(a, b)| !(a.is_nan() && b.is_nan())).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f64::max);
    assert!(off <= 1e-9 * scale, "{what}: {off:e} of {scale:e}");
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

fn assert_same_results(a: &Path, b: &Path) {
    assert_eq!(files(a), files(b));
    for name in ["probes.csv", "balance.csv"] {
        let [a, b] = [a, b].map(|folder| columns(&folder.join(name)));
        // Reactions across the bar are round-off beside those along it, energies beside each other.
        let scale = a.iter().map(|column| largest(column)).fold(0.0, f64::max);
        a.iter().zip(&b).enumerate().for_each(|(k, (a, b))| assert_close(&format!("{name} {k}"), a, b, scale));
    }
    for name in files(a).iter().filter(|name| name.ends_with(".vtu")) {
        let [a, b] = [a, b].map(|folder| read_vtu(folder.join(name)).unwrap());
        for ((field, of_a), (of, of_b)) in a.point_data.iter().zip(&b.point_data) {
            assert_eq!(field, of);
            assert_close(&format!("{name} {field}"), &of_a.values, &of_b.values, largest(&of_a.values));
        }
    }
}

#[test]
fn the_first_rank_writes_what_one_rank_writes_and_the_others_nothing() {
    let place = Place::new(BAR);
    let [alone] = place.run("one", 1, |_, _| {}).try_into().expect("one rank");
    let alone = alone.unwrap();
    assert!(matches!(alone.outcome, Outcome::Completed));
    // In two parts, on other numbers of ranks.
    let until_half = place.run("three", 3, |_, options| options.until = Some(0.5));
    assert!(until_half.iter().all(|summary| matches!(summary.as_ref().unwrap().outcome, Outcome::Stopped { .. })));
    std::fs::rename(place.out("three", 0), place.out("two", 0)).unwrap();
    let rest = place.run("two", 2, |_, options| options.resume = true);
    for summary in &rest {
        let summary = summary.as_ref().unwrap();
        assert!(matches!(summary.outcome, Outcome::Completed));
        assert_eq!((summary.verdict.level, summary.steps), (alone.verdict.level, alone.steps));
    }
    assert_same_results(&place.out("one", 0), &place.out("two", 0));
    for (name, rank) in [("three", 1), ("three", 2), ("two", 1)] {
        assert!(!place.out(name, rank).exists(), "{name} {rank}");
    }
}

#[test]
fn a_signal_to_one_rank_ends_all_after_the_same_step() {
    let place = Place::new(BAR);
    let ended = place.run("signal", 3, |rank, options| options.stop = Arc::new(AtomicBool::new(rank == 2)));
    for summary in ended {
        assert!(matches!(summary.unwrap().outcome, Outcome::Interrupted { last_step: 0, .. }));
    }
}

#[test]
fn what_one_rank_cannot_read_or_write_is_an_error_of_all() {
    let place = Place::new(BAR);
    let told = |results: Vec<Result<Summary, RunError>>, who: usize, part: &str| {
        for (rank, result) in results.into_iter().enumerate() {
            let error = result.expect_err("the run fails");
            let is_of_other = matches!(error, RunError::OtherRank(_) | RunError::Output(OutputError::OtherRank(_)));
            let text = error.to_string();
            assert!(text.contains(part) && is_of_other == (rank != who), "rank {rank}: {text}");
            assert!(!is_of_other || text.starts_with(&format!("rank {who}: ")), "{text}");
        }
    };
    // A file where the folder should be; a file where frames go; no checkpoint; a damaged one.
    std::fs::write(place.out("file", 0), "").unwrap();
    told(place.run("file", 3, |_, _| {}), 0, "file.0");
    std::fs::create_dir(place.out("frames", 0)).unwrap();
    std::fs::write(place.out("frames", 0).join("frames"), "").unwrap();
    told(place.run("frames", 3, |_, _| {}), 0, "frames");
    told(place.run("nothing", 2, |_, options| options.resume = true), 0, "no checkpoint");
    // The last rank is on a machine without the scene.
    let missing = Threads::run(3, |communicator| {
        let scene = place.folder.path().join(if communicator.rank() == 2 { "away.toml" } else { "scene.toml" });
        let out = place.out("away", communicator.rank());
        run_scene(
            &scene,
            &RunOptions { out, ranks: Ranks::gathered(communicator), ..RunOptions::default() },
            &mut |_| {},
        )
    });
    told(missing, 2, "away.toml");
    assert!(!place.out("away", 0).exists());
    // And this one has another.
    std::fs::write(place.folder.path().join("other.toml"), BAR.replace("-0.4", "-0.3")).unwrap();
    let different = Threads::run(2, |communicator| {
        let scene = place.folder.path().join(if communicator.rank() == 1 { "other.toml" } else { "scene.toml" });
        let out = place.out("other", communicator.rank());
        run_scene(
            &scene,
            &RunOptions { out, ranks: Ranks::gathered(communicator), ..RunOptions::default() },
            &mut |_| {},
        )
    });
    assert!(different.iter().all(|result| matches!(result, Err(RunError::Option(text)) if text.contains("different"))));
    assert!(!place.out("other", 0).exists());
}

#[test]
fn an_error_in_the_scene_is_the_same_on_all_ranks() {
    let place = Place::new(&BAR.replace("bar.right", "bar.wrong"));
    let results = place.run("wrong", 3, |_, _| {});
    assert!(results.iter().all(|result| matches!(result, Err(RunError::Scene(_)))));
    assert!(!place.out("wrong", 0).exists());
    let place = Place::new(BAR);
    let results = place.run("systems", 2, |_, options| options.systems = 1);
    assert!(results.iter().all(|result| matches!(result, Err(RunError::Option(text)) if text.contains("--systems"))));
}
