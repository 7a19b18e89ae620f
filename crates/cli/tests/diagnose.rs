//! The diagnosis of a run by the program: short form, page, events, `stoss diagnose`.

use std::path::Path;
use std::process::{Command, Output, Stdio};

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stoss"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn failing(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/failing").join(name);
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn a_run_that_comes_out_wrong_says_why_and_leaves_a_page() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), failing("missing-contact.toml")).unwrap();
    let run = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report"]);
    assert_eq!(run.status.code(), Some(4));
    let told = text(&run.stderr);
    for part in [
        "diagnosis: a contact is missing (almost certain)",
        "`plate`",
        "`ball`",
        "try:",
        "[[contact]]",
        "diagnosis.html",
        "edges",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    // The progress of a step before bodies touch has no depth; the last one has.
    let depths: Vec<bool> =
        told.lines().filter(|line| line.starts_with("step ")).map(|line| line.contains("depth")).collect();
    assert!(!depths[0] && depths[depths.len() - 1], "{told}");
    let page = std::fs::read_to_string(folder.path().join("out/diagnosis.html")).unwrap();
    for part in ["<svg", "missing contact", "plate.top"] {
        assert!(page.contains(part), "{part}");
    }
    std::fs::remove_file(folder.path().join("out/diagnosis.html")).unwrap();
    let again = stoss(folder.path(), &["diagnose", "out"]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    assert!(text(&again.stdout).starts_with("diagnosis: a contact is missing"));
    assert_eq!(std::fs::read_to_string(folder.path().join("out/diagnosis.html")).unwrap(), page);
    // The same folder after a run that comes out well has none.
    let until =
        stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report", "--until", "0.04", "--json"]);
    assert_eq!(until.status.code(), Some(0));
    assert!(!folder.path().join("out/diagnosis.json").exists() && !folder.path().join("out/diagnosis.html").exists());
    assert!(text(&stoss(folder.path(), &["diagnose", "out"]).stdout).contains("nothing to diagnose"));
    let steps = text(&until.stdout);
    let step = steps.lines().find(|line| line.contains("\"event\":\"step\"")).unwrap();
    let step: serde_json::Value = serde_json::from_str(step).unwrap();
    assert!(step["drift"].as_f64().is_some_and(|drift| drift < 1e-9) && step["depth"] == 0.0, "{step}");
    assert_eq!(stoss(folder.path(), &["diagnose", "."]).status.code(), Some(1));
}

#[test]
fn a_run_that_stops_has_the_diagnosis_among_its_events() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), failing("free-rotation.toml")).unwrap();
    let run = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--json"]);
    assert_eq!(run.status.code(), Some(3));
    let events: Vec<serde_json::Value> =
        text(&run.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let kinds: Vec<&str> = events.iter().map(|event| event["event"].as_str().unwrap()).collect();
    assert_eq!(kinds[kinds.len() - 2..], ["diagnosis", "error"], "{kinds:?}");
    assert_eq!(events[events.len() - 1]["verdict"], "sound");
    let diagnosis = &events[events.len() - 2];
    assert_eq!(
        (&diagnosis["cause"], &diagnosis["confidence"]),
        (&"free-rotation".into(), &"high".into()),
        "{diagnosis}"
    );
    assert!(diagnosis["remedies"][0].as_str().unwrap().contains("flap."), "{diagnosis}");
    assert!(folder.path().join("out/diagnosis.html").is_file());
    let report = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(report.contains("href=\"diagnosis.html\""));
}

/// An impact with Newmark's method stops the run: message, verdict and cause are on the terminal, and the verdict also with `--quiet`.
#[test]
fn a_run_that_stops_has_its_verdict() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), failing("scheme-gains-energy.toml")).unwrap();
    let run = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report"]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let told = text(&run.stderr);
    let places = [
        "error: step ",
        "verdict up to step ",
        "diagnosis: the scheme adds energy (almost certain)",
        "{ scheme = \"energy-momentum\" }",
    ]
    .map(|part| told.find(part).unwrap_or_else(|| panic!("{part}: {told}")));
    assert!(places.is_sorted() && told.contains(": wrong: at t = "), "{told}");
    let quiet = text(&stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report", "--quiet"]).stderr);
    assert!(quiet.contains("verdict up to step ") && !quiet.contains("diagnosis:"), "{quiet}");
}
