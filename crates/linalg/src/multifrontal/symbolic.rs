//! Everything about a factorisation that does not depend on values: places of all entries and sizes of all fronts.

use super::groups::Groups;
use super::tree::Node;
use crate::{LinalgError, NONE, SparsityPattern};

/// Subtrees of less work than this share of the whole, or than [`SMALLEST_TASK`], are factorised by one task. Fixed, so that it
/// decides nothing but speed.
const TASK_SHARE: f64 = 1.0 / 32.0;
/// Floating-point operations.
const SMALLEST_TASK: f64 = 4e6;

/// A front: `w` equations are eliminated, `r` remain. Its factors are stored by columns in one block: first the lower panel
/// (`w + r` rows, `w` columns), then, for unsymmetric values, the upper panel (`w` rows, `r` columns).
#[derive(Debug, Clone, Copy)]
pub(super) struct Front {
    /// First position (equation in the order of elimination).
    pub begin: usize,
    pub w: usize,
    pub r: usize,
    /// Where the factors start; those of the next front end them.
    pub offset: usize,
    /// Where `rows` and `places` start in the lists of [`Symbolic`].
    pub rows: usize,
    /// First front of the subtree.
    pub first: usize,
    /// The subtree is worth several tasks.
    pub shared: bool,
    /// Depth in the tree modulo 2; roots are even.
    pub odd: bool,
    /// Storage for updates that the subtree needs: by one task, and by tasks in parallel where `shared`.
    pub need: usize,
    pub need_shared: usize,
}

impl Front {
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.rows..self.rows + self.r
    }
}

/// The analysis of a pattern.
#[derive(Debug)]
pub(super) struct Symbolic {
    pub symmetric: bool,
    /// Equation at each position.
    pub order: Vec<u32>,
    /// Fronts in the order of elimination; a sentinel ends the list.
    pub fronts: Vec<Front>,
    /// Children of front `f`: `children[child_starts[f]..child_starts[f + 1]]`; the roots are those of front `len()`.
    pub child_starts: Vec<u32>,
    pub children: Vec<u32>,
    /// Positions of the remaining rows of each front.
    pub rows: Vec<u32>,
    /// Where those rows are in the parent's front.
    pub places: Vec<u32>,
    /// The matrix' entries of front `f`, `entries[entry_starts[f]..entry_starts[f + 1]]`: place in the front's block, index in the
    /// list of values.
    pub entry_starts: Vec<usize>,
    pub entries: Vec<(u32, u32)>,
    /// Largest `w` and `r`.
    pub largest: (usize, usize),
    /// Floating-point operations of a factorisation.
    pub operations: f64,
}

impl Symbolic {
    pub fn len(&self) -> usize {
        self.fronts.len() - 1
    }

    pub fn children(&self, f: usize) -> &[u32] {
        &self.children[self.child_starts[f] as usize..self.child_starts[f + 1] as usize]
    }

    /// Entries of the factors.
    pub fn factor_len(&self) -> usize {
        self.fronts[self.len()].offset
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Front>() * self.fronts.capacity()
            + size_of::<u32>()
                * (self.order.capacity()
                    + self.children.capacity()
                    + self.child_starts.capacity()
                    + self.rows.capacity()
                    + self.places.capacity())
            + size_of::<usize>() * self.entry_starts.capacity()
            + size_of::<(u32, u32)>() * self.entries.capacity()
    }

    /// # Errors
    /// [`LinalgError::TooLarge`] for a front of more than `2^32` entries.
    pub fn new(
        pattern: &SparsityPattern,
        groups: &Groups,
        nodes: &[Node],
        symmetric: bool,
    ) -> Result<Self, LinalgError> {
        let n = pattern.n();
        let count = nodes.len();
        let mut order = Vec::with_capacity(n);
        let mut position = vec![0u32; n];
        let mut front_of = Vec::with_capacity(n);
        let mut fronts: Vec<Front> = Vec::with_capacity(count + 1);
        let mut rows = Vec::new();
        for (f, node) in nodes.iter().enumerate() {
            for &g in &node.groups {
                for &equation in groups.members(g as usize) {
                    position[equation as usize] = order.len() as u32;
                    order.push(equation);
                    front_of.push(f as u32);
                }
            }
        }
        let (mut begin, mut offset, mut operations, mut largest) = (0, 0, 0.0, (0, 0));
        for node in nodes {
            let (w, r) = (node.eliminated, node.remaining);
            let block = w * (w + r) + if symmetric { 0 } else { w * r };
            if block >= NONE as usize {
                return Err(LinalgError::TooLarge { what: "entries of a front", count: block });
            }
            let first_row = rows.len();
            for &g in &node.rows {
                rows.extend(groups.members(g as usize).iter().map(|&equation| position[equation as usize]));
            }
            let (need, need_shared, first, shared) = (0, 0, fronts.len(), false);
            fronts.push(Front { begin, w, r, offset, rows: first_row, first, shared, odd: false, need, need_shared });
            begin += w;
            offset += block;
            operations += work(w, r, symmetric);
            largest = (largest.0.max(w), largest.1.max(r));
        }
        fronts.push(Front {
            begin: n,
            w: 0,
            r: 0,
            offset,
            rows: rows.len(),
            first: 0,
            shared: false,
            odd: true,
            need: 0,
            need_shared: 0,
        });
        let (child_starts, children) = children(nodes);
        let mut symbolic = Self {
            symmetric,
            order,
            fronts,
            child_starts,
            children,
            places: vec![0; rows.len()],
            rows,
            entry_starts: Vec::new(),
            entries: Vec::new(),
            largest,
            operations,
        };
        // The sentinel is the parent of the roots.
        for f in (0..=count).rev() {
            for k in symbolic.child_starts[f]..symbolic.child_starts[f + 1] {
                let child = symbolic.children[k as usize] as usize;
                symbolic.fronts[child].odd = !symbolic.fronts[f].odd;
            }
        }
        symbolic.plan_storage();
        symbolic.place(pattern, &position, &front_of);
        Ok(symbolic)
    }

    /// Subtrees, tasks, and storage for updates.
    fn plan_storage(&mut self) {
        let count = self.len();
        let mut subtree = vec![0.0; count];
        let task = SMALLEST_TASK.max(TASK_SHARE * self.operations);
        for f in 0..=count {
            let own = self.fronts[f];
            let (mut held, mut need, mut need_shared) = (0, 0, 0);
            let mut operations = if f < count { work(own.w, own.r, self.symmetric) } else { 0.0 };
            let mut first = f;
            for &c in &self.children[self.child_starts[f] as usize..self.child_starts[f + 1] as usize] {
                let child = &self.fronts[c as usize];
                need = need.max(held + child.need);
                held += child.r * child.r;
                need_shared += child.need_shared;
                operations += subtree[c as usize];
                first = first.min(child.first);
            }
            // Symmetric fronts multiply their lower panel by its pivots before the update.
            let update = own.r * own.r + if self.symmetric { own.w * own.r } else { 0 };
            let shared = operations > task;
            let front = &mut self.fronts[f];
            front.first = first;
            front.shared = shared;
            front.need = need.max(held + update);
            front.need_shared = if shared { need_shared + update } else { front.need };
            if f < count {
                subtree[f] = operations;
            }
        }
    }

    /// Places of the children's rows and of the matrix' entries.
    fn place(&mut self, pattern: &SparsityPattern, position: &[u32], front_of: &[u32]) {
        let (n, count) = (pattern.n(), self.len());
        // Entries of each front, in the order of the pattern.
        self.entry_starts = vec![0; count + 1];
        let front_of_entry = |row: usize, column: usize| {
            let (r, c) = (position[row], position[column]);
            (!self.symmetric || r >= c).then(|| front_of[r.min(c) as usize] as usize)
        };
        for j in 0..n {
            for &i in pattern.column(j) {
                if let Some(f) = front_of_entry(i as usize, j) {
                    self.entry_starts[f + 1] += 1;
                }
            }
        }
        for f in 0..count {
            self.entry_starts[f + 1] += self.entry_starts[f];
        }
        let mut next = self.entry_starts.clone();
        // For the time being an entry's row and column instead of its place.
        let mut raw = vec![(0u32, 0u32, 0u32); self.entry_starts[count]];
        for j in 0..n {
            for k in pattern.column_range(j) {
                let i = pattern.row_indices()[k] as usize;
                if let Some(f) = front_of_entry(i, j) {
                    raw[next[f]] = (position[i], position[j], k as u32);
                    next[f] += 1;
                }
            }
        }
        let mut local = vec![0u32; n];
        self.entries = Vec::with_capacity(raw.len());
        for f in 0..count {
            let Front { begin, w, r, .. } = self.fronts[f];
            (0..w).for_each(|k| local[begin + k] = k as u32);
            let rows = &self.rows[self.fronts[f].rows()];
            rows.iter().enumerate().for_each(|(k, &row)| local[row as usize] = (w + k) as u32);
            for &(row, column, k) in &raw[self.entry_starts[f]..self.entry_starts[f + 1]] {
                let (i, j) = (local[row as usize] as usize, local[column as usize] as usize);
                let place = if j < w { i + j * (w + r) } else { w * (w + r) + i + (j - w) * w };
                self.entries.push((place as u32, k));
            }
            for &c in &self.children[self.child_starts[f] as usize..self.child_starts[f + 1] as usize] {
                for k in self.fronts[c as usize].rows() {
                    self.places[k] = local[self.rows[k] as usize];
                }
            }
        }
    }
}

/// Children by parent, in increasing order; the last list is that of the roots.
fn children(nodes: &[Node]) -> (Vec<u32>, Vec<u32>) {
    let count = nodes.len();
    let parent = |node: &Node| if node.parent == NONE { count } else { node.parent as usize };
    let mut starts = vec![0u32; count + 2];
    nodes.iter().for_each(|node| starts[parent(node) + 1] += 1);
    for f in 0..=count {
        starts[f + 1] += starts[f];
    }
    let mut next = starts.clone();
    let mut list = vec![0u32; count];
    for (f, node) in nodes.iter().enumerate() {
        let slot = &mut next[parent(node)];
        list[*slot as usize] = f as u32;
        *slot += 1;
    }
    (starts, list)
}

/// Floating-point operations of a front.
fn work(w: usize, r: usize, symmetric: bool) -> f64 {
    let (w, r) = (w as f64, r as f64);
    (2.0 * w * w * w / 3.0 + 2.0 * w * w * r + 2.0 * w * r * r) * if symmetric { 0.5 } else { 1.0 }
}
