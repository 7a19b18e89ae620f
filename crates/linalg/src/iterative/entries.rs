//! Where the entries of blocks are in the values of a matrix, looked up once a pattern.

use super::bsr::{Block, Bsr};
use super::layout::Layout;
use super::saddle::Border;
use crate::{NONE, SparsityPattern};

/// Sources of the values of blocks, and of what borders them.
#[derive(Debug, Default)]
pub(crate) struct Entries {
    /// Whether the columns of a node are its rows too.
    symmetric: bool,
    /// Place of the first row of each block in the columns of its node, of which each has the same rows; [`NONE`] if they do not, or not all rows of the block:
    /// then they are looked up.
    offsets: Vec<u32>,
    /// Positions of the entries of multipliers and others in the columns of nodes, equation by equation.
    border: Vec<u32>,
    /// Where the entries of an equation begin; empty if there are none at all.
    border_starts: Vec<u32>,
}

impl Entries {
    /// The sources for the blocks `k` of [`Layout::block_pattern`]. `symmetric`: the values are those of a symmetric matrix.
    pub fn new(layout: &Layout, pattern: &SparsityPattern, k: &Bsr<f64, 3, 3>, symmetric: bool) -> Self {
        let nodes = layout.nodes();
        let mut out = Self { symmetric, offsets: vec![NONE; k.indices.len()], ..Self::default() };
        // Columns ascend, so the next block of a row is that of the present column.
        let mut next: Vec<usize> = k.starts[..nodes].to_vec();
        for (owner, equations) in layout.equations.iter().enumerate() {
            let mut present = present(equations).map(|(_, equation)| pattern.column(equation));
            let first = present.next().unwrap_or_default();
            let is_regular = present.all(|column| column == first);
            let mut at = 0;
            for own in k.starts[owner]..k.starts[owner + 1] {
                let other = k.indices[own] as usize;
                let block = if symmetric { own } else { next[other] };
                next[other] += 1;
                let first_row = present_rows(layout, other).next();
                while at < first.len() && Some(first[at]) < first_row {
                    at += 1;
                }
                if is_regular && present_rows(layout, other).zip(at..).all(|(row, at)| first.get(at) == Some(&row)) {
                    out.offsets[block] = at as u32;
                }
            }
        }
        if !layout.slots.is_empty() {
            out.border_starts.push(0);
            for equation in layout.equations.iter().flat_map(|equations| present(equations).map(|(_, e)| e)) {
                let rows = pattern.column(equation).iter().zip(pattern.column_range(equation));
                let others = rows.filter(|(row, _)| layout.place[**row as usize] as usize >= 3 * nodes);
                out.border.extend(others.map(|(_, position)| position as u32));
                out.border_starts.push(out.border.len() as u32);
            }
        }
        out
    }

    /// Copies the values of the blocks between nodes, and of what borders them. A component without equation has its node's largest diagonal entry.
    pub fn set(
        &self,
        layout: &Layout,
        pattern: &SparsityPattern,
        values: &[f64],
        k: &mut Bsr<f64, 3, 3>,
        border: &mut Border,
    ) {
        k.for_rows_of_blocks(|i, range, columns, blocks| {
            for ((block, &j), &offset) in blocks.iter_mut().zip(columns).zip(&self.offsets[range]) {
                let (owner, other) = if self.symmetric { (i, j as usize) } else { (j as usize, i) };
                *block = block_of(layout, pattern, values, (owner, other), offset);
                if !self.symmetric {
                    *block = transposed(block);
                }
                if i == j as usize {
                    fill_held(block, layout.free[i]);
                }
            }
        });
        self.set_border(layout, pattern, values, border);
    }

    fn set_border(&self, layout: &Layout, pattern: &SparsityPattern, values: &[f64], border: &mut Border) {
        let nodes = layout.nodes();
        border.clear(nodes);
        if layout.slots.is_empty() {
            return;
        }
        let place = |position: usize| layout.place[pattern.row_indices()[position] as usize] as usize;
        let mut marks = vec![0; layout.slots.len()];
        let mut starts = self.border_starts.windows(2);
        for equations in &layout.equations {
            for ((c, _), range) in present(equations).zip(&mut starts) {
                for &position in &self.border[range[0] as usize..range[1] as usize] {
                    let (row, value) = (place(position as usize) - 3 * nodes, values[position as usize]);
                    if value != 0.0 {
                        border.c_by_node.add(row, c, value, &mut marks[row]);
                    }
                }
            }
            border.c_by_node.finish_row();
        }
        for equation in
            layout.place.iter().enumerate().filter(|(_, place)| **place as usize >= 3 * nodes).map(|(e, _)| e)
        {
            for position in pattern.column_range(equation).filter(|&position| values[position] != 0.0) {
                let (place, value) = (place(position), values[position]);
                match place.checked_sub(3 * nodes) {
                    None => border.b.add_next(place / 3, place % 3, value),
                    Some(row) => border.d_by_column.add(row, value),
                }
            }
            border.b.finish_row();
            border.d_by_column.finish_row();
        }
        border.transpose();
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<u32>() * (self.offsets.capacity() + self.border.capacity() + self.border_starts.capacity())
    }
}

/// Components of a node that have an equation.
fn present(equations: &[u32; 3]) -> impl Iterator<Item = (usize, usize)> {
    equations.iter().enumerate().filter(|(_, equation)| **equation != NONE).map(|(c, &equation)| (c, equation as usize))
}

/// Equations of a node.
fn present_rows(layout: &Layout, node: usize) -> impl Iterator<Item = u32> {
    layout.equations[node].into_iter().filter(|&equation| equation != NONE)
}

/// The block of the rows of a node in the columns of its owner; by columns.
#[inline(always)]
fn block_of(
    layout: &Layout,
    pattern: &SparsityPattern,
    values: &[f64],
    (owner, other): (usize, usize),
    offset: u32,
) -> Block<f64, 3, 3> {
    let (columns, rows) = (&layout.equations[owner], &layout.equations[other]);
    let begins = pattern.column_pointers();
    if offset != NONE && layout.free[owner] == [true; 3] && layout.free[other] == [true; 3] {
        return columns.map(|column| {
            let begin = begins[column as usize] + offset as usize;
            std::array::from_fn(|r| values[begin + r])
        });
    }
    let mut block = [[0.0; 3]; 3];
    for (c, column) in present(columns) {
        for (k, (r, row)) in present(rows).enumerate() {
            let position = match offset {
                NONE => pattern.position(row as u32, column as u32),
                offset => Some(begins[column] + offset as usize + k),
            };
            block[c][r] = position.map_or(0.0, |position| values[position]);
        }
    }
    block
}

fn transposed(block: &Block<f64, 3, 3>) -> Block<f64, 3, 3> {
    std::array::from_fn(|r| std::array::from_fn(|c| block[c][r]))
}

/// Gives the components without equation the largest diagonal entry of the others.
fn fill_held(block: &mut Block<f64, 3, 3>, free: [bool; 3]) {
    let largest = (0..3).map(|d| block[d][d].abs()).fold(0.0, f64::max);
    for d in (0..3).filter(|&d| !free[d]) {
        block[d][d] = if largest > 0.0 { largest } else { 1.0 };
    }
}
