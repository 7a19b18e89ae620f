//! The folder of results: frames, tables, summary, checkpoint.
//!
//! Tables and frames are complete after every step, so that a run that is killed leaves what it had done; a resumed run cuts
//! them back to its checkpoint and then writes the same bytes as a run that was never interrupted.

mod description;
mod drift;
mod earlier;
mod folder;
mod frame;
mod frames;
mod hdf;
mod identity;
mod lock;
mod means;
mod promises;
mod rows;
mod settings;
mod start;
mod summary;
mod systems;
mod table;
mod watch;

pub use crate::build::{Drawing, DrawnLine, DrawnPoint, DrawnSurface};
#[cfg(test)]
mod tests;

pub use crate::error::OutputError;
pub use description::{Description, UnitLabels};
pub use drift::Drift;
pub use earlier::Overwrite;
pub use folder::ResultFolder;
pub use identity::SceneIdentity;
pub use lock::is_in_use;
pub use settings::FolderSettings;
pub use summary::{Memory, Outcome, RankSummary, Summary, WatchSummary};
pub use watch::{Watched, judge_folder};

pub(crate) use promises::{changed_by, promises};
pub(crate) use start::write_start;
pub(crate) use systems::SystemWriter;
pub(crate) use watch::{contact_bodies, judge_start};
