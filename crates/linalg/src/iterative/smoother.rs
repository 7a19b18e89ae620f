//! Chebyshev's polynomials in `D^-1 A` with the diagonal blocks `D`: products and vectors only, so that no order of the rows shows.

use super::bsr::{Block, Bsr, TASK_ROWS, with_wide_vectors};
use super::inverse::{apply_blocks, times};
use super::real::Real;
use super::sums::norm;
use super::waves::Waves;
use crate::vector::pseudo_random;
use rayon::prelude::*;

/// Products of the power iteration.
const POWER_ITERATIONS: usize = 12;

/// Factor by which the estimate of the largest eigenvalue is raised.
const ESTIMATE_MARGIN: f64 = 1.02;

/// The polynomial is small on eigenvalues between `1.1 / RANGE` and `1.1` times the estimate of the largest one.
const RANGE: f64 = 8.0;
const UPPER_MARGIN: f64 = 1.1;

/// The largest eigenvalue of `D^-1 A` in size, by power iteration from a fixed vector, raised a little.
pub(crate) fn largest_eigenvalue<T: Real, const B: usize>(a: &Bsr<T, B, B>, inverse: &[Block<T, B, B>]) -> f64 {
    let n = a.rows() * B;
    let mut x: Vec<f64> = (0..n).map(pseudo_random).collect();
    let (mut scaled, mut y) = (vec![T::default(); n], vec![T::default(); n]);
    let mut largest = 1.0;
    for _ in 0..POWER_ITERATIONS {
        let scale = 1.0 / norm(&x);
        scaled.iter_mut().zip(&x).for_each(|(scaled, x)| *scaled = T::rounded(x * scale));
        a.multiply(&scaled, &mut y);
        apply_blocks(inverse, T::rounded(1.0), &y, &mut scaled);
        x.iter_mut().zip(&scaled).for_each(|(x, scaled)| *x = scaled.wide());
        largest = norm(&x);
    }
    ESTIMATE_MARGIN * largest
}

/// The largest degree of the polynomial.
const MAX_DEGREE: usize = 4;

/// A step of the iteration: `z` becomes `keep z + factor D (b - A x)` and is added to `x`.
#[derive(Debug, Clone, Copy, Default)]
struct Step<T> {
    factor: T,
    keep: T,
}

/// The smoother of a level.
#[derive(Debug)]
pub(crate) struct Smoother<T, const B: usize> {
    inverse: Vec<Block<T, B, B>>,
    /// The first one without `keep`.
    steps: [Step<T>; MAX_DEGREE],
    degree: usize,
    waves: Waves,
    z: Vec<T>,
    /// The iterate of every second step.
    other: Vec<T>,
}

impl<T: Real, const B: usize> Smoother<T, B> {
    /// A smoother for a matrix with its inverse diagonal blocks and [`largest_eigenvalue`]; `degree` products, of which the first is spared if the iterate is
    /// zero.
    pub fn new(a: &Bsr<T, B, B>, inverse: Vec<Block<T, B, B>>, largest: f64, degree: usize) -> Self {
        let n = B * inverse.len();
        let upper = UPPER_MARGIN * largest;
        let lower = upper / RANGE;
        let (middle, half) = (0.5 * (upper + lower), 0.5 * (upper - lower));
        let ratio = middle / half;
        let mut rho = 1.0 / ratio;
        let mut steps = [Step::default(); MAX_DEGREE];
        steps[0].factor = T::rounded(1.0 / middle);
        for step in &mut steps[1..degree] {
            let next = 1.0 / (2.0 * ratio - rho);
            *step = Step { factor: T::rounded(2.0 * next / half), keep: T::rounded(next * rho) };
            rho = next;
        }
        let waves = Waves::new(a);
        Self { inverse, steps, degree, waves, z: vec![T::default(); n], other: vec![T::default(); n] }
    }

    /// Improves `x`; with `from_zero` it counts as zero, whatever is in it. `residual` gets `b - A x`.
    pub fn smooth(
        &mut self,
        a: &Bsr<T, B, B>,
        b: &[T],
        x: &mut Vec<T>,
        from_zero: bool,
        mut residual: Option<&mut [T]>,
    ) {
        let Self { inverse, steps, degree, waves, z, other } = self;
        let mut steps = &steps[..*degree];
        if from_zero {
            apply_blocks(inverse, steps[0].factor, b, z);
            x.copy_from_slice(z);
            steps = &steps[1..];
        }
        let b = b.as_chunks::<B>().0;
        // The rows from `first` on that `z` and `next` have.
        let pass = |step: Option<&Step<T>>, first: usize, x: &[T], z: &mut [T], next: &mut [T]| {
            let x = x.as_chunks().0;
            with_wide_vectors(
                #[inline(always)]
                || {
                    for (k, (z, next)) in
                        z.as_chunks_mut::<B>().0.iter_mut().zip(next.as_chunks_mut::<B>().0).enumerate()
                    {
                        let i = first + k;
                        let product = a.row_product(i, x);
                        let r = std::array::from_fn(|d| b[i][d] - product[d]);
                        let Some(step) = step else {
                            *next = r;
                            continue;
                        };
                        let change = times(&inverse[i], &r);
                        (0..B).for_each(|d| z[d] = step.keep * z[d] + step.factor * change[d]);
                        (0..B).for_each(|d| next[d] = x[i][d] + z[d]);
                    }
                },
            );
        };
        let passes = steps.len() + usize::from(residual.is_some());
        // The vectors of a pass: the second step reads what the first one has written.
        let mut with = |k: usize, run: &mut dyn FnMut(Option<&Step<T>>, &[T], &mut [T], &mut [T])| {
            let (from, to) = if k.is_multiple_of(2) { (&*x, &mut *other) } else { (&*other, &mut *x) };
            match (steps.get(k), &mut residual) {
                (None, Some(residual)) => run(None, from, z, residual),
                (step, _) => run(step, from, z, to),
            }
        };
        if rayon::current_num_threads() == 1 || a.rows() <= 4 * TASK_ROWS {
            waves.run::<{ MAX_DEGREE + 1 }>(passes, |k, rows| {
                let part = B * rows.start..B * rows.end;
                with(k, &mut |step, x, z, next| {
                    pass(step, rows.start, x, &mut z[part.clone()], &mut next[part.clone()])
                });
            });
        } else {
            for k in 0..passes {
                with(k, &mut |step, x, z, next| {
                    let tasks = z.par_chunks_mut(B * TASK_ROWS).zip(next.par_chunks_mut(B * TASK_ROWS)).enumerate();
                    tasks.for_each(|(task, (z, next))| pass(step, task * TASK_ROWS, x, z, next));
                });
            }
        }
        if steps.len() % 2 == 1 {
            std::mem::swap(x, other);
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Block<T, B, B>>() * self.inverse.capacity()
            + size_of::<T>() * (self.z.capacity() + self.other.capacity())
            + self.waves.memory_bytes()
    }
}
