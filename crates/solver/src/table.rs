//! Piecewise linear functions of time.

use serde::{Deserialize, Serialize};

/// Piecewise linear function of time with one or more columns; constant before the first and after the last row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    times: Vec<f64>,
    /// Row-major, `times.len() * columns`.
    values: Vec<f64>,
    columns: usize,
    /// Whether it is set while the run goes on ([`crate::Simulation::steer`]): then nothing can be said of times to come.
    steered: bool,
}

/// Why rows are not a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A table without rows.
    #[error("the table has no row")]
    Empty,
    /// A row has the wrong number of values.
    #[error("row {row} has {found} values after the time, expected {expected}")]
    Columns {
        /// Index of the row.
        row: usize,
        /// Values found.
        found: usize,
        /// Values expected.
        expected: usize,
    },
    /// Times do not increase.
    #[error("the time {time} of row {row} is not larger than that of the row before")]
    Order {
        /// Index of the row.
        row: usize,
        /// Time of the row.
        time: f64,
    },
    /// A value that is NaN or infinite.
    #[error("row {row} has a value that is not finite")]
    NotFinite {
        /// Index of the row.
        row: usize,
    },
}

impl Table {
    /// A constant.
    pub fn constant(values: &[f64]) -> Self {
        Self { times: vec![0.0], values: values.to_vec(), columns: values.len(), steered: false }
    }

    /// A table from rows `[time, value, value, ...]` with increasing times.
    ///
    /// # Errors
    /// No row, a wrong number of values, times that do not increase, values that are not finite.
    pub fn from_rows(rows: &[Vec<f64>], columns: usize) -> Result<Self, TableError> {
        if rows.is_empty() {
            return Err(TableError::Empty);
        }
        let mut table = Self { times: Vec::new(), values: Vec::new(), columns, steered: false };
        for (row, entries) in rows.iter().enumerate() {
            if entries.len() != columns + 1 {
                return Err(TableError::Columns { row, found: entries.len().saturating_sub(1), expected: columns });
            }
            if entries.iter().any(|x| !x.is_finite()) {
                return Err(TableError::NotFinite { row });
            }
            if table.times.last().is_some_and(|&last| entries[0] <= last) {
                return Err(TableError::Order { row, time: entries[0] });
            }
            table.times.push(entries[0]);
            table.values.extend_from_slice(&entries[1..]);
        }
        Ok(table)
    }

    /// Number of values a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Lets the table be set while the run goes on.
    pub(crate) fn steer(&mut self) {
        self.steered = true;
    }

    /// Whether it is set while the run goes on.
    pub(crate) fn is_steered(&self) -> bool {
        self.steered
    }

    /// Leads the values from now on: linear from the value at `from` to `values`, one a column, at the later time `to`, and constant after it.
    pub(crate) fn lead(&mut self, from: f64, to: f64, values: &[f64]) {
        let present: Vec<f64> = (0..self.columns).map(|column| self.value(from, column)).collect();
        self.times = vec![from, to];
        self.values = [&present, values].concat();
    }

    /// True if the value never changes.
    pub fn is_constant(&self) -> bool {
        if self.steered {
            return false;
        }
        let first = &self.values[..self.columns];
        self.values.chunks_exact(self.columns).all(|row| row == first)
    }

    /// True if a column is zero at all times.
    pub fn is_zero(&self, column: usize) -> bool {
        !self.steered && self.values.iter().skip(column).step_by(self.columns).all(|&value| value == 0.0)
    }

    /// Value of a column at a time.
    pub fn value(&self, time: f64, column: usize) -> f64 {
        let at = |row: usize| self.values[row * self.columns + column];
        let after = self.times.partition_point(|&t| t <= time);
        if after == 0 {
            return at(0);
        }
        if after == self.times.len() {
            return at(after - 1);
        }
        let (t0, t1) = (self.times[after - 1], self.times[after]);
        let s = (time - t0) / (t1 - t0);
        at(after - 1) + s * (at(after) - at(after - 1))
    }

    /// Whether a column is the same function of time as a column of another table, bit by bit.
    pub fn is_same_function(&self, column: usize, other: &Self, other_column: usize) -> bool {
        let mut times = self.times.iter().chain(&other.times);
        times.all(|&time| self.value(time, column) == other.value(time, other_column))
    }

    /// Slope of a column just after a time.
    pub fn slope(&self, time: f64, column: usize) -> f64 {
        // A time within round-off of a row counts as that row, so that the slope after a kink is taken at the kink.
        let slack = 1.0e-12 * time.abs().max(1.0e-300);
        let after = self.times.partition_point(|&t| t <= time + slack);
        if after == 0 || after == self.times.len() {
            return 0.0;
        }
        let at = |row: usize| self.values[row * self.columns + column];
        (at(after) - at(after - 1)) / (self.times[after] - self.times[after - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_and_extrapolates() {
        let table = Table::from_rows(&[vec![1.0, 2.0, 0.0], vec![3.0, 6.0, -1.0]], 2).unwrap();
        assert_eq!(table.value(0.0, 0), 2.0);
        assert_eq!(table.value(2.0, 0), 4.0);
        assert_eq!(table.value(2.5, 1), -0.75);
        assert_eq!(table.value(9.0, 1), -1.0);
        assert_eq!(table.slope(0.5, 0), 0.0);
        assert_eq!(table.slope(1.0, 0), 2.0);
        assert_eq!(table.slope(3.0, 0), 0.0);
        assert!(!table.is_constant());
        assert!(Table::constant(&[1.0]).is_constant());
    }

    #[test]
    fn what_is_steered_goes_on_from_where_it_is() {
        let mut table = Table::from_rows(&[vec![0.0, 0.0], vec![2.0, 4.0]], 1).unwrap();
        table.steer();
        table.lead(1.0, 1.5, &[3.0]);
        assert_eq!([1.0, 1.25, 1.5, 9.0].map(|time| table.value(time, 0)), [2.0, 2.5, 3.0, 3.0]);
        assert_eq!(table.slope(1.0, 0), 2.0);
        let mut zero = Table::constant(&[0.0]);
        zero.steer();
        assert!(!zero.is_constant() && !zero.is_zero(0));
    }

    #[test]
    fn refuses_what_is_no_table() {
        assert_eq!(Table::from_rows(&[], 1), Err(TableError::Empty));
        assert_eq!(Table::from_rows(&[vec![0.0]], 1), Err(TableError::Columns { row: 0, found: 0, expected: 1 }));
        assert_eq!(
            Table::from_rows(&[vec![0.0, 1.0], vec![0.0, 1.0]], 1),
            Err(TableError::Order { row: 1, time: 0.0 })
        );
        assert_eq!(Table::from_rows(&[vec![0.0, f64::NAN]], 1), Err(TableError::NotFinite { row: 0 }));
    }
}
