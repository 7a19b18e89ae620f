//! Why a run of a model problem stops.

/// Why a run stopped. What the observer saw before stays valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The scheme cannot integrate constraints.
    #[error("scheme `{scheme}` cannot integrate constraints, which `{problem}` has")]
    Constraints {
        /// The scheme.
        scheme: String,
        /// The problem.
        problem: String,
    },
    /// The step size is not positive and finite.
    #[error("the step size must be positive and finite, found {dt}")]
    StepSize {
        /// Step size given.
        dt: f64,
    },
    /// `M x = b` has no solution.
    #[error("the mass matrix is singular")]
    SingularMass,
    /// The tangent is singular.
    #[error("the tangent is singular")]
    SingularTangent,
    /// Newton did not converge.
    #[error("step {step} from time {time}: Newton: {reason}")]
    Newton {
        /// Number of the step, from 1.
        step: u64,
        /// Time at the start of the step.
        time: f64,
        /// The stop reason.
        reason: String,
    },
    /// The active set did not settle.
    #[error("step {step} from time {time}: the active set does not settle")]
    ActiveSet {
        /// Number of the step.
        step: u64,
        /// Time at the start of the step.
        time: f64,
    },
    /// Coordinates or energy have grown without bound.
    #[error("step {step} at time {time}: the solution has grown without bound")]
    Unbounded {
        /// Number of the step.
        step: u64,
        /// Time at the end of the step.
        time: f64,
    },
}
