//! Linear systems as files: Matrix Market, which SciPy, Matlab, Julia and others read.
//!
//! A system `NAME` is `NAME.mtx` (the matrix, `coordinate real general`, every entry of the pattern, zeros included), `NAME-rhs.mtx` (the right-hand
//! side, `array real general`) and, if the pattern has them, `NAME-groups.mtx` (labels of the equations that belong together,
//! [`SparsityPattern::with_groups`], `array integer general`). Where the pattern tells multipliers from displacements, a comment of the matrix has the number of the first
//! one, from 1. Numbers are written so that reading gives the same bits.

use crate::{LinalgError, SparseMatrix, SparsityPattern};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// Why a system cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SystemFileError {
    /// Input or output.
    #[error("{path}: {source}", path = .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A line that does not belong into a file of this kind.
    #[error("{path}:{line}: {reason}", path = .path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Reason.
        reason: String,
    },
    /// The entries do not form a valid pattern.
    #[error(transparent)]
    Pattern(#[from] LinalgError),
}

/// A matrix with a right-hand side.
#[derive(Clone, Debug)]
pub struct SystemFile {
    /// The matrix; its pattern is symmetric.
    pub matrix: SparseMatrix,
    /// The right-hand side.
    pub rhs: Vec<f64>,
}

/// Beginning of the comment that has the number of the first multiplier.
const FIRST_MULTIPLIER: &str = "% first multiplier: ";

fn beside(matrix: &Path, what: &str) -> PathBuf {
    let stem = matrix.file_stem().unwrap_or_default().to_string_lossy();
    matrix.with_file_name(format!("{stem}-{what}.mtx"))
}

/// Writes a system: `matrix_file` should end in `.mtx`; right-hand side and groups go beside it.
///
/// # Errors
/// [`SystemFileError::Io`].
pub fn write_system(
    matrix_file: &Path,
    pattern: &SparsityPattern,
    values: &[f64],
    rhs: &[f64],
) -> Result<(), SystemFileError> {
    write(matrix_file, |out| {
        let n = pattern.n();
        writeln!(out, "%%MatrixMarket matrix coordinate real general")?;
        if pattern.first_multiplier() < n {
            writeln!(out, "{FIRST_MULTIPLIER}{}", pattern.first_multiplier() + 1)?;
        }
        writeln!(out, "{n} {n} {}", pattern.nnz())?;
        let mut line = String::new();
        for j in 0..n {
            for k in pattern.column_range(j) {
                line.clear();
                // cannot fail: a string grows.
                let _ = writeln!(line, "{} {} {:e}", pattern.row_indices()[k] + 1, j + 1, values[k]);
                out.write_all(line.as_bytes())?;
            }
        }
        Ok(())
    })?;
    write(&beside(matrix_file, "rhs"), |out| {
        writeln!(out, "%%MatrixMarket matrix array real general\n{} 1", rhs.len())?;
        rhs.iter().try_for_each(|v| writeln!(out, "{v:e}"))
    })?;
    let Some(groups) = pattern.groups() else { return Ok(()) };
    write(&beside(matrix_file, "groups"), |out| {
        writeln!(out, "%%MatrixMarket matrix array integer general\n{} 1", groups.len())?;
        groups.iter().try_for_each(|group| writeln!(out, "{group}"))
    })
}

fn write(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), SystemFileError> {
    let written = File::create(path).and_then(|file| {
        let mut out = BufWriter::new(file);
        fill(&mut out)?;
        out.flush()
    });
    written.map_err(|source| SystemFileError::Io { path: path.to_owned(), source })
}

/// Reads what [`write_system`] wrote, or any real square `coordinate` matrix with an `array` of one column beside it. Entries that appear twice are
/// added.
///
/// # Errors
/// [`SystemFileError`].
pub fn read_system(matrix_file: &Path) -> Result<SystemFile, SystemFileError> {
    let mut lines = Lines::open(matrix_file, "matrix coordinate real general")?;
    let [rows, columns, count] = lines.numbers::<usize, 3>()?;
    let first_multiplier =
        lines.first_multiplier.filter(|first| (1..=rows).contains(first)).map_or(rows, |first| first - 1);
    if rows != columns {
        return Err(lines.wrong("the matrix is not square"));
    }
    let (mut stencils, mut entries) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let text = lines.next_line()?;
        let mut words = text.split_whitespace();
        let index = |word: Option<&str>| word.and_then(|w| w.parse::<usize>().ok()).filter(|i| (1..=rows).contains(i));
        let (i, j) = (index(words.next()), index(words.next()));
        let value = words.next().and_then(|w| w.parse::<f64>().ok());
        let (Some(i), Some(j), Some(value)) = (i, j, value) else {
            return Err(lines.wrong("needs row, column and value"));
        };
        stencils.push([i as u32 - 1, j as u32 - 1]);
        entries.push(value);
    }
    let pattern = SparsityPattern::from_stencils(rows, stencils.iter().map(|s| &s[..]))?;
    let mut pattern = pattern.with_first_multiplier(first_multiplier);
    let groups = beside(matrix_file, "groups");
    if groups.is_file() {
        let mut lines = Lines::open(&groups, "matrix array integer general")?;
        pattern = pattern.with_groups(lines.column(rows)?)?;
    }
    let mut matrix = SparseMatrix::zeros(Arc::new(pattern));
    for (&[i, j], value) in stencils.iter().zip(entries) {
        if let Some(k) = matrix.pattern.position(i, j) {
            matrix.values[k] += value;
        }
    }
    let mut lines = Lines::open(&beside(matrix_file, "rhs"), "matrix array real general")?;
    Ok(SystemFile { matrix, rhs: lines.column(rows)? })
}

/// Lines that are not comments.
struct Lines {
    path: PathBuf,
    reader: BufReader<File>,
    number: usize,
    /// First multiplier, from a comment that was read.
    first_multiplier: Option<usize>,
}

impl Lines {
    /// A file whose header has this kind.
    fn open(path: &Path, kind: &str) -> Result<Self, SystemFileError> {
        let file = File::open(path).map_err(|source| SystemFileError::Io { path: path.to_owned(), source })?;
        let mut lines = Self { path: path.to_owned(), reader: BufReader::new(file), number: 0, first_multiplier: None };
        let header = lines.read()?.unwrap_or_default();
        let found = header.trim().strip_prefix("%%MatrixMarket").map(|rest| rest.trim().to_lowercase());
        match found {
            Some(found) if found == kind => Ok(lines),
            _ => Err(lines.wrong(&format!("is not a Matrix Market file with `{kind}`"))),
        }
    }

    fn read(&mut self) -> Result<Option<String>, SystemFileError> {
        let mut line = String::new();
        let read = self.reader.read_line(&mut line);
        let read = read.map_err(|source| SystemFileError::Io { path: self.path.clone(), source })?;
        self.number += 1;
        Ok((read > 0).then_some(line))
    }

    fn next_line(&mut self) -> Result<String, SystemFileError> {
        loop {
            match self.read()? {
                Some(line) if line.starts_with('%') || line.trim().is_empty() => {
                    let number = line.strip_prefix(FIRST_MULTIPLIER).and_then(|number| number.trim().parse().ok());
                    self.first_multiplier = self.first_multiplier.or(number);
                }
                Some(line) => return Ok(line),
                None => return Err(self.wrong("the file ends here; there should be more lines")),
            }
        }
    }

    fn numbers<T: FromStr, const N: usize>(&mut self) -> Result<[T; N], SystemFileError> {
        let line = self.next_line()?;
        let numbers: Vec<T> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        numbers.try_into().map_err(|_| self.wrong(&format!("needs {N} numbers")))
    }

    /// An array of one column and `n` rows.
    fn column<T: FromStr>(&mut self, n: usize) -> Result<Vec<T>, SystemFileError> {
        if self.numbers::<usize, 2>()? != [n, 1] {
            return Err(self.wrong(&format!("needs {n} rows and one column")));
        }
        (0..n).map(|_| self.numbers::<T, 1>().map(|[value]| value)).collect()
    }

    fn wrong(&self, reason: &str) -> SystemFileError {
        SystemFileError::Format { path: self.path.clone(), line: self.number, reason: reason.to_owned() }
    }
}
