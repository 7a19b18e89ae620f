//! Progress: a bar on a terminal, otherwise one line a step.

use crate::terminal::say;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use stoss::output::Watched;
use stoss::run::{Event, Summary};
use stoss::solver::{DecisionKind, digits, short};

/// Shows the events of a run.
pub struct Progress {
    quiet: bool,
    terminal: bool,
    bar: Option<ProgressBar>,
}

/// The worst drift and the deepest penetration so far.
fn worst(watched: &Watched) -> String {
    let drift = watched.drift.map(|(name, drift)| format!("  drift {drift:.1e} ({name})")).unwrap_or_default();
    let depth = watched.relative_depth;
    if depth > 0.0 { format!("{drift}  depth {depth:.3} edges") } else { drift }
}

/// Words of a decision on the step, for the terminal.
fn words(kind: DecisionKind) -> &'static str {
    match kind {
        DecisionKind::Cut => "cutback",
        DecisionKind::Grow => "step size grows",
        DecisionKind::Shrink => "next step size halved",
        DecisionKind::Restart => "step started again",
        DecisionKind::Smoothed => "contact smoothed",
        DecisionKind::Warning => "warning",
        DecisionKind::Stage => "stage",
        DecisionKind::Release => "release",
    }
}

impl Progress {
    /// The progress of a run; it shows nothing if `quiet`.
    pub fn new(quiet: bool) -> Self {
        Self { quiet, terminal: std::io::stderr().is_terminal(), bar: None }
    }

    /// Shows one event.
    pub fn show(&mut self, event: &Event<'_>) {
        if self.quiet {
            return;
        }
        match event {
            Event::Start { title, out, end, step, resumed } => {
                let verb = if *resumed { "resuming" } else { "running" };
                let (end, step) = (digits(*end), digits(*step));
                say!("{verb} \"{title}\" to t = {end} in steps of {step}, results in {}", out.display());
                if self.terminal {
                    let bar = ProgressBar::new(1000);
                    if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3}% {msg} [{elapsed} < {eta}]")
                    {
                        bar.set_style(style);
                    }
                    self.bar = Some(bar);
                }
            }
            Event::Step { record, end, extent, watched } => {
                let active = record.contact.as_ref().map_or(0, |c| c.active);
                let line = format!(
                    "step {:5}  t = {:<10}  Newton {:2}  contacts {active:4}{}",
                    record.step,
                    short(record.time, record.dt),
                    record.iterations,
                    worst(watched)
                );
                match &self.bar {
                    Some(bar) => {
                        bar.set_position((1000.0 * record.time / end).clamp(0.0, 1000.0) as u64);
                        bar.set_message(line);
                    }
                    None => say!("{line}  energy {:.10e}", record.balance.total() / extent),
                }
                for decision in &record.decisions {
                    let time = short(decision.time, decision.dt);
                    let text = format!("  {} at t = {time}: {}", words(decision.kind), decision.reason);
                    match &self.bar {
                        Some(bar) => bar.println(text),
                        None => say!("{text}"),
                    }
                }
            }
            Event::Warning(text) => say!("warning: {text}"),
            _ => {}
        }
    }

    /// Prints a line, above the bar if there is one.
    pub fn note(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => say!("{text}"),
        }
    }

    /// Removes the bar and prints the outcome.
    pub fn finish(&mut self, summary: &Summary) {
        self.abandon();
        if !self.quiet {
            say!("{summary}");
        }
    }

    /// Removes the bar.
    pub fn abandon(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
