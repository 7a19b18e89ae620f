//! Sums over long vectors, the same bits for any number of threads: chunks of a fixed length, eight partial sums in each, chunks added in order.

use rayon::prelude::*;

/// Entries of a chunk.
const CHUNK: usize = 4096;

/// Entries from which on chunks go to several threads.
const PARALLEL: usize = 16 * CHUNK;

fn dot_of_chunk((x, y): (&[f64], &[f64])) -> f64 {
    let mut sums = [0.0; 8];
    let (eights, others) = (x.chunks_exact(8), y.chunks_exact(8));
    let rest: f64 = eights.remainder().iter().zip(others.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in eights.zip(others) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// `x . y`.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    debug_assert_eq!(x.len(), y.len());
    if x.len() < PARALLEL || rayon::current_num_threads() == 1 {
        return x.chunks(CHUNK).zip(y.chunks(CHUNK)).map(dot_of_chunk).sum();
    }
    let parts: Vec<f64> = x.par_chunks(CHUNK).zip(y.par_chunks(CHUNK)).map(dot_of_chunk).collect();
    parts.iter().sum()
}

/// The Euclidean norm, of vectors whose squares neither overflow nor vanish.
pub(crate) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_leave_the_bits() {
        let x: Vec<f64> = (0..3 * PARALLEL + 5).map(|i| (0.37 * i as f64).sin()).collect();
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let one = pool(1).install(|| dot(&x, &x));
        assert_eq!(one.to_bits(), pool(3).install(|| dot(&x, &x)).to_bits());
        assert!((one - x.iter().map(|x| x * x).sum::<f64>()).abs() < 1e-9 * one);
        assert_eq!(norm(&[3.0, 4.0]), 5.0);
    }
}
