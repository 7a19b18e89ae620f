//! Errors of mortar integrals.

use stoss_segmentation::SegmentationError;

/// Errors of mortar integrals.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MortarError {
    /// A facet could not be segmented.
    #[error("slave facet {facet}: {source}")]
    Segmentation {
        /// Local number of the slave facet.
        facet: u32,
        /// What is wrong.
        source: SegmentationError,
    },
    /// A search range is not an interval.
    #[error("gap range from {min} to {max} is empty or not a number")]
    Range {
        /// Deepest penetration.
        min: f64,
        /// Widest gap.
        max: f64,
    },
}
