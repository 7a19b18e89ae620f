//! `stoss import`: a scene from an Abaqus or CalculiX deck.

use crate::diagnostics;
use crate::job::quoted;
use crate::terminal::{say, tell};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss::deck_import::{self, FileNames, ImportError, Severity};
use stoss::mesh_io::{self, MeshIoError, deck};
use stoss::run::{RunError, RunOptions, check_scene_for};

#[derive(Args)]
pub(crate) struct Import {
    /// The deck (.inp). Files that it includes are read too.
    deck: PathBuf,
    /// The scene to write [default: the deck's name with .toml]. Where the deck has no names for sets that the scene needs, a mesh with them is written next to it.
    #[arg(short, long, value_name = "SCENE")]
    out: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
}

/// The folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// How the scene calls the deck: by its name if both are in one folder, else by its whole path.
fn name_of(deck: &Path, scene: &Path) -> std::io::Result<String> {
    let whole = deck.canonicalize()?;
    let is_beside =
        folder(scene).canonicalize().is_ok_and(|own| folder(deck).canonicalize().is_ok_and(|other| own == other));
    let name = deck.file_name().filter(|_| is_beside).map(Path::new);
    Ok(name.unwrap_or(&whole).to_string_lossy().into_owned())
}

pub(crate) fn import(asked: &Import) -> ExitCode {
    match write(asked) {
        Ok(code) => code,
        Err((message, code)) => {
            say!("error: {message}");
            ExitCode::from(code)
        }
    }
}

fn of_mesh(error: &MeshIoError) -> (String, u8) {
    let is_file = matches!(error, MeshIoError::Io { .. } | MeshIoError::Output { .. });
    (error.to_string(), if is_file { 1 } else { 2 })
}

fn write(asked: &Import) -> Result<ExitCode, (String, u8)> {
    let Import { deck: from, out, force } = asked;
    let scene = out.clone().unwrap_or_else(|| from.with_extension("toml"));
    let mesh = scene.with_extension("mesh.inp");
    let deck = deck::read_deck(from).map_err(|error| of_mesh(&error))?;
    let name = name_of(from, &scene).map_err(|error| (format!("{}: {error}", from.display()), 1))?;
    let mesh_name = mesh.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let made =
        deck_import::import(&deck, &FileNames { deck: name, mesh: mesh_name }).map_err(|error| match &error {
            ImportError::Mesh(inner) => of_mesh(inner),
            ImportError::NoBody { .. } => (error.to_string(), 2),
        })?;
    let written = [Some(&scene), made.mesh.as_ref().map(|_| &mesh)];
    for path in written.into_iter().flatten() {
        let is_deck = path.canonicalize().is_ok_and(|own| from.canonicalize().is_ok_and(|deck| own == deck));
        if is_deck {
            return Err((format!("{} is the deck: choose another name with -o", path.display()), 2));
        }
        if path.exists() && !force {
            return Err((
                format!("{} exists: choose another name with -o, or replace it with --force", path.display()),
                1,
            ));
        }
    }
    if let Some(content) = &made.mesh {
        mesh_io::write_mesh(&mesh, content).map_err(|error| of_mesh(&error))?;
    }
    std::fs::write(&scene, &made.scene).map_err(|error| (format!("{}: {error}", scene.display()), 1))?;
    report(&scene, made.mesh.as_ref().map(|_| mesh.as_path()), &made);
    match check_scene_for(&scene, &RunOptions::default()) {
        Ok(plan) => {
            let plan = plan.to_string();
            // What is left out stands above.
            let warnings = plan.lines().map(str::trim_start).filter(|line| line.starts_with("warning: "));
            let is_repeated = |line: &&str| made.left_out.iter().any(|entry| line.contains(&entry.text()));
            warnings.filter(|line| !is_repeated(line)).for_each(|line| say!("{line}"));
            let word = quoted(&scene.display().to_string());
            Ok(tell(&format!("next: stoss check {word}\n      stoss run {word}")))
        }
        Err(RunError::Scene(problems)) => {
            diagnostics::print(&scene, &problems);
            Err((format!("the scene is written, but it cannot run as it is: correct {}", scene.display()), 2))
        }
        Err(error) => Err((error.to_string(), 1)),
    }
}

/// Says what was written, mapped and left out.
fn report(scene: &Path, mesh: Option<&Path>, made: &deck_import::Import) {
    let beside = mesh.map_or(String::new(), |mesh| format!(" and {}", quoted(&mesh.display().to_string())));
    let mut lines = vec![format!("{}{beside}:", quoted(&scene.display().to_string()))];
    lines.extend(made.mapped.iter().map(|line| format!("  {line}")));
    for severity in Severity::ALL {
        let own: Vec<_> = made.left_out.iter().filter(|entry| entry.severity == severity).collect();
        if own.is_empty() {
            continue;
        }
        lines.push(match severity {
            Severity::Missing => "missing, so that the verdict of a run is at best doubtful:".to_owned(),
            Severity::Changed => "not as in the deck:".to_owned(),
            Severity::Note => "notes:".to_owned(),
        });
        lines.extend(own.iter().map(|entry| format!("  {entry}")));
    }
    let _ = tell(&lines.join("\n"));
}
