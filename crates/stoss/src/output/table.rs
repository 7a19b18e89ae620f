//! Comma-separated tables that survive a kill: one row a line, flushed after each step, cut back on resume.

use super::OutputError;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// An open table. Numbers are written with the fewest digits that read back to the same bits.
#[derive(Debug)]
pub(crate) struct CsvTable {
    path: PathBuf,
    /// File of the table; none of a rank that does not write.
    file: Option<File>,
    length: u64,
    /// Rows that are not in the file yet.
    rows: String,
    line: String,
}

impl CsvTable {
    /// Creates the file with its header line.
    pub fn create(path: &Path, header: &str) -> Result<Self, OutputError> {
        let file = File::create(path).map_err(OutputError::io(path))?;
        let mut table = Self { path: path.to_path_buf(), file: Some(file), ..Self::nowhere() };
        table.line.push_str(header);
        table.end_row();
        table.flush()?;
        Ok(table)
    }

    /// A table without a file, which forgets its rows.
    pub fn nowhere() -> Self {
        Self { path: PathBuf::new(), file: None, length: 0, rows: String::new(), line: String::new() }
    }

    /// Opens the file and cuts it back to `length` bytes.
    pub fn resume(path: &Path, length: u64) -> Result<Self, OutputError> {
        let mut file = OpenOptions::new().write(true).open(path).map_err(OutputError::io(path))?;
        let found = file.metadata().map_err(OutputError::io(path))?.len();
        if found < length {
            return Err(OutputError::Damaged {
                path: path.to_path_buf(),
                reason: format!("{found} bytes, but the checkpoint was written after {length}"),
            });
        }
        file.set_len(length).map_err(OutputError::io(path))?;
        file.seek(SeekFrom::End(0)).map_err(OutputError::io(path))?;
        Ok(Self { path: path.to_path_buf(), file: Some(file), length, ..Self::nowhere() })
    }

    /// Resumes as [`Self::resume`], and gives the table other columns if its own differ from `header`: those of the same name keep their
    /// values, new ones are empty in the rows so far.
    pub fn resume_as(path: &Path, length: u64, header: &str) -> Result<Self, OutputError> {
        let table = Self::resume(path, length)?;
        let text = std::fs::read_to_string(path).map_err(OutputError::io(path))?;
        let mut lines = text.lines();
        let before: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let wanted: Vec<&str> = header.split(',').collect();
        if before == wanted {
            return Ok(table);
        }
        let places: Vec<Option<usize>> = wanted.iter().map(|name| before.iter().position(|b| b == name)).collect();
        let scratch = path.with_extension("csv.part");
        let mut table = Self::create(&scratch, header)?;
        for line in lines {
            let cells: Vec<&str> = line.split(',').collect();
            let kept: Vec<&str> = places.iter().map(|k| k.and_then(|k| cells.get(k).copied()).unwrap_or("")).collect();
            table.line = kept.join(",");
            table.end_row();
        }
        table.flush()?;
        std::fs::rename(&scratch, path).map_err(OutputError::io(path))?;
        table.path = path.to_path_buf();
        Ok(table)
    }

    fn separate(&mut self) {
        if !self.line.is_empty() {
            self.line.push(',');
        }
    }

    /// Appends an integer to the row.
    pub fn integer(&mut self, value: u64) -> &mut Self {
        self.separate();
        self.line.push_str(&value.to_string());
        self
    }

    /// Appends a number to the row; infinities and NaN as `inf`, `-inf`, `NaN`.
    pub fn number(&mut self, value: f64) -> &mut Self {
        self.separate();
        self.line.push_str(&format!("{value:e}"));
        self
    }

    /// Appends numbers to the row.
    pub fn numbers(&mut self, values: &[f64]) -> &mut Self {
        for &value in values {
            self.number(value);
        }
        self
    }

    /// Appends numbers over `extent` to the row.
    pub fn per(&mut self, extent: f64, values: &[f64]) -> &mut Self {
        for value in values {
            self.number(value / extent);
        }
        self
    }

    /// Appends a name to the row; empty for none.
    pub fn text(&mut self, value: &str) -> &mut Self {
        self.separate();
        self.line.push_str(value);
        self
    }

    /// Ends the row, which [`Self::flush`] writes.
    pub fn end_row(&mut self) {
        if self.file.is_some() {
            self.rows.push_str(&self.line);
            self.rows.push('\n');
        }
        self.line.clear();
    }

    /// Hands everything to the operating system; returns the length in bytes.
    pub fn flush(&mut self) -> Result<u64, OutputError> {
        if let Some(file) = &mut self.file {
            file.write_all(self.rows.as_bytes()).map_err(OutputError::io(&self.path))?;
        }
        self.length += self.rows.len() as u64;
        self.rows.clear();
        Ok(self.length)
    }
}
