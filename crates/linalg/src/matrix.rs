//! A sparse matrix: a shared pattern and values. Products and norms, no factorisation.

use crate::SparsityPattern;
use std::sync::Arc;

/// A square sparse matrix. The pattern is shared, the values are the matrix's own, in the order of the pattern.
#[derive(Debug, Clone)]
pub struct SparseMatrix {
    /// The pattern.
    pub pattern: Arc<SparsityPattern>,
    /// One value for each entry of the pattern.
    pub values: Vec<f64>,
}

impl SparseMatrix {
    /// The zero matrix on a pattern.
    pub fn zeros(pattern: Arc<SparsityPattern>) -> Self {
        let values = vec![0.0; pattern.nnz()];
        Self { pattern, values }
    }

    /// Sets all values to zero and keeps the pattern.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Number of rows and columns.
    pub fn n(&self) -> usize {
        self.pattern.n()
    }

    /// `y = A x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        multiply(&self.pattern, &self.values, x, y);
    }

    /// The largest absolute value in each row.
    pub fn row_max(&self, rows: &mut [f64]) {
        self.pattern.row_max(&self.values, rows);
    }

    /// The infinity norm: the largest sum of absolute values of a row.
    pub fn norm_inf(&self) -> f64 {
        let mut sums = vec![0.0; self.n()];
        for (&i, v) in self.pattern.row_indices().iter().zip(&self.values) {
            sums[i as usize] += v.abs();
        }
        crate::vector::norm_inf(&sums)
    }

    /// Value of entry `(row, col)`; zero where the pattern has none.
    pub fn get(&self, row: u32, col: u32) -> f64 {
        self.pattern.position(row, col).map_or(0.0, |k| self.values[k])
    }
}

/// `y = A x`.
pub(crate) fn multiply(pattern: &SparsityPattern, values: &[f64], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for j in 0..pattern.n() {
        let xj = x[j];
        let range = pattern.column_range(j);
        for (&i, &v) in pattern.row_indices()[range.clone()].iter().zip(&values[range]) {
            y[i as usize] += v * xj;
        }
    }
}
