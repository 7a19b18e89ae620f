//! The table `[watch]`.

use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// What a verdict `wrong` does to the run.
    #[derive(Default)]
    OnFault {
        /// The run goes on to its end; the program then exits with code 4.
        #[default]
        Finish = "finish",
        /// The run stops after the step; the program exits with code 4. The run can be resumed.
        Stop = "stop",
        /// The verdict is written, the program exits with code 0.
        Ignore = "ignore",
    }
}

named! {
    /// What the watch found in a run.
    Verdict {
        /// Nothing.
        Sound = "sound",
        /// Something that needs attention.
        Doubtful = "doubtful",
        /// The result must not be used as it is.
        Wrong = "wrong",
    }
}

/// `[watch]`: the independent check of every run for bodies inside each other, inverted elements and broken balances.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Watch {
    /// The geometry is checked every so many steps, at least 1; by default every step with less than 4000 facets, every second one
    /// with less than 8000, and so on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every: Option<u32>,
    /// Depth of a node inside another body, in edge lengths of the facet that it passed, from which on a run is wrong; positive. A
    /// sixth of it is doubtful.
    #[serde(default = "Watch::default_limit")]
    pub limit: f64,
    /// What a verdict `wrong` does.
    #[serde(default)]
    pub on_fault: OnFault,
}

impl Watch {
    /// Less than a third of an edge is within what a coarse mesh leaves open.
    pub const DEFAULT_LIMIT: f64 = 0.3;

    fn default_limit() -> f64 {
        Self::DEFAULT_LIMIT
    }
}

impl Default for Watch {
    fn default() -> Self {
        Self { every: None, limit: Self::DEFAULT_LIMIT, on_fault: OnFault::default() }
    }
}
