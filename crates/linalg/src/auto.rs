//! The choice of a solver by the size of the system and by what its equations are.

use crate::iterative::{Curvature, IterativeSolver};
use crate::{
    DenseSolver, EquationPlace, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SolveReport, SolverOptions,
    SolverStatistics, SparsityPattern,
};
use std::sync::Arc;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Choice {
    Dense,
    #[default]
    Multifrontal,
}

/// Direct solvers and, for large systems whose equations have places ([`LinearSolver::place`]), an iteration in front of them.
///
/// Up to [`AutoSolver::DENSE_LIMIT`] equations a dense LU, above it the multifrontal factorisation; [`LinearSolver::solve_nearby`] and [`LinearSolver::solve_definite`] iterate from
/// [`AutoSolver::ITERATIVE`] equations on, with multipliers from [`AutoSolver::ITERATIVE_WITH_MULTIPLIERS`]. What the iteration cannot solve, or would solve slowly, it leaves to
/// the factorisation until the next [`LinearSolver::forget`]. [`LinearSolver::factorise`] always factorises. The choice depends on the data only, hence it is the same in every run.
///
/// The iteration ends at the forcing term of Eisenstat and Walker (SIAM J. Sci. Comput. 17, 1996), `0.9 (|b| / |b_before|)^2` at most 1e-2, from the
/// right-hand sides since `forget`, or at the tolerance of the caller if that is more than a tenth of it; with multipliers at a hundredth of the caller's tolerance, or at 1e-8 or the tolerance,
/// whichever is smaller, if that is more.
#[derive(Debug, Default)]
pub struct AutoSolver {
    dense: DenseSolver,
    multifrontal: MultifrontalSolver,
    iterative: IterativeSolver,
    choice: Choice,
    preference: Preference,
    /// Whether the present pattern is iterated on.
    iterates: bool,
    pattern: Option<Arc<SparsityPattern>>,
    kind: MatrixKind,
}

/// Size from which on an [`AutoSolver`] iterates.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Preference {
    /// Iterates from the size on from which that is faster.
    #[default]
    Fastest,
    /// Iterates from the size on from which there is anything to coarsen.
    Iterative,
}

impl AutoSolver {
    /// The largest system that is factorised as a dense one. Measured on whole runs of two blocks that collide, CPU time of the multifrontal solver
    /// over that of the others: 52 equations 0.94 (dense), 171 equations 0.82 (dense) and 0.84 (faer's sparse factorisation), 400 equations 0.79
    /// (faer), 775 equations 0.76 (faer).
    pub const DENSE_LIMIT: usize = 50;

    /// The smallest system without multipliers that is iterated on.
    pub const ITERATIVE: usize = 3000;

    /// The smallest system with multipliers that is iterated on, if they are less than one in [`AutoSolver::MULTIPLIERS`] equations.
    pub const ITERATIVE_WITH_MULTIPLIERS: usize = 15_000;

    /// Least number of equations to each multiplier of a system that is iterated on, see [`AutoSolver::ITERATIVE_WITH_MULTIPLIERS`].
    pub const MULTIPLIERS: usize = 8;

    /// The smallest system that is iterated on where that is preferred: smaller ones have nothing to coarsen.
    pub const SMALLEST_ITERATIVE: usize = 1000;

    /// A solver with the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// A solver with other settings.
    pub fn with_options(options: SolverOptions) -> Self {
        let mut iterative = IterativeSolver::default();
        iterative.renew_always(options.max_nearby_iterations == 0);
        Self {
            dense: DenseSolver::with_options(options),
            multifrontal: MultifrontalSolver::with_options(options),
            iterative,
            ..Self::default()
        }
    }

    /// A solver with other settings that iterates from [`AutoSolver::SMALLEST_ITERATIVE`] equations on as long as less than half of them are of multipliers and
    /// parts.
    pub fn preferring_iteration(options: SolverOptions) -> Self {
        Self { preference: Preference::Iterative, ..Self::with_options(options) }
    }

    fn active(&mut self) -> &mut dyn LinearSolver {
        match self.choice {
            Choice::Dense => &mut self.dense,
            Choice::Multifrontal => &mut self.multifrontal,
        }
    }

    /// Whether a system of so many equations, so many of them `others` than those of nodes of bodies, is iterated on, by [`AutoSolver::new`] or (`prefers`)
    /// [`AutoSolver::preferring_iteration`], if its equations have places.
    pub fn iterates_on(prefers: bool, equations: usize, others: usize) -> bool {
        if prefers {
            equations >= Self::SMALLEST_ITERATIVE && 2 * others < equations
        } else if others == 0 {
            equations >= Self::ITERATIVE
        } else {
            equations >= Self::ITERATIVE_WITH_MULTIPLIERS && Self::MULTIPLIERS * others < equations
        }
    }

    /// Whether systems of this size with the present places are iterated on.
    fn suits(&self, n: usize) -> bool {
        let (placed, others) = self.iterative.placed();
        placed == n && Self::iterates_on(self.preference == Preference::Iterative, n, others)
    }

    /// The direct solver, which is given the pattern only when it is needed.
    fn direct(&mut self) -> Result<&mut dyn LinearSolver, LinalgError> {
        let kind = self.kind;
        if let Some(pattern) = self.pattern.clone() {
            self.active().analyse(&pattern, kind)?;
        }
        Ok(self.active())
    }

    fn iterate(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
        curvature: Curvature,
    ) -> Result<Option<u32>, LinalgError> {
        if self.iterates { self.iterative.solve(values, rhs, solution, tolerance, curvature) } else { Ok(None) }
    }
}

impl LinearSolver for AutoSolver {
    fn place(&mut self, equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) {
        let smallest = match self.preference {
            Preference::Fastest => Self::ITERATIVE,
            Preference::Iterative => Self::SMALLEST_ITERATIVE,
        };
        if equations.len() >= smallest {
            self.iterative.place(equations);
        }
    }

    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        self.choice = match pattern.n() {
            n if n <= Self::DENSE_LIMIT => Choice::Dense,
            _ => Choice::Multifrontal,
        };
        self.iterates = self.suits(pattern.n());
        self.kind = kind;
        self.pattern = Some(Arc::clone(pattern));
        if self.iterates {
            self.iterative.analyse(pattern, kind);
            return Ok(());
        }
        self.active().analyse(pattern, kind)
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.direct()?.factorise(values)
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
        let iterations = self.iterate(values, rhs, solution, tolerance, Curvature::Any)?;
        if iterations.is_some() {
            Ok(iterations)
        } else {
            self.direct()?.solve_nearby(values, rhs, solution, tolerance)
        }
    }

    fn solve_definite(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, LinalgError> {
        Ok(self.iterate(values, rhs, solution, tolerance, Curvature::Positive)?.is_some())
    }

    fn is_definite(&mut self, values: &[f64]) -> Option<bool> {
        if self.iterates { self.iterative.is_definite(values) } else { None }
    }

    fn take_reason(&mut self) -> Option<String> {
        self.iterative.take_reason()
    }

    fn negative_eigenvalues(&mut self) -> Option<usize> {
        self.active().negative_eigenvalues()
    }

    fn forget(&mut self) {
        // A pattern of another size may have been another solver's in between.
        self.dense.forget();
        self.multifrontal.forget();
        self.iterative.forget();
    }

    fn memory_bytes(&self) -> usize {
        self.dense.memory_bytes() + self.multifrontal.memory_bytes() + self.iterative.memory_bytes()
    }

    fn name(&self) -> &str {
        match self.choice {
            _ if self.iterates && !self.iterative.has_refused() => "smoothed aggregation",
            Choice::Dense => self.dense.name(),
            Choice::Multifrontal => self.multifrontal.name(),
        }
    }

    fn statistics(&self) -> SolverStatistics {
        self.dense.statistics() + self.multifrontal.statistics() + self.iterative.statistics()
    }
}
