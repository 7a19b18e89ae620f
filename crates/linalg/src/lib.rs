//! Fixed sparsity patterns, deterministic scatter, the trait of a linear solver, faer backends, refinement.
