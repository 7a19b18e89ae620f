//! Contact surfaces, pair search, gap kinematics, and the trait of a contact discretisation.

mod method;
pub use method::{ContactMethod, ContactRule, LocalContribution, SlotReport, StepConfiguration};

/// Errors of contact geometry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A projection did not converge.
    #[error("closest-point projection of slave node {node} on master facet {facet} did not converge")]
    Projection { node: u32, facet: u32 },
    /// A surface has no facet.
    #[error("the {side} surface is empty")]
    EmptySurface { side: &'static str },
    /// Slave and master share nodes.
    #[error("slave and master surface share node {node}: a body cannot be in contact with itself here")]
    SharedNode { node: u32 },
    /// A facet has a degenerate normal.
    #[error("facet {facet} is degenerate (area {area:e})")]
    DegenerateFacet { facet: u32, area: f64 },
    /// History bytes do not fit.
    #[error("contact history does not fit this model: {reason}")]
    History { reason: String },
}
