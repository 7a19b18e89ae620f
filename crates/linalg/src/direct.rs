//! The common part of all direct solvers: equilibration, the test for singularity, the residual check, refinement, statistics,
//! the caching of the analysis. A backend is only the factorisation in between.

use crate::gmres::Gmres;
use crate::matrix::multiply;
use crate::refinement::{Refinement, check_finite, check_length};
use crate::scaling::Equilibration;
use crate::vector::{norm_inf, norm2, pseudo_random};
use crate::{
    LinalgError, LinearSolver, MatrixKind, SolveReport, SolverOptions, SolverStatistics, SparsityPattern, SystemArray,
};
use std::fmt::Debug;
use std::sync::Arc;

/// A factorisation behind [`DirectSolver`]. The values it gets are finite and equilibrated; a zero pivot may leave
/// infinities or NaN in its factors, which [`DirectSolver`] finds.
pub trait Factorisation: Send + Debug {
    /// A short name for records.
    fn name(&self) -> &'static str;

    /// Ordering and storage for a new pattern.
    ///
    /// # Errors
    /// [`LinalgError::Backend`].
    fn analyse(&mut self, pattern: &SparsityPattern, kind: MatrixKind) -> Result<(), LinalgError>;

    /// Factorises; always called with the pattern and kind of the last `analyse`.
    ///
    /// # Errors
    /// [`LinalgError::Singular`], [`LinalgError::Backend`].
    fn factorise(&mut self, pattern: &SparsityPattern, values: &[f64]) -> Result<(), LinalgError>;

    /// Overwrites `v` by the solution for the right-hand side `v`.
    fn solve_in_place(&mut self, v: &mut [f64]);

    /// Heap memory in bytes.
    fn memory_bytes(&self) -> usize;

    /// Factorises again by a slower and safer method, because the last factors are not accurate enough; false if there is no such
    /// method or it is in use already.
    ///
    /// # Errors
    /// [`LinalgError::Singular`], [`LinalgError::Backend`].
    fn fall_back(&mut self, _: &SparsityPattern, _: &[f64]) -> Result<bool, LinalgError> {
        Ok(false)
    }

    /// Negative eigenvalues of the symmetric matrix with these values, a symmetric scaling of what was factorised last; `None` if it cannot be computed from the factors (default).
    fn negative_eigenvalues(&mut self, _: &SparsityPattern, _: &[f64]) -> Option<usize> {
        None
    }

    /// Number of substitutions that cost as much as a factorisation; zero if iterative solutions do not pay.
    fn applications_per_factorisation(&self) -> u32 {
        0
    }

    /// Whether the equilibration has to keep the values' symmetry.
    fn symmetric_scaling(&self) -> bool {
        false
    }

    /// Number of factorisations by the safer method.
    fn pivoting_fallbacks(&self) -> u64 {
        0
    }

    /// Number of matrices announced as positive definite that were not.
    fn indefinite_fallbacks(&self) -> u64 {
        0
    }
}

/// Growth of a solution above which the matrix is tested for singularity once more. A matrix that is singular up to round-off shows at least this growth unless the
/// right-hand side is orthogonal to the undetermined motion to eight digits.
const SUSPICIOUS_GROWTH: f64 = 1e7;

/// A solution with a larger row-wise backward error is worth a second factorisation with safer pivoting.
const GOOD_BACKWARD_ERROR: f64 = 1e-13;

/// Least number of iterations for which an iterative solution is tried. (Two tori with friction, 28 000 equations: the seldom solution takes fewer than six to a
/// relative residual of 1e-6, ten on average, while a factorisation is worth about forty.)
const FEWEST_NEARBY_ITERATIONS: u32 = 6;

/// The true residual of an iterative solution may be this many times the tolerance.
const TRUE_RESIDUAL: f64 = 2.0;

/// A [`LinearSolver`] made of a [`Factorisation`].
#[derive(Debug, Default)]
pub struct DirectSolver<F> {
    factorisation: F,
    options: SolverOptions,
    pattern: Option<Arc<SparsityPattern>>,
    kind: MatrixKind,
    factorised: bool,
    equilibration: Equilibration,
    scaled: Vec<f64>,
    probe: Vec<f64>,
    refinement: Refinement,
    gmres: Gmres,
    /// The equilibrated right-hand side of a nearby solution.
    scaled_rhs: Vec<f64>,
    statistics: SolverStatistics,
}

impl<F: Factorisation + Default> DirectSolver<F> {
    /// A solver with the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// A solver with other settings.
    pub fn with_options(options: SolverOptions) -> Self {
        Self { options, ..Self::default() }
    }
}

/// Added to the diagonal of an equilibrated matrix that has no factors, to find out which motion is undetermined: far above round-off, far
/// below everything that is determined.
const SHIFT: f64 = 1e-10;

impl<F: Factorisation> DirectSolver<F> {
    /// The equation in which the undetermined motion of an exactly singular matrix is largest: two steps of inverse iteration with a slightly
    /// shifted diagonal. `None` if that does not help. Leaves no usable factors.
    fn locate(&mut self) -> Option<usize> {
        let pattern = self.pattern.clone()?;
        for i in 0..pattern.n() as u32 {
            if let Some(k) = pattern.position(i, i) {
                self.scaled[k] += SHIFT;
            }
        }
        self.factorisation.factorise(&pattern, &self.scaled).ok()?;
        self.start_probe();
        for _ in 0..2 {
            self.factorisation.solve_in_place(&mut self.probe);
            let largest = norm_inf(&self.probe);
            if !largest.is_finite() {
                return None;
            }
            self.probe.iter_mut().for_each(|v| *v /= largest);
        }
        self.probe.iter().position(|v| v.abs() == 1.0)
    }

    /// The probe, once more with safer pivoting if it fails: a large growth may be that of a bad pivot.
    fn probe_or_fall_back(&mut self, pattern: &SparsityPattern) -> Result<(), LinalgError> {
        match self.probe() {
            Err(LinalgError::Singular { .. }) if self.factorisation.fall_back(pattern, &self.scaled)? => self.probe(),
            result => result,
        }
    }

    /// Solution and refinement with the present factors.
    fn refine(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        let (factorisation, equilibration) = (&mut self.factorisation, &self.equilibration);
        self.refinement.solve(&self.options, equilibration, rhs, solution, |v| {
            equilibration.scale_rhs(v);
            if !v.is_empty() {
                factorisation.solve_in_place(v);
            }
            equilibration.scale_solution(v);
        })
    }

    /// A right-hand side of entries in [-1, 1).
    fn start_probe(&mut self) {
        self.probe.iter_mut().enumerate().for_each(|(i, v)| *v = pseudo_random(i));
    }

    /// Overwrites `v` by the solution for the right-hand side `v`, without a check: a part of a preconditioner.
    pub(crate) fn substitute(&mut self, v: &mut [f64]) {
        self.equilibration.scale_rhs(v);
        if !v.is_empty() {
            self.factorisation.solve_in_place(v);
        }
        self.equilibration.scale_solution(v);
    }

    /// Solves the equilibrated system for one right-hand side of entries in [-1, 1), and takes a huge or undefined answer as the
    /// sign of a singular matrix.
    fn probe(&mut self) -> Result<(), LinalgError> {
        self.start_probe();
        self.factorisation.solve_in_place(&mut self.probe);
        let mut growth = norm_inf(&self.probe);
        if growth.is_finite() && growth > SUSPICIOUS_GROWTH {
            // One step of inverse iteration: by now the vector is nearly the weakest motion, so that the growth is the
            // whole one even if the first right-hand side happened to do little work on it.
            self.probe.iter_mut().for_each(|v| *v /= growth);
            self.factorisation.solve_in_place(&mut self.probe);
            growth = norm_inf(&self.probe);
        }
        if growth <= self.options.singular_growth {
            return Ok(());
        }
        let finite = self.probe.iter().all(|v| v.is_finite());
        let row = (finite && growth.is_finite()).then(|| self.probe.iter().position(|v| v.abs() == growth)).flatten();
        Err(LinalgError::Singular { row })
    }
}

impl<F: Factorisation> LinearSolver for DirectSolver<F> {
    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        if let Some(known) = &self.pattern
            && kind == self.kind
            && (Arc::ptr_eq(known, pattern) || known == pattern)
        {
            return Ok(());
        }
        self.factorised = false;
        self.pattern = None;
        self.kind = kind;
        self.statistics.analyses += 1;
        self.factorisation.analyse(pattern, kind)?;
        self.refinement.set_pattern(pattern);
        self.probe.clear();
        self.probe.resize(pattern.n(), 0.0);
        self.pattern = Some(Arc::clone(pattern));
        Ok(())
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.factorised = false;
        self.refinement.set_values(values)?;
        let pattern = self.pattern.clone().ok_or(LinalgError::CallOrder { called: "factorise", missing: "analyse" })?;
        self.statistics.factorisations += 1;
        self.statistics.symmetric += u64::from(self.kind != MatrixKind::General);
        if pattern.n() == 0 {
            self.factorised = true;
            return Ok(());
        }
        let scaled = &mut self.scaled;
        if self.factorisation.symmetric_scaling() {
            self.equilibration.compute_symmetric(&pattern, values, scaled)
        } else {
            self.equilibration.compute(&pattern, values, self.kind, scaled)
        }
        .map_err(|row| LinalgError::Singular { row: Some(row) })?;
        let result = self.factorisation.factorise(&pattern, &self.scaled);
        let result = result.and_then(|()| self.probe_or_fall_back(&pattern));
        self.statistics.indefinite_fallbacks = self.factorisation.indefinite_fallbacks();
        self.statistics.pivoting_fallbacks = self.factorisation.pivoting_fallbacks();
        match result {
            Ok(()) => {}
            Err(LinalgError::Singular { row: None }) => return Err(LinalgError::Singular { row: self.locate() }),
            Err(error) => return Err(error),
        }
        self.factorised = true;
        Ok(())
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        if !self.factorised {
            return Err(LinalgError::CallOrder { called: "solve", missing: "factorise" });
        }
        let first = self.refine(rhs, solution);
        let poor = match &first {
            Ok(report) => report.backward_error > GOOD_BACKWARD_ERROR,
            Err(LinalgError::NotConverged { .. } | LinalgError::NonFinite { place: SystemArray::Solution, .. }) => true,
            Err(_) => false,
        };
        let fallen_back = match &self.pattern {
            Some(pattern) if poor => matches!(self.factorisation.fall_back(pattern, &self.scaled), Ok(true)),
            _ => false,
        };
        self.statistics.pivoting_fallbacks = self.factorisation.pivoting_fallbacks();
        let report = if fallen_back { self.refine(rhs, solution) } else { first }?;
        self.statistics.solves += 1;
        self.statistics.refinement_steps += u64::from(report.refinement_steps);
        Ok(report)
    }

    fn solve_nearby(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<Option<u32>, LinalgError> {
        let Some(pattern) = self.pattern.as_ref().filter(|_| self.factorised) else { return Ok(None) };
        let limit = self.factorisation.applications_per_factorisation().min(self.options.max_nearby_iterations);
        if limit < FEWEST_NEARBY_ITERATIONS {
            return Ok(None);
        }
        check_length("values", pattern.nnz(), values)?;
        check_length("right-hand side", pattern.n(), rhs)?;
        check_length("solution", pattern.n(), solution)?;
        check_finite(SystemArray::Matrix, values)?;
        check_finite(SystemArray::RightHandSide, rhs)?;
        let (factorisation, equilibration) = (&mut self.factorisation, &self.equilibration);
        self.scaled_rhs.clear();
        self.scaled_rhs.extend_from_slice(rhs);
        equilibration.scale_rhs(&mut self.scaled_rhs);
        let scratch = &mut self.probe;
        // The unknown of the iteration is that of the equilibrated system.
        let report = self.gmres.solve(
            &self.scaled_rhs,
            solution,
            tolerance,
            limit,
            |x, y| {
                scratch.copy_from_slice(x);
                equilibration.scale_solution(scratch);
                multiply(pattern, values, scratch, y);
                equilibration.scale_rhs(y);
            },
            |v| factorisation.solve_in_place(v),
        );
        self.statistics.nearby_iterations += u64::from(report.iterations);
        // A NaN is no solution.
        let mut good = report.residual <= tolerance;
        equilibration.scale_solution(solution);
        if good {
            // What the recurrence says is true as far as the basis is orthogonal.
            multiply(pattern, values, solution, scratch);
            scratch.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
            equilibration.scale_rhs(scratch);
            good = norm2(scratch) <= TRUE_RESIDUAL * tolerance * norm2(&self.scaled_rhs);
        }
        if !good {
            self.statistics.nearby_given_up += 1;
            return Ok(None);
        }
        self.statistics.nearby_solves += 1;
        Ok(Some(report.iterations))
    }

    fn negative_eigenvalues(&mut self) -> Option<usize> {
        let pattern = self.pattern.clone().filter(|_| self.factorised && self.kind != MatrixKind::General)?;
        if pattern.n() == 0 {
            return Some(0);
        }
        // A symmetric scaling is a congruence, another is not.
        if self.factorisation.symmetric_scaling() {
            return self.factorisation.negative_eigenvalues(&pattern, &self.scaled);
        }
        let mut scaled = Vec::new();
        Equilibration::default().compute_symmetric(&pattern, self.refinement.values(), &mut scaled).ok()?;
        self.factorisation.negative_eigenvalues(&pattern, &scaled)
    }

    fn forget(&mut self) {
        self.factorised = false;
    }

    fn memory_bytes(&self) -> usize {
        size_of::<f64>() * (self.scaled.capacity() + self.probe.capacity() + self.scaled_rhs.capacity())
            + self.gmres.memory_bytes()
            + self.factorisation.memory_bytes()
            + self.equilibration.memory_bytes()
            + self.refinement.memory_bytes()
    }

    fn name(&self) -> &str {
        self.factorisation.name()
    }

    fn statistics(&self) -> SolverStatistics {
        self.statistics
    }
}
