//! `stoss mesh`: what is in a mesh file.

use crate::terminal::{say, tell};
use clap::Subcommand;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss::mesh_io::{self, MeshIoError};

#[derive(Subcommand)]
pub(crate) enum MeshCommand {
    /// Print the contents of a mesh file, and whether Stoss can use it (exit code 0) or not (exit code 2, with reasons).
    Info {
        /// The file (.msh, .inp, .vtu).
        file: PathBuf,
        /// Only this group of elements.
        #[arg(long, value_name = "NAME")]
        group: Option<String>,
    },
    /// Write a mesh with its sets in another format, which follows from the extension (.msh: Gmsh 4.1, .inp: Abaqus, .vtu: VTK).
    Convert {
        /// The file that is read.
        from: PathBuf,
        /// The file that is written.
        to: PathBuf,
        /// Only this group of elements.
        #[arg(long, value_name = "NAME")]
        group: Option<String>,
        /// Factor on the coordinates, for another unit of length.
        #[arg(long, default_value_t = 1.0)]
        scale: f64,
    },
}

pub(crate) fn command(command: MeshCommand) -> ExitCode {
    match command {
        MeshCommand::Info { file, group } => info(&file, group.as_deref()),
        MeshCommand::Convert { from, to, group, scale } => convert(&from, &to, group.as_deref(), scale),
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

fn convert(from: &Path, to: &Path, group: Option<&str>, scale: f64) -> ExitCode {
    if !(scale > 0.0 && scale.is_finite()) {
        say!("error: --scale {scale}: give a positive, finite factor");
        return ExitCode::from(2);
    }
    let converted = mesh_io::read_contents(from).and_then(|contents| {
        contents.notes().iter().for_each(|note| say!("note: {note}"));
        let mut mesh = contents.mesh_with_inner_facets(group)?;
        mesh.nodes.iter_mut().flatten().for_each(|x| *x *= scale);
        mesh_io::write_mesh(to, &mesh)?;
        Ok(mesh)
    });
    match converted {
        Ok(mesh) => tell(&format!("{}: {} nodes, {} elements", to.display(), mesh.nodes.len(), mesh.elements.len())),
        Err(error) => refuse(&error),
    }
}

/// Exit code 1 for a file that cannot be read or written, 2 for one whose content is wrong.
fn refuse(error: &MeshIoError) -> ExitCode {
    say!("error: {error}");
    ExitCode::from(if matches!(error, MeshIoError::Io { .. } | MeshIoError::Output { .. }) { 1 } else { 2 })
}
