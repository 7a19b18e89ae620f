//! `M x = b` by preconditioned conjugate gradients: initial accelerations, and velocities from momenta.
//!
//! The mass of hexahedra with its row sums as preconditioner has a condition number of about ten at any mesh size: some thirty products give
//! round-off, without a factorisation to compute and to keep.

use crate::StepError;
use crate::masses::Masses;

/// Products after which the solution is given up; thirty are usual.
const MAX_PRODUCTS: usize = 500;

/// Vectors of the iteration and the preconditioner.
#[derive(Debug)]
pub(crate) struct MassSolver {
    free: Vec<u32>,
    row_sums: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

fn sum_of_products(free: &[u32], a: &[f64], b: &[f64]) -> f64 {
    free.iter().map(|&c| a[c as usize] * b[c as usize]).sum()
}

impl MassSolver {
    /// For the given free components of vectors with `components` entries.
    pub fn new(masses: &Masses, free: &[u32], components: usize) -> Self {
        let ones = vec![1.0; components];
        let mut row_sums = vec![0.0; components];
        masses.multiply_add(1.0, &ones, &mut row_sums);
        // What has no mass has no equation here.
        let free = free.iter().copied().filter(|&c| row_sums[c as usize] != 0.0).collect();
        let zeros = || vec![0.0; components];
        Self { free, row_sums, residual: zeros(), direction: zeros(), product: zeros() }
    }

    /// Solves for the free components; the others keep the value that they come with.
    pub fn solve(&mut self, masses: &Masses, rhs: &[f64], x: &mut [f64]) -> Result<(), StepError> {
        let Self { free, row_sums, residual, direction, product } = self;
        residual.copy_from_slice(rhs);
        masses.multiply_add(-1.0, x, residual);
        // The size of what is summed up, which is what round-off is relative to.
        let scale: f64 =
            free.iter().map(|&c| (row_sums[c as usize] * x[c as usize]).abs() + rhs[c as usize].abs()).sum();
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
                free.iter().map(|&c| residual[c as usize] * residual[c as usize] / row_sums[c as usize]).sum();
            let ratio = energy / previous;
            previous = energy;
            for &c in free.iter() {
                let c = c as usize;
                direction[c] = residual[c] / row_sums[c] + ratio * direction[c];
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
