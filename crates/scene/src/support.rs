//! `[[support]]`: springs and dashpots to the ground.

use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// What stiffness and damping of a support are given for.
    SupportPer {
        /// For a unit of the reference area of a set of facets.
        Area = "area",
        /// For each node of a set.
        Node = "node",
    }
}

/// `[[support]]`: springs and dashpots from a set of a deformable body to the ground, without force in the reference configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Set of facets, or of nodes with `per = "node"`, `body.set`.
    pub set: String,
    /// What the numbers are given for.
    #[serde(default = "Support::default_per")]
    pub per: SupportPer,
    /// Stiffness along the three axes: force per length, and per area or node.
    #[serde(default)]
    pub stiffness: [f64; 3],
    /// Damping along the three axes: force per velocity, and per area or node. It does not act in statics; a quasi-static scene needs stiffness.
    #[serde(default)]
    pub damping: [f64; 3],
}

impl Support {
    /// Name of the part that the support with this number in the scene becomes.
    pub fn part_name(&self, number: usize) -> String {
        format!("support[{number}] of {}", self.set)
    }

    pub(crate) fn default_per() -> SupportPer {
        SupportPer::Area
    }
}
