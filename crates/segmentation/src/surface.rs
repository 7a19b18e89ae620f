//! One slave facet against a master surface.

use crate::folded::unfold;
use crate::{Segment, SegmentationError, SlaveFrame, segment_pair};
use nalgebra::Vector3;
use stoss_reference_element::{FacetNodes, Nodal};

/// A facet of the master surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterFacet {
    /// Number of the facet, returned in [`Segment::master_facet`].
    pub id: u32,
    /// Numbers of its nodes: facets with two of them in common are neighbours.
    pub nodes: FacetNodes,
    /// Positions, counter-clockwise seen from outside of the master.
    pub corners: Nodal<Vector3<f64>>,
}

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

/// A master facet that lies opposite, but behind another sheet of the master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HiddenFacet {
    /// Number of the facet.
    pub id: u32,
    /// Parametric area of its segments (see [`SlaveFrame::kind`] for that of the facet).
    pub parametric_area: f64,
}

/// All segments of one slave facet.
#[derive(Clone, Debug)]
pub struct FacetSegmentation {
    /// The segmentation plane.
    pub frame: SlaveFrame,
    /// Segments in the order of the candidates.
    pub segments: Vec<Segment>,
    /// Facets left out because a nearer sheet covers the same part of the slave.
    pub hidden: Vec<HiddenFacet>,
}

impl FacetSegmentation {
    /// Sum of the segments' parametric areas.
    pub fn parametric_area(&self) -> f64 {
        self.segments.iter().map(Segment::parametric_area).sum()
    }
}

/// Segments a slave facet against the candidates of a master surface.
///
/// Two sheets that cover the same part of the slave are no contact of both, nor are two parts of a folded one: each part of the slave belongs to the segment
/// that is nearer there by the size of its mean gap, and the other one is cut ([`crate::Provenance::Cut`]). A facet of which nothing is left is listed as hidden,
/// as those on the far side of a body are.
///
/// # Errors
/// Those of [`SlaveFrame::new`] and [`segment_pair`].
pub fn segment_facet(
    slave: impl Into<Nodal<Vector3<f64>>>,
    candidates: &[MasterFacet],
    range: GapRange,
) -> Result<FacetSegmentation, SegmentationError> {
    let frame = SlaveFrame::new(slave)?;
    let mut segments = Vec::new();
    for facet in candidates {
        segment_pair(&frame, facet.id, &facet.corners, &mut segments)?;
    }
    segments.retain(|segment| range.meets(segment));
    let mut found = FacetSegmentation { frame, segments, hidden: Vec::new() };
    unfold(&mut found, candidates);
    Ok(found)
}
