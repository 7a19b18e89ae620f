//! The ranks that run a scene together: which there are, and what each of them solves its linear systems with.
//!
//! Every rank runs the same program on the same scene and takes the same decisions. The first one writes the results; the others compute only. An error of one is one of all, so that none waits for a
//! rank that has ended.

use std::fmt::Display;
use std::sync::Arc;
use stoss_linalg::{Communicator, GatheredSolver, LinearSolver, Serial};
#[cfg(feature = "mpi")]
use stoss_linalg_petsc::Mpi;

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
    #[cfg(feature = "mpi")]
    Mpi(Arc<Mpi>),
}

/// An error that another rank of a run has, and this one has not; the text begins with its number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OtherRankError(String);

impl Ranks {
    /// Ranks of which each gathers the whole matrix and solves with the scene's solver ([`GatheredSolver`]): for tests of what is shared out, with threads as ranks ([`stoss_linalg::Threads`]).
    pub fn gathered(communicator: Arc<dyn Communicator>) -> Self {
        Self(Kind::Gathered(communicator))
    }

    /// The processes that `mpirun` has started together, which solve with PETSc unless the scene names another solver. Starts MPI; a program calls [`Ranks::end`] at its end.
    ///
    /// # Errors
    /// Why MPI or PETSc do not start.
    #[cfg(feature = "mpi")]
    pub fn mpi() -> Result<Self, String> {
        let mpi = Mpi::start()?;
        Ok(Self(if mpi.size() > 1 { Kind::Mpi(mpi) } else { Kind::One }))
    }

    /// Ends MPI, if it was started: on all ranks, when no run is going on any more.
    #[cfg(feature = "mpi")]
    pub fn end() {
        Mpi::end();
    }

    /// What the ranks tell each other with.
    pub fn communicator(&self) -> Arc<dyn Communicator> {
        match &self.0 {
            Kind::One => Serial::shared(),
            Kind::Gathered(communicator) => Arc::clone(communicator),
            #[cfg(feature = "mpi")]
            Kind::Mpi(mpi) => Arc::clone(mpi) as Arc<dyn Communicator>,
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

    /// Whether PETSc solves on these ranks if the scene does not name a solver.
    pub(crate) fn have_petsc(&self) -> bool {
        !matches!(self.0, Kind::One | Kind::Gathered(_))
    }

    /// The solver of a run on these ranks, of one that serves one rank.
    pub(crate) fn spread(&self, solver: Box<dyn LinearSolver>) -> Box<dyn LinearSolver> {
        match &self.0 {
            Kind::One => solver,
            _ => Box::new(GatheredSolver::new(self.communicator(), solver)),
        }
    }

    /// What the first rank with an error says, where this one has none. Collective.
    pub(crate) fn elsewhere(&self, own: Option<&dyn Display>) -> Option<OtherRankError> {
        let communicator = self.communicator();
        let text = own.map(|error| format!("rank {}: {error}", communicator.rank()));
        communicator.first_text(text.as_deref()).filter(|_| own.is_none()).map(OtherRankError)
    }

    /// The result, or an error on all ranks if one of them has one: its own, or that of the first other rank. Collective.
    ///
    /// # Errors
    /// The error of the result, or [`OtherRankError`].
    pub fn agree<T, E: Display + From<OtherRankError>>(&self, result: Result<T, E>) -> Result<T, E> {
        match self.elsewhere(result.as_ref().err().map(|error| error as &dyn Display)) {
            Some(error) => Err(error.into()),
            None => result,
        }
    }

    /// What the first rank gives, on all. Collective.
    #[cfg(feature = "output")]
    pub(crate) fn of_first(&self, bytes: Vec<u8>) -> Vec<u8> {
        if self.count() == 1 {
            return bytes;
        }
        let mine: &[u8] = if self.is_first() { &bytes } else { &[] };
        self.communicator().gather_bytes(mine).swap_remove(0)
    }

    /// Whether all ranks give the same. Collective.
    #[cfg(feature = "output")]
    pub(crate) fn are_equal(&self, bytes: &[u8]) -> bool {
        self.communicator().gather_bytes(bytes).iter().all(|other| other == bytes)
    }
}
