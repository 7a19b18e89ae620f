//! Sparse LU and Cholesky.

use super::{Scratch, backend};
use crate::direct::Factorisation;
use crate::{LinalgError, MatrixKind, SparsityPattern};
use faer::dyn_stack::StackReq;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu, simplicial, supernodal,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Always by blocks: with three equations a node the columns come in groups, and faer's automatic choice of the scalar
/// algorithm below about 300 equations was measured to be several times slower.
const SUPERNODAL: SupernodalThreshold = SupernodalThreshold::FORCE_SUPERNODAL;

/// LU for [`MatrixKind::General`] and [`MatrixKind::Symmetric`] (faer's LDL' stops at a zero diagonal block and its
/// LBL' returns NaN there); Cholesky for [`MatrixKind::SymmetricPositiveDefinite`], with LU instead of it for values that are
/// not.
#[derive(Debug, Default)]
pub struct FaerSparse {
    /// Rows of the pattern, in faer's width.
    rows: Vec<usize>,
    lu: Option<Lu>,
    cholesky: Option<Cholesky>,
    /// Whether the last factorisation is the Cholesky one.
    positive: bool,
    fallbacks: u64,
}

impl Factorisation for FaerSparse {
    fn name(&self) -> &'static str {
        "faer"
    }

    fn analyse(&mut self, pattern: &SparsityPattern, kind: MatrixKind) -> Result<(), LinalgError> {
        (self.lu, self.cholesky) = (None, None);
        self.rows = pattern.row_indices().iter().map(|&row| row as usize).collect();
        if kind == MatrixKind::SymmetricPositiveDefinite {
            self.cholesky = Some(Cholesky::new(symbolic(pattern, &self.rows))?);
        } else {
            self.lu = Some(Lu::new(symbolic(pattern, &self.rows))?);
        }
        Ok(())
    }

    fn factorise(&mut self, pattern: &SparsityPattern, values: &[f64]) -> Result<(), LinalgError> {
        let matrix = SparseColMatRef::new(symbolic(pattern, &self.rows), values);
        if let Some(cholesky) = &mut self.cholesky {
            self.positive = cholesky.factorise(matrix);
            if self.positive {
                return Ok(());
            }
            self.fallbacks += 1;
        }
        if self.lu.is_none() {
            self.lu = Some(Lu::new(symbolic(pattern, &self.rows))?);
        }
        self.positive = false;
        match &mut self.lu {
            Some(lu) => lu.factorise(matrix),
            None => unreachable!("set above"),
        }
    }

    fn solve_in_place(&mut self, v: &mut [f64]) {
        match (&mut self.cholesky, &mut self.lu) {
            (Some(cholesky), _) if self.positive => cholesky.solve_in_place(v),
            (_, Some(lu)) => lu.solve_in_place(v),
            _ => debug_assert!(false, "solve before factorise"),
        }
    }

    fn memory_bytes(&self) -> usize {
        size_of::<usize>() * self.rows.capacity()
            + self.lu.as_ref().map_or(0, Lu::memory_bytes)
            + self.cholesky.as_ref().map_or(0, Cholesky::memory_bytes)
    }

    fn indefinite_fallbacks(&self) -> u64 {
        self.fallbacks
    }
}

fn symbolic<'a>(pattern: &'a SparsityPattern, rows: &'a [usize]) -> SymbolicSparseColMatRef<'a, usize> {
    let n = pattern.n();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_pointers(), None, rows)
}

#[derive(Debug)]
struct Lu {
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    factor: Scratch,
    solve: Scratch,
    /// Entries of the matrix, for the estimate of memory.
    nnz: usize,
}

impl Lu {
    fn new(pattern: SymbolicSparseColMatRef<'_, usize>) -> Result<Self, LinalgError> {
        let params = LuSymbolicParams { supernodal_flop_ratio_threshold: SUPERNODAL, ..Default::default() };
        let symbolic = factorize_symbolic_lu(pattern, params).map_err(|e| backend("symbolic LU", e))?;
        let factor = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
        // `SymbolicLu::solve_in_place_scratch` of faer 0.24.4 calls itself without end.
        let n = pattern.nrows();
        let solve = StackReq::any_of(&[
            supernodal::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
            simplicial::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
        ]);
        Ok(Self {
            factor: Scratch::new(factor)?,
            solve: Scratch::new(solve)?,
            symbolic,
            numeric: NumericLu::new(),
            nnz: pattern.row_idx().len(),
        })
    }

    fn factorise(&mut self, matrix: SparseColMatRef<'_, usize, f64>) -> Result<(), LinalgError> {
        let result = self.symbolic.factorize_numeric_lu(
            &mut self.numeric,
            matrix,
            Par::Seq,
            self.factor.stack(),
            Default::default(),
        );
        match result {
            Ok(_) => Ok(()),
            Err(faer::sparse::linalg::LuError::SymbolicSingular { index }) => {
                let (columns, _) = self.symbolic.col_perm().arrays();
                Err(LinalgError::Singular { row: columns.get(index).copied() })
            }
            Err(e) => Err(backend("LU", e)),
        }
    }

    fn solve_in_place(&mut self, v: &mut [f64]) {
        let n = v.len();
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(v, n, 1),
            Par::Seq,
            self.solve.stack(),
        );
    }

    /// The factors are private to faer; ten times the matrix is typical of contact problems of some thousand unknowns.
    fn memory_bytes(&self) -> usize {
        self.factor.bytes + self.solve.bytes + 160 * self.nnz
    }
}

#[derive(Debug)]
struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    factor: Scratch,
    solve: Scratch,
}

impl Cholesky {
    fn new(pattern: SymbolicSparseColMatRef<'_, usize>) -> Result<Self, LinalgError> {
        let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold: SUPERNODAL, ..Default::default() };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, params)
            .map_err(|e| backend("symbolic Cholesky factorisation", e))?;
        let factor = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Ok(Self {
            values: vec![0.0; symbolic.len_val()],
            factor: Scratch::new(factor)?,
            solve: Scratch::new(solve)?,
            symbolic,
        })
    }

    /// False if the matrix is not positive definite.
    fn factorise(&mut self, matrix: SparseColMatRef<'_, usize, f64>) -> bool {
        let result = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix,
            Side::Lower,
            Default::default(),
            Par::Seq,
            self.factor.stack(),
            Default::default(),
        );
        // The only error is a pivot that is not positive.
        result.is_ok()
    }

    fn solve_in_place(&mut self, v: &mut [f64]) {
        let n = v.len();
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(v, n, 1),
            Par::Seq,
            self.solve.stack(),
        );
    }

    fn memory_bytes(&self) -> usize {
        self.factor.bytes + self.solve.bytes + size_of::<f64>() * self.values.capacity()
    }
}
