//! Kinematic and distributing coupling of sets of deformable bodies to a reference point; `[[coupling]]`.

use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// Coupling of a set of a deformable body to its reference point.
    Coupling {
        /// Kinematic coupling: the set moves as a rigid body with the reference point.
        Kinematic = "kinematic",
        /// Distributing coupling: the reference point follows the mean motion of the set, which can deform freely.
        Distributing = "distributing",
    }
}

/// `[[coupling]]`: nodes of a deformable body that move with a rigid body, or in whose mean it moves. Loads, prescribed motions and joints of the rigid body then act on the nodes. It needs neither mass
/// nor surface: its `position` is the reference point.
///
/// ```toml
/// [[rigid]]
/// name = "hub"
/// position = [0.0, 0.0, 0.5]
///
/// [[coupling]]
/// name = "grip"
/// kind = "distributing"
/// set = "plate.hole"
/// rigid = "hub"
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SetCoupling {
    /// Unique name.
    pub name: String,
    /// Kind of the coupling.
    pub kind: Coupling,
    /// Set of a deformable body, `body.set`. A distributing coupling needs three nodes that are not on a line.
    pub set: String,
    /// Name of the rigid body.
    pub rigid: String,
}
