//! Errors of a step and of a run.

use crate::checkpoint::CheckpointError;
use crate::place::Place;
use stoss_fe_solid::{InsideOut, SolidError};
use stoss_linalg::LinalgError;
use stoss_term::Fault;

/// Why an attempted step failed.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A term could not be evaluated: an element is inverted, a string has no length, a search failed.
    #[error(transparent)]
    Term(#[from] Fault),
    /// The linear system could not be solved for another reason than [`Self::Singular`].
    #[error(transparent)]
    Linear(#[from] LinalgError),
    /// Newton did not converge.
    #[error("Newton: {reason} after {iterations} iterations (relative residual {residual:.2e}; {place})")]
    NotConverged {
        /// The stop reason.
        reason: String,
        /// Iterations done.
        iterations: usize,
        /// Last relative residual.
        residual: f64,
        /// Where the residual is largest, and what may be the reason.
        place: String,
        /// Place in numbers of the model.
        at: Box<Place>,
    },
    /// The matrix is singular.
    #[error("the system is singular: {unknown} is not determined; {hint}")]
    Singular {
        /// The unknown in which the undetermined motion is largest.
        unknown: Unknown,
        /// Place of the unknown in numbers of the model.
        at: Box<Place>,
        /// What may be the reason.
        hint: String,
    },
    /// Prescribed motion cannot reach its end without surfaces passing through each other.
    #[error(
        "prescribed motion is blocked by surfaces that would pass through each other{place}: it has not reached its end in {attempts} attempts; {remedy}"
    )]
    Blocked {
        /// Linear responses tried.
        attempts: u32,
        /// Where surfaces are nearest to each other, as the middle of a sentence.
        place: String,
        /// Place in numbers of the model.
        at: Box<Place>,
        /// What may help.
        remedy: &'static str,
    },
    /// The active set cycles.
    #[error(
        "the active set cycles: {count} node(s) of contact {pair} (first: {first}) open when closed and close when open, after {changes} changes of the set and {repairs} changes of pairing"
    )]
    Cycling {
        /// Contact pair.
        pair: String,
        /// Nodes that flip.
        count: usize,
        /// The first of them.
        first: String,
        /// Place of the node in numbers of the model.
        at: Box<Place>,
        /// Changes of the set in this attempt.
        changes: usize,
        /// Changes of pairings in this attempt.
        repairs: usize,
    },
    /// The active set did not settle.
    #[error(
        "the active set did not settle in {rounds} rounds, with {changes} changes of the set and {repairs} changes of pairing"
    )]
    ActiveSet {
        /// Rounds tried, each with a solution.
        rounds: usize,
        /// Rounds that changed the set.
        changes: usize,
        /// Changes of pairings in this attempt.
        repairs: usize,
    },
    /// Elements that are turned inside out at a vertex at the end of the step and were not before.
    #[error(
        "body {body}: {} of {elements} elements are turned inside out at a corner (worst: element {}, relative volume {:.1e} at its node {})",
        .found.count, .found.element, .found.relative_volume, .found.node
    )]
    InsideOut {
        /// The body.
        body: String,
        /// Number of elements of the body.
        elements: usize,
        /// Number of elements that are turned inside out, and the worst one.
        found: InsideOut,
    },
    /// A point of a body flows by more in a step than the settings allow.
    #[error(
        "body {body}: the equivalent plastic strain of a point would grow by {increment:.2e} in the step, more than the limit {limit:.2e}"
    )]
    PlasticIncrement {
        /// The body.
        body: String,
        /// The largest increment.
        increment: f64,
        /// The limit, [`crate::Settings::max_plastic_increment`].
        limit: f64,
    },
    /// Accelerations and multipliers at the start are not determined.
    #[error(
        "accelerations at the start are not determined by masses and constraints ({0}): a constraint may be given twice, or something may have neither mass nor constraint"
    )]
    Start(LinalgError),
    /// A system with the mass alone could not be solved.
    #[error("the mass matrix is singular: a body may have no volume or no density")]
    Mass,
}

/// An unknown of the system, in words of the model.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Unknown {
    /// A component of the position of a node.
    Position {
        /// Component (0, 1, 2).
        component: u8,
        /// The node: number in its body, the body, where it is.
        node: String,
    },
    /// The pressure of a contact constraint.
    Pressure {
        /// Contact pair.
        pair: String,
        /// Slave node of the constraint.
        node: String,
    },
    /// The multiplier of a joint, of rigidity, of a tie.
    Multiplier {
        /// The constraint.
        constraint: String,
        /// Equation of the constraint, from one.
        equation: usize,
    },
    /// Which one is not known.
    Unnamed,
}

impl std::fmt::Display for Unknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Position { component, node } => {
                write!(f, "a motion that is largest in {} of {node}", ["x", "y", "z"][usize::from(*component) % 3])
            }
            Self::Pressure { pair, node } => write!(f, "the pressure of contact {pair} at {node}"),
            Self::Multiplier { constraint, equation } => {
                write!(f, "the multiplier of equation {equation} of {constraint}")
            }
            Self::Unnamed => f.write_str("a motion or a pressure"),
        }
    }
}

/// Why a run stopped early. All completed steps stay valid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The model is inconsistent.
    #[error("{0}")]
    Model(String),
    /// A step that failed with every step size down to the smallest allowed one.
    #[error("step {step} from time {time} failed {even}at the step size {dt:.3e}: {cause}{hint}", time = crate::short(*.time, *.dt), even = if *.were_smaller { "even " } else { "" })]
    StepFailed {
        /// Number of the step that failed.
        step: u64,
        /// Time of the last completed step.
        time: f64,
        /// Smallest step size tried.
        dt: f64,
        /// Whether a larger one was tried before.
        were_smaller: bool,
        /// The last failure.
        cause: Box<StepError>,
        /// What smaller steps do not help against, as the end of the sentence; else empty.
        hint: String,
    },
    /// Setting up failed.
    #[error("setting up: {0}")]
    Setup(#[from] StepError),
    /// A stage cannot begin.
    #[error("stage {stage}: {reason}")]
    Stage {
        /// Name of the stage.
        stage: String,
        /// Why.
        reason: String,
    },
    /// A prescription or constraint that is switched on is far from what it demands.
    #[error(
        "{what} cannot be switched on: {place} is {distance:.3e} away from where it has to be, more than an edge length ({length:.3e})"
    )]
    Jump {
        /// Name of what is switched on.
        what: String,
        /// Place where it is farthest away.
        place: String,
        /// Distance there.
        distance: f64,
        /// The length that is allowed.
        length: f64,
    },
    /// A release of something that cannot be released.
    #[error("{0}")]
    Release(String),
    /// Reading or writing a checkpoint failed.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

impl From<SolidError> for StepError {
    fn from(error: SolidError) -> Self {
        Self::Term(error.into())
    }
}
