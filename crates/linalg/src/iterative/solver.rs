//! The solver: one system after the other, with what of the last one still serves.

use super::bsr::Bsr;
use super::condense::Condensation;
use super::entries::Entries;
use super::hierarchy::{Hierarchy, OneLevel};
use super::inverse::inverse_diagonal;
use super::krylov::{Krylov, Operator, Report};
use super::layout::Layout;
use super::modes::rigid_modes;
use super::refusal::Refusal;
use super::saddle::{Border, Saddle};
use super::sums::norm;
use crate::refinement::{check_finite, check_length};
use crate::vector::pseudo_random;
use crate::{EquationPlace, LinalgError, MatrixKind, SolverStatistics, SparsityPattern, SystemArray};
use std::sync::Arc;

/// Largest relative residual that an inexact Newton method asks for.
const LARGEST_FORCING: f64 = 1e-2;

/// Factor of the forcing term (Eisenstat and Walker, choice 2).
const FORCING: f64 = 0.9;

/// A tolerance at most this many times smaller than the forcing term is met at once: a further iteration of Newton's method for the rest would cost more.
const NEAR_TOLERANCE: f64 = 10.0;

/// Share of the tolerance with multipliers, and not more than the next figure if the tolerance is not smaller itself: active sets and friction look at
/// iterates, and loose solutions double their number.
const SHARE_WITH_MULTIPLIERS: f64 = 1e-2;
const TOLERANCE_WITH_MULTIPLIERS: f64 = 1e-8;

/// Iterations after which a solution is given up.
const LIMIT: u32 = 150;

/// Two solutions in a row with more iterations than this, and a factorisation is taken to be faster.
const SLOW: u32 = 60;

/// Iterations that one level alone may take.
const LIMIT_OF_ONE_LEVEL: u32 = 15;

/// A translation of all nodes meets at least this part of the resistance of all nodes moved one by one, where mass dominates. (Consistent mass alone: 3.4; a block held on one side, without
/// mass: about the edge of an element over that of the block.)
const MASS_DOMINATED: f64 = 1.0;

/// A hierarchy is renewed if a solution takes more iterations than its first one would have taken to the same residual, times this, plus [`EXTRA`].
const GROWTH: f64 = 1.5;
const EXTRA: f64 = 3.0;

/// Relative residual of the solution that looks for a direction of negative curvature, as a part of what one of all directions has in a right-hand side that has the same of each: until the
/// iteration has met a direction whose curvature is small beside the others', its part of the residual stays.
const PROBE: f64 = 0.01;

/// The true residual may be this many times that of the recurrence.
const TRUE_RESIDUAL: f64 = 2.0;

#[derive(Debug)]
enum Preconditioner {
    OneLevel(Box<OneLevel<f32>>),
    Hierarchy(Box<Hierarchy<f32>>),
}

impl Preconditioner {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        match self {
            Self::OneLevel(level) => level.apply(r, z),
            Self::Hierarchy(hierarchy) => hierarchy.apply(r, z),
        }
    }

    fn is_indefinite(&self) -> bool {
        matches!(self, Self::Hierarchy(hierarchy) if hierarchy.is_indefinite())
    }
}

/// Matrix and preconditioner.
struct Preconditioned<'a> {
    k: &'a Bsr<f64, 3, 3>,
    border: &'a Border,
    saddle: &'a mut Saddle,
    condensation: &'a mut Option<Condensation>,
    preconditioner: &'a mut Preconditioner,
}

impl Operator for Preconditioned<'_> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        let n = 3 * self.k.rows();
        self.k.multiply(&x[..n], &mut y[..n]);
        if self.border.len() > 0 {
            self.border.add_products(&self.saddle.scale, x, y);
        }
    }

    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        let Self { k, border, saddle, condensation, preconditioner } = self;
        let cycle = |r: &[f64], z: &mut [f64]| preconditioner.apply(r, z);
        match condensation {
            _ if border.len() == 0 => preconditioner.apply(r, z),
            Some(condensation) => condensation.apply(k, &saddle.scale, cycle, r, z),
            None => saddle.apply(border, cycle, r, z),
        }
    }
}

/// What is known of a symmetric matrix and asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// The sign of its eigenvalues does not matter.
    Any,
    /// A matrix that has a negative eigenvalue, as far as can be seen, is not solved.
    Positive,
}

/// Solutions by iteration.
#[derive(Debug, Default)]
pub(crate) struct IterativeSolver {
    layout: Layout,
    pattern: Option<Arc<SparsityPattern>>,
    kind: MatrixKind,
    k: Bsr<f64, 3, 3>,
    entries: Entries,
    border: Border,
    /// Slave nodes of other equations.
    slaves: Vec<u32>,
    saddle: Saddle,
    condensation: Option<Condensation>,
    preconditioner: Option<Preconditioner>,
    /// Iterations and residual of the first solution with this preconditioner.
    first: Option<(u32, f64)>,
    /// Whether the preconditioner has become too old.
    is_stale: bool,
    renews: bool,
    /// Whether a direction of negative curvature was met since the preconditioner was made.
    is_indefinite: bool,
    /// Whether the last solution took many iterations.
    was_slow: bool,
    last_rhs: Option<f64>,
    /// Since [`IterativeSolver::forget`].
    refused: bool,
    reason: Option<Refusal>,
    krylov: Krylov,
    b: Vec<f64>,
    x: Vec<f64>,
    statistics: SolverStatistics,
}

impl IterativeSolver {
    /// Places of the equations of the next pattern.
    pub fn place(&mut self, equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) {
        if self.layout.set(equations) {
            self.pattern = None;
        }
    }

    /// Whether a preconditioner serves for one system only.
    pub fn renew_always(&mut self, always: bool) {
        self.renews = always;
    }

    /// Number of equations that have places, and of those among them that are of no node.
    pub fn placed(&self) -> (usize, usize) {
        (self.layout.place.len(), self.layout.slots.len())
    }

    /// The pattern of the next systems.
    pub fn analyse(&mut self, pattern: &Arc<SparsityPattern>, kind: MatrixKind) {
        let same = |known: &Arc<SparsityPattern>| Arc::ptr_eq(known, pattern) || known == pattern;
        if kind == self.kind && self.pattern.as_ref().is_some_and(same) {
            return;
        }
        self.statistics.analyses += 1;
        self.preconditioner = None;
        self.k = self.layout.block_pattern(pattern);
        self.entries = Entries::new(&self.layout, pattern, &self.k, kind != MatrixKind::General);
        self.slaves = self.layout.slaves(pattern);
        self.kind = kind;
        self.pattern = Some(Arc::clone(pattern));
    }

    /// Solves `A x = b` to a forcing term of at least `tolerance`; `None` if it does not come to that. Returns the number of iterations.
    ///
    /// # Errors
    /// The errors of [`crate::LinearSolver::solve_nearby`].
    pub fn solve(
        &mut self,
        values: &[f64],
        rhs: &[f64],
        solution: &mut [f64],
        tolerance: f64,
        curvature: Curvature,
    ) -> Result<Option<u32>, LinalgError> {
        let Some(pattern) = self.pattern.clone().filter(|_| !self.refused) else { return Ok(None) };
        check_length("values", pattern.nnz(), values)?;
        check_length("right-hand side", pattern.n(), rhs)?;
        check_length("solution", pattern.n(), solution)?;
        check_finite(SystemArray::Matrix, values)?;
        check_finite(SystemArray::RightHandSide, rhs)?;
        self.entries.set(&self.layout, &pattern, values, &mut self.k, &mut self.border);
        match self.run(rhs, tolerance, curvature) {
            Ok(Some(iterations)) => {
                self.layout.scatter(&self.x, solution);
                check_finite(SystemArray::Solution, solution)?;
                Ok(Some(iterations))
            }
            Ok(None) => Ok(None),
            Err(refusal) => {
                self.refused = true;
                self.preconditioner = None;
                self.statistics.handed_over += 1;
                self.reason = Some(refusal);
                Ok(None)
            }
        }
    }

    fn run(&mut self, rhs: &[f64], tolerance: f64, curvature: Curvature) -> Result<Option<u32>, Refusal> {
        if self.border.len() > 0 {
            self.set_multipliers()?;
        }
        self.layout.gather(rhs, &mut self.b);
        if self.border.len() > 0 {
            let n = 3 * self.k.rows();
            self.b[n..].iter_mut().zip(&self.saddle.scale).for_each(|(b, scale)| *b *= scale);
        }
        self.x.clear();
        self.x.resize(self.b.len(), 0.0);
        let size = norm(&self.b);
        if size == 0.0 {
            return Ok(Some(0));
        }
        let tolerance = self.forcing(size, tolerance);
        let is_fresh = self.preconditioner.is_none() || self.is_stale || self.renews;
        if is_fresh {
            self.set_up(true)?;
            if curvature == Curvature::Positive {
                self.probe();
            }
        }
        if curvature == Curvature::Positive && self.is_indefinite {
            return Ok(None);
        }
        let mut report = self.iterate(tolerance, curvature);
        let mut total = report.iterations;
        let one_level = matches!(self.preconditioner, Some(Preconditioner::OneLevel(_)));
        let negative = |report: &Report| curvature == Curvature::Positive && report.negative;
        if !report.reached(TRUE_RESIDUAL * tolerance) && !negative(&report) && (!is_fresh || one_level) {
            self.set_up(false)?;
            report = self.iterate(tolerance, curvature);
            total += report.iterations;
        }
        self.statistics.iterations += u64::from(total);
        if negative(&report) {
            self.is_indefinite = true;
            return Ok(None);
        }
        if !report.reached(TRUE_RESIDUAL * tolerance) {
            return Err(refusal(report));
        }
        self.judge_age(report);
        if report.iterations > SLOW && std::mem::replace(&mut self.was_slow, true) {
            return Err(Refusal::Slow { iterations: report.iterations });
        }
        self.was_slow = report.iterations > SLOW;
        self.statistics.iterative_solves += 1;
        Ok(Some(total))
    }

    /// What is done with the multipliers. A hierarchy of other motions is too old.
    fn set_multipliers(&mut self) -> Result<(), Refusal> {
        let Self { k, border, saddle, slaves, .. } = self;
        let (inverse, slots) = (inverse_diagonal(k), &self.layout.slots);
        saddle.set_weights(border, &inverse, slots);
        let before =
            std::mem::replace(&mut self.condensation, Condensation::new(k, border, slots, slaves, &saddle.sizes));
        let takes = |of: &Option<Condensation>| of.as_ref().map(|of| of.takes().collect::<Vec<_>>());
        self.is_stale |= takes(&before) != takes(&self.condensation);
        if self.condensation.is_none() {
            saddle.factorise(border, &inverse, slots)?;
        }
        Ok(())
    }

    /// Whether the symmetric matrix with these values has no direction of negative curvature, as far as an iteration can tell; `None` if it has no preconditioner.
    pub fn is_definite(&mut self, values: &[f64]) -> Option<bool> {
        let pattern = self.pattern.clone().filter(|pattern| !self.refused && pattern.nnz() == values.len())?;
        self.preconditioner.as_ref()?;
        self.entries.set(&self.layout, &pattern, values, &mut self.k, &mut self.border);
        if self.border.len() > 0 {
            return None;
        }
        self.probe();
        Some(!self.is_indefinite)
    }

    /// Solves for a right-hand side that has a part of everything. (That of a straight column under its load has none of the motion in which it buckles.)
    fn probe(&mut self) {
        if self.border.len() > 0 || self.kind == MatrixKind::General {
            return;
        }
        let rhs = std::mem::take(&mut self.b);
        self.b.resize(self.layout.len(), 0.0);
        for &place in &self.layout.place {
            self.b[place as usize] = pseudo_random(place as usize);
        }
        let tolerance = PROBE / (self.b.len() as f64).sqrt();
        // Where a structure is about to buckle the soft motions come first, and the direction that is looked for last.
        self.krylov.set_patient(true);
        let report = self.iterate(tolerance, Curvature::Positive);
        self.krylov.set_patient(false);
        self.statistics.iterations += u64::from(report.iterations);
        self.is_indefinite |= report.negative;
        self.b = rhs;
        self.x.fill(0.0);
    }

    /// The relative residual to solve to.
    fn forcing(&mut self, size: f64, tolerance: f64) -> f64 {
        if self.border.len() > 0 {
            return (SHARE_WITH_MULTIPLIERS * tolerance).max(tolerance.min(TOLERANCE_WITH_MULTIPLIERS));
        }
        let ratio = self.last_rhs.replace(size).map_or(1.0, |last| size / last);
        let forcing = (FORCING * ratio * ratio).min(LARGEST_FORCING);
        if forcing > NEAR_TOLERANCE * tolerance { forcing } else { tolerance }
    }

    fn set_up(&mut self, may_be_one_level: bool) -> Result<(), Refusal> {
        self.statistics.set_ups += 1;
        (self.first, self.is_stale, self.is_indefinite, self.preconditioner) = (None, false, false, None);
        let Layout { positions, free, labels, .. } = &self.layout;
        let k = &self.k;
        self.preconditioner = Some(if may_be_one_level && self.border.len() == 0 && is_mass_dominated(k) {
            Preconditioner::OneLevel(Box::new(OneLevel::new(k)))
        } else {
            let mut modes = rigid_modes(positions, free);
            let general = MatrixKind::General;
            let hierarchy = match &self.condensation {
                _ if self.border.len() == 0 => Hierarchy::new(k, &modes, labels, self.kind),
                Some(condensation) => {
                    condensation.restrict(&mut modes);
                    Hierarchy::new(&condensation.matrix(k, &self.border), &modes, labels, general)
                }
                None => Hierarchy::new(&self.saddle.augmented(k, &self.border), &modes, labels, general),
            };
            Preconditioner::Hierarchy(Box::new(hierarchy?))
        });
        Ok(())
    }

    fn iterate(&mut self, tolerance: f64, curvature: Curvature) -> Report {
        let Self { k, border, saddle, condensation, preconditioner, krylov, b, x, kind, .. } = self;
        let Some(preconditioner) = preconditioner else {
            return Report { iterations: 0, residual: f64::INFINITY, negative: false, slow: false };
        };
        let is_symmetric = *kind != MatrixKind::General && border.len() == 0;
        let mut limit = if matches!(preconditioner, Preconditioner::OneLevel(_)) { LIMIT_OF_ONE_LEVEL } else { LIMIT };
        let mut is_indefinite = preconditioner.is_indefinite();
        let mut system = Preconditioned { k, border, saddle, condensation, preconditioner };
        let mut used = 0;
        if is_symmetric && !is_indefinite {
            let report = krylov.conjugate_gradients(&mut system, b, x, tolerance, limit);
            if (report.reached(TRUE_RESIDUAL * tolerance) || report.slow) && !report.negative {
                return report;
            }
            (used, is_indefinite) = (report.iterations, report.negative);
            limit -= used.min(limit);
        }
        if is_indefinite && curvature == Curvature::Positive {
            return Report { iterations: used, residual: f64::INFINITY, negative: true, slow: false };
        }
        let mut report = krylov.fgmres(&mut system, b, x, tolerance, limit, used == 0);
        report.iterations += used;
        report
    }

    /// Notes whether the preconditioner is too old for the next solution.
    fn judge_age(&mut self, report: Report) {
        let Report { iterations, residual, .. } = report;
        match self.first {
            None => self.first = Some((iterations, residual)),
            Some((first, reached)) => {
                let expected = f64::from(first) * (residual.ln() / reached.ln()).max(1.0);
                self.is_stale = f64::from(iterations) > GROWTH * expected + EXTRA;
            }
        }
    }

    /// Drops what was made from earlier values.
    pub fn forget(&mut self) {
        (self.preconditioner, self.condensation) = (None, None);
        (self.first, self.last_rhs) = (None, None);
        (self.is_stale, self.is_indefinite, self.was_slow, self.refused) = (false, false, false, false);
    }

    /// Whether nothing is solved until [`IterativeSolver::forget`].
    pub fn has_refused(&self) -> bool {
        self.refused
    }

    /// Why, if nobody asked yet.
    pub fn take_reason(&mut self) -> Option<String> {
        self.reason.take().map(|reason| reason.to_string())
    }

    pub fn statistics(&self) -> SolverStatistics {
        self.statistics
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let preconditioner = match &self.preconditioner {
            None => 0,
            Some(Preconditioner::OneLevel(level)) => level.memory_bytes(),
            Some(Preconditioner::Hierarchy(hierarchy)) => hierarchy.memory_bytes(),
        };
        preconditioner
            + self.k.memory_bytes()
            + self.entries.memory_bytes()
            + self.border.memory_bytes()
            + self.saddle.memory_bytes()
            + self.condensation.as_ref().map_or(0, Condensation::memory_bytes)
            + self.krylov.memory_bytes()
            + 2 * size_of::<f64>() * self.b.capacity()
    }
}

/// Why a solution that did not end did not.
fn refusal(report: Report) -> Refusal {
    let Report { iterations, residual, slow, .. } = report;
    if slow { Refusal::Foreseen { iterations, limit: LIMIT } } else { Refusal::NotConverged { iterations, residual } }
}

/// Whether the resistance to a translation of all nodes is large against that of all nodes one by one.
fn is_mass_dominated(k: &Bsr<f64, 3, 3>) -> bool {
    let (mut all, mut one) = ([0.0; 3], [0.0; 3]);
    for i in 0..k.rows() {
        for (j, block) in k.row(i) {
            for d in 0..3 {
                all[d] += block[d][d];
                one[d] += if i == j { block[d][d] } else { 0.0 };
            }
        }
    }
    (0..3).all(|d| all[d] >= MASS_DOMINATED * one[d])
}
