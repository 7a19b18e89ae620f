//! `cargo xtask slow`: runs every test of the workspace and tells which tests and which programs of tests take longest.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use crate::workspace::{Outcome, Workspace, read, write};

/// Number of tests, and of programs of tests, that are listed.
const LISTED: usize = 10;

/// Lines of the log that are shown of a failure.
const SHOWN: usize = 200;

/// What a line with the duration of a program begins with.
const PROGRAM: &str = "program of tests: ";

/// What a log of `cargo test` says of durations.
#[derive(Debug, Default, PartialEq)]
struct Times {
    /// Seconds and name of each test that passed.
    tests: Vec<(f64, String)>,
    /// Seconds, package and name of each program of tests.
    programs: Vec<(f64, String)>,
}

/// Runs all tests, each with its time, or reads the log of an earlier run; false if a test fails.
pub fn command(workspace: &Workspace, log: Option<PathBuf>) -> Outcome<bool> {
    let (log, passed) = match log {
        Some(log) => (log, true),
        None => {
            let log = workspace.target()?.join("slow/tests.log");
            write(&log, "")?;
            let passed = test(workspace, &log)?;
            (log, passed)
        }
    };
    let text = read(&log)?;
    if !passed {
        let told: Vec<&str> = text.lines().filter(|line| seconds_of_test(line).is_none()).collect();
        told.iter().skip(told.len().saturating_sub(SHOWN)).for_each(|line| println!("{line}"));
        println!("slow: a test failed; all is in {}", log.display());
        return Ok(false);
    }
    text.lines().filter(|line| line.starts_with("test result")).for_each(|line| println!("{line}"));
    let times = times(&text);
    let all: f64 = times.programs.iter().map(|(seconds, _)| seconds).sum();
    println!("slow: {} tests passed in {} programs, {all:.0} s", times.tests.len(), times.programs.len());
    list("tests", times.tests);
    list("programs of tests", times.programs);
    Ok(true)
}

/// `cargo test --workspace`, all of its words in `log`. Each program of tests is called by [`timed`]: the flag that asks for the times is one of libtest's
/// unstable ones, which cargo does not pass on.
fn test(workspace: &Workspace, log: &Path) -> Outcome<bool> {
    let own = std::env::current_exe()?;
    let runner = format!("target.'cfg(all())'.runner=[{:?}, \"timed\"]", own.to_string_lossy());
    let words = File::create(log)?;
    let mut cargo = workspace.cargo();
    cargo.args(["test", "--workspace", "--config", &runner]);
    Ok(cargo.stdout(words.try_clone()?).stderr(words).status()?.success())
}

/// Runs a program of tests, which tells the duration of each, and tells its own.
pub fn timed(mut words: Vec<OsString>) -> Outcome<ExitCode> {
    let program = if words.is_empty() { return Err("no program of tests".into()) } else { words.remove(0) };
    let start = Instant::now();
    let mut run = Command::new(&program);
    run.args(words).args(["-Zunstable-options", "--report-time"]).env("RUSTC_BOOTSTRAP", "1");
    let status = run.status()?;
    let package = std::env::var("CARGO_PKG_NAME").unwrap_or_default();
    let name = Path::new(&program).file_name().unwrap_or_default().to_string_lossy();
    println!("{PROGRAM}{package} {name}: {:.1} s", start.elapsed().as_secs_f64());
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Prints the longest of what took some time.
fn list(what: &str, mut times: Vec<(f64, String)>) {
    times.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("\nten slowest {what}:");
    times.iter().take(LISTED).for_each(|(seconds, name)| println!("{seconds:.1} s  {name}"));
}

/// Name and seconds of a line `test NAME ... ok <1.234s>`.
fn seconds_of_test(line: &str) -> Option<(f64, String)> {
    let (name, rest) = line.strip_prefix("test ")?.split_once(" ... ok <")?;
    Some((rest.strip_suffix("s>")?.parse().ok()?, name.to_owned()))
}

/// Reads the log of a run.
fn times(log: &str) -> Times {
    let mut times = Times::default();
    for line in log.lines() {
        times.tests.extend(seconds_of_test(line));
        let program = line.strip_prefix(PROGRAM).and_then(|rest| rest.strip_suffix(" s")?.rsplit_once(": "));
        times.programs.extend(program.and_then(|(name, seconds)| Some((seconds.parse().ok()?, name.to_owned()))));
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_from_a_log() {
        let log = "     Running tests/all.rs (target/debug/deps/all-01)\n\nrunning 3 tests\ntest mesh::a ... ok <1.250s>\n\
                   test mesh::b ... FAILED <9.000s>\ntest c ... ok\n\ntest result: ok. 2 passed; finished in 10.26s\n\n\
                   program of tests: stoss-mesh all-01: 10.3 s\n";
        let found = times(log);
        assert_eq!(found.tests, [(1.25, "mesh::a".to_owned())]);
        assert_eq!(found.programs, [(10.3, "stoss-mesh all-01".to_owned())]);
        assert_eq!(times(""), Times::default());
    }
}
