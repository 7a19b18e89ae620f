//! Why a system is left to the direct solver.

/// What the iterative solver cannot do, or would do slowly.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Refusal {
    /// The aggregates of a level are too small.
    NoCoarsening { equations: usize },
    /// The coarsest matrix has no factors, with the reason.
    Coarsest(String),
    /// The Schur complement has no factors, with the reason.
    Schur(String),
    /// A solution did not end, after so many iterations.
    NotConverged { iterations: u32, residual: f64 },
    /// A solution was broken off after so many iterations, because it would have gone beyond the limit.
    Foreseen { iterations: u32, limit: u32 },
    /// Two solutions one after the other took many iterations, the last one so many.
    Slow { iterations: u32 },
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoCoarsening { equations } => {
                write!(f, "the aggregates of a level of {equations} equations are too small")
            }
            Self::Coarsest(reason) => write!(f, "the coarsest level: {reason}"),
            Self::Schur(reason) => write!(f, "the Schur complement of the multipliers: {reason}"),
            Self::NotConverged { iterations, residual } => {
                write!(f, "the relative residual is {residual:.1e} after {iterations} iterations")
            }
            Self::Foreseen { iterations, limit } => {
                write!(f, "a solution would take more than {limit} iterations, as its first {iterations} show")
            }
            Self::Slow { iterations } => write!(f, "two solutions took many iterations, the last one {iterations}"),
        }
    }
}
