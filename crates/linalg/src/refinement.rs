//! Residual check and iterative refinement, the same for every solver. Not a Krylov method.

use crate::scaling::Equilibration;
use crate::vector::first_non_finite;
use crate::{LinalgError, SolveReport, SolverOptions, SparsityPattern, SystemArray};
use std::sync::Arc;

/// The original matrix and the work space for `r = b - A x` and its row-wise measure.
///
/// The measure is that of [`SolveReport::backward_error`].
#[derive(Debug, Default)]
pub struct Refinement {
    pattern: Option<Arc<SparsityPattern>>,
    values: Vec<f64>,
    residual: Vec<f64>,
    denominator: Vec<f64>,
    correction: Vec<f64>,
    best: Vec<f64>,
}

impl Refinement {
    /// Keeps the pattern and makes room.
    pub fn set_pattern(&mut self, pattern: &Arc<SparsityPattern>) {
        let n = pattern.n();
        self.pattern = Some(Arc::clone(pattern));
        self.values.clear();
        self.values.reserve_exact(pattern.nnz());
        for v in [&mut self.residual, &mut self.denominator, &mut self.correction, &mut self.best] {
            v.clear();
            v.resize(n, 0.0);
        }
    }

    /// Copies the values after a check of their number and finiteness.
    ///
    /// # Errors
    /// [`LinalgError::CallOrder`], [`LinalgError::Length`], [`LinalgError::NonFinite`].
    pub fn set_values(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.values.clear();
        let pattern =
            self.pattern.as_ref().ok_or(LinalgError::CallOrder { called: "factorise", missing: "analyse" })?;
        check_length("values", pattern.nnz(), values)?;
        check_finite(SystemArray::Matrix, values)?;
        self.values.extend_from_slice(values);
        Ok(())
    }

    /// The values that were set last.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Heap memory in bytes, without the shared pattern.
    pub fn memory_bytes(&self) -> usize {
        size_of::<f64>() * (self.values.capacity() + 4 * self.residual.capacity())
    }

    /// Solves `A x = b`: `apply(v)` overwrites `v` by an approximation of `A^-1 v` and is called once for the solution and
    /// once for each refinement step. Stops at the target, or when a step no longer halves the error, and keeps the
    /// best iterate. A residual beyond the target without the exception for tiny rows costs one step.
    ///
    /// # Errors
    /// [`LinalgError::Length`], [`LinalgError::CallOrder`], [`LinalgError::NonFinite`], [`LinalgError::NotConverged`].
    pub fn solve(
        &mut self,
        options: &SolverOptions,
        equilibration: &Equilibration,
        rhs: &[f64],
        solution: &mut [f64],
        mut apply: impl FnMut(&mut [f64]),
    ) -> Result<SolveReport, LinalgError> {
        let pattern = self.pattern.as_ref().ok_or(LinalgError::CallOrder { called: "solve", missing: "analyse" })?;
        if self.values.len() != pattern.nnz() {
            return Err(LinalgError::CallOrder { called: "solve", missing: "factorise" });
        }
        check_length("right-hand side", pattern.n(), rhs)?;
        check_length("solution", pattern.n(), solution)?;
        check_finite(SystemArray::RightHandSide, rhs)?;
        solution.copy_from_slice(rhs);
        apply(solution);
        check_finite(SystemArray::Solution, solution)?;
        let work = Work { pattern, values: &self.values, equilibration };
        let target = options.target_backward_error;
        let mut error = work.error(rhs, solution, &mut self.residual, &mut self.denominator);
        let mut steps = 0;
        // One step is spent on the tiny rows alone; more only where the measure that counts asks for it.
        while (error.backward > target || (error.strict > target && steps == 0)) && steps < options.max_refinement_steps
        {
            steps += 1;
            self.best.copy_from_slice(solution);
            self.correction.copy_from_slice(&self.residual);
            apply(&mut self.correction);
            for (x, d) in solution.iter_mut().zip(&self.correction) {
                *x += d;
            }
            let new = work.error(rhs, solution, &mut self.residual, &mut self.denominator);
            let better = new.backward < error.backward || (new.backward <= target && new.strict < error.strict);
            // A NaN is not better.
            if !better {
                solution.copy_from_slice(&self.best);
                break;
            }
            let halved = new.backward <= 0.5 * error.backward;
            error = new;
            if !halved {
                break;
            }
        }
        let error = error.backward;
        if error <= options.acceptable_backward_error {
            Ok(SolveReport { backward_error: error, refinement_steps: steps })
        } else {
            Err(LinalgError::NotConverged {
                backward_error: error,
                limit: options.acceptable_backward_error,
                refinement_steps: steps,
            })
        }
    }
}

struct Work<'a> {
    pattern: &'a SparsityPattern,
    values: &'a [f64],
    equilibration: &'a Equilibration,
}

impl Work<'_> {
    /// Row-wise backward errors; leaves the residual in `r`.
    fn error(&self, b: &[f64], x: &[f64], r: &mut [f64], d: &mut [f64]) -> Errors {
        let n = b.len();
        for i in 0..n {
            r[i] = b[i];
            d[i] = b[i].abs();
        }
        for j in 0..n {
            let xj = x[j];
            let range = self.pattern.column_range(j);
            let rows = &self.pattern.row_indices()[range.clone()];
            for (&i, v) in rows.iter().zip(&self.values[range]) {
                let t = v * xj;
                r[i as usize] -= t;
                d[i as usize] += t.abs();
            }
        }
        let largest = self.equilibration.largest_scaled_unknown(x);
        let mut errors = Errors { backward: 0.0, strict: 0.0 };
        for i in 0..n {
            if r[i] == 0.0 {
                continue;
            }
            let size = self.equilibration.row_size(i, largest);
            let floor = 1e3 * n as f64 * f64::EPSILON * (size + b[i].abs());
            let strict = r[i].abs() / d[i];
            let backward = if d[i] > floor { strict } else { r[i].abs() / (d[i] + size) };
            if strict.is_nan() || backward.is_nan() {
                return Errors { backward: f64::NAN, strict: f64::NAN };
            }
            errors.strict = errors.strict.max(strict);
            errors.backward = errors.backward.max(backward);
        }
        errors
    }
}

/// The measure with and without the exception for rows of round-off size.
#[derive(Clone, Copy)]
struct Errors {
    backward: f64,
    strict: f64,
}

pub(crate) fn check_length(what: &'static str, expected: usize, slice: &[f64]) -> Result<(), LinalgError> {
    if slice.len() == expected { Ok(()) } else { Err(LinalgError::Length { what, expected, found: slice.len() }) }
}

pub(crate) fn check_finite(place: SystemArray, slice: &[f64]) -> Result<(), LinalgError> {
    first_non_finite(slice).map_or(Ok(()), |index| Err(LinalgError::NonFinite { place, index }))
}
