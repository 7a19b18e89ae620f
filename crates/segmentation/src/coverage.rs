//! The invariant of coverage: segments tile what lies opposite the master, without gap and without double cover.

use crate::overlap::common_area;
use crate::{FacetSegmentation, GapRange, MasterFacet, Provenance, Segment, SegmentationError, segment_pair};
use std::collections::BTreeMap;
use stoss_reference_element::FacetNodes;

/// A master edge inside the slave facet that only one of its two facets has in its segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenEdge {
    /// Number of the facet with a segment at the edge.
    pub facet: u32,
    /// Number of its neighbour, which has segments, but none at this edge.
    pub neighbour: u32,
    /// Ends in the slave's coordinates.
    pub ends: [[f64; 2]; 2],
}

/// Result of [`check_coverage`]. Areas are parametric: the slave facet has [`stoss_reference_element::FacetKind::area`].
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageReport {
    /// Area of the segments.
    pub covered: f64,
    /// The facet's area less `covered`: overhang, and what is missing.
    pub uncovered: f64,
    /// Master facets that lie opposite within the range, but have no segment, with the area that they would cover; of hidden ones what no nearer segment covers
    /// in their place.
    pub missing: Vec<(u32, f64)>,
    /// Area covered twice (measured in the image and scaled).
    pub double: f64,
    /// Interior edges that do not match.
    pub open_edges: Vec<OpenEdge>,
    /// Whether segments were cut because the master is folded. A cut is straight in the image; on a distorted slave facet the parametric areas
    /// then add up only as far as it is straight there too.
    pub cut: bool,
}

impl CoverageReport {
    /// Uncovered area that is opposite the master.
    pub fn uncovered_opposite(&self) -> f64 {
        self.missing.iter().map(|m| m.1).sum()
    }

    /// Whether the segments tile the overlap: nothing missing, no double cover, no open edge, not more than the whole
    /// facet.
    pub fn is_tiling(&self, tolerance: f64) -> bool {
        self.uncovered_opposite() <= tolerance
            && self.double <= tolerance
            && self.open_edges.is_empty()
            && (self.cut || self.uncovered >= -tolerance)
    }
}

/// Part of the slave's image that a hidden facet may leave uncovered: round-off of many differences of areas.
const HIDDEN_UNCOVERED: f64 = 1e-8;

/// Compares segments with the whole master surface.
///
/// `surface` has to contain every facet that may lie opposite, whatever search made the candidates: all of the
/// surface, or a generous part. The edges of the segments are matched with each other independently of how they were
/// made.
///
/// # Errors
/// The errors of [`segment_pair`].
pub fn check_coverage(
    found: &FacetSegmentation,
    surface: &[MasterFacet],
    range: GapRange,
) -> Result<CoverageReport, SegmentationError> {
    let covered = found.parametric_area();
    let whole = found.frame.kind().area();
    let has = |id: u32| found.segments.iter().any(|s| s.master_facet == id);
    let mut missing = Vec::new();
    let mut scratch = Vec::new();
    for facet in surface {
        if has(facet.id) {
            continue;
        }
        scratch.clear();
        segment_pair(&found.frame, facet.id, &facet.corners, &mut scratch)?;
        scratch.retain(|s| range.meets(s));
        let area: f64 = if found.hidden.iter().any(|h| h.id == facet.id) {
            let covered = |s: &Segment| found.segments.iter().map(|near| common_area(s, near)).sum::<f64>();
            let bare: f64 = scratch.iter().map(|s| s.image_area() - covered(s)).sum();
            if bare > HIDDEN_UNCOVERED * found.frame.image_area() {
                whole * bare / found.frame.image_area()
            } else {
                0.0
            }
        } else {
            scratch.iter().map(Segment::parametric_area).sum()
        };
        if area > 0.0 {
            missing.push((facet.id, area));
        }
    }
    let boxes: Vec<[[f64; 2]; 2]> = found.segments.iter().map(Segment::bounds).collect();
    let mut double = 0.0;
    for (i, a) in found.segments.iter().enumerate() {
        for (j, b) in found.segments.iter().enumerate().skip(i + 1) {
            if (0..2).all(|k| boxes[i][0][k] < boxes[j][1][k] && boxes[j][0][k] < boxes[i][1][k]) {
                double += common_area(a, b);
            }
        }
    }
    double *= whole / found.frame.image_area();
    let cut = found.segments.iter().flat_map(Segment::vertices).any(|v| v.provenance == Provenance::Cut);
    let open_edges = open_edges(found, surface);
    Ok(CoverageReport { covered, uncovered: whole - covered, missing, double, open_edges, cut })
}

/// The master edges of a segment's sides: side `k` runs from vertex `k` to the next.
fn side_edge(segment: &Segment, k: usize) -> Option<u8> {
    let v = segment.vertices();
    let kind = segment.master_map.kind();
    let (a, b) = (v[k].provenance, v[(k + 1) % v.len()].provenance);
    (0..kind.edge_count() as u8).find(|&edge| {
        let on = |p: Provenance| match p {
            Provenance::Master(c) => kind.side(edge as usize).contains(&(c as usize)),
            Provenance::Intersection { master_edge, .. } => master_edge == edge,
            Provenance::Slave(_) | Provenance::Cut => false,
        };
        on(a) && on(b)
    })
}

struct Side {
    facet: u32,
    ends: [[f64; 2]; 2],
}

fn open_edges(found: &FacetSegmentation, surface: &[MasterFacet]) -> Vec<OpenEdge> {
    let nodes: BTreeMap<u32, FacetNodes> = surface.iter().map(|f| (f.id, f.nodes)).collect();
    let mut sides: BTreeMap<[u32; 2], Vec<Side>> = BTreeMap::new();
    for segment in &found.segments {
        let Some(n) = nodes.get(&segment.master_facet) else { continue };
        let v = segment.vertices();
        for k in 0..v.len() {
            if let Some(edge) = side_edge(segment, k) {
                let [a, b] = n.kind().side(edge as usize).map(|corner| n[corner]);
                let ends = [v[k].slave, v[(k + 1) % v.len()].slave];
                sides.entry([a.min(b), a.max(b)]).or_default().push(Side { facet: segment.master_facet, ends });
            }
        }
    }
    let same = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() + (p[1] - q[1]).abs() <= 1e-12;
    let mut open = Vec::new();
    for list in sides.values() {
        for side in list {
            let [p, q] = side.ends;
            let other = list.iter().find(|o| o.facet != side.facet);
            let fits = |o: &&Side| o.facet != side.facet && same(o.ends[0], q) && same(o.ends[1], p);
            // An edge without length borders on nothing.
            if let Some(o) = other
                && !same(p, q)
                && !list.iter().any(|o| fits(&o))
            {
                open.push(OpenEdge { facet: side.facet, neighbour: o.facet, ends: side.ends });
            }
        }
    }
    open
}
