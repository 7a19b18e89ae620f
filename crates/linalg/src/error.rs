//! The crate's error type.

/// Array of a linear system in which a value that is not finite was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SystemArray {
    /// An entry of the matrix; the index is the position in the list of values.
    Matrix,
    /// An entry of the right-hand side; the index is the equation.
    RightHandSide,
    /// An entry of the solution; the index is the equation.
    Solution,
}

impl std::fmt::Display for SystemArray {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Matrix => "matrix",
            Self::RightHandSide => "right-hand side",
            Self::Solution => "solution",
        })
    }
}

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinalgError {
    /// A stencil names an equation that does not exist.
    #[error("entry {entry} of stencil {stencil} names equation {equation}, but there are only {n}")]
    EquationOutOfRange {
        /// Index of the stencil in its list.
        stencil: usize,
        /// Index of the entry in the stencil.
        entry: usize,
        /// The equation named there.
        equation: u32,
        /// Number of equations.
        n: usize,
    },
    /// A stencil couples two equations that the pattern does not couple.
    #[error("stencil {stencil} couples row {row} and column {column}, which the pattern does not contain")]
    EntryNotInPattern {
        /// Index of the stencil in its list.
        stencil: usize,
        /// Row of the missing entry.
        row: u32,
        /// Column of the missing entry.
        column: u32,
    },
    /// More equations or entries than 32-bit positions can number.
    #[error("the system is too large: {what} = {count} does not fit into 32 bits")]
    TooLarge {
        /// Name of what is counted.
        what: &'static str,
        /// The count.
        count: usize,
    },
    /// A slice has the wrong length.
    #[error("{what} has {found} entries instead of {expected}")]
    Length {
        /// Name of the slice.
        what: &'static str,
        /// The length asked for.
        expected: usize,
        /// The length found.
        found: usize,
    },
    /// `factorise` before `analyse`, or `solve` before `factorise` (or after a factorisation that failed).
    #[error("`{called}` was called before `{missing}`")]
    CallOrder {
        /// The method called.
        called: &'static str,
        /// The method that has to come first.
        missing: &'static str,
    },
    /// The matrix is singular to working precision.
    #[error("the matrix is singular to working precision{}", .row.map(|row| format!(" (the undetermined motion is largest in equation {row})")).unwrap_or_default())]
    Singular {
        /// The equation in which the (nearly) undetermined motion is largest, if it is known. A body without supports
        /// leads to this error.
        row: Option<usize>,
    },
    /// NaN or infinity.
    #[error("the {place} is not finite at index {index}")]
    NonFinite {
        /// Array that it is in.
        place: SystemArray,
        /// Index in that array.
        index: usize,
    },
    /// The residual of the solution stayed too large in spite of the iterative refinement.
    #[error(
        "the row-wise backward error {backward_error:.1e} of the solution stays above {limit:.1e} after {refinement_steps} refinement steps"
    )]
    NotConverged {
        /// The smallest row-wise backward error reached.
        backward_error: f64,
        /// The limit that it should have been below.
        limit: f64,
        /// Refinement steps done.
        refinement_steps: u32,
    },
    /// A setting that the solver does not have, or that makes no solver.
    #[error("the linear solver refuses its settings: {message}")]
    Settings {
        /// The setting, and what is wrong with it.
        message: String,
    },
    /// The library underneath failed, usually for lack of memory.
    #[error("{operation} failed: {message}")]
    Backend {
        /// The operation that failed.
        operation: &'static str,
        /// The message of the library.
        message: String,
    },
}
