//! `stoss sweep`: does the cases of a scene's `[sweep]`, some at once, each in a process of its own.

use crate::job::{INTERRUPTED, assignment, quoted};
use crate::terminal::{say, tell};
use crate::{WRONG, diagnostics, interrupt};
use clap::Args;
use std::fs::File;
use std::path::PathBuf;
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use stoss::output::OutputError;
use stoss::run::RunError;
use stoss::solver::digits;
use stoss::sweep::{Case, CaseResult, CaseState, SweepPlan, TABLE};

/// How often a running case is checked.
const LOOK: Duration = Duration::from_millis(20);

/// Options of `stoss sweep`.
#[derive(Args)]
pub struct SweepOptions {
    /// The scene (TOML), with a table `[sweep]`.
    scene: PathBuf,
    /// Folder for the cases and `sweep.csv` [default: the scene's name with `.sweep`, in the current directory].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Number of cases that run at the same time.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Threads of each case [default: all cores, shared by the cases that run at the same time].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Set a parameter that the sweep does not vary to another value; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    /// Also run the cases again that failed.
    #[arg(long)]
    retry: bool,
    /// Run nothing: print the command line of each case that is not done, for a scheduler.
    #[arg(long)]
    commands: bool,
    /// Write no page that compares the cases (`report.html` in the folder of the sweep).
    #[arg(long)]
    no_report: bool,
    /// Run nothing: write `sweep.csv` and the page from what is there.
    #[arg(long, conflicts_with = "commands")]
    collect: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Does the sweep.
pub fn sweep(options: SweepOptions) -> ExitCode {
    let plan = match SweepPlan::read(&options.scene, &options.set) {
        Ok(plan) => plan,
        Err(error) => {
            match &error {
                RunError::Scene(problems) => diagnostics::print(&options.scene, problems),
                error => say!("error: {error}"),
            }
            return ExitCode::from(if matches!(error, RunError::Read { .. }) { 1 } else { 2 });
        }
    };
    let stem = options.scene.file_stem().map_or_else(|| "run".into(), |s| s.to_string_lossy().into_owned());
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.sweep")));
    let jobs = usize::from(options.jobs);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = options.threads.map_or((cores / jobs).max(1), usize::from);
    let pending: Vec<&Case> = plan
        .cases()
        .iter()
        .filter(|case| match plan.state(&out, case) {
            CaseState::New | CaseState::Begun => true,
            CaseState::Failed => options.retry,
            CaseState::Done => false,
        })
        .collect();
    let sweep = Running { plan: &plan, out, threads, quiet: options.quiet, stop: Arc::default() };
    let done = if options.commands {
        return sweep.print_commands(&pending);
    } else if options.collect {
        Ok(())
    } else {
        sweep.run(&pending, jobs)
    };
    match done.and_then(|()| plan.collect(&sweep.out)) {
        Ok(results) => {
            let has_page = !options.no_report && sweep.write_page(&results);
            sweep.finish(&results, has_page)
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}

struct Running<'a> {
    plan: &'a SweepPlan,
    out: PathBuf,
    threads: usize,
    quiet: bool,
    stop: Arc<AtomicBool>,
}

impl Running<'_> {
    fn command(&self, case: &Case) -> Vec<String> {
        let mut words = self.plan.command(&self.out, case);
        words.extend(["--threads".to_owned(), self.threads.to_string()]);
        words
    }

    fn print_commands(&self, pending: &[&Case]) -> ExitCode {
        let mut lines = Vec::new();
        for case in pending {
            let words = self.command(case);
            if let Err(error) = self.plan.begin(&self.out, case) {
                say!("error: {error}");
                return ExitCode::from(1);
            }
            let words: Vec<String> =
                std::iter::once("stoss".to_owned()).chain(words).map(|word| quoted(&word)).collect();
            lines.push(format!(
                "{} --quiet 2> {}",
                words.join(" "),
                quoted(&case.log(&self.out).display().to_string())
            ));
        }
        if lines.is_empty() { ExitCode::SUCCESS } else { tell(&lines.join("\n")) }
    }

    fn run(&self, pending: &[&Case], jobs: usize) -> Result<(), OutputError> {
        if !self.quiet {
            let (all, left) = (self.plan.cases().len(), pending.len());
            say!("{left} of {all} cases to run, {jobs} at once, results in {}", self.out.display());
        }
        let raised = || say!("interrupted: the running cases end after their current step, and no other case begins");
        if let Err(error) = interrupt::watch(&self.stop, raised) {
            say!("warning: Ctrl-C will end the sweep at once: {error}");
        }
        let next = AtomicUsize::new(0);
        let failure = Mutex::new(None);
        std::thread::scope(|scope| {
            for _ in 0..jobs.min(pending.len()) {
                scope.spawn(|| {
                    while !self.stop.load(Ordering::Relaxed) {
                        let Some(case) = pending.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                        // One writes the table at a time; the lock is poisoned only by a panic, after which nothing more is begun.
                        let ended = self.run_case(case);
                        let Ok(mut failure) = failure.lock() else { break };
                        match ended.and_then(|code| self.report(case, code)) {
                            Ok(()) => {}
                            Err(error) => {
                                self.stop.store(true, Ordering::Relaxed);
                                *failure = Some(error);
                            }
                        }
                    }
                });
            }
        });
        match failure.into_inner() {
            Ok(Some(error)) => Err(error),
            _ => Ok(()),
        }
    }

    fn run_case(&self, case: &Case) -> Result<ExitStatus, OutputError> {
        let words = self.command(case);
        self.plan.begin(&self.out, case)?;
        let path = case.log(&self.out);
        let io = |source| OutputError::Io { path: path.clone(), source };
        let log = File::create(&path).map_err(io)?;
        let program = std::env::current_exe().map_err(io)?;
        let mut command = Command::new(program);
        command.args(words).arg("--quiet").stdin(Stdio::null()).stdout(Stdio::null()).stderr(log);
        let mut child = start(&mut command).map_err(io)?;
        let mut told = false;
        loop {
            if let Some(status) = child.try_wait().map_err(io)? {
                return Ok(status);
            }
            if !told && self.stop.load(Ordering::Relaxed) {
                end_after_step(&child);
                told = true;
            }
            std::thread::sleep(LOOK);
        }
    }

    /// Writes the table again and says how a case ended.
    fn report(&self, case: &Case, status: ExitStatus) -> Result<(), OutputError> {
        let results = self.plan.collect(&self.out)?;
        let Some(result) = results.get(case.number - 1).filter(|_| !self.quiet) else { return Ok(()) };
        let reason = match (result.reason.as_str(), status.code()) {
            ("", None) => format!(": {status}"),
            ("", _) => String::new(),
            (reason, _) => format!(": {reason}"),
        };
        let verdict = match (result.verdict.as_str(), result.outcome, result.time) {
            ("", ..) => String::new(),
            (verdict, "completed", _) | (verdict, _, None) => format!(", {verdict}"),
            (verdict, _, Some(time)) => format!(" ({verdict} up to t = {})", digits(time)),
        };
        say!("case {} of {}  {}  {}{verdict}{reason}", case.number, results.len(), case.label(), result.outcome);
        Ok(())
    }

    /// Writes the page that compares the cases; a page that cannot be written does not make the results worse.
    fn write_page(&self, results: &[CaseResult]) -> bool {
        if results.iter().all(|result| result.steps.is_none()) {
            return false;
        }
        match stoss_report::page::write(&[self.out.as_path()]) {
            Ok(notes) => {
                notes.iter().filter(|_| !self.quiet).for_each(|note| say!("warning: {note}"));
                true
            }
            Err(error) => {
                say!("warning: report.html could not be written: {error}");
                false
            }
        }
    }

    fn finish(&self, results: &[CaseResult], has_page: bool) -> ExitCode {
        let count = |outcome: &str| results.iter().filter(|result| result.outcome == outcome).count();
        let (completed, failed) = (count("completed"), count("failed"));
        // The watch may have stopped a case that is wrong; that of a failed one is a verdict on a part of it.
        let judged = |verdict: &str| {
            results.iter().filter(|result| result.verdict == verdict && result.outcome != "failed").count()
        };
        let (wrong, doubtful) = (judged("wrong"), judged("doubtful"));
        if !self.quiet {
            let table = self.out.join(TABLE);
            let rest = results.len() - completed - failed;
            let doubts = if doubtful > 0 { format!(", {doubtful} doubtful") } else { String::new() };
            say!(
                "{completed} completed ({wrong} wrong{doubts}), {failed} failed, {rest} not done: {}",
                table.display()
            );
            if has_page {
                say!("page: {}", self.out.join(stoss_report::page::NAME).display());
            }
        }
        ExitCode::from(match () {
            () if self.stop.load(Ordering::Relaxed) => INTERRUPTED,
            () if failed > 0 => 3,
            () if wrong > 0 => WRONG,
            () => 0,
        })
    }
}

/// Starts a case in a process group of its own: Ctrl-C of the terminal must reach it once, through the sweep.
fn start(command: &mut Command) -> std::io::Result<Child> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    command.spawn()
}

/// Asks a case to end after its present step.
#[cfg(unix)]
fn end_after_step(child: &Child) {
    if let Some(id) = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw) {
        // It may have ended by itself.
        let _ = rustix::process::kill_process(id, rustix::process::Signal::TERM);
    }
}

/// Ctrl-C has reached it already.
#[cfg(not(unix))]
fn end_after_step(_: &Child) {}
