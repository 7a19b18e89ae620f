//! Errors of a step and of a run.

use crate::checkpoint::CheckpointError;
use stoss_contact::ContactError;
use stoss_fe_solid::SolidError;
use stoss_linalg::LinalgError;

/// Why an attempted step failed.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A solid could not be evaluated (an inverted element, for instance).
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// Contact geometry failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The linear system could not be solved.
    #[error(transparent)]
    Linear(#[from] LinalgError),
    /// Newton did not converge.
    #[error("Newton: {reason} after {iterations} iterations (relative residual {residual:.2e})")]
    NotConverged {
        /// The stop reason.
        reason: String,
        /// Iterations done.
        iterations: usize,
        /// Last relative residual.
        residual: f64,
    },
    /// The active set did not settle.
    #[error("the active set did not settle in {changes} changes")]
    ActiveSet {
        /// Changes tried.
        changes: usize,
    },
    /// A system with the mass alone could not be solved.
    #[error("the mass matrix is singular: is there a body without volume or density?")]
    Mass,
}

/// Why a run stopped early. All completed steps stay valid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The model is inconsistent.
    #[error("{0}")]
    Model(String),
    /// No step size down to the smallest allowed one worked.
    #[error("step {step} from time {time} failed even at the step size {dt:.3e}: {cause}")]
    StepFailed {
        /// Number of the step that failed.
        step: u64,
        /// Time of the last completed step.
        time: f64,
        /// Smallest step size tried.
        dt: f64,
        /// The last failure.
        cause: StepError,
    },
    /// Setting up failed.
    #[error("setting up: {0}")]
    Setup(#[from] StepError),
    /// Reading or writing a checkpoint failed.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}
