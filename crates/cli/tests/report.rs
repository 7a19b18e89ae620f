//! The page that a run leaves, `stoss report`, `stoss follow` and `stoss picture`.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

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
    let page_seconds = |folder: &Path| {
        let text = std::fs::read_to_string(folder.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        summary["page_seconds"].as_f64()
    };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let page = folder.path().join("out/report.html");
    let run = ["run", "scene.toml", "--out", "out"];
    let output = stoss(folder.path(), &run);
    assert!(output.status.success() && stderr(&output).contains("out/report.html"), "{}", stderr(&output));
    assert!(std::fs::read_to_string(&page).unwrap().contains("<title>flight</title>"));
    assert!(page_seconds(&folder.path().join("out")).is_some_and(|seconds| seconds > 0.0));
    // A new run removes the page of the one before, which would be about other results.
    let output = stoss(folder.path(), &[&run[..], &["--no-report", "--quiet"]].concat());
    assert!(output.status.success() && stderr(&output).is_empty(), "{}", stderr(&output));
    assert!(!page.exists() && page_seconds(&folder.path().join("out")).is_none());
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
        (vec!["a.bmp"], "a.bmp"),
        (vec!["b.gif", "--frame", "0"], "--frame"),
        (vec!["b.svg", "--fps", "5"], "--fps"),
        (vec!["b.gif", "--fps", "500"], "--fps 500"),
        (vec!["b.png", "--size", "640"], "--size"),
        (vec!["b.png", "--size", "1x1"], "--size 1x1"),
        (vec!["b.svg", "--body", "rope"], "block"),
        (vec!["b.svg", "--field", "colour"], "velocity"),
        (vec!["b.svg", "--frame", "70"], "--frame 70"),
        (vec!["b.svg", "--view", "1,2"], "--view"),
        (vec!["b.svg", "--frame", "0", "--time", "0"], "--time"),
    ] {
        let (code, text) = picture(&arguments);
        assert!(code == Some(2) && text.contains(told), "{text}");
    }
    for name in ["b.svg", "b.png", "b.gif"] {
        assert!(!folder.path().join(name).exists());
    }
    let bytes = |arguments: &[&str]| {
        assert_eq!(picture(arguments), (Some(0), String::new()));
        std::fs::read(folder.path().join(arguments[0])).unwrap()
    };
    // Width and height stand behind the signature and the name of the first part; in the other format behind the version.
    let png = bytes(&["c.png", "--size", "320x240"]);
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png[16..24] == [0, 0, 1, 64, 0, 0, 0, 240]);
    let gif = bytes(&["c.gif", "--size", "320x240", "--every", "2", "--fps", "10", "--once"]);
    assert!(gif.starts_with(b"GIF89a") && gif[6..10] == [64, 1, 240, 0]);
    // Frames 0 and 2 are each announced by a delay of ten hundredths of a second.
    let delays = gif.windows(6).filter(|bytes| bytes[..3] == [0x21, 0xf9, 4] && bytes[4..6] == [10, 0]).count();
    assert_eq!(delays, 2);
    let (code, text) = picture(&["nowhere/b.svg"]);
    assert!(code == Some(1) && text.contains("nowhere/b.svg"), "{text}");
}

/// The page as it is now.
fn page_of(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("out/report.html")).unwrap_or_default()
}

#[test]
fn a_page_loads_itself_anew_as_long_as_the_run_goes_on_and_is_followed() {
    const RELOAD: &str = "<meta name=\"stoss-reload\" content=\"0.5\">";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    assert!(stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--no-report", "--quiet"]).status.success());
    // A run that has ended.
    let output = stoss(folder.path(), &["follow", "out"]);
    assert!(output.status.success() && page_of(folder.path()).contains("<title>flight</title>"));
    assert!(!page_of(folder.path()).contains(RELOAD));
    // One that goes on: somebody holds its lock.
    let follow = |end: &dyn Fn(u32)| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stoss"));
        command.args(["follow", "out", "--interval", "0.5"]).current_dir(folder.path()).stdout(Stdio::null());
        let mut child = command.spawn().unwrap();
        let limit = Instant::now() + Duration::from_secs(20);
        while !page_of(folder.path()).contains(RELOAD) && Instant::now() < limit {
            std::thread::sleep(Duration::from_millis(10));
        }
        assert!(page_of(folder.path()).contains(RELOAD));
        end(child.id());
        assert!(child.wait().unwrap().success());
        assert!(page_of(folder.path()).contains("<title>flight</title>") && !page_of(folder.path()).contains(RELOAD));
    };
    let lock = std::fs::File::options().write(true).open(folder.path().join("out/stoss.lock")).unwrap();
    lock.lock().unwrap();
    #[cfg(unix)]
    follow(&|child| assert!(Command::new("kill").args(["-INT", &child.to_string()]).status().unwrap().success()));
    follow(&|_| lock.unlock().unwrap());
    let output = stoss(folder.path(), &["follow", "out", "--interval", "0"]);
    assert!(output.status.code() == Some(2) && stderr(&output).contains("--interval"));
}

#[test]
fn a_sweep_leaves_a_page_that_compares_its_cases() {
    let folder = tempfile::tempdir().unwrap();
    let scene = SCENE.replace("[time]", "[parameters]\nspeed = 1.0\n[sweep]\ngrid = { speed = [1.0, 2.5] }\n[time]");
    std::fs::write(folder.path().join("scene.toml"), scene.replace("-1.0]", "\"-speed\"]")).unwrap();
    let page = folder.path().join("out/report.html");
    assert!(stoss(folder.path(), &["sweep", "scene.toml", "--out", "out", "--no-report"]).status.success());
    assert!(!page.exists());
    let output = stoss(folder.path(), &["sweep", "scene.toml", "--out", "out"]);
    assert!(output.status.success() && stderr(&output).contains("out/report.html"), "{}", stderr(&output));
    let text = std::fs::read_to_string(&page).unwrap();
    assert_eq!((text.matches("class=\"run\">").count(), text.matches("id=\"sweep\">").count()), (2, 1));
    std::fs::remove_file(&page).unwrap();
    assert!(stoss(folder.path(), &["report", "out"]).status.success());
    assert_eq!(std::fs::read_to_string(&page).unwrap(), text);
    // As a shell writes `out/cases/*`.
    let names: Vec<String> = ["0001", "0001.json", "0001.log", "0002", "0002.json", "0002.log"]
        .map(|name| format!("out/cases/{name}"))
        .into();
    let arguments: Vec<&str> = std::iter::once("report").chain(names.iter().map(String::as_str)).collect();
    assert!(stoss(folder.path(), &arguments).status.success());
    let text = std::fs::read_to_string(folder.path().join("out/cases/0001/report.html")).unwrap();
    assert_eq!(text.matches("class=\"run\">").count(), 2);
    assert_eq!(stoss(folder.path(), &["report", "out/cases/0001.log"]).status.code(), Some(2));
}

/// The page of a scene stands where it is wanted, and nothing else is left.
#[test]
fn a_scene_is_shown_before_its_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let output = stoss(folder.path(), &["view", "scene.toml"]);
    assert!(output.status.success() && stderr(&output).is_empty(), "{}", stderr(&output));
    let page = std::fs::read_to_string(folder.path().join("scene.view.html")).unwrap();
    assert!(page.contains("<title>flight</title>"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let output = stoss(folder.path(), &["view", "scene.toml", "-o", "other.html"]);
    assert!(output.status.success() && folder.path().join("other.html").exists());
    std::fs::write(folder.path().join("mine.html"), "my own").unwrap();
    let output = stoss(folder.path(), &["view", "scene.toml", "-o", "mine.html"]);
    assert!(output.status.code() == Some(1) && stderr(&output).contains("mine.html"));
    std::fs::write(folder.path().join("bad.toml"), SCENE.replace("end = 0.02", "end = -1")).unwrap();
    let output = stoss(folder.path(), &["view", "bad.toml"]);
    assert!(output.status.code() == Some(2) && stderr(&output).contains("time.end"), "{}", stderr(&output));
    assert!(!folder.path().join("bad.view.html").exists());
}
