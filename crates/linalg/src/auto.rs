//! The choice of a solver by the size of the system.

use crate::{
    DenseSolver, FaerSolver, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SolveReport, SolverOptions,
    SolverStatistics, SparsityPattern,
};
use std::sync::Arc;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Choice {
    Dense,
    #[default]
    Sparse,
    Multifrontal,
}

/// Dense LU up to [`AutoSolver::DENSE_LIMIT`] equations, faer's sparse factorisation up to [`AutoSolver::SPARSE_LIMIT`], the multifrontal
/// one above. The choice depends on the size only, hence it is the same in every run.
#[derive(Debug, Default)]
pub struct AutoSolver {
    dense: DenseSolver,
    sparse: FaerSolver,
    multifrontal: MultifrontalSolver,
    choice: Choice,
}

impl AutoSolver {
    /// The largest system that is factorised as a dense one. Measured (`benches/factorise.rs`, a saddle point on a mesh): 148
    /// equations 0.17 ms dense and 0.22 ms sparse, 309 equations 0.88 and 0.80 ms; the dense one needs no analysis.
    pub const DENSE_LIMIT: usize = 200;

    /// The largest system that is left to faer's sparse factorisation.
    pub const SPARSE_LIMIT: usize = 1000;

    /// With the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// With other settings.
    pub fn with_options(options: SolverOptions) -> Self {
        Self {
            dense: DenseSolver::with_options(options),
            sparse: FaerSolver::with_options(options),
            multifrontal: MultifrontalSolver::with_options(options),
            choice: Choice::default(),
        }
    }

    fn active(&mut self) -> &mut dyn LinearSolver {
        match self.choice {
            Choice::Dense => &mut self.dense,
            Choice::Sparse => &mut self.sparse,
            Choice::Multifrontal => &mut self.multifrontal,
        }
    }
}

impl LinearSolver for AutoSolver {
    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        self.choice = match pattern.n() {
            n if n <= Self::DENSE_LIMIT => Choice::Dense,
            n if n <= Self::SPARSE_LIMIT => Choice::Sparse,
            _ => Choice::Multifrontal,
        };
        self.active().analyse(pattern, kind)
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.active().factorise(values)
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        self.active().solve(rhs, solution)
    }

    fn solve_nearby(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<Option<u32>, LinalgError> {
        self.active().solve_nearby(values, rhs, solution, tolerance)
    }

    fn forget(&mut self) {
        // A pattern of another size may have been another solver's in between.
        self.dense.forget();
        self.sparse.forget();
        self.multifrontal.forget();
    }

    fn memory_bytes(&self) -> usize {
        self.dense.memory_bytes() + self.sparse.memory_bytes() + self.multifrontal.memory_bytes()
    }

    fn name(&self) -> &str {
        match self.choice {
            Choice::Dense => self.dense.name(),
            Choice::Sparse => self.sparse.name(),
            Choice::Multifrontal => self.multifrontal.name(),
        }
    }

    fn statistics(&self) -> SolverStatistics {
        self.dense.statistics() + self.sparse.statistics() + self.multifrontal.statistics()
    }
}
