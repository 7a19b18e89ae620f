//! `stoss follow`: keeps the page of a run up to date while it runs.

use crate::interrupt;
use crate::terminal::{say, tell_line};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use stoss_report::folder::Folder;
use stoss_report::page::{Follower, NAME};

/// How long a run that has just been started may take until there is something to show.
const PATIENCE: Duration = Duration::from_secs(10);

/// How often Ctrl-C is looked for.
const LOOK: Duration = Duration::from_millis(50);

/// The pause between two pages is at least so many times what the last one took: the run shall have the processor.
const PAUSE: u32 = 5;

/// What `stoss follow` is asked for.
#[derive(clap::Args)]
pub struct Follow {
    /// The folder of results of a run that is still running.
    out: PathBuf,
    /// Seconds from one page to the next.
    #[arg(long, value_name = "S", default_value_t = 5.0, value_parser = seconds)]
    interval: f64,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.5..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "give a number of seconds from 0.5 to 3600".to_owned())
}

/// Carries out `stoss follow`.
pub fn follow(asked: &Follow) -> ExitCode {
    let stop = Arc::new(AtomicBool::new(false));
    if let Err(error) = interrupt::watch(&stop, || {}) {
        say!("warning: Ctrl-C cannot be handled, so that the page will go on reloading after it: {error}");
    }
    match write(&asked.out, Duration::from_secs_f64(asked.interval), &stop) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(1)
        }
    }
}

fn write(out: &Path, interval: Duration, stop: &AtomicBool) -> stoss_report::Outcome<()> {
    let began = Instant::now();
    let may_come = || began.elapsed() < PATIENCE || stoss::output::is_in_use(out);
    while Folder::open(out).is_err() && may_come() && !stop.load(Ordering::Relaxed) {
        std::thread::sleep(LOOK);
    }
    let mut page = Follower::default();
    let mut was_told = false;
    loop {
        // First: what a run wrote before it ended is then on the last page.
        let goes_on = stoss::output::is_in_use(out) && !stop.load(Ordering::Relaxed);
        let start = Instant::now();
        let notes = match page.write(out, goes_on.then_some(interval.as_secs_f64())) {
            // A run that starts again removes what was there.
            Err(_) if goes_on && was_told => Vec::new(),
            result => result?,
        };
        if !was_told {
            tell_line(&out.join(NAME).display().to_string());
            was_told = true;
        }
        if !goes_on {
            for note in notes {
                say!("warning: {note}");
            }
            return Ok(());
        }
        let next = Instant::now() + interval.max(PAUSE * start.elapsed());
        while Instant::now() < next && !stop.load(Ordering::Relaxed) && stoss::output::is_in_use(out) {
            std::thread::sleep(LOOK);
        }
    }
}
