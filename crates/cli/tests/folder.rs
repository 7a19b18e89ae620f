//! Result folders: one run at a time, resuming with a changed scene, prescriptions that overlap.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Output};

/// A block that is pushed against a wall of its own size; it never comes near to its limits.
const SCENE: &str = r#"[scene]
title = "block"
kind = "dynamic"

[time]
end = 0.2
step = 0.02
integrator = { scheme = "energy-momentum" }

[[body]]
name = "block"
mesh = { generator = "block", size = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "neo-hooke", young = 100.0, poisson = 0.3 }
density = 1.0
velocity = [0.0, 0.0, 0.5]

[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true

[[prescribe]]
set = "block.left"
components = ["x"]
fixed = true

[[probe]]
name = "top"
set = "block.top"
quantity = "displacement"

[output]
every = 2
checkpoint_every = 2
"#;

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stoss"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program was built")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn write_scene(folder: &Path, changes: &[(&str, &str)]) {
    let text = changes.iter().fold(SCENE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no `{from}`");
        text.replacen(from, to, 1)
    });
    std::fs::write(folder.join("scene.toml"), text).unwrap();
}

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn a_folder_in_use_is_refused_and_free_again_afterwards() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), &[]);
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let other_run = File::create(out.join("stoss.lock")).unwrap();
    other_run.lock().unwrap();
    for more in [&[][..], &["--resume"]] {
        let output = stoss(folder.path(), &[&["run", "scene.toml", "--out", "out"][..], more].concat());
        let expected = if more.is_empty() { "in use by another run" } else { "no checkpoint" };
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1, "nothing may be written");
    }
    drop(other_run);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let other_run = File::open(out.join("stoss.lock")).unwrap();
    other_run.lock().unwrap();
    let before = read(&out, "balance.csv");
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--resume"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("in use by another run"), "{}", stderr(&output));
    assert_eq!(read(&out, "balance.csv"), before);
}

#[test]
fn prescriptions_that_agree_may_overlap() {
    let folder = tempfile::tempdir().unwrap();
    let check = |changes: &[(&str, &str)]| {
        write_scene(folder.path(), changes);
        stoss(folder.path(), &["check", "scene.toml"])
    };
    let left = "set = \"block.left\"\ncomponents = [\"x\"]\nfixed = true";
    let same = "set = \"block.left\"\ncomponents = [\"x\"]\ndisplacement = { table = [[0.0, 0.0], [1.0, 0.0]] }";
    for changes in [&[][..], &[(left, same)]] {
        let output = check(changes);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        // 27 nodes: 9 at the bottom, and 6 more on the left.
        let plan = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(plan.contains("48 free and 33 prescribed"), "{plan}");
    }
    let different = "set = \"block.left\"\ncomponents = [\"x\"]\ndisplacement = { table = [[0.0, 0.0], [1.0, 0.1]] }";
    let output = check(&[(left, different)]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("with other values"), "{}", stderr(&output));
}

#[test]
fn resuming_bears_changes_of_what_is_not_computed() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), &[]);
    let run = |more: &[&str]| {
        let output = stoss(folder.path(), &[&["run", "scene.toml", "--quiet"][..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    run(&["--out", "whole"]);
    run(&["--out", "out", "--until", "0.12"]);
    let probe = "[[probe]]\nname = \"side\"\nset = \"block.middle\"\nquantity = \"velocity\"\n";
    let set =
        "[[set]]\nname = \"block.middle\"\nbody = \"block\"\nplane = { point = [0, 0, 0.5], normal = [0, 0, 1] }\n";
    write_scene(
        folder.path(),
        &[
            ("title = \"block\"", "title = \"another title\" # and a comment"),
            ("end = 0.2", "end = 0.3"),
            ("every = 2", "every = 1"),
            ("[output]", &format!("{set}\n{probe}\n[watch]\nlimit = 0.5\n\n[output]")),
        ],
    );
    run(&["--out", "out", "--resume"]);
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    assert!(read(&out, "balance.csv").starts_with(&read(&whole, "balance.csv")));
    assert_eq!(read(&out, "balance.csv").lines().count(), 17);
    let [before, after] = [read(&whole, "probes.csv"), read(&out, "probes.csv")];
    let [before, after] = [&before, &after].map(|text| text.lines().collect::<Vec<_>>());
    assert_eq!(after[0], format!("{},side.x,side.y,side.z", before[0]));
    assert_eq!(after[3], format!("{},,,", before[3]), "rows before the change have no values of the new probe");
    assert!(after[9].starts_with(before[9]) && !after[9].ends_with(','), "{}", after[9]);
    // Steps 0, 2, 4, 6, then each of 7 to 15.
    assert_eq!(std::fs::read_dir(out.join("frames")).unwrap().count(), 13);
    // No probes any more.
    let start = SCENE.find("[[probe]]").unwrap();
    let end = SCENE.find("[output]").unwrap();
    write_scene(folder.path(), &[("end = 0.2", "end = 0.4"), (&SCENE[start..end], "")]);
    run(&["--out", "out", "--resume"]);
    assert!(!out.join("probes.csv").exists());
}

#[test]
fn resuming_names_what_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), &[]);
    let first = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet", "--until", "0.1"]);
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    let before = read(&folder.path().join("out"), "balance.csv");
    for (changes, named) in [
        (&[("young = 100.0", "young = 200.0")][..], "body[0].material.young: 100.0 -> 200.0"),
        (&[("step = 0.02", "step = 0.01")], "time.step: 0.02 -> 0.01"),
        (&[("end = 0.2", "end = 0.05")], "after the new end"),
        (
            &[(
                "fixed = true\n\n[[probe]]",
                "fixed = true\n\n[[load]]\nbody = \"block\"\nbody_force = [0, 0, 1]\n\n[[probe]]",
            )],
            "load was added",
        ),
    ] {
        write_scene(folder.path(), changes);
        let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--resume"]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains(named), "`{named}` is not in: {}", stderr(&output));
        assert_eq!(read(&folder.path().join("out"), "balance.csv"), before, "results must stay");
    }
}

#[test]
fn a_shortened_last_step_cannot_be_continued() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), &[("end = 0.2", "end = 0.05")]);
    let first = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    write_scene(folder.path(), &[]);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--resume"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("shortened"), "{}", stderr(&output));
}
