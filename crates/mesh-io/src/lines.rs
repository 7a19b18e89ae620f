//! Going through a text line by line, with errors that say where.

use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use crate::place::FileLocation;
use crate::{FilePosition, MeshIoError};

/// The longest piece of a file that an error repeats.
const EXCERPT: usize = 60;

/// A cursor over the lines of a text. Blank lines are skipped, white space at both ends is removed.
#[derive(Clone)]
pub(crate) struct Lines<'a> {
    pub path: &'a Path,
    /// Number of the file among those that are read together.
    pub file: u32,
    rest: std::iter::Enumerate<std::str::Lines<'a>>,
    /// Number of the last line returned.
    pub number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(path: &'a Path, text: &'a str) -> Lines<'a> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Lines { path, file: 0, rest: text.lines().enumerate(), number: 0 }
    }

    /// The current line.
    pub fn place(&self) -> FileLocation {
        FileLocation { file: self.file, at: self.number as u64 }
    }

    /// The next line that is not blank, or `None` at the end.
    pub fn next(&mut self) -> Option<&'a str> {
        for (index, line) in self.rest.by_ref() {
            self.number = index + 1;
            let line = line.trim();
            if !line.is_empty() {
                return Some(line);
            }
        }
        None
    }

    /// The next line, or an error at the end of the file.
    pub fn expect(&mut self, what: &str) -> Result<&'a str, MeshIoError> {
        match self.next() {
            Some(line) => Ok(line),
            None => Err(self.error("end of file", format!("expected {what}; the file is cut off, write it again"))),
        }
    }

    /// An error at the current line.
    pub fn error(&self, value: impl Display, remedy: impl Display) -> MeshIoError {
        syntax(self.path, self.number, value, remedy)
    }

    /// A parsed number of the current line.
    pub fn parse<T: FromStr>(&self, token: Option<&str>, what: &str) -> Result<T, MeshIoError> {
        let token = token.ok_or_else(|| self.error("end of line", format!("expected {what}")))?;
        token.parse().map_err(|_| self.error(token, format!("expected {what}")))
    }

    /// A finite number of the current line; `D` exponents of Fortran are understood.
    pub fn parse_real(&self, token: Option<&str>, what: &str) -> Result<f64, MeshIoError> {
        let token = token.ok_or_else(|| self.error("end of line", format!("expected {what}")))?;
        real(token).ok_or_else(|| self.error(token, format!("expected {what}, a finite number")))
    }
}

/// A finite number; `D` exponents of Fortran are understood.
pub(crate) fn real(text: &str) -> Option<f64> {
    let value = text.parse().or_else(|_| text.replace(['d', 'D'], "e").parse::<f64>()).ok()?;
    value.is_finite().then_some(value)
}

/// A [`MeshIoError::Syntax`]. What is missing in an empty file is missing in its first line.
pub(crate) fn syntax(path: &Path, line: usize, value: impl Display, remedy: impl Display) -> MeshIoError {
    let line = line.max(1);
    MeshIoError::Syntax { path: path.to_owned(), line, value: excerpt(&value.to_string()), remedy: remedy.to_string() }
}

/// A [`MeshIoError::Unsupported`].
pub(crate) fn unsupported(path: &Path, line: usize, value: impl Display, remedy: impl Display) -> MeshIoError {
    let at = FilePosition::Line(line);
    MeshIoError::Unsupported { path: path.to_owned(), at, value: value.to_string(), remedy: remedy.to_string() }
}

fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}
