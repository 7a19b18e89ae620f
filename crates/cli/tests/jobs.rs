//! Jobs: interruption, parameters, events, sweeps.

use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A block that falls freely from a height: exact in closed form.
const FALL: &str = r#"[parameters]
g = 10.0
height = 1.0
stiffness = 1e4

[scene]
title = "fall"
kind = "dynamic"

[time]
end = 0.5
step = "0.5 / 50"
integrator = { scheme = "energy-momentum" }

[gravity]
acceleration = [0.0, 0.0, "-g"]

[[body]]
name = "block"
mesh = { generator = "block", min = [0.0, 0.0, "height"], max = [1.0, 1.0, "height + 1"], divisions = [2, 2, 2] }
material = { law = "neo-hooke", young = "stiffness", poisson = 0.3 }
density = 2.0

[[probe]]
name = "block"
set = "block.top"
quantity = "displacement"

[output]
every = 10
checkpoint_every = 1000

[sweep]
grid = { g = [5.0, 10.0], height = [1.0, "2*height"] }
extremes = ["balance.kinetic", "probes.block.z"]
"#;

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stoss"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).output().expect("the program starts")
}

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stoss"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("the temporary folder is writable");
}

fn rows(out: &Path) -> usize {
    std::fs::read_to_string(out.join("balance.csv")).map_or(0, |text| text.lines().count())
}

fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(120), "waited too long: {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A run of very many steps.
fn long() -> String {
    FALL.replacen("end = 0.5", "end = 500.0", 1)
}

#[cfg(unix)]
fn send(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("there is `kill`");
    assert!(sent.success());
}

/// The first signal leaves a checkpoint from which the run goes on as if it had not been interrupted.
#[cfg(unix)]
#[test]
fn a_signal_ends_the_run_after_a_step_and_it_goes_on_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", &long());
    for signal in ["-INT", "-TERM"] {
        let out = folder.path().join(signal);
        let mut child = start(folder.path(), &["run", "scene.toml", "--out", &format!("./{signal}"), "--set", "g=9"]);
        // Nobody reads what it says of its steps; the pipe holds what 40 steps say.
        wait_until("some steps", || rows(&out) > 5);
        send(&child, signal);
        let mut told = String::new();
        std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut told).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(5), "{told}");
        let last = told.lines().last().unwrap();
        assert!(last.contains("run scene.toml --out") && last.contains("--set g=9 --resume"), "{told}");
        let summary: Value = serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["outcome"]["kind"], "interrupted");
        let steps = summary["outcome"]["last_step"].as_u64().unwrap();
        assert_eq!(rows(&out) as u64, steps + 2, "a header and the steps from 0");
        // Go on for some steps, and compare with a run that was not interrupted.
        let until = (summary["time"].as_f64().unwrap() + 0.1).to_string();
        let more = ["--set", "g=9", "--until", &until, "--quiet"];
        let resumed = stoss(
            folder.path(),
            &[&["run", "scene.toml", "--out", &format!("./{signal}"), "--resume"][..], &more].concat(),
        );
        assert_eq!(resumed.status.code(), Some(0), "{}", stderr(&resumed));
        let whole = stoss(folder.path(), &[&["run", "scene.toml", "--out", "whole"][..], &more].concat());
        assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
        for table in ["balance.csv", "newton.csv", "probes.csv"] {
            let read = |folder: &Path| std::fs::read(folder.join(table)).unwrap();
            assert!(read(&out) == read(&folder.path().join("whole")), "{table} differs");
        }
    }
}

/// A step that lasts: the first signal cannot end it, the second one does.
#[cfg(unix)]
#[test]
fn a_second_signal_ends_the_program_at_once() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", &long().replacen("divisions = [2, 2, 2]", "divisions = [36, 36, 36]", 1));
    let mut child = start(folder.path(), &["run", "scene.toml", "--out", "out", "--threads", "1"]);
    wait_until("the first state", || rows(&folder.path().join("out")) >= 2);
    send(&child, "-INT");
    std::thread::sleep(Duration::from_millis(100));
    send(&child, "-INT");
    let begun = Instant::now();
    let status = child.wait().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    assert_eq!(status.code(), Some(130), "{status}");
}

#[test]
fn parameters_are_set_from_outside() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", FALL);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--set", "g=2*2", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = std::fs::read_to_string(folder.path().join("out/probes.csv")).unwrap();
    let last: Vec<f64> = table.lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    // g t^2 / 2 after half a second; the scheme is exact for it.
    assert!((last[4] + 0.5).abs() < 1e-9, "{last:?}");
    let output = stoss(folder.path(), &["check", "scene.toml", "--set", "gee=1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("scene.toml:1:") && stderr(&output).contains("--set gee=1"),
        "{}",
        stderr(&output)
    );
    assert_eq!(stoss(folder.path(), &["check", "scene.toml", "--set", "g"]).status.code(), Some(2));
    // Other values are another scene.
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--set", "g=5", "--resume"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("gravity"), "{}", stderr(&output));
}

/// `check` says what expressions over sets hold: a row of facets that a comparison loses at a line of the mesh is seen.
#[test]
fn check_prints_nodes_facets_and_area_of_expressions() {
    let folder = tempfile::tempdir().unwrap();
    let scene = FALL
        .replace("\"block.top\"", "\"block.top & x > 0.5\"")
        .replace("[sweep]", "[sets]\nhalf = \"block.top & x >= 0.5\"\n[sweep]");
    write(folder.path(), "scene.toml", &scene);
    let output = stoss(folder.path(), &["check", "scene.toml"]);
    let plan = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(plan.contains("  set block.top & x > 0.5: 3 nodes, no facets\n"), "{plan}{}", stderr(&output));
    assert!(plan.contains("  set half = block.top & x >= 0.5: 6 nodes, 2 facets with an area of 0.5\n"), "{plan}");
}

/// Times have the digits that the step has, also in microseconds, and decisions are words.
#[test]
fn progress_in_microseconds_is_readable() {
    let folder = tempfile::tempdir().unwrap();
    let scene = FALL.replace("end = 0.5", "end = 0.5e-6").replace("0.5 / 50", "0.5e-6 / 5");
    write(folder.path(), "scene.toml", &scene);
    let text = stderr(&stoss(folder.path(), &["run", "scene.toml", "--no-report"]));
    assert!(text.contains("t = 3e-7 "), "{text}");
}

#[test]
fn force_replaces_what_stoss_did_not_write() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", FALL);
    std::fs::create_dir(folder.path().join("out")).unwrap();
    write(folder.path(), "out/balance.csv", "my own\n");
    write(folder.path(), "out/notes.txt", "mine\n");
    let arguments = ["run", "scene.toml", "--out", "out", "--until", "0.05", "--quiet"];
    let refused = stoss(folder.path(), &arguments);
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    assert_eq!(std::fs::read_to_string(folder.path().join("out/balance.csv")).unwrap(), "my own\n");
    let forced = stoss(folder.path(), &[&arguments[..], &["--force"]].concat());
    assert_eq!(forced.status.code(), Some(0), "{}", stderr(&forced));
    assert!(rows(&folder.path().join("out")) > 2 && folder.path().join("out/notes.txt").exists());
    assert_eq!(stoss(folder.path(), &[&arguments[..], &["--force", "--resume"]].concat()).status.code(), Some(2));
}

fn events(output: &Output) -> Vec<Value> {
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"))).collect()
}

/// Every key of an event is in the schema, and every event has all that the schema requires.
fn assert_described(schema: &Value, event: &Value) {
    let kind = &event["event"];
    let branches = schema["oneOf"].as_array().expect("a list of events");
    let branch = branches.iter().find(|branch| branch["properties"]["event"]["const"] == *kind);
    let branch = branch.unwrap_or_else(|| panic!("{kind} is not in the schema"));
    let definition = branch["$ref"].as_str().map(|name| schema.pointer(&name[1..]).expect("a definition"));
    let known =
        |key: &str| [Some(branch), definition].into_iter().flatten().any(|table| !table["properties"][key].is_null());
    for key in event.as_object().unwrap().keys() {
        assert!(known(key), "{key} of {kind} is not in the schema");
    }
    for table in [Some(branch), definition].into_iter().flatten() {
        for key in table["required"].as_array().into_iter().flatten() {
            assert!(event.get(key.as_str().unwrap()).is_some(), "{kind} has no {key}");
        }
    }
}

#[test]
fn events_are_json_as_the_schema_says() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", FALL);
    let schema: Value = serde_json::from_slice(&stoss(folder.path(), &["schema", "--events"]).stdout).unwrap();
    let output = stoss(folder.path(), &["run", "scene.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    let list = events(&output);
    list.iter().for_each(|event| assert_described(&schema, event));
    let count = |kind: &str| list.iter().filter(|event| event["event"] == kind).count();
    assert_eq!((count("start"), count("step"), count("end"), list.len()), (1, 50, 1, 52));
    assert_eq!((&list[0]["title"], &list[50]["step"]), (&"fall".into(), &50.into()));
    let end = &list[51];
    assert_eq!(
        (&end["outcome"], &end["verdict"], &end["exit_code"]),
        (&"completed".into(), &"sound".into(), &0.into())
    );
    // Potential energy becomes kinetic energy: 1/2 m (g t)^2 with m = 2.
    assert!((list[50]["kinetic"].as_f64().unwrap() - 25.0).abs() < 1e-6, "{}", list[50]);

    write(folder.path(), "bad.toml", &FALL.replacen("density = 2.0", "density = -2.0", 1));
    let output = stoss(folder.path(), &["run", "bad.toml", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let list = events(&output);
    list.iter().for_each(|event| assert_described(&schema, event));
    assert_eq!((list.len(), &list[0]["event"], &list[0]["exit_code"]), (1, &"error".into(), &2.into()));
    assert_eq!(list[0]["problems"][0]["key"], "body[0].density");
}

/// The rows of `sweep.csv` by name of the column.
fn table(folder: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = std::fs::read_to_string(folder.join("sweep.csv")).unwrap();
    let mut lines = text.lines();
    let names: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
    // No reason in these tests has a comma outside of the last cells that are checked.
    lines.map(|line| names.iter().cloned().zip(line.split(',').map(str::to_owned)).collect()).collect()
}

fn number(row: &std::collections::BTreeMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name}: {row:?}"))
}

/// A parameter that a case leaves alone has its own value in the table.
#[test]
fn rows_of_a_sweep_have_the_values_that_were_used() {
    let folder = tempfile::tempdir().unwrap();
    let cases = "cases = [{ g = 5.0 }, { height = \"2*height\" }]";
    write(folder.path(), "fall.toml", &FALL.replace("grid = { g = [5.0, 10.0], height = [1.0, \"2*height\"] }", cases));
    let output = stoss(folder.path(), &["sweep", "fall.toml", "--collect", "--no-report"]);
    let rows = table(&folder.path().join("fall.sweep"));
    let values: Vec<[f64; 2]> = rows.iter().map(|row| ["g", "height"].map(|name| number(row, name))).collect();
    assert_eq!(values, [[5.0, 1.0], [10.0, 2.0]], "{}", stderr(&output));
}

#[test]
fn a_sweep_has_a_folder_and_a_row_for_each_case() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "fall.toml", FALL);
    let output = stoss(folder.path(), &["sweep", "fall.toml", "--jobs", "2", "--threads", "1"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = folder.path().join("fall.sweep");
    let rows = table(&out);
    assert_eq!(rows.len(), 4);
    for (row, [g, height]) in rows.iter().zip([[5.0, 1.0], [5.0, 2.0], [10.0, 1.0], [10.0, 2.0]]) {
        assert_eq!((number(row, "g"), number(row, "height")), (g, height));
        assert_eq!(
            (row["outcome"].as_str(), row["verdict"].as_str(), row["reason"].as_str()),
            ("completed", "sound", "")
        );
        assert!((number(row, "last.block.z") + g / 8.0).abs() < 1e-9, "{row:?}");
        assert!((number(row, "max.balance.kinetic") - g * g / 4.0).abs() < 1e-6, "{row:?}");
        assert!((number(row, "min.probes.block.z") + g / 8.0).abs() < 1e-9, "{row:?}");
        assert_eq!((number(row, "time"), number(row, "steps")), (0.5, 50.0));
    }
    // Nothing is left to do.
    let marks = |name: &str| std::fs::metadata(out.join(name)).unwrap().modified().unwrap();
    let before = marks("cases/0001/summary.json");
    let again = stoss(folder.path(), &["sweep", "fall.toml"]);
    assert_eq!(again.status.code(), Some(0));
    assert!(stderr(&again).contains("0 of 4 cases to run"), "{}", stderr(&again));
    assert_eq!(marks("cases/0001/summary.json"), before);
    // A value more is two cases more, and what is there already is not done again where the numbers stay.
    write(folder.path(), "fall.toml", &FALL.replacen("g = [5.0, 10.0]", "g = [5.0, 10.0, 20.0]", 1));
    let more = stoss(folder.path(), &["sweep", "fall.toml"]);
    assert!(stderr(&more).contains("2 of 6 cases to run"), "{}", stderr(&more));
    assert_eq!((marks("cases/0001/summary.json"), table(&out).len()), (before, 6));
}

/// A case that fails is a row with its reason; one whose scene is wrong as well. Others go on.
#[test]
fn failed_cases_stay_with_their_reason() {
    let folder = tempfile::tempdir().unwrap();
    let text = FALL
        .replacen(
            "grid = { g = [5.0, 10.0], height = [1.0, \"2*height\"] }",
            "cases = [{ g = 1.0 }, { stiffness = -1.0 }, { g = 1e9 }]",
            1,
        )
        .replacen(
            "[[probe]]",
            "[[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\n[[probe]]",
            1,
        )
        .replacen("integrator", "max_cuts = 1\nintegrator", 1);
    write(folder.path(), "fall.toml", &text);
    let output = stoss(folder.path(), &["sweep", "fall.toml", "--quiet", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let text = std::fs::read_to_string(folder.path().join("out/sweep.csv")).unwrap();
    let rows = table(&folder.path().join("out"));
    let outcomes: Vec<&str> = rows.iter().map(|row| row["outcome"].as_str()).collect();
    assert_eq!(outcomes, ["completed", "failed", "failed"], "{text}");
    assert!(text.lines().nth(2).unwrap().contains("body[0].material.young"), "{text}");
    assert!(rows[2]["reason"].len() > 10, "{text}");
    // They are left alone, and done again where that is wanted.
    let again = stoss(folder.path(), &["sweep", "fall.toml", "--out", "out"]);
    assert!(stderr(&again).contains("0 of 3 cases to run"), "{}", stderr(&again));
    let retried = stoss(folder.path(), &["sweep", "fall.toml", "--out", "out", "--retry"]);
    assert!(stderr(&retried).contains("2 of 3 cases to run"), "{}", stderr(&retried));
}

/// Lines for a scheduler do what the sweep does.
#[cfg(unix)]
#[test]
fn commands_are_lines_for_a_shell() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a fall.toml", FALL);
    let output = stoss(folder.path(), &["sweep", "a fall.toml", "--commands", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let lines = String::from_utf8(output.stdout).unwrap();
    assert_eq!(lines.lines().count(), 4, "{lines}");
    assert!(lines.lines().all(|line| line.starts_with("stoss run 'a fall.toml' --out out/cases/000")), "{lines}");
    let program = Path::new(env!("CARGO_BIN_EXE_stoss")).parent().unwrap().display().to_string();
    let path = format!("{program}:{}", std::env::var("PATH").unwrap());
    for line in lines.lines().take(2) {
        let status = Command::new("sh").args(["-c", line]).current_dir(folder.path()).env("PATH", &path).status();
        assert!(status.unwrap().success(), "{line}");
    }
    let collected = stoss(folder.path(), &["sweep", "a fall.toml", "--collect", "--out", "out", "--quiet"]);
    assert_eq!(collected.status.code(), Some(0), "{}", stderr(&collected));
    let outcomes: Vec<String> = table(&folder.path().join("out")).iter().map(|row| row["outcome"].clone()).collect();
    assert_eq!(outcomes, ["completed", "completed", "missing", "missing"]);
    // The rest by another program, two at once; then the table is that of a sweep.
    let rest = stoss(folder.path(), &["sweep", "a fall.toml", "--commands", "--out", "out"]).stdout;
    let mut xargs = Command::new("xargs");
    xargs.args(["-0", "-P", "2", "-I", "LINE", "sh", "-c", "LINE"]).current_dir(folder.path()).env("PATH", &path);
    let mut xargs = xargs.stdin(Stdio::piped()).spawn().unwrap();
    let lines: Vec<u8> = rest.iter().map(|&byte| if byte == b'\n' { 0 } else { byte }).collect();
    assert_eq!(lines.iter().filter(|&&byte| byte == 0).count(), 2);
    xargs.stdin.take().unwrap().write_all(&lines).unwrap();
    assert!(xargs.wait().unwrap().success());
    for arguments in [&["--collect", "--out", "out"][..], &["--out", "swept", "--threads", "1"]] {
        let output = stoss(folder.path(), &[&["sweep", "a fall.toml", "--no-report"], arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let [collected, swept] = ["out", "swept"].map(|name| {
        let mut rows = table(&folder.path().join(name));
        rows.iter_mut().for_each(|row| drop(row.remove("wall_seconds")));
        rows
    });
    assert!(collected.len() == 4 && collected == swept, "{collected:?}\n{swept:?}");
}

/// Without MPI each process would do the whole run: one of them says so.
#[cfg(not(feature = "mpi"))]
#[test]
fn processes_that_were_started_together_need_mpi() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "fall.toml", FALL);
    let of_rank = |rank: &str, arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stoss"));
        command.args(arguments).current_dir(folder.path()).stdin(Stdio::null());
        command.env("OMPI_COMM_WORLD_SIZE", "2").env("OMPI_COMM_WORLD_RANK", rank).output().expect("the program starts")
    };
    for (arguments, message) in [
        (&["run", "fall.toml"][..], "has no MPI"),
        (&["sweep", "fall.toml"], "only `stoss run`"),
        (&["rum"], "unrecognized subcommand"),
    ] {
        let [first, second] = ["0", "1"].map(|rank| of_rank(rank, arguments));
        assert!(first.status.code() == Some(2) && stderr(&first).contains(message), "{}", stderr(&first));
        assert!(second.status.success() && second.stderr.is_empty(), "{}", stderr(&second));
    }
    let output = stoss(folder.path(), &["run", "fall.toml", "--out", "one", "--quiet", "--no-report"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!folder.path().join("fall.out").exists() && !folder.path().join("fall.sweep").exists());
    write(folder.path(), "petsc.toml", &FALL.replace("[sweep]", "[solver]\nlinear = \"petsc\"\n[sweep]"));
    let output = stoss(folder.path(), &["run", "petsc.toml"]);
    let text = stderr(&output);
    assert!(output.status.code() == Some(2) && text.contains("solver.linear") && text.contains("`mpi`"), "{text}");
}

/// The sums are those of the documented formula for 27 nodes.
#[test]
fn check_estimates_what_a_rank_needs() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "fall.toml", FALL);
    let output = stoss(folder.path(), &["check", "fall.toml", "--ranks", "4"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("on 4 ranks (estimate"), "{text}");
    assert!(text.contains("57.2 MB") && text.contains("1.9 kB"), "{text}");
    assert_eq!(stoss(folder.path(), &["check", "fall.toml", "--ranks", "0"]).status.code(), Some(2));
}

/// A sweep that is interrupted leaves cases that go on from their checkpoints.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let text = FALL.replacen("end = 0.5", "end = 3.0", 1).replacen("[2, 2, 2]", "[5, 5, 5]", 1);
    write(folder.path(), "fall.toml", &text);
    let mut child = start(folder.path(), &["sweep", "fall.toml", "--out", "out", "--threads", "1"]);
    let first = folder.path().join("out/cases/0001");
    wait_until("some steps of the first case", || rows(&first) > 3);
    send(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(5));
    let interrupted = rows(&first);
    let outcomes: Vec<String> = table(&folder.path().join("out")).iter().map(|row| row["outcome"].clone()).collect();
    assert_eq!(outcomes, ["interrupted", "missing", "missing", "missing"]);
    let lines = stoss(folder.path(), &["sweep", "fall.toml", "--out", "out", "--commands"]).stdout;
    let lines = String::from_utf8(lines).unwrap();
    assert_eq!(lines.lines().filter(|line| line.contains("--resume")).count(), 1, "{lines}");
    assert_eq!(rows(&first), interrupted);
}

#[test]
fn a_new_scene_comes_from_an_example_and_replaces_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let listed = String::from_utf8(stoss(folder.path(), &["examples"]).stdout).unwrap();
    assert!(listed.lines().count() >= 10 && listed.contains("trebuchet"), "{listed}");
    let written = stoss(folder.path(), &["init", "mine", "--from", "flight"]);
    assert_eq!(written.status.code(), Some(0), "{}", stderr(&written));
    assert_eq!(stoss(folder.path(), &["check", "mine.toml"]).status.code(), Some(0));
    let text = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    let printed = String::from_utf8(stoss(folder.path(), &["examples", "flight"]).stdout).unwrap();
    assert_eq!(printed.trim_end(), text.trim_end());
    let again = stoss(folder.path(), &["init", "mine.toml"]);
    assert_eq!(again.status.code(), Some(1), "{}", stderr(&again));
    assert_eq!(std::fs::read_to_string(folder.path().join("mine.toml")).unwrap(), text);
    let unknown = stoss(folder.path(), &["init", "other", "--from", "fligth"]);
    assert!(unknown.status.code() == Some(2) && stderr(&unknown).contains("flight"), "{}", stderr(&unknown));
}

#[test]
fn shells_and_man_know_the_commands() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let output = stoss(folder.path(), &["completions", shell]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("sweep") && text.contains("resume"), "{shell}: {text}");
    }
    let page = String::from_utf8(stoss(folder.path(), &["man"]).stdout).unwrap();
    assert!(page.contains(".TH stoss 1"), "{page}");
    assert!(stoss(folder.path(), &["man", "--out", "man1"]).status.success());
    assert!(std::fs::read_to_string(folder.path().join("man1/stoss-run.1")).unwrap().contains("resume"));
}

/// A free block under a total force: momentum is force times time, and the ledger is exact. A traction of the same resultant
/// does the same.
#[test]
fn a_total_force_has_this_resultant() {
    let folder = tempfile::tempdir().unwrap();
    let load = |load: &str| {
        FALL.replacen("[gravity]\nacceleration = [0.0, 0.0, \"-g\"]\n", "", 1)
            .replacen("divisions = [2, 2, 2]", "divisions = [2, 3, 2], grading = [1.0, 3.0, 1.0]", 1)
            .replacen("[1.0, 1.0, \"height + 1\"]", "[4.0, 0.5, \"height + 1\"]", 1)
            .replacen("g = 10.0", "g = 10.0\nF = 3.0", 1)
            .replacen("g = [5.0, 10.0], ", "", 1)
            .replacen("[[probe]]", &format!("[[load]]\nset = \"block.top\"\n{load}\n\n[[probe]]"), 1)
    };
    write(folder.path(), "total.toml", &load("total_force = [0.25, 0.0, \"F\"]"));
    write(folder.path(), "traction.toml", &load("traction = [0.125, 0.0, \"F/2\"]"));
    let last = |name: &str| {
        let output = stoss(folder.path(), &["run", &format!("{name}.toml"), "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = std::fs::read_to_string(folder.path().join(format!("{name}.out/balance.csv"))).unwrap();
        let row = |line: &str| line.split(',').map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<_>>();
        (row(text.lines().nth(1).unwrap()), row(text.lines().last().unwrap()))
    };
    let (first, total) = last("total");
    // The columns lx, ly, lz. The area is two.
    for (found, force) in total[3..6].iter().zip([0.25, 0.0, 3.0]) {
        assert!((found - force * 0.5).abs() < 1e-11, "{total:?}");
    }
    assert!((total[15] - first[15]).abs() < 1e-9 * (total[9] + total[10]), "{first:?} {total:?}");
    let (_, traction) = last("traction");
    total.iter().zip(&traction).for_each(|(a, b)| assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}"));
    write(folder.path(), "bad.toml", &load("total_force = 3.0"));
    let output = stoss(folder.path(), &["check", "bad.toml"]);
    assert!(output.status.code() == Some(2) && stderr(&output).contains("load[0].total_force"), "{}", stderr(&output));
}

/// Of two bodies one is accelerated, by a function of time: its momentum is mass times the integral, the other one rests.
#[test]
fn an_acceleration_is_that_of_one_body() {
    let folder = tempfile::tempdir().unwrap();
    let text = FALL
        .replacen("[gravity]\nacceleration = [0.0, 0.0, \"-g\"]\n", "", 1)
        .replacen("g = [5.0, 10.0], ", "", 1)
        .replacen(
            "[[probe]]",
            "[[body]]\nname = \"other\"\nmesh = { generator = \"block\", size = [1, 1, 1], divisions = [1, 1, 1] }\nposition = [5, 5, 5]\n\
             material = { law = \"neo-hooke\", young = 1e4, poisson = 0.3 }\ndensity = 7.0\n\n[[load]]\nbody = \"block\"\n\
             acceleration = { table = [[0, 0, 0, 0], [0.5, 4, 0, \"-g\"]] }\n\n[[probe]]",
            1,
        );
    write(folder.path(), "scene.toml", &text);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let last = read_rows(&folder.path().join("out/balance.csv")).pop().unwrap();
    // Mass 2; a ramp of half a second, integrated exactly by the midpoint: 2 * a * 0.25.
    for (found, momentum) in last[3..6].iter().zip([2.0, 0.0, -5.0]) {
        assert!((found - momentum).abs() < 1e-10, "{last:?}");
    }
    // Kinetic energy p^2 / 2m is the work.
    assert!((last[9] - 29.0 / 4.0).abs() < 1e-9 && last[15].abs() < 1e-9, "{last:?}");
    for (from, to, key) in [
        ("body = \"block\"\nacc", "set = \"block.all\"\nacc", "load[0].set"),
        ("body = \"block\"\nacc", "body = \"blok\"\nacc", "load[0].body"),
    ] {
        assert!(text.contains(from));
        write(folder.path(), "bad.toml", &text.replacen(from, to, 1));
        let output = stoss(folder.path(), &["check", "bad.toml"]);
        assert!(output.status.code() == Some(2) && stderr(&output).contains(key), "{key}: {}", stderr(&output));
    }
}

/// The numbers of a table of results, row by row.
fn read_rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

/// A rigid motion of a block on springs and dashpots: the midpoint rule for one mass, and the damped oscillation in the limit.
#[test]
fn a_block_on_springs_and_dashpots_is_a_damped_oscillator() {
    let folder = tempfile::tempdir().unwrap();
    let text = FALL
        .replacen("[gravity]\nacceleration = [0.0, 0.0, \"-g\"]\n", "", 1)
        .replacen("g = [5.0, 10.0], ", "", 1)
        .replacen("divisions = [2, 2, 2]", "divisions = [1, 1, 1]", 1)
        .replacen("density = 2.0", "density = 2.0\nmass = \"lumped\"\nvelocity = [0.0, 0.0, 1.0]", 1)
        .replacen(
            "[[probe]]",
            "[[support]]\nset = \"block.all\"\nper = \"node\"\nstiffness = [0, 0, 30]\ndamping = [0, 0, 0.7]\n\n\
             [[probe]]\nname = \"springs\"\nset = \"block.all\"\nquantity = \"support_force\"\n\n[[probe]]",
            1,
        );
    write(folder.path(), "scene.toml", &text);
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let probes = read_rows(&folder.path().join("out/probes.csv"));
    let balance = read_rows(&folder.path().join("out/balance.csv"));
    let (m, k, d, h) = (2.0, 8.0 * 30.0, 8.0 * 0.7, 0.01);
    let (mut u, mut v, mut loss) = (0.0, 1.0, 0.0);
    let decay: f64 = d / (2.0 * m);
    let omega = f64::sqrt(k / m - decay * decay);
    for (step, (row, ledger)) in probes.iter().zip(&balance).enumerate() {
        assert!((row[7] - u).abs() < 1e-11, "step {step}: {} {u}", row[7]);
        assert!((row[4] + k * u + d * v).abs() < 1e-9, "step {step}: {}", row[4]);
        // dissipation, and the total, which stays.
        assert!((ledger[13] - loss).abs() < 1e-11 && (ledger[15] - 1.0).abs() < 1e-11, "step {step}: {ledger:?}");
        let t = h * step as f64;
        assert!((u - (-decay * t).exp() * (omega * t).sin() / omega).abs() < 1e-3);
        let mean = (2.0 * m * v / h - k * u) / (2.0 * m / h + 0.5 * k * h + d);
        (u, v, loss) = (u + h * mean, 2.0 * mean - v, loss + d * h * mean * mean);
    }
    assert_eq!(probes.len(), 51);
}

/// A column under pressure on an elastic foundation sinks by pressure over stiffness, whatever the mesh.
#[test]
fn a_foundation_yields_by_pressure_over_stiffness() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"[scene]
title = "foundation"
kind = "quasi-static"

[time]
end = 1.0
step = 0.5

[[body]]
name = "block"
mesh = { generator = "block", size = [2.0, 1.0, 1.0], divisions = [2, 3, 2], grading = [3.0, 0.5, 1.0] }
material = { law = "neo-hooke", young = 1e3, poisson = 0.0 }

[[support]]
set = "block.bottom"
stiffness = [1e3, 1e3, 2e3]
damping = [7.0, 7.0, 7.0]

[[load]]
set = "block.top"
pressure = { table = [[0.0, 0.0], [1.0, 100.0]] }

[[probe]]
name = "bottom"
set = "block.bottom"
quantity = "displacement"

[[probe]]
name = "foundation"
set = "block.bottom"
quantity = "support_force"
"#;
    write(folder.path(), "scene.toml", text);
    let checked = stoss(folder.path(), &["check", "scene.toml"]);
    let plan = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(checked.status.success() && !plan.contains("warning"), "{plan}");
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let last = read_rows(&folder.path().join("out/probes.csv")).pop().unwrap();
    assert!(last[2].abs() < 1e-9 && last[3].abs() < 1e-9 && (last[4] + 0.05).abs() < 1e-9, "{last:?}");
    // pressure times area
    assert!(last[5].abs() < 1e-7 && last[6].abs() < 1e-7 && (last[7] - 200.0).abs() < 1e-7, "{last:?}");
    for (from, to, key) in [
        ("stiffness = [1e3, 1e3, 2e3]\ndamping = [7.0, 7.0, 7.0]\n", "", "support[0].stiffness"),
        ("1e3, 1e3, 2e3", "1e3, -1e3, 2e3", "support[0].stiffness[1]"),
        ("1e3, 1e3, 2e3", "1e3", "support[0].stiffness"),
        ("set = \"block.bottom\"\nstiffness", "set = \"block.belly\"\nstiffness", "support[0].set"),
        ("damping", "per = \"volume\"\ndamping", "support[0].per"),
        ("damping", "dumping", "support[0].dumping"),
        ("\"support_force\"", "\"reaction\"", "choose `support_force`"),
    ] {
        write(folder.path(), "bad.toml", &text.replacen(from, to, 1));
        let output = stoss(folder.path(), &["check", "bad.toml"]);
        assert!(output.status.code() == Some(2) && stderr(&output).contains(key), "{key}: {}", stderr(&output));
    }
    // reactions do not have the force of the foundation
    let held = text.replacen("\"support_force\"", "\"reaction\"", 1)
        + "\n[[prescribe]]\nset = \"block.left\"\ncomponents = [\"x\"]\nfixed = true\n";
    write(folder.path(), "held.toml", &held);
    let checked = stoss(folder.path(), &["check", "held.toml"]);
    let plan = String::from_utf8_lossy(&checked.stdout).into_owned() + &stderr(&checked);
    assert!(checked.status.success() && plan.contains("`foundation`") && plan.contains("support_force"), "{plan}");
}
