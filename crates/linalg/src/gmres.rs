//! GMRES with a preconditioner on the right, without restarts. Not a solver by itself: it uses the factors of a matrix close to the one at hand.
//!
//! Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986). Preconditioned by the factors of a matrix that differs in `r` rows it ends after `r + 1`
//! iterations; a small difference in all rows reduces the residual by about its size each time. Both is what a Newton iteration with contact
//! does to its tangent.

use crate::vector::{axpy, dot, norm2};

/// Relative residual that must be reached after a third of the iterations, as a power of the tolerance: with a tolerance of 1e-6 a tenth.
/// (Residuals fall faster later on, where the changes of single rows are used up. Chosen on the tori of `scenes/tori-friction-03.toml`; a wrong
/// choice costs time, never the answer.)
const EARLY_REDUCTION: f64 = 1.0 / 6.0;

/// Work space, kept between solutions; it grows with the largest number of iterations so far.
#[derive(Debug, Default)]
pub(crate) struct Gmres {
    /// Orthonormal basis of the Krylov space.
    basis: Vec<Vec<f64>>,
    /// Columns of the triangular factor of the Hessenberg matrix, one after the other: `k + 1` entries in column `k`.
    triangle: Vec<f64>,
    /// Cosine and sine of the rotations.
    rotations: Vec<[f64; 2]>,
    /// The rotated right-hand side of the least-squares problem.
    projected: Vec<f64>,
    work: Vec<f64>,
}

/// Iterations and residual of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GmresReport {
    pub iterations: u32,
    /// `|b - A x| / |b|`, as the recurrence gives it.
    pub residual: f64,
}

impl Gmres {
    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let vectors = self.basis.iter().map(Vec::capacity).sum::<usize>();
        let small = self.triangle.capacity() + 2 * self.rotations.capacity() + self.projected.capacity();
        size_of::<f64>() * (vectors + small + self.work.capacity())
    }

    /// Solves `A x = b` until `|b - A x| <= tolerance |b|` in the Euclidean norm, or for `limit` iterations, or until the Krylov space ends, or until
    /// the rest of the iterations will hardly be enough.
    /// `multiply(v, w)` sets `w = A v`, `precondition(v)` overwrites `v` by an approximation of `A^-1 v`. The residual is NaN if a
    /// value is not finite; `x` is then meaningless.
    pub fn solve(
        &mut self,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        limit: u32,
        mut multiply: impl FnMut(&[f64], &mut [f64]),
        mut precondition: impl FnMut(&mut [f64]),
    ) -> GmresReport {
        x.fill(0.0);
        self.triangle.clear();
        self.rotations.clear();
        self.projected.clear();
        self.work.resize(b.len(), 0.0);
        let size = norm2(b);
        if size == 0.0 || !size.is_finite() {
            return GmresReport { iterations: 0, residual: size };
        }
        self.vector(0, b, 1.0 / size);
        self.projected.push(size);
        let mut residual = 1.0;
        let mut k = 0;
        while residual > tolerance && k < limit as usize {
            self.work.copy_from_slice(&self.basis[k]);
            precondition(&mut self.work);
            let mut next = self.take(k + 1, b.len());
            multiply(&self.work, &mut next);
            let length = self.orthogonalise(k, &mut next);
            self.basis[k + 1] = next;
            residual = self.projected[k + 1].abs() / size;
            k += 1;
            let hopeless = k as u32 == limit / 3 && residual > tolerance.powf(EARLY_REDUCTION);
            if length == 0.0 || !residual.is_finite() || hopeless {
                break;
            }
        }
        if residual.is_finite() {
            self.combine(k, x, &mut precondition);
        }
        GmresReport { iterations: k as u32, residual }
    }

    /// Sets basis vector `k` to `factor * v`.
    fn vector(&mut self, k: usize, v: &[f64], factor: f64) {
        let mut basis = self.take(k, v.len());
        basis.iter_mut().zip(v).for_each(|(b, v)| *b = factor * v);
        self.basis[k] = basis;
    }

    /// The storage of basis vector `k`, taken out.
    fn take(&mut self, k: usize, n: usize) -> Vec<f64> {
        if self.basis.len() <= k {
            self.basis.resize_with(k + 1, Vec::new);
        }
        let mut vector = std::mem::take(&mut self.basis[k]);
        vector.resize(n, 0.0);
        vector
    }

    /// Makes `next` the unit vector that is orthogonal to the first `k + 1` ones (modified Gram-Schmidt), adds column `k` of the triangle and one
    /// entry of the projected right-hand side; returns the length before it was made a unit vector.
    fn orthogonalise(&mut self, k: usize, next: &mut [f64]) -> f64 {
        let start = self.triangle.len();
        for v in &self.basis[..=k] {
            let h = dot(v, next);
            axpy(-h, v, next);
            self.triangle.push(h);
        }
        let length = norm2(next);
        if length > 0.0 {
            next.iter_mut().for_each(|v| *v /= length);
        }
        let column = &mut self.triangle[start..];
        for (i, &[c, s]) in self.rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            column[i] = c * a + s * b;
            column[i + 1] = c * b - s * a;
        }
        let diagonal = column[k].hypot(length);
        // A vector that the matrix annihilates is no help.
        let [c, s] = if diagonal == 0.0 { [0.0, 1.0] } else { [column[k] / diagonal, length / diagonal] };
        column[k] = diagonal;
        self.rotations.push([c, s]);
        let g = self.projected[k];
        self.projected[k] = c * g;
        self.projected.push(-s * g);
        length
    }

    /// `x = P^-1 V y` with the `y` of the least-squares problem of size `k`.
    fn combine(&mut self, k: usize, x: &mut [f64], precondition: &mut impl FnMut(&mut [f64])) {
        // Column j begins at j (j + 1) / 2.
        let entry = |i: usize, j: usize| self.triangle[j * (j + 1) / 2 + i];
        for i in (0..k).rev() {
            let sum: f64 = (i + 1..k).map(|j| entry(i, j) * self.projected[j]).sum();
            let diagonal = entry(i, i);
            self.projected[i] = if diagonal == 0.0 { 0.0 } else { (self.projected[i] - sum) / diagonal };
        }
        for (y, v) in self.projected[..k].iter().zip(&self.basis) {
            axpy(*y, v, x);
        }
        if k > 0 {
            precondition(x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tridiagonal and unsymmetric.
    fn multiply(x: &[f64], y: &mut [f64]) {
        let n = x.len();
        for i in 0..n {
            let (before, after) = (if i > 0 { x[i - 1] } else { 0.0 }, if i + 1 < n { x[i + 1] } else { 0.0 });
            y[i] = (3.0 + i as f64 / n as f64) * x[i] - 1.5 * before - 0.5 * after;
        }
    }

    fn right_side(n: usize) -> Vec<f64> {
        (0..n).map(|i| (i as f64).sin() + 0.3).collect()
    }

    fn true_residual(b: &[f64], x: &[f64], multiply: impl Fn(&[f64], &mut [f64])) -> f64 {
        let mut r = vec![0.0; b.len()];
        multiply(x, &mut r);
        r.iter_mut().zip(b).for_each(|(r, b)| *r -= b);
        norm2(&r) / norm2(b)
    }

    #[test]
    fn reported_residual_is_the_true_one() {
        let b = right_side(60);
        let (mut gmres, mut last) = (Gmres::default(), 0);
        for tolerance in [0.5, 1e-2, 1e-4, 1e-8, 1e-12] {
            let mut x = vec![0.0; 60];
            let report = gmres.solve(&b, &mut x, tolerance, 60, multiply, |_| {});
            assert!((true_residual(&b, &x, multiply) - report.residual).abs() < 1e-14, "{tolerance}");
            assert!(report.residual <= tolerance && report.iterations > last, "{report:?}");
            last = report.iterations;
        }
        // As many as it needed, but most of them for the beginning.
        let report = gmres.solve(&b, &mut [0.0; 60], 1e-12, 9, multiply, |_| {});
        assert_eq!(report.iterations, 3);
    }

    #[test]
    fn a_change_of_few_rows_ends_after_one_more_iteration() {
        // Rows 3, 7 and 20 of the unit matrix, which is the preconditioner, are replaced.
        let changed = |x: &[f64], y: &mut [f64]| {
            y.copy_from_slice(x);
            for i in [3, 7, 20] {
                y[i] = 5.0 * x[i] - 2.0 * x[(i + 11) % 40] + 0.5 * x[i - 1];
            }
        };
        let b = right_side(40);
        let mut x = vec![0.0; 40];
        let report = Gmres::default().solve(&b, &mut x, 1e-13, 20, changed, |_| {});
        assert!(report.iterations <= 4, "{report:?}");
        assert!(true_residual(&b, &x, changed) < 1e-13);
    }

    #[test]
    fn the_exact_inverse_needs_one_iteration_and_nothing_needs_none() {
        let b = right_side(5);
        let mut x = vec![0.0; 5];
        let twice = |x: &[f64], y: &mut [f64]| y.iter_mut().zip(x).for_each(|(y, x)| *y = 2.0 * x);
        let mut gmres = Gmres::default();
        let report = gmres.solve(&b, &mut x, 1e-15, 9, twice, |v| v.iter_mut().for_each(|v| *v *= 0.5));
        assert_eq!(report.iterations, 1);
        assert!(true_residual(&b, &x, twice) < 1e-15);
        let report = gmres.solve(&[0.0; 5], &mut x, 1e-15, 9, twice, |_| {});
        assert_eq!((report.iterations, report.residual), (0, 0.0));
        assert_eq!(x, [0.0; 5]);
    }

    #[test]
    fn a_singular_matrix_and_nan_end_without_a_solution() {
        let zero = |_: &[f64], y: &mut [f64]| y.fill(0.0);
        let mut x = vec![0.0; 4];
        let report = Gmres::default().solve(&[1.0, 2.0, 0.0, 1.0], &mut x, 1e-10, 9, zero, |_| {});
        assert!(report.residual >= 1.0 && x.iter().all(|x| x.is_finite()), "{report:?}");
        let nan = |_: &[f64], y: &mut [f64]| y.fill(f64::NAN);
        let report = Gmres::default().solve(&[1.0, 2.0, 0.0, 1.0], &mut x, 1e-10, 9, nan, |_| {});
        assert!(report.residual.is_nan());
    }
}
