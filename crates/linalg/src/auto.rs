//! The choice of a solver by the size of the system.

use crate::{
    DenseSolver, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SolveReport, SolverOptions,
    SolverStatistics, SparsityPattern,
};
use std::sync::Arc;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Choice {
    Dense,
    #[default]
    Multifrontal,
}

/// Dense LU up to [`AutoSolver::DENSE_LIMIT`] equations, the multifrontal factorisation above. The choice depends on the size only, hence it is the same in every run.
#[derive(Debug, Default)]
pub struct AutoSolver {
    dense: DenseSolver,
    multifrontal: MultifrontalSolver,
    choice: Choice,
}

impl AutoSolver {
    /// The largest system that is factorised as a dense one. Measured on whole runs of two blocks that collide, CPU time of the multifrontal solver
    /// over that of the others: 52 equations 0.94 (dense), 171 equations 0.82 (dense) and 0.84 (faer's sparse factorisation), 400 equations 0.79
    /// (faer), 775 equations 0.76 (faer).
    pub const DENSE_LIMIT: usize = 50;

    /// With the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// With other settings.
    pub fn with_options(options: SolverOptions) -> Self {
        Self {
            dense: DenseSolver::with_options(options),
            multifrontal: MultifrontalSolver::with_options(options),
            choice: Choice::default(),
        }
    }

    fn active(&mut self) -> &mut dyn LinearSolver {
        match self.choice {
            Choice::Dense => &mut self.dense,
            Choice::Multifrontal => &mut self.multifrontal,
        }
    }
}

impl LinearSolver for AutoSolver {
    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        self.choice = match pattern.n() {
            n if n <= Self::DENSE_LIMIT => Choice::Dense,
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

    fn negative_eigenvalues(&mut self) -> Option<usize> {
        self.active().negative_eigenvalues()
    }

    fn forget(&mut self) {
        // A pattern of another size may have been another solver's in between.
        self.dense.forget();
        self.multifrontal.forget();
    }

    fn memory_bytes(&self) -> usize {
        self.dense.memory_bytes() + self.multifrontal.memory_bytes()
    }

    fn name(&self) -> &str {
        match self.choice {
            Choice::Dense => self.dense.name(),
            Choice::Multifrontal => self.multifrontal.name(),
        }
    }

    fn statistics(&self) -> SolverStatistics {
        self.dense.statistics() + self.multifrontal.statistics()
    }
}
