//! PETSc's solvers behind the trait of a linear solver.

use crate::Mpi;
use crate::ffi::{self, Failure, Quality, System};
use crate::method::{Method, prefixed};
use crate::rows::Rows;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use stoss_linalg::{
    Communicator, EquationPlace, LinalgError, LinearSolver, MatrixKind, SolveReport, SolverOptions, SolverStatistics,
    SparsityPattern, SystemArray,
};

/// Numbers of the two solvers of a matrix: the one that factorises (or has the options of the user) and the one that iterates.
const DIRECT: usize = 0;
const ITERATIVE: usize = 1;

/// The largest relative residual of an iteration, so that Newton's method takes the way of exact solutions.
const TOLERANCE: f64 = 1e-8;

/// The relative residual up to which a solution by options of the user is taken.
const ACCEPTED: f64 = 1e-6;

/// Words of errors.
const SOLUTION: &str = "the solution by PETSc";

/// PETSc's solvers for a matrix whose rows are spread over all ranks.
///
/// Needs the place of each equation ([`LinearSolver::place`]) and, on several ranks, its owner ([`LinearSolver::spread`]). The true residual is computed after every solution. Of those of MUMPS
/// the normwise backward error `|b - A x| / (|A| |x| + |b|)` (norms of largest entries) is refined and reported; on several ranks MUMPS does not promise the same last bits in every run.
#[derive(Debug)]
pub struct PetscSolver {
    mpi: Arc<Mpi>,
    method: Method,
    options: SolverOptions,
    /// Number of the solver in this program, for the prefix of its options.
    number: u64,
    places: Vec<EquationPlace>,
    owners: Vec<u32>,
    pattern: Option<Arc<SparsityPattern>>,
    kind: MatrixKind,
    rows: Rows,
    system: Option<System>,
    values: Vec<f64>,
    /// Whether the direct solver has factors, and of symmetric ones the number of negative pivots.
    factors: Option<Option<usize>>,
    /// Why the iteration is not tried until the next `forget`, and whether that was asked for.
    refusal: Option<(String, bool)>,
    /// Options that PETSc has not asked for in the first solution.
    unused: Option<Vec<String>>,
    statistics: SolverStatistics,
}

impl PetscSolver {
    /// A solver on all ranks of MPI.
    pub fn new(mpi: Arc<Mpi>, method: Method) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        Self {
            mpi,
            method,
            options: SolverOptions::default(),
            number: COUNT.fetch_add(1, Ordering::Relaxed),
            places: Vec::new(),
            owners: Vec::new(),
            pattern: None,
            kind: MatrixKind::General,
            rows: Rows::default(),
            system: None,
            values: Vec::new(),
            factors: None,
            refusal: None,
            unused: None,
            statistics: SolverStatistics::default(),
        }
    }

    fn ranks(&self) -> &dyn Communicator {
        &*self.mpi
    }

    /// Prefix of the options of a solver.
    fn prefix(&self, engine: usize) -> String {
        let symmetric = if self.kind == MatrixKind::General { "" } else { "s" };
        format!("stoss{}{}{symmetric}_", self.number, ["d", "i"][engine])
    }

    /// Makes a solver with these options, unless there is one.
    fn add_engine(&mut self, engine: usize, options: &str) -> Result<(), LinalgError> {
        let prefix = self.prefix(engine);
        let Some(system) = &mut self.system else { return Err(missing("factorise", "analyse")) };
        if system.has_engine(engine) {
            return Ok(());
        }
        let made = ffi::insert_options(&prefixed(options, &prefix)).and_then(|()| system.add_engine(engine, &prefix));
        made.map_err(|message| LinalgError::Settings { message: format!("{message} (options: {options})") })
    }

    /// Gives PETSc the values of this rank's part.
    fn set_values(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        let Some((system, pattern)) = self.system.as_mut().zip(self.pattern.as_ref()) else {
            return Err(missing("factorise", "analyse"));
        };
        if values.len() != pattern.nnz() {
            let (expected, found) = (pattern.nnz(), values.len());
            return Err(LinalgError::Length { what: "list of values", expected, found });
        }
        self.factors = None;
        let wrong = values.iter().position(|value| !value.is_finite());
        let scale = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        // The first rank with a value that is not finite: all have the same error.
        let mut found = vec![0.0; self.mpi.size()];
        let mine = wrong.map_or(-1.0, |index| index as f64);
        self.mpi.gather(&[mine], &vec![1; self.mpi.size()], &mut found);
        if let Some(&index) = found.iter().find(|&&index| index >= 0.0) {
            return Err(LinalgError::NonFinite { place: SystemArray::Matrix, index: index as usize });
        }
        self.values.clear();
        self.values.extend_from_slice(values);
        // Rows without equations are of the size of the others.
        let scale = if scale > 0.0 { scale } else { 1.0 };
        self.values.extend(self.rows.padding.iter().map(|_| scale));
        system.set_values(&self.values).map_err(|message| failed("the values of PETSc's matrix", message))
    }

    /// The rows of this rank of a vector.
    fn own_rows(&self, vector: &[f64]) -> Vec<f64> {
        let mut rows = vec![0.0; self.rows.counts[self.mpi.rank()]];
        for &e in &self.rows.own {
            rows[self.rows.of_equation[e as usize] as usize - self.rows.first] = vector[e as usize];
        }
        rows
    }

    /// The whole of a vector whose rows this rank has.
    fn gather(&self, own: &[f64], whole: &mut [f64]) {
        let mut all = vec![0.0; self.rows.counts.iter().sum()];
        self.mpi.gather(own, &self.rows.counts, &mut all);
        whole.iter_mut().zip(&self.rows.of_equation).for_each(|(value, &row)| *value = all[row as usize]);
    }

    fn check_vectors(&self, rhs: &[f64], solution: &[f64]) -> Result<(), LinalgError> {
        let n = self.rows.of_equation.len();
        for (what, found) in [("right-hand side", rhs.len()), ("solution", solution.len())] {
            if found != n {
                return Err(LinalgError::Length { what, expected: n, found });
            }
        }
        match rhs.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(LinalgError::NonFinite { place: SystemArray::RightHandSide, index }),
            None => Ok(()),
        }
    }

    /// Solves by the iteration, with the preconditioner of these values; `None` if there is no iteration for the pattern, or it was refused.
    fn iterate(&mut self, values: &[f64], rhs: &[f64], tolerance: f64) -> Result<Option<Iterated>, LinalgError> {
        let options = self.method.iterative(self.kind, self.rows.of_equation.len(), self.rows.others);
        let Some(options) = options.filter(|_| self.refusal.is_none()) else { return Ok(None) };
        self.set_values(values)?;
        self.add_engine(ITERATIVE, &options)?;
        let b = self.own_rows(rhs);
        let (mut x, mut r) = (vec![0.0; b.len()], vec![0.0; b.len()]);
        let Some(system) = &mut self.system else { return Ok(None) };
        let backend = |message| failed(SOLUTION, message);
        self.statistics.set_ups += 1;
        if let Some(failure) = system.set_up(ITERATIVE).map_err(backend)? {
            let reason = format!("the set-up of PETSc's multigrid failed ({failure})");
            return Ok(Some(Iterated { x, refusal: Some(reason), is_indefinite: false }));
        }
        let ended = system.solve(ITERATIVE, Some(tolerance), &b, &mut x).map_err(backend)?;
        let quality = system.residual(&b, &x, &mut r).map_err(backend)?;
        self.statistics.iterations += ended.iterations;
        let good = ended.has_converged && quality.residual <= 10.0 * tolerance;
        self.statistics.iterative_solves += u64::from(good);
        let told = || {
            let (reason, count, residual) = (&ended.reason, ended.iterations, quality.residual);
            format!("PETSc's multigrid ended with {reason} after {count} iterations, relative residual {residual:.1e}")
        };
        Ok(Some(Iterated { x, refusal: (!good).then(told), is_indefinite: ended.is_indefinite }))
    }

    /// Options that PETSc has not asked for in a whole solution are misspelt, or do nothing.
    fn check_options(&mut self) -> Result<(), LinalgError> {
        if !matches!(self.method, Method::Options(_)) {
            return Ok(());
        }
        let unused = match self.unused.take() {
            Some(unused) => unused,
            None => {
                let prefix = self.prefix(DIRECT);
                let unused = ffi::unused_options(&prefix).map_err(|message| LinalgError::Settings { message })?;
                let own: Vec<String> = unused.iter().map(|name| format!("-{}", &name[prefix.len()..])).collect();
                // Some solvers are on a part of the ranks: unused is what no rank has asked for. A tolerance that was not written is no mistake.
                let all = self.communicator().gather_bytes(own.join(" ").as_bytes());
                let all: Vec<String> = all.iter().map(|of| String::from_utf8_lossy(of).into_owned()).collect();
                let on_all = |name: &String| all.iter().all(|of| of.split(' ').any(|other| other == name));
                own.into_iter().filter(|name| on_all(name) && self.method.names(name)).collect()
            }
        };
        let unused = self.unused.insert(unused);
        if unused.is_empty() {
            return Ok(());
        }
        let message = format!(
            "PETSc has no use for {}: correct the spelling, or remove it; what is not of the solver goes into the environment variable PETSC_OPTIONS",
            unused.join(", ")
        );
        Err(LinalgError::Settings { message })
    }

    /// Improves a solution with the factors until its residual is at round-off level or falls no more; returns what it is like then, and the steps.
    fn refine(&mut self, b: &[f64], x: &mut [f64]) -> Result<(Quality, u32), String> {
        let Some(system) = &mut self.system else { return Err("there is no matrix".to_owned()) };
        let mut r = vec![0.0; b.len()];
        let mut quality = system.residual(b, x, &mut r)?;
        let (mut change, mut better, mut left) = (r.clone(), x.to_vec(), r.clone());
        let mut steps = 0;
        while quality.backward_error > f64::EPSILON && steps < self.options.max_refinement_steps {
            if !system.solve(DIRECT, None, &r, &mut change)?.has_converged {
                break;
            }
            better.iter_mut().zip(x.iter().zip(&change)).for_each(|(new, (old, change))| *new = old + change);
            let new = system.residual(b, &better, &mut left)?;
            let gain = new.backward_error / quality.backward_error;
            steps += 1;
            if gain < 1.0 {
                x.copy_from_slice(&better);
                std::mem::swap(&mut r, &mut left);
                quality = new;
            }
            if exceeds(gain, 0.5) {
                break;
            }
        }
        Ok((quality, steps))
    }
}

/// What an iteration has found in the rows of this rank.
struct Iterated {
    x: Vec<f64>,
    /// Why it is not to be used.
    refusal: Option<String>,
    is_indefinite: bool,
}

/// Whether a value exceeds a limit; what is no number does.
fn exceeds(value: f64, limit: f64) -> bool {
    value.is_nan() || value > limit
}

fn failed(operation: &'static str, message: String) -> LinalgError {
    LinalgError::Backend { operation, message }
}

fn missing(called: &'static str, missing: &'static str) -> LinalgError {
    LinalgError::CallOrder { called, missing }
}

impl LinearSolver for PetscSolver {
    fn place(&mut self, equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) {
        self.places.clear();
        self.places.extend(equations);
        self.owners.clear();
    }

    fn spread(&mut self, owners: &mut dyn ExactSizeIterator<Item = u32>) {
        self.owners.clear();
        self.owners.extend(owners);
    }

    fn communicator(&self) -> Arc<dyn Communicator> {
        Arc::clone(&self.mpi) as Arc<dyn Communicator>
    }

    fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) -> Result<(), LinalgError> {
        let same = self.kind == kind
            && self.system.is_some()
            && self.pattern.as_ref().is_some_and(|old| Arc::ptr_eq(old, pattern) || **old == **pattern);
        // It may be the same on one rank and another on the next.
        if !self.ranks().any(!same) {
            return Ok(());
        }
        (self.system, self.factors, self.kind) = (None, None, kind);
        let n = pattern.n();
        if self.mpi.size() == 1 {
            self.owners.resize(n, 0);
        }
        for (what, found) in [("list of places", self.places.len()), ("list of owners", self.owners.len())] {
            if found != n {
                return Err(LinalgError::Length { what, expected: n, found });
            }
        }
        self.rows = Rows::new(&self.places, &self.owners, self.mpi.rank(), self.mpi.size())?;
        let count = pattern.nnz() + self.rows.padding.len();
        let (mut i, mut j): (Vec<i32>, Vec<i32>) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for column in 0..n {
            for &row in pattern.column(column) {
                i.push(self.rows.of_equation[row as usize]);
                j.push(self.rows.of_equation[column]);
            }
        }
        i.extend(&self.rows.padding);
        j.extend(&self.rows.padding);
        let (rows, block) = (self.rows.counts[self.mpi.rank()], if self.rows.others == 0 { 3 } else { 1 });
        let system = System::new(rows, block, (i, j), kind != MatrixKind::General, &self.rows.motions);
        self.system = Some(system.map_err(|message| failed("the pattern of PETSc's matrix", message))?);
        self.pattern = Some(Arc::clone(pattern));
        self.statistics.analyses += 1;
        Ok(())
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), LinalgError> {
        self.set_values(values)?;
        let options = self.method.direct(self.kind);
        self.add_engine(DIRECT, &options)?;
        self.statistics.factorisations += 1;
        self.statistics.symmetric += u64::from(self.kind != MatrixKind::General);
        let Some(system) = &mut self.system else { return Err(missing("factorise", "analyse")) };
        let operation = "the factorisation by PETSc";
        let backend = |message| failed(operation, message);
        match system.set_up(DIRECT).map_err(backend)? {
            None => {}
            Some(Failure::Singular) => return Err(LinalgError::Singular { row: None }),
            Some(failure) => return Err(failed(operation, failure.to_string())),
        }
        let (zero, negative) = system.pivots(DIRECT).map_err(backend)?;
        if zero > 0 {
            return Err(LinalgError::Singular { row: None });
        }
        self.factors = Some(negative);
        Ok(())
    }

    fn solve(&mut self, rhs: &[f64], solution: &mut [f64]) -> Result<SolveReport, LinalgError> {
        if self.factors.is_none() {
            return Err(missing("solve", "factorise"));
        }
        self.check_vectors(rhs, solution)?;
        let b = self.own_rows(rhs);
        let mut x = vec![0.0; b.len()];
        let Some(system) = &mut self.system else { return Err(missing("solve", "analyse")) };
        let backend = |message| failed(SOLUTION, message);
        let ended = system.solve(DIRECT, None, &b, &mut x).map_err(backend)?;
        let is_own_choice = matches!(self.method, Method::Options(_));
        let (quality, steps) = if is_own_choice {
            (system.residual(&b, &x, &mut vec![0.0; b.len()]).map_err(backend)?, 0)
        } else {
            self.refine(&b, &mut x).map_err(backend)?
        };
        self.check_options()?;
        self.statistics.solves += 1;
        self.statistics.refinement_steps += u64::from(steps);
        self.statistics.iterations += if is_own_choice { ended.iterations } else { 0 };
        let limit = self.options.acceptable_backward_error;
        if !is_own_choice && ended.has_converged && exceeds(quality.backward_error, limit) {
            let backward_error = quality.backward_error;
            return Err(LinalgError::NotConverged { backward_error, limit, refinement_steps: steps });
        }
        if !ended.has_converged || (is_own_choice && exceeds(quality.residual, ACCEPTED)) {
            let (reason, count, residual) = (&ended.reason, ended.iterations, quality.residual);
            let message = format!("{reason} after {count} iterations, relative residual {residual:.1e}");
            return Err(failed(SOLUTION, message));
        }
        self.gather(&x, solution);
        Ok(SolveReport { backward_error: quality.backward_error, refinement_steps: steps })
    }

    fn solve_nearby(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<Option<u32>, LinalgError> {
        self.check_vectors(rhs, solution)?;
        let before = self.statistics.iterations;
        let Some(found) = self.iterate(values, rhs, tolerance.min(TOLERANCE))? else { return Ok(None) };
        if let Some(reason) = found.refusal {
            self.statistics.handed_over += 1;
            self.refusal = Some((reason, false));
            return Ok(None);
        }
        self.gather(&found.x, solution);
        Ok(Some((self.statistics.iterations - before) as u32))
    }

    fn solve_definite(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, LinalgError> {
        self.check_vectors(rhs, solution)?;
        let Some(found) = self.iterate(values, rhs, tolerance.min(TOLERANCE))? else { return Ok(false) };
        if found.refusal.is_some() {
            return Ok(false);
        }
        self.gather(&found.x, solution);
        Ok(true)
    }

    /// Whether the matrix is definite, from a solution for a right-hand side with parts of all directions: `None` without an iteration, or if it ends for
    /// another reason.
    fn is_definite(&mut self, values: &[f64]) -> Option<bool> {
        let n = self.rows.of_equation.len();
        // Weyl's sequence: entries in [-1, 1) without a period.
        let rhs: Vec<f64> = (1..=n).map(|k| 2.0 * (k as f64 * std::f64::consts::SQRT_2).fract() - 1.0).collect();
        let found = self.iterate(values, &rhs, TOLERANCE).ok()??;
        if found.is_indefinite { Some(false) } else { found.refusal.is_none().then_some(true) }
    }

    fn take_reason(&mut self) -> Option<String> {
        match &mut self.refusal {
            Some((reason, told @ false)) => {
                *told = true;
                Some(reason.clone())
            }
            _ => None,
        }
    }

    fn negative_eigenvalues(&mut self) -> Option<usize> {
        self.factors.flatten()
    }

    fn forget(&mut self) {
        self.factors = None;
        self.refusal = None;
        // Its aggregates are those of values that are forgotten.
        if let Some(system) = &mut self.system {
            system.remake(ITERATIVE);
        }
    }

    fn memory_bytes(&self) -> usize {
        let lists = self.rows.of_equation.capacity() + self.rows.own.capacity() + self.owners.capacity();
        self.system.as_ref().map_or(0, System::memory_bytes)
            + 8 * (self.values.capacity() + self.rows.motions.capacity())
            + size_of::<EquationPlace>() * self.places.capacity()
            + 4 * lists
    }

    fn name(&self) -> &str {
        "petsc"
    }

    fn statistics(&self) -> SolverStatistics {
        self.statistics
    }
}
