//! What all direct solvers share: equilibration, the test for singularity, the residual check, refinement, statistics,
//! the caching of the analysis. A backend is only the factorisation in between.

use crate::refinement::Refinement;
use crate::scaling::Equilibration;
use crate::vector::norm_inf;
use crate::{LinalgError, LinearSolver, MatrixKind, SolveReport, SolverOptions, SolverStatistics, SparsityPattern};
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

    /// How often a matrix announced as positive definite was not.
    fn indefinite_fallbacks(&self) -> u64 {
        0
    }
}

/// Above this a solution is looked at twice. A matrix that is singular up to round-off shows at least this growth unless the
/// right-hand side is orthogonal to the undetermined motion to eight digits.
const SUSPICIOUS_GROWTH: f64 = 1e7;

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
    statistics: SolverStatistics,
}

impl<F: Factorisation + Default> DirectSolver<F> {
    /// With the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// With other settings.
    pub fn with_options(options: SolverOptions) -> Self {
        Self { options, ..Self::default() }
    }
}

impl<F: Factorisation> DirectSolver<F> {
    /// Solves the equilibrated system for one right-hand side of entries in [-1, 1), and takes a huge or undefined answer as the
    /// sign of a singular matrix.
    fn probe(&mut self) -> Result<(), LinalgError> {
        for (i, v) in self.probe.iter_mut().enumerate() {
            // A hash of the index, not equal sizes: those may cancel exactly against a rigid motion.
            let mut h = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            *v = (h >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        }
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
        let pattern =
            self.pattern.as_ref().ok_or(LinalgError::CallOrder { called: "factorise", missing: "analyse" })?;
        self.statistics.factorisations += 1;
        if pattern.n() == 0 {
            self.factorised = true;
            return Ok(());
        }
        self.equilibration
            .compute(pattern, values, self.kind, &mut self.scaled)
            .map_err(|row| LinalgError::Singular { row: Some(row) })?;
        let result = self.factorisation.factorise(pattern, &self.scaled);
        self.statistics.indefinite_fallbacks = self.factorisation.indefinite_fallbacks();
        result?;
        self.probe()?;
        self.factorised = true;
        Ok(())
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        if !self.factorised {
            return Err(LinalgError::CallOrder { called: "solve", missing: "factorise" });
        }
        let (factorisation, equilibration) = (&mut self.factorisation, &self.equilibration);
        let report = self.refinement.solve(&self.options, equilibration, rhs, solution, |v| {
            equilibration.scale_rhs(v);
            if !v.is_empty() {
                factorisation.solve_in_place(v);
            }
            equilibration.scale_solution(v);
        })?;
        self.statistics.solves += 1;
        self.statistics.refinement_steps += u64::from(report.refinement_steps);
        Ok(report)
    }

    fn memory_bytes(&self) -> usize {
        size_of::<f64>() * (self.scaled.capacity() + self.probe.capacity())
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
