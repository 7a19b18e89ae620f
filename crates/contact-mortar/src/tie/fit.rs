//! Moves slave nodes of the reference so that the gap vectors vanish.

use super::rows::ConstraintRow;
use crate::MortarError;

/// Residual, relative to that at the start, at which the iteration stops.
const TOLERANCE: f64 = 1e-14;
/// The smallest residual that counts, in edge lengths.
const ROUND_OFF: f64 = 1e-15;
/// Worse than this, relative to the start, is a failure. What is left is no error of the run, for the constraint then
/// closes it.
const FAILURE: f64 = 1e-8;

/// `D_AB` of one component, each row over its largest entry, between the nodes of the rows that keep it.
struct SlaveMatrix {
    rows: Vec<Vec<(u32, f64)>>,
}

impl SlaveMatrix {
    fn multiply(&self, x: &[f64], out: &mut [f64]) {
        for (o, row) in out.iter_mut().zip(&self.rows) {
            *o = row.iter().map(|&(k, v)| v * x[k as usize]).sum();
        }
    }

    fn multiply_transposed(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (x, row) in x.iter().zip(&self.rows) {
            for &(k, v) in row {
                out[k as usize] += v * x;
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Moves the slave nodes of `rows` in `q` so that their gap vectors vanish: `D dx = -g` in each component, by
/// conjugate gradients on the normal equations. `D` is the mass matrix of a surface (or diagonal); scaled by the largest
/// entries of its rows it has a condition of about ten on any mesh, so some tens of iterations give all digits, without a
/// factorisation.
///
/// # Errors
/// [`MortarError::Fit`].
pub(super) fn close(rows: &[ConstraintRow], length: f64, q: &mut [f64]) -> Result<(), MortarError> {
    for component in 0..3 {
        let kept: Vec<&ConstraintRow> = rows.iter().filter(|row| row.kept[component]).collect();
        let local = |node: u32| kept.binary_search_by_key(&node, |row| row.node).ok();
        let mut right = Vec::with_capacity(kept.len());
        let mut matrix = SlaveMatrix { rows: Vec::with_capacity(kept.len()) };
        for row in &kept {
            let entries = row.entries.iter().filter(|e| e.is_slave);
            let coefficients = entries.clone().map(|e| e.coefficients[component]);
            // The first of equals, which is the diagonal of linear faces.
            let largest = coefficients.fold(0.0, |most: f64, c| if c.abs() > most.abs() { c } else { most });
            right.push(-row.gap(q)[component] / largest);
            let scaled = entries
                .filter_map(|e| local(e.node).map(|k| (k as u32, e.coefficients[component] / largest)))
                .collect();
            matrix.rows.push(scaled);
        }
        let n = right.len();
        let (mut x, mut s, mut p, mut ap) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut r = right;
        let start = dot(&r, &r).sqrt();
        let enough = TOLERANCE * start + ROUND_OFF * length * (n as f64).sqrt();
        matrix.multiply_transposed(&r, &mut s);
        p.copy_from_slice(&s);
        let mut gamma = dot(&s, &s);
        let mut best = start;
        let mut stale = 0;
        for _ in 0..20 * n.max(50) {
            if best <= enough || gamma == 0.0 || stale > 20 {
                break;
            }
            matrix.multiply(&p, &mut ap);
            let alpha = gamma / dot(&ap, &ap);
            for k in 0..n {
                x[k] += alpha * p[k];
                r[k] -= alpha * ap[k];
            }
            matrix.multiply_transposed(&r, &mut s);
            let next = dot(&s, &s);
            for k in 0..n {
                p[k] = s[k] + next / gamma * p[k];
            }
            gamma = next;
            let residual = dot(&r, &r).sqrt();
            stale = if residual < best { 0 } else { stale + 1 };
            best = best.min(residual);
        }
        let residual = dot(&r, &r).sqrt();
        if residual.is_nan() || residual > FAILURE * start + enough {
            return Err(MortarError::Fit { component, residual: residual / start });
        }
        for (row, dx) in kept.iter().zip(&x) {
            q[3 * row.node as usize + component] += dx;
        }
    }
    Ok(())
}
