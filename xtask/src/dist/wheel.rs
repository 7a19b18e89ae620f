//! The wheel of the Python package, where maturin is installed: built with optimisation across crates, and tried.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::workspace::{Outcome, Workspace, capture, show};

/// The scene of the archive's trial, from the repository, as far as that goes.
const TRIAL: &str =
    "import stoss; print(stoss.__version__, stoss.run('scenes/two-blocks.toml', until=0.01, out=OUT).outcome)";

/// Builds the wheel into `folder`; nothing but a note where there is no maturin.
pub fn build(workspace: &Workspace, folder: &Path) -> Outcome<()> {
    if capture(workspace.process("maturin").arg("--version")).is_err() {
        println!("dist: no wheel of the Python package: maturin is not installed (`pip install maturin`)");
        return Ok(());
    }
    // What an earlier commit left would be taken for this one's.
    let wheels = folder.join("wheel");
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels)?;
    }
    let mut command = workspace.process("maturin");
    command.args(["build", "--release", "--locked", "--out"]).arg(&wheels);
    command.env("CARGO_PROFILE_RELEASE_LTO", "thin").env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "4");
    if !command.status()?.success() {
        return Err(format!("`{}` failed", show(&command)).into());
    }
    let wheel = only_file(&wheels)?;
    println!("dist: wrote {} ({} kB)", wheel.display(), std::fs::metadata(&wheel)?.len() / 1000);
    try_it(workspace, &wheel, &wheels.join("trial"))
}

fn only_file(folder: &Path) -> Outcome<PathBuf> {
    let files: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    match files.as_slice() {
        [wheel] => Ok(wheel.clone()),
        files => {
            Err(format!("{}: one wheel was expected, and there are {} files", folder.display(), files.len()).into())
        }
    }
}

/// Unpacks the wheel and runs a scene with it, if the system's Python has numpy.
fn try_it(workspace: &Workspace, wheel: &Path, folder: &Path) -> Outcome<()> {
    if capture(Command::new("python3").args(["-c", "import numpy"])).is_err() {
        println!("dist: the wheel is not tried: python3 has no numpy");
        return Ok(());
    }
    capture(Command::new("python3").args(["-m", "zipfile", "-e"]).arg(wheel).arg(folder))?;
    let program = TRIAL.replace("OUT", &format!("{:?}", folder.join("out").display().to_string()));
    let told = capture(workspace.process("python3").args(["-c", &program]).env("PYTHONPATH", folder))?;
    std::fs::remove_dir_all(folder)?;
    println!("dist: the wheel runs a scene: stoss {}", told.trim());
    Ok(())
}
