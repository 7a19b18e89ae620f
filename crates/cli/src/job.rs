//! `stoss run`: one scene into one folder, with progress for people or events for programs.

use crate::progress::Progress;
use crate::ranks::{self, Launched};
use crate::terminal::{say, tell_line};
use crate::{WRONG, diagnose, diagnostics, interrupt, page};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Instant;
use stoss::events::EventRecord;
use stoss::output::{Outcome, Overwrite};
use stoss::run::{Event, RunError, RunOptions, Summary};
use stoss::solver::digits;
use stoss::watch::Severity;

/// Exit code of a run that Ctrl-C or SIGTERM has ended after a step.
pub const INTERRUPTED: u8 = 5;

/// Options of `stoss run`.
#[derive(Args)]
pub struct Job {
    /// The scene (TOML).
    scene: PathBuf,
    /// Folder for the results [default: the scene's name with `.out`, in the current directory].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Set a parameter of the scene to another value; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    /// Threads for element loops; the results do not depend on it [default: all cores; one for each of several processes that `mpirun` has started].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Stop after the first step that reaches this time, before the scene's end.
    #[arg(long)]
    until: Option<f64>,
    /// Continue from the checkpoint in the folder.
    #[arg(long)]
    resume: bool,
    /// Start a new run even if it replaces files in the folder that Stoss did not write.
    #[arg(long, conflicts_with = "resume")]
    force: bool,
    /// Write the first N linear systems that are factorised as Matrix Market files, into the folder `systems` of the results.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    systems: u32,
    /// Do not write the report for a browser (`report.html` in the folder) at the end.
    #[arg(long)]
    no_report: bool,
    /// Print the events of the run on standard output as JSON, one object a line, and only errors on standard error (see `stoss schema --events`).
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(long)]
    quiet: bool,
}

/// `name=value`.
pub fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write a parameter and its value, for instance radius=0.5".to_owned()),
    }
}

/// `scenes/ball-plate.toml` -> `ball-plate.out`.
fn default_folder(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().map_or_else(|| "run".into(), |s| s.to_string_lossy().into_owned());
    PathBuf::from(format!("{stem}.out"))
}

/// Where events go.
struct Listener {
    progress: Progress,
    json: bool,
    /// Why the run stopped or its result is wrong, shown at the end.
    diagnosis: Option<String>,
}

impl Listener {
    fn tell(&self, record: Option<EventRecord>) {
        if let Some(record) = record.filter(|_| self.json) {
            tell_line(&record.to_line());
        }
    }

    fn show(&mut self, event: &Event<'_>) {
        self.tell(EventRecord::of(event));
        if let Event::Diagnosis(diagnosis) = event {
            self.diagnosis = Some(diagnosis.to_string());
        }
        self.progress.show(event);
    }

    fn finish(&mut self, summary: &Summary, out: &Path, code: u8) {
        self.tell(Some(EventRecord::end(summary, out, code)));
        self.progress.finish(summary);
    }

    fn fail(&mut self, error: &RunError, code: u8) {
        self.tell(Some(EventRecord::error(error, code)));
        self.progress.abandon();
    }
}

/// Runs the scene, on all ranks that were started together.
pub fn run(job: Job, launched: Launched) -> ExitCode {
    let ranks = match launched.ranks() {
        Ok(ranks) => ranks,
        Err(_) if !launched.is_first() => return ranks::SILENT,
        Err(error) => {
            say!("error: {error}");
            return ExitCode::from(2);
        }
    };
    // Ranks have a core each.
    let threads = job.threads.or((ranks.count() > 1).then_some(1));
    if let Some(threads) = threads
        && let Err(error) = stoss::run::set_threads(usize::from(threads))
    {
        if ranks.is_first() {
            say!("error: {error}");
        }
        return ranks::end(&ranks, 1);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let options = RunOptions {
        out: job.out.clone().unwrap_or_else(|| default_folder(&job.scene)),
        until: job.until,
        resume: job.resume,
        systems: job.systems,
        overwrite: if job.force { Overwrite::Any } else { Overwrite::Own },
        set: job.set.clone(),
        ranks: ranks.clone(),
        stop,
        ..RunOptions::default()
    };
    let code = if ranks.is_first() { lead(&job, &options) } else { follow(&job, &options) };
    ranks::end(&ranks, code)
}

/// Runs the scene beside the rank that writes and speaks.
fn follow(job: &Job, options: &RunOptions) -> u8 {
    // What it cannot catch, and how the run ends, the first rank tells.
    let _ = interrupt::watch(&options.stop, || {});
    let _ = stoss::run::run_scene(&job.scene, options, &mut |_| {});
    0
}

/// Runs the scene, with its folder, progress and messages.
fn lead(job: &Job, options: &RunOptions) -> u8 {
    let out = &options.out;
    let quiet = job.quiet || job.json;
    let listener = Arc::new(Mutex::new(Listener { progress: Progress::new(quiet), json: job.json, diagnosis: None }));
    let raised = {
        let listener = Arc::clone(&listener);
        move || {
            if let Ok(listener) = listener.lock() {
                listener.tell(Some(EventRecord::Interrupting));
                listener
                    .progress
                    .note("interrupted: the run ends after the current step; press Ctrl-C again to end it at once");
            }
        }
    };
    if let Err(error) = interrupt::watch(&options.stop, raised) {
        say!("warning: Ctrl-C will end the run at once, without a checkpoint: {error}");
    }
    let result = stoss::run::run_scene(&job.scene, options, &mut |event| {
        if let Ok(mut listener) = listener.lock() {
            listener.show(&event);
        }
    });
    // The lock is poisoned only by a panic of the thread that says that the run was interrupted.
    let mut listener = listener.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if matches!(result, Ok(_) | Err(RunError::Simulation { .. })) && !job.no_report {
        listener.progress.abandon();
        // A page is no part of the results: without it the run is as good.
        let began = Instant::now();
        let page = page::write(&[out]);
        let told = Summary::add_page_seconds(out, began.elapsed().as_secs_f64());
        told.unwrap_or_else(|error| say!("warning: {error}"));
        match page {
            Ok(page) if !quiet => say!("page: {}", page.display()),
            Ok(_) => {}
            Err(error) => say!("warning: report.html could not be written: {error}"),
        }
    }
    let diagnosis = listener.diagnosis.take();
    let page = diagnosis.as_ref().and_then(|_| diagnose::page(out));
    let tell_diagnosis = || {
        if let Some(diagnosis) = diagnosis.as_ref().filter(|_| !quiet) {
            say!("{diagnosis}");
            page.iter().for_each(|page| say!("  more:   {page}"));
        }
    };
    match result {
        Ok(summary) => {
            let code = code_of(&summary);
            listener.finish(&summary, out, code);
            if quiet && summary.is_fault() {
                say!("{}: {}", summary.outcome.judged(summary.time), summary.verdict);
            }
            tell_diagnosis();
            if let Outcome::Interrupted { last_step, last_time } = summary.outcome {
                let time = digits(last_time);
                say!("interrupted after step {last_step} at t = {time}; the checkpoint is in {}", out.display());
                say!("continue with: {}", resume_command(job, out));
            }
            code
        }
        Err(error) => {
            let code = code_of_error(&error);
            listener.fail(&error, code);
            match &error {
                RunError::Scene(problems) => diagnostics::print(&job.scene, problems),
                error => say!("error: {error}"),
            }
            if let RunError::Simulation { last_step, last_time, verdict, .. } = &error
                && (!quiet || verdict.level == Severity::Wrong)
            {
                say!("outcome: failed after step {last_step} at t = {}", digits(*last_time));
                say!("verdict up to step {last_step}: {verdict}");
            }
            tell_diagnosis();
            code
        }
    }
}

fn code_of_error(error: &RunError) -> u8 {
    match error {
        RunError::Scene(_) | RunError::Option(_) | RunError::Encoding { .. } => 2,
        RunError::Simulation { .. } => 3,
        _ => 1,
    }
}

fn code_of(summary: &Summary) -> u8 {
    match summary.outcome {
        Outcome::Interrupted { .. } => INTERRUPTED,
        _ if summary.is_fault() => WRONG,
        _ => 0,
    }
}

/// The command line that continues a run.
fn resume_command(job: &Job, out: &Path) -> String {
    let mut words = vec!["stoss".to_owned(), "run".to_owned(), job.scene.display().to_string()];
    words.extend(["--out".to_owned(), out.display().to_string()]);
    for (name, value) in &job.set {
        words.extend(["--set".to_owned(), format!("{name}={value}")]);
    }
    if let Some(until) = job.until {
        words.extend(["--until".to_owned(), until.to_string()]);
    }
    words.push("--resume".to_owned());
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell reads it back.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::{assignment, quoted};

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("a/b-1.toml"), "a/b-1.toml");
        assert_eq!(quoted("two words"), "'two words'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn assignments_have_two_sides() {
        assert_eq!(assignment("radius = 2*0.5"), Ok(("radius".into(), "2*0.5".into())));
        for wrong in ["radius", "=1", "radius=", ""] {
            assert!(assignment(wrong).is_err(), "{wrong}");
        }
    }
}
