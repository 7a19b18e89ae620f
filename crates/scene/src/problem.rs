//! Problems of a scene: where, which key, what is wrong and what to do.

use crate::{Location, Scene};
use std::fmt;
use std::ops::Range;

/// One problem of a scene. Written as `file:line:column: key = value: message; remedy`.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Problem {
    /// The scene file, as it was named to [`crate::parse`].
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Byte range in the scene's text.
    pub span: Range<usize>,
    /// Path of the key, for instance `body[1].material.kappa`; empty for errors of syntax.
    pub key: String,
    /// The offending value as written, shortened; empty if there is none.
    pub value: String,
    /// What is wrong.
    pub message: String,
    /// Remedy: what to do.
    pub remedy: String,
}

impl Problem {
    /// A problem at a key of a scene that was read already, for checks that need more than the scene (meshes, laws, files). A key
    /// that does not appear in the file is located at the nearest table around it.
    pub fn at(
        scene: &Scene,
        key: impl Into<String>,
        value: impl fmt::Display,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let key = key.into();
        let location = scene.locate_nearest(&key);
        Self::new(scene.file(), location, key, &value.to_string(), message.into(), remedy.into())
    }

    pub(crate) fn new(
        file: &str,
        location: Location,
        key: String,
        value: &str,
        message: String,
        remedy: String,
    ) -> Self {
        Self {
            file: file.to_owned(),
            line: location.line,
            column: location.column,
            span: location.span,
            key: shorten(&key, KEY),
            value: shorten(value, VALUE),
            message: shorten(&message, SENTENCE),
            remedy: shorten(&remedy, SENTENCE),
        }
    }
}

/// Most characters of a key, of a value, of a message or a remedy: what a scene has in it may be of any length.
const KEY: usize = 120;
const VALUE: usize = 60;
const SENTENCE: usize = 600;

/// One line of at most so many characters.
fn shorten(text: &str, limit: usize) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= limit {
        return line;
    }
    let mut short: String = line.chars().take(limit - 3).collect();
    short.push_str("...");
    short
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: ", self.file, self.line, self.column)?;
        match (self.key.is_empty(), self.value.is_empty()) {
            (true, _) => {}
            (false, true) => write!(f, "{}: ", self.key)?,
            (false, false) => write!(f, "{} = {}: ", self.key, self.value)?,
        }
        write!(f, "{}; {}", self.message, self.remedy)
    }
}

impl std::error::Error for Problem {}

/// All problems of a scene, in the order of the file; at least one. Written one a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneErrors {
    problems: Vec<Problem>,
    text: String,
}

impl SceneErrors {
    /// Problems of the scene with this text; `None` if there are none.
    pub fn new(mut problems: Vec<Problem>, text: &str) -> Option<Self> {
        problems.sort_by(|a, b| (a.span.start, &a.key).cmp(&(b.span.start, &b.key)));
        (!problems.is_empty()).then(|| Self { problems, text: text.to_owned() })
    }

    pub(crate) fn one(problem: Problem, text: &str) -> Self {
        Self { problems: vec![problem], text: text.to_owned() }
    }

    /// The problems in the order of the file.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// The scene's text, to which the spans belong.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for SceneErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneErrors {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_names_everything() {
        let location = Location { line: 12, column: 9, span: 3..5 };
        let problem = Problem::new(
            "scenes/x.toml",
            location,
            "body[0].density".into(),
            "-1",
            "must be positive".into(),
            "give the mass per volume".into(),
        );
        assert_eq!(
            problem.to_string(),
            "scenes/x.toml:12:9: body[0].density = -1: must be positive; give the mass per volume"
        );
    }

    #[test]
    fn long_values_are_shortened_to_one_line() {
        assert_eq!(shorten("[1,\n  2]", VALUE), "[1, 2]");
        assert_eq!(shorten(&"é".repeat(100), VALUE).chars().count(), 60);
    }
}
