//! Chebyshev's polynomials in `D^-1 A` with the diagonal blocks `D`: products and vectors only, so that no order of the rows shows.

use super::bsr::{Block, Bsr};
use super::inverse::apply_blocks;
use super::real::Real;
use super::sums::norm;
use crate::vector::pseudo_random;

/// Products of the power iteration.
const POWER_ITERATIONS: usize = 12;

/// By this much the estimate of the largest eigenvalue is raised.
const ESTIMATE_MARGIN: f64 = 1.02;

/// The polynomial is small on eigenvalues between `1.1 / RANGE` and `1.1` times the estimate of the largest one.
const RANGE: f64 = 8.0;
const UPPER_MARGIN: f64 = 1.1;

/// The largest eigenvalue of `D^-1 A` in size, by power iteration from a fixed vector, raised a little.
pub(crate) fn largest_eigenvalue<const B: usize>(a: &Bsr<f64, B, B>, inverse: &[Block<f64, B, B>]) -> f64 {
    let n = a.rows() * B;
    let mut x: Vec<f64> = (0..n).map(pseudo_random).collect();
    let mut y = vec![0.0; n];
    let mut largest = 1.0;
    for _ in 0..POWER_ITERATIONS {
        let scale = 1.0 / norm(&x);
        x.iter_mut().for_each(|x| *x *= scale);
        a.multiply(&x, &mut y);
        apply_blocks(inverse, 1.0, &y, 0.0, &mut x);
        largest = norm(&x);
    }
    ESTIMATE_MARGIN * largest
}

/// The smoother of a level.
#[derive(Debug)]
pub(crate) struct Smoother<T, const B: usize> {
    inverse: Vec<Block<T, B, B>>,
    /// Of `D^-1 A`.
    largest: f64,
    degree: usize,
    z: Vec<T>,
    r: Vec<T>,
}

impl<T: Real, const B: usize> Smoother<T, B> {
    /// For a matrix divided by `unit`, from the inverse diagonal blocks of the matrix and [`largest_eigenvalue`]; `degree` products, of which the first is spared if the iterate is zero.
    pub fn new(inverse: &[Block<f64, B, B>], unit: f64, largest: f64, degree: usize) -> Self {
        let n = B * inverse.len();
        let inverse = inverse.iter().map(|block| block.map(|row| row.map(|v| T::rounded(unit * v)))).collect();
        Self { inverse, largest, degree, z: vec![T::default(); n], r: vec![T::default(); n] }
    }

    /// Improves `x`; with `from_zero` it counts as zero, whatever is in it.
    pub fn smooth(&mut self, a: &Bsr<T, B, B>, b: &[T], x: &mut [T], from_zero: bool) {
        let upper = UPPER_MARGIN * self.largest;
        let lower = upper / RANGE;
        let (middle, half) = (0.5 * (upper + lower), 0.5 * (upper - lower));
        let ratio = middle / half;
        let mut rho = 1.0 / ratio;
        let Self { inverse, z, r, .. } = self;
        if from_zero {
            apply_blocks(inverse, T::rounded(1.0 / middle), b, T::default(), z);
            x.copy_from_slice(z);
        } else {
            a.residual(b, x, r);
            apply_blocks(inverse, T::rounded(1.0 / middle), r, T::default(), z);
            x.iter_mut().zip(&*z).for_each(|(x, z)| *x += *z);
        }
        for _ in 1..self.degree {
            a.residual(b, x, r);
            let next = 1.0 / (2.0 * ratio - rho);
            apply_blocks(inverse, T::rounded(2.0 * next / half), r, T::rounded(next * rho), z);
            rho = next;
            x.iter_mut().zip(&*z).for_each(|(x, z)| *x += *z);
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Block<T, B, B>>() * self.inverse.capacity() + size_of::<T>() * (self.z.capacity() + self.r.capacity())
    }
}
