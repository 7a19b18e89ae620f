//! Dense kernels of a multifrontal factorisation: the elimination of the first `w` of `w + r` equations of a front. Not the tree.
//!
//! Large products are cut into blocks of columns of a fixed size, so that they may run in parallel without an influence on the bits;
//! faer itself runs sequentially.

use super::Scratch;
use crate::LinalgError;
use faer::diag::DiagMut;
use faer::dyn_stack::StackReq;
use faer::linalg::cholesky::lblt::factor as pivoted;
use faer::linalg::cholesky::ldlt::factor as unpivoted;
use faer::linalg::lu::partial_pivoting::factor as lu;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve as triangular;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// A pivot below this is none: the equilibrated matrix has entries of about 1, and what is left of them after
/// cancellation is round-off.
const SMALLEST_PIVOT: f64 = 1e-15;

/// Largest multiplier without pivoting. Where displacements come before the multipliers of contact they seldom exceed it. The three digits that it may cost
/// come back with one step of refinement. (At 100, badly scaled contact of two blocks takes a tenth longer, by fronts that are factorised twice, and is not more exact.)
const LARGEST_MULTIPLIER: f64 = 1000.0;

/// Products of fewer floating-point operations are not worth several tasks.
const SMALLEST_PRODUCT: usize = 4_000_000;

/// Columns of a block of the update.
const BLOCK: usize = 96;

/// Columns of a block on the diagonal of a symmetric update.
const DIAGONAL_BLOCK: usize = 32;

/// Scratch memory of one task.
#[derive(Debug, Default)]
pub struct FrontWork {
    scratch: Scratch,
    column: Vec<f64>,
    inverse: Vec<u32>,
    symmetric: bool,
    /// Lower triangle of a symmetric front's square, in case it has to be factorised again.
    triangle: Vec<f64>,
}

impl FrontWork {
    /// Storage for fronts that eliminate at most `w` equations.
    ///
    /// # Errors
    /// [`LinalgError::Backend`] for want of memory.
    pub fn new(w: usize, symmetric: bool) -> Result<Self, LinalgError> {
        let mut work = Self::default();
        work.reserve(w, symmetric)?;
        Ok(work)
    }

    fn reserve(&mut self, w: usize, symmetric: bool) -> Result<(), LinalgError> {
        if self.column.len() >= w && self.symmetric == symmetric {
            return Ok(());
        }
        let request: StackReq = if symmetric {
            pivoted::cholesky_in_place_scratch::<u32, f64>(w, Par::Seq, Default::default())
                .or(unpivoted::cholesky_in_place_scratch::<f64>(w, Par::Seq, Default::default()))
        } else {
            lu::lu_in_place_scratch::<u32, f64>(w, w, Par::Seq, Default::default())
        };
        self.scratch = Scratch::new(request)?;
        self.column = vec![0.0; w];
        self.inverse = vec![0; w];
        self.symmetric = symmetric;
        Ok(())
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let floats = self.column.capacity() + self.triangle.capacity();
        self.scratch.bytes + floats * size_of::<f64>() + self.inverse.capacity() * size_of::<u32>()
    }
}

/// LU of a front. `block` holds the lower panel (`w + r` rows, `w` columns) and the upper one (`w` rows, `r` columns), `update` is for the
/// `r x r` rest, all by columns. Pivots are chosen among the first `w` rows: afterwards the first `w` rows of the panels are `P A = L U`,
/// the others of the lower panel `A U^-1`, and `update` is the Schur complement.
///
/// False if an equation has no acceptable pivot (or for want of memory); the factors are then worthless.
pub fn factorise_lu_front(
    w: usize,
    r: usize,
    block: &mut [f64],
    update: &mut [f64],
    pivots: &mut [u32],
    work: &mut FrontWork,
    parallel: bool,
) -> bool {
    if work.reserve(w, false).is_err() {
        return false;
    }
    let (lower, upper) = block.split_at_mut((w + r) * w);
    let (mut square, mut below) = MatMut::from_column_major_slice_mut(lower, w + r, w).split_at_row_mut(w);
    lu::lu_in_place(
        square.rb_mut(),
        pivots,
        &mut work.inverse[..w],
        Par::Seq,
        work.scratch.stack(),
        Default::default(),
    );
    if !(0..w).all(|k| acceptable(square[(k, k)].abs())) {
        return false;
    }
    if r == 0 {
        return true;
    }
    let square = square.as_ref();
    let exchanged = pivots.iter().enumerate().any(|(k, &p)| p as usize != k);
    if exchanged {
        for column in upper.chunks_exact_mut(w) {
            work.column[..w].copy_from_slice(column);
            column.iter_mut().zip(&*pivots).for_each(|(x, &p)| *x = work.column[p as usize]);
        }
    }
    let parallel_solve = parallel && w * w * r >= SMALLEST_PRODUCT;
    for_columns(upper, w, parallel_solve, |_, columns| {
        triangular::solve_unit_lower_triangular_in_place(square, columns, Par::Seq);
    });
    for_rows(below.rb_mut(), parallel_solve, &|rows| {
        triangular::solve_lower_triangular_in_place(square.transpose(), rows.transpose_mut(), Par::Seq);
    });
    let (below, upper) = (below.as_ref(), MatRef::from_column_major_slice(upper, w, r));
    for_columns(update, r, parallel && 2 * w * r * r >= SMALLEST_PRODUCT, |first, columns| {
        let upper = upper.subcols(first, columns.ncols());
        matmul(columns, Accum::Replace, below, upper, -1.0, Par::Seq);
    });
    true
}

/// `L D L^T` of a symmetric front, of which only the lower triangles are read and written; `block` is the lower panel alone. Pivots are taken as they
/// come while that goes well, else 1 x 1 or 2 x 2 (Bunch and Kaufman), chosen among the first `w` equations. Afterwards the panel is `P^T L` and
/// has the diagonal of `D`, `subdiagonal` the rest
/// of `D`. `product` (`w r` entries) is scratch.
///
/// `update`, whatever was in it, is what the elimination adds to the rest: `- L D L^T`, of which parts of the upper triangle are not computed.
///
/// False if an equation has no acceptable pivot (or for want of memory); the factors are then worthless.
pub fn factorise_ldl_front(
    w: usize,
    r: usize,
    block: &mut [f64],
    update: &mut [f64],
    pivots: &mut [u32],
    subdiagonal: &mut [f64],
    product: &mut [f64],
    work: &mut FrontWork,
    parallel: bool,
) -> bool {
    if work.reserve(w, true).is_err() {
        return false;
    }
    let (mut square, mut below) = MatMut::from_column_major_slice_mut(block, w + r, w).split_at_row_mut(w);
    if !factorise_without_pivoting(square.rb_mut(), pivots, subdiagonal, work) {
        // The last off-diagonal is not written.
        subdiagonal.fill(0.0);
        pivoted::cholesky_in_place(
            square.rb_mut(),
            DiagMut::from_slice_mut(subdiagonal),
            pivots,
            &mut work.inverse[..w],
            Par::Seq,
            work.scratch.stack(),
            Default::default(),
        );
    }
    let square = square.as_ref();
    let mut k = 0;
    while k < w {
        let pair = subdiagonal[k] != 0.0;
        let size = if pair {
            // The smaller pivot of the two is about the determinant over the largest entry.
            let (a, b, c) = (square[(k, k)], subdiagonal[k], square[(k + 1, k + 1)]);
            (a * c - b * b).abs() / a.abs().max(b.abs()).max(c.abs())
        } else {
            square[(k, k)].abs()
        };
        if !acceptable(size) {
            return false;
        }
        k += if pair { 2 } else { 1 };
    }
    if r == 0 {
        return true;
    }
    permute_columns(below.rb_mut(), pivots, &mut work.inverse[..w], &mut product[..r]);
    let mut scaled = MatMut::from_column_major_slice_mut(product, r, w);
    for_rows(below.rb_mut(), parallel && w * w * r >= SMALLEST_PRODUCT, &|rows| {
        triangular::solve_unit_lower_triangular_in_place(square, rows.transpose_mut(), Par::Seq);
    });
    // Now `below` is `L D`, which is kept in `scaled`, and becomes `L`.
    let mut k = 0;
    while k < w {
        if subdiagonal[k] == 0.0 {
            let inverse = 1.0 / square[(k, k)];
            let pairs = below.rb_mut().col_mut(k).iter_mut().zip(scaled.rb_mut().col_mut(k).iter_mut());
            pairs.for_each(|(x, kept)| {
                *kept = *x;
                *x *= inverse;
            });
            k += 1;
        } else {
            let (a, b, c) = (square[(k, k)], subdiagonal[k], square[(k + 1, k + 1)]);
            let determinant = a * c - b * b;
            let (a, b, c) = (a / determinant, b / determinant, c / determinant);
            let (first, second) = below.rb_mut().subcols_mut(k, 2).split_at_col_mut(1);
            let (kept, also_kept) = scaled.rb_mut().subcols_mut(k, 2).split_at_col_mut(1);
            let pairs = first.col_mut(0).iter_mut().zip(second.col_mut(0).iter_mut());
            let kept = kept.col_mut(0).iter_mut().zip(also_kept.col_mut(0).iter_mut());
            pairs.zip(kept).for_each(|((x, y), kept)| {
                (*kept.0, *kept.1) = (*x, *y);
                (*x, *y) = (c * *x - b * *y, a * *y - b * *x);
            });
            k += 2;
        }
    }
    let (below, scaled) = (below.as_ref(), scaled.as_ref());
    for_columns(update, r, parallel && w * r * r >= SMALLEST_PRODUCT, |first, columns| {
        let width = columns.ncols();
        let right = scaled.subrows(first, width);
        let (diagonal, rest) = columns.subrows_mut(first, r - first).split_at_row_mut(width);
        negative_lower_product(diagonal, below.subrows(first, width), right);
        let below = below.subrows(first + width, r - first - width);
        matmul(rest, Accum::Replace, below, right.transpose(), -1.0, Par::Seq);
    });
    true
}

/// Negative pivots among those of a symmetric front: `factors` begin with a panel of `height` rows as [`factorise_ldl_front`] leaves it, `subdiagonal` has an entry for each of its columns.
pub fn negative_pivots(factors: &[f64], height: usize, subdiagonal: &[f64]) -> usize {
    let diagonal = |k: usize| factors[k * height + k];
    let (mut count, mut k) = (0, 0);
    while k < subdiagonal.len() {
        let b = subdiagonal[k];
        if b == 0.0 {
            count += usize::from(diagonal(k) < 0.0);
            k += 1;
        } else {
            let (a, c) = (diagonal(k), diagonal(k + 1));
            count += if a * c < b * b { 1 } else { 2 * usize::from(a < 0.0) };
            k += 2;
        }
    }
    count
}

/// Column `order[k]` comes to place `k`, cycle by cycle, so that only columns that move are touched. `done` and `spare` (a column) are scratch.
fn permute_columns(mut matrix: MatMut<'_, f64>, order: &[u32], done: &mut [u32], spare: &mut [f64]) {
    done.fill(0);
    for first in 0..order.len() {
        if done[first] != 0 || order[first] as usize == first {
            continue;
        }
        spare.iter_mut().zip(matrix.rb().col(first).iter()).for_each(|(x, y)| *x = *y);
        let mut to = first;
        loop {
            done[to] = 1;
            let from = order[to] as usize;
            if from == first {
                break;
            }
            let (left, right) = matrix.rb_mut().split_at_col_mut(from.max(to));
            let (left, right) = (left.col_mut(from.min(to)), right.col_mut(0));
            let (mut target, source) = if from > to { (left, right) } else { (right, left) };
            target.copy_from(source.rb());
            to = from;
        }
        matrix.rb_mut().col_mut(to).iter_mut().zip(&*spare).for_each(|(x, y)| *x = *y);
    }
}

/// `L D L^T` of a square of which the lower triangle is given, if that goes well without exchanges; else the triangle is as before. It is several
/// times faster than a search for pivots.
fn factorise_without_pivoting(
    mut square: MatMut<'_, f64>,
    pivots: &mut [u32],
    subdiagonal: &mut [f64],
    work: &mut FrontWork,
) -> bool {
    let w = pivots.len();
    work.triangle.clear();
    for k in 0..w {
        work.triangle.extend(square.rb().col(k).subrows(k, w - k).iter());
    }
    let (scratch, options) = (work.scratch.stack(), Default::default());
    let result = unpivoted::cholesky_in_place(square.rb_mut(), options, Par::Seq, scratch, Default::default());
    // A NaN is no multiplier.
    let small = |column: usize| {
        let multipliers = square.rb().col(column).subrows(column + 1, w - column - 1);
        multipliers.iter().fold(true, |small, l| small & (l.abs() <= LARGEST_MULTIPLIER))
    };
    if result.is_ok() && (0..w).all(|k| acceptable(square[(k, k)].abs()) && small(k)) {
        subdiagonal.fill(0.0);
        pivots.iter_mut().zip(0..).for_each(|(pivot, k)| *pivot = k);
        return true;
    }
    let mut from = work.triangle.iter();
    for k in 0..w {
        let column = square.rb_mut().col_mut(k).subrows_mut(k, w - k);
        column.iter_mut().zip(&mut from).for_each(|(x, y)| *x = *y);
    }
    false
}

/// `target = -left right^T` for the lower triangle and parts of the upper one, which nobody reads.
fn negative_lower_product(mut target: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    let n = target.ncols();
    for first in (0..n).step_by(DIAGONAL_BLOCK) {
        let width = DIAGONAL_BLOCK.min(n - first);
        let block = target.rb_mut().submatrix_mut(first, first, n - first, width);
        let right = right.subrows(first, width).transpose();
        matmul(block, Accum::Replace, left.subrows(first, n - first), right, -1.0, Par::Seq);
    }
}

/// `task(first, block)` for all blocks of columns of a matrix of `rows` rows.
fn for_columns(matrix: &mut [f64], rows: usize, parallel: bool, task: impl Fn(usize, MatMut<'_, f64>) + Send + Sync) {
    let each = |(k, block): (usize, &mut [f64])| {
        let columns = block.len() / rows;
        task(k * BLOCK, MatMut::from_column_major_slice_mut(block, rows, columns));
    };
    if parallel {
        matrix.par_chunks_mut(rows * BLOCK).enumerate().for_each(each);
    } else {
        matrix.chunks_mut(rows * BLOCK).enumerate().for_each(each);
    }
}

/// `task(block)` for all blocks of rows.
fn for_rows(matrix: MatMut<'_, f64>, parallel: bool, task: &(impl Fn(MatMut<'_, f64>) + Sync)) {
    let rows = matrix.nrows();
    if rows <= BLOCK {
        return task(matrix);
    }
    let half = rows.div_ceil(2 * BLOCK) * BLOCK;
    let (upper, lower) = matrix.split_at_row_mut(half);
    if parallel {
        rayon::join(|| for_rows(upper, parallel, task), || for_rows(lower, parallel, task));
    } else {
        for_rows(upper, parallel, task);
        for_rows(lower, parallel, task);
    }
}

fn acceptable(size: f64) -> bool {
    size >= SMALLEST_PIVOT && size.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_permuted_by_cycles() {
        for order in [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [1, 2, 3, 4, 0], [2, 0, 1, 4, 3], [0, 3, 1, 2, 4]] {
            let mut columns: Vec<f64> = (0..10).map(f64::from).collect();
            let matrix = MatMut::from_column_major_slice_mut(&mut columns, 2, 5);
            permute_columns(matrix, &order, &mut [7; 5], &mut [0.0; 2]);
            let expected: Vec<f64> = order.iter().flat_map(|&k| [f64::from(2 * k), f64::from(2 * k + 1)]).collect();
            assert_eq!(columns, expected, "{order:?}");
        }
    }

    /// What was in the vector of off-diagonals before does not matter: the last entry is not written by the library.
    #[test]
    fn off_diagonals_need_not_be_cleared() {
        // [0 1 1; 1 3 1; 1 1 0], of which two equations are eliminated by one 2 x 2 pivot or by exchanging them; the Schur complement is 1.
        let factorise = |left_over: f64| {
            let mut block = [0.0, 1.0, 1.0, 0.0, 3.0, 1.0];
            let (mut update, mut pivots, mut product) = ([left_over], [0; 2], [left_over; 2]);
            let mut subdiagonal = [left_over; 2];
            let (update_, work) = (&mut update, &mut FrontWork::default());
            let done = factorise_ldl_front(
                2,
                1,
                &mut block,
                update_,
                &mut pivots,
                &mut subdiagonal,
                &mut product,
                work,
                false,
            );
            (done, block, update, subdiagonal)
        };
        let clean = factorise(0.0);
        assert!(clean.0 && (clean.2[0] - 1.0).abs() < 1e-15, "{clean:?}");
        assert_eq!(factorise(7.0), clean);
    }
}
