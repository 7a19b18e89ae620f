//! What a result folder is made with.

use super::identity::SceneIdentity;
use crate::build::{ContactPlan, JointPlace, Probe};
use crate::ranks::Ranks;
use crate::scene::{Field, FrameFormat, Frames, Watch as WatchTable};
use stoss_watch::{Finding, Promises};

/// What a folder needs to know of the scene.
#[derive(Clone, Debug)]
pub struct FolderSettings {
    /// The joints.
    pub joints: Vec<JointPlace>,
    /// The ranks of the run, of which the first one writes; all of them call the same methods of a folder in the same order.
    pub ranks: Ranks,
    /// Stages of the run.
    pub schedule: crate::build::Schedule,
    /// What frames show beside the solids.
    pub drawing: super::Drawing,
    /// Title of the scene.
    pub title: String,
    /// Names of bodies, plan and text of the scene.
    pub description: super::Description,
    /// What the results depend on.
    pub identity: SceneIdentity,
    /// Scheme, or "quasi-static".
    pub scheme: String,
    /// Which steps have a frame, beside the last one.
    pub frames: Frames,
    /// Format of the files of frames.
    pub format: FrameFormat,
    /// A checkpoint every so many steps.
    pub checkpoint_every: u64,
    /// Fields of the frames; `None`: all.
    pub fields: Option<Vec<Field>>,
    /// What sums over the model are divided by in tables and frames ([`crate::build::Built::extent`]).
    pub extent: f64,
    /// Probes.
    pub probes: Vec<Probe>,
    /// What drifts of linear momentum, angular momentum and energy are relative to; `None`: the largest magnitude in the run.
    pub scales: [Option<f64>; 3],
    /// What changes linear momentum, angular momentum and energy, if anything does: then there is no drift to report.
    pub changed_by: [Option<String>; 3],
    /// Contacts, for the summary.
    pub contacts: Vec<ContactPlan>,
    /// Names of all parts.
    pub parts: Vec<String>,
    /// Pairs of bodies between which a contact is named.
    pub contact_bodies: Vec<Option<[usize; 2]>>,
    /// What must not change, stage by stage.
    pub promises: Vec<Option<Promises>>,
    /// What is checked, and what a verdict `wrong` does.
    pub watch: WatchTable,
    /// The finding that the scene lacks something of its deck.
    pub left_out: Option<Finding>,
}

impl FolderSettings {
    pub(super) fn has_friction(&self) -> bool {
        self.contacts.iter().any(|contact| contact.friction.is_some())
    }
}
