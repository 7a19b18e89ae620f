//! Errors of mortar integrals.

use stoss_contact::ContactError;
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
        /// Error of the segmentation.
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
    /// A surface is not usable.
    #[error(transparent)]
    Surface(#[from] ContactError),
    /// Segments do not cover the overlap exactly once: the master folds over itself, or the surfaces are too far
    /// apart for their projections.
    #[error(
        "the segments of {count} slave facets (first: {facet}) do not cover the overlap with the master exactly once"
    )]
    Coverage {
        /// Number of such facets.
        count: usize,
        /// Local number of the first.
        facet: u32,
    },
    /// A slave that has nothing of the master opposite it.
    #[error("no part of the slave surface lies opposite the master within a distance of {reach:e}")]
    Apart {
        /// Largest distance.
        reach: f64,
    },
    /// A slave of which no node can have a multiplier.
    #[error("every slave node is held by supports or by another tie already")]
    AllFixed,
    /// Slave nodes cannot be moved so that the surfaces fit.
    #[error(
        "no motion of the slave nodes closes the interface in {}: {residual:.1e} of the gap is left",
        ["x", "y", "z"][*component % 3]
    )]
    Fit {
        /// Cartesian component.
        component: usize,
        /// What is left, relative to the start.
        residual: f64,
    },
}
