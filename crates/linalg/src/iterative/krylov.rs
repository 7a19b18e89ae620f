//! Krylov methods for a preconditioner that is not quite linear: a cycle in single precision rounds.

use super::sums::{dot, norm};
use crate::vector::axpy;

/// A matrix and its preconditioner.
pub(crate) trait Operator {
    /// `y = A x`.
    fn multiply(&mut self, x: &[f64], y: &mut [f64]);
    /// `z = M r`.
    fn precondition(&mut self, r: &[f64], z: &mut [f64]);
}

/// Report of an iteration: how it ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Report {
    pub iterations: u32,
    /// `|b - A x| / |b|`, computed from the solution.
    pub residual: f64,
    /// A direction with `d . A d <= 0` or `d . M d < 0` was met, and the iteration broken off.
    pub negative: bool,
    /// The limit was foreseen, and the iteration broken off.
    pub slow: bool,
}

impl Report {
    /// Whether the residual is as small as that. A NaN is not.
    pub fn reached(&self, tolerance: f64) -> bool {
        self.residual <= tolerance
    }
}

/// Least number of steps over which the pace of an iteration is taken.
const WINDOW: usize = 20;

/// An iteration is not broken off before so many steps: one of few soft motions is slow until it has found them, and fast then.
const PATIENCE: u32 = 60;

/// Rate at which the residual falls.
#[derive(Debug, Default)]
struct Pace {
    steps: u32,
    /// Whether nothing is broken off.
    is_off: bool,
    /// Logarithms of the relative residual, from where it was largest on: that of conjugate gradients may rise first.
    logs: Vec<f64>,
}

impl Pace {
    fn begin(&mut self, residual: f64) {
        self.steps = 0;
        self.logs.clear();
        self.logs.push(residual.ln());
    }

    /// Notes the residual after one more step. Whether the iteration would not end within `limit` steps at its pace.
    fn is_too_slow(&mut self, residual: f64, tolerance: f64, limit: u32) -> bool {
        self.steps += 1;
        let last = residual.ln();
        if last >= self.logs[0] {
            self.logs.clear();
        }
        self.logs.push(last);
        let fallen = self.logs.len() - 1;
        if self.is_off || self.steps < PATIENCE || fallen < WINDOW {
            return false;
        }
        // The faster of two: that of the later half of the steps, and of the last ones.
        let over = |window: usize| (last - self.logs[fallen - window]) / window as f64;
        let pace = over(WINDOW).min(over(WINDOW.max(fallen / 2)));
        pace >= 0.0 || f64::from(self.steps) + (tolerance.ln() - last) / pace > f64::from(limit)
    }
}

/// Iterations of [`Krylov::fgmres`] after which it begins again from its present solution.
const RESTART: usize = 60;

/// Storage of both methods; it grows with the iterations.
#[derive(Debug, Default)]
pub(crate) struct Krylov {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    basis: Vec<Vec<f64>>,
    directions: Vec<Vec<f64>>,
    pace: Pace,
}

/// `r = b - A x` and its norm.
fn residual(operator: &mut impl Operator, b: &[f64], x: &[f64], r: &mut [f64]) -> f64 {
    operator.multiply(x, r);
    r.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
    norm(r)
}

impl Krylov {
    fn fit(&mut self, n: usize) {
        for v in [&mut self.r, &mut self.z, &mut self.p, &mut self.q] {
            v.resize(n, 0.0);
        }
        for v in self.basis.iter_mut().chain(&mut self.directions) {
            v.resize(n, 0.0);
        }
    }

    /// Whether iterations go on to their limit however slow they are, from here on.
    pub fn set_patient(&mut self, is_patient: bool) {
        self.pace.is_off = is_patient;
    }

    /// Conjugate gradients for symmetric matrices, after Polak and Ribiere: the direction is orthogonal to the change of the residual, whatever the preconditioner is. From zero, until the
    /// residual is `tolerance` times `b`, or `limit` iterations are done or foreseen.
    pub fn conjugate_gradients(
        &mut self,
        operator: &mut impl Operator,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        limit: u32,
    ) -> Report {
        self.fit(b.len());
        let Self { r, z, p, q, pace, .. } = self;
        x.fill(0.0);
        r.copy_from_slice(b);
        let size = norm(b);
        let mut report = Report { iterations: 0, residual: 1.0, negative: false, slow: false };
        pace.begin(1.0);
        operator.precondition(r, z);
        p.copy_from_slice(z);
        let mut descent = dot(r, z);
        while report.iterations < limit {
            operator.multiply(p, q);
            let curvature = dot(p, q);
            if curvature <= 0.0 || descent < 0.0 {
                report.negative = true;
                return report;
            }
            let step = descent / curvature;
            axpy(step, p, x);
            axpy(-step, q, r);
            report.iterations += 1;
            report.residual = norm(r) / size;
            let ended = report.reached(tolerance) || report.residual.is_nan();
            report.slow = !ended && pace.is_too_slow(report.residual, tolerance, limit);
            if ended || report.slow {
                break;
            }
            // `r_new . z_new - r_old . z_new`, with the difference of the residuals at hand.
            operator.precondition(r, z);
            let change = -step * dot(q, z);
            let factor = change / descent;
            descent = dot(r, z);
            p.iter_mut().zip(&*z).for_each(|(p, z)| *p = z + factor * *p);
        }
        report.residual = residual(operator, b, x, r) / size;
        report
    }

    /// Flexible GMRES (Saad 1993) with modified Gram-Schmidt, from zero or on from `x`, until the true residual is `tolerance` times `b`, or `limit` iterations are done or foreseen.
    pub fn fgmres(
        &mut self,
        operator: &mut impl Operator,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        limit: u32,
        from_zero: bool,
    ) -> Report {
        self.fit(b.len());
        let n = b.len();
        let size = norm(b);
        let mut report = Report { iterations: 0, residual: 1.0, negative: false, slow: false };
        if from_zero {
            x.fill(0.0);
            self.r.copy_from_slice(b);
        } else {
            report.residual = residual(operator, b, x, &mut self.r) / size;
        }
        let Self { r, q, basis, directions, pace, .. } = self;
        pace.begin(report.residual);
        while report.residual > tolerance && report.iterations < limit && !report.slow {
            let beta = norm(r);
            // Columns of the triangular factor, rotations, the rotated right-hand side.
            let (mut triangle, mut rotations): (Vec<Vec<f64>>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
            let mut projected = vec![beta];
            let mut k = 0;
            while k < RESTART && report.iterations < limit {
                if basis.len() == k {
                    basis.push(vec![0.0; n]);
                    directions.push(vec![0.0; n]);
                }
                let (from, length) = if k == 0 { (&*r, beta) } else { (&*q, triangle_rest(&triangle)) };
                basis[k].iter_mut().zip(from).for_each(|(v, w)| *v = w / length);
                operator.precondition(&basis[k], &mut directions[k]);
                operator.multiply(&directions[k], q);
                let mut column = Vec::with_capacity(k + 2);
                for v in &basis[..=k] {
                    let part = dot(v, q);
                    axpy(-part, v, q);
                    column.push(part);
                }
                let rest = norm(q);
                for (i, &[c, s]) in rotations.iter().enumerate() {
                    let (a, b) = (column[i], column[i + 1]);
                    (column[i], column[i + 1]) = (c * a + s * b, c * b - s * a);
                }
                let diagonal = column[k].hypot(rest);
                let [c, s] = if diagonal == 0.0 { [0.0, 1.0] } else { [column[k] / diagonal, rest / diagonal] };
                column[k] = diagonal;
                column.push(rest);
                triangle.push(column);
                rotations.push([c, s]);
                let last = projected[k];
                projected[k] = c * last;
                projected.push(-s * last);
                k += 1;
                report.iterations += 1;
                report.residual = projected[k].abs() / size;
                let ended = report.reached(tolerance) || report.residual.is_nan() || rest == 0.0;
                report.slow = !ended && pace.is_too_slow(report.residual, tolerance, limit);
                if ended || report.slow {
                    break;
                }
            }
            for i in (0..k).rev() {
                let sum: f64 = (i + 1..k).map(|j| triangle[j][i] * projected[j]).sum();
                projected[i] = (projected[i] - sum) / triangle[i][i];
            }
            (0..k).for_each(|i| axpy(projected[i], &directions[i], x));
            let before = beta / size;
            report.residual = residual(operator, b, x, r) / size;
            // Nothing more to gain.
            if report.residual >= before || report.residual.is_nan() {
                break;
            }
        }
        report
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let single = [&self.r, &self.z, &self.p, &self.q];
        let all = single.into_iter().chain(&self.basis).chain(&self.directions);
        size_of::<f64>() * all.map(Vec::capacity).sum::<usize>()
    }
}

/// Length of what was left of the last product beyond the basis.
fn triangle_rest(triangle: &[Vec<f64>]) -> f64 {
    triangle.last().and_then(|column| column.last()).copied().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps until an iteration to `1e-8` with these residuals is broken off.
    fn steps(residual: impl Fn(i32) -> f64) -> Option<i32> {
        let mut pace = Pace::default();
        pace.begin(1.0);
        (1..150).find(|&k| pace.is_too_slow(residual(k), 1e-8, 150))
    }

    #[test]
    fn what_ends_within_the_limit_is_not_broken_off() {
        assert_eq!(steps(|k| 0.87_f64.powi(k)), None);
        // Residuals of conjugate gradients rise first.
        assert_eq!(steps(|k| if k < 30 { 1.2_f64.powi(k) } else { 1.2_f64.powi(30) * 0.75_f64.powi(k - 30) }), None);
        // Slow until few soft motions are found, then fast.
        assert_eq!(steps(|k| if k < 50 { 0.98_f64.powi(k) } else { 0.98_f64.powi(50) * 0.7_f64.powi(k - 50) }), None);
        assert_eq!(steps(|k| 0.95_f64.powi(k)), Some(60));
        // Fast at first, then not at all.
        assert_eq!(steps(|k| 0.7_f64.powi(k.min(15))), Some(60));
        assert_eq!(steps(|_| 0.5), Some(60));
    }
}
