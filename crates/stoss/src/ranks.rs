//! The ranks that run a scene together: which there are, and what each of them solves its linear systems with.
//!
//! Every rank runs the same program on the same scene and takes the same decisions. The first one writes the results and speaks; the others compute only.

use std::fmt::Display;
use std::sync::Arc;
use stoss_linalg::{Communicator, GatheredSolver, LinearSolver, Serial};

/// The ranks of a run; one by default.
///
/// ```
/// use stoss::linalg::Threads;
/// use stoss::ranks::Ranks;
///
/// let first = Threads::run(3, |communicator| Ranks::gathered(communicator).is_first());
/// assert_eq!(first, [true, false, false]);
/// assert!(Ranks::default().is_first());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Ranks(Kind);

#[derive(Clone, Debug, Default)]
enum Kind {
    #[default]
    One,
    Gathered(Arc<dyn Communicator>),
}

impl Ranks {
    /// Ranks of which each gathers the whole matrix and solves with the scene's solver ([`GatheredSolver`]): for tests of what is shared out, with threads as ranks ([`stoss_linalg::Threads`]).
    pub fn gathered(communicator: Arc<dyn Communicator>) -> Self {
        Self(Kind::Gathered(communicator))
    }

    /// What the ranks tell each other with.
    pub fn communicator(&self) -> Arc<dyn Communicator> {
        match &self.0 {
            Kind::One => Serial::shared(),
            Kind::Gathered(communicator) => Arc::clone(communicator),
        }
    }

    /// The number of ranks.
    pub fn count(&self) -> usize {
        self.communicator().size()
    }

    /// Whether this is the rank that writes and speaks.
    pub fn is_first(&self) -> bool {
        self.communicator().rank() == 0
    }

    /// The solver of a run on these ranks, of one that serves one rank.
    pub(crate) fn spread(&self, solver: Box<dyn LinearSolver>) -> Box<dyn LinearSolver> {
        match &self.0 {
            Kind::One => solver,
            Kind::Gathered(communicator) => Box::new(GatheredSolver::new(Arc::clone(communicator), solver)),
        }
    }

    /// What the first rank with an error says, with its number, where this one has none. Collective.
    pub(crate) fn elsewhere(&self, own: Option<&dyn Display>) -> Option<String> {
        let communicator = self.communicator();
        let text = own.map(|error| format!("rank {}: {error}", communicator.rank()));
        communicator.first_text(text.as_deref()).filter(|_| own.is_none())
    }
}
