//! Solutions by iteration: conjugate gradients or GMRES, preconditioned by smoothed aggregation, with multipliers by a block triangle.
//!
//! Vanek, Mandel and Brezina, *Algebraic multigrid by smoothed aggregation for second and fourth order elliptic problems*, Computing 56 (1996); Adams, Brezina, Hu and
//! Tuminaro, *Parallel multigrid smoothing: polynomial versus Gauss-Seidel*, J. Comput. Phys. 188 (2003). What is chosen here and why: theory/linear-solvers#iteration.
//!
//! | file | what |
//! |---|---|
//! | `layout`, `entries` | nodes of the equations, blocks of the matrix, where their values are |
//! | `bsr` | matrices of blocks, products |
//! | `aggregates`, `modes` | which nodes are put together, rigid modes, prolongation |
//! | `smoother`, `waves`, `hierarchy` | Chebyshev's polynomials, passes over a matrix, levels, the cycle |
//! | `condense` | multipliers that take a motion from a slave node |
//! | `saddle` | multipliers: scales, augmentation, Schur complement |
//! | `krylov` | the iterations |
//! | `solver` | tolerances, what is kept, what is refused |
//!
//! **Same bits.** Rows of products are sums in the order of the pattern, each by one thread; sums of vectors are those of `sums`; everything else is sequential.

mod aggregates;
mod bsr;
mod condense;
mod entries;
mod hierarchy;
mod inverse;
mod krylov;
mod layout;
mod modes;
mod real;
mod refusal;
mod saddle;
mod smoother;
mod solver;
mod sums;
#[cfg(test)]
mod tests;
mod waves;

pub(crate) use solver::{Curvature, IterativeSolver};
