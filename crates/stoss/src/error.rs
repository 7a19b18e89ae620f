//! Why a run or its folder of results fails.

use crate::ranks::OtherRankError;
use crate::scene::SceneErrors;
use std::path::{Path, PathBuf};
use stoss_solver::{SimulationError, digits};
use stoss_watch::Verdict;

/// Why a run was not done or not finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scene is wrong.
    #[error("{0}")]
    Scene(SceneErrors),
    /// The scene's file cannot be read.
    #[error("cannot read the scene {path}: {source}", path = .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The scene's file is no text.
    #[error("{path}:{line}: the file is not UTF-8 text here: save the scene in the encoding UTF-8", path = .path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// The first line that cannot be read, from 1.
        line: usize,
    },
    /// An option does not fit the scene.
    #[error("{0}")]
    Option(String),
    /// Another rank of the run has an error, and this one has none; the text has its number.
    #[error(transparent)]
    OtherRank(#[from] OtherRankError),
    /// The checkpoint does not fit.
    #[error("cannot resume from {path}: {reason}", path = .path.display())]
    Resume {
        /// The checkpoint.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// Results cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The simulation stopped early.
    #[error("{source}\nlast good state: step {last_step} at t = {time}; all results up to there are in {out}", time = digits(*.last_time), out = .out.display())]
    Simulation {
        /// What happened.
        source: Box<SimulationError>,
        /// Last completed step.
        last_step: u64,
        /// Time of the last completed step.
        last_time: f64,
        /// What the watch found up to there.
        verdict: Box<Verdict>,
        /// Folder of the results.
        out: PathBuf,
    },
}

/// Why results cannot be written or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// Another rank of the run cannot write, and this one does not: the text has its number.
    #[error(transparent)]
    OtherRank(#[from] OtherRankError),
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
        /// Reason.
        reason: String,
    },
    /// A stored result cannot be judged.
    #[error("{path} cannot be judged: {reason}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// A file has the name of a file of results, but is none.
    #[error("{path} was not written by Stoss, but the run would replace it; move it away, choose another folder with --out, or replace it with --force",
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
