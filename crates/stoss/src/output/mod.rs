//! The folder of results: frames, tables, summary, checkpoint.
//!
//! Tables and frames are complete after every step, so that a run that is killed leaves what it had done; a resumed run cuts
//! them back to its checkpoint and then writes the same bytes as a run that was never interrupted.

mod drift;
mod earlier;
mod folder;
mod frame;
mod identity;
mod lock;
mod promises;
mod summary;
mod systems;
mod table;
mod watch;

pub use drift::Drift;
pub use folder::{FolderSettings, ResultFolder};
pub use identity::SceneIdentity;
pub use summary::{Memory, Outcome, Summary, WatchSummary};
pub use watch::judge_folder;

pub(crate) use promises::{changed_by, promises};
pub(crate) use systems::SystemWriter;
pub(crate) use watch::{contact_bodies, judge_start};

use std::path::{Path, PathBuf};

/// Why results cannot be written or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// Input or output.
    #[error("{path}: {source}", path = .path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file does not fit the checkpoint.
    #[error("{path} does not fit the checkpoint: {reason}; run again without --resume", path = .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A stored result cannot be judged.
    #[error("{path} cannot be judged: {reason}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file has the name of a file of results, but is none.
    #[error("{path} was not written by Stoss, but a run would replace it; move it away, or choose another folder with --out",
        path = .path.display())]
    NotOurs {
        /// The file.
        path: PathBuf,
    },
    /// Another run writes into the folder.
    #[error("{path} is in use by another run; wait for its end, or choose another folder with --out", path = .path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// A frame could not be written.
    #[error(transparent)]
    Frame(#[from] stoss_mesh_io::MeshIoError),
    /// A linear system could not be written.
    #[error(transparent)]
    System(#[from] stoss_linalg::matrix_market::SystemFileError),
    /// A quantity could not be evaluated.
    #[error("evaluating a result: {0}")]
    Evaluate(#[from] stoss_solver::StepError),
    /// The watch cannot be built for these bodies.
    #[error("the watch: {0}")]
    Watch(#[from] stoss_watch::WatchError),
    /// A checkpoint could not be written.
    #[error(transparent)]
    Checkpoint(#[from] stoss_solver::CheckpointError),
}

impl OutputError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.to_path_buf(), source }
    }
}
