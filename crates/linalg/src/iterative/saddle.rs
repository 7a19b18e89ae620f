//! Saddle points `[K B; C D]`: what the preconditioner needs beside the hierarchy of a matrix of nodes.
//!
//! With `W` block by block, a block a slot, the iteration is preconditioned by
//!
//! `z2 = -S^-1 (r2 + D W r2) - W r2`, `z1 = M (r1 + B W r2 - B (z2 + W D z2))`,
//!
//! where `M` is a cycle for `K + B W C` and `S = C E^-1 B - D` with the diagonal blocks `E` of `K` is factorised. Were `M` and `S` exact, the iteration would end after two steps for
//! every `W`. `W` is that of a light augmented Lagrangian: it holds bodies that contact alone holds. Rows are scaled to forces, so that the norm of the iteration means the same in all.

use super::bsr::{Block, Bsr, sum_with};
use super::inverse::invert;
use super::refusal::Refusal;
use crate::{LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SparsityPattern};
use std::sync::Arc;

/// Weight of the augmentation: from 0.1 to 1 the iterations are much the same.
const WEIGHT: f64 = 0.3;

/// A row that is nearly orthogonal to its own force says nothing by itself: it counts as at least this part of what the lengths of both would give.
const LEAST_COSINE: f64 = 0.1;

/// Coupling of multipliers and nodes by rows of three-vectors: those of a multiplier at nodes, or those of a node at multipliers.
#[derive(Debug, Clone, Default)]
pub(crate) struct CouplingBlock {
    pub starts: Vec<usize>,
    pub indices: Vec<u32>,
    pub values: Vec<[f64; 3]>,
}

impl CouplingBlock {
    fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.indices.clear();
        self.values.clear();
    }

    /// Adds to the entry of the present row with that index, whose place `mark` remembers.
    pub fn add(&mut self, index: usize, component: usize, value: f64, mark: &mut usize) {
        let start = *self.starts.last().unwrap_or(&0);
        if *mark < start || self.indices.get(*mark) != Some(&(index as u32)) {
            *mark = self.indices.len();
            self.indices.push(index as u32);
            self.values.push([0.0; 3]);
        }
        self.values[*mark][component] += value;
    }

    /// Adds to the last entry of the present row if it has that index, else begins a new one.
    pub fn add_next(&mut self, index: usize, component: usize, value: f64) {
        let mut last = self.indices.len().wrapping_sub(1);
        self.add(index, component, value, &mut last);
    }

    /// Ends the present row.
    pub fn finish_row(&mut self) {
        self.starts.push(self.indices.len());
    }

    fn rows(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[f64; 3])> {
        let range = self.starts[i]..self.starts[i + 1];
        self.indices[range.clone()].iter().map(|&j| j as usize).zip(&self.values[range])
    }

    /// Writes the transpose into `out`, with so many columns.
    fn transpose_into(&self, columns: usize, out: &mut Self) {
        out.starts.clear();
        out.starts.resize(columns + 1, 0);
        self.indices.iter().for_each(|&j| out.starts[j as usize + 1] += 1);
        (0..columns).for_each(|j| out.starts[j + 1] += out.starts[j]);
        out.indices.resize(self.indices.len(), 0);
        out.values.resize(self.values.len(), [0.0; 3]);
        let mut next = out.starts.clone();
        for i in 0..self.rows() {
            for (j, value) in self.row(i) {
                (out.indices[next[j]], out.values[next[j]]) = (i as u32, *value);
                next[j] += 1;
            }
        }
    }

    fn memory_bytes(&self) -> usize {
        size_of::<usize>() * self.starts.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<[f64; 3]>() * self.values.capacity()
    }
}

/// A sparse matrix between other equations.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sparse {
    starts: Vec<usize>,
    indices: Vec<u32>,
    values: Vec<f64>,
}

impl Sparse {
    fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.indices.clear();
        self.values.clear();
    }

    pub fn add(&mut self, index: usize, value: f64) {
        self.indices.push(index as u32);
        self.values.push(value);
    }

    pub fn finish_row(&mut self) {
        self.starts.push(self.indices.len());
    }

    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.starts[i]..self.starts[i + 1];
        self.indices[range.clone()].iter().map(|&j| j as usize).zip(self.values[range].iter().copied())
    }
}

/// `B`, `C` and `D` of `[K B; C D]`, values that are zero left out.
#[derive(Debug, Default)]
pub(crate) struct Border {
    nodes: usize,
    /// `B^T`: a row for each other equation.
    pub b: CouplingBlock,
    b_by_node: CouplingBlock,
    pub c: CouplingBlock,
    /// `C^T`: a row for each node.
    pub c_by_node: CouplingBlock,
    /// `D^T`.
    pub d_by_column: Sparse,
}

impl Border {
    /// Empties the border before it is filled.
    pub fn clear(&mut self, nodes: usize) {
        self.nodes = nodes;
        self.b.clear();
        self.c_by_node.clear();
        self.d_by_column.clear();
    }

    /// Transposes the blocks after they are filled.
    pub fn transpose(&mut self) {
        let others = self.b.rows();
        self.b.transpose_into(self.nodes, &mut self.b_by_node);
        self.c_by_node.transpose_into(others, &mut self.c);
    }

    /// Number of other equations.
    pub fn len(&self) -> usize {
        self.b.rows()
    }

    /// `y += factor D x`.
    fn add_d(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (column, x) in x.iter().enumerate() {
            self.d_by_column.row(column).for_each(|(row, value)| y[row] += factor * value * x);
        }
    }

    /// `y += B x` at the nodes.
    fn add_b(&self, x: &[f64], y: &mut [f64]) {
        let y = y.as_chunks_mut::<3>().0;
        for (row, x) in x.iter().enumerate() {
            for (node, value) in self.b.row(row) {
                (0..3).for_each(|d| y[node][d] += value[d] * x);
            }
        }
    }

    /// `y_r = scale_r (C x1 + D x2)_r`, `y1 += B x2`, for vectors of all equations.
    pub fn add_products(&self, scale: &[f64], x: &[f64], y: &mut [f64]) {
        let (x1, x2) = x.split_at(3 * self.nodes);
        let (y1, y2) = y.split_at_mut(3 * self.nodes);
        self.add_b(x2, y1);
        let x1 = x1.as_chunks::<3>().0;
        for (r, y) in y2.iter_mut().enumerate() {
            *y = self.c.row(r).map(|(node, c)| (0..3).map(|d| c[d] * x1[node][d]).sum::<f64>()).sum();
        }
        self.add_d(1.0, x2, y2);
        y2.iter_mut().zip(scale).for_each(|(y, scale)| *y *= scale);
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        [&self.b, &self.b_by_node, &self.c, &self.c_by_node].into_iter().map(CouplingBlock::memory_bytes).sum::<usize>()
            + size_of::<usize>() * self.d_by_column.starts.capacity()
            + 12 * self.d_by_column.indices.capacity()
    }
}

/// `W` of the equations of a slot.
#[derive(Debug)]
struct Slot {
    first: usize,
    /// Entries by rows.
    w: Vec<f64>,
    width: usize,
}

/// The preconditioner's part beside the hierarchy.
#[derive(Debug, Default)]
pub(crate) struct Saddle {
    /// What the rows of other equations are multiplied by: they are forces then, as those of nodes.
    pub scale: Vec<f64>,
    /// `C E^-1 B` of each other equation, in size.
    pub sizes: Vec<f64>,
    slots: Vec<Slot>,
    /// Slot of each other equation in that list.
    slot_of: Vec<Option<u32>>,
    schur: MultifrontalSolver,
    r2: Vec<f64>,
    wr: Vec<f64>,
    z2: Vec<f64>,
    t: Vec<f64>,
    r1: Vec<f64>,
}

/// Products through the inverse diagonal blocks of `K`.
struct Through<'a> {
    inverse: &'a [Block<f64, 3, 3>],
    /// Product by nodes; zero between uses.
    image: Vec<[f64; 3]>,
}

impl<'a> Through<'a> {
    fn new(inverse: &'a [Block<f64, 3, 3>]) -> Self {
        Self { inverse, image: vec![[0.0; 3]; inverse.len()] }
    }

    /// `E^-1 b` for a row of `B^T`.
    fn set<'b>(&mut self, b: impl Iterator<Item = (usize, &'b [f64; 3])>) {
        b.for_each(|(node, b)| {
            let inverse = &self.inverse[node];
            self.image[node] = std::array::from_fn(|r| (0..3).map(|c| inverse[r][c] * b[c]).sum());
        });
    }

    fn clear<'b>(&mut self, b: impl Iterator<Item = (usize, &'b [f64; 3])>) {
        b.for_each(|(node, _)| self.image[node] = [0.0; 3]);
    }

    fn times<'b>(&self, c: impl Iterator<Item = (usize, &'b [f64; 3])>) -> f64 {
        c.map(|(node, c)| (0..3).map(|d| c[d] * self.image[node][d]).sum::<f64>()).sum()
    }
}

fn length<'a>(row: impl Iterator<Item = (usize, &'a [f64; 3])>) -> f64 {
    row.flat_map(|(_, v)| v).map(|v| v * v).sum::<f64>().sqrt()
}

/// `K + B W C`, with the first column and the entries of row `r` of `W` by `weights(r)`.
pub(crate) fn with_products<'a>(
    k: &Bsr<f64, 3, 3>,
    border: &Border,
    weights: impl Fn(usize) -> Option<(usize, &'a [f64])> + Sync,
) -> Bsr<f64, 3, 3> {
    sum_with(k, |node, add| {
        for (r, b) in border.b_by_node.row(node) {
            let Some((first, weights)) = weights(r) else { continue };
            for (q, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                for (column, c) in border.c.row(first + q) {
                    add(column as u32, &b.map(|b| c.map(|c| weight * b * c)));
                }
            }
        }
    })
}

impl Saddle {
    /// Scales and `W`, from the border, the inverse diagonal blocks `E^-1` of `K`, and the slot of each other equation.
    pub fn set_weights(&mut self, border: &Border, inverse: &[Block<f64, 3, 3>], slots: &[Option<u32>]) {
        let through = &mut Through::new(inverse);
        let m = border.len();
        self.scale.clear();
        self.scale.resize(m, 1.0);
        self.sizes.clear();
        self.slots.clear();
        self.slot_of.clear();
        self.slot_of.resize(m, None);
        let mut first = 0;
        while first < m {
            let width = match slots[first] {
                Some(slot) => slots[first..].iter().take_while(|other| **other == Some(slot)).count(),
                None => 1,
            };
            let mut e = vec![0.0; width * width];
            let mut couples = false;
            for r in first..first + width {
                let mut own = 0.0;
                for (row, value) in border.d_by_column.row(r) {
                    if (first..first + width).contains(&row) && slots[first].is_some() {
                        e[(row - first) * width + r - first] -= value;
                    }
                    own += if row == r { value } else { 0.0 };
                }
                let (b, c) = (|| border.b.row(r), || border.c.row(r));
                through.set(b());
                let (signed, bb) = (through.times(c()), through.times(b()).abs());
                through.clear(b());
                through.set(c());
                let cc = through.times(c()).abs();
                through.clear(c());
                let by_motion = if cc > 0.0 { length(c()) / cc } else { f64::INFINITY };
                let by_force = if own != 0.0 { length(b()) / own.abs() } else { f64::INFINITY };
                let factor = by_motion.min(by_force);
                if factor.is_finite() && factor > 0.0 && slots[r].is_some() {
                    self.scale[r] = factor;
                }
                let size = signed.abs().max(LEAST_COSINE * (cc * bb).sqrt());
                self.sizes.push(size);
                couples |= size > 0.0;
                // With the sign that leaves it regular: rows of friction have another one than those of gaps.
                e[(r - first) * (width + 1)] += size.copysign(signed) / WEIGHT;
            }
            if couples && slots[first].is_some() {
                invert(&mut e, width);
                self.slot_of[first..first + width].fill(Some(self.slots.len() as u32));
                self.slots.push(Slot { first, w: e, width });
            }
            first += width;
        }
        for v in [&mut self.r2, &mut self.wr, &mut self.z2, &mut self.t] {
            v.clear();
            v.resize(m, 0.0);
        }
        self.r1.clear();
        self.r1.resize(3 * border.nodes, 0.0);
    }

    /// `S = C E^-1 B - D` and its factors, after [`Saddle::set_weights`] with the same. The analysis is kept while the pattern is the same.
    ///
    /// # Errors
    /// [`Refusal::Schur`].
    pub fn factorise(
        &mut self,
        border: &Border,
        inverse: &[Block<f64, 3, 3>],
        slots: &[Option<u32>],
    ) -> Result<(), Refusal> {
        self.factorise_through(border, &mut Through::new(inverse), slots)
            .map_err(|error| Refusal::Schur(error.to_string()))
    }

    fn factorise_through(
        &mut self,
        border: &Border,
        through: &mut Through<'_>,
        slots: &[Option<u32>],
    ) -> Result<(), LinalgError> {
        let m = border.len();
        // Column by column, with the rows that share a node.
        let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); m];
        let mut sums = vec![0.0; m];
        let mut seen = vec![u32::MAX; m];
        for (j, column) in columns.iter_mut().enumerate() {
            let mut rows: Vec<u32> = Vec::new();
            let mut add = |row: usize, value: f64, rows: &mut Vec<u32>| {
                if seen[row] != j as u32 {
                    seen[row] = j as u32;
                    sums[row] = 0.0;
                    rows.push(row as u32);
                }
                sums[row] += value;
            };
            through.set(border.b.row(j));
            for (node, _) in border.b.row(j) {
                let image = through.image[node];
                for (row, c) in border.c_by_node.row(node) {
                    add(row, (0..3).map(|d| c[d] * image[d]).sum(), &mut rows);
                }
            }
            through.clear(border.b.row(j));
            for (row, value) in border.d_by_column.row(j) {
                add(row, -value, &mut rows);
            }
            column.extend(rows.iter().map(|&row| (row, sums[row as usize])));
        }
        let pairs: Vec<[u32; 2]> =
            columns.iter().enumerate().flat_map(|(j, c)| c.iter().map(move |&(i, _)| [i, j as u32])).collect();
        let pattern = SparsityPattern::from_stencils(m, pairs.iter().map(|pair| &pair[..]))?;
        let slot_count = slots.iter().flatten().max().map_or(0, |last| last + 1);
        let labels = slots.iter().enumerate().map(|(k, slot)| slot.unwrap_or(slot_count + k as u32)).collect();
        let pattern = Arc::new(pattern.with_groups(labels)?);
        let mut values = vec![0.0; pattern.nnz()];
        for (j, column) in columns.iter().enumerate() {
            for &(i, value) in column {
                if let Some(at) = pattern.position(i, j as u32) {
                    values[at] = value;
                }
            }
        }
        self.schur.analyse(&pattern, MatrixKind::General)?;
        self.schur.factorise(&values)
    }

    /// `K + B W C`.
    pub fn augmented(&self, k: &Bsr<f64, 3, 3>, border: &Border) -> Bsr<f64, 3, 3> {
        with_products(k, border, |r| {
            let slot = &self.slots[self.slot_of[r]? as usize];
            Some((slot.first, &slot.w[(r - slot.first) * slot.width..][..slot.width]))
        })
    }

    /// `y += W x`.
    fn add_w(slots: &[Slot], x: &[f64], y: &mut [f64]) {
        for Slot { first, w, width } in slots {
            for (i, row) in w.chunks_exact(*width).enumerate() {
                y[first + i] += row.iter().zip(&x[*first..]).map(|(w, x)| w * x).sum::<f64>();
            }
        }
    }

    /// `z = M r`, of a residual whose rows are scaled.
    pub fn apply(&mut self, border: &Border, mut cycle: impl FnMut(&[f64], &mut [f64]), r: &[f64], z: &mut [f64]) {
        let n = 3 * border.nodes;
        let Self { scale, slots, schur, r2, wr, z2, t, r1, .. } = self;
        r2.iter_mut().zip(&r[n..]).zip(&*scale).for_each(|((r2, r), scale)| *r2 = r / scale);
        wr.fill(0.0);
        Self::add_w(slots, r2, wr);
        z2.copy_from_slice(r2);
        border.add_d(1.0, wr, z2);
        schur.substitute(z2);
        z2.iter_mut().zip(&*wr).for_each(|(z, w)| *z = -*z - *w);
        // `W r2 - z2 - W D z2`.
        t.fill(0.0);
        border.add_d(-1.0, z2, t);
        r2.copy_from_slice(t);
        t.iter_mut().zip(&*wr).zip(&*z2).for_each(|((t, w), z)| *t = w - z);
        Self::add_w(slots, r2, t);
        r1.copy_from_slice(&r[..n]);
        border.add_b(t, r1);
        let (z1, last) = z.split_at_mut(n);
        cycle(r1, z1);
        last.copy_from_slice(z2);
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let vectors = [&self.scale, &self.r2, &self.wr, &self.z2, &self.t, &self.r1];
        self.schur.memory_bytes()
            + size_of::<f64>() * vectors.into_iter().map(Vec::capacity).sum::<usize>()
            + self.slots.iter().map(|slot| 8 * slot.w.capacity() + size_of::<Slot>()).sum::<usize>()
    }
}
