//! What can be wrong with data.

/// Why nothing is fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A line of a table.
    #[error("line {line}: {message}; {remedy}")]
    Line {
        /// Number of the line, from one.
        line: usize,
        /// Message: what is wrong.
        message: String,
        /// Remedy: what to do.
        remedy: String,
    },
    /// Fewer points than parameters.
    #[error(
        "the law {law} has {parameters} parameters to be found and the table has {points} points; measure more, or take a law with fewer"
    )]
    TooFew {
        /// Name of the law.
        law: &'static str,
        /// Number of parameters that are sought.
        parameters: usize,
        /// Points beside those without strain.
        points: usize,
    },
    /// A search of which no start led anywhere.
    #[error(
        "no parameters of the law {law} describe these curves; see whether stresses grow with stretches, and take another law"
    )]
    NoParameters {
        /// Name of the law.
        law: &'static str,
    },
    /// Poisson's ratio.
    #[error("Poisson's ratio {poisson} must be above 0 and below 1/2; rubber has about 0.4999")]
    Poisson {
        /// The value.
        poisson: f64,
    },
}
