//! Errors of segmentation.

/// Errors of segmentation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SegmentationError {
    /// The diagonals of the slave facet are parallel: it has no area about its centre and no normal.
    #[error("the slave facet has no normal at its centre (product of its diagonals {area:e})")]
    DegenerateSlave {
        /// Length of the vector product of the diagonals, an area.
        area: f64,
    },
    /// A coordinate is not finite.
    #[error("a node of the {side} facet is not finite")]
    NotFinite {
        /// "slave" or "master".
        side: &'static str,
    },
}
