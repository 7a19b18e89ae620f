//! A solver that hands the systems it solves to a recorder.

use crate::{EquationPlace, LinalgError, LinearSolver, MatrixKind, SolveReport, SolverStatistics, SparsityPattern};
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// A system that is solved.
#[derive(Clone, Copy, Debug)]
pub struct SolvedSystem<'a> {
    /// Pattern of the matrix.
    pub pattern: &'a SparsityPattern,
    /// Kind of the matrix as announced by the caller.
    pub kind: MatrixKind,
    /// Values in the order of the pattern.
    pub values: &'a [f64],
    /// Right-hand side.
    pub rhs: &'a [f64],
}

/// Called with each system; returns whether it wants further ones.
pub type Recorder = Box<dyn FnMut(SolvedSystem<'_>) -> bool + Send>;

/// Passes everything on to another solver, and hands the systems that are factorised and solved to a [`Recorder`]. Results do not depend on it.
pub struct RecordingSolver {
    inner: Box<dyn LinearSolver>,
    recorder: Option<Recorder>,
    pattern: Option<Arc<SparsityPattern>>,
    kind: MatrixKind,
    /// Values that were factorised and not recorded yet.
    values: Vec<f64>,
}

impl RecordingSolver {
    /// A solver with a recorder that gets the systems until it returns false.
    pub fn new(inner: Box<dyn LinearSolver>, recorder: Recorder) -> Self {
        Self { inner, recorder: Some(recorder), pattern: None, kind: MatrixKind::General, values: Vec::new() }
    }
}

impl Debug for RecordingSolver {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordingSolver").field("inner", &self.inner).finish_non_exhaustive()
    }
}

impl LinearSolver for RecordingSolver {
    fn place(&mut self, equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) {
        self.inner.place(equations);
    }

    fn communicator(&self) -> Arc<dyn crate::Communicator> {
        self.inner.communicator()
    }

    fn spread(&mut self, owners: &mut dyn ExactSizeIterator<Item = u32>) {
        self.inner.spread(owners);
    }

    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        (self.pattern, self.kind) = (Some(Arc::clone(pattern)), kind);
        self.inner.analyse(pattern, kind)
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.values.clear();
        if self.recorder.is_some() {
            self.values.extend_from_slice(values);
        }
        self.inner.factorise(values)
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        if let (Some(recorder), Some(pattern)) = (&mut self.recorder, &self.pattern)
            && self.values.len() == pattern.nnz()
        {
            let goes_on = recorder(SolvedSystem { pattern, kind: self.kind, values: &self.values, rhs });
            self.values.clear();
            if !goes_on {
                self.recorder = None;
            }
        }
        self.inner.solve(rhs, solution)
    }

    fn solve_nearby(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<Option<u32>, LinalgError> {
        self.inner.solve_nearby(values, rhs, solution, tolerance)
    }

    fn solve_definite(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, LinalgError> {
        self.inner.solve_definite(values, rhs, solution, tolerance)
    }

    fn is_definite(&mut self, values: &[f64]) -> Option<bool> {
        self.inner.is_definite(values)
    }

    fn take_reason(&mut self) -> Option<String> {
        self.inner.take_reason()
    }

    fn negative_eigenvalues(&mut self) -> Option<usize> {
        self.inner.negative_eigenvalues()
    }

    fn forget(&mut self) {
        self.inner.forget();
    }

    fn memory_bytes(&self) -> usize {
        self.inner.memory_bytes() + size_of::<f64>() * self.values.capacity()
    }

    fn name(&self) -> &str {
        self.inner.name()
    }

    fn statistics(&self) -> SolverStatistics {
        self.inner.statistics()
    }
}
