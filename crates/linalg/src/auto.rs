//! The choice of a solver by the size of the system.

use crate::{
    DenseSolver, FaerSolver, LinalgError, LinearSolver, MatrixKind, SolveReport, SolverOptions, SolverStatistics,
    SparsityPattern,
};
use std::sync::Arc;

/// Dense LU up to [`AutoSolver::DENSE_LIMIT`] equations, sparse factorisation above. The choice depends on the size only, hence
/// it is the same in every run.
#[derive(Debug, Default)]
pub struct AutoSolver {
    dense: DenseSolver,
    sparse: FaerSolver,
    use_dense: bool,
}

impl AutoSolver {
    /// The largest system that is factorised as a dense one. Measured (`benches/factorise.rs`, a saddle point on a mesh): 148
    /// equations 0.17 ms dense and 0.22 ms sparse, 309 equations 0.88 and 0.80 ms; the dense one needs no analysis.
    pub const DENSE_LIMIT: usize = 200;

    /// With the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// With other settings.
    pub fn with_options(options: SolverOptions) -> Self {
        Self { dense: DenseSolver::with_options(options), sparse: FaerSolver::with_options(options), use_dense: false }
    }

    fn active(&mut self) -> &mut dyn LinearSolver {
        if self.use_dense { &mut self.dense } else { &mut self.sparse }
    }
}

impl LinearSolver for AutoSolver {
    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        self.use_dense = pattern.n() <= Self::DENSE_LIMIT;
        self.active().analyse(pattern, kind)
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.active().factorise(values)
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        self.active().solve(rhs, solution)
    }

    fn memory_bytes(&self) -> usize {
        self.dense.memory_bytes() + self.sparse.memory_bytes()
    }

    fn name(&self) -> &str {
        if self.use_dense { self.dense.name() } else { self.sparse.name() }
    }

    fn statistics(&self) -> SolverStatistics {
        self.dense.statistics() + self.sparse.statistics()
    }
}
