//! `stoss report`, and the page that a run leaves.

use crate::terminal::{say, tell};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Writes the page of these runs, with warnings about what it has to leave out; returns its file.
pub fn write(folders: &[&Path]) -> stoss_report::Outcome<PathBuf> {
    for note in stoss_report::page::write(folders)? {
        say!("warning: {note}");
    }
    Ok(folders[0].join(stoss_report::page::NAME))
}

/// Carries out `stoss report`.
pub fn report(folders: &[PathBuf]) -> ExitCode {
    let folders: Vec<&Path> = folders.iter().map(PathBuf::as_path).filter(|path| !is_beside_a_case(path)).collect();
    if folders.is_empty() {
        say!("error: no folder of results is named");
        return ExitCode::from(2);
    }
    match write(&folders) {
        Ok(page) => tell(&page.display().to_string()),
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}

/// What `SWEEP/cases/*` has beside the folders of the cases.
fn is_beside_a_case(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    path.is_file() && matches!(ending, Some("json" | "log")) && path.with_extension("").is_dir()
}
