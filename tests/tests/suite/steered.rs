//! Runs step by step, and loads and prescribed motions that are set between steps: the same as tables, promised nothing, and resumed with the same bits.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use stoss::output::Outcome;
use stoss::run::{RunError, RunOptions, Session, run_scene};
use stoss::watch::Severity;

/// A block that is pushed by a force (in test 1), or led at its bottom (in test 2).
const SCENE: &str = r#"
[scene]
title = "steered"
kind = "dynamic"

[time]
end = 0.4
step = 0.02
integrator = { scheme = "energy-momentum" }

[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 10.0
"#;

const PUSH: &str = "[[load]]\nname = \"push\"\nset = \"block.top\"\ntraction = TABLE\n";
const LED: &str =
    "[[prescribe]]\nname = \"shaker\"\nset = \"block.bottom\"\ncomponents = [\"z\", \"x\"]\nfixed = true\n";

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn options(folder: &Path, out: &str, steered: &str) -> RunOptions {
    RunOptions { out: folder.join(out), steered: vec![steered.to_owned()], ..RunOptions::default() }
}

#[test]
fn a_load_that_is_set_once_is_that_of_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let table = PUSH.replace("TABLE", "{ table = [[0.0, 0, 0, 0], [0.1, 3.0, 0, 40.0]] }");
    let table = write(folder.path(), "table.toml", &format!("{SCENE}{table}"));
    let out = folder.path().join("table");
    run_scene(&table, &RunOptions { out: out.clone(), ..RunOptions::default() }, &mut |_| {}).unwrap();
    let zero = write(folder.path(), "zero.toml", &format!("{SCENE}{}", PUSH.replace("TABLE", "[0, 0, 0]")));
    let mut session = Session::start(&zero, &options(folder.path(), "set", "push"), &mut |_| {}).unwrap();
    session.lead("push", &[3.0, 0.0, 40.0], Some(0.1)).unwrap();
    let mut steps = 0;
    while let Some(record) = session.advance(&mut |_| {}).unwrap() {
        steps += 1;
        assert_eq!(record.step, steps);
    }
    assert_eq!(session.steered_values("push").unwrap(), [3.0, 0.0, 40.0]);
    let summary = session.finish(&mut |_| {}).unwrap();
    assert_eq!((summary.outcome, steps), (Outcome::Completed, 20));
    // The load does work; nobody had promised that the energy stays.
    assert_eq!(summary.verdict.level, Severity::Sound, "{}", summary.verdict);
    let read = |out: &Path| std::fs::read_to_string(out.join("balance.csv")).unwrap();
    assert_eq!(read(&out), read(&folder.path().join("set")));
}

/// Leads the bottom after every step by a rule that looks at the state.
fn advance(session: &mut Session) -> bool {
    let went_on = session.advance(&mut |_| {}).unwrap().is_some();
    if went_on {
        let state = session.simulation().state();
        let top = state.q.chunks_exact(3).map(|q| q[2]).fold(f64::MIN, f64::max);
        let lift = 0.05 * (8.0 * state.time).sin() - 0.2 * (top - 1.0);
        session.lead("shaker", &[lift, 0.1 * state.time], None).unwrap();
    }
    went_on
}

#[test]
fn a_run_with_a_controller_resumes_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "led.toml", &format!("{SCENE}{LED}"));
    let whole = options(folder.path(), "whole", "shaker");
    let mut session = Session::start(&path, &whole, &mut |_| {}).unwrap();
    while advance(&mut session) {}
    assert_eq!(session.finish(&mut |_| {}).unwrap().outcome, Outcome::Completed);

    let stop = Arc::new(AtomicBool::new(false));
    let first = RunOptions { stop: Arc::clone(&stop), ..options(folder.path(), "parts", "shaker") };
    let mut part = Session::start(&path, &first, &mut |_| {}).unwrap();
    for _ in 0..7 {
        assert!(advance(&mut part));
    }
    stop.store(true, Ordering::Relaxed);
    assert!(!advance(&mut part));
    let summary = part.finish(&mut |_| {}).unwrap();
    assert!(matches!(summary.outcome, Outcome::Interrupted { last_step: 7, .. }), "{:?}", summary.outcome);
    // Without the name of what was set it is another run.
    let without = RunOptions { steered: Vec::new(), resume: true, ..options(folder.path(), "parts", "shaker") };
    let error = Session::start(&path, &without, &mut |_| {}).unwrap_err().to_string();
    assert!(error.contains("were steered when the checkpoint was written"), "{error}");

    let second = RunOptions { resume: true, ..options(folder.path(), "parts", "shaker") };
    let mut part = Session::start(&path, &second, &mut |_| {}).unwrap();
    while advance(&mut part) {}
    assert_eq!(part.finish(&mut |_| {}).unwrap().steps, 20);
    assert_eq!(session.simulation().state(), part.simulation().state());
    let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join("balance.csv")).unwrap();
    assert_eq!(read("whole"), read("parts"));
}

#[test]
fn what_cannot_be_set_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "led.toml", &format!("{SCENE}{LED}"));
    let refused = |result: Result<(), RunError>| match result {
        Err(RunError::Option(text)) => text,
        other => panic!("{other:?}"),
    };
    let start = |path: &Path, name: &str| Session::start(path, &options(folder.path(), "out", name), &mut |_| {});
    let error = refused(start(&path, "push").map(drop));
    assert!(error.contains("push") && error.contains("known are: shaker"), "{error}");
    let twice = LED.replace("name = \"shaker\"\n", "").replace("bottom", "left");
    let twice = write(folder.path(), "twice.toml", &format!("{SCENE}{LED}{twice}"));
    let error = refused(start(&twice, "shaker").map(drop));
    assert!(error.contains("another prescribed motion"), "{error}");

    let mut session = start(&path, "shaker").unwrap();
    for (name, values, until, expected) in [
        ("push", &[0.0, 0.0][..], None, "steered are: shaker"),
        ("shaker", &[0.0][..], None, "1 values were given, and it has 2"),
        ("shaker", &[0.0, f64::NAN][..], None, "not finite"),
        ("shaker", &[0.0, 0.0][..], Some(0.0), "not after t = 0"),
    ] {
        let error = refused(session.lead(name, values, until));
        assert!(error.contains(expected), "{error}");
    }
}
