//! Chores of the workspace: `cargo xtask <command>`.
//!
//! `schema`, `gallery` and the suites of `verify` that measure scenes run the program `stoss` and read the files that it
//! leaves; the suites that measure a crate (`tangents`, `multibody`) call it. Which crates those are is in `layers.toml`.

mod bench;
mod circles;
mod dist;
mod layers;
mod modules;
mod reference;
mod reuse;
mod same;
mod schema;
mod slow;
mod tidy;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use stoss_verification::{RandomRange, Selection, gallery, manifest, program, workspace};
use workspace::{Outcome, Workspace};

/// Chores of the workspace.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    /// The program `stoss` to run; without it, it is built in the release profile.
    #[arg(long, global = true)]
    program: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compares every crate's normal dependencies with layers.toml and docs/layers.md, and finds circles between modules.
    Layers {
        /// Writes docs/layers.md instead of comparing it.
        #[arg(long)]
        bless: bool,
    },
    /// Builds each reusable crate alone and compares its dependency list with docs/reuse/.
    Reuse {
        /// Writes the lists instead of comparing them.
        #[arg(long)]
        bless: bool,
    },
    /// Checks the habits that no compiler checks.
    Tidy,
    /// Writes docs/scene.schema.json and docs/guide/reference.md from `stoss schema`.
    Schema {
        /// Compares instead of writing.
        #[arg(long)]
        check: bool,
    },
    /// Runs the verification suites and writes target/verify/report.html and report.json.
    Verify {
        /// Shortens long scenes.
        #[arg(long)]
        quick: bool,
        /// First seed of the suite `random`.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Number of scenes of the suite `random`.
        #[arg(long, default_value_t = 30)]
        count: u64,
        /// A problem of the suite `work-precision`, mostly one; all if none is given.
        #[arg(long = "problem")]
        problems: Vec<String>,
        /// Names of suites; all if none is given.
        suites: Vec<String>,
    },
    /// Runs scenes with another program too and compares every table and the last frame byte by byte.
    Same {
        /// The other program `stoss`, mostly that of the commit before.
        other: PathBuf,
        /// Steps of the size that a scene gives; 0: to the end of each scene.
        #[arg(long, default_value_t = 20)]
        steps: u32,
        /// Files, folders, or names of shipped scenes; all shipped scenes if none is given.
        scenes: Vec<String>,
    },
    /// Measures CPU time and memory of works against another program, in turn, and prints a table.
    Bench {
        /// A commit, whose program is built, or a program `stoss`.
        other: String,
        /// Pairs of runs of each work.
        #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
        pairs: u32,
        /// Threads of each run.
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
        threads: u32,
        /// Names of works, or files of scenes; all works if none is given.
        works: Vec<String>,
    },
    /// Draws docs/gallery/ from the runs of the shipped scenes.
    Gallery {
        /// One picture only.
        scene: Option<String>,
    },
    /// Runs all tests and lists the slowest ones and the slowest programs of tests.
    Slow {
        /// What `cargo xtask slow` has written before, by default target/slow/tests.log: nothing is run.
        #[arg(long)]
        log: Option<PathBuf>,
    },
    /// Runs a program of tests so that it tells the duration of each; cargo calls it for `slow`.
    #[command(hide = true)]
    Timed {
        /// The program and its arguments.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        words: Vec<OsString>,
    },
    /// Writes the archive of a release into target/dist and tries it.
    Dist,
}

fn dispatch(arguments: Arguments) -> Outcome<ExitCode> {
    if let Command::Timed { words } = arguments.command {
        return slow::timed(words);
    }
    let workspace = Workspace { program: arguments.program, ..Workspace::find()? };
    let passed = match arguments.command {
        Command::Layers { bless } => layers::command(&workspace, bless),
        Command::Reuse { bless } => reuse::command(&workspace, bless),
        Command::Tidy => tidy::command(&workspace),
        Command::Schema { check } => schema::command(&workspace, check),
        Command::Verify { quick, seed, count, problems, suites } => {
            let random = RandomRange { seed, count };
            stoss_verification::verify(&workspace, Selection { suites, quick, random, problems })
        }
        Command::Same { other, steps, scenes } => same::command(&workspace, &same::Comparison { other, steps, scenes }),
        Command::Bench { other, pairs, threads, works } => {
            bench::command(&workspace, &bench::Bench { other, pairs, threads, works })
        }
        Command::Dist => dist::command(&workspace),
        Command::Gallery { scene } => gallery::command(&workspace, scene.as_deref()),
        Command::Slow { log } => slow::command(&workspace, log),
        Command::Timed { .. } => Ok(true),
    };
    Ok(if passed? { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn main() -> ExitCode {
    match dispatch(Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}
