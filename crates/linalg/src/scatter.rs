//! Scatter maps: where the entries of dense local blocks go in the list of values. Computed once a pattern, so that
//! assembly is additions only. Not assembly itself: the caller decides the order, and so the bits.

use crate::{LinalgError, NONE, SparsityPattern};

/// For a list of stencils, the position in the values of each local entry `(i, j)`, row-major; [`NONE`] where the row or
/// the column has no equation.
#[derive(Debug, Clone, Default)]
pub struct ScatterMap {
    offsets: Vec<usize>,
    positions: Vec<u32>,
}

impl ScatterMap {
    /// Looks up every entry of every stencil. The stencils may have different sizes.
    ///
    /// # Errors
    /// [`LinalgError::EntryNotInPattern`] if the pattern was not built from (at least) these stencils.
    pub fn new<'a>(pattern: &SparsityPattern, stencils: impl Iterator<Item = &'a [u32]>) -> Result<Self, LinalgError> {
        let mut map = Self { offsets: vec![0], positions: Vec::new() };
        for (stencil, equations) in stencils.enumerate() {
            for &row in equations {
                for &column in equations {
                    let position = if row == NONE || column == NONE {
                        NONE
                    } else {
                        // A pattern has fewer than NONE entries, so the conversion is exact.
                        pattern.position(row, column).ok_or(LinalgError::EntryNotInPattern { stencil, row, column })?
                            as u32
                    };
                    map.positions.push(position);
                }
            }
            map.offsets.push(map.positions.len());
        }
        map.positions.shrink_to_fit();
        Ok(map)
    }

    /// Number of stencils.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no stencil.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The positions of stencil `k`, row-major.
    pub fn positions(&self, k: usize) -> &[u32] {
        &self.positions[self.offsets[k]..self.offsets[k + 1]]
    }

    /// Adds a local matrix (row-major, as large as stencil `k`) to the values. The sums are formed in the order of the
    /// calls, hence the result is the same bits whenever the order is.
    pub fn add(&self, k: usize, local_row_major: &[f64], values: &mut [f64]) {
        let positions = self.positions(k);
        debug_assert_eq!(positions.len(), local_row_major.len(), "stencil {k}");
        for (&position, &value) in positions.iter().zip(local_row_major) {
            if position != NONE {
                values[position as usize] += value;
            }
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<usize>() * self.offsets.capacity() + size_of::<u32>() * self.positions.capacity()
    }
}
