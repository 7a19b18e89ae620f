//! `cargo xtask tidy`: habits that no compiler checks.
//!
//! A check is a function from a file's text to findings. To add one, write it in the file that fits (`text` for any text,
//! `rust` for sources, `documents` for Markdown, `citations` for what is cited, `terms` for what users read, `packages` for
//! manifests), call it below, and give it a test that fails
//! without it.

mod citations;
mod documents;
mod packages;
mod rust;
mod source;
mod terms;
mod text;

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use crate::workspace::{Outcome, Workspace};

/// Something to mend.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// Path from the root.
    pub file: String,
    /// Line from 1; 0 for the file as a whole.
    pub line: usize,
    /// Message: what is wrong.
    pub message: String,
}

impl Violation {
    /// Makes one.
    pub fn new(file: &str, line: usize, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line, message: message.into() }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(out, "{}: {}", self.file, self.message),
            line => write!(out, "{}:{line}: {}", self.file, self.message),
        }
    }
}

/// Runs all checks; false if there is a finding.
pub fn command(workspace: &Workspace) -> Outcome<bool> {
    let files = workspace.files()?;
    let texts: BTreeMap<String, String> = files
        .iter()
        .filter_map(|path| Some((slashes(path), std::fs::read_to_string(workspace.path(path)).ok()?)))
        .collect();
    let mut theory = citations::Theory::default();
    texts.iter().for_each(|(file, content)| theory.add(file, content));
    let anchors = |path: &Path| texts.get(&slashes(path)).map(|content| documents::anchors(content));
    let mut findings = Vec::new();
    for (file, content) in &texts {
        findings.extend(text::check(file, content));
        findings.extend(theory.check(file, content));
        findings.extend(terms::check(file, content));
        if file.ends_with(".rs") {
            findings.extend(rust::check(file, content));
        }
        if file.ends_with(".md") {
            findings.extend(documents::check(file, content, |path| workspace.path(path).exists(), anchors));
        }
    }
    findings.extend(rust::stale_allowances(|path| files.iter().any(|file| slashes(file) == path)));
    findings.extend(packages::check(workspace)?);
    for finding in &findings {
        println!("tidy: {finding}");
    }
    println!("tidy: {} text files, {} findings", texts.len(), findings.len());
    Ok(findings.is_empty())
}

fn slashes(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}
