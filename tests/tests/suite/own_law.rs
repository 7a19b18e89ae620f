//! The example of a law of one's own in whole runs: conservation, checkpoints, messages. Its closed form is checked in the example.

#[path = "../../../crates/stoss/examples/own_law.rs"]
mod example;

#[path = "../../../crates/stoss/examples/own_history.rs"]
mod with_state;

use example::{STRETCHED, ciarlet, laws};
use std::path::Path;
use stoss::build::{OwnLaws, build_with};
use stoss::run::{RunError, RunOptions, check_scene_with, run_scene};
use stoss::scene::{SceneErrors, parse_with};

/// A cube that flies, turns and vibrates.
const FLYING: &str = r#"
[scene]
title = "flying"
kind = "dynamic"

[time]
end = 0.3
step = 0.02
integrator = { scheme = "energy-momentum" }

[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "ciarlet", lambda = 1300.0, mu = 865.0 }
density = 10.0
angular_velocity = [1.0, 2.0, 3.0]
velocity_gradient = [[0, 0, 0], [0, 0, 0], [0, 0, 4]]

[output]
every = 100
"#;

#[test]
fn a_run_with_an_own_law_conserves_and_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flying.toml");
    std::fs::write(&path, FLYING).unwrap();
    assert!(check_scene_with(&path, &laws()).unwrap().to_string().contains("ciarlet"));
    let options =
        RunOptions { out: folder.path().join("out"), until: Some(0.1), laws: laws(), ..RunOptions::default() };
    run_scene(&path, &options, &mut |_| {}).unwrap();
    let options = RunOptions { resume: true, until: None, ..options };
    let summary = run_scene(&path, &options, &mut |_| {}).unwrap();
    assert_eq!(summary.steps, 15);
    assert!(summary.drift["energy"].relative.unwrap() < 1e-12, "{:?}", summary.drift);
    assert!(summary.drift["angular_momentum"].relative.unwrap() < 1e-12, "{:?}", summary.drift);
    // A program without the law.
    let options = RunOptions { laws: OwnLaws::default(), ..options };
    match run_scene(&path, &options, &mut |_| {}) {
        Err(RunError::Scene(problems)) => assert_eq!(problems.problems()[0].key, "body[0].material.law"),
        other => panic!("{other:?}"),
    }
}

/// The problems of a scene whose material was changed.
fn problems(to: &str) -> SceneErrors {
    let text = STRETCHED.replace("{ law = \"ciarlet\", lambda = 1300.0, mu = 865.0 }", to);
    assert_ne!(text, STRETCHED);
    match parse_with(&text, "test.toml", &laws().names()) {
        Err(problems) => problems,
        Ok(scene) => build_with(&scene, Path::new("."), &laws()).map(|_| ()).unwrap_err(),
    }
}

#[test]
fn wrong_parameters_are_told_at_their_place() {
    for (material, key, message, remedy) in [
        ("{ law = \"ciarlet\", mu = 865.0 }", "body[0].material.lambda", "is missing", "lambda = 1.0"),
        ("{ law = \"ciarlet\", lambda = 1.0, mu = [1.0] }", "body[0].material.mu", "must be a number", "not a list"),
        ("{ law = \"ciarlet\", lambda = 1.0, mu = true }", "body[0].material.mu", "must be a number", "1.0"),
        ("{ law = \"ciarlet\", lambda = 1.0, mu = -1.0 }", "body[0].material.mu", "must be positive", "enlarge mu"),
        ("{ law = \"ciarlet\", lambda = 1, mu = 1, lamda = 2 }", "body[0].material.lamda", "unknown key", "`lambda`"),
        ("{ law = \"ciarlet\", lambda = 1, mu = 1, softening = 2 }", "body[0].material", "softening is not", "other"),
        ("{ law = \"ciarlte\", lambda = 1, mu = 1 }", "body[0].material.law", "is unknown", "did you mean `ciarlet`"),
    ] {
        let problems = problems(material);
        let problem = &problems.problems()[0];
        assert_eq!((problem.key.as_str(), problem.line), (key, 13), "{problem}");
        assert!(problem.message.contains(message) && problem.remedy.contains(remedy), "{problem}");
    }
}

#[test]
fn names_of_the_catalogue_are_taken() {
    for name in ["neo-hooke", "ciarlet", "two words", ""] {
        let error = laws().with(name, ciarlet).unwrap_err();
        assert_eq!(error.name, name);
    }
}

/// A law with a state from outside of the crates: energy and loss are constant, the books have the loss, and a run that resumes has the states.
#[test]
fn a_run_with_an_own_state_loses_what_it_says_and_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flying.toml");
    std::fs::write(&path, with_state::FLYING).unwrap();
    let checked = check_scene_with(&path, &with_state::laws()).unwrap().to_string();
    assert!(checked.contains("softer that softens"), "{checked}");
    let at_once = RunOptions { out: folder.path().join("at-once"), laws: with_state::laws(), ..RunOptions::default() };
    let summary = run_scene(&path, &at_once, &mut |_| {}).unwrap();
    assert!(summary.drift["energy"].relative.unwrap() < 1e-12, "{:?}", summary.drift);
    let halted = RunOptions { out: folder.path().join("halted"), until: Some(0.14), ..at_once };
    run_scene(&path, &halted, &mut |_| {}).unwrap();
    let resumed = RunOptions { resume: true, until: None, ..halted };
    run_scene(&path, &resumed, &mut |_| {}).unwrap();
    for table in ["balance.csv", "terms.csv"] {
        let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join(table)).unwrap();
        assert!(read("at-once") == read("halted"), "{table}");
        let text = read("halted");
        let heads: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let place = heads.iter().position(|head| head.ends_with("softening_loss")).unwrap();
        assert!(
            !heads.iter().any(|head| head.ends_with("plastic_loss") || head.ends_with("viscous_loss")),
            "{heads:?}"
        );
        let lost = |row: &str| -> f64 { row.split(',').nth(place).unwrap().parse().unwrap() };
        assert!(text.lines().skip(1).map(lost).fold(0.0, f64::max) > 0.0, "{table}");
    }
}
