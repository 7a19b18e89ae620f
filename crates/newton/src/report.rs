//! What the iteration did.

/// Why the iteration stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StopReason {
    /// The tolerance is reached.
    Converged,
    /// The residual does not fall any further and is (or the increments are) as small as round-off allows.
    ConvergedToRoundOff,
    /// The limit on iterations is reached.
    MaxIterations,
    /// The residual exceeds the limit of divergence.
    Diverged,
    /// The residual has not fallen for many iterations, well above round-off.
    Stagnated,
    /// No step length was acceptable.
    LineSearchFailed,
    /// A residual or an increment is NaN or infinite.
    NotFinite,
    /// The problem reported an error.
    ProblemError,
}

impl StopReason {
    /// Whether the iterate is a solution.
    pub fn is_converged(self) -> bool {
        matches!(self, Self::Converged | Self::ConvergedToRoundOff)
    }
}

impl std::fmt::Display for StopReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::ConvergedToRoundOff => "converged to round-off",
            Self::MaxIterations => "too many iterations",
            Self::Diverged => "diverged",
            Self::Stagnated => "stagnated",
            Self::LineSearchFailed => "no acceptable step length",
            Self::NotFinite => "residual or increment not finite",
            Self::ProblemError => "error in the problem",
        })
    }
}

/// One iterate. The first record of a report is the initial iterate, with zero increment and step length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationRecord {
    /// Norm of the residual at this iterate.
    pub residual: f64,
    /// The residual's scale at this iterate.
    pub scale: f64,
    /// Largest violation of the constraints at this iterate, relative to what they are measured with.
    pub violation: f64,
    /// Norm of the full increment `du` that led here.
    pub increment: f64,
    /// The part of the increment that was taken: 1 without a line search (less after a cycle), 0 for a further iteration that was rejected
    /// (its residual is that of the rejected iterate).
    pub step_length: f64,
}

impl IterationRecord {
    /// The larger of `residual / scale` and the violation of the constraints.
    pub fn relative_residual(&self) -> f64 {
        let relative = if self.residual == 0.0 { 0.0 } else { self.residual / self.scale };
        // `max` would lose a NaN.
        if self.violation > relative { self.violation } else { relative }
    }
}

/// The course of one iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct NewtonReport {
    /// Why it stopped.
    pub reason: StopReason,
    /// The iterates, the initial one first.
    pub iterations: Vec<IterationRecord>,
}

impl NewtonReport {
    /// Number of linear systems solved whose step was tried.
    pub fn iteration_count(&self) -> usize {
        self.iterations.len().saturating_sub(1)
    }

    /// The accepted iterate, if there was one.
    pub fn accepted(&self) -> Option<&IterationRecord> {
        self.iterations.iter().rev().find(|r| r.step_length > 0.0 || r.increment == 0.0)
    }

    /// Norm of the residual at the accepted iterate; NaN if there was none.
    pub fn final_residual(&self) -> f64 {
        self.accepted().map_or(f64::NAN, |r| r.residual)
    }

    /// The order of convergence seen in the last three residuals `a > b > c` that are above the level of round-off
    /// (`1e-14` times the scale): `ln(c/b) / ln(b/a)`. None if there are no three.
    pub fn observed_order(&self) -> Option<f64> {
        let usable = |w: &&[IterationRecord]| {
            let falls = w[0].residual > w[1].residual && w[1].residual > w[2].residual;
            falls && w[2].residual > 1e-14 * w[2].scale && w[2].step_length == 1.0
        };
        let w = self.iterations.windows(3).rev().find(usable)?;
        Some((w[2].residual / w[1].residual).ln() / (w[1].residual / w[0].residual).ln())
    }
}

/// The iteration did not arrive at a solution.
#[derive(Debug, Clone, thiserror::Error)]
pub enum NewtonFailure<E> {
    /// The problem reported an error that no shorter step avoids.
    #[error("error in iteration {}: {error}", .report.iterations.len())]
    Problem {
        /// The problem's error.
        error: E,
        /// The course so far.
        report: NewtonReport,
    },
    /// An iteration that stopped without a solution.
    #[error("no convergence ({}) after {} iterations, residual {:.3e}", .0.reason, .0.iteration_count(), .0.iterations.last().map_or(f64::NAN, |r| r.residual))]
    NotConverged(NewtonReport),
}

impl<E> NewtonFailure<E> {
    /// The course of the iteration, whatever ended it.
    pub fn report(&self) -> &NewtonReport {
        match self {
            Self::Problem { report, .. } | Self::NotConverged(report) => report,
        }
    }
}
