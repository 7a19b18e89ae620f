//! Substitution with the factors of the fronts, one right-hand side.

use super::numeric::Numeric;
use super::symbolic::{Front, Symbolic};

/// Vectors for the substitution: the right-hand side in the order of elimination, a front's part of it, and scratch.
#[derive(Debug, Default)]
pub(super) struct Vectors {
    ordered: Vec<f64>,
    local: Vec<f64>,
    column: Vec<f64>,
}

impl Vectors {
    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<f64>() * (self.ordered.capacity() + self.local.capacity() + self.column.capacity())
    }
}

/// Overwrites `v` by the solution for the right-hand side `v`.
pub(super) fn solve(symbolic: &Symbolic, numeric: &Numeric, vectors: &mut Vectors, v: &mut [f64]) {
    let (w, r) = symbolic.largest;
    vectors.local.resize(w + r, 0.0);
    vectors.column.resize(w, 0.0);
    vectors.ordered.clear();
    vectors.ordered.extend(symbolic.order.iter().map(|&equation| v[equation as usize]));
    let x = &mut vectors.ordered;
    for f in 0..symbolic.len() {
        let front = symbolic.fronts[f];
        let Front { begin, w, r, offset, .. } = front;
        let lower = &numeric.factors[offset..offset + (w + r) * w];
        let t = &mut vectors.local[..w + r];
        for (t, &p) in t.iter_mut().zip(&numeric.pivots[begin..begin + w]) {
            *t = x[begin + p as usize];
        }
        t[w..].fill(0.0);
        forward(lower, w, t);
        x[begin..begin + w].copy_from_slice(&t[..w]);
        for (&row, t) in symbolic.rows[front.rows()].iter().zip(&t[w..]) {
            x[row as usize] += t;
        }
    }
    for f in (0..symbolic.len()).rev() {
        let front = symbolic.fronts[f];
        let Front { begin, w, r, offset, .. } = front;
        let block = &numeric.factors[offset..symbolic.fronts[f + 1].offset];
        let (lower, upper) = block.split_at((w + r) * w);
        let t = &mut vectors.local[..w + r];
        t[..w].copy_from_slice(&x[begin..begin + w]);
        for (&row, t) in symbolic.rows[front.rows()].iter().zip(&mut t[w..]) {
            *t = x[row as usize];
        }
        if symbolic.symmetric {
            divide(lower, w + r, &numeric.subdiagonal[begin..begin + w], &mut t[..w]);
            backward_transposed(lower, w, t);
            for (t, &p) in t.iter().zip(&numeric.pivots[begin..begin + w]) {
                x[begin + p as usize] = *t;
            }
        } else {
            let (t, below) = t.split_at_mut(w);
            subtract(upper, w, below, t);
            backward(lower, w, w + r, t);
            x[begin..begin + w].copy_from_slice(t);
        }
    }
    for (&equation, x) in symbolic.order.iter().zip(&*x) {
        v[equation as usize] = *x;
    }
}

/// `t <- L^-1 t` for the first `w` entries, `t <- t - L t` for the others; unit diagonal.
fn forward(lower: &[f64], w: usize, t: &mut [f64]) {
    let m = t.len();
    let mut k = 0;
    // Two columns at a time halve the traffic of `t`.
    while k + 1 < w {
        let (a, b) = (&lower[k * m..][..m], &lower[(k + 1) * m..][..m]);
        let x = t[k];
        let y = t[k + 1] - a[k + 1] * x;
        t[k + 1] = y;
        for ((t, a), b) in t[k + 2..].iter_mut().zip(&a[k + 2..]).zip(&b[k + 2..]) {
            *t -= a * x + b * y;
        }
        k += 2;
    }
    if k < w {
        let x = t[k];
        t[k + 1..].iter_mut().zip(&lower[k * m + k + 1..][..m - k - 1]).for_each(|(t, a)| *t -= a * x);
    }
}

/// `t <- t - U x`.
fn subtract(upper: &[f64], w: usize, x: &[f64], t: &mut [f64]) {
    let mut pairs = upper.chunks_exact(2 * w);
    let mut xs = x.chunks_exact(2);
    for (columns, x) in pairs.by_ref().zip(xs.by_ref()) {
        let (a, b) = columns.split_at(w);
        for ((t, a), b) in t.iter_mut().zip(a).zip(b) {
            *t -= a * x[0] + b * x[1];
        }
    }
    for (column, x) in pairs.remainder().chunks_exact(w).zip(xs.remainder()) {
        t.iter_mut().zip(column).for_each(|(t, a)| *t -= a * x);
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

/// Four partial sums, which the compiler can keep in vector registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (mut p, mut q) = (a.chunks_exact(4), b.chunks_exact(4));
    for (a, b) in p.by_ref().zip(q.by_ref()) {
        for l in 0..4 {
            sums[l] += a[l] * b[l];
        }
    }
    let rest: f64 = p.remainder().iter().zip(q.remainder()).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
