//! One slave facet against a master surface.

use crate::folded::remove_hidden_parts;
use crate::{FacetSegmentation, MasterFacet, Segment, SegmentationError, SlaveFrame, segment_pair_within};
use nalgebra::Vector3;
use stoss_reference_element::Nodal;

/// Gaps along the slave's normal within which a master counts, lengths. A segment counts if its range of gaps meets
/// this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapRange {
    /// Deepest penetration, a negative number.
    pub min: f64,
    /// Widest distance.
    pub max: f64,
}

impl GapRange {
    /// Everything in front and behind.
    pub const ALL: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY };

    pub(crate) fn meets(&self, segment: &Segment) -> bool {
        let gaps = segment.vertices().iter().map(|v| v.gap);
        let (low, high) = gaps.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), g| (a.min(g), b.max(g)));
        low <= self.max && high >= self.min
    }
}

/// Segments a slave facet against the candidates of a master surface.
///
/// Two sheets that cover the same part of the slave are no contact of both, nor are two parts of a folded one: each part of the slave belongs to the segment
/// that is nearer there by the size of its mean gap, and the other one is cut ([`crate::Provenance::Cut`]). A facet of which nothing is left is listed as hidden,
/// as those on the far side of a body are.
///
/// # Errors
/// The errors of [`SlaveFrame::new`] and [`crate::segment_pair`].
pub fn segment_facet(
    slave: impl Into<Nodal<Vector3<f64>>>,
    candidates: &[MasterFacet],
    range: GapRange,
) -> Result<FacetSegmentation, SegmentationError> {
    segment_facet_within(SlaveFrame::new(slave)?, candidates, |_| 0, range)
}

/// Segments of a slave facet as of [`segment_facet`], for surfaces that end at planes of symmetry: `planes` are those that a node of the master lies in, a bit
/// each, as in [`SlaveFrame::with_planes`].
///
/// # Errors
/// The errors of [`segment_pair_within`].
pub fn segment_facet_within(
    frame: SlaveFrame,
    candidates: &[MasterFacet],
    planes: impl Fn(u32) -> u8,
    range: GapRange,
) -> Result<FacetSegmentation, SegmentationError> {
    let mut segments = Vec::new();
    for facet in candidates {
        segment_pair_within(&frame, facet.id, &facet.corners, &facet.nodes.map(&planes), &mut segments)?;
    }
    segments.retain(|segment| range.meets(segment));
    let mut found = FacetSegmentation { frame, segments, hidden: Vec::new() };
    remove_hidden_parts(&mut found, candidates);
    Ok(found)
}
