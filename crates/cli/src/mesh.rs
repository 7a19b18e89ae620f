//! `stoss mesh`: what is in a mesh file.

use crate::terminal::{say, tell};
use clap::Subcommand;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss::mesh_io::{self, MeshIoError};

#[derive(Subcommand)]
pub(crate) enum MeshCommand {
    /// Tells what is in a mesh file, and whether Stoss can use it (exit code 0) or not (2, with reasons).
    Info {
        /// The file (.msh, .inp, .vtu).
        file: PathBuf,
        /// Look at this group of elements only.
        #[arg(long, value_name = "NAME")]
        group: Option<String>,
    },
}

pub(crate) fn command(command: MeshCommand) -> ExitCode {
    match command {
        MeshCommand::Info { file, group } => info(&file, group.as_deref()),
    }
}

fn info(file: &Path, group: Option<&str>) -> ExitCode {
    let contents = match mesh_io::read_contents(file) {
        Ok(contents) => contents,
        Err(error) => return refuse(&error),
    };
    let survey = contents.survey(group);
    let told = tell(&survey.to_string());
    if survey.reasons.is_empty() { told } else { ExitCode::from(2) }
}

/// A file that cannot be opened is another matter than one that is wrong.
fn refuse(error: &MeshIoError) -> ExitCode {
    say!("error: {error}");
    ExitCode::from(if matches!(error, MeshIoError::Io { .. } | MeshIoError::Output { .. }) { 1 } else { 2 })
}
