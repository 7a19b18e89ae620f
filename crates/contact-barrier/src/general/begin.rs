//! Which contacts begin. It is asked where they have no energy, so the answers may be sharp; theory/barrier#begin.

use super::history::{Key, Rubbed, Spring};
use crate::proximity::{Candidate, nearest};
use crate::{Interactions, Skin};
use nalgebra::Vector3;
use stoss_geometry::{ClosestPair, PairFeature, closest, combine};

/// Cosine between the outward normal at a point of integration and the direction to what it is to act on, from which on it does.
const FACING: f64 = 0.3;

/// Cosine between a direction and the normal of a face, or of the normals of two faces of which one is turned around, from which on they are flush.
const FLUSH: f64 = 0.9;

/// Cosines for edges: how far the closest direction may lie outside of the cone of normals of an edge, and the least by which the two sides of an edge turn away.
const OUTSIDE: f64 = 0.1;
const TURN: f64 = 0.1;

/// Angle between two faces, in rad, from which on the edge or corner in which one of them ends has all of the points.
const TILTED: f64 = 0.02;

/// The part of the thickness in which that acts which is not needed as long as other contacts carry: corners that are flush, and edges of the mesh of flat surfaces.
const LAST: f64 = 0.3;

/// Skin, candidates and both configurations, the start of the step and its predictor, by which it is decided what begins to act.
pub(super) struct Onset<'a> {
    pub skin: &'a Skin,
    pub rules: &'a Interactions,
    pub candidates: &'a [Candidate],
    pub x_n: &'a [Vector3<f64>],
    pub predicted: &'a [Vector3<f64>],
    pub springs: &'a [Spring],
    pub thickness: f64,
    /// Whether forces are those between two states.
    pub between_states: bool,
}

/// Whether the place where a point meets a triangle is on an edge or a corner of its body, which have points of their own.
pub(super) fn is_at_sharp(skin: &Skin, c: &Candidate, close: &ClosestPair) -> bool {
    match close.feature() {
        PairFeature::VertexVertex([_, b]) => skin.is_sharp(c.points[b]),
        PairFeature::VertexEdge(_, [a, b]) => skin.is_sharp_edge(c.points[a], c.points[b]),
        _ => false,
    }
}

/// The lowest place of a surface above another one.
struct End {
    height: f64,
    /// Distance from where it was begun, and longest side of the triangle there.
    way: f64,
    side: f64,
    /// Whether it is on an edge or a corner of the body.
    is_sharp: bool,
}

impl Onset<'_> {
    /// The place on the second primitive that is closest to a point.
    pub fn foot(&self, c: &Candidate, close: &ClosestPair, x: &[Vector3<f64>]) -> Vector3<f64> {
        x[c.points[0] as usize] - combine(&close.weights, &c.of(x))
    }

    /// Friction of the first of these pairs that had some.
    pub fn rubbed(&self, mut keys: impl Iterator<Item = Key>) -> Rubbed {
        if self.springs.is_empty() {
            return Rubbed::default();
        }
        let of = |key: Key| self.springs.binary_search_by_key(&key, |spring| spring.key).ok();
        keys.find_map(of).map_or_else(Rubbed::default, |place| self.springs[place].rubbed)
    }

    /// The two configurations of which one suffices: at the start of the step, and at its predictor.
    fn configurations(&self) -> [&[Vector3<f64>]; 2] {
        [self.x_n, self.predicted]
    }

    /// Weight and largest thickness of a point against a patch, if it begins to act on it.
    pub fn point_begins(&self, of: &[u32]) -> Option<[f64; 2]> {
        self.configurations().into_iter().find_map(|x| {
            let (k, close) = nearest(self.candidates, of, x)?;
            let [weight, part] = self.meets(&self.candidates[k as usize], &close, &|p| x[p as usize])?;
            Some([weight, part * self.thickness])
        })
    }

    /// Weight and largest thickness of a vertex that stopped a motion before a triangle.
    pub fn blocked_point(&self, c: &Candidate) -> [f64; 2] {
        [self.skin.guard_weight(c.points[0], c.of[0]), self.thickness]
    }

    /// Weight and largest thickness of two edges that stopped a motion.
    pub fn blocked_edges(&self, c: &Candidate) -> [f64; 2] {
        [self.skin.edge_weight(c.of).0, self.thickness]
    }

    /// Weight of a point that meets a triangle at a place where it is to act on it, and the part of the thickness in which it does.
    fn meets(&self, c: &Candidate, close: &ClosestPair, x: &dyn Fn(u32) -> Vector3<f64>) -> Option<[f64; 2]> {
        let (skin, p) = (self.skin, c.points[0]);
        let shares = [1, 2, 3].map(|i| -close.weights[i]);
        let share = self.rules.share(c.classes[0], c.classes[1]);
        let weight = skin.point_weight(p, c.of[0], shares, share, self.corners(p, c.of[0], x));
        if weight <= 0.0 {
            return None;
        }
        let to_foot = -combine(&close.weights, &c.points.map(x));
        if !skin.is_integration_point(p) && skin.is_sharp(p) {
            return Some([weight, if self.is_flush(c, close, &to_foot, x) { LAST } else { 1.0 }]);
        }
        let is_sharp = is_at_sharp(skin, c, close);
        let faces = |own: u32| {
            let normal = self.normal(own, x);
            normal.dot(&to_foot) >= FACING * normal.norm() * to_foot.norm()
        };
        (!is_sharp && skin.triangle_of_integration_point(p).is_none_or(faces)).then_some([weight, 1.0])
    }

    /// Degrees, from 0 to 1, to which the surface of a point and the triangle that it meets touch each other with an edge or a corner of their body: that surface alone has points then, for the direction of the force is the normal of the other one.
    fn corners(&self, point: u32, triangle: u32, x: &dyn Fn(u32) -> Vector3<f64>) -> [f64; 2] {
        if !self.skin.is_integration_point(point) && self.skin.is_sharp(point) {
            return [0.0; 2];
        }
        let normal = self.normal(triangle, x).try_normalize(0.0).unwrap_or_default();
        let cosine = |t: u32| -normal.dot(&self.normal(t, x).try_normalize(0.0).unwrap_or_default());
        // Of the triangles around a vertex the one that is opposite most of all.
        let opposite = || {
            let around = self.skin.triangles_at(point).iter().copied();
            around.max_by(|&s, &t| cosine(s).total_cmp(&cosine(t)))
        };
        let Some(own) = self.skin.triangle_of_integration_point(point).or_else(opposite) else { return [0.0; 2] };
        let own_normal = self.normal(own, x).try_normalize(0.0).unwrap_or_default();
        let sine = own_normal.cross(&normal).norm();
        let angle = sine.atan2(-own_normal.dot(&normal));
        if angle == 0.0 {
            return [0.0; 2];
        }
        let ends = [self.lowest(own, triangle, point, x), self.lowest(triangle, own, point, x)];
        // The one that ends first, on the way on which the gap closes.
        let reach = self.thickness / sine;
        std::array::from_fn(|i| {
            let (end, other) = (&ends[i], &ends[1 - i]);
            let is_first = end.is_sharp && end.way < reach + end.side && end.way < other.way + end.side;
            let before = ((end.height - other.height) / (self.thickness * sine)).clamp(0.0, 1.0);
            if is_first { before * (angle / TILTED).min(1.0) } else { 0.0 }
        })
    }

    /// Where a surface is lowest above the plane of a triangle of another one, going down from one of its own triangles; not beyond that plane.
    fn lowest(&self, from: u32, towards: u32, place: u32, x: &dyn Fn(u32) -> Vector3<f64>) -> End {
        let (skin, normal) = (self.skin, self.normal(towards, x).try_normalize(0.0).unwrap_or_default());
        let origin = x(skin.triangles()[towards as usize][0]);
        let height = |v: u32| (x(v) - origin).dot(&normal);
        let corners @ [a, b, c] = skin.triangles()[from as usize];
        let lower = |least: (f64, u32), v: u32| if height(v) < least.0 { (height(v), v) } else { least };
        let mut least = [b, c].into_iter().fold((height(a), a), lower);
        while least.0 > -self.thickness {
            let around = skin.triangles_at(least.1).iter().flat_map(|&t| skin.triangles()[t as usize]);
            let next = around.fold(least, lower);
            if next.1 == least.1 {
                break;
            }
            least = next;
        }
        let side = corners.map(x).map(|p| (p - x(a)).norm()).into_iter().fold((x(b) - x(c)).norm(), f64::max);
        End { height: least.0, way: (x(least.1) - x(place)).norm(), side, is_sharp: skin.is_sharp(least.1) }
    }

    /// Twice the area of a triangle, along its normal.
    fn normal(&self, triangle: u32, x: &dyn Fn(u32) -> Vector3<f64>) -> Vector3<f64> {
        let [a, b, c] = self.skin.triangles()[triangle as usize].map(x);
        (b - a).cross(&(c - a))
    }

    /// Outward normal of a triangle at the start of the step; zero for one without area.
    pub fn unit_normal(&self, triangle: u32) -> Vector3<f64> {
        self.normal(triangle, &|p| self.x_n[p as usize]).try_normalize(0.0).unwrap_or_default()
    }

    /// Whether a place in a triangle is within a thickness of an edge or a corner of the body.
    fn is_at_rim(&self, triangle: u32, place: &Vector3<f64>, x: &dyn Fn(u32) -> Vector3<f64>) -> bool {
        let (skin, reach) = (self.skin, self.thickness * self.thickness);
        let corners @ [a, b, c] = skin.triangles()[triangle as usize];
        let near_edge = |[a, b]: [u32; 2]| {
            let (s, e) = (x(a), x(b) - x(a));
            let part = ((place - s).dot(&e) / e.norm_squared()).clamp(0.0, 1.0);
            skin.is_sharp_edge(a, b) && (s + e * part - place).norm_squared() < reach
        };
        let near_corner = |v: u32| skin.is_sharp(v) && (x(v) - place).norm_squared() < reach;
        [[a, b], [b, c], [c, a]].into_iter().any(near_edge) || corners.into_iter().any(near_corner)
    }

    /// Whether a corner of a body, or a vertex on one of its edges, lies above the rim of a face that is flush with one of its own: what is beside it acts there, and its oblique direction to the rim would
    /// push the rims apart. Places within a thickness of the rim count as on it, so that nothing is decided by round-off.
    fn is_flush(
        &self,
        c: &Candidate,
        close: &ClosestPair,
        to_foot: &Vector3<f64>,
        x: &dyn Fn(u32) -> Vector3<f64>,
    ) -> bool {
        let (skin, p) = (self.skin, c.points[0]);
        if !self.is_at_rim(c.of[0], &(x(p) + to_foot), x) {
            return false;
        }
        let above = |triangle: u32| {
            let normal = self.normal(triangle, x);
            let size = normal.norm();
            -normal.dot(to_foot) >= FLUSH * size * to_foot.norm()
                && skin.triangles_at(p).iter().any(|&own| {
                    let own = self.normal(own, x);
                    -own.dot(&normal) >= FLUSH * size * own.norm()
                })
        };
        match close.feature() {
            PairFeature::VertexVertex([_, v]) => skin.triangles_at(c.points[v]).iter().any(|&t| above(t)),
            PairFeature::VertexEdge(_, [a, b]) => {
                skin.beside(c.points[a], c.points[b]).into_iter().filter(|&t| t != u32::MAX).any(above)
            }
            _ => above(c.of[0]),
        }
    }

    /// Weight and largest thickness of two edges that begin to act on each other.
    pub fn edges_begin(&self, c: &Candidate) -> Option<[f64; 2]> {
        let part = self.configurations().into_iter().find_map(|x| {
            let close = closest(c.kind, &c.of(x));
            self.cross(c, &close, &|p| x[p as usize])
        })?;
        Some([self.skin.edge_weight(c.of).0, part * self.thickness])
    }

    /// The part of the thickness in which two edges act that are nearest to each other on their surfaces, crossing. It is all where both are convex towards each other. Edges of flat surfaces are only needed where other contacts
    /// have not kept these apart: where an edge of a body bends one between its points, or where both bulge a little and touch between them.
    fn cross(&self, c: &Candidate, close: &ClosestPair, x: &dyn Fn(u32) -> Vector3<f64>) -> Option<f64> {
        if close.feature() != PairFeature::EdgeEdge {
            return None;
        }
        let points = c.points.map(x);
        let out = (-combine(&close.weights, &points)).try_normalize(0.0)?;
        let sides = |edge: usize, [a, b]: [usize; 2], out: Vector3<f64>| {
            let along = (points[b] - points[a]).try_normalize(0.0).unwrap_or_default();
            let [s, t] = self.skin.opposite(c.of[edge]).map(|v| {
                let d = (v != u32::MAX).then(|| x(v) - points[a])?;
                Some((d - along * along.dot(&d)).try_normalize(0.0)?.dot(&out))
            });
            let (s, t) = (s.or(t)?, t.or(s)?);
            // Whether the direction is one of the normals, and whether the edge turns away from it.
            Some((s <= OUTSIDE && t <= OUTSIDE, s + t <= -TURN || self.skin.opposite(c.of[edge])[1] == u32::MAX))
        };
        let ((in_first, first), (in_second, second)) = (sides(0, [0, 1], out)?, sides(1, [2, 3], -out)?);
        if !(in_first && in_second) {
            return None;
        }
        let carries = first && second && !self.is_corner_above_corner(c, close, &out, x);
        Some(if carries { 1.0 } else { LAST })
    }

    /// Whether two edges cross within a thickness of an end of either of them, above faces that are flush: as a corner on a rim, [`Self::is_flush`].
    fn is_corner_above_corner(
        &self,
        c: &Candidate,
        close: &ClosestPair,
        out: &Vector3<f64>,
        x: &dyn Fn(u32) -> Vector3<f64>,
    ) -> bool {
        let edge = |[a, b]: [usize; 2], part: f64, out: Vector3<f64>| {
            let [a, b] = [c.points[a], c.points[b]];
            let at_end = part.min(1.0 - part) * (x(b) - x(a)).norm() < self.thickness;
            at_end
                && self.skin.beside(a, b).into_iter().filter(|&t| t != u32::MAX).any(|t| {
                    let normal = self.normal(t, x);
                    normal.dot(&out) >= FLUSH * normal.norm()
                })
        };
        edge([0, 1], close.weights[1], *out) && edge([2, 3], -close.weights[3], -out)
    }
}
