//! Kinematic and distributing coupling of sets of deformable bodies to a reference point.

use crate::names::named;

named! {
    /// Coupling of a set of a deformable body to its reference point.
    Coupling {
        /// Kinematic coupling: the set moves as a rigid body with the reference point.
        Kinematic = "kinematic",
        /// Distributing coupling: the reference point follows the mean motion of the set, which can deform freely.
        Distributing = "distributing",
    }
}
