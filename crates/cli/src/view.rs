//! `stoss view`: a page of a scene before its run.

use crate::job;
use crate::terminal::{say, tell};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss::run::RunOptions;

/// What `stoss view` is asked for.
#[derive(clap::Args)]
pub struct View {
    /// The scene (TOML).
    scene: PathBuf,
    /// The page [default: the scene's name with `.view.html`, in the current directory].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Set a parameter of the scene to another value; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = job::assignment)]
    set: Vec<(String, String)>,
}

/// Carries out `stoss view`.
pub fn view(asked: &View) -> ExitCode {
    let name = asked.scene.file_stem().unwrap_or_default().to_string_lossy();
    let page = asked.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.view.html")));
    let options = RunOptions { set: asked.set.clone(), ..RunOptions::default() };
    // What the page is made of is in nobody's way.
    let folder = std::env::temp_dir().join(format!("stoss-view-{}", std::process::id()));
    let code = written(&asked.scene, &options, &folder, &page);
    // A scene that was refused has left no folder.
    if let Err(error) = std::fs::remove_dir_all(&folder)
        && folder.exists()
    {
        say!("warning: {}: {error}", folder.display());
    }
    code
}

fn written(scene: &Path, options: &RunOptions, folder: &Path, page: &Path) -> ExitCode {
    if let Err(error) = stoss::setup::write(scene, options, folder) {
        return crate::refused(scene, &error);
    }
    match stoss_report::page::write_as(folder, page) {
        Ok(notes) => {
            for note in notes {
                say!("warning: {note}");
            }
            tell(&page.display().to_string())
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}
