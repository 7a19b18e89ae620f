//! Columns of the tables of a run, of several runs and of a sweep.

use std::path::Path;
use std::process::{Command, Output, Stdio};

const SCENE: &str = "[scene]\ntitle = \"pull\"\nkind = \"quasi-static\"\nunits = \"mm-t-s\"\n[parameters]\nforce = 2.0\n[time]\nend = 1.0\nstep = 0.25\n\
    [[body]]\nname = \"bar\"\nmesh = { generator = \"block\", min = [0, 0, 0], max = [2, 1, 1], divisions = [2, 1, 1] }\n\
    material = { law = \"neo-hooke\", young = 100.0, poisson = 0.3 }\n\
    [[prescribe]]\nset = \"bar.left\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
    [[load]]\nset = \"bar.right\"\ntotal_force = { table = [[0, 0, 0, 0], [1, \"force\", 0, 0]] }\n\
    [[probe]]\nname = \"end-face\"\nset = \"bar.right\"\nquantity = \"displacement\"\n\
    [[probe]]\nname = \"pull\"\nset = \"bar.left\"\nquantity = \"reaction\"\n[sweep]\ngrid = { force = [1.0, 2.0] }\n";

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_stoss");
    Command::new(program).args(arguments).current_dir(folder).stdin(Stdio::null()).output().expect("the program starts")
}

/// Standard output of a command that succeeds.
fn table(folder: &Path, arguments: &[&str]) -> String {
    let output = stoss(folder, &[&["table"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

#[test]
fn columns_of_runs_and_sweeps_are_printed() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    std::fs::write(folder.join("pull.toml"), SCENE).unwrap();
    assert!(stoss(folder, &["run", "pull.toml", "--no-report", "--quiet"]).status.success());
    assert!(
        stoss(folder, &["run", "pull.toml", "--no-report", "--quiet", "--set", "force=4", "--out", "four"])
            .status
            .success()
    );

    // No table of the run is replaced.
    for file in ["pull.out/probes.csv", "pull.out/balance.csv"] {
        let before = std::fs::read(folder.join(file)).unwrap();
        let output = stoss(folder, &["table", "pull.out", "-o", file]);
        assert_eq!(output.status.code(), Some(2), "{file}");
        assert_eq!(std::fs::read(folder.join(file)).unwrap(), before);
    }

    // The overview of the probes has their units, and extrema with their times.
    let overview = table(folder, &["pull.out"]);
    let lines: Vec<&str> = overview.lines().collect();
    assert_eq!(words(lines[0]), ["column", "unit", "first", "last", "min", "at", "time", "max", "at", "time"]);
    let pull = words(lines.iter().find(|line| line.starts_with("pull.x")).unwrap());
    assert_eq!(pull, ["pull.x", "N", "0", "-2", "-2", "1", "0", "0"], "{overview}");

    // Rows and formulas of them; a name with a minus sign is a name.
    let rows = table(
        folder,
        &["pull.out", "--columns", "time", "push = -pull.x", "change(push)", "2 * end-face.y - end-face.y"],
    );
    let rows: Vec<Vec<&str>> = rows.lines().skip(1).map(words).collect();
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[0][..3], ["0", "0", "-"]);
    assert_eq!(rows[4][..3], ["1", "2", "0.5"], "{rows:?}");
    let chosen = table(folder, &["pull.out", "--from", "0.25", "--every", "2", "--columns", "time"]);
    assert_eq!(words(&chosen), ["time", "0.25", "0.75"]);

    // Several runs; other tables; all digits.
    let last = table(folder, &["pull.out", "four", "--last", "--columns", "step", "pull.x"]);
    assert_eq!(words(&last), ["table", "step", "pull.x", "pull.out", "4", "-2", "four", "4", "-4"], "{last}");
    let csv = table(folder, &["pull.out/balance.csv", "--last", "--csv", "--columns", "step", "strain"]);
    let written = std::fs::read_to_string(folder.join("pull.out/balance.csv")).unwrap();
    let strain = written.lines().last().unwrap().split(',').nth(10).unwrap();
    assert_eq!(csv, format!("step,strain\n4e0,{strain}\n"));
    table(folder, &["pull.out", "-o", "copy.csv"]);
    let copy = std::fs::read_to_string(folder.join("copy.csv")).unwrap();
    assert_eq!(copy.lines().count(), 6, "{copy}");

    // The folder of a sweep stands for its table.
    assert!(stoss(folder, &["sweep", "pull.toml", "--no-report", "--quiet"]).status.success());
    let sweep = table(folder, &["pull.sweep", "--columns", "force", "verdict", "last.pull.x"]);
    assert_eq!(words(&sweep), ["force", "verdict", "last.pull.x", "1", "sound", "-1", "2", "sound", "-2"], "{sweep}");
}

#[test]
fn what_is_not_there_is_named() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    std::fs::write(folder.join("t.csv"), "step,ball.z,name\n0,1e0,a\n").unwrap();
    for (arguments, code, says) in [
        (&["t.csv", "--columns", "bal.z"][..], 2, "did you mean `ball.z`"),
        (&["t.csv", "--columns", "2 * name"], 2, "`name` has words"),
        (&["t.csv", "--from", "1", "--columns", "step"], 2, "need a column `time`"),
        (&["t.csv", "--last"], 2, "name --columns"),
        (&["missing.csv"], 1, "missing.csv"),
        (&["."], 2, "name one of its tables: ./t.csv"),
    ] {
        let output = stoss(folder, &[&["table"], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && error.contains(says), "{arguments:?}: {error}");
    }
    std::fs::remove_file(folder.join("t.csv")).unwrap();
    assert_eq!(stoss(folder, &["table", "."]).status.code(), Some(1));
}
