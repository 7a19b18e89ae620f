//! Two bodies that act on each other: what is left between their surfaces, what has driven them into each other, and in which directions they can push.

use crate::Watch;
use crate::cone::beside;
use crate::pairs::overlap;
use crate::predicates::nearest_point;
use crate::surface::{SMOOTH, Surface};
use nalgebra::Vector3;
use std::collections::BTreeSet;

/// Parts of an edge, beyond the smallest distance of two surfaces, up to which their facets count as those that push.
const PUSHING: f64 = 0.1;
/// Parts of an edge: if no node of either body is nearer to the other, only edges can meet, and which facets push is not known.
const NEAREST: f64 = 0.25;
/// If the nearest node is farther than so many times the smallest distance, edges meet between the nodes.
const AS_NEAR: f64 = 2.0;
/// Parts of an edge of the other body up to which a rim counts as one that pushes.
const RIM: f64 = 1.5;
/// Parts of an edge, beyond the smallest distance and the height of an arch, up to which surfaces lie on each other.
const TOUCHING: f64 = 1.0e-3;
/// Two surfaces are curved alike if they lie on each other over so many times the angle between neighbouring facets.
const CURVED_ALIKE: f64 = 3.0;

/// What is left of the height of an arch where contact has true positions: it takes three pieces along each side.
const KNOWN: f64 = 1.0 / 9.0;

/// Parts of an edge by which distances of one place are different.
const SAME_PLACE: f64 = 1.0e-9;
/// Cosine of the normals of two facets below which they are opposite to each other.
const OPPOSITE: f64 = -0.5;

/// Normals that differ by less are one.
const SAME_NORMAL: f64 = 1.0e-6;

/// Two bodies that act on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The two bodies; the node is one of the first.
    pub bodies: [usize; 2],
    /// Global number of the node of one that is nearest to the surface of the other.
    pub node: u32,
    /// Position of the node.
    pub position: [f64; 3],
    /// Distance of the node from that surface (a length).
    pub apart: f64,
    /// Mean edge of the facet there (a length).
    pub edge: f64,
    /// How far the bodies have been moved into each other since they touched (a length): the largest difference of the displacements of any two of their nodes along the force, or without one along the
    /// normal there, less the gap that they had in the reference, or with the overlap that they had.
    pub drive: f64,
    /// Mean height of the arches of facets over the nodes of the other surface that lie on them (a length), of surfaces that are curved alike; zero of others. By so much the gap between the
    /// facets is not that between the curved surfaces, unless contact knows the true positions.
    pub arch: f64,
    /// Amount by which the distance of the facets, which the watch measures, may differ from that of the true surfaces which contact knows (a length).
    pub known_arches: f64,
    /// Whether loads alone press them together. Forces are right then whatever is left between the surfaces, but how bodies share them depends on the arches.
    pub by_loads: bool,
}

/// A node near the other surface.
struct Near {
    node: u32,
    triangle: usize,
    distance: f64,
    foot: Vector3<f64>,
}

/// The nodes of a body that are not farther from the other surface than `margin` of the facet there beyond the nearest one; none if all are farther than `reach`.
fn near(body: &Surface, other: &Surface, reach: f64, margin: impl Fn(u32) -> f64) -> Vec<Near> {
    let at = |node: u32, bound: f64| {
        let x = &body.points[node as usize];
        let mut best = None;
        other.tree.nearest(x, bound, |t, bound| {
            let foot = nearest_point(x, other.triangle(t));
            let distance = (x - foot).norm();
            if distance < bound {
                best = Some(Near { node, triangle: t, distance, foot });
                distance
            } else {
                bound
            }
        });
        best
    };
    let nodes = || 0..body.nodes.len() as u32;
    let least = nodes().fold(reach, |least, node| at(node, least).map_or(least, |near| near.distance));
    if least == reach {
        return Vec::new();
    }
    let widest = (0..other.facets.len() as u32).map(&margin).fold(0.0, f64::max);
    // A little more, so that the nearest one itself is found.
    let found = nodes().filter_map(|node| at(node, (least + widest) * (1.0 + f64::EPSILON) + f64::MIN_POSITIVE));
    let mut found: Vec<Near> =
        found.filter(|near| near.distance <= least + margin(other.facet(near.triangle))).collect();
    for near in &mut found {
        let over = other.height_over_face(&body.points[near.node as usize], near.triangle);
        near.distance = over.map_or(near.distance, f64::abs);
    }
    found
}

/// Normals of these facets and of those around them on a smooth surface, which has the normals between them. An open surface has two sides, of which the one that `force` comes from counts, and pushes
/// with its `rim` outwards as well.
fn pushing(surface: &Surface, facets: &[u32], rim: Vec<Vector3<f64>>, force: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let corners = |f: u32| surface.facets[f as usize].corners().iter();
    let around = |f: u32| {
        let all = corners(f).flat_map(|&corner| surface.facets_at(corner)).copied();
        let normal = surface.normal(f);
        all.filter(move |&g| surface.normal(g).dot(&normal) > SMOOTH)
    };
    let near: BTreeSet<u32> = facets.iter().flat_map(|&f| around(f).chain([f])).collect();
    let mut all: Vec<Vector3<f64>> = near.iter().map(|&f| surface.normal(f)).collect();
    if !surface.is_closed {
        if all.iter().sum::<Vector3<f64>>().dot(force) < 0.0 {
            all.iter_mut().for_each(|normal| *normal = -*normal);
        }
        all.extend(rim);
    }
    let mut normals: Vec<Vector3<f64>> = Vec::new();
    for normal in all {
        if normals.iter().all(|known| (known - normal).norm() > SAME_NORMAL) {
            normals.push(normal);
        }
    }
    normals
}

/// The triangle that is most opposite to a facet of the node, with the normals of both: of the facets of `other` that are as near to a node of `body` as the
/// one that was found, as at an edge between two facets. Nothing if none is opposite, as where a node lies beside a rim.
fn opposite(body: &Surface, other: &Surface, near: &Near) -> Option<(usize, [Vector3<f64>; 2])> {
    let x = &body.points[near.node as usize];
    let first = other.facet(near.triangle);
    let bound = (x - near.foot).norm() + SAME_PLACE * other.length(first);
    let around = other.facets[first as usize].corners().iter().flat_map(|&corner| other.facets_at(corner));
    let all: BTreeSet<u32> = around.copied().chain([first]).collect();
    let triangles = all.iter().flat_map(|&f| other.triangles_of(f));
    let as_near = triangles.filter(|&t| (x - nearest_point(x, other.triangle(t))).norm() <= bound);
    let own = || body.facets_at(near.node).iter().map(|&f| body.normal(f));
    let pairs = as_near.flat_map(|t| own().map(move |n| (t, [n, other.normal(other.facet(t))])));
    let cosine = |[n, m]: &[Vector3<f64>; 2]| n.dot(m);
    pairs.min_by(|a, b| cosine(&a.1).total_cmp(&cosine(&b.1))).filter(|(_, normals)| cosine(normals) < OPPOSITE)
}

/// Heights of the arches of a surface at the nodes of another one that lie on it.
#[derive(Clone, Copy, Debug, Default)]
struct Arches {
    /// Mean of the heights, if the surfaces are curved alike.
    mean: f64,
    /// Amount by which the smallest distance of the nodes from the facets differs from that from the curved surface, if they are curved alike.
    of_gap: f64,
    /// The highest arch over these facets.
    highest: f64,
}

/// The arches of `other` at the nodes of `body`.
fn arches(body: &Surface, other: &Surface) -> Arches {
    let lying = near(body, other, f64::INFINITY, |f| other.highest_arch(f) + TOUCHING * other.length(f));
    let places: Vec<(&Near, usize, [Vector3<f64>; 2])> =
        lying.iter().filter_map(|near| opposite(body, other, near).map(|(t, normals)| (near, t, normals))).collect();
    let facets: BTreeSet<u32> = places.iter().map(|(_, t, _)| other.facet(*t)).collect();
    let highest = facets.iter().map(|&f| other.highest_arch(f)).fold(0.0, f64::max);
    let angle = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).norm().atan2(a.dot(b));
    // Of each side, those of a plane under a ball being one normal.
    let spread = |side: usize| {
        let all = places.iter().map(|(_, _, normals)| angle(&places[0].2[side], &normals[side]));
        all.fold(0.0, f64::max)
    };
    // The largest angle between neighbours on a smooth surface: facets that share a node.
    let turn = |&f: &u32| {
        let normal = other.normal(f);
        let around = other.facets[f as usize].corners().iter().flat_map(|&corner| other.facets_at(corner));
        let smooth = around.map(|&g| other.normal(g)).filter(|n| n.dot(&normal) > SMOOTH);
        smooth.map(|n| angle(&normal, &n)).fold(0.0, f64::max)
    };
    let least = CURVED_ALIKE * facets.iter().map(turn).fold(0.0, f64::max);
    if spread(0) <= least || spread(1) <= least {
        return Arches { highest, ..Arches::default() };
    }
    let heights: Vec<f64> = places.iter().map(|(near, t, _)| other.height_of_arch(*t, &near.foot)).collect();
    let mean = (heights.iter().sum::<f64>() / places.len() as f64).abs();
    let distances = places.iter().map(|(near, ..)| near.distance);
    let curved =
        distances.clone().zip(&heights).map(|(distance, height)| distance - height).fold(f64::INFINITY, f64::min);
    Arches { mean, of_gap: (curved - distances.fold(f64::INFINITY, f64::min)).abs(), highest }
}

impl Watch {
    /// Two bodies as they lie in the state that [`Self::geometry`] has looked at last, with this force on the first one; nothing if one of them has no surface. `known` is their smallest distance
    /// where contact knows it: edges may be nearer to each other than any node. `is_round`: whether contact has true positions on the round surfaces of each; `by_loads`:
    /// whether loads alone press them together.
    pub fn meeting(
        &mut self,
        bodies: [usize; 2],
        force: [f64; 3],
        known: Option<f64>,
        is_round: [bool; 2],
        by_loads: bool,
    ) -> Option<Meeting> {
        let is_round = |body: usize| is_round[usize::from(body != bodies[0])];
        let gap = self.gap_in_reference(bodies);
        // Against the force, the way of the first body into the second.
        let way = -Vector3::from(force).try_normalize(0.0).unwrap_or_default();
        let nearest = |[a, b]: [usize; 2]| {
            let (body, other) = (&self.surfaces[a], &self.surfaces[b]);
            let found = near(body, other, f64::INFINITY, |_| 0.0).into_iter().next()?;
            Some(([a, b], found))
        };
        let [a, b] = bodies;
        let both = [nearest([a, b]), nearest([b, a])].into_iter().flatten();
        let ([a, b], found) = both.min_by(|x, y| x.1.distance.total_cmp(&y.1.distance))?;
        let of_gap = if by_loads { self.arches_of_gap([a, b]) } else { [0.0; 2] };
        let (body, other) = (&self.surfaces[a], &self.surfaces[b]);
        let position = body.points[found.node as usize];
        let edge = other.edge_length(found.triangle);
        let along = |surface: &Surface, into: &Vector3<f64>| {
            let motions = surface.nodes.iter().zip(&surface.points).map(|(&node, x)| {
                let then = &self.model.reference[3 * node as usize..3 * node as usize + 3];
                into.dot(&(x - Vector3::from_column_slice(then)))
            });
            motions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), u| (low.min(u), high.max(u)))
        };
        let drive = |from: &Surface, to: &Surface, into: Vector3<f64>| along(from, &into).1 - along(to, &into).0;
        let [first, second] = bodies.map(|k| &self.surfaces[k]);
        let drive = match way == Vector3::zeros() {
            true => drive(body, other, -other.normal(other.facet(found.triangle))),
            false => drive(first, second, way),
        } - gap;
        let (mut mean, mut known_arches) = (0.0_f64, 0.0);
        for (arches, of) in [(arches(body, other), b), (arches(other, body), a)] {
            mean = mean.max(if is_round(of) { KNOWN * arches.mean } else { arches.mean });
            known_arches += if is_round(of) { arches.highest } else { 0.0 };
        }
        for (height, of) in of_gap.into_iter().zip([a, b]) {
            mean = mean.max(if is_round(of) { KNOWN * height } else { height });
        }
        Some(Meeting {
            bodies: [a, b],
            node: body.nodes[found.node as usize],
            position: position.into(),
            apart: found.distance.min(known.unwrap_or(f64::INFINITY)),
            edge,
            drive,
            arch: mean,
            known_arches,
            by_loads,
        })
    }

    /// Smallest distance of two bodies in the reference, the depth of their overlap with a minus.
    pub fn gap_in_reference(&mut self, [a, b]: [usize; 2]) -> f64 {
        let key = [a.min(b), a.max(b)];
        if let Some(&gap) = self.gaps.get(&key) {
            return gap;
        }
        let [first, second] = [a, b].map(|k| self.in_reference(k));
        let mut inside = Vec::new();
        let mut depth =
            |x: &Surface, y: &Surface| overlap(x, y, |_| false, &mut inside).deepest.map(|deepest| deepest.depth);
        let depth = depth(&first, &second).into_iter().chain(depth(&second, &first)).fold(0.0, f64::max);
        let distance = |x, y| near(x, y, f64::INFINITY, |_| 0.0).first().map_or(f64::INFINITY, |near| near.distance);
        let gap = if depth > 0.0 { -depth } else { distance(&first, &second).min(distance(&second, &first)) };
        self.gaps.insert(key, gap);
        gap
    }

    fn in_reference(&self, body: usize) -> Surface {
        let mut surface = self.surfaces[body].clone();
        surface.place(&self.model.reference, true);
        surface
    }

    /// Amounts by which the arches of each of two bodies change the gap in the reference (a length).
    fn arches_of_gap(&mut self, [a, b]: [usize; 2]) -> [f64; 2] {
        let key = [a.min(b), a.max(b)];
        let known = self.arches.get(&key).copied();
        let [first, second] = known.unwrap_or_else(|| {
            let [first, second] = key.map(|k| self.in_reference(k));
            [arches(&second, &first).of_gap, arches(&first, &second).of_gap]
        });
        self.arches.insert(key, [first, second]);
        if a < b { [first, second] } else { [second, first] }
    }

    /// What of the force on the first of two bodies, which act on each other without friction, their surfaces cannot exert: its distances from the cone of the normals of the second one
    /// where it is near the first, and from that of the inner normals of the first one where it is near the second. Of the state that [`Self::geometry`] has looked at last; nothing if no
    /// node of one is near the other, as where only edges meet: no node is nearly as near as the smallest distance that contact may know.
    pub fn side_force(&self, [a, b]: [usize; 2], force: [f64; 3], known: Option<f64>) -> Option<[[f64; 3]; 2]> {
        let (first, second) = (&self.surfaces[a], &self.surfaces[b]);
        let of = |body: &Surface, other: &Surface| {
            let longest = (0..other.facets.len() as u32).map(|f| other.length(f)).fold(0.0, f64::max);
            let mut found = near(body, other, NEAREST * longest, |f| PUSHING * other.length(f));
            if !found.iter().any(|near| near.distance <= NEAREST * other.edge_length(near.triangle)) {
                found.clear();
            }
            found
        };
        let (of_first, of_second) = (of(first, second), of(second, first));
        let nearest = of_first.iter().chain(&of_second).map(|near| near.distance).fold(f64::INFINITY, f64::min);
        if nearest == f64::INFINITY || known.is_some_and(|known| nearest > AS_NEAR * known) {
            return None;
        }
        let facets = |of_own: &[Near], of_other: &[Near], surface: &Surface| -> Vec<u32> {
            let below = of_other.iter().map(|near| surface.facet(near.triangle));
            below.chain(of_own.iter().flat_map(|near| surface.facets_at(near.node).iter().copied())).collect()
        };
        let [rim_of_first, rim_of_second] =
            [(first, &of_second, second), (second, &of_first, first)].map(|(surface, of_other, other)| {
                let outwards = of_other.iter().flat_map(|near| {
                    let size = other.facets_at(near.node).iter().map(|&f| other.length(f)).fold(0.0, f64::max);
                    surface.outwards(surface.facet(near.triangle), &near.foot, RIM * size)
                });
                outwards.collect::<Vec<_>>()
            });
        // What the first one exerts is the opposite.
        let force = Vector3::from(force);
        let of_first_facets = facets(&of_first, &of_second, first);
        let of_second_facets = facets(&of_second, &of_first, second);
        let by_first = beside(&-force, &pushing(first, &of_first_facets, rim_of_first, &-force));
        let by_second = beside(&force, &pushing(second, &of_second_facets, rim_of_second, &force));
        Some([by_second.into(), (-by_first).into()])
    }
}
