//! A solver for matrices that are spread over ranks which gathers all of it on each of them and solves there. It saves neither time nor memory; every other part of a distributed run can be run
//! and tested with it.

use crate::{
    Communicator, EquationPlace, LinalgError, LinearSolver, MatrixKind, SolveReport, SolverStatistics, SparsityPattern,
};
use std::sync::Arc;

/// A solver of a system of all ranks that gathers it and solves it on each of them.
#[derive(Debug)]
pub struct GatheredSolver {
    communicator: Arc<dyn Communicator>,
    inner: Box<dyn LinearSolver>,
    local: Option<Arc<SparsityPattern>>,
    whole: Option<Arc<SparsityPattern>>,
    /// Entries of each rank, and where they go in the whole.
    counts: Vec<usize>,
    places: Vec<u32>,
    sums: Vec<f64>,
}

impl GatheredSolver {
    /// A gathered solver around a solver of one rank.
    pub fn new(communicator: Arc<dyn Communicator>, inner: Box<dyn LinearSolver>) -> Self {
        let (counts, places, sums) = (Vec::new(), Vec::new(), Vec::new());
        Self { communicator, inner, local: None, whole: None, counts, places, sums }
    }

    /// The pattern of the sum of the ranks' matrices.
    fn gather_pattern(&mut self, pattern: &SparsityPattern) -> Result<SparsityPattern, LinalgError> {
        let mut mine = Vec::with_capacity(8 * pattern.nnz());
        for column in 0..pattern.n() {
            for row in pattern.column(column) {
                mine.extend_from_slice(&row.to_le_bytes());
                mine.extend_from_slice(&(column as u32).to_le_bytes());
            }
        }
        let all = self.communicator.gather_bytes(&mine);
        self.counts = all.iter().map(|bytes| bytes.len() / 8).collect();
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let entries: Vec<[u32; 2]> =
            all.iter().flat_map(|bytes| bytes.chunks_exact(8)).map(|b| [word(b), word(&b[4..])]).collect();
        let mut whole = SparsityPattern::from_stencils(pattern.n(), entries.iter().map(|entry| &entry[..]))?;
        if let Some(groups) = pattern.groups() {
            whole = whole.with_groups(groups.to_vec())?;
        }
        // Every entry is in the pattern that was made from it.
        self.places = entries.iter().map(|&[i, j]| whole.position(i, j).unwrap_or_default() as u32).collect();
        Ok(whole.with_first_multiplier(pattern.first_multiplier()))
    }

    /// The values of the sum, into `self.sums`.
    fn gather_values(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        let Some(whole) = &self.whole else {
            return Err(LinalgError::CallOrder { called: "factorise", missing: "analyse" });
        };
        let expected = self.counts[self.communicator.rank()];
        if values.len() != expected {
            return Err(LinalgError::Length { what: "list of values", expected, found: values.len() });
        }
        let mut all = vec![0.0; self.places.len()];
        self.communicator.gather(values, &self.counts, &mut all);
        self.sums.clear();
        self.sums.resize(whole.nnz(), 0.0);
        all.iter().zip(&self.places).for_each(|(value, &at)| self.sums[at as usize] += value);
        Ok(())
    }
}

impl LinearSolver for GatheredSolver {
    fn place(&mut self, equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) {
        self.inner.place(equations);
    }

    fn communicator(&self) -> Arc<dyn Communicator> {
        Arc::clone(&self.communicator)
    }

    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        let same = self.local.as_ref().is_some_and(|old| Arc::ptr_eq(old, pattern) || **old == **pattern);
        // It may be the same on one rank and another on the next.
        if self.communicator.any(!same) {
            self.whole = Some(Arc::new(self.gather_pattern(pattern)?));
            self.local = Some(Arc::clone(pattern));
        }
        match &self.whole {
            Some(whole) => self.inner.analyse(whole, kind),
            None => Ok(()),
        }
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.gather_values(values)?;
        self.inner.factorise(&self.sums)
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        self.inner.solve(rhs, solution)
    }

    fn solve_nearby(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<Option<u32>, LinalgError> {
        if self.whole.is_none() {
            return Ok(None);
        }
        self.gather_values(values)?;
        self.inner.solve_nearby(&self.sums, rhs, solution, tolerance)
    }

    fn solve_definite(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, LinalgError> {
        self.gather_values(values)?;
        self.inner.solve_definite(&self.sums, rhs, solution, tolerance)
    }

    fn is_definite(&mut self, values: &[f64]) -> Option<bool> {
        self.gather_values(values).ok()?;
        self.inner.is_definite(&self.sums)
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
        self.inner.memory_bytes() + 4 * self.places.capacity() + 8 * self.sums.capacity()
    }

    fn name(&self) -> &str {
        self.inner.name()
    }

    fn statistics(&self) -> SolverStatistics {
        self.inner.statistics()
    }
}
