//! The program `stoss`: runs scenes, checks them, prints the scene format's schema.
//!
//! Exit codes: 0 done; 1 files could not be read or written; 2 the scene, a mesh file or the command line is wrong; 3 the
//! simulation stopped early (all completed steps are kept); 4 the run went on, but the watch found its result wrong.

mod diagnostics;
mod mesh;
mod progress;
mod terminal;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss::run::{RunError, RunOptions};
use terminal::{say, tell};

/// Large-deformation contact elastodynamics.
#[derive(Parser)]
#[command(version, about, long_about = None)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs a scene and writes a folder of results.
    Run {
        /// The scene (TOML).
        scene: PathBuf,
        /// Folder for the results [default: the scene's name with `.out`, in the present folder].
        #[arg(long)]
        out: Option<PathBuf>,
        /// Threads for element loops; the results do not depend on it [default: all cores].
        #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: Option<u16>,
        /// Stop with the first step that reaches this time, before the scene's end.
        #[arg(long)]
        until: Option<f64>,
        /// Continue from the checkpoint in the folder.
        #[arg(long)]
        resume: bool,
        /// Write the first N linear systems that are factorised into the folder `systems` of the results, as Matrix Market files.
        #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
        systems: u32,
        /// Write no page for a browser at the end (`report.html` in the folder).
        #[arg(long)]
        no_report: bool,
        /// Print nothing but errors.
        #[arg(long)]
        quiet: bool,
    },
    /// Writes a page for a browser, `report.html`, into the first of these folders: the run as an animation, its charts and its verdict. Several
    /// runs are compared.
    Report {
        /// Folders of results.
        #[arg(required = true)]
        out: Vec<PathBuf>,
    },
    /// Reports all problems of a scene, or the plan of its run.
    Check {
        /// The scene (TOML).
        scene: PathBuf,
    },
    /// Judges the stored frames of a run: bodies inside each other, bad elements, anything that passed through a body.
    Judge {
        /// A folder of results.
        out: PathBuf,
    },
    /// Looks at mesh files.
    Mesh {
        #[command(subcommand)]
        command: mesh::MeshCommand,
    },
    /// Prints the JSON schema of the scene format.
    Schema,
}

fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::Run { scene, out, threads, until, resume, systems, no_report, quiet } => {
            if let Some(threads) = threads
                && let Err(error) = stoss::run::set_threads(usize::from(threads))
            {
                say!("error: {error}");
                return ExitCode::from(1);
            }
            let out = out.unwrap_or_else(|| default_folder(&scene));
            let options = RunOptions { out, until, resume, systems, ..RunOptions::default() };
            run(&scene, options, Talk { quiet, report: !no_report })
        }
        Command::Report { out } => report(&out),
        Command::Check { scene } => check(&scene),
        Command::Judge { out } => judge(&out),
        Command::Mesh { command } => mesh::command(command),
        Command::Schema => tell(&stoss::scene::json_schema()),
    }
}

/// Exit code of a run whose result the watch found wrong.
const WRONG: u8 = 4;

fn judge(out: &Path) -> ExitCode {
    match stoss::run::judge_folder(out) {
        Ok(verdict) => {
            let told = tell(&verdict.to_string());
            if verdict.level == stoss::watch::Level::Wrong { ExitCode::from(WRONG) } else { told }
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}

/// `scenes/ball-plate.toml` -> `ball-plate.out`.
fn default_folder(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().map_or_else(|| "run".into(), |s| s.to_string_lossy().into_owned());
    PathBuf::from(format!("{stem}.out"))
}

/// What a run says and leaves beside its results.
#[derive(Clone, Copy)]
struct Talk {
    quiet: bool,
    /// Whether it ends with a page.
    report: bool,
}

fn run(path: &Path, options: RunOptions, talk: Talk) -> ExitCode {
    let mut progress = progress::Progress::new(talk.quiet);
    let result = stoss::run::run_scene(path, &options, &mut |event| progress.show(&event));
    let has_results = matches!(result, Ok(_) | Err(RunError::Simulation { .. }));
    if has_results && talk.report {
        progress.abandon();
        // A page is no part of the results: without it the run is as good.
        match page(&[&options.out]) {
            Ok(page) if !talk.quiet => say!("page: {}", page.display()),
            Ok(_) => {}
            Err(error) => say!("warning: no page: {error}"),
        }
    }
    match result {
        Ok(summary) => {
            progress.finish(&summary);
            if talk.quiet && summary.is_fault() {
                say!("{}", summary.verdict);
            }
            if summary.is_fault() { ExitCode::from(WRONG) } else { ExitCode::SUCCESS }
        }
        Err(RunError::Scene(problems)) => {
            diagnostics::print(path, &problems);
            ExitCode::from(2)
        }
        Err(error @ (RunError::Option(_) | RunError::Encoding { .. })) => {
            say!("error: {error}");
            ExitCode::from(2)
        }
        Err(error) => {
            progress.abandon();
            say!("error: {error}");
            ExitCode::from(if has_results { 3 } else { 1 })
        }
    }
}

/// Writes the page of these runs, with warnings about what it has to leave out; returns its file.
fn page(folders: &[&Path]) -> stoss_report::Outcome<PathBuf> {
    for note in stoss_report::page::write(folders)? {
        say!("warning: {note}");
    }
    Ok(folders[0].join(stoss_report::page::NAME))
}

fn report(folders: &[PathBuf]) -> ExitCode {
    let folders: Vec<&Path> = folders.iter().map(PathBuf::as_path).collect();
    match page(&folders) {
        Ok(page) => tell(&page.display().to_string()),
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}

fn check(path: &Path) -> ExitCode {
    match stoss::run::check_scene(path) {
        Ok(plan) => tell(&plan.to_string()),
        Err(RunError::Scene(problems)) => {
            diagnostics::print(path, &problems);
            ExitCode::from(2)
        }
        Err(error @ RunError::Encoding { .. }) => {
            say!("error: {error}");
            ExitCode::from(2)
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}
