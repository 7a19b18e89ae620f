//! Which facets may be opposite each other in a step, and their segments.
//!
//! The pairs are found once a step, generously: a pair without overlap has no weight, so that too long a list changes nothing, and within the step no pair comes or
//! goes by a search.

use crate::MortarError;
use crate::positions::Positions;
use crate::surfaces::{corners, master_facet, region};
use std::collections::HashMap;
use stoss_contact::{ContactSurface, SurfaceTree};
use stoss_geometry::Aabb;
use stoss_segmentation::{FacetSegmentation, GapRange, MasterFacet, SlaveFrame, segment_facet_within};

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
        tree: &SurfaceTree,
        q: &[f64],
        range: SearchRange,
    ) -> Result<Self, MortarError> {
        // Where the facets may be now of which the tree knows where they were.
        let (shift, excess) = tree.motion(master, q);
        let fitted = tree.tree().bounds();
        let bounds = Aabb { min: fitted.min + shift, max: fitted.max + shift }.inflated(excess);
        let gaps = GapRange { min: -range.depth, max: range.far };
        let of_facet = |facet: u32| {
            let x = corners(slave, facet, q);
            let normal = SlaveFrame::new(x).map_err(|source| MortarError::Segmentation { facet, source })?.normal();
            let mut found = Vec::new();
            let region = region(&x, normal, &bounds, gaps).inflated(range.reach);
            let then = Aabb { min: region.min - shift, max: region.max - shift }.inflated(excess);
            tree.tree().query(&then, |f| found.push(f as u32));
            found.retain(|&f| Aabb::from_points(&corners(master, f, q)).overlaps(&region));
            found.sort_unstable();
            Ok::<_, MortarError>(found)
        };
        Ok(Self((0..slave.facets().len() as u32).map(of_facet).collect::<Result<_, _>>()?))
    }

    /// The nodes that a step looks at: those of the slave and of all master facets that it may meet, ascending.
    pub fn nodes(&self, slave: &ContactSurface, master: &ContactSurface) -> Vec<u32> {
        let mut facets: Vec<u32> = self.0.iter().flatten().copied().collect();
        facets.sort_unstable();
        facets.dedup();
        let of_master = facets.iter().flat_map(|&f| master.facets()[f as usize]);
        let mut nodes: Vec<u32> = slave.nodes().iter().copied().chain(of_master).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Segments of a slave facet at positions `q`; `planes` of symmetry that nodes lie in, a bit each.
    pub fn segment(
        &self,
        slave: &ContactSurface,
        master: &ContactSurface,
        facet: u32,
        planes: &HashMap<u32, u8>,
        q: Positions<'_>,
    ) -> Result<FacetSegmentation, MortarError> {
        let near: Vec<MasterFacet> = self.0[facet as usize].iter().map(|&f| master_facet(master, f, q)).collect();
        let of = |node: u32| if planes.is_empty() { 0 } else { planes.get(&node).copied().unwrap_or_default() };
        SlaveFrame::new(corners(slave, facet, q))
            .map(|frame| frame.with_planes(&slave.facets()[facet as usize].map(of)))
            .and_then(|frame| segment_facet_within(frame, &near, of, GapRange::ALL))
            .map_err(|source| MortarError::Segmentation { facet, source })
    }
}
