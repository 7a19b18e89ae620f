//! The factorisations of the library faer, the only place where it appears. Sparse LU (column ordering COLAMD, full partial
//! pivoting) and sparse Cholesky (AMD), dense LU for tiny systems, the dense kernels of [`crate::multifrontal`], all sequential. Not the policy around a factorisation:
//! that is [`crate::DirectSolver`].

mod dense;
mod front;
mod sparse;

pub use dense::DenseLu;
pub(crate) use front::{FrontWork, factorise_ldl_front, factorise_lu_front, negative_pivots};
pub use sparse::FaerSparse;

use crate::{DirectSolver, LinalgError};
use faer::dyn_stack::{MemBuffer, StackReq};

/// Sparse direct solver of faer: LU, or Cholesky for a matrix that is positive definite.
pub type FaerSolver = DirectSolver<FaerSparse>;

/// Dense LU with partial pivoting of the whole matrix, for systems so small that sparsity is a burden.
pub type DenseSolver = DirectSolver<DenseLu>;

/// Scratch memory that is kept between calls.
#[derive(Default)]
struct Scratch {
    buffer: Option<MemBuffer>,
    bytes: usize,
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Scratch({} bytes)", self.bytes)
    }
}

impl Scratch {
    fn new(requirement: StackReq) -> Result<Self, LinalgError> {
        let buffer = MemBuffer::try_new(requirement).map_err(|e| backend("allocation", e))?;
        Ok(Self { buffer: Some(buffer), bytes: requirement.unaligned_bytes_required() })
    }

    fn stack(&mut self) -> &mut faer::dyn_stack::MemStack {
        // An empty stack only before the analysis, and then nobody asks.
        let buffer = (self.buffer).get_or_insert_with(|| MemBuffer::new(StackReq::EMPTY));
        faer::dyn_stack::MemStack::new(buffer)
    }
}

fn backend(operation: &'static str, error: impl std::fmt::Debug) -> LinalgError {
    LinalgError::Backend { operation, message: format!("{error:?}") }
}
