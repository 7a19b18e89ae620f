//! The watch on whole runs of the program: verdict, exit code, what stays and can be resumed.

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A block falls into another one; there is no contact.
const SCENE: &str = r#"[scene]
title = "nothing named"
kind = "dynamic"

[time]
end = 0.4
step = 0.02
integrator = { scheme = "energy-momentum" }

[[body]]
name = "upper"
mesh = { generator = "block", min = [0.1, 0.1, 1.1], max = [0.9, 0.9, 1.9], divisions = [2, 2, 2] }
material = { law = "neo-hooke", lambda = 1300.0, mu = 865.0 }
density = 10.0
velocity = [0.0, 0.0, -1.0]

[[body]]
name = "lower"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "neo-hooke", lambda = 1300.0, mu = 865.0 }
density = 10.0

[general_contact]
enabled = false

[output]
checkpoint_every = 3
"#;

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stoss"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn folder_with(scene: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("the temporary folder is writable");
    folder
}

fn summary(out: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap()
}

/// A column of a table of numbers.
fn column(out: &Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(out.join("watch.csv")).unwrap();
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|head| head == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

#[test]
fn a_body_inside_another_is_found_although_no_contact_is_named() {
    let folder = folder_with(SCENE);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let text = stderr(&output);
    assert!(text.contains("wrong: ") && text.contains("`upper`") && text.contains("`lower`"), "{text}");
    let out = folder.path().join("out");
    let summary = summary(&out);
    assert_eq!(summary["verdict"]["level"], "wrong");
    assert_eq!(summary["outcome"]["kind"], "completed");
    // Nothing acts, so nothing deforms: the depth is the path less the gap of 0.1.
    for (time, depth) in column(&out, "time").into_iter().zip(column(&out, "depth")) {
        let expected = (time - 0.1).max(0.0);
        assert!((depth - expected).abs() < 1e-9, "t = {time}: {depth}, not {expected}");
    }
    let judged = stoss(folder.path(), &["judge", "out"]);
    assert_eq!(judged.status.code(), Some(4), "{}", stderr(&judged));
    assert!(String::from_utf8_lossy(&judged.stdout).contains("wrong: "));
}

#[test]
fn what_a_wrong_run_does_is_the_scenes_choice() {
    let ignore = folder_with(&format!("{SCENE}\n[watch]\non_fault = \"ignore\"\n"));
    let output = stoss(ignore.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), String::new()));
    assert_eq!(summary(&ignore.path().join("out"))["verdict"]["level"], "wrong");

    let stop = folder_with(&format!("{SCENE}\n[watch]\non_fault = \"stop\"\nlimit = 0.17\n"));
    let output = stoss(stop.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let stopped = summary(&stop.path().join("out"));
    assert_eq!(stopped["outcome"]["kind"], "stopped");
    // 0.17 of an edge of 0.4 is reached at t = 0.168.
    assert_eq!(stopped["steps"], 9);
}

#[test]
fn bodies_apart_are_sound_and_a_resumed_run_has_the_same_rows() {
    let apart = SCENE.replace("velocity = [0.0, 0.0, -1.0]", "velocity = [0.0, 0.0, 1.0]");
    let folder = folder_with(&format!("{apart}\n[watch]\nevery = 4\n"));
    for (out, more) in [("whole", &[][..]), ("broken", &["--until", "0.19"]), ("broken", &["--resume"])] {
        let output = stoss(folder.path(), &[&["run", "scene.toml", "--out", out, "--quiet"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let rows = |out: &str| std::fs::read_to_string(folder.path().join(out).join("watch.csv")).unwrap();
    assert_eq!(rows("whole"), rows("broken"));
    assert_eq!(column(&folder.path().join("whole"), "step"), [0.0, 4.0, 8.0, 12.0, 16.0, 20.0]);
    assert_eq!(summary(&folder.path().join("broken"))["verdict"]["level"], "sound");
    assert_eq!(stoss(folder.path(), &["judge", "whole"]).status.code(), Some(0));
}

#[test]
fn check_says_what_overlaps_at_the_start() {
    let folder = folder_with(&SCENE.replace("[0.1, 0.1, 1.1]", "[0.1, 0.1, 0.7]"));
    let output = stoss(folder.path(), &["check", "scene.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("inside `lower`"), "{text}");
    let sound = folder_with(SCENE);
    let text = String::from_utf8_lossy(&stoss(sound.path(), &["check", "scene.toml"]).stdout).into_owned();
    assert!(!text.contains("inside"), "{text}");
}

#[test]
fn a_folder_without_results_cannot_be_judged() {
    let folder = tempfile::tempdir().unwrap();
    let output = stoss(folder.path(), &["judge", "."]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("watch.json"), "{}", stderr(&output));
}

/// A block over a slab that is held at its bottom.
fn block_over_slab(kind: &str, time: &str, gap: f64, rest: &str) -> String {
    let (bottom, top) = (1.0 + gap, 2.0 + gap);
    let density = if kind == "dynamic" { "density = 1.0" } else { "" };
    format!(
        r#"
[scene]
title = "block over slab"
kind = "{kind}"
[time]
{time}
[[body]]
name = "slab"
mesh = {{ generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [4, 4, 2] }}
material = {{ law = "neo-hooke", young = 1.0, poisson = 0.3 }}
{density}
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0.5, 0.5, {bottom:?}], max = [1.5, 1.5, {top:?}], divisions = [3, 3, 3] }}
material = {{ law = "neo-hooke", young = 1.0, poisson = 0.3 }}
{density}
[[contact]]
method = "mortar"
slave = "block.bottom"
master = "slab.top"
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
{rest}
"#
    )
}

/// What passes through a body in one step is no result: the run stops, or its verdict is `wrong`.
#[test]
fn tunnelling_in_large_steps_is_no_result() {
    let falls = block_over_slab(
        "dynamic",
        "end = 5.0\nstep = 0.6\nintegrator = { scheme = \"backward-euler\" }",
        0.7,
        "[[load]]\nbody = \"block\"\nbody_force = [0, 0, -20.0]\n",
    );
    let pressed = block_over_slab(
        "quasi-static",
        "end = 1.0\nstep = 1.0",
        0.1,
        "[[prescribe]]\nset = \"block.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = { table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -3.0]] }\n",
    );
    for scene in [falls, pressed] {
        let folder = folder_with(&scene);
        let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
        let passed = output.status.code() == Some(4) && stderr(&output).contains("has passed through");
        assert!(passed || output.status.code() == Some(3), "{}", stderr(&output));
    }
}

/// Nodes of a stiff block that node-to-surface contact loses in a soft slab are found inside it.
#[test]
fn a_lost_indenter_is_wrong() {
    let scene = r#"
[scene]
title = "lost"
kind = "quasi-static"
[time]
end = 1.0
step = 0.05
[[body]]
name = "slab"
mesh = { generator = "block", min = [0, 0, 0], max = [4, 4, 1], divisions = [8, 8, 2] }
material = { law = "neo-hooke", young = 1.0, poisson = 0.3 }
[[body]]
name = "block"
mesh = { generator = "block", min = [1.5, 1.5, 1], max = [2.5, 2.5, 2], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[contact]]
method = "nts"
slave = "block.bottom"
master = "slab.top"
[[prescribe]]
set = "slab.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.top"
components = ["x", "y", "z"]
displacement = { table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -0.5]] }
"#;
    let folder = folder_with(scene);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert!(stderr(&output).starts_with("verdict: wrong:"), "{}", stderr(&output));
    // Judged again from what is stored.
    assert_eq!(stoss(folder.path(), &["judge", "out"]).status.code(), Some(4));
}
