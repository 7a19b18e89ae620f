//! Origin of a report: of what source, when and on what machine it was made. What cannot be found out is left open, not guessed.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

use crate::workspace::{Workspace, capture};

/// Source, time and machine of a report; `None` for what is not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Origin {
    /// Commit of the repository.
    pub commit: Option<String>,
    /// Whether files differ from the commit.
    pub modified: Option<bool>,
    /// UTC, `2026-11-21T19:08:39Z`.
    pub date: Option<String>,
    /// Operating system and architecture.
    pub system: String,
    /// Processor, as Linux names it.
    pub processor: Option<String>,
    /// Cores that the process may use.
    pub cores: Option<usize>,
    /// Version of the compiler.
    pub rustc: Option<String>,
}

impl Origin {
    /// Asks git, the clock, the system and the compiler.
    pub fn find(workspace: &Workspace) -> Self {
        let commit = commit(workspace);
        let status = || capture(workspace.process("git").args(["status", "--porcelain"])).ok();
        let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let version = capture(workspace.process(compiler).arg("--version")).ok();
        let since = SystemTime::now().duration_since(UNIX_EPOCH).ok();
        Self {
            modified: commit.as_ref().and_then(|_| status()).map(|text| !text.trim().is_empty()),
            commit,
            date: since.map(|time| date(time.as_secs())),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            processor: std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| processor(&text)),
            cores: std::thread::available_parallelism().ok().map(usize::from),
            rustc: version.map(|text| text.trim().to_owned()),
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let commit = self.commit.as_ref().map(|commit| {
            let changed = if self.modified == Some(true) { ", with changes" } else { "" };
            format!("commit {}{changed}", commit.get(..12).unwrap_or(commit))
        });
        let cores = self.cores.map(|cores| format!("{cores} cores"));
        let parts =
            [commit, self.date.clone(), self.processor.clone(), cores, Some(self.system.clone()), self.rustc.clone()];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

/// The commit, if the workspace itself is a repository: one further up is of something else.
fn commit(workspace: &Workspace) -> Option<String> {
    let ask = |what: &[&str]| capture(workspace.process("git").arg("rev-parse").args(what)).ok();
    let top = ask(&["--show-toplevel"])?;
    let same = Path::new(top.trim_end()).canonicalize().ok()? == workspace.root.canonicalize().ok()?;
    let commit = ask(&["--verify", "HEAD"])?.trim().to_owned();
    (same && !commit.is_empty()).then_some(commit)
}

/// Model names of `/proc/cpuinfo`, each once.
fn processor(text: &str) -> Option<String> {
    let mut names: Vec<&str> = Vec::new();
    for line in text.lines() {
        if let Some((key, name)) = line.split_once(':')
            && key.trim() == "model name"
            && !name.trim().is_empty()
            && !names.contains(&name.trim())
        {
            names.push(name.trim());
        }
    }
    (!names.is_empty()).then(|| names.join(", "))
}

/// Date and time of seconds since the beginning of 1970, UTC, in the Gregorian calendar.
fn date(seconds: u64) -> String {
    let (mut days, time) = (seconds / 86_400, seconds % 86_400);
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while month < 11 && days >= lengths[month] {
        days -= lengths[month];
        month += 1;
    }
    let [hour, minute, second] = [time / 3600, time / 60 % 60, time % 60];
    format!("{year:04}-{:02}-{:02}T{hour:02}:{minute:02}:{second:02}Z", month + 1, days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let known = [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_000_000_000, "2001-09-09T01:46:40Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ];
        for (seconds, expected) in known {
            assert_eq!(date(seconds), expected);
        }
    }

    #[test]
    fn processors_are_named_once_or_not_at_all() {
        let text = "processor\t: 0\nmodel name\t: A 1\nprocessor\t: 1\nmodel name\t: A 1\nmodel name\t: B 2\n";
        assert_eq!(processor(text).as_deref(), Some("A 1, B 2"));
        assert_eq!(processor("Hardware : board\nmodel name :\n"), None);
    }

    #[test]
    fn a_folder_within_a_repository_has_no_commit() {
        let inside = Workspace { root: Workspace::find().unwrap().path("xtask"), program: None };
        assert_eq!(commit(&inside), None);
        let nowhere = Workspace { root: "/no/such/folder".into(), program: None };
        assert_eq!(commit(&nowhere), None);
        assert_eq!(Origin::find(&nowhere).modified, None);
    }

    #[test]
    fn what_is_not_known_is_left_out_of_the_line() {
        let origin = Origin { system: "linux x86_64".into(), ..Origin::default() };
        assert_eq!(origin.line(), "linux x86_64");
        let known = Origin { commit: Some("0123456789abcdef".into()), modified: Some(true), cores: Some(2), ..origin };
        assert_eq!(known.line(), "commit 0123456789ab, with changes; 2 cores; linux x86_64");
    }
}
