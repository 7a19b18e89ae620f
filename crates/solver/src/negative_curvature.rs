//! Directions in which the energy falls at a static solution, without those of layers alone: for these the negative part `sum min(lambda_i, 0) v_i v_i^T` of each contribution is left out.

use crate::assembly::System;
use crate::problem::{StepProblem, contact_step};
use crate::{Phase, StepError};

/// Sweeps of Jacobi's iteration; ten are enough for double precision.
const SWEEPS: usize = 50;

/// Part of the sum of squares that may be left off the diagonal.
const ROUND_OFF: f64 = 1.0e-30;

impl StepProblem<'_> {
    /// Independent directions in which the energy falls at a solution, from the tangent there; of potentials that keep surfaces apart only what is positive counts. Their
    /// own negative curvature is that of a layer, which is no body that buckles.
    pub fn unstable_directions(&mut self) -> usize {
        // Where the last factors had none there is none here: they belong to an iterate nearby.
        if self.system.excess == 0 || !self.counts_directions() {
            return 0;
        }
        let s = &mut *self.system;
        let values = if s.slot_equation.is_empty() { &s.solid_values } else { &s.values };
        let solver = &mut s.solver;
        let count = match self.timings.measure(Phase::Factorisation, || solver.factorise(values)) {
            Ok(()) => self.count_excess(),
            Err(_) => return 0,
        };
        if count == 0 || !self.model.keeps_apart() {
            return count;
        }
        let Ok(values) = self.without_curvature_of_layers() else { return count };
        let solver = &mut self.system.solver;
        match self.timings.measure(Phase::Factorisation, || solver.factorise(&values)) {
            Ok(()) => self.count_excess(),
            Err(_) => count,
        }
    }

    /// Values of the tangent without the negative part of each contribution of potentials that keep surfaces apart.
    fn without_curvature_of_layers(&mut self) -> Result<Vec<f64>, StepError> {
        let Self { model, system, step, iterate, .. } = self;
        let configuration = contact_step(step, &iterate.q);
        let mut values = system.values.clone();
        let System { contact_map, transform, expanded, .. } = &mut **system;
        let (mut matrix, mut vectors, mut k) = (Vec::new(), Vec::new(), 0);
        for (c, pair) in model.contacts.iter().enumerate() {
            let (pressures, auxiliaries, active) = (&iterate.pressures[c], &iterate.auxiliaries[c], &iterate.active[c]);
            let is_layer = pair.method.keeps_apart();
            pair.method.assemble_with(configuration, pressures, auxiliaries, active, is_layer, &mut |local| {
                if is_layer {
                    matrix.clear();
                    let mut rows = local.dim();
                    if model.embedding.touches(&local.nodes) {
                        let rest = rows - 3 * local.nodes.len();
                        model.embedding.expand(&local.nodes, expanded);
                        model.embedding.transform(&local.nodes, expanded, rest, &local.tangent, transform);
                        matrix.extend_from_slice(&transform.matrix);
                        rows = 3 * expanded.len() + rest;
                    } else {
                        matrix.extend_from_slice(&local.tangent);
                    }
                    if keep_negative_part(&mut matrix, rows, &mut vectors) {
                        matrix.iter_mut().for_each(|entry| *entry = -*entry);
                        contact_map.add(k, &matrix, &mut values);
                    }
                }
                k += 1;
            })?;
        }
        Ok(values)
    }
}

/// Replaces a symmetric matrix of `n` rows (row by row) by its negative part; false, and nothing useful is left in it, if it has none.
fn keep_negative_part(matrix: &mut [f64], n: usize, vectors: &mut Vec<f64>) -> bool {
    vectors.clear();
    vectors.resize(n * n, 0.0);
    (0..n).for_each(|i| vectors[i * n + i] = 1.0);
    for _ in 0..SWEEPS {
        let (mut off, mut all) = (0.0, 0.0);
        for i in 0..n {
            for j in 0..n {
                let square = matrix[i * n + j] * matrix[i * n + j];
                all += square;
                off += if i == j { 0.0 } else { square };
            }
        }
        if off <= ROUND_OFF * all {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(matrix, vectors, n, p, q);
            }
        }
    }
    let eigenvalues: Vec<f64> = (0..n).map(|i| matrix[i * n + i]).collect();
    let largest = eigenvalues.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    // What round-off leaves of zero is no curvature.
    let is_negative = |value: f64| value < -f64::EPSILON * n as f64 * largest;
    if !eigenvalues.iter().any(|&value| is_negative(value)) {
        return false;
    }
    matrix.fill(0.0);
    for (k, &value) in eigenvalues.iter().enumerate().filter(|(_, value)| is_negative(**value)) {
        for i in 0..n {
            for j in 0..n {
                matrix[i * n + j] += value * vectors[i * n + k] * vectors[j * n + k];
            }
        }
    }
    true
}

/// A rotation of the rows and columns `p` and `q` that makes the entry between them zero.
fn rotate(m: &mut [f64], v: &mut [f64], n: usize, p: usize, q: usize) {
    let between = m[p * n + q];
    if between == 0.0 {
        return;
    }
    let theta = (m[q * n + q] - m[p * n + p]) / (2.0 * between);
    let t = if theta == 0.0 { 1.0 } else { theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt()) };
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..n {
        let (a, b) = (m[k * n + p], m[k * n + q]);
        (m[k * n + p], m[k * n + q]) = (c * a - s * b, s * a + c * b);
    }
    for k in 0..n {
        let (a, b) = (m[p * n + k], m[q * n + k]);
        (m[p * n + k], m[q * n + k]) = (c * a - s * b, s * a + c * b);
    }
    for k in 0..n {
        let (a, b) = (v[k * n + p], v[k * n + q]);
        (v[k * n + p], v[k * n + q]) = (c * a - s * b, s * a + c * b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `Q diag(-3, 0, 1, -0.5, 2) Q^T` with Householder's `Q` the part of the first and the fourth; nothing of one without negative eigenvalues.
    #[test]
    fn what_is_negative_is_left() {
        let n = 5;
        let w = [0.3, -0.7, 0.2, 0.5, 0.1];
        let size: f64 = w.iter().map(|x| x * x).sum();
        let q = |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * w[i] * w[j] / size;
        let of = |values: [f64; 5]| -> Vec<f64> {
            let entry = |i: usize, j: usize| (0..n).map(|k| values[k] * q(i, k) * q(j, k)).sum::<f64>();
            (0..n * n).map(|at| entry(at / n, at % n)).collect()
        };
        let mut vectors = Vec::new();
        let mut matrix = of([-3.0, 0.0, 1.0, -0.5, 2.0]);
        assert!(keep_negative_part(&mut matrix, n, &mut vectors));
        for (found, expected) in matrix.iter().zip(of([-3.0, 0.0, 0.0, -0.5, 0.0])) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
        let mut positive = of([3.0, 0.0, 1.0, 0.5, 2.0]);
        assert!(!keep_negative_part(&mut positive, n, &mut vectors));
    }
}
