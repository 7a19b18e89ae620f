//! Newton iteration, line search, convergence tests, stop reasons.
