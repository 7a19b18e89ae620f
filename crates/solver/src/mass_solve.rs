//! `M x = b` by preconditioned conjugate gradients: initial accelerations, and velocities from momenta.
//!
//! The mass of finite elements with its diagonal as preconditioner has a condition number that depends on the element alone and not on the mesh (A. J. Wathen, 1987):
//! some thirty products give round-off, without a factorisation to compute and to keep. Row sums would not do: those of quadratic elements are negative at corners.

use crate::StepError;
use crate::masses::Masses;

/// Products after which the solution is given up; thirty are usual.
const MAX_PRODUCTS: usize = 500;

/// Vectors of the iteration and the preconditioner.
#[derive(Debug)]
pub(crate) struct MassSolver {
    free: Vec<u32>,
    diagonal: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

fn sum_of_products(free: &[u32], a: &[f64], b: &[f64]) -> f64 {
    free.iter().map(|&c| a[c as usize] * b[c as usize]).sum()
}

impl MassSolver {
    /// A solver for the given free components of vectors with `components` entries.
    pub fn new(masses: &Masses, free: &[u32], components: usize) -> Self {
        let diagonal = masses.diagonal(components);
        // What has no mass has no equation here.
        let free = free.iter().copied().filter(|&c| diagonal[c as usize] != 0.0).collect();
        let zeros = || vec![0.0; components];
        Self { free, diagonal, residual: zeros(), direction: zeros(), product: zeros() }
    }

    /// Solves for the free components; the others keep the value that they come with.
    pub fn solve(&mut self, masses: &Masses, rhs: &[f64], x: &mut [f64]) -> Result<(), StepError> {
        let Self { free, diagonal, residual, direction, product } = self;
        residual.copy_from_slice(rhs);
        masses.multiply_add(-1.0, x, residual);
        // The size of what is summed up, which is what round-off is relative to.
        let scale: f64 =
            free.iter().map(|&c| (diagonal[c as usize] * x[c as usize]).abs() + rhs[c as usize].abs()).sum();
        let tolerance = 1e-16 * scale;
        direction.fill(0.0);
        let (mut previous, mut best, mut worse) = (1.0, f64::INFINITY, 0);
        for _ in 0..MAX_PRODUCTS {
            let norm = free.iter().map(|&c| residual[c as usize].abs()).sum::<f64>();
            // At round-off the residual wanders.
            worse = if norm < 0.5 * best { 0 } else { worse + 1 };
            best = norm.min(best);
            if norm <= tolerance || (worse > 5 && best <= 1e4 * tolerance) {
                return Ok(());
            }
            let energy: f64 =
                free.iter().map(|&c| residual[c as usize] * residual[c as usize] / diagonal[c as usize]).sum();
            let ratio = energy / previous;
            previous = energy;
            for &c in free.iter() {
                let c = c as usize;
                direction[c] = residual[c] / diagonal[c] + ratio * direction[c];
            }
            product.fill(0.0);
            masses.multiply_add(1.0, direction, product);
            let length = energy / sum_of_products(free, direction, product);
            if !length.is_finite() {
                break;
            }
            for &c in free.iter() {
                let c = c as usize;
                x[c] += length * direction[c];
                residual[c] -= length * product[c];
            }
        }
        Err(StepError::Mass)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use stoss_fe_solid::{MassKind, SolidBody};
    use stoss_materials::NeoHooke;
    use stoss_mesh::generate::Block;
    use stoss_reference_element::CellKind;

    /// The preconditioner is positive, also for cells whose row sums are not, and the solution exact.
    #[test]
    fn masses_of_all_cells_are_solved_with() {
        for kind in CellKind::ALL {
            let block = Block::new([0.0; 3], [1.0, 2.0, 1.0], [2, 3, 2]).generate().unwrap();
            let mesh = block.with_cells(kind).unwrap();
            let law = Arc::new(NeoHooke::from_young_poisson(1.0, 0.3).unwrap());
            let mass = SolidBody::new("a", &mesh, 0, law).unwrap().mass(3.0, MassKind::Consistent);
            let masses = Masses { bodies: vec![mass], ..Masses::default() };
            let n = 3 * mesh.nodes.len();
            let exact: Vec<f64> = (0..n).map(|c| ((7 * c + 3) as f64).sin()).collect();
            let mut rhs = vec![0.0; n];
            masses.multiply_add(1.0, &exact, &mut rhs);
            let free: Vec<u32> = (0..n as u32).collect();
            let mut x = vec![0.0; n];
            let mut solver = MassSolver::new(&masses, &free, n);
            assert!(solver.diagonal.iter().all(|&m| m > 0.0), "{kind}");
            solver.solve(&masses, &rhs, &mut x).unwrap();
            let off = x.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{kind}: {off:e}");
        }
    }
}
