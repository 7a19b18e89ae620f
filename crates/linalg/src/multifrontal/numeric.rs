//! The numeric phase: fronts are assembled and factorised, children before parents.
//!
//! A front's fully summed columns are assembled where its factors are stored; only the square update matrix for the parent
//! lives in the arena, of which both ends are stacks: fronts of even depth put their update on the one, those of odd depth on the other, so that
//! the updates of the children, which are the uppermost ones of the other stack, are in nobody's way and nothing is ever moved. Subtrees own contiguous parts of factors and pivots, so that tasks share nothing. The children's updates
//! are added in the order of the children whoever computed them: the bits do not depend on the number of threads.

use super::symbolic::{Front, Symbolic};
use crate::LinalgError;
use crate::faer_backend::{FrontWork, factorise_ldl_front, factorise_lu_front, negative_pivots};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Columns of a front to which one task adds the children's updates.
const COLUMNS: usize = 64;

/// Fewer entries of a front are not worth several tasks.
const SMALLEST_SUM: usize = 50_000;

/// The factors, and the memory to compute them in.
#[derive(Debug, Default)]
pub(super) struct Numeric {
    pub factors: Vec<f64>,
    /// Row exchanges inside the fronts: row `pivots[k]` of the front came to place `k`.
    pub pivots: Vec<u32>,
    /// Symmetric values: off-diagonals of the 2 x 2 pivots, 0 for 1 x 1 pivots.
    pub subdiagonal: Vec<f64>,
    arena: Vec<f64>,
    work: Mutex<Vec<FrontWork>>,
}

/// Slices of the factors and of the storage that belong to one subtree.
struct Part<'a> {
    factors: &'a mut [f64],
    pivots: &'a mut [u32],
    subdiagonal: &'a mut [f64],
    arena: &'a mut [f64],
}

/// A front has no acceptable pivot.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoPivot;

impl Numeric {
    /// Makes room for the factors.
    pub fn fit(&mut self, symbolic: &Symbolic) {
        let n = symbolic.order.len();
        self.factors.resize(symbolic.factor_len(), 0.0);
        self.pivots.resize(n, 0);
        self.subdiagonal.resize(if symbolic.symmetric { n } else { 0 }, 0.0);
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let pool = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        size_of::<f64>() * (self.factors.capacity() + self.subdiagonal.capacity() + self.arena.capacity())
            + size_of::<u32>() * self.pivots.capacity()
            + pool.iter().map(FrontWork::memory_bytes).sum::<usize>()
    }

    /// Negative pivots of symmetric factors.
    pub fn negative_pivots(&self, symbolic: &Symbolic) -> usize {
        let fronts = &symbolic.fronts[..symbolic.len()];
        let of_front = |front: &Front| {
            let pivots = front.begin..front.begin + front.w;
            negative_pivots(&self.factors[front.offset..], front.w + front.r, &self.subdiagonal[pivots])
        };
        fronts.iter().map(of_front).sum()
    }

    /// Factorises; with more than one thread by tasks.
    ///
    /// # Errors
    /// `Ok(Err(_))` if a pivot is missing; [`LinalgError::Backend`] for want of memory.
    pub fn factorise(&mut self, symbolic: &Symbolic, values: &[f64]) -> Result<Result<(), NoPivot>, LinalgError> {
        let threads = rayon::current_num_threads();
        let root = symbolic.fronts[symbolic.len()];
        let parallel = threads > 1 && root.shared;
        let need = if parallel { root.need_shared } else { root.need };
        if self.arena.len() < need {
            self.arena.resize(need, 0.0);
        }
        {
            let pool = self.work.get_mut().unwrap_or_else(PoisonError::into_inner);
            while pool.len() < if parallel { threads } else { 1 } {
                pool.push(FrontWork::new(symbolic.largest.0, symbolic.symmetric)?);
            }
        }
        let part = Part {
            factors: &mut self.factors,
            pivots: &mut self.pivots,
            subdiagonal: &mut self.subdiagonal,
            arena: &mut self.arena,
        };
        let run = Run { symbolic, values, parallel, work: &self.work };
        Ok(if parallel { run.children(symbolic.len(), part).map(|_| ()) } else { run.stack(0, symbolic.len(), part) })
    }
}

struct Run<'a> {
    symbolic: &'a Symbolic,
    values: &'a [f64],
    parallel: bool,
    work: &'a Mutex<Vec<FrontWork>>,
}

impl Run<'_> {
    /// Fronts `first..end`, which are whole subtrees, one after the other. The update of the last one comes to the start of the arena.
    fn stack(&self, first: usize, end: usize, part: Part<'_>) -> Result<(), NoPivot> {
        let mut work = self.take_work();
        let (mut factors, mut pivots, mut subdiagonal) = (part.factors, part.pivots, part.subdiagonal);
        let last_odd = end > first && self.symbolic.fronts[end - 1].odd;
        // What is free of the arena.
        let (mut low, mut high) = (0, part.arena.len());
        let mut result = Ok(());
        for f in first..end {
            let front = self.symbolic.fronts[f];
            let (own, rest) = factors.split_at_mut(self.symbolic.fronts[f + 1].offset - front.offset);
            factors = rest;
            let (own_pivots, rest) = pivots.split_at_mut(front.w);
            pivots = rest;
            let (own_subdiagonal, rest) = subdiagonal.split_at_mut(if self.symmetric() { front.w } else { 0 });
            subdiagonal = rest;
            let children = self.symbolic.children(f).iter().map(|&c| self.symbolic.fronts[c as usize]);
            let (size, held): (usize, usize) = (front.r * front.r, children.clone().map(|c| c.r * c.r).sum());
            if front.odd == last_odd {
                let (free, updates) = part.arena.split_at_mut(high);
                let (update, free) = free[low..].split_at_mut(size);
                let updates = children.scan(held, |at, child| {
                    *at -= child.r * child.r;
                    Some((child, &updates[*at..*at + child.r * child.r]))
                });
                result = self.front(f, (own, own_pivots, own_subdiagonal), update, updates, free, &mut work);
                (low, high) = (low + size, high + held);
            } else {
                let (updates, free) = part.arena.split_at_mut(low);
                let (free, update) = free[..high - low].split_at_mut(high - low - size);
                let updates = children.scan(low - held, |at, child| {
                    *at += child.r * child.r;
                    Some((child, &updates[*at - child.r * child.r..*at]))
                });
                result = self.front(f, (own, own_pivots, own_subdiagonal), update, updates, free, &mut work);
                (low, high) = (low - held, high - size);
            }
            if result.is_err() {
                break;
            }
        }
        self.return_work(work);
        result
    }

    /// A subtree; its update comes to the start of the arena.
    fn subtree(&self, f: usize, part: Part<'_>) -> Result<(), NoPivot> {
        let front = self.symbolic.fronts[f];
        if !front.shared {
            return self.stack(front.first, f + 1, part);
        }
        let base = self.symbolic.fronts[front.first];
        let (below, own) = part.factors.split_at_mut(front.offset - base.offset);
        let (pivots_below, own_pivots) = part.pivots.split_at_mut(front.begin - base.begin);
        let split = if self.symmetric() { front.begin - base.begin } else { 0 };
        let (subdiagonal_below, own_subdiagonal) = part.subdiagonal.split_at_mut(split);
        let (update, arena) = part.arena.split_at_mut(front.r * front.r);
        let below = Part { factors: below, pivots: pivots_below, subdiagonal: subdiagonal_below, arena: &mut *arena };
        let top = self.children(f, below)?;
        let (held, free) = arena.split_at_mut(top);
        let updates = self.symbolic.children(f).iter().scan(0, |at, &c| {
            let child = self.symbolic.fronts[c as usize];
            *at += child.need_shared;
            Some((child, &held[*at - child.need_shared..][..child.r * child.r]))
        });
        let mut work = self.take_work();
        let result = self.front(f, (own, own_pivots, own_subdiagonal), update, updates, free, &mut work);
        self.return_work(work);
        result
    }

    fn symmetric(&self) -> bool {
        self.symbolic.symmetric
    }

    /// The children of front `f` as parallel tasks. Returns the storage that they took.
    fn children(&self, f: usize, part: Part<'_>) -> Result<usize, NoPivot> {
        let (mut factors, mut pivots, mut subdiagonal, mut arena) =
            (part.factors, part.pivots, part.subdiagonal, part.arena);
        let mut taken = 0;
        let mut tasks = Vec::with_capacity(self.symbolic.children(f).len());
        for &c in self.symbolic.children(f) {
            let child = self.symbolic.fronts[c as usize];
            let base = self.symbolic.fronts[child.first];
            let (own_factors, rest) = factors.split_at_mut(self.symbolic.fronts[c as usize + 1].offset - base.offset);
            factors = rest;
            let equations = child.begin + child.w - base.begin;
            let (own_pivots, rest) = pivots.split_at_mut(equations);
            pivots = rest;
            let (own_subdiagonal, rest) = subdiagonal.split_at_mut(if self.symmetric() { equations } else { 0 });
            subdiagonal = rest;
            let (own_arena, rest) = arena.split_at_mut(child.need_shared);
            arena = rest;
            taken += child.need_shared;
            let part =
                Part { factors: own_factors, pivots: own_pivots, subdiagonal: own_subdiagonal, arena: own_arena };
            tasks.push((c as usize, part));
        }
        let results: Vec<Result<(), NoPivot>> = tasks.into_par_iter().map(|(c, part)| self.subtree(c, part)).collect();
        results.into_iter().collect::<Result<Vec<()>, NoPivot>>().map(|_| taken)
    }

    /// A front: its fully summed columns are assembled and eliminated, which gives the update, to which those of the children are added.
    fn front<'u>(
        &self,
        f: usize,
        (block, pivots, subdiagonal): (&mut [f64], &mut [u32], &mut [f64]),
        update: &mut [f64],
        updates: impl Iterator<Item = (Front, &'u [f64])> + Clone + Sync,
        free: &mut [f64],
        work: &mut FrontWork,
    ) -> Result<(), NoPivot> {
        let Front { w, r, .. } = self.symbolic.fronts[f];
        block.fill(0.0);
        let entries = self.symbolic.entry_starts[f]..self.symbolic.entry_starts[f + 1];
        for &(place, k) in &self.symbolic.entries[entries] {
            block[place as usize] += self.values[k as usize];
        }
        let symmetric = self.symmetric();
        let (lower, upper) = block.split_at_mut((w + r) * w);
        // Rows that a child's column `j` has in the panels and in the update; of symmetric values those from the diagonal on.
        let from = |j: usize| if symmetric { j } else { 0 };
        self.add(lower, (f, w + r), 0, 0, updates.clone(), |j, _, end| from(j)..end);
        if !symmetric {
            self.add(upper, (f, w), w, 0, updates.clone(), |_, inner, _| 0..inner);
        }
        let eliminated = if symmetric {
            factorise_ldl_front(w, r, block, update, pivots, subdiagonal, &mut free[..w * r], work, self.parallel)
        } else {
            factorise_lu_front(w, r, block, update, pivots, work, self.parallel)
        };
        if !eliminated {
            return Err(NoPivot);
        }
        self.add(update, (f, r), w, w, updates, |j, inner, end| inner.max(from(j))..end);
        Ok(())
    }

    /// Adds the children's updates to a part of front `f`: columns of `height` entries, the first of which is the front's column `first`
    /// and begins with the front's row `top`. `rows(j, inner, end)` are the rows of a child's column `j` that count, of its `end` rows, the first `inner` of
    /// which are eliminated in the front.
    fn add<'u>(
        &self,
        target: &mut [f64],
        (f, height): (usize, usize),
        first: usize,
        top: usize,
        updates: impl Iterator<Item = (Front, &'u [f64])> + Clone + Sync,
        rows: impl Fn(usize, usize, usize) -> std::ops::Range<usize> + Sync,
    ) {
        let Front { w, shared, .. } = self.symbolic.fronts[f];
        let task = |(block, target): (usize, &mut [f64])| {
            let columns = first + block * COLUMNS..first + block * COLUMNS + target.len() / height;
            for (child, values) in updates.clone() {
                let places = &self.symbolic.places[child.rows()];
                let position = |place: usize| places.partition_point(|&p| (p as usize) < place);
                let inner = position(w);
                for j in position(columns.start)..position(columns.end) {
                    let rows = rows(j, inner, child.r);
                    let target = &mut target[(places[j] as usize - columns.start) * height..][..height];
                    let values = &values[j * child.r..][rows.clone()];
                    for (&place, value) in places[rows].iter().zip(values) {
                        target[place as usize - top] += value;
                    }
                }
            }
        };
        if self.parallel && shared && target.len() >= SMALLEST_SUM {
            target.par_chunks_mut(COLUMNS * height).enumerate().for_each(task);
        } else if height > 0 {
            target.chunks_mut(COLUMNS * height).enumerate().for_each(task);
        }
    }

    fn take_work(&self) -> FrontWork {
        let mut pool = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        // The pool holds one for each thread; a thread that waits for its tasks may run others meanwhile, hence the default.
        pool.pop().unwrap_or_default()
    }

    fn return_work(&self, work: FrontWork) {
        self.work.lock().unwrap_or_else(PoisonError::into_inner).push(work);
    }
}
