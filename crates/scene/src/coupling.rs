//! How sets of deformable bodies follow what acts on them as wholes.

use crate::names::named;

named! {
    /// How the set of a deformable body follows its reference point.
    Coupling {
        /// The set moves as a rigid body.
        Kinematic = "kinematic",
        /// The reference point follows the set in the mean: the set deforms freely.
        Distributing = "distributing",
    }
}
