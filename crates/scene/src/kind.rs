//! Kinds of scenes and of stages.

use crate::names::named;

named! {
    /// Kind of analysis of a scene or a stage.
    Kind {
        /// With inertia: needs `[time] integrator` and the density of every body.
        Dynamic = "dynamic",
        /// Without inertia: a sequence of equilibria while loads and prescribed displacements follow their tables.
        QuasiStatic = "quasi-static",
    }
}
