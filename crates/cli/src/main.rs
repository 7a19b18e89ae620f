//! The program `stoss`: runs scenes, checks them, prints the scene format's schema.
//!
//! Exit codes: 0 done; 1 files could not be read or written; 2 the scene, a mesh file or the command line is wrong; 3 the
//! simulation stopped early (all completed steps are kept); 4 the run reached its end, but the watch found its result wrong;
//! 5 Ctrl-C or SIGTERM ended the run after a step.

mod diagnose;
mod diagnostics;
mod examples;
mod fit;
mod follow;
mod import;
mod interrupt;
mod job;
mod mesh;
mod page;
mod picture;
mod progress;
mod ranks;
mod shell;
mod sweep;
mod table;
mod terminal;
mod values;
mod view;

use clap::{CommandFactory, Parser, Subcommand};
use ranks::Launched;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss::output::Outcome;
use stoss::run::{RunError, RunOptions, Summary};
use terminal::{say, tell};

/// Large-deformation contact elastodynamics.
#[derive(Parser)]
#[command(name = "stoss", version, about = "Large-deformation contact elastodynamics", long_about = None)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene and write a folder of results.
    Run(job::Job),
    /// Write a page for a browser, `report.html`, into the first of these folders: the run as an animation, its charts and its verdict. Several
    /// runs are compared, and so are the cases of a sweep.
    Report {
        /// Folders of results, or the folder of a sweep.
        #[arg(required = true)]
        out: Vec<PathBuf>,
    },
    /// Keep the page of a run up to date while it runs; a browser that shows the page reloads it. Ends with the run, or with Ctrl-C.
    Follow(follow::Follow),
    /// Draw a frame of a run as an SVG or PNG file, or all frames as a GIF file; needs no display.
    Picture(picture::Picture),
    /// Write values of a frame along a line or on a plane section as a table (CSV).
    Values(values::Values),
    /// Print columns of a table of a run: by default its probes, with first, last, smallest and largest value.
    Table(table::Table),
    /// Run a scene for all values of its parameters that its table `[sweep]` gives.
    Sweep(sweep::SweepOptions),
    /// Report all problems of a scene, or the plan of its run.
    Check {
        /// The scene (TOML).
        scene: PathBuf,
        /// Set a parameter of the scene to another value; may be given several times.
        #[arg(long, value_name = "NAME=VALUE", value_parser = job::assignment)]
        set: Vec<(String, String)>,
        /// Also estimate the memory that a run on N ranks would need, and the bytes that a rank would receive.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
        ranks: Option<u32>,
    },
    /// Write a page for a browser that shows a scene before its run: bodies, surfaces of contacts with their gaps, supports, loads, joints and sets with their names.
    View(view::View),
    /// Judge the stored frames and balances of a run: penetration, inverted elements, nodes that passed through a body, drift of momenta and energy.
    Judge {
        /// A folder of results.
        out: PathBuf,
    },
    /// Print why a run stopped, or why its result is wrong, where, and what to try; write a page with pictures of the place, `diagnosis.html`, into its folder.
    Diagnose {
        /// A folder of results.
        out: PathBuf,
    },
    /// Check mesh files, and convert them.
    Mesh {
        #[command(subcommand)]
        command: mesh::MeshCommand,
    },
    /// Find the parameters of material laws from measured curves.
    Fit(fit::Asked),
    /// Write a scene from an Abaqus or CalculiX deck (.inp), with a list of what is left out or changed.
    Import(import::Import),
    /// Write a new scene, taken from an example.
    Init {
        /// Name of the scene: NAME.toml is written, unless such a file exists.
        name: PathBuf,
        /// Name of the example; `stoss examples` lists them [default: two-blocks].
        #[arg(long, value_name = "EXAMPLE")]
        from: Option<String>,
    },
    /// List the scenes that come with the program, or print one.
    Examples {
        /// Name of an example.
        name: Option<String>,
    },
    /// Print completions for a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page.
    Man {
        /// Write the pages of the program and of all its commands into this folder instead.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Print the JSON schema of the scene format, or of the events of a run.
    Schema {
        /// Print the schema of the events that `stoss run --json` prints.
        #[arg(long)]
        events: bool,
    },
}

fn main() -> ExitCode {
    let launched = Launched::here();
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(_) if !launched.is_first() => return ranks::SILENT,
        Err(error) => error.exit(),
    };
    match command {
        Command::Run(job) => job::run(job, launched),
        _ if !launched.is_first() => ranks::SILENT,
        _ if !launched.is_alone() => {
            say!(
                "error: only `stoss run` is done by several processes together: start other commands without a launcher"
            );
            ExitCode::from(2)
        }
        Command::Sweep(options) => sweep::sweep(options),
        Command::Report { out } => page::report(&out),
        Command::Follow(asked) => follow::follow(&asked),
        Command::Picture(asked) => picture::write(asked),
        Command::Values(asked) => values::write(asked),
        Command::Table(asked) => table::print(&asked),
        Command::Check { scene, set, ranks } => check(&scene, set, ranks),
        Command::View(asked) => view::view(&asked),
        Command::Judge { out } => judge(&out),
        Command::Diagnose { out } => diagnose::diagnose(&out),
        Command::Mesh { command } => mesh::command(command),
        Command::Fit(asked) => fit::run(&asked),
        Command::Import(asked) => import::import(&asked),
        Command::Init { name, from } => examples::init(&name, from.as_deref()),
        Command::Examples { name } => examples::examples(name.as_deref()),
        Command::Completions { shell } => shell::completions(shell, Arguments::command()),
        Command::Man { out } => shell::manual(out.as_deref(), Arguments::command()),
        Command::Schema { events: true } => tell(&stoss::events::json_schema()),
        Command::Schema { events: false } => tell(&stoss::scene::json_schema()),
    }
}

/// Exit code of a run whose result the watch found wrong.
pub(crate) const WRONG: u8 = 4;

fn judge(out: &Path) -> ExitCode {
    match stoss::run::judge_folder(out) {
        Ok(verdict) => {
            // The outcome is another thing than the verdict on what is stored.
            let ended =
                Summary::read(out).ok().map(|summary| summary.outcome).filter(|ended| *ended != Outcome::Completed);
            let ended = ended.map(|ended| format!("outcome: {ended}\n")).unwrap_or_default();
            let told = tell(&format!("{ended}{verdict}"));
            if verdict.level == stoss::watch::Severity::Wrong { ExitCode::from(WRONG) } else { told }
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}

fn check(path: &Path, set: Vec<(String, String)>, ranks: Option<u32>) -> ExitCode {
    match stoss::run::check_scene_for(path, &RunOptions { set, ..RunOptions::default() }) {
        Ok(plan) => {
            let of_ranks = ranks.map(|ranks| format!("\n{}", plan.on_ranks(ranks))).unwrap_or_default();
            tell(&format!("{plan}{of_ranks}"))
        }
        Err(error) => refused(path, &error),
    }
}

/// Says why a scene cannot be used.
pub(crate) fn refused(path: &Path, error: &RunError) -> ExitCode {
    match error {
        RunError::Scene(problems) => {
            diagnostics::print(path, problems);
            ExitCode::from(2)
        }
        RunError::Encoding { .. } => {
            say!("error: {error}");
            ExitCode::from(2)
        }
        _ => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}
