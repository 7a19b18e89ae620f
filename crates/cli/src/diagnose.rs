//! `stoss diagnose`, and the page that a run leaves which stopped or whose result is wrong.

use crate::terminal::{say, tell};
use std::path::Path;
use std::process::ExitCode;
use stoss::diagnosis::Diagnosis;

/// Writes the page of a folder; its name in words, or a warning.
pub fn page(out: &Path) -> Option<String> {
    match stoss_report::diagnosis::write(out) {
        Ok(page) => page.map(|page| page.display().to_string()),
        Err(error) => {
            say!("warning: diagnosis.html could not be written: {error}");
            None
        }
    }
}

/// Carries out the command.
pub fn diagnose(out: &Path) -> ExitCode {
    match Diagnosis::read(out) {
        Ok(Some(diagnosis)) => {
            let details = page(out).map(|page| format!("\n  more:   {page}")).unwrap_or_default();
            tell(&format!("{diagnosis}{details}"))
        }
        Ok(None) if out.join("summary.json").is_file() => tell(
            "nothing to diagnose: the run did not stop with an error, and the watch found nothing whose cause is known",
        ),
        Ok(None) => {
            say!("error: {}: no results of a run (no summary.json)", out.display());
            ExitCode::from(1)
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}
