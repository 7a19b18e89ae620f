//! Scatter maps: where the entries of dense local blocks go in the list of values. Computed once a pattern, so that
//! assembly is additions only. Not assembly itself: the caller decides the order, and so the bits.

use crate::{LinalgError, NONE, SparsityPattern};

/// Rows of a run at most: the components of a node.
const LONGEST_RUN: usize = 3;

/// Positions in the values of a pattern of the local entries of a list of stencils.
///
/// Rows of a stencil whose equations follow each other, as those of a node do, follow each other in every column of the pattern too. A map
/// therefore has one position for such a run of rows and a column: for solids a third of the entries.
#[derive(Debug, Clone, Default)]
pub struct ScatterMap {
    stencils: Vec<Stencil>,
    runs: Vec<Run>,
    /// Positions for each stencil, run by run: that of the first row in each local column; [`NONE`] if the column has no equation.
    positions: Vec<u32>,
}

/// Where the lists of a stencil begin.
#[derive(Debug, Clone, Copy)]
struct Stencil {
    runs: usize,
    positions: usize,
    /// Number of local rows.
    dimension: usize,
}

/// Local rows `first..first + length` with equations that follow each other.
#[derive(Debug, Clone, Copy)]
struct Run {
    first: u32,
    length: u32,
}

impl ScatterMap {
    /// Looks up every entry of every stencil. The stencils may have different sizes.
    ///
    /// # Errors
    /// [`LinalgError::EntryNotInPattern`] if the pattern was not built from (at least) these stencils.
    pub fn new<'a>(pattern: &SparsityPattern, stencils: impl Iterator<Item = &'a [u32]>) -> Result<Self, LinalgError> {
        let mut map = Self::default();
        for (stencil, equations) in stencils.enumerate() {
            let first_run = map.runs.len();
            map.stencils.push(Stencil { runs: first_run, positions: map.positions.len(), dimension: equations.len() });
            let mut first = 0;
            while first < equations.len() {
                if equations[first] == NONE {
                    first += 1;
                    continue;
                }
                let rest = equations[first..].iter().zip(equations[first]..).take(LONGEST_RUN);
                let length = rest.take_while(|&(&equation, next)| equation == next).count();
                map.runs.push(Run { first: first as u32, length: length as u32 });
                first += length;
            }
            map.look_up(pattern, stencil, equations, first_run)?;
        }
        map.stencils.shrink_to_fit();
        map.runs.shrink_to_fit();
        map.positions.shrink_to_fit();
        Ok(map)
    }

    /// Appends the positions of the runs of a stencil.
    fn look_up(
        &mut self,
        pattern: &SparsityPattern,
        stencil: usize,
        equations: &[u32],
        first_run: usize,
    ) -> Result<(), LinalgError> {
        let Self { runs, positions, .. } = self;
        let runs = &runs[first_run..];
        let first_position = positions.len();
        positions.resize(first_position + runs.len() * equations.len(), NONE);
        for columns in runs {
            // Where the last run was: those that follow are mostly behind it.
            let mut offset = 0;
            let mut last = 0;
            for (r, run) in runs.iter().enumerate() {
                let rows = &equations[run.first as usize..(run.first + run.length) as usize];
                let (row, to) = (rows[0], first_position + r * equations.len());
                if row < last {
                    offset = 0;
                }
                last = row;
                for local in columns.first as usize..(columns.first + columns.length) as usize {
                    let column = equations[local];
                    let missing = |row| LinalgError::EntryNotInPattern { stencil, row, column };
                    if column as usize >= pattern.n() {
                        return Err(missing(row));
                    }
                    let in_column = pattern.column(column as usize);
                    // Columns of a node have the same rows in most cases.
                    if in_column.get(offset) != Some(&row) {
                        offset = seek(in_column, offset, row);
                    }
                    for (k, &row) in rows.iter().enumerate() {
                        if in_column.get(offset + k) != Some(&row) {
                            return Err(missing(row));
                        }
                    }
                    // A pattern has fewer than NONE entries, so the conversion is exact.
                    positions[to + local] = (pattern.column_range(column as usize).start + offset) as u32;
                }
            }
        }
        Ok(())
    }

    /// Number of stencils.
    pub fn len(&self) -> usize {
        self.stencils.len()
    }

    /// Whether there is no stencil.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a local matrix (row-major, as large as stencil `k`) to the values; one of any size adds nothing where the stencil is empty. The sums are formed in the order of the
    /// calls, and within a call row by row if a stencil names an equation twice; hence the result is the same bits whenever the order of the calls is.
    pub fn add(&self, k: usize, local_row_major: &[f64], values: &mut [f64]) {
        let Stencil { runs, positions, dimension } = self.stencils[k];
        let end = self.stencils.get(k + 1).map_or(self.runs.len(), |next| next.runs);
        // The stencil of what another rank adds is empty.
        debug_assert!(dimension == 0 || dimension * dimension == local_row_major.len(), "stencil {k}");
        let runs = &self.runs[runs..end];
        let positions = self.positions[positions..][..runs.len() * dimension].chunks_exact(dimension.max(1));
        for (run, positions) in runs.iter().zip(positions) {
            let rows = &local_row_major[run.first as usize * dimension..][..run.length as usize * dimension];
            match run.length {
                1 => add_run([rows], positions, values),
                2 => {
                    let (a, b) = rows.split_at(dimension);
                    add_run([a, b], positions, values);
                }
                _ => {
                    let (a, rest) = rows.split_at(dimension);
                    let (b, c) = rest.split_at(dimension);
                    add_run([a, b, c], positions, values);
                }
            }
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Stencil>() * self.stencils.capacity()
            + size_of::<Run>() * self.runs.capacity()
            + size_of::<u32>() * self.positions.capacity()
    }
}

/// Where a value is, or would be, in an ascending list; quickly if that is a little behind `from`.
fn seek(list: &[u32], from: usize, value: u32) -> usize {
    if from >= list.len() || list[from] > value {
        return list.partition_point(|&other| other < value);
    }
    let (mut low, mut step) = (from, 1);
    while low + step < list.len() && list[low + step] < value {
        low += step;
        step *= 2;
    }
    let high = (low + step + 1).min(list.len());
    low + list[low..high].partition_point(|&other| other < value)
}

/// Adds `R` local rows that follow each other in every column.
#[inline]
fn add_run<const R: usize>(rows: [&[f64]; R], positions: &[u32], values: &mut [f64]) {
    let rows = rows.map(|row| &row[..positions.len()]);
    for (column, &position) in positions.iter().enumerate() {
        if position != NONE {
            let values = &mut values[position as usize..][..R];
            for r in 0..R {
                values[r] += rows[r][column];
            }
        }
    }
}
