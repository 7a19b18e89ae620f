//! The curvature of the energy at a static solution: in how many directions it falls.

use crate::downhill::SMALLEST_SHIFT;
use crate::problem::StepProblem;
use crate::timing::Phase;
use crate::{CouplingTerm, StepError};

impl StepProblem<'_> {
    /// Negative eigenvalues of what was factorised last, a symmetric tangent, beyond one for each multiplier; zero if the solver does not count.
    pub(crate) fn count_excess(&mut self) -> usize {
        let multipliers = self.iterate.active.iter().flatten().filter(|&&active| active).count();
        self.system.solver.negative_eigenvalues().map_or(0, |count| count.saturating_sub(multipliers))
    }

    /// Whether the directions in which the energy falls can be counted: a static step with a symmetric tangent, without stabilisation, and with no unknown but positions and multipliers.
    pub(crate) fn counts_directions(&self) -> bool {
        !self.step.rule.has_inertia()
            && !self.system.present.has_damping
            && self.is_symmetric()
            && self.system.matrix.slots.width.iter().all(|&width| width == 1)
    }

    /// Independent directions in which the energy falls at a solution, from the tangent there, and in which it falls also if contact by potentials resists approach as it does but does not
    /// turn: a layer between surfaces has a negative curvature along them of the order of pressure over distance, which is none of a body.
    pub fn unstable_directions(&mut self) -> usize {
        // Where the last factors had none there is none here: they belong to an iterate nearby. An iteration has none, and looks.
        if !self.counts_directions() || (self.system.excess == 0 && !self.iteration_finds_any()) {
            return 0;
        }
        let count = self.negative(None);
        if count == 0 || !self.model.contacts.iter().filter_map(CouplingTerm::potential).any(|of| of.acts()) {
            return count;
        }
        let Ok(mut values) = self.without_softening() else { return count };
        // Motions that nothing resists, as sliding without friction, have no sign.
        let (s, shift) = (&*self.system, SMALLEST_SHIFT * self.mean_diagonal());
        s.matrix.diagonal().for_each(|(at, _)| values[at] += shift);
        let count = self.negative(Some(&values));
        // The next step starts with the factors of this one.
        self.negative(None);
        count
    }

    /// Whether a solver that iterates sees a direction in which the energy falls.
    fn iteration_finds_any(&mut self) -> bool {
        let s = &mut *self.system;
        let values = s.matrix.values();
        let solver = &mut s.solver;
        self.timings.measure(Phase::Solve, || solver.is_definite(values)) == Some(false)
    }

    /// Excess of negative eigenvalues of the tangent, or of these values on its pattern; zero if it has no factors.
    fn negative(&mut self, values: Option<&[f64]>) -> usize {
        let s = &mut *self.system;
        let own = s.matrix.values();
        let solver = &mut s.solver;
        match self.timings.measure(Phase::Factorisation, || solver.factorise(values.unwrap_or(own))) {
            Ok(()) => self.count_excess(),
            Err(_) => 0,
        }
    }

    /// The tangent with the parts of contact by potentials that have no negative curvature.
    fn without_softening(&mut self) -> Result<Vec<f64>, StepError> {
        let (model, s) = (&*self.model, &mut *self.system);
        let mut values = s.matrix.values.clone();
        let (mut k, mut expanded) = (0, Vec::new());
        for (c, pair) in model.couplings() {
            let at = self.iterate.at(c, &self.step);
            let softens = pair.is_potential();
            let (map, transform) = (&s.matrix.map, &mut s.scratch.transform);
            pair.term.assemble(&at, softens, &mut |local| {
                if softens && !local.is_elsewhere {
                    let change = negative_part(&local.tangent, local.dim());
                    if model.embedding.touches(&local.nodes) {
                        model.embedding.expand(&local.nodes, &mut expanded);
                        model.embedding.transform(&local.nodes, &expanded, 0, &change, transform);
                        map.add(k, &transform.matrix, &mut values);
                    } else {
                        map.add(k, &change, &mut values);
                    }
                }
                k += 1;
            })?;
        }
        Ok(values)
    }
}

/// What a symmetric matrix (row-major, `n` rows) lacks to have no negative eigenvalue: the sum of `-l v v^T` over its negative eigenvalues `l` with their unit eigenvectors `v`, which Jacobi's method finds.
fn negative_part(matrix: &[f64], n: usize) -> Vec<f64> {
    /// Sweeps; the method converges quadratically after some four.
    const SWEEPS: usize = 30;
    let mut a = matrix.to_vec();
    let mut vectors = vec![0.0; n * n];
    (0..n).for_each(|i| vectors[i * n + i] = 1.0);
    let size: f64 = a.iter().map(|x| x * x).sum();
    for _ in 0..SWEEPS {
        let off: f64 = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i * n + j].powi(2)).sum();
        if off <= f64::EPSILON * f64::EPSILON * size {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                let apq = a[p * n + q];
                if apq == 0.0 {
                    continue;
                }
                let theta = 0.5 * (a[q * n + q] - a[p * n + p]) / apq;
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let (c, s) = (1.0 / t.hypot(1.0), t / t.hypot(1.0));
                for k in 0..n {
                    let (x, y) = (a[k * n + p], a[k * n + q]);
                    (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p * n + k], a[q * n + k]);
                    (a[p * n + k], a[q * n + k]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (vectors[k * n + p], vectors[k * n + q]);
                    (vectors[k * n + p], vectors[k * n + q]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    let mut part = vec![0.0; n * n];
    for (k, value) in (0..n).map(|k| (k, a[k * n + k])).filter(|(_, value)| *value < 0.0) {
        for i in 0..n {
            for j in 0..n {
                part[i * n + j] -= value * vectors[i * n + k] * vectors[j * n + k];
            }
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring under compression: stiff along its axis, and with a negative stiffness across, which is what is taken away.
    #[test]
    fn the_negative_part_of_a_compressed_spring() {
        let (along, across, axis) = (3.0, -0.5, [0.6, 0.0, 0.8]);
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let block = |i: usize, j: usize, a: f64, b: f64| a * axis[i] * axis[j] + b * (unit(i, j) - axis[i] * axis[j]);
        let matrix = |a: f64, b: f64| -> Vec<f64> {
            let entry = |r: usize, c: usize| if (r < 3) == (c < 3) { 1.0 } else { -1.0 } * block(r % 3, c % 3, a, b);
            (0..36).map(|k| entry(k / 6, k % 6)).collect()
        };
        let part = negative_part(&matrix(along, across), 6);
        assert!(part.iter().zip(matrix(0.0, -across)).all(|(x, y)| (x - y).abs() < 1e-13), "{part:?}");
        assert!(negative_part(&matrix(along, 0.5), 6).iter().all(|x| x.abs() < 1e-13));
    }
}
