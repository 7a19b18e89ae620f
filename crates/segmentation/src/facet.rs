//! Facets of the master, and the segmentation of one slave facet.

use crate::{Segment, SlaveFrame};
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

/// A master facet that is opposite the slave facet, but hidden behind another sheet of the master.
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
    /// Facets without a segment because a nearer sheet covers the same part of the slave.
    pub hidden: Vec<HiddenFacet>,
}

impl FacetSegmentation {
    /// Sum of the segments' parametric areas.
    pub fn parametric_area(&self) -> f64 {
        self.segments.iter().map(Segment::parametric_area).sum()
    }
}
