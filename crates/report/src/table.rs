//! Tables of numbers with a header line: `balance.csv`, `newton.csv`, `contact.csv`, `probes.csv`.

use std::path::Path;

use crate::{Outcome, read};

/// Columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a file.
    pub fn read(path: &Path) -> Outcome<Self> {
        Self::parse(&read(path)?).map_err(|error| format!("{}: {error}", path.display()).into())
    }

    /// Reads comma-separated text: one line of names, then one line of numbers a row. Entries that are no number
    /// (a word, an empty place) become NaN.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text.lines();
        let header = lines.next().ok_or("the file is empty")?;
        let names: Vec<String> = header.split(',').map(|name| name.trim().to_owned()).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for (row, line) in lines.enumerate().filter(|(_, line)| !line.is_empty()) {
            let entries: Vec<&str> = line.split(',').collect();
            if entries.len() != names.len() {
                return Err(format!("line {} has {} entries, not {}", row + 2, entries.len(), names.len()));
            }
            for (column, entry) in columns.iter_mut().zip(entries) {
                column.push(entry.trim().parse().unwrap_or(f64::NAN));
            }
        }
        Ok(Self { names, columns })
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Result<&[f64], String> {
        match self.names.iter().position(|found| found == name) {
            Some(place) => Ok(&self.columns[place]),
            None => Err(format!("no column {name:?} among {:?}", self.names)),
        }
    }

    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Three columns as vectors.
    pub fn vectors(&self, names: [&str; 3]) -> Result<Vec<[f64; 3]>, String> {
        let [x, y, z] = [self.column(names[0])?, self.column(names[1])?, self.column(names[2])?];
        Ok((0..x.len()).map(|row| [x[row], y[row], z[row]]).collect())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }
}

/// A table with its entries as they are written, some of which may be words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextTable {
    /// Names of the columns.
    pub names: Vec<String>,
    /// Entries of each row, as many as there are names.
    pub rows: Vec<Vec<String>>,
}

impl TextTable {
    /// Reads a file of comma-separated values; a last row without a line feed is left out: it is being written.
    ///
    /// # Errors
    /// What is wrong with it, with its name.
    pub fn read(path: &Path) -> Outcome<Self> {
        let text = read(path)?;
        let whole = text.rfind('\n').map_or(text.as_str(), |end| &text[..=end]);
        Self::parse(whole).map_err(|error| format!("{}: {error}", path.display()).into())
    }

    /// Reads a text of comma-separated values: one line of names, then one line a row.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text.lines();
        let names = cells(lines.next().filter(|line| !line.is_empty()).ok_or("the file is empty")?);
        let mut rows = Vec::new();
        for (row, line) in lines.enumerate().filter(|(_, line)| !line.is_empty()) {
            let entries = cells(line);
            if entries.len() != names.len() {
                return Err(format!("line {} has {} entries, not {}", row + 2, entries.len(), names.len()));
            }
            rows.push(entries);
        }
        Ok(Self { names, rows })
    }
}

/// Entries of a line of comma-separated text, some in quotes (RFC 4180).
pub(crate) fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let (mut is_quoted, mut letters) = (false, line.chars().peekable());
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_quoted && letters.next_if_eq(&'"').is_some() => {
                cells.iter_mut().last().into_iter().for_each(|cell| cell.push('"'))
            }
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => cells.push(String::new()),
            _ => cells.iter_mut().last().into_iter().for_each(|cell| cell.push(letter)),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name() {
        let table = Table::parse("step,time,word\n0,0.0,a\n1,1e-2,b\n").unwrap();
        assert_eq!(table.rows(), 2);
        assert_eq!(table.column("time").unwrap(), [0.0, 0.01]);
        assert!(table.column("word").unwrap().iter().all(|value| value.is_nan()));
        assert!(table.column("energy").is_err());
    }

    #[test]
    fn words_stay_as_they_are_written() {
        let table = TextTable::parse("case,reason,x\n1,\"a, \"\"b\"\"\",2.50e0\n").unwrap();
        assert_eq!(table.names, ["case", "reason", "x"]);
        assert_eq!(table.rows, [["1", "a, \"b\"", "2.50e0"]]);
        for broken in ["", "a,b\n1\n"] {
            assert!(TextTable::parse(broken).is_err(), "{broken}");
        }
    }

    #[test]
    fn ragged_rows_are_refused() {
        assert!(Table::parse("a,b\n1\n").unwrap_err().contains("line 2"));
        assert!(Table::parse("").is_err());
    }
}
