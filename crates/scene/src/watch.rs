//! The table `[watch]`.

use crate::names::named;
use stoss_scene_derive::table;

named! {
    /// Consequence of the verdict `wrong` for the run.
    #[derive(Default)]
    OnFault {
        /// The run continues to its end; the program then exits with code 4.
        #[default]
        Finish = "finish",
        /// The run stops after the step; the program exits with code 4. The run can be resumed.
        Stop = "stop",
        /// The verdict is written, and the program exits with code 0.
        Ignore = "ignore",
    }
}

named! {
    /// Verdict of the watch on a run.
    Verdict {
        /// Nothing was found.
        Sound = "sound",
        /// The result should be examined.
        Doubtful = "doubtful",
        /// The result must not be used.
        Wrong = "wrong",
    }
}

/// `[watch]`: the independent check of every run for penetration, inverted elements and violated conservation of momentum and energy.
#[table]
pub struct Watch {
    /// Number of steps from one check of the geometry to the next, at least 1. If left out every step with less than 4000 facets, every second one
    /// with less than 8000, and so on.
    pub every: Option<u32>,
    /// Depth of a node inside another body from which on a run is `wrong`, in edge lengths of the facet there; positive. From a
    /// sixth of it on a run is `doubtful`.
    #[key(default = Self::DEFAULT_LIMIT, dimension = Number, positive)]
    pub limit: f64,
    /// Consequence of the verdict `wrong`: `finish` if left out.
    #[key(default)]
    pub on_fault: OnFault,
}

impl Watch {
    /// Depths of less than a third of an edge occur with coarse meshes.
    pub const DEFAULT_LIMIT: f64 = 0.3;
}
