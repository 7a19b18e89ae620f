//! The trait of a linear solver, its reports and settings. The implementations are in
//! [`crate::faer_backend`] and [`crate::AutoSolver`].
//!
//! # To add a solver
//! Implement [`crate::Factorisation`] and wrap it in [`crate::DirectSolver`], so that all solvers have the same guarantees, and add
//! a line to the battery in `tests/solvers.rs`. What iterates offers [`LinearSolver::solve_nearby`] and leaves the rest to a direct solver behind it, as
//! [`crate::AutoSolver`] does.

use crate::{Communicator, EquationPlace, LinalgError, Serial, SparsityPattern};
use std::fmt::Debug;
use std::sync::Arc;

/// Kind of the matrix. The pattern always has both triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MatrixKind {
    /// General: unsymmetric, indefinite, with zero blocks on the diagonal.
    #[default]
    General,
    /// `A = A^T`, possibly indefinite.
    Symmetric,
    /// `A = A^T` and probably positive definite. If it is not, that costs time but does not change the answer:
    /// a Newton tangent need not stay definite.
    SymmetricPositiveDefinite,
}

/// The quality of one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveReport {
    /// Row-wise backward error `max_i |b - A x|_i / (|A| |x| + |b|)_i` of the original, unscaled system
    ///
    /// In a row whose denominator is at round-off level (sparse right-hand sides and solutions make such rows) the
    /// quotient means nothing; there the row's largest term is added to the denominator, taken in the equilibrated
    /// variables, after Arioli, Demmel and Duff (SIAM J. Matrix Anal. Appl. 10, 1989). A small value says that `x` solves
    /// exactly a system in which every entry was changed by so much relative to itself: with badly scaled rows a residual
    /// measured by one norm of all rows proves nothing.
    pub backward_error: f64,
    /// Steps of iterative refinement that were needed.
    pub refinement_steps: u32,
}

/// Statistics of a solver since it was made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SolverStatistics {
    /// Symbolic analyses (calls of `analyse` that found the pattern unchanged are not counted).
    pub analyses: u64,
    /// Numeric factorisations, failed ones and fallbacks included.
    pub factorisations: u64,
    /// Factorisations of matrices announced as symmetric.
    pub symmetric: u64,
    /// Solutions.
    pub solves: u64,
    /// Steps of iterative refinement.
    pub refinement_steps: u64,
    /// Solutions by iteration with the factors of earlier values ([`LinearSolver::solve_nearby`]).
    pub nearby_solves: u64,
    /// Iterations of [`Self::nearby_solves`] and of those that were given up.
    pub nearby_iterations: u64,
    /// Iterative solutions that were given up: too many iterations, or a true residual larger than that of the iteration.
    pub nearby_given_up: u64,
    /// Matrices announced as positive definite that were not, and were factorised by LU instead.
    pub indefinite_fallbacks: u64,
    /// Matrices for which the pivots inside the fronts were not good enough, so that they were factorised again with full
    /// pivoting.
    pub pivoting_fallbacks: u64,
    /// Solutions by iteration with a preconditioner of its own (smoothed aggregation).
    pub iterative_solves: u64,
    /// Iterations of [`Self::iterative_solves`] and of those that were given up.
    pub iterations: u64,
    /// Preconditioners that were made.
    pub set_ups: u64,
    /// Times that the iteration left a step to the direct solver, see [`LinearSolver::take_reason`].
    pub handed_over: u64,
}

impl std::ops::Add for SolverStatistics {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            analyses: self.analyses + other.analyses,
            factorisations: self.factorisations + other.factorisations,
            symmetric: self.symmetric + other.symmetric,
            solves: self.solves + other.solves,
            refinement_steps: self.refinement_steps + other.refinement_steps,
            nearby_solves: self.nearby_solves + other.nearby_solves,
            nearby_iterations: self.nearby_iterations + other.nearby_iterations,
            nearby_given_up: self.nearby_given_up + other.nearby_given_up,
            indefinite_fallbacks: self.indefinite_fallbacks + other.indefinite_fallbacks,
            pivoting_fallbacks: self.pivoting_fallbacks + other.pivoting_fallbacks,
            iterative_solves: self.iterative_solves + other.iterative_solves,
            iterations: self.iterations + other.iterations,
            set_ups: self.set_ups + other.set_ups,
            handed_over: self.handed_over + other.handed_over,
        }
    }
}

/// Settings common to all solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverOptions {
    /// Row-wise backward error at which refinement stops.
    pub target_backward_error: f64,
    /// An error above this after refinement is [`LinalgError::NotConverged`].
    pub acceptable_backward_error: f64,
    /// Largest number of refinement steps for a solution.
    pub max_refinement_steps: u32,
    /// After a factorisation the equilibrated system is solved once for a fixed right-hand side of entries in [-1, 1). If the
    /// solution is larger than this the matrix is [`LinalgError::Singular`]: its smallest singular value is at round-off level,
    /// and the Newton increment would be noise. Without this test a body without supports is not detected, because its residual
    /// is self-equilibrated.
    pub singular_growth: f64,
    /// Largest number of iterations of [`LinearSolver::solve_nearby`], each of which stores a vector. Zero: factors, and preconditioners of an iteration,
    /// serve for the values they were made from only.
    pub max_nearby_iterations: u32,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            target_backward_error: 1e-14,
            acceptable_backward_error: 1e-9,
            max_refinement_steps: 8,
            singular_growth: 1e13,
            max_nearby_iterations: 40,
        }
    }
}

/// A solver for `A x = b` with a pattern that seldom changes.
///
/// The three phases are called in order; `factorise` may be repeated with new values, `solve` with new right-hand sides.
/// The result depends on the input since the last [`LinearSolver::forget`] only: a repetition gives the same bits, on any number of threads.
pub trait LinearSolver: Send + Debug {
    /// Where the equations of the pattern are that is given to [`Self::analyse`] next, with the present positions of nodes. Called before each `analyse` for the sake of solvers that
    /// iterate; without it they leave a pattern to factorisation. Ignored by default.
    fn place(&mut self, _equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) {}

    /// The ranks over which the matrix is spread. With more than one, `analyse`, `factorise` and whatever else takes a pattern or values get those of each rank's own contributions, in the numbers of
    /// the whole; the matrix is their sum over the ranks. Right-hand sides and solutions are whole on all ranks, and every method is collective. One rank by default.
    fn communicator(&self) -> Arc<dyn Communicator> {
        Serial::shared()
    }

    /// The rank that has the row of each equation of the pattern that is given to [`Self::analyse`] next. Called with [`Self::place`], and only with more than one rank. Ignored by default.
    fn spread(&mut self, _owners: &mut dyn ExactSizeIterator<Item = u32>) {}

    /// Symbolic phase: ordering, storage. A no-op if pattern (the same `Arc`, or an equal one) and kind are those of the last
    /// call. A change invalidates the factorisation.
    ///
    /// # Errors
    /// [`LinalgError::Backend`] for lack of memory.
    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError>;

    /// Numeric phase. `values` in the order of the pattern; they are copied.
    ///
    /// # Errors
    /// [`LinalgError::NonFinite`], [`LinalgError::Singular`], [`LinalgError::Length`], [`LinalgError::CallOrder`],
    /// [`LinalgError::Backend`]. After an error there is no factorisation.
    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError>;

    /// Solves with the last factorisation, checks the residual and refines.
    ///
    /// # Errors
    /// [`LinalgError::NonFinite`], [`LinalgError::NotConverged`], [`LinalgError::Length`], [`LinalgError::CallOrder`].
    /// `solution` is then meaningless.
    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError>;

    /// Solves `A x = b` for other values than those factorised, which are the preconditioner of an iteration that ends when the equilibrated residual
    /// has fallen to `tolerance` times the equilibrated right-hand side, both in the Euclidean norm; the residual of the solution is computed
    /// once more at the end and may be twice that. Returns the number of iterations. A solver with a preconditioner of its own, made from any of the values since
    /// [`Self::forget`], stops at the forcing term of an inexact Newton method instead if that is larger, at most 1e-2 ([`crate::AutoSolver`]).
    ///
    /// `None`, and a meaningless `solution`, if there are no factors of this pattern, if that many iterations would cost more than a
    /// factorisation of the new values, or if the solver does not offer it (default): the caller then factorises.
    /// [`Self::solve`] refers to the factorised values as before.
    ///
    /// # Errors
    /// [`LinalgError::Length`], [`LinalgError::NonFinite`].
    fn solve_nearby(
        &mut self,
        _values: &[f64],
        _rhs: &[f64],
        _solution: &mut [f64],
        _tolerance: f64,
    ) -> Result<Option<u32>, LinalgError> {
        Ok(None)
    }

    /// Solves a symmetric `A x = b` by iteration to a residual as of [`Self::solve_nearby`], unless a direction is met in which `A` has no positive curvature. Returns false, and a meaningless
    /// `solution`, if one is met or if the solver does not iterate (default): the caller then factorises and counts ([`Self::negative_eigenvalues`]). An iteration sees a
    /// direction where its vectors or its coarsest level have a part of it, and never counts how many there are.
    ///
    /// # Errors
    /// The errors of [`Self::solve_nearby`].
    fn solve_definite(
        &mut self,
        _values: &[f64],
        _rhs: &[f64],
        _solution: &mut [f64],
        _tolerance: f64,
    ) -> Result<bool, LinalgError> {
        Ok(false)
    }

    /// Whether the symmetric matrix with these values has no direction of negative curvature, as far as an iteration can tell that has solved nearby ones since [`LinearSolver::forget`].
    /// `None` for those that do not iterate (default): they count negative eigenvalues.
    fn is_definite(&mut self, _values: &[f64]) -> Option<bool> {
        None
    }

    /// Why the iteration has left the systems since the last [`LinearSolver::forget`] to the direct solver, if it has and nobody asked yet. `None` by default.
    fn take_reason(&mut self) -> Option<String> {
        None
    }

    /// Number of negative eigenvalues of the matrix that was factorised last (Sylvester: as many as negative pivots of `L D L^T`), of one announced as symmetric.
    /// `None` for others, without factors, and for solvers that cannot count them (default).
    fn negative_eigenvalues(&mut self) -> Option<usize> {
        None
    }

    /// Drops the factors, so that later results do not depend on earlier ones, to the last bit. An analysis that would be repeated in the same way is kept.
    fn forget(&mut self);

    /// Heap memory in bytes: exact for our own arrays, an estimate for the library's factors.
    fn memory_bytes(&self) -> usize;

    /// A short name for records.
    fn name(&self) -> &str;

    /// Statistics so far.
    fn statistics(&self) -> SolverStatistics;
}
