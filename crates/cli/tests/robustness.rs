//! The program on bad scenes, diverging runs, killed runs, different numbers of threads.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A valid scene: a block falls on a plate that is held at its bottom.
const BASE: &str = r#"[scene]
title = "base"
kind = "dynamic"

[time]
end = 0.4
step = 0.02
integrator = { scheme = "energy-momentum" }
max_cuts = 4

[solver]
max_iterations = 20

[[body]]
name = "top"
mesh = { generator = "block", min = [-0.5, -0.5, 1.05], max = [0.5, 0.5, 2.05], divisions = [2, 2, 2] }
material = { law = "neo-hooke", lambda = 1300.0, mu = 865.0 }
density = 10.0
velocity = [0.1, 0.0, -1.0]

[[body]]
name = "plate"
mesh = { generator = "hexahedron", divisions = [3, 3, 1], corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]] }
material = { law = "ogden", mu = [6300.0, 12.0, -100.0], alpha = [1.3, 5.0, -2.0], kappa = 2000.0, beta = 9.0 }
density = 10.0

[[set]]
name = "plate.edge"
body = "plate"
box = { min = [-9, -9, -9], max = [-0.99, 9, 9] }

[[contact]]
method = "nts"
slave = "top.bottom"
master = "plate.top"

[[prescribe]]
set = "plate.bottom"
components = ["x", "y", "z"]
fixed = true

[[load]]
body = "top"
body_force = [0.0, 0.0, -1.0]

[[probe]]
name = "tip"
set = "top.top"
quantity = "displacement"

[output]
every = 1
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

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("the temporary folder is writable");
}

/// The base scene with one text replaced, which must be there.
fn changed(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "the base scene has no `{from}`");
    BASE.replacen(from, to, 1)
}

/// (replace, by, a text in the line of the mistake, key that must be named)
const MISTAKES: &[(&str, &str, &str, &str)] = &[
    // The format.
    ("title = \"base\"", "title = base", "title = base", ""),
    ("step = 0.02", "step = ", "step = ", ""),
    ("kind = \"dynamic\"", "kind = \"dynamical\"", "dynamical", "scene.kind"),
    ("title = \"base\"", "title = 3", "title = 3", "scene.title"),
    ("title = \"base\"", "title = \"base\"\nauthor = \"me\"", "author", "scene.author"),
    ("[output]", "[outptu]", "[outptu]", "outptu"),
    ("step = 0.02", "step = 0.0", "step = 0.0", "time.step"),
    ("step = 0.02", "step = -0.02", "step = -0.02", "time.step"),
    ("step = 0.02", "step = nan", "step = nan", "time.step"),
    ("step = 0.02", "step = \"slow\"", "step = \"slow\"", "time.step"),
    ("end = 0.4", "end = -1.0", "end = -1.0", "time.end"),
    ("end = 0.4", "end = inf", "end = inf", "time.end"),
    ("\"energy-momentum\"", "\"leapfrog\"", "leapfrog", "time.integrator.scheme"),
    ("\"energy-momentum\"", "\"forward-euler\"", "forward-euler", "time.integrator.scheme"),
    ("\"energy-momentum\"", "\"newmark\", beta = 7.0", "beta = 7.0", "time.integrator.beta"),
    ("\"energy-momentum\"", "\"midpoint\", beta = 0.25", "beta = 0.25", "time.integrator.beta"),
    (
        "[[prescribe]]",
        "[[contact]]\nname = \"again\"\nmethod = \"nts\"\nslave = \"top.bottom\"\nmaster = \"plate.top\"\n[[prescribe]]",
        "name = \"again\"",
        "contact[1].name",
    ),
    ("max_cuts = 4", "max_cuts = 99", "max_cuts = 99", "time.max_cuts"),
    ("max_iterations = 20", "max_iterations = 0", "max_iterations = 0", "solver.max_iterations"),
    ("max_iterations = 20", "linear = \"magic\"", "magic", "solver.linear"),
    ("density = 10.0\nvelocity", "density = -1.0\nvelocity", "density = -1.0", "body[0].density"),
    ("density = 10.0\nvelocity", "density = nan\nvelocity", "density = nan", "body[0].density"),
    ("density = 10.0\nvelocity", "desnity = 10.0\nvelocity", "desnity", "body[0].desnity"),
    ("velocity = [0.1, 0.0, -1.0]", "velocity = [0.1, 0.0]", "velocity", "body[0].velocity"),
    ("velocity = [0.1, 0.0, -1.0]", "velocity = 1.0", "velocity", "body[0].velocity"),
    ("name = \"plate\"", "name = \"top\"", "name = \"top\"\nmesh = { generator = \"hexa", "body[1].name"),
    ("lambda = 1300.0", "lambda = -1300.0", "lambda = -1300.0", "body[0].material.lambda"),
    ("mu = 865.0", "mu = -865.0", "mu = -865.0", "body[0].material.mu"),
    ("law = \"neo-hooke\"", "law = \"steel\"", "steel", "body[0].material.law"),
    ("kappa = 2000.0, ", "", "ogden", "body[1].material.kappa"),
    ("alpha = [1.3, 5.0, -2.0]", "alpha = [1.3, 5.0]", "alpha", "body[1].material.alpha"),
    ("generator = \"block\"", "generator = \"cube\"", "cube", "body[0].mesh.generator"),
    ("divisions = [2, 2, 2]", "divisions = [2, 0, 2]", "[2, 0, 2]", "body[0].mesh.divisions[1]"),
    ("divisions = [2, 2, 2]", "divisions = [2, 2.5, 2]", "2.5", "body[0].mesh.divisions[1]"),
    ("max = [0.5, 0.5, 2.05]", "max = [0.5, -0.5, 2.05]", "max = [0.5, -0.5", "body[0].mesh.max"),
    ("method = \"nts\"", "method = \"penalty\"", "penalty", "contact[0].method"),
    ("slave = \"top.bottom\"\n", "", "[[contact]]", "contact[0].slave"),
    ("master = \"plate.top\"", "master = \"plat.top\"", "plat.top", "contact[0].master"),
    ("method = \"nts\"", "method = \"nts\"\nfriction = 0.3", "friction", "contact[0].friction"),
    ("components = [\"x\", \"y\", \"z\"]", "components = []", "components", "prescribe[0].components"),
    ("components = [\"x\", \"y\", \"z\"]", "components = [\"w\"]", "\"w\"", "prescribe[0].components[0]"),
    ("fixed = true", "displacement = { table = [] }", "table = []", "prescribe[0].displacement"),
    (
        "fixed = true",
        "displacement = { table = [[0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]] }",
        "table = ",
        "prescribe[0].displacement",
    ),
    ("body_force = [0.0, 0.0, -1.0]", "body_force = -1.0", "body_force", "load[0].body_force"),
    ("body_force = [0.0, 0.0, -1.0]\n", "", "[[load]]", "load[0]"),
    ("quantity = \"displacement\"", "quantity = \"colour\"", "colour", "probe[0].quantity"),
    ("every = 1\n", "every = 0\n", "every = 0", "output.every"),
    // What only the meshes tell.
    ("slave = \"top.bottom\"", "slave = \"top.belly\"", "top.belly", "contact[0].slave"),
    ("set = \"plate.bottom\"", "set = \"plate.sole\"", "plate.sole", "prescribe[0].set"),
    ("set = \"top.top\"", "set = \"top.roof\"", "top.roof", "probe[0].set"),
    ("max = [-0.99, 9, 9]", "max = [-8, 9, 9]", "[[set]]", "set[0]"),
    (
        "corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 1]",
        "corners = [[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 1]",
        "hexahedron",
        "body[1].mesh",
    ),
    (
        "mesh = { generator = \"block\", min = [-0.5, -0.5, 1.05], max = [0.5, 0.5, 2.05], divisions = [2, 2, 2] }",
        "mesh = { file = \"nowhere.msh\" }",
        "nowhere.msh",
        "body[0].mesh.file",
    ),
    ("slave = \"top.bottom\"", "slave = \"plate.bottom\"", "master = \"plate.top\"", "contact[0].master"),
    (
        "[[load]]\n",
        "[[prescribe]]\nset = \"plate.edge\"\ncomponents = [\"x\"]\ndisplacement = [0.1]\n\n[[load]]\n",
        "set = \"plate.edge\"\ncomponents",
        "prescribe[1]",
    ),
    ("mu = [6300.0, 12.0, -100.0]", "mu = [-6300.0, 12.0, -100.0]", "-6300", "body[1].material"),
    ("mu = [6300.0, 12.0, -100.0]", "mu = [10.0, -100.0, -100.0]", "mu = [10.0", "body[1].material"),
];

/// Line, from 1, of the first occurrence.
fn line_of(text: &str, at: &str) -> usize {
    let position = text.find(at).unwrap_or_else(|| panic!("`{at}` is not in the scene"));
    1 + text[..position].matches('\n').count()
}

/// What is wrong with the program's answer to a malformed scene, if anything.
fn complaint(output: &Output, file: &str, line: usize, key: &str) -> Option<String> {
    let text = stderr(output);
    if output.status.code() != Some(2) {
        return Some(format!("exit code {:?}\n{text}", output.status.code()));
    }
    if text.contains("panicked") {
        return Some(text);
    }
    let place = format!("{file}:{line}:");
    let found = text.lines().filter(|l| l.starts_with("error: ")).any(|l| {
        // `error: FILE:LINE:COLUMN: KEY ...: MESSAGE; REMEDY`
        let remedy = l.rsplit_once("; ").is_some_and(|(_, remedy)| remedy.len() > 5);
        l.contains(&place) && l.contains(key) && remedy
    });
    (!found).then(|| format!("no line with `{place}`, `{key}` and a remedy in\n{text}"))
}

#[test]
fn the_base_scene_is_well_formed() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", BASE);
    let output = stoss(folder.path(), &["check", "scene.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let plan = String::from_utf8_lossy(&output.stdout).into_owned();
    // 27 + 32 nodes, the 16 at the bottom of the plate fixed; 9 slave nodes.
    assert!(plan.contains("129 free and 48 prescribed"), "{plan}");
    assert!(plan.contains("up to 9 contact pressures"), "{plan}");
    assert!(!folder.path().join("scene.out").exists(), "check must write nothing");
}

#[test]
fn malformed_scenes_are_explained() {
    assert!(MISTAKES.len() >= 40);
    let folder = tempfile::tempdir().unwrap();
    let mut failures = Vec::new();
    for (number, (from, to, at, key)) in MISTAKES.iter().enumerate() {
        let text = changed(from, to);
        let file = format!("bad-{number}.toml");
        write(folder.path(), &file, &text);
        // Every seventh through `run`: the answer must be the same.
        let command = if number % 7 == 0 { "run" } else { "check" };
        let output = stoss(folder.path(), &[command, &file]);
        if let Some(complaint) = complaint(&output, &file, line_of(&text, at), key) {
            failures.push(format!("--- {number}: `{from}` -> `{to}` ({command})\n{complaint}"));
        }
        assert!(!folder.path().join(format!("bad-{number}.out")).exists(), "{number}: a folder was left");
    }
    assert!(failures.is_empty(), "{} of {}\n{}", failures.len(), MISTAKES.len(), failures.join("\n"));
}

#[test]
fn several_problems_are_reported_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let text = changed("step = 0.02", "step = -0.02").replacen("every = 1\n", "every = 0\n", 1);
    write(folder.path(), "scene.toml", &text);
    let output = stoss(folder.path(), &["check", "scene.toml"]);
    assert_eq!(complaint(&output, "scene.toml", line_of(&text, "step = -0.02"), "time.step"), None);
    assert_eq!(complaint(&output, "scene.toml", line_of(&text, "every = 0"), "output.every"), None);
}

#[test]
fn wrong_command_lines() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", BASE);
    assert_eq!(stoss(folder.path(), &["check", "missing.toml"]).status.code(), Some(1));
    assert_eq!(stoss(folder.path(), &["rnu", "scene.toml"]).status.code(), Some(2));
    assert_eq!(stoss(folder.path(), &["run", "scene.toml", "--threads", "0"]).status.code(), Some(2));
    for until in ["--until=0", "--until=-1", "--until=nan", "--until=7"] {
        let output = stoss(folder.path(), &["run", "scene.toml", until]);
        assert_eq!(output.status.code(), Some(2), "{until}: {}", stderr(&output));
        assert!(stderr(&output).contains("--until"), "{until}: {}", stderr(&output));
    }
    let output = stoss(folder.path(), &["run", "scene.toml", "--resume", "--out", "nothing-here"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("without --resume").count(), 1, "{}", stderr(&output));
    std::fs::write(folder.path().join("latin1.toml"), b"[scene]\ntitle = \"Sto\xdf\"\n").unwrap();
    let output = stoss(folder.path(), &["check", "latin1.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("latin1.toml:2") && stderr(&output).contains("UTF-8"), "{}", stderr(&output));
}

#[test]
fn a_run_replaces_its_own_frames_only_and_misses_them() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", BASE);
    let arguments = ["run", "scene.toml", "--out", "out", "--until", "0.1", "--quiet"];
    assert_eq!(stoss(folder.path(), &arguments).status.code(), Some(0));
    let out = folder.path().join("out");
    write(&out, "frames/frame_mine.vtu", "mine");
    write(&out, "frames/frame_000099.vtu", "of a longer run");
    assert_eq!(stoss(folder.path(), &arguments).status.code(), Some(0));
    assert!(out.join("frames/frame_mine.vtu").exists() && !out.join("frames/frame_000099.vtu").exists());
    std::fs::remove_file(out.join("frames/frame_000002.vtu")).unwrap();
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--resume"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("frame_000002.vtu"), "{}", stderr(&output));
}

#[test]
fn a_run_killed_at_once_can_be_resumed() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", &changed("checkpoint_every = 3", "checkpoint_every = 1000"));
    let whole = stoss(folder.path(), &["run", "scene.toml", "--out", "whole", "--quiet"]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    let out = folder.path().join("killed");
    let mut child = Command::new(env!("CARGO_BIN_EXE_stoss"))
        .args(["run", "scene.toml", "--out", "killed", "--quiet"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while rows(&out) < 3 {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success(), "the run was over before it could be killed");
    let resumed = stoss(folder.path(), &["run", "scene.toml", "--out", "killed", "--resume", "--quiet"]);
    assert_eq!(resumed.status.code(), Some(0), "{}", stderr(&resumed));
    assert_same_results(&folder.path().join("whole"), &out);
}

fn frames(out: &Path) -> Vec<PathBuf> {
    let mut list: Vec<PathBuf> = std::fs::read_dir(out.join("frames"))
        .expect("there are frames")
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "vtu"))
        .collect();
    list.sort();
    list
}

fn assert_readable(frame: &Path) {
    let text = String::from_utf8_lossy(&std::fs::read(frame).unwrap()).into_owned();
    assert!(text.starts_with("<?xml") && text.trim_end().ends_with("</VTKFile>"), "{} is cut off", frame.display());
    assert!(stoss::mesh_io::read_vtu(frame).is_ok(), "{} is not readable", frame.display());
}

fn summary(out: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap()
}

#[test]
fn a_run_that_fails_keeps_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    // A load that grows beyond what the body can bear: it is pulled flat.
    let text = changed(
        "body_force = [0.0, 0.0, -1.0]",
        "body_force = { table = [[0.0, 0.0, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0], [0.12, 0.0, 0.0, -1e9]] }",
    )
    .replacen("max_cuts = 4", "max_cuts = 2", 1);
    write(folder.path(), "scene.toml", &text);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    assert!(message.contains("last good state: step "), "{message}");
    let out = folder.path().join("out");
    let summary = summary(&out);
    assert_eq!(summary["outcome"]["kind"], "failed", "{summary}");
    let last = summary["outcome"]["last_step"].as_u64().unwrap();
    assert!(last >= 5, "{summary}");
    let rows = std::fs::read_to_string(out.join("balance.csv")).unwrap();
    assert_eq!(rows.lines().count() as u64, last + 2, "a header and the steps from 0");
    let frames = frames(&out);
    assert!(frames.len() >= 6, "{frames:?}");
    frames.iter().for_each(|frame| assert_readable(frame));
}

fn assert_same_results(a: &Path, b: &Path) {
    for table in ["balance.csv", "newton.csv", "probes.csv", "contact.csv", "frames.pvd"] {
        let [x, y] = [a, b].map(|folder| std::fs::read(folder.join(table)).unwrap());
        assert!(x == y, "{table} differs");
    }
    let [x, y] = [a, b].map(frames);
    let names = |list: &[PathBuf]| list.iter().map(|p| p.file_name().unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(names(&x), names(&y));
    for (frame, other) in x.iter().zip(&y) {
        assert!(std::fs::read(frame).unwrap() == std::fs::read(other).unwrap(), "{} differs", frame.display());
    }
    let [x, y] = [a, b].map(|folder| summary(folder)["drift"].clone());
    assert_eq!(x, y, "drifts of the summaries");
}

fn rows(out: &Path) -> usize {
    std::fs::read_to_string(out.join("balance.csv")).map_or(0, |text| text.lines().count())
}

/// A matrix pattern that grows within a step, an ordering, factors: nothing of what earlier steps left in the linear solver shows.
#[test]
fn a_large_system_resumes_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/ironing-mortar.toml");
    let text = std::fs::read_to_string(scene).unwrap();
    write(folder.path(), "scene.toml", &text);
    let run = |arguments: &[&str]| {
        let output = stoss(folder.path(), &[&["run", "scene.toml", "--quiet"], arguments].concat());
        // The slab's edges stand in the coarse indenter: the verdict is `wrong`.
        assert!(matches!(output.status.code(), Some(0 | 4)), "{}", stderr(&output));
    };
    run(&["--out", "whole", "--until", "2.6"]);
    run(&["--out", "parts", "--until", "2.2"]);
    run(&["--out", "parts", "--until", "2.6", "--resume"]);
    assert_eq!(summary(&folder.path().join("parts"))["linear_solver"], "multifrontal");
    assert_same_results(&folder.path().join("whole"), &folder.path().join("parts"));
}

#[test]
fn a_killed_run_resumes_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let text = changed("end = 0.4", "end = 1.2");
    write(folder.path(), "scene.toml", &text);
    let whole = stoss(folder.path(), &["run", "scene.toml", "--out", "whole", "--quiet"]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    let balance = std::fs::read_to_string(folder.path().join("whole/newton.csv")).unwrap();
    let header: Vec<&str> = balance.lines().next().unwrap().split(',').collect();
    let active = header.iter().position(|h| *h == "active").unwrap();
    assert!(
        balance.lines().skip(1).any(|row| row.split(',').nth(active).unwrap().parse::<u64>().unwrap() > 0),
        "the bodies must touch"
    );

    let out = folder.path().join("killed");
    let total = rows(&folder.path().join("whole"));
    // Killed twice: after the first few steps, and in the middle.
    for (attempt, enough) in [8, total / 2].into_iter().enumerate() {
        let mut arguments = vec!["run", "scene.toml", "--out", "killed", "--quiet"];
        if attempt > 0 {
            arguments.push("--resume");
        }
        let mut child = Command::new(env!("CARGO_BIN_EXE_stoss"))
            .args(&arguments)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while rows(&out) < enough && start.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        let status = child.wait().unwrap();
        assert!(!status.success(), "the run was over before it could be killed");
        frames(&out).iter().for_each(|frame| assert_readable(frame));
    }
    let resumed = stoss(folder.path(), &["run", "scene.toml", "--out", "killed", "--resume", "--quiet"]);
    assert_eq!(resumed.status.code(), Some(0), "{}", stderr(&resumed));
    assert_same_results(&folder.path().join("whole"), &out);
    assert_eq!(summary(&out)["outcome"]["kind"], "completed");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let text = changed("divisions = [2, 2, 2]", "divisions = [6, 6, 4]")
        .replacen("divisions = [3, 3, 1]", "divisions = [9, 9, 2]", 1)
        .replacen("end = 0.4", "end = 0.12", 1);
    write(folder.path(), "scene.toml", &text);
    for threads in ["1", "2"] {
        let output = stoss(folder.path(), &["run", "scene.toml", "--threads", threads, "--out", threads, "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    assert_same_results(&folder.path().join("1"), &folder.path().join("2"));
    // 306 elements, in contact at the end.
    let newton = std::fs::read_to_string(folder.path().join("1/newton.csv")).unwrap();
    assert!(newton.lines().last().unwrap().split(',').nth(5).unwrap().parse::<u64>().unwrap() > 0);
}

#[test]
fn until_stops_early_on_the_same_path() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", BASE);
    let part = stoss(folder.path(), &["run", "scene.toml", "--until", "0.1"]);
    assert_eq!(part.status.code(), Some(0), "{}", stderr(&part));
    // Without a terminal: one line a step. The folder is named after the scene.
    assert_eq!(stderr(&part).lines().filter(|line| line.starts_with("step ")).count(), 5);
    let whole = stoss(folder.path(), &["run", "scene.toml", "--out", "whole", "--quiet"]);
    assert_eq!(whole.status.code(), Some(0));
    assert!(whole.stdout.is_empty() && whole.stderr.is_empty(), "{}", stderr(&whole));
    let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join("balance.csv")).unwrap();
    let (part, whole) = (read("scene.out"), read("whole"));
    assert_eq!(part.lines().count(), 7, "a header and the steps 0 to 5");
    assert_eq!(whole.lines().count(), 22);
    assert!(whole.starts_with(&part));
    assert_eq!(
        whole.lines().next(),
        Some(
            "step,time,dt,lx,ly,lz,jx,jy,jz,kinetic,strain,potential,contact,dissipation,external_work,total,closing_loss,contact_remainder,impact_loss,impact_deformable,impacts,impact_capped"
        )
    );
    // A run that was stopped early goes on where it stopped.
    let rest = stoss(folder.path(), &["run", "scene.toml", "--resume", "--quiet"]);
    assert_eq!(rest.status.code(), Some(0), "{}", stderr(&rest));
    assert_same_results(&folder.path().join("scene.out"), &folder.path().join("whole"));
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", BASE);
    write(folder.path(), "other.toml", &changed("density = 10.0\nvelocity", "density = 11.0\nvelocity"));
    let first = stoss(folder.path(), &["run", "scene.toml", "--until", "0.1", "--out", "out", "--quiet"]);
    assert_eq!(first.status.code(), Some(0));
    let before = std::fs::read(folder.path().join("out/balance.csv")).unwrap();
    let second = stoss(folder.path(), &["run", "other.toml", "--out", "out", "--resume"]);
    assert_eq!(second.status.code(), Some(1), "{}", stderr(&second));
    assert!(stderr(&second).contains("checkpoint"), "{}", stderr(&second));
    assert_eq!(std::fs::read(folder.path().join("out/balance.csv")).unwrap(), before, "results must stay");
}

#[test]
fn long_lines_make_short_messages() {
    let folder = tempfile::tempdir().unwrap();
    let long = "x".repeat(100_000);
    for (from, to) in [
        ("law = \"neo-hooke\"", format!("law = \"{long}\"")),
        ("[solver]", format!("[{long}]\n[solver]")),
        ("slave = \"top.bottom\"", format!("slave = \"top.{long}\"")),
        ("max_iterations = 20", format!("max_iterations = 20{long}")),
    ] {
        write(folder.path(), "scene.toml", &changed(from, &to));
        let output = stoss(folder.path(), &["check", "scene.toml"]);
        assert_eq!(output.status.code(), Some(2), "{from}");
        let told = stderr(&output);
        assert!(told.len() < 2000, "{from}: {} characters", told.len());
        assert_eq!(told.matches("error:").count(), 1, "{told}");
    }
}

/// A pipe has no end as long as someone may write into it: it must be refused, not read.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.toml");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::fs::rename(&pipe, folder.path().join("mesh.inp")).unwrap();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mesh =
        "mesh = { generator = \"block\", min = [-0.5, -0.5, 1.05], max = [0.5, 0.5, 2.05], divisions = [2, 2, 2] }";
    write(folder.path(), "scene.toml", &changed(mesh, "mesh = { file = \"mesh.inp\" }"));
    for (scene, code) in [("pipe.toml", 1), ("/dev/zero", 1), ("scene.toml", 2)] {
        let output = stoss(folder.path(), &["check", scene]);
        assert_eq!(output.status.code(), Some(code), "{scene}: {}", stderr(&output));
        assert!(stderr(&output).contains("not a regular file"), "{scene}: {}", stderr(&output));
    }
}

#[test]
fn schema_is_json() {
    let folder = tempfile::tempdir().unwrap();
    let output = stoss(folder.path(), &["schema"]);
    assert_eq!(output.status.code(), Some(0));
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for table in ["scene", "time", "body", "contact", "prescribe", "load", "probe", "output", "expect"] {
        assert!(!schema["properties"][table].is_null(), "{table} is not in the schema");
    }
}

/// `stoss schema | head -1`: the reader goes away before everything is written.
#[test]
fn a_closed_pipe_is_no_panic() {
    for closed in ["stdout", "stderr"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stoss"));
        if closed == "stdout" {
            command.arg("schema")
        } else {
            command.args(["check", "no-such-scene.toml"])
        };
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        if closed == "stdout" {
            drop(child.stdout.take())
        } else {
            drop(child.stderr.take())
        };
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(if closed == "stdout" { 0 } else { 1 }), "{output:?}");
    }
}
