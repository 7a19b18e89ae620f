//! One slave facet against a master surface.

use crate::folded::unfold;
use crate::overlap::common_area;
use crate::{Segment, SegmentationError, SlaveFrame, segment_pair};
use nalgebra::Vector3;

/// A facet of the master surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterFacet {
    /// Number of the facet, returned in [`Segment::master_facet`].
    pub id: u32,
    /// Numbers of its nodes: facets with two of them in common are neighbours.
    pub nodes: [u32; 4],
    /// Positions, counter-clockwise seen from outside of the master.
    pub corners: [Vector3<f64>; 4],
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
    /// Parametric area of its segments (the slave facet has 4).
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
    /// Sum of the segments' parametric areas (the facet has 4).
    pub fn parametric_area(&self) -> f64 {
        self.segments.iter().map(Segment::parametric_area).sum()
    }
}

/// Segments a slave facet against the candidates of a master surface.
///
/// Two sheets (sets of candidates connected over edges) that cover the same part of the slave are no contact of both: of the one whose mean gap is larger in
/// size the whole is listed as hidden if the nearer ones cover most of it, as the far side of a body is. Where they cover less, and where one sheet is
/// folded, each part of the slave belongs to the nearer segment (by its mean gap): the other one is cut ([`crate::Provenance::Cut`]).
///
/// # Errors
/// Those of [`SlaveFrame::new`] and [`segment_pair`].
pub fn segment_facet(
    slave: [Vector3<f64>; 4],
    candidates: &[MasterFacet],
    range: GapRange,
) -> Result<FacetSegmentation, SegmentationError> {
    let frame = SlaveFrame::new(slave)?;
    let mut segments = Vec::new();
    let mut owner = Vec::new();
    let mut seen = Vec::new();
    for (index, facet) in candidates.iter().enumerate() {
        let start = segments.len();
        segment_pair(&frame, facet.id, &facet.corners, &mut segments)?;
        let mut k = start;
        while k < segments.len() {
            if range.meets(&segments[k]) {
                k += 1;
            } else {
                segments.remove(k);
            }
        }
        if segments.len() > start {
            owner.resize(segments.len(), seen.len());
            seen.push(index);
        }
    }
    let mut found = FacetSegmentation { frame, segments, hidden: Vec::new() };
    hide(&mut found, candidates, &seen, &owner);
    unfold(&mut found, candidates);
    Ok(found)
}

/// A sheet of which nearer ones cover more than this part is behind them.
const BEHIND: f64 = 0.5;

fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

/// Removes sheets that are behind others. `seen`: candidates with segments; `owner`: for every segment the position
/// in `seen`.
fn hide(found: &mut FacetSegmentation, candidates: &[MasterFacet], seen: &[usize], owner: &[usize]) {
    let mut parent: Vec<usize> = (0..seen.len()).collect();
    for a in 0..seen.len() {
        for b in 0..a {
            let (p, q) = (&candidates[seen[a]].nodes, &candidates[seen[b]].nodes);
            if p.iter().filter(|n| q.contains(n)).count() >= 2 {
                let (ra, rb) = (root(&mut parent, a), root(&mut parent, b));
                parent[ra.max(rb)] = ra.min(rb);
            }
        }
    }
    let sheet: Vec<usize> = owner.iter().map(|&o| root(&mut parent, o)).collect();
    if sheet.iter().all(|&s| s == sheet[0]) {
        return;
    }
    // Mean gap of every sheet.
    let mut gap = vec![(0.0, 0.0); seen.len()];
    for (segment, &s) in found.segments.iter().zip(&sheet) {
        let v = segment.vertices();
        let mean = v.iter().map(|v| v.gap).sum::<f64>() / v.len() as f64;
        let area = segment.image_area();
        gap[s].0 += area * mean;
        gap[s].1 += area;
    }
    let size: Vec<f64> = gap.iter().map(|(g, a)| if *a > 0.0 { (g / a).abs() } else { f64::INFINITY }).collect();
    let mut order: Vec<usize> = sheet.clone();
    order.sort_by(|&a, &b| size[a].total_cmp(&size[b]).then(a.cmp(&b)));
    order.dedup();
    let mut kept: Vec<usize> = Vec::new();
    for &s in &order {
        let mut covered = 0.0;
        for i in (0..sheet.len()).filter(|&i| sheet[i] == s) {
            for j in (0..sheet.len()).filter(|&j| kept.contains(&sheet[j])) {
                covered += common_area(&found.segments[i], &found.segments[j]);
            }
        }
        if covered <= BEHIND * gap[s].1 {
            kept.push(s);
        }
    }
    let mut position = 0;
    let hidden = &mut found.hidden;
    found.segments.retain(|segment| {
        let stays = kept.contains(&sheet[position]);
        position += 1;
        if !stays {
            hidden.push(HiddenFacet { id: segment.master_facet, parametric_area: segment.parametric_area() });
        }
        stays
    });
}
