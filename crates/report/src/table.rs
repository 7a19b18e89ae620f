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
    fn ragged_rows_are_refused() {
        assert!(Table::parse("a,b\n1\n").unwrap_err().contains("line 2"));
        assert!(Table::parse("").is_err());
    }
}
