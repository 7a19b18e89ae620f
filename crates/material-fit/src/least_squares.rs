//! Least squares by the method of Levenberg and Marquardt: J. J. Moré, *The Levenberg-Marquardt algorithm: implementation and theory*, 1978, with the diagonal of the normal equations as the scale.

use nalgebra::{DMatrix, DVector};

const MAX_ITERATIONS: usize = 400;

/// The search ends when the sum of squares falls by less than this part of it.
const SMALLEST_GAIN: f64 = 1e-13;

/// Damping at the start, its factors, and where no step is found any more.
const DAMPING: f64 = 1e-3;
const LESS: f64 = 0.2;
const MORE: f64 = 5.0;
const LARGEST_DAMPING: f64 = 1e12;

/// Size of a difference, in parts of a parameter.
const DIFFERENCE: f64 = 1e-6;

/// The parameters near `start` with the least sum of squares of the deviations, and that sum. `None` if there are no deviations at the start; a step to where there are none is shortened.
pub(crate) fn least_squares(start: &[f64], deviations: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Option<(Vec<f64>, f64)> {
    let square = |r: &[f64]| r.iter().map(|v| v * v).sum::<f64>();
    let mut x = start.to_vec();
    let mut r = deviations(&x)?;
    let mut best = square(&r);
    let mut damping = DAMPING;
    for _ in 0..MAX_ITERATIONS {
        let jacobian = jacobian(&x, &deviations)?;
        let normal = jacobian.transpose() * &jacobian;
        let slope = jacobian.transpose() * DVector::from_column_slice(&r);
        let before = best;
        while damping <= LARGEST_DAMPING {
            let mut damped = normal.clone();
            for k in 0..x.len() {
                damped[(k, k)] += damping * normal[(k, k)].max(f64::MIN_POSITIVE);
            }
            let step = damped.cholesky().map(|factors| factors.solve(&slope));
            let next = step.map(|step| x.iter().zip(step.iter()).map(|(x, d)| x - d).collect::<Vec<f64>>());
            let tried = next.and_then(|next| deviations(&next).map(|r| (next, r)));
            if let Some((next, tried)) = tried
                && square(&tried) < best
            {
                (best, x, r) = (square(&tried), next, tried);
                damping = (LESS * damping).max(1e-12);
                break;
            }
            damping *= MORE;
        }
        if before - best <= SMALLEST_GAIN * before {
            break;
        }
    }
    Some((x, best))
}

/// Central differences.
fn jacobian(x: &[f64], deviations: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Option<DMatrix<f64>> {
    let mut columns = Vec::with_capacity(x.len());
    for k in 0..x.len() {
        let size = DIFFERENCE * x[k].abs().max(DIFFERENCE);
        let at = |by: f64| {
            let mut moved = x.to_vec();
            moved[k] += by;
            deviations(&moved)
        };
        let (ahead, behind) = (at(size)?, at(-size)?);
        columns
            .push(DVector::from_iterator(ahead.len(), ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * size))));
    }
    Some(DMatrix::from_columns(&columns))
}
