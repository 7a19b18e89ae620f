//! Which facets are opposite each other, of those that have segments: not those that see each other edge-on, nor those that lie far behind each other where
//! an edge of one body is in the other one by little.

use crate::method::MortarContact;
use crate::slot::SHARP;
use crate::surfaces::SurfaceSegmentation;
use nalgebra::Vector3;
use std::borrow::Cow;
use stoss_contact::ContactSurface;
use stoss_segmentation::{FacetSegmentation, Segment, Vertex};

/// Cosine of the angle between opposed normals below which a facet sees another one edge-on (75 degrees).
const EDGE_ON: f64 = 0.25;
/// A sheet faces a slave facet as much as another one if the cosine is at least this part of the other's.
const AS_MUCH: f64 = 0.9;
/// A sheet touches a slave facet if the mean gap where they overlap is at most this part of the width of the overlap, beyond what they may move in the step. Over an
/// edge at which they touch only, it is half the tangent of the angle between them, more than that from 6 degrees on.
const TOUCHING: f64 = 0.05;

/// `d1 x d2` of the diagonals of a facet at positions `q`, an area.
fn area_vector(surface: &ContactSurface, facet: u32, q: &[f64]) -> Vector3<f64> {
    let x = surface.patch(facet, q).corners;
    (x[2] - x[0]).cross(&(x[3] - x[1]))
}

/// Unit normals of all facets at positions `q`; zero where there is none.
pub(crate) fn unit_normals(surface: &ContactSurface, q: &[f64]) -> Vec<Vector3<f64>> {
    let facets = 0..surface.facets().len() as u32;
    facets.map(|f| area_vector(surface, f, q).try_normalize(0.0).unwrap_or_default()).collect()
}

/// Whether an edge between facets with these reference normals is sharp.
pub(crate) fn is_sharp(normals: &[Vector3<f64>], e: usize, f: usize) -> bool {
    normals[e].dot(&normals[f]) <= SHARP
}

/// Numbers of the sheets into which sharp edges divide a surface, one a facet; reference normals.
pub(crate) fn sheets(surface: &ContactSurface, normals: &[Vector3<f64>]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut sheets = vec![NONE; normals.len()];
    for first in 0..normals.len() {
        if sheets[first] != NONE {
            continue;
        }
        sheets[first] = first as u32;
        let mut reached = vec![first];
        while let Some(f) = reached.pop() {
            for e in (0..4).filter_map(|edge| surface.neighbour(f as u32, edge)).map(|e| e as usize) {
                if sheets[e] == NONE && !is_sharp(normals, e, f) {
                    sheets[e] = first as u32;
                    reached.push(e);
                }
            }
        }
    }
    sheets
}

/// Which facets have a node of a sharp edge of the surface.
pub(crate) fn at_sharp_edges(surface: &ContactSurface, normals: &[Vector3<f64>]) -> Vec<bool> {
    let is_at = |f: usize| beside(surface, f).any(|e| is_sharp(normals, e, f));
    (0..normals.len()).map(is_at).collect()
}

/// Facets that share a node with one, itself among them.
fn beside(surface: &ContactSurface, facet: usize) -> impl Iterator<Item = usize> {
    let around = surface.local_facets()[facet].iter().flat_map(|&n| surface.facets_around(n as usize));
    around.map(|&e| e as usize)
}

/// What a slave facet and one sheet of the master have to do with each other. Angles and depths are those at the start of the step: iterates would come and go,
/// and may be deep in each other.
#[derive(Clone, Debug)]
pub(crate) struct Overlap {
    sheet: u32,
    /// Cosine of the angle between the facet's normal and the opposed one of that facet of the sheet that faces it most.
    facing: f64,
    seen: Seen,
}

/// What holds for the rest of a step once it was seen in it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seen {
    /// Both the facet and the sheet end at a sharp edge there, and the sheet lies behind the facet deeper than it overlaps it. An edge of the slave that
    /// is in the master by little, at a block that tips over the rim of a slab, say, has facets beyond it that see the far side of the master through
    /// its inside: what resolves such an overlap is the contact across it.
    is_far_behind: bool,
    /// They touch where they overlap, or may before the step is over.
    touches: bool,
    /// They do so somewhere, at an edge, say.
    meets: bool,
}

impl MortarContact {
    /// Whether a slave facet with this unit normal and a master facet face each other.
    fn face(&self, normal: &Vector3<f64>, master_facet: u32, q: &[f64]) -> bool {
        self.facing(normal, master_facet, q) > EDGE_ON
    }

    /// Cosine of the angle between a unit normal and the opposed one of a master facet.
    fn facing(&self, normal: &Vector3<f64>, master_facet: u32, q: &[f64]) -> f64 {
        let other = area_vector(&self.master, master_facet, q);
        let size = other.norm();
        if size > 0.0 { -normal.dot(&other) / size } else { 0.0 }
    }

    /// Overlaps of every slave facet with all sheets.
    pub(crate) fn overlaps(&self, segments: &SurfaceSegmentation) -> Vec<Vec<Overlap>> {
        let facets = segments.facets.iter().enumerate();
        facets.map(|(slave_facet, found)| self.overlaps_of(found, slave_facet)).collect()
    }

    fn overlaps_of(&self, found: &FacetSegmentation, slave_facet: usize) -> Vec<Overlap> {
        let slave = self.slave.patch(slave_facet as u32, &self.start);
        let normal = area_vector(&self.slave, slave_facet as u32, &self.start).try_normalize(0.0).unwrap_or_default();
        let length = found.frame.image_area().sqrt();
        let mut sheets: Vec<u32> = found.segments.iter().map(|s| self.master_sheets[s.master_facet as usize]).collect();
        sheets.sort_unstable();
        sheets.dedup();
        let overlap = |sheet: u32| {
            let segments = || found.segments.iter().filter(|s| self.master_sheets[s.master_facet as usize] == sheet);
            let masters = || segments().map(|s| s.master_facet);
            // Breadth of the overlap, all of the facet's or little where only an edge is over it; gaps of the same points at the start of the step and now,
            // times that.
            let [mut width, mut gap_n, mut gap] = [0.0; 3];
            let [mut least_n, mut least] = [f64::INFINITY; 2];
            for segment in segments() {
                let master = self.master.patch(segment.master_facet, &self.start);
                let start = |v: &Vertex| (master.point(v.master) - slave.point(v.slave)).dot(&normal);
                let vertices = segment.vertices();
                let share = segment.image_area() / length;
                width += share;
                least_n = vertices.iter().map(start).fold(least_n, f64::min);
                least = vertices.iter().map(|v| v.gap).fold(least, f64::min);
                gap_n += share * vertices.iter().map(start).sum::<f64>() / vertices.len() as f64;
                gap += share * vertices.iter().map(|v| v.gap).sum::<f64>() / vertices.len() as f64;
            }
            let near = TOUCHING * width;
            let ends = || self.slave_edges[slave_facet] && masters().any(|m| self.master_edges[m as usize]);
            let before = self.seen.get(&(slave_facet, sheet));
            let seen = Seen {
                is_far_behind: before.map_or_else(|| -gap_n > width * width && ends(), |seen| seen.is_far_behind),
                touches: gap_n <= (near + self.reach) * width
                    || gap <= near * width
                    || before.is_some_and(|seen| seen.touches),
                meets: least_n <= near + self.reach || least <= near || before.is_some_and(|seen| seen.meets),
            };
            let facing = masters().map(|m| self.facing(&normal, m, &self.start)).fold(-1.0, f64::max);
            Overlap { sheet, facing, seen }
        };
        sheets.into_iter().map(overlap).collect()
    }

    /// Keeps what was seen for the rest of the step.
    pub(crate) fn remember_overlaps(&mut self) {
        let Some(integrated) = &self.integrated else { return };
        for (slave_facet, overlaps) in integrated.overlaps.iter().enumerate() {
            self.seen.extend(overlaps.iter().map(|o| ((slave_facet, o.sheet), o.seen)));
        }
    }

    /// Which slave facets are opposite the master. One that sees it edge-on only would have gaps as wide as the search reaches. It is opposite if it goes over
    /// smoothly, over other such facets or at once, into one that faces the master, and lies beyond no sharp edge from one: the side of a
    /// block that stands on the master and leans a little is not, nor a surface that is edge-on as a whole.
    pub(crate) fn opposite(&self, segments: &SurfaceSegmentation, overlaps: &[Vec<Overlap>], q: &[f64]) -> Vec<bool> {
        let faces = |(slave_facet, found): (usize, &FacetSegmentation)| {
            let normal = found.frame.normal();
            let is_near = |segment: &Segment| {
                let sheet = self.master_sheets[segment.master_facet as usize];
                overlaps[slave_facet].iter().any(|o| o.sheet == sheet && !o.seen.is_far_behind)
            };
            found.segments.iter().any(|s| self.face(&normal, s.master_facet, q) && is_near(s))
        };
        let faces: Vec<bool> = segments.facets.iter().enumerate().map(faces).collect();
        let is_sharp = |e: usize, f: usize| is_sharp(&self.reference_normals, e, f);
        let mut opposite = faces.clone();
        let mut reached: Vec<usize> = (0..faces.len()).filter(|&f| faces[f]).collect();
        while let Some(f) = reached.pop() {
            for e in beside(&self.slave, f).filter(|&e| !is_sharp(e, f)) {
                let is_edge_on = !opposite[e] && !segments.facets[e].segments.is_empty();
                if is_edge_on && !beside(&self.slave, e).any(|d| faces[d] && is_sharp(d, e)) {
                    opposite[e] = true;
                    reached.push(e);
                }
            }
        }
        opposite
    }

    /// The segments of a slave facet with those sheets of the master that it may touch. Where it faces none those count that the facets beside it may touch.
    pub(crate) fn counted<'a>(
        &self,
        segments: &'a SurfaceSegmentation,
        overlaps: &[Vec<Overlap>],
        slave_facet: usize,
    ) -> Cow<'a, FacetSegmentation> {
        let found = &segments.facets[slave_facet];
        let own = &overlaps[slave_facet];
        let is_edge_on = |o: &Overlap| o.facing <= EDGE_ON && !o.seen.is_far_behind;
        let mut sheets = self.touched(overlaps, slave_facet);
        if sheets.is_empty() {
            let around = beside(&self.slave, slave_facet);
            let around = around.filter(|&e| !is_sharp(&self.reference_normals, e, slave_facet));
            let touched: Vec<u32> = around.flat_map(|e| self.touched(overlaps, e)).collect();
            sheets.extend(own.iter().filter(|o| is_edge_on(o)).map(|o| o.sheet).filter(|s| touched.contains(s)));
        }
        if own.iter().all(|o| sheets.contains(&o.sheet)) {
            return Cow::Borrowed(found);
        }
        let mut counted = found.clone();
        counted.segments.retain(|segment| sheets.contains(&self.master_sheets[segment.master_facet as usize]));
        Cow::Owned(counted)
    }

    /// Sheets that a slave facet faces and may touch in the step: those near it or near a facet beside it. The others only if nothing beyond a sharp edge, of the
    /// slave or of the master, is faced more by it or a facet beside it, nor near one unless they meet it, too. Over the rim of a slab the bottom of a block sees
    /// the slab's side, and the side of a block that stands on a floor sees the next wall; their wide gaps are no gaps of the contact before the edge.
    fn touched(&self, overlaps: &[Vec<Overlap>], slave_facet: usize) -> Vec<u32> {
        let faced = |f: usize| overlaps[f].iter().filter(|o| o.facing > EDGE_ON && !o.seen.is_far_behind);
        let counts = |overlap: &Overlap| {
            let mut others = Vec::new();
            for e in beside(&self.slave, slave_facet) {
                let beyond_edge = is_sharp(&self.reference_normals, e, slave_facet);
                for other in faced(e) {
                    if beyond_edge || other.sheet != overlap.sheet {
                        others.push(other);
                    } else if other.seen.touches {
                        return true;
                    }
                }
            }
            let allows = |other: &&Overlap| {
                overlap.facing >= AS_MUCH * other.facing && (overlap.seen.meets || !other.seen.touches)
            };
            others.iter().all(allows)
        };
        faced(slave_facet).filter(|o| counts(o)).map(|o| o.sheet).collect()
    }
}
