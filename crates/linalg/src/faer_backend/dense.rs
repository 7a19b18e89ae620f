//! Dense LU of a sparse matrix.

use super::{FrontWork, Scratch, factorise_ldl_front, negative_pivots};
use crate::direct::Factorisation;
use crate::{LinalgError, MatrixKind, SparsityPattern};
use faer::dyn_stack::StackReq;
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par};

/// LU with partial pivoting, whatever the kind.
#[derive(Debug, Default)]
pub struct DenseLu {
    /// Factors by columns.
    factors: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    scratch: Scratch,
}

impl Factorisation for DenseLu {
    fn name(&self) -> &'static str {
        "dense LU"
    }

    fn analyse(&mut self, pattern: &SparsityPattern, _: MatrixKind) -> Result<(), LinalgError> {
        let n = pattern.n();
        self.factors = vec![0.0; n * n];
        self.forward = vec![0; n];
        self.inverse = vec![0; n];
        self.scratch = Scratch::new(StackReq::any_of(&[
            factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()),
            solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
        ]))?;
        Ok(())
    }

    fn factorise(&mut self, pattern: &SparsityPattern, values: &[f64]) -> Result<(), LinalgError> {
        let n = pattern.n();
        self.factors.fill(0.0);
        for j in 0..n {
            for k in pattern.column_range(j) {
                self.factors[pattern.row_indices()[k] as usize + n * j] = values[k];
            }
        }
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.factors, n, n),
            &mut self.forward,
            &mut self.inverse,
            Par::Seq,
            self.scratch.stack(),
            Default::default(),
        );
        let zero_pivot = (0..n).find(|&i| self.factors[i + n * i] == 0.0);
        zero_pivot.map_or(Ok(()), |i| Err(LinalgError::Singular { row: Some(i) }))
    }

    fn solve_in_place(&mut self, v: &mut [f64]) {
        let n = v.len();
        let factors = MatRef::from_column_major_slice(&self.factors, n, n);
        solve::solve_in_place(
            factors,
            factors,
            PermRef::new_checked(&self.forward, &self.inverse, n),
            MatMut::from_column_major_slice_mut(v, n, 1),
            Par::Seq,
            self.scratch.stack(),
        );
    }

    fn negative_eigenvalues(&mut self, pattern: &SparsityPattern, values: &[f64]) -> Option<usize> {
        // The whole matrix as a front.
        let n = pattern.n();
        let mut matrix = vec![0.0; n * n];
        for j in 0..n {
            for k in pattern.column_range(j) {
                matrix[pattern.row_indices()[k] as usize + n * j] = values[k];
            }
        }
        let (mut pivots, mut subdiagonal) = (vec![0; n], vec![0.0; n]);
        let mut work = FrontWork::new(n, true).ok()?;
        let done =
            factorise_ldl_front(n, 0, &mut matrix, &mut [], &mut pivots, &mut subdiagonal, &mut [], &mut work, false);
        done.then(|| negative_pivots(&matrix, n, &subdiagonal))
    }

    fn memory_bytes(&self) -> usize {
        let n = self.forward.len();
        n * n * size_of::<f64>() + 2 * n * size_of::<usize>() + self.scratch.bytes
    }
}
