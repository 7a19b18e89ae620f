//! Which facets are opposite each other, of those that have segments: not those that see each other edge-on, nor those that lie far behind each other where
//! an edge of one body is in the other one by little.

use crate::method::MortarContact;
use crate::surfaces::SurfaceSegmentation;
use nalgebra::Vector3;
use std::borrow::Cow;
use stoss_contact::ContactSurface;
use stoss_segmentation::{FacetSegmentation, Vertex};

/// Cosine of the angle between opposed normals below which a facet sees another one edge-on (75 degrees).
const EDGE_ON: f64 = 0.25;
/// A sheet faces a slave facet as much as another one if the cosine is at least this part of the other's.
const AS_MUCH: f64 = 0.9;
/// Sine of the angle to a sheet up to which a facet lies flat on it (3 degrees), so that the facets beyond its sharp edges are no part of the contact however they
/// lean.
const FLAT: f64 = 0.05;
/// Sine of the angle from which on it is one side of an edge that points at the sheet (12 degrees).
const AT_EDGE: f64 = 0.2;
/// A sheet touches a slave facet if the mean gap where they overlap is at most this part of the width of the overlap, beyond what they may move in the step. Over an
/// edge at which they touch only, it is half the tangent of the angle between them, more than that from 6 degrees on.
const TOUCHING: f64 = 0.05;
/// How much more a gap may close in a step than its velocity at the start makes it.
const HASTE: f64 = 2.0;
/// Cosine of the angle between the normals of two facets in the reference configuration from which on the edge between them is sharp, 34.4 degrees: a chamfer of
/// 45 degrees is, a round side of twelve facets is not. It lies between the edges of regular prisms with ten and with eleven sides, so that round-off
/// decides nothing.
const SHARP: f64 = 0.825;

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

/// Into which sides sharp edges divide the facets around each node of a surface: facets are on one side if edges at the node that are not sharp lead from one
/// to the other.
#[derive(Clone, Debug)]
pub(crate) struct Sides(Vec<[u32; 4]>);

impl Sides {
    pub fn new(surface: &ContactSurface, normals: &[Vector3<f64>]) -> Self {
        const NONE: u32 = u32::MAX;
        let facets = surface.local_facets();
        let corner = |facet: u32, node: u32| facets[facet as usize].iter().position(|&n| n == node);
        let mut sides = vec![[NONE; 4]; facets.len()];
        for (first, nodes) in facets.iter().enumerate() {
            for (a, &node) in nodes.iter().enumerate() {
                if sides[first][a] != NONE {
                    continue;
                }
                sides[first][a] = first as u32;
                let mut reached = vec![(first as u32, a)];
                while let Some((f, a)) = reached.pop() {
                    for e in [a, (a + 3) % 4].into_iter().filter_map(|edge| surface.neighbour(f, edge)) {
                        let Some(b) = corner(e, node) else { continue };
                        if sides[e as usize][b] == NONE && !is_sharp(normals, e as usize, f as usize) {
                            sides[e as usize][b] = first as u32;
                            reached.push((e, b));
                        }
                    }
                }
            }
        }
        Self(sides)
    }

    /// The side of a facet at its corner `corner`: the number of its first facet.
    pub fn of(&self, facet: u32, corner: usize) -> u32 {
        self.0[facet as usize][corner]
    }

    /// Whether two facets are on one side of a node that they share: no sharp edge is between them.
    pub fn join(&self, surface: &ContactSurface, e: usize, f: usize) -> bool {
        let facets = surface.local_facets();
        let same = |a: usize, b: usize| facets[e][a] == facets[f][b] && self.0[e][a] == self.0[f][b];
        (0..4).any(|a| (0..4).any(|b| same(a, b)))
    }
}

/// Which facets have a node at which the surface has several sides.
pub(crate) fn at_sharp_edges(surface: &ContactSurface, sides: &Sides) -> Vec<bool> {
    (0..surface.facets().len()).map(|f| beside(surface, f).any(|e| !sides.join(surface, e, f))).collect()
}

/// Facets that share a node with one, itself among them.
fn beside(surface: &ContactSurface, facet: usize) -> impl Iterator<Item = usize> {
    let around = surface.local_facets()[facet].iter().flat_map(|&n| surface.facets_around(n as usize));
    around.map(|&e| e as usize)
}

/// What a slave facet and one sheet of the master have to do with each other. Angles, depths and velocities are those at the start of the step: iterates
/// would come and go, and may be deep in each other.
#[derive(Clone, Debug)]
pub(crate) struct Overlap {
    sheet: u32,
    /// Cosine of the angle between the facet's normal and the opposed one of that facet of the sheet that faces it most.
    facing: f64,
    seen: Seen,
}

/// What holds for the rest of a step once it was seen in it, at an iterate that was only tried, too: what came and went would keep Newton from converging.
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

impl Overlap {
    /// Whether the facet faces the sheet, and not through the inside of a body.
    fn is_faced(&self) -> bool {
        self.facing > EDGE_ON && !self.seen.is_far_behind
    }
}

impl MortarContact {
    /// Whether no sharp edge is between two slave facets that share a node.
    fn is_smooth(&self, e: usize, f: usize) -> bool {
        self.slave_sides.join(&self.slave, e, f)
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
            let [mut facing, mut reach] = [-1.0_f64, 0.0_f64];
            for segment in segments() {
                let opposed = -area_vector(&self.master, segment.master_facet, &self.start);
                let opposed = opposed.try_normalize(0.0).unwrap_or_default();
                let cosine = normal.dot(&opposed);
                facing = facing.max(cosine);
                for vertex in segment.vertices() {
                    let approach =
                        self.velocity_between(slave_facet as u32, segment.master_facet, vertex).dot(&opposed);
                    reach = reach.max(HASTE * self.step_size * approach / cosine.max(EDGE_ON));
                }
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
                touches: gap_n <= (near + reach) * width
                    || gap <= near * width
                    || before.is_some_and(|seen| seen.touches),
                meets: least_n <= near + reach || least <= near || before.is_some_and(|seen| seen.meets),
            };
            Overlap { sheet, facing, seen }
        };
        sheets.into_iter().map(overlap).collect()
    }

    /// Velocity of the slave relative to the master where a vertex is, at the start of the step.
    fn velocity_between(&self, slave_facet: u32, master_facet: u32, vertex: &Vertex) -> Vector3<f64> {
        if self.velocity.len() != self.start.len() {
            return Vector3::zeros();
        }
        let slave = self.slave.patch(slave_facet, &self.velocity).point(vertex.slave);
        slave - self.master.patch(master_facet, &self.velocity).point(vertex.master)
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
    pub(crate) fn opposite(&self, segments: &SurfaceSegmentation, overlaps: &[Vec<Overlap>]) -> Vec<bool> {
        let faces: Vec<bool> = overlaps.iter().map(|all| all.iter().any(Overlap::is_faced)).collect();
        let mut opposite = faces.clone();
        let mut reached: Vec<usize> = (0..faces.len()).filter(|&f| faces[f]).collect();
        while let Some(f) = reached.pop() {
            for e in beside(&self.slave, f).filter(|&e| self.is_smooth(e, f)) {
                let is_edge_on = !opposite[e] && !segments.facets[e].segments.is_empty();
                if is_edge_on && !beside(&self.slave, e).any(|d| faces[d] && !self.is_smooth(d, e)) {
                    opposite[e] = true;
                    reached.push(e);
                }
            }
        }
        opposite
    }

    /// The segments of a slave facet with those sheets of the master that it may touch, and the part of its weight with which it counts. Where it faces none those
    /// sheets count that the facets beside it may touch.
    pub(crate) fn counted<'a>(
        &self,
        segments: &'a SurfaceSegmentation,
        overlaps: &[Vec<Overlap>],
        slave_facet: usize,
    ) -> Counted<'a> {
        let found = &segments.facets[slave_facet];
        let own = &overlaps[slave_facet];
        let is_edge_on = |o: &Overlap| o.facing <= EDGE_ON && !o.seen.is_far_behind;
        let touched = self.touched(overlaps, slave_facet);
        let part = if touched.is_empty() { 1.0 } else { touched.iter().map(|sheet| sheet.1).fold(0.0, f64::max) };
        let mut sheets: Vec<u32> = touched.iter().map(|sheet| sheet.0).collect();
        if sheets.is_empty() {
            let around = beside(&self.slave, slave_facet);
            let around = around.filter(|&e| self.is_smooth(e, slave_facet));
            let touched: Vec<u32> = around.flat_map(|e| self.touched(overlaps, e)).map(|sheet| sheet.0).collect();
            sheets.extend(own.iter().filter(|o| is_edge_on(o)).map(|o| o.sheet).filter(|s| touched.contains(s)));
        }
        if own.iter().all(|o| sheets.contains(&o.sheet)) {
            return Counted { found: Cow::Borrowed(found), part };
        }
        let mut counted = found.clone();
        counted.segments.retain(|segment| sheets.contains(&self.master_sheets[segment.master_facet as usize]));
        Counted { found: Cow::Owned(counted), part }
    }

    /// Sheets that a slave facet faces and may touch in the step, those near it or near a facet beside it, with the part of its weight with which it counts. The
    /// others only if nothing beyond a sharp edge, of the slave or of the master, is near one unless they meet it, too, and none lies flat on its sheet that faces
    /// it more. Over the rim of a slab the bottom of a block sees the slab's side, and the side of a block that stands on a floor sees the next wall; their wide gaps
    /// are no gaps of the contact before the edge.
    ///
    /// Both sides of an edge that points at one sheet count, their facets at the edge by the cosines of their angles to it: with sides of one size at a right angle, as
    /// with the three sides of a corner, the force has then the direction of the sheet's normal. The less upright one fades out as the other one lies down.
    fn touched(&self, overlaps: &[Vec<Overlap>], slave_facet: usize) -> Vec<(u32, f64)> {
        let faced = |f: usize| overlaps[f].iter().filter(|o| o.is_faced());
        let part_of = |overlap: &Overlap| {
            let (mut part, mut touches) = (1.0_f64, false);
            for e in beside(&self.slave, slave_facet) {
                let beyond_edge = !self.is_smooth(e, slave_facet);
                for other in faced(e) {
                    let same = other.sheet == overlap.sheet;
                    if same && !beyond_edge {
                        touches |= other.seen.touches;
                    } else if other.seen.touches && !overlap.seen.meets {
                        part = 0.0;
                    } else {
                        part = part.min(share(overlap.facing, other.facing, same));
                    }
                }
            }
            if touches && part == 0.0 { 1.0 } else { part }
        };
        faced(slave_facet).map(|o| (o.sheet, part_of(o))).filter(|sheet| sheet.1 > 0.0).collect()
    }
}

/// What counts of a slave facet.
#[derive(Clone, Debug)]
pub(crate) struct Counted<'a> {
    /// The segments.
    pub found: Cow<'a, FacetSegmentation>,
    /// Which part of their weight, over 0: the largest of all sheets that count. Pressures of nodes at such an edge stand for this part of the area.
    pub part: f64,
}

/// Part of its weight with which a facet counts that has another one before it beyond an edge, by the cosines of the angles to their sheets, `same` if they are one.
/// Over an edge of the master it counts wholly or not at all: the normal of the force is the slave's.
fn share(facing: f64, other: f64, same: bool) -> f64 {
    if facing >= AS_MUCH * other {
        return if same { (facing / other).min(1.0) } else { 1.0 };
    }
    let sine = (1.0 - other * other).max(0.0).sqrt();
    let upright = ((sine - FLAT) / (AT_EDGE - FLAT)).clamp(0.0, 1.0);
    match same {
        true => facing / other * upright,
        false => upright.round(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    /// How many sides the nodes of the barrel of a regular prism have.
    fn sides_of_prism(edges: u32, turn: [f64; 3], first: u32) -> Vec<usize> {
        let turn = Rotation3::from_scaled_axis(Vector3::from(turn));
        let corner = |k: u32| {
            let angle = f64::from(k / 2) * std::f64::consts::TAU / f64::from(edges);
            turn * Vector3::new(angle.cos(), angle.sin(), f64::from(k % 2))
        };
        let q: Vec<f64> = (0..2 * edges).flat_map(|k| <[f64; 3]>::from(corner(k))).collect();
        let facet = |f: u32| [2 * f, 2 * f + 2, 2 * f + 3, 2 * f + 1].map(|k| k % (2 * edges));
        let facets: Vec<[u32; 4]> = (0..edges).map(|f| facet((f + first) % edges)).collect();
        let surface = ContactSurface::new("slave", &facets, &q).unwrap();
        let sides = Sides::new(&surface, &unit_normals(&surface, &q));
        let count = |node: usize| {
            let corner = |f: u32| surface.local_facets()[f as usize].iter().position(|&n| n as usize == node).unwrap();
            let mut found: Vec<u32> = surface.facets_around(node).iter().map(|&f| sides.of(f, corner(f))).collect();
            found.sort_unstable();
            found.dedup();
            found.len()
        };
        (0..surface.nodes().len()).map(count).collect()
    }

    proptest! {
        #[test]
        fn round_off_decides_on_no_side(turn in prop::array::uniform3(-3.0f64..3.0), first in 0_u32..9) {
            for (edges, expected) in [(4, 2), (8, 2), (10, 2), (11, 1), (12, 1)] {
                let sides = sides_of_prism(edges, turn, first % edges);
                prop_assert!(sides.iter().all(|n| *n == expected), "{edges}: {sides:?}");
            }
        }
    }

    /// Round both ways with twelve facets a turn: facets that share but a node are 41 degrees apart, those that share an edge 30.
    #[test]
    fn a_ball_has_no_sharp_edges() {
        let slope = std::f64::consts::FRAC_PI_6.tan();
        let node = |k: u32| Vector3::new(slope * (f64::from(k % 3) - 1.0), slope * (f64::from(k / 3) - 1.0), 1.0);
        let q: Vec<f64> = (0..9).flat_map(|k| <[f64; 3]>::from(node(k).normalize())).collect();
        let facets = [0, 1, 3, 4].map(|k| [k, k + 1, k + 4, k + 3]);
        let surface = ContactSurface::new("slave", &facets, &q).unwrap();
        let normals = unit_normals(&surface, &q);
        assert!(is_sharp(&normals, 0, 3) && !is_sharp(&normals, 0, 1));
        let sides = Sides::new(&surface, &normals);
        assert!((0..4).all(|e| (0..4).all(|f| sides.join(&surface, e, f))));
        assert_eq!(at_sharp_edges(&surface, &sides), [false; 4]);
    }

    /// Of three planes that meet at a node two have a sharp edge, the third one none with either: all are on one side, whichever comes first.
    #[test]
    fn sides_do_not_depend_on_the_order_of_facets() {
        let normals = [[-0.5, -0.1, 1.0], [0.0, 0.25, 1.0], [0.5, -0.1, 1.0]].map(Vector3::from);
        let [a, b, c] = [(0, 1), (1, 2), (2, 0)].map(|(k, l)| normals[k].cross(&normals[l]));
        let x = [Vector3::zeros(), a, b, c, c + a, a + b, b + c];
        let q: Vec<f64> = x.iter().flatten().copied().collect();
        for facets in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]] {
            let facets = facets.map(|k: usize| [[0, 1, 4, 3], [0, 2, 5, 1], [0, 3, 6, 2]][k]);
            let surface = ContactSurface::new("slave", &facets, &q).unwrap();
            let normals = unit_normals(&surface, &q);
            assert_eq!((0..3).filter(|&f| is_sharp(&normals, f, (f + 1) % 3)).count(), 1);
            let sides = Sides::new(&surface, &normals);
            assert!((0..3).all(|f| sides.of(f, 0) == 0), "{sides:?}");
        }
    }
}
