//! Sparsity patterns: which equations are coupled. Not the values.

use crate::LinalgError;

/// The mark of what is not there. In a stencil: this local unknown has no equation (a prescribed component). In a [`crate::ScatterMap`]: this local
/// entry is dropped.
pub const NONE: u32 = u32::MAX;

/// Pattern of an `n x n` matrix, stored by columns; the rows of a column increase strictly. The diagonal is always there, but for [`SparsityPattern::from_own_stencils`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SparsityPattern {
    n: usize,
    column_pointers: Vec<usize>,
    row_indices: Vec<u32>,
    groups: Option<Vec<u32>>,
    first_multiplier: usize,
}

impl SparsityPattern {
    /// The pattern of a sum of dense local blocks. A stencil lists the equations that are coupled with each other; entries
    /// that are [`NONE`] are skipped. A stencil may name an equation twice. The pattern is symmetric by construction.
    ///
    /// # Errors
    /// [`LinalgError::EquationOutOfRange`], [`LinalgError::TooLarge`].
    pub fn from_stencils<'a>(n: usize, stencils: impl Iterator<Item = &'a [u32]> + Clone) -> Result<Self, LinalgError> {
        Self::from_own_stencils(n, stencils, |_| true)
    }

    /// Pattern as of [`SparsityPattern::from_stencils`], for the part of a matrix that a rank has: an equation that no stencil names has its diagonal if it is
    /// one of the rank's own.
    ///
    /// # Errors
    /// The errors of [`SparsityPattern::from_stencils`].
    pub fn from_own_stencils<'a>(
        n: usize,
        stencils: impl Iterator<Item = &'a [u32]> + Clone,
        is_own: impl Fn(usize) -> bool,
    ) -> Result<Self, LinalgError> {
        if n >= NONE as usize {
            return Err(LinalgError::TooLarge { what: "number of equations", count: n });
        }
        let blocks = Blocks::new(n, stencils.clone())?;
        // Which blocks are coupled: the pattern of a matrix of blocks.
        let coupled = blocks.coupled(stencils, is_own);
        let size = |block: usize| (blocks.starts[block + 1] - blocks.starts[block]) as usize;
        let rows = |block: usize| coupled.rows(block).iter().map(|&row| size(row as usize)).sum::<usize>();
        let count = (0..blocks.count()).map(|block| size(block) * rows(block)).sum();
        if count >= NONE as usize {
            return Err(LinalgError::TooLarge { what: "number of entries", count });
        }
        let (mut column_pointers, mut row_indices) = (Vec::with_capacity(n + 1), Vec::with_capacity(count));
        column_pointers.push(0);
        for block in 0..blocks.count() {
            for _ in 0..size(block) {
                for &row in coupled.rows(block) {
                    row_indices.extend(blocks.starts[row as usize]..blocks.starts[row as usize + 1]);
                }
                column_pointers.push(row_indices.len());
            }
        }
        Ok(Self { n, column_pointers, row_indices, groups: None, first_multiplier: n })
    }

    /// Adds which equations belong together: a label for each, equal for the displacements of a node and for the multipliers of
    /// which it is the slave; [`NONE`] for an equation of which it is not known. The labels' values mean nothing. Within a group
    /// multipliers must be numbered after displacements. A solver that orders the equations itself keeps a group together
    /// and eliminates it in the order of the numbers; all others ignore it.
    ///
    /// # Errors
    /// [`LinalgError::Length`] unless there is one label an equation.
    pub fn with_groups(mut self, groups: Vec<u32>) -> Result<Self, LinalgError> {
        if groups.len() != self.n {
            return Err(LinalgError::Length { what: "list of groups", expected: self.n, found: groups.len() });
        }
        self.groups = Some(groups);
        Ok(self)
    }

    /// The labels of [`SparsityPattern::with_groups`].
    pub fn groups(&self) -> Option<&[u32]> {
        self.groups.as_deref()
    }

    /// Adds which equations are those of multipliers: from number `first` on. The unknowns before are displacements, all in one unit; a multiplier, and its row, may
    /// have a unit of its own. Without this all unknowns count as displacements.
    /// A number beyond the last equation means that there is no multiplier.
    pub fn with_first_multiplier(mut self, first: usize) -> Self {
        self.first_multiplier = first.min(self.n);
        self
    }

    /// Number of the first multiplier, see [`SparsityPattern::with_first_multiplier`]; the number of equations if there is none.
    pub fn first_multiplier(&self) -> usize {
        self.first_multiplier
    }

    /// Number of equations.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.row_indices.len()
    }

    /// Where the columns begin, `n + 1` positions.
    pub fn column_pointers(&self) -> &[usize] {
        &self.column_pointers
    }

    /// Row of each stored entry.
    pub fn row_indices(&self) -> &[u32] {
        &self.row_indices
    }

    /// The rows of a column, in increasing order.
    pub fn column(&self, j: usize) -> &[u32] {
        &self.row_indices[self.column_range(j)]
    }

    /// Positions of a column's entries.
    pub fn column_range(&self, j: usize) -> std::ops::Range<usize> {
        self.column_pointers[j]..self.column_pointers[j + 1]
    }

    /// Position of entry `(row, col)` in the list of values; `None` where the pattern has none or the indices are too large.
    pub fn position(&self, row: u32, col: u32) -> Option<usize> {
        let col = col as usize;
        if col >= self.n {
            return None;
        }
        let start = self.column_pointers[col];
        self.column(col).binary_search(&row).ok().map(|k| start + k)
    }

    /// The largest absolute value in each row, for values in the order of the pattern.
    pub(crate) fn row_max(&self, values: &[f64], rows: &mut [f64]) {
        rows.fill(0.0);
        for (&i, v) in self.row_indices.iter().zip(values) {
            let i = i as usize;
            rows[i] = rows[i].max(v.abs());
        }
    }

    /// `max |a_ij - a_ji| / min(m_i, m_j)` for values in the order of the pattern, `m_i` the largest entry of row `i` in size: about round-off
    /// if the values are meant to be symmetric. For tests.
    pub fn asymmetry(&self, values: &[f64]) -> f64 {
        let mut rows = vec![0.0; self.n];
        self.row_max(values, &mut rows);
        let mut largest = 0.0f64;
        // Rows are sorted and the pattern is symmetric: entry `(j, i)` is the next one of column `i` whenever `(i, j)` below the diagonal comes up.
        let mut next: Vec<usize> = (0..self.n).map(|j| self.column_range(j).start).collect();
        for j in 0..self.n {
            for k in self.column_range(j).filter(|&k| self.row_indices[k] as usize > j) {
                let i = self.row_indices[k] as usize;
                debug_assert_eq!(self.row_indices[next[i]] as usize, j);
                let difference = (values[k] - values[next[i]]).abs();
                next[i] += 1;
                if difference > 0.0 {
                    largest = largest.max(difference / rows[i].min(rows[j]));
                }
            }
        }
        largest
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<usize>() * self.column_pointers.capacity()
            + size_of::<u32>() * (self.row_indices.capacity() + self.groups.as_ref().map_or(0, Vec::capacity))
    }
}

/// Ranges of equations that all stencils name one after the other or not at all, such as the components of a node: they have the same rows and columns.
struct Blocks {
    /// First equation of each, and the number of all.
    starts: Vec<u32>,
    /// Block that begins with an equation; [`NONE`] for the others.
    beginning: Vec<u32>,
}

/// The blocks that are coupled with each block, ascending, with itself.
struct Coupled {
    pointers: Vec<usize>,
    rows: Vec<u32>,
}

impl Coupled {
    fn rows(&self, block: usize) -> &[u32] {
        &self.rows[self.pointers[block]..self.pointers[block + 1]]
    }
}

impl Blocks {
    fn new<'a>(n: usize, stencils: impl Iterator<Item = &'a [u32]>) -> Result<Self, LinalgError> {
        let mut is_named = vec![false; n];
        // Whether a block begins with each equation.
        let mut begins = vec![false; n + 1];
        for (k, stencil) in stencils.enumerate() {
            let mut before = NONE;
            for (entry, &equation) in stencil.iter().enumerate() {
                if equation != NONE && equation as usize >= n {
                    return Err(LinalgError::EquationOutOfRange { stencil: k, entry, equation, n });
                }
                if before == NONE || equation != before + 1 {
                    if before != NONE {
                        begins[before as usize + 1] = true;
                    }
                    if equation != NONE {
                        begins[equation as usize] = true;
                    }
                }
                if equation != NONE {
                    is_named[equation as usize] = true;
                }
                before = equation;
            }
            if before != NONE {
                begins[before as usize + 1] = true;
            }
        }
        let (mut starts, mut beginning) = (Vec::new(), vec![NONE; n]);
        for equation in 0..n {
            if begins[equation] || !is_named[equation] || equation == 0 {
                beginning[equation] = starts.len() as u32;
                starts.push(equation as u32);
            }
        }
        starts.push(n as u32);
        Ok(Self { starts, beginning })
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The blocks that a stencil names; all of their equations are in it.
    fn of<'a>(&'a self, stencil: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        let beginning = |&equation: &u32| if equation == NONE { NONE } else { self.beginning[equation as usize] };
        stencil.iter().map(beginning).filter(|&block| block != NONE)
    }

    fn coupled<'a>(
        &self,
        stencils: impl Iterator<Item = &'a [u32]> + Clone,
        is_own: impl Fn(usize) -> bool,
    ) -> Coupled {
        let count = self.count();
        // Which stencils touch a block: offsets by counting, then the list.
        let mut offsets = vec![0usize; count + 1];
        for stencil in stencils.clone() {
            self.of(stencil).for_each(|block| offsets[block as usize + 1] += 1);
        }
        for block in 0..count {
            offsets[block + 1] += offsets[block];
        }
        let mut list: Vec<&[u32]> = vec![&[]; offsets[count]];
        let mut next = offsets.clone();
        for stencil in stencils {
            for block in self.of(stencil) {
                list[next[block as usize]] = stencil;
                next[block as usize] += 1;
            }
        }
        let (mut pointers, mut rows) = (Vec::with_capacity(count + 1), Vec::new());
        let mut mark = vec![NONE; count];
        pointers.push(0);
        for block in 0..count as u32 {
            let start = rows.len();
            mark[block as usize] = block;
            let stencils = &list[offsets[block as usize]..offsets[block as usize + 1]];
            // One that is not named is a single equation.
            if !stencils.is_empty() || is_own(self.starts[block as usize] as usize) {
                rows.push(block);
            }
            for stencil in stencils {
                for other in self.of(stencil) {
                    if mark[other as usize] != block {
                        mark[other as usize] = block;
                        rows.push(other);
                    }
                }
            }
            rows[start..].sort_unstable();
            pointers.push(rows.len());
        }
        Coupled { pointers, rows }
    }
}
