//! Multifrontal factorisation of matrices with a symmetric pattern: LU of unsymmetric values, `L D L^T` of symmetric ones.
//!
//! The equations are ordered by nested dissection of the graph of *groups* (the components of a node and the multipliers of which it is the
//! slave, see [`crate::SparsityPattern::with_groups`]); a zero block on the diagonal is harmless as long as a multiplier comes after the displacements that
//! it constrains. Pivots are chosen inside a front only, so that storage and order are fixed beforehand. If that does not give a
//! usable factorisation (no pivot in a front, refinement that does not converge) the matrix is factorised again by faer's LU with partial
//! pivoting over whole columns, which is slow and safe.
//!
//! | file | what |
//! |---|---|
//! | `groups` | groups of equations, their graph |
//! | `ordering` | nested dissection; the only place of the ordering library |
//! | `tree` | elimination tree, merging, rows of the fronts |
//! | `symbolic` | places of everything in storage |
//! | `numeric` | assembly and elimination of the fronts, tasks |
//! | `solve` | substitution |
//!
//! The dense kernels are in [`crate::faer_backend`]. Duff and Reid, *The multifrontal solution of indefinite sparse symmetric linear equations*,
//! ACM Trans. Math. Softw. 9 (1983); Liu, *The multifrontal method for sparse matrix solution*, SIAM Review 34 (1992).

mod groups;
mod numeric;
mod ordering;
mod solve;
mod symbolic;
mod tree;

use crate::direct::Factorisation;
use crate::faer_backend::FaerSparse;
use crate::{DirectSolver, LinalgError, MatrixKind, SparsityPattern};
use groups::KnownGroups;
use numeric::{NoPivot, Numeric};
use symbolic::Symbolic;

/// Multifrontal direct solver with fallback to full pivoting.
pub type MultifrontalSolver = DirectSolver<Multifrontal>;

/// Operations of a factorisation that take as long as the substitutions take for an entry of the factors: they wait for memory. (Measured on one
/// matrix, a tangent of `scenes/tori-friction-03.toml`, on two shared cores of an AMD EPYC, Zen 3; it decides on time, never on the answer.)
const OPERATIONS_PER_ENTRY: f64 = 20.0;

/// The factorisation.
#[derive(Debug, Default)]
pub struct Multifrontal {
    kind: MatrixKind,
    known: KnownGroups,
    symbolic: Option<Symbolic>,
    /// Outlives the analysis: the storage of a new one is mostly that of the last.
    numeric: Numeric,
    /// The last ordering and the graph that it belongs to: multipliers that come and go inside their groups leave it as it is.
    ordered: Option<(ordering::Graph, Vec<u32>)>,
    vectors: solve::Vectors,
    /// Factorisation in use instead of the multifrontal factors if `fallen_back`.
    fallback: Option<FaerSparse>,
    fallen_back: bool,
    fallbacks: u64,
}

impl Multifrontal {
    /// Order and storage.
    fn analyse_groups(&mut self, pattern: &SparsityPattern) -> Result<(), LinalgError> {
        self.symbolic = None;
        let groups = self.known.groups();
        let graph = groups.graph(pattern);
        // A function of the graph alone: what was ordered before must not show in the bits.
        let order = match self.ordered.take() {
            Some((known, order)) if known == graph => order,
            _ => ordering::nested_dissection(&graph)?,
        };
        let weights: Vec<usize> = (0..groups.len()).map(|g| groups.members(g).len()).collect();
        let nodes = tree::fronts(&graph, &weights, &order);
        self.ordered = Some((graph, order));
        let symbolic = Symbolic::new(pattern, &groups, &nodes, self.kind != MatrixKind::General)?;
        self.numeric.fit(&symbolic);
        self.symbolic = Some(symbolic);
        Ok(())
    }

    /// Floating-point operations of a factorisation with the present analysis, and entries of its factors.
    pub fn effort(&self) -> (f64, usize) {
        self.symbolic.as_ref().map_or((0.0, 0), |symbolic| (symbolic.operations, symbolic.factor_len()))
    }
}

impl Factorisation for Multifrontal {
    fn name(&self) -> &'static str {
        "multifrontal"
    }

    fn analyse(&mut self, pattern: &SparsityPattern, kind: MatrixKind) -> Result<(), LinalgError> {
        self.kind = kind;
        self.symbolic = None;
        (self.fallback, self.fallen_back) = (None, false);
        self.known = KnownGroups::new(pattern);
        // Otherwise the values decide.
        if self.known.complete() { self.analyse_groups(pattern) } else { Ok(()) }
    }

    fn factorise(&mut self, pattern: &SparsityPattern, values: &[f64]) -> Result<(), LinalgError> {
        self.fallen_back = false;
        if self.known.attach(pattern, values) || self.symbolic.is_none() {
            self.analyse_groups(pattern)?;
        }
        let Some(symbolic) = &self.symbolic else {
            return Err(LinalgError::CallOrder { called: "factorise", missing: "analyse" });
        };
        match self.numeric.factorise(symbolic, values)? {
            Ok(()) => {
                // It is seldom needed twice, and large.
                self.fallback = None;
                Ok(())
            }
            Err(NoPivot) => self.fall_back(pattern, values).map(|_| ()),
        }
    }

    fn fall_back(&mut self, pattern: &SparsityPattern, values: &[f64]) -> Result<bool, LinalgError> {
        if self.fallen_back {
            return Ok(false);
        }
        self.fallbacks += 1;
        if self.fallback.is_none() {
            let mut safe = FaerSparse::default();
            safe.analyse(pattern, MatrixKind::General)?;
            self.fallback = Some(safe);
        }
        if let Some(safe) = &mut self.fallback {
            safe.factorise(pattern, values)?;
        }
        self.fallen_back = true;
        Ok(true)
    }

    fn solve_in_place(&mut self, v: &mut [f64]) {
        match (&mut self.fallback, &self.symbolic) {
            (Some(safe), _) if self.fallen_back => safe.solve_in_place(v),
            (_, Some(symbolic)) => solve::solve(symbolic, &self.numeric, &mut self.vectors, v),
            _ => debug_assert!(false, "solve before factorise"),
        }
    }

    fn negative_eigenvalues(&mut self, _: &SparsityPattern, _: &[f64]) -> Option<usize> {
        let symbolic = self.symbolic.as_ref().filter(|symbolic| symbolic.symmetric && !self.fallen_back)?;
        Some(self.numeric.negative_pivots(symbolic))
    }

    fn applications_per_factorisation(&self) -> u32 {
        let (operations, entries) = self.effort();
        if self.fallen_back || entries == 0 { 0 } else { (operations / (OPERATIONS_PER_ENTRY * entries as f64)) as u32 }
    }

    fn symmetric_scaling(&self) -> bool {
        self.kind != MatrixKind::General
    }

    fn memory_bytes(&self) -> usize {
        self.symbolic.as_ref().map_or(0, Symbolic::memory_bytes)
            + self.numeric.memory_bytes()
            + self.known.memory_bytes()
            + self.vectors.memory_bytes()
            + self.fallback.as_ref().map_or(0, FaerSparse::memory_bytes)
    }

    fn pivoting_fallbacks(&self) -> u64 {
        self.fallbacks
    }
}
