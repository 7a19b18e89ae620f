//! Building and running the program `stoss`.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Instant;

use crate::workspace::{Outcome, Workspace, capture, show, write};

/// The built program.
#[derive(Clone, Debug)]
pub struct Program {
    workspace: Workspace,
    executable: PathBuf,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ending {
    /// Exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl Program {
    /// [`Workspace::program`], or `stoss-cli` built in the release profile.
    pub fn build(workspace: &Workspace) -> Outcome<Self> {
        if let Some(program) = &workspace.program {
            let executable = std::path::absolute(program)?;
            if !executable.is_file() {
                return Err(format!("there is no program {}", executable.display()).into());
            }
            return Ok(Self { workspace: workspace.clone(), executable });
        }
        let status = workspace.cargo().args(["build", "--release", "--quiet", "-p", "stoss-cli"]).status()?;
        if !status.success() {
            return Err("the program `stoss` does not build".into());
        }
        let name = format!("stoss{}", std::env::consts::EXE_SUFFIX);
        let executable = workspace.target()?.join("release").join(name);
        Ok(Self { workspace: workspace.clone(), executable })
    }

    /// Path of the executable.
    pub fn executable(&self) -> &Path {
        &self.executable
    }

    /// Standard output of `stoss schema`.
    pub fn schema(&self) -> Outcome<String> {
        capture(self.workspace.process(&self.executable).arg("schema"))
    }

    /// Runs a scene into `out` (emptied before); what the program says goes to `out` with the extension `.log`.
    pub fn run(&self, scene: &Path, out: &Path, until: Option<f64>) -> Outcome<Ending> {
        if out.exists() {
            std::fs::remove_dir_all(out)?;
        }
        let mut command = self.workspace.process(&self.executable);
        command.arg("run").arg(scene).arg("--out").arg(out);
        if let Some(until) = until {
            command.arg("--until").arg(until.to_string());
        }
        let start = Instant::now();
        let output = command.stdin(Stdio::null()).output().map_err(|error| format!("{}: {error}", show(&command)))?;
        let seconds = start.elapsed().as_secs_f64();
        let log = [output.stdout, output.stderr].concat();
        write(&out.with_extension("log"), &String::from_utf8_lossy(&log))?;
        Ok(Ending { code: output.status.code(), seconds })
    }

    /// Draws a frame of a run with `stoss picture`; `arguments` are its options.
    pub fn picture(&self, folder: &Path, file: &Path, arguments: &[&str]) -> Outcome<()> {
        let mut command = self.workspace.process(&self.executable);
        capture(command.arg("picture").arg(folder).arg(file).args(arguments)).map(|_| ())
    }
}
