//! Checkpoints: the whole state of a run, from which it continues with the same bits; written atomically.

use crate::control::Clock;
use crate::run_state::{Ledger, Log, NodalForces, SlotState, StageState};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
#[cfg(feature = "checkpoints")]
use std::io::Write;
#[cfg(feature = "checkpoints")]
use std::path::Path;
use std::path::PathBuf;
use stoss_integrators::State;

#[cfg(feature = "checkpoints")]
const MAGIC: &[u8; 8] = b"STOSSCP\x0c";

/// Why a checkpoint cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// Input or output.
    #[error("checkpoint {path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file that is no checkpoint, is of another version, or is damaged.
    #[error("checkpoint {path} is not readable: {reason}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// A checkpoint of another scene or model.
    #[error("checkpoint does not fit: {reason}")]
    Mismatch {
        /// Difference between the checkpoint and the run.
        reason: String,
    },
}

/// The state of a run after a completed step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Identifies scene and program version; a run resumes only with the same tag.
    pub tag: String,
    /// Clock and step control.
    pub clock: Clock,
    /// The stage, and what does not act.
    pub stage: StageState,
    /// Completed steps.
    pub step: u64,
    /// Positions, velocities (in quasi-static runs: last displacement increment over its time), and whatever else the scheme carries.
    #[serde(with = "StateParts")]
    pub state: State,
    /// Multipliers of the couplings.
    pub slots: SlotState,
    /// Balance at the last step.
    pub ledger: Ledger,
    /// Forces of the last step, for output.
    pub forces: NodalForces,
    /// Times, decisions and counts so far.
    pub log: Log,
    /// Largest rate of a gap that closed under the law of impact.
    pub largest_rate: f64,
    /// Histories of all terms: bodies, parts, loads, couplings.
    pub histories: Vec<Vec<u8>>,
    /// Further data of the caller by name, for instance the lengths of result files.
    pub attachments: BTreeMap<String, Vec<u8>>,
}

/// State as it is written.
#[derive(Serialize, Deserialize)]
#[serde(remote = "State")]
struct StateParts {
    time: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    history: Vec<f64>,
}

/// 64-bit FNV-1a: detects a torn or damaged file; it is no protection against intent.
#[cfg(feature = "checkpoints")]
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(feature = "checkpoints")]
impl Checkpoint {
    /// Writes to a temporary file in the same folder, flushes it to the disk and renames it: at any moment the path names a complete
    /// checkpoint or none.
    ///
    /// # Errors
    /// [`CheckpointError::Io`].
    pub fn write(&self, path: &Path) -> Result<(), CheckpointError> {
        let io = |source| CheckpointError::Io { path: path.to_path_buf(), source };
        let body = postcard::to_stdvec(self)
            .map_err(|e| CheckpointError::Damaged { path: path.to_path_buf(), reason: e.to_string() })?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut file = tempfile::NamedTempFile::new_in(folder).map_err(io)?;
        file.write_all(MAGIC).map_err(io)?;
        file.write_all(&checksum(&body).to_le_bytes()).map_err(io)?;
        file.write_all(&body).map_err(io)?;
        file.as_file().sync_all().map_err(io)?;
        file.persist(path).map_err(|e| io(e.error))?;
        Ok(())
    }

    /// Reads and checks a checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError::Io`], [`CheckpointError::Damaged`].
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        let bytes = std::fs::read(path).map_err(|source| CheckpointError::Io { path: path.to_path_buf(), source })?;
        Self::from_bytes(&bytes, path)
    }

    /// The checkpoint in the bytes of a file of this name, which others have read.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`].
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self, CheckpointError> {
        let damaged = |reason: &str| CheckpointError::Damaged { path: path.to_path_buf(), reason: reason.into() };
        let body = bytes.strip_prefix(MAGIC).ok_or_else(|| damaged("not a checkpoint of this version"))?;
        let (sum, body) = body.split_first_chunk::<8>().ok_or_else(|| damaged("truncated"))?;
        if u64::from_le_bytes(*sum) != checksum(body) {
            return Err(damaged("the checksum is wrong (truncated or changed)"));
        }
        postcard::from_bytes(body).map_err(|e| damaged(&e.to_string()))
    }
}
