//! Which facets may be opposite each other in a step, and their segments.
//!
//! The pairs are found once a step, generously: a pair without overlap has no weight, so that too long a list changes nothing, and within the step no pair comes or
//! goes by a search.

use crate::MortarError;
use crate::surfaces::{corners, master_facet, region};
use stoss_contact::ContactSurface;
use stoss_geometry::{Aabb, BoundingVolumeTree};
use stoss_segmentation::{FacetSegmentation, GapRange, MasterFacet, SlaveFrame, segment_facet};

/// Master facets that each slave facet may meet, ascending.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates(Vec<Vec<u32>>);

/// How far facets are looked for along the slave's normal, and `reach` beyond that in all directions; lengths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchRange {
    pub depth: f64,
    pub far: f64,
    pub reach: f64,
}

impl Candidates {
    pub fn find(
        slave: &ContactSurface,
        master: &ContactSurface,
        q: &[f64],
        range: SearchRange,
    ) -> Result<Self, MortarError> {
        let boxes: Vec<Aabb> =
            (0..master.facets().len() as u32).map(|f| Aabb::from_points(&corners(master, f, q))).collect();
        let tree = BoundingVolumeTree::build(&boxes);
        let bounds = tree.bounds();
        let gaps = GapRange { min: -range.depth, max: range.far };
        let of_facet = |facet: u32| {
            let x = corners(slave, facet, q);
            let normal = SlaveFrame::new(x).map_err(|source| MortarError::Segmentation { facet, source })?.normal();
            let mut found = Vec::new();
            tree.query(&region(&x, normal, &bounds, gaps).inflated(range.reach), |f| found.push(f as u32));
            found.sort_unstable();
            Ok::<_, MortarError>(found)
        };
        Ok(Self((0..slave.facets().len() as u32).map(of_facet).collect::<Result<_, _>>()?))
    }

    /// Segments of a slave facet at positions `q`.
    pub fn segment(
        &self,
        slave: &ContactSurface,
        master: &ContactSurface,
        facet: u32,
        q: &[f64],
    ) -> Result<FacetSegmentation, MortarError> {
        let near: Vec<MasterFacet> = self.0[facet as usize].iter().map(|&f| master_facet(master, f, q)).collect();
        segment_facet(corners(slave, facet, q), &near, GapRange::ALL)
            .map_err(|source| MortarError::Segmentation { facet, source })
    }
}
