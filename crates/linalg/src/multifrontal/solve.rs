//! Substitution with the factors of the fronts, one right-hand side.
//!
//! A front takes what its children add to its rows, and after the way back hands them what they need: like the factorisation, so that subtrees are
//! tasks that share nothing, and the sums are the same for any number of threads.

use super::numeric::Numeric;
use super::symbolic::{Front, Symbolic};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Vectors for the substitution: the right-hand side in the order of elimination, for each front what passes between it and its parent, and
/// scratch for each task.
#[derive(Debug, Default)]
pub(super) struct Vectors {
    ordered: Vec<f64>,
    passed: Vec<f64>,
    scratch: Mutex<Vec<Vec<f64>>>,
}

impl Vectors {
    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let pool = self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let scratch = pool.iter().map(Vec::capacity).sum::<usize>();
        size_of::<f64>() * (self.ordered.capacity() + self.passed.capacity() + scratch)
    }
}

/// Overwrites `v` by the solution for the right-hand side `v`.
pub(super) fn solve(symbolic: &Symbolic, numeric: &Numeric, vectors: &mut Vectors, v: &mut [f64]) {
    let root = symbolic.len();
    vectors.passed.resize(symbolic.rows.len(), 0.0);
    vectors.ordered.clear();
    vectors.ordered.extend(symbolic.order.iter().map(|&equation| v[equation as usize]));
    let parallel = rayon::current_num_threads() > 1 && symbolic.fronts[root].shared;
    for way in [Way::Forward, Way::Backward] {
        let run = Run { symbolic, numeric, parallel, way, scratch: &vectors.scratch };
        let part = Part { x: &mut vectors.ordered, passed: &mut vectors.passed };
        if parallel { run.children(root, part) } else { run.stack(0, root, part) }
    }
    for (&equation, x) in symbolic.order.iter().zip(&vectors.ordered) {
        v[equation as usize] = *x;
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Way {
    Forward,
    Backward,
}

/// Slices of the vectors that belong to one subtree.
struct Part<'a> {
    x: &'a mut [f64],
    passed: &'a mut [f64],
}

struct Run<'a> {
    symbolic: &'a Symbolic,
    numeric: &'a Numeric,
    parallel: bool,
    way: Way,
    scratch: &'a Mutex<Vec<Vec<f64>>>,
}

impl Run<'_> {
    /// Fronts `first..end`, which are whole subtrees, one after the other.
    fn stack(&self, first: usize, end: usize, part: Part<'_>) {
        let mut t = self.take_scratch();
        if self.way == Way::Forward {
            (first..end).for_each(|f| self.front(f, first, part.x, part.passed, &mut t));
        } else {
            (first..end).rev().for_each(|f| self.front(f, first, part.x, part.passed, &mut t));
        }
        self.return_scratch(t);
    }

    fn subtree(&self, f: usize, part: Part<'_>) {
        let front = self.symbolic.fronts[f];
        if !(front.shared && self.parallel) {
            return self.stack(front.first, f + 1, part);
        }
        let below = |part: &mut Part<'_>| {
            let (base, end) = (self.symbolic.fronts[front.first], front);
            let part =
                Part { x: &mut part.x[..end.begin - base.begin], passed: &mut part.passed[..end.rows - base.rows] };
            self.children(f, part);
        };
        let mut part = part;
        if self.way == Way::Forward {
            below(&mut part);
        }
        let mut t = self.take_scratch();
        self.front(f, front.first, part.x, part.passed, &mut t);
        self.return_scratch(t);
        if self.way == Way::Backward {
            below(&mut part);
        }
    }

    /// The children of front `f` as parallel tasks.
    fn children(&self, f: usize, part: Part<'_>) {
        let (mut x, mut passed) = (part.x, part.passed);
        let mut tasks = Vec::with_capacity(self.symbolic.children(f).len());
        for &c in self.symbolic.children(f) {
            let (child, after) = (self.symbolic.fronts[c as usize], self.symbolic.fronts[c as usize + 1]);
            let base = self.symbolic.fronts[child.first];
            let (own_x, rest) = x.split_at_mut(after.begin - base.begin);
            x = rest;
            let (own_passed, rest) = passed.split_at_mut(after.rows - base.rows);
            passed = rest;
            tasks.push((c as usize, Part { x: own_x, passed: own_passed }));
        }
        tasks.into_par_iter().for_each(|(c, part)| self.subtree(c, part));
    }

    /// One front of a part that begins with front `first`.
    fn front(&self, f: usize, first: usize, x: &mut [f64], passed: &mut [f64], t: &mut [f64]) {
        let Self { symbolic, numeric, .. } = self;
        let base = symbolic.fronts[first];
        let Front { begin, w, r, offset, rows, .. } = symbolic.fronts[f];
        let x = &mut x[begin - base.begin..][..w];
        let (below, own) = passed.split_at_mut(rows - base.rows);
        let own = &mut own[..r];
        let children = symbolic.children(f).iter().map(|&c| {
            let rows = symbolic.fronts[c as usize + 1].rows;
            let from = symbolic.fronts[c as usize].rows;
            (from - base.rows..rows - base.rows, &symbolic.places[from..rows])
        });
        let block = &numeric.factors[offset..symbolic.fronts[f + 1].offset];
        let (lower, upper) = block.split_at((w + r) * w);
        let pivots = &numeric.pivots[begin..begin + w];
        let t = &mut t[..w + r];
        if self.way == Way::Forward {
            t[..w].copy_from_slice(x);
            t[w..].fill(0.0);
            for (range, places) in children {
                for (&place, value) in places.iter().zip(&below[range]) {
                    t[place as usize] += value;
                }
            }
            x.copy_from_slice(&t[..w]);
            for (t, &p) in t.iter_mut().zip(pivots) {
                *t = x[p as usize];
            }
            forward(lower, w, t);
            x.copy_from_slice(&t[..w]);
            own.copy_from_slice(&t[w..]);
            return;
        }
        t[..w].copy_from_slice(x);
        t[w..].copy_from_slice(own);
        if symbolic.symmetric {
            divide(lower, w + r, &numeric.subdiagonal[begin..begin + w], &mut t[..w]);
            backward_transposed(lower, w, t);
            for (t, &p) in t.iter().zip(pivots) {
                x[p as usize] = *t;
            }
            t[..w].copy_from_slice(x);
        } else {
            let (t, known) = t.split_at_mut(w);
            subtract(upper, w, known, t);
            backward(lower, w, w + r, t);
            x.copy_from_slice(t);
        }
        for (range, places) in children {
            for (&place, value) in places.iter().zip(&mut below[range]) {
                *value = t[place as usize];
            }
        }
    }

    fn take_scratch(&self) -> Vec<f64> {
        let mut scratch = self.scratch.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        let (w, r) = self.symbolic.largest;
        scratch.resize(w + r, 0.0);
        scratch
    }

    fn return_scratch(&self, scratch: Vec<f64>) {
        self.scratch.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
    }
}

/// `t <- L^-1 t` for the first `w` entries, `t <- t - L t` for the others; unit diagonal.
fn forward(lower: &[f64], w: usize, t: &mut [f64]) {
    let m = t.len();
    for first in (0..w).step_by(4) {
        let width = 4.min(w - first);
        for k in first..first + width {
            let x = t[k];
            let column = &lower[k * m..][..first + width];
            t[k + 1..first + width].iter_mut().zip(&column[k + 1..]).for_each(|(t, a)| *t -= a * x);
        }
        let (x, t) = t[first..].split_at_mut(width);
        subtract_columns(&lower[first * m..], m, first + width, x, t);
    }
}

/// `t <- t - U x`.
fn subtract(upper: &[f64], w: usize, x: &[f64], t: &mut [f64]) {
    for (columns, x) in upper.chunks(4 * w).zip(x.chunks(4)) {
        subtract_columns(columns, w, 0, x, t);
    }
}

/// `t <- t - A x` with the rows from `top` on of at most four columns of height `m`: four at a time spare most of the traffic of `t`.
#[inline]
fn subtract_columns(columns: &[f64], m: usize, top: usize, x: &[f64], t: &mut [f64]) {
    if let &[x0, x1, x2, x3] = x {
        let column = |k: usize| &columns[k * m + top..(k + 1) * m][..t.len()];
        let (a, b, c, d) = (column(0), column(1), column(2), column(3));
        for i in 0..t.len() {
            t[i] -= (a[i] * x0 + b[i] * x1) + (c[i] * x2 + d[i] * x3);
        }
    } else {
        for (column, x) in columns.chunks(m).zip(x) {
            t.iter_mut().zip(&column[top..]).for_each(|(t, a)| *t -= a * x);
        }
    }
}

/// `t <- U^-1 t` with the upper triangle of the first `w` rows of the panel of height `m`.
fn backward(lower: &[f64], w: usize, m: usize, t: &mut [f64]) {
    for k in (0..w).rev() {
        let column = &lower[k * m..][..k + 1];
        t[k] /= column[k];
        let x = t[k];
        t[..k].iter_mut().zip(column).for_each(|(t, a)| *t -= a * x);
    }
}

/// `t <- D^-1 t`.
fn divide(lower: &[f64], m: usize, subdiagonal: &[f64], t: &mut [f64]) {
    let mut k = 0;
    while k < t.len() {
        let a = lower[k * m + k];
        if subdiagonal[k] == 0.0 {
            t[k] /= a;
            k += 1;
        } else {
            let (b, c) = (subdiagonal[k], lower[(k + 1) * m + k + 1]);
            let (x, y, determinant) = (t[k], t[k + 1], a * c - b * b);
            t[k] = (c * x - b * y) / determinant;
            t[k + 1] = (a * y - b * x) / determinant;
            k += 2;
        }
    }
}

/// `t <- L^-T t` for the first `w` entries; the others are known.
fn backward_transposed(lower: &[f64], w: usize, t: &mut [f64]) {
    let m = t.len();
    for k in (0..w).rev() {
        let (head, tail) = t.split_at_mut(k + 1);
        head[k] -= dot(&lower[k * m + k + 1..][..m - k - 1], tail);
    }
}

/// Eight partial sums, which the compiler can keep in vector registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (mut p, mut q) = (a.chunks_exact(8), b.chunks_exact(8));
    for (a, b) in p.by_ref().zip(q.by_ref()) {
        for l in 0..8 {
            sums[l] += a[l] * b[l];
        }
    }
    let rest: f64 = p.remainder().iter().zip(q.remainder()).map(|(a, b)| a * b).sum();
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}
