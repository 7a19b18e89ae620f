//! The page that a run leaves, `stoss report` and `stoss picture`.

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A block flies.
const SCENE: &str = r#"[scene]
title = "flight"
kind = "dynamic"

[time]
end = 0.02
step = 0.01
integrator = { scheme = "energy-momentum" }

[[body]]
name = "block"
mesh = { generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }
material = { law = "neo-hooke", lambda = 1300.0, mu = 865.0 }
density = 10.0
velocity = [0.0, 0.0, -1.0]
"#;

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stoss"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).output().expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_run_leaves_a_page_unless_it_is_told_not_to() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let page = folder.path().join("out/report.html");
    let run = ["run", "scene.toml", "--out", "out"];
    let output = stoss(folder.path(), &run);
    assert!(output.status.success() && stderr(&output).contains("out/report.html"), "{}", stderr(&output));
    assert!(std::fs::read_to_string(&page).unwrap().contains("<title>flight</title>"));
    // A new run removes the page of the one before, which would be about other results.
    let output = stoss(folder.path(), &[&run[..], &["--no-report", "--quiet"]].concat());
    assert!(output.status.success() && stderr(&output).is_empty(), "{}", stderr(&output));
    assert!(!page.exists());
    let output = stoss(folder.path(), &["report", "out", "out"]);
    assert!(output.status.success() && page.exists());
    let text = std::fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("class=\"run\">").count(), 2);
    let description = std::fs::read_to_string(folder.path().join("out/run.json")).unwrap();
    let description: serde_json::Value = serde_json::from_str(&description).unwrap();
    assert_eq!((&description["bodies"][0], &description["scene"]), (&"block".into(), &SCENE.into()));
}

#[test]
fn folders_and_files_that_are_not_right_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let output = stoss(folder.path(), &["report", "nowhere"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("nowhere"), "{}", stderr(&output));
    assert_eq!(stoss(folder.path(), &["report"]).status.code(), Some(2));
    assert!(stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report"]).status.success());
    std::fs::write(folder.path().join("out/balance.csv"), "step,time\n1\n").unwrap();
    let output = stoss(folder.path(), &["report", "out"]);
    assert!(output.status.success() && stderr(&output).contains("balance.csv"), "{}", stderr(&output));
}

#[test]
fn a_picture_is_drawn_and_options_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    assert!(stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report", "--quiet"]).status.success());
    let picture = |arguments: &[&str]| {
        let output = stoss(folder.path(), &[&["picture", "out"], arguments].concat());
        (output.status.code(), stderr(&output))
    };
    let asked =
        ["a.svg", "--time", "0.011", "--view", "-1,-2,1", "--body", "block", "--range", "-1,1", "--field", "velocity"];
    assert_eq!(picture(&asked), (Some(0), String::new()));
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(svg.contains(">flight: block<") && svg.contains(">velocity<") && svg.contains(">-1.00<"));
    for (arguments, told) in [
        (vec!["a.png"], "a.png"),
        (vec!["b.svg", "--body", "rope"], "block"),
        (vec!["b.svg", "--field", "colour"], "velocity"),
        (vec!["b.svg", "--frame", "70"], "--frame 70"),
        (vec!["b.svg", "--view", "1,2"], "--view"),
        (vec!["b.svg", "--frame", "0", "--time", "0"], "--time"),
    ] {
        let (code, text) = picture(&arguments);
        assert!(code == Some(2) && text.contains(told), "{text}");
    }
    assert!(!folder.path().join("b.svg").exists());
    let (code, text) = picture(&["nowhere/b.svg"]);
    assert!(code == Some(1) && text.contains("nowhere/b.svg"), "{text}");
}
