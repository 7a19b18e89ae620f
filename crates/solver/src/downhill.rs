//! Linear solutions along which the energy of a static step falls: an unstable tangent is shifted.

use crate::assembly::System;
use crate::diagnosis::linear_error;
use crate::problem::StepProblem;
use crate::{CouplingTerm, Phase, StepError};
use stoss_linalg::{LinalgError, MatrixKind, vector};
use stoss_newton::NewtonProblem as _;

/// Smallest shift of an unstable tangent, in parts of its mean diagonal, and the factor to the next one.
pub(crate) const SMALLEST_SHIFT: f64 = 1.0e-6;
const SHIFT_FACTOR: f64 = 4.0;

/// Largest number of shifts of a tangent: the last one is ten orders of magnitude above the diagonal.
const MAX_SHIFTS: u32 = 27;

/// Increments of a shifted tangent are lengthened by this at most.
const LONGEST: f64 = 8.0;

impl StepProblem<'_> {
    /// Solves with an unsymmetric tangent, shifted until the increment goes downhill.
    pub fn solve_unsymmetric_downhill(&mut self) -> Result<f64, StepError> {
        let mut increment = self.solve()?;
        let mut shift = (SMALLEST_SHIFT * self.mean_diagonal()).max(self.last_shift / SHIFT_FACTOR);
        for _ in 0..MAX_SHIFTS {
            if self.slope_of_increment() <= 0.0 {
                break;
            }
            self.last_shift = shift;
            let solved = self.factorise_shifted(MatrixKind::General, shift).and_then(|_| self.solve_factorised());
            if let Err(error) = solved {
                let has_inertia = self.step.rule.has_inertia();
                return Err(linear_error(self.model, self.system, self.iterate, has_inertia, error));
            }
            self.solved_shifted = true;
            increment = self.keep_base()?;
            shift *= SHIFT_FACTOR;
        }
        Ok(increment)
    }

    /// Lets friction know where the iterate will go.
    pub fn set_line(&mut self) {
        self.part = 0.0;
        self.full_increment();
        let Self { model, system, .. } = self;
        model
            .contacts
            .iter_mut()
            .filter_map(CouplingTerm::potential_mut)
            .for_each(|of| of.set_line(&system.base.full_increment));
    }

    /// Derivative of the potential along the increment.
    pub fn slope_of_increment(&self) -> f64 {
        let s = &*self.system;
        let free = s.matrix.free();
        -vector::dot(&s.rhs[..free], &s.increment[..free])
    }

    /// Solves with the symmetric tangent by iteration; false if the solver does not iterate, or met a direction in which the energy does not rise.
    pub fn solve_definite(&mut self) -> Result<bool, LinalgError> {
        let tolerance = self.accuracy.tolerance();
        self.system.place_equations(self.model, &self.iterate.q);
        let System { solver, matrix, rhs, increment, .. } = &mut *self.system;
        let (pattern, values) = (&matrix.pattern, matrix.values());
        self.timings.measure(Phase::Factorisation, || solver.analyse(pattern, MatrixKind::Symmetric))?;
        let solved = self.timings.measure(Phase::Solve, || solver.solve_definite(values, rhs, increment, tolerance))?;
        if solved {
            *self.solves += 1;
            self.solved_shifted = false;
            self.system.excess = 0;
        }
        Ok(solved)
    }

    /// Factorises the tangent plus the smallest multiple of the unit matrix that is found to leave no direction in which the energy falls; returns it.
    pub fn factorise_downhill(&mut self) -> Result<f64, LinalgError> {
        if self.factorise_shifted(MatrixKind::Symmetric, 0.0)? {
            return Ok(0.0);
        }
        // What was needed last is not far from what is needed now.
        let smallest = SMALLEST_SHIFT * self.mean_diagonal();
        let mut shift = (0.5 * self.last_shift).max(smallest);
        let known = shift > smallest;
        let mut shifts = 0;
        while !self.factorise_shifted(MatrixKind::Symmetric, shift)? && shifts < MAX_SHIFTS {
            shift *= if known && shifts == 0 { 2.0 } else { SHIFT_FACTOR };
            shifts += 1;
        }
        // Off a saddle point it goes the faster the less the tangent is shifted.
        if shifts > 0 && !known {
            shift = if self.factorise_shifted(MatrixKind::Symmetric, 0.5 * shift)? {
                0.5 * shift
            } else {
                self.factorise_shifted(MatrixKind::Symmetric, shift)?;
                shift
            };
        }
        self.last_shift = shift;
        Ok(shift)
    }

    /// Factorises the tangent plus `shift` times the unit matrix; returns whether the energy falls in no direction, as far as the solver can tell.
    pub fn factorise_shifted(&mut self, kind: MatrixKind, shift: f64) -> Result<bool, LinalgError> {
        let System { matrix, solver, .. } = &mut *self.system;
        let diagonal: Vec<(usize, f64)> = if shift == 0.0 { Vec::new() } else { matrix.diagonal().collect() };
        diagonal.iter().for_each(|&(at, value)| matrix.values_mut()[at] = value + shift);
        let result = self.timings.measure(Phase::Factorisation, || {
            solver.analyse(&matrix.pattern, kind)?;
            solver.factorise(matrix.values())
        });
        diagonal.iter().for_each(|&(at, value)| matrix.values_mut()[at] = value);
        result?;
        let excess = self.count_excess();
        if shift == 0.0 {
            self.system.excess = excess;
        }
        Ok(excess == 0)
    }

    /// Lengthens the increment of a shifted tangent to where the energy without the shift, to second order, is least along it.
    pub fn lengthen(&mut self, shift: f64) {
        if shift == 0.0 {
            return;
        }
        let slope = -self.slope_of_increment();
        let s = &mut *self.system;
        let increment = &mut s.increment[..s.matrix.free()];
        let curvature = slope - shift * vector::dot(increment, increment);
        let longer = if curvature * LONGEST > slope { slope / curvature } else { LONGEST };
        increment.iter_mut().for_each(|du| *du *= longer);
    }

    /// Solves with what was factorised last.
    pub fn solve_factorised(&mut self) -> Result<(), LinalgError> {
        *self.solves += 1;
        let s = &mut *self.system;
        let (solver, rhs, increment) = (&mut s.solver, &s.rhs, &mut s.increment);
        self.timings.measure(Phase::Solve, || solver.solve(rhs, increment)).map(|_| ())
    }

    /// Mean of the magnitudes on the diagonal of the tangent.
    pub fn mean_diagonal(&self) -> f64 {
        let matrix = &self.system.matrix;
        matrix.diagonal_sum() / matrix.free().max(1) as f64
    }
}
