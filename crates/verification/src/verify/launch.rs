//! Runs the program with a time limit: a hang is a result too.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

use super::{Bench, Run};
use crate::program::Ending;
use crate::workspace::{Outcome, read, write};

/// Far more than any of these scenes needs.
const LIMIT: Duration = Duration::from_secs(120);

/// Time between two checks at a running program.
const PAUSE: Duration = Duration::from_millis(2);

/// How a run ended and what it said.
#[derive(Clone, Debug)]
pub struct Launched {
    /// The run; its exit code is missing if it was stopped or killed by a signal.
    pub run: Run,
    /// True if the time limit stopped it.
    pub hung: bool,
    /// Everything that the program said.
    pub log: String,
}

/// Writes a scene with the files that it refers to into a folder below that of `verify`, and runs it there.
pub fn launch(bench: &Bench, home: &str, name: &str, scene: &str, files: &[(String, String)]) -> Outcome<Launched> {
    launch_within(bench, home, name, scene, files, LIMIT)
}

/// Writes and runs a scene as [`launch`], with another time limit.
pub fn launch_within(
    bench: &Bench,
    home: &str,
    name: &str,
    scene: &str,
    files: &[(String, String)],
    limit: Duration,
) -> Outcome<Launched> {
    let place = bench.folder.join(home);
    let path = place.join(format!("{name}.toml"));
    write(&path, scene)?;
    for (file, text) in files {
        write(&place.join(file), text)?;
    }
    let folder = place.join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    let log = place.join(format!("{name}.log"));
    let program = bench.program()?;
    let (ending, hung) = run(bench, program.executable(), &path, &folder, &log, limit)?;
    bench.count(&format!("{home}/{name}"), ending);
    let run = Run { name: name.to_owned(), folder, ending, until: None };
    Ok(Launched { run, hung, log: read(&log)? })
}

fn run(
    bench: &Bench,
    program: &Path,
    scene: &Path,
    out: &PathBuf,
    log: &Path,
    limit: Duration,
) -> Outcome<(Ending, bool)> {
    let words = File::create(log)?;
    let mut command = bench.workspace.process(program);
    command.arg("run").arg(scene).arg("--out").arg(out).args(["--threads", "1", "--quiet"]);
    command.stdin(Stdio::null()).stdout(words.try_clone()?).stderr(words);
    let start = Instant::now();
    let mut child = command.spawn()?;
    loop {
        let seconds = start.elapsed().as_secs_f64();
        if let Some(status) = child.try_wait()? {
            return Ok((Ending { code: status.code(), seconds }, false));
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok((Ending { code: None, seconds }, true));
        }
        std::thread::sleep(PAUSE);
    }
}
