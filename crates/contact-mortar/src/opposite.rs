//! Which facets are opposite each other, of those that have segments: not those that see each other edge-on.

use crate::method::MortarContact;
use crate::slot::SHARP;
use crate::surfaces::SurfaceSegmentation;
use nalgebra::Vector3;
use std::borrow::Cow;
use stoss_contact::ContactSurface;
use stoss_segmentation::FacetSegmentation;

/// Cosine of the angle between opposed normals below which a facet sees another one edge-on (75 degrees).
const EDGE_ON: f64 = 0.25;

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
fn is_sharp(normals: &[Vector3<f64>], e: usize, f: usize) -> bool {
    normals[e].dot(&normals[f]) <= SHARP
}

impl MortarContact {
    /// Whether a slave facet with this unit normal and a master facet face each other.
    fn face(&self, normal: &Vector3<f64>, master_facet: u32, q: &[f64]) -> bool {
        let other = area_vector(&self.master, master_facet, q);
        -normal.dot(&other) > EDGE_ON * other.norm()
    }

    /// Which slave facets are opposite the master. One that sees it edge-on only would have gaps as wide as the search reaches. It is opposite if it goes over
    /// smoothly, over other such facets or at once, into one that faces the master, and lies beyond no sharp edge from one: the side of a
    /// block that stands on the master and leans a little is not, nor a surface that is edge-on as a whole.
    pub(crate) fn opposite(&self, segments: &SurfaceSegmentation, q: &[f64]) -> Vec<bool> {
        let faces = |found: &FacetSegmentation| {
            found.segments.iter().any(|s| self.face(&found.frame.normal(), s.master_facet, q))
        };
        let faces: Vec<bool> = segments.facets.iter().map(faces).collect();
        let is_sharp = |e: usize, f: usize| is_sharp(&self.reference_normals, e, f);
        let mut opposite = faces.clone();
        let mut reached: Vec<usize> = (0..faces.len()).filter(|&f| faces[f]).collect();
        while let Some(f) = reached.pop() {
            for e in self.beside(f).filter(|&e| !is_sharp(e, f)) {
                let is_edge_on = !opposite[e] && !segments.facets[e].segments.is_empty();
                if is_edge_on && !self.beside(e).any(|d| faces[d] && is_sharp(d, e)) {
                    opposite[e] = true;
                    reached.push(e);
                }
            }
        }
        opposite
    }

    /// The segments of a slave facet but for those with walls: master facets that it sees edge-on, and that go over into those that face it by a sharp edge only;
    /// if none does, into those that face the slave facets beside it. Beyond the edge of a block that stands on it, it sees the block's side as soon as that
    /// bulges; the side's wide gaps are no gaps of the contact below the block. The positions at the start of the step decide, so that iterates do not
    /// come and go.
    pub(crate) fn without_walls<'a>(
        &self,
        segments: &'a SurfaceSegmentation,
        slave_facet: usize,
    ) -> Cow<'a, FacetSegmentation> {
        let found = &segments.facets[slave_facet];
        let facing = self.facing(found, slave_facet);
        if facing.len() == found.segments.len() {
            return Cow::Borrowed(found);
        }
        let has = |facet: u32| found.segments.iter().any(|s| s.master_facet == facet);
        let mut reached = facing;
        if reached.is_empty() {
            for e in self.beside(slave_facet).filter(|&e| !is_sharp(&self.reference_normals, e, slave_facet)) {
                reached.extend(self.facing(&segments.facets[e], e));
            }
        }
        let mut next = 0;
        while next < reached.len() {
            let facet = reached[next];
            next += 1;
            for neighbour in (0..4).filter_map(|edge| self.master.neighbour(facet, edge)) {
                let is_wall = is_sharp(&self.master_normals, facet as usize, neighbour as usize);
                if !is_wall && !reached.contains(&neighbour) && has(neighbour) {
                    reached.push(neighbour);
                }
            }
        }
        let mut without = found.clone();
        without.segments.retain(|segment| reached.contains(&segment.master_facet));
        Cow::Owned(without)
    }

    /// Master facets that face a slave facet at the start of the step, once for each segment.
    fn facing(&self, found: &FacetSegmentation, slave_facet: usize) -> Vec<u32> {
        let normal = area_vector(&self.slave, slave_facet as u32, &self.start).try_normalize(0.0).unwrap_or_default();
        let masters = found.segments.iter().map(|s| s.master_facet);
        masters.filter(|&facet| self.face(&normal, facet, &self.start)).collect()
    }

    /// Slave facets that share a node with one, itself among them.
    fn beside(&self, facet: usize) -> impl Iterator<Item = usize> {
        let around = self.slave.local_facets()[facet].iter().flat_map(|&n| self.slave.facets_around(n as usize));
        around.map(|&e| e as usize)
    }
}
