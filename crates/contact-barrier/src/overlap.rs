//! Bodies that overlap: how far one has to be moved to be free of the other.

use crate::{Interactions, Skin, SkinFacet, check_initial, is_closed};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_contact::position;
use stoss_geometry::Aabb;

/// Directions that are tried.
const DIRECTIONS: usize = 6;

/// Directions with a smaller cosine to the first one are not tried.
const ALIGNED: f64 = 0.3;

/// Lengths are found up to this part of the limit.
const PRECISION: f64 = 1e-6;

/// Points that tell whether a body is inside another one.
const POINTS: usize = 64;

/// Depth of such points, in parts of the size of a triangle: bodies that touch are not inside each other.
const BELOW: f64 = 1e-6;

/// A short step outwards from a triangle with this normal, which is twice its area long.
fn skin_depth(normal: &Vector3<f64>) -> Vector3<f64> {
    normal * (BELOW / normal.norm().sqrt())
}

/// Barycentric coordinates of the samples of a triangle: all of it, and points near its corners.
const SAMPLES: [[f64; 3]; 6] = [
    [0.90, 0.05, 0.05],
    [0.05, 0.90, 0.05],
    [0.05, 0.05, 0.90],
    [0.10, 0.45, 0.45],
    [0.45, 0.10, 0.45],
    [0.45, 0.45, 0.10],
];

/// How two bodies lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relation {
    /// The surfaces cross, or share planes and have a volume in common.
    Cross,
    /// One of them is wholly inside the other.
    Inside,
    /// The bodies are apart, by this distance if it is below what was looked for.
    Apart(Option<f64>),
}

/// A translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// Unit vector.
    pub direction: Vector3<f64>,
    /// Length of the translation.
    pub length: f64,
}

/// Surface of a body.
#[derive(Debug, Default)]
struct Surface {
    facets: Vec<SkinFacet>,
    triangles: Vec<[Vector3<f64>; 3]>,
    bounds: Option<Aabb>,
    is_closed: bool,
}

impl Surface {
    fn bounds(&self) -> Aabb {
        self.bounds.unwrap_or_else(Aabb::empty)
    }

    /// Whether a point is inside: a closed surface turns around it.
    fn contains(&self, x: &Vector3<f64>) -> bool {
        if !self.is_closed || !self.bounds().contains(x) {
            return false;
        }
        let angle = |[a, b, c]: &[Vector3<f64>; 3]| {
            let [a, b, c] = [a - x, b - x, c - x];
            let [p, q, r] = [a.norm(), b.norm(), c.norm()];
            2.0 * a.cross(&b).dot(&c).atan2(p * q * r + a.dot(&b) * r + b.dot(&c) * p + c.dot(&a) * q)
        };
        self.triangles.iter().map(angle).sum::<f64>() > 2.0 * std::f64::consts::PI
    }
}

/// The bodies of a skin, of which one may be thought of as moved.
#[derive(Debug)]
pub struct Overlaps<'a> {
    q: &'a [f64],
    rules: Interactions,
    bodies: BTreeMap<u32, Surface>,
}

/// The facets of two bodies that may meet, with their nodes in new numbers.
struct Local {
    skin: Skin,
    q: Vec<f64>,
    /// Nodes of the first body come first.
    first: usize,
}

impl Local {
    fn moved(&self, by: &Vector3<f64>) -> Vec<f64> {
        let mut q = self.q.clone();
        q[..3 * self.first].chunks_exact_mut(3).for_each(|x| (0..3).for_each(|i| x[i] += by[i]));
        q
    }
}

impl<'a> Overlaps<'a> {
    /// The bodies of a skin at the positions `q`.
    pub fn new(skin: &Skin, rules: &Interactions, q: &'a [f64]) -> Self {
        let mut bodies: BTreeMap<u32, Surface> = BTreeMap::new();
        let mut triangles: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
        let body = |facet: u32| rules.body(skin.facets()[facet as usize].class);
        for (f, facet) in skin.facets().iter().enumerate() {
            bodies.entry(body(f as u32)).or_default().facets.push(*facet);
        }
        for (t, triangle) in skin.triangles().iter().enumerate() {
            let body = body(skin.facet_of_triangle(t as u32));
            let corners = triangle.map(|vertex| skin.at(vertex, q));
            let surface = bodies.entry(body).or_default();
            surface.triangles.push(corners);
            surface.bounds = Some(surface.bounds().union(&Aabb::from_points(&corners)));
            triangles.entry(body).or_default().push(*triangle);
        }
        for (body, surface) in &mut bodies {
            surface.is_closed = is_closed(&triangles[body]);
        }
        Self { q, rules: rules.between_bodies(), bodies }
    }

    /// Largest and smallest extent of the box around a body.
    pub fn extents(&self, body: u32) -> [f64; 2] {
        let bounds = self.bodies[&body].bounds();
        let size = bounds.max - bounds.min;
        [size.max(), size.min()]
    }

    fn local(&self, [a, b]: [u32; 2], shift: &Vector3<f64>, margin: f64) -> Local {
        let boxes = [self.moved_bounds(a, shift), self.bodies[&b].bounds()];
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let (mut facets, mut q, mut first) = (Vec::new(), Vec::new(), 0);
        for (k, body) in [a, b].into_iter().enumerate() {
            let by = if k == 0 { *shift } else { Vector3::zeros() };
            let region = boxes[1 - k].inflated(margin);
            let at = |node: u32| position(self.q, node) + by;
            for facet in &self.bodies[&body].facets {
                let around = facet.nodes.iter().fold(Aabb::empty(), |all, &n| all.union(&Aabb::from_points([&at(n)])));
                if !around.overlaps(&region) {
                    continue;
                }
                let nodes = facet.nodes.map(|node| {
                    let next = numbers.len() as u32;
                    *numbers.entry(node).or_insert_with(|| {
                        q.extend_from_slice(at(node).as_slice());
                        next
                    })
                });
                facets.push(SkinFacet { nodes, ..*facet });
            }
            if k == 0 {
                first = numbers.len();
            }
        }
        let skin = Skin::new(facets, &q, &|_| None);
        Local { skin, q, first }
    }

    fn moved_bounds(&self, body: u32, shift: &Vector3<f64>) -> Aabb {
        let bounds = self.bodies[&body].bounds();
        Aabb { min: bounds.min + shift, max: bounds.max + shift }
    }

    /// How `a`, moved by `shift`, lies to `b`; distances below `reach` are reported.
    pub fn relation(&self, bodies: [u32; 2], shift: &Vector3<f64>, reach: f64) -> Relation {
        let [a, b] = bodies;
        if !self.moved_bounds(a, shift).inflated(reach).overlaps(&self.bodies[&b].bounds()) {
            return Relation::Apart(None);
        }
        self.relation_of(&self.local(bodies, shift, reach), bodies, shift, &Vector3::zeros(), reach)
    }

    /// How `a`, moved by `shift` and then by `by`, lies to `b`, by a local skin at `shift`.
    fn relation_of(
        &self,
        local: &Local,
        [a, b]: [u32; 2],
        shift: &Vector3<f64>,
        by: &Vector3<f64>,
        reach: f64,
    ) -> Relation {
        let check = check_initial(&local.skin, &self.rules, &local.moved(by), reach);
        if !check.crossings.is_empty() {
            return Relation::Cross;
        }
        let shift = shift + by;
        if self.is_within(local, a, b, by, &shift) {
            let [first, second] = [self.moved_bounds(a, &shift), self.bodies[&b].bounds()];
            let holds = |outer: &Aabb, inner: &Aabb| outer.contains(&inner.min) && outer.contains(&inner.max);
            let is_nested = holds(&first, &second) || holds(&second, &first);
            return if is_nested { Relation::Inside } else { Relation::Cross };
        }
        Relation::Apart(check.nearest.values().next().map(|nearest| nearest.distance))
    }

    /// Whether one of two bodies is wholly inside the other: all points just below its surface that are checked.
    pub fn is_enclosed(&self, bodies: [u32; 2]) -> bool {
        let [a, b] = bodies.map(|body| &self.bodies[&body]);
        let is_within = |inner: &Surface, outer: &Surface| {
            let (box_of, around) = (inner.bounds(), outer.bounds());
            let few = inner.triangles.iter().step_by(inner.triangles.len().div_ceil(POINTS).max(1));
            around.contains(&box_of.min)
                && around.contains(&box_of.max)
                && few
                    .map(|[p, q, r]| (p + q + r) / 3.0 - skin_depth(&(q - p).cross(&(r - p))))
                    .all(|x| outer.contains(&x))
        };
        is_within(a, b) || is_within(b, a)
    }

    /// Whether points just below the surface of one body are inside the other. Surfaces that do not cross are inside with all of their points or with none, but for those that share a plane: hence several.
    fn is_within(&self, local: &Local, a: u32, b: u32, by: &Vector3<f64>, shift: &Vector3<f64>) -> bool {
        let triangles = local.skin.triangles();
        (0..triangles.len()).step_by(triangles.len().div_ceil(POINTS).max(1)).any(|t| {
            let facet = local.skin.facet_of_triangle(t as u32);
            let is_first = self.rules.body(local.skin.facets()[facet as usize].class) == a;
            let [p, q, r] = triangles[t].map(|vertex| local.skin.at(vertex, &local.q));
            let x = (p + q + r) / 3.0 - skin_depth(&(q - p).cross(&(r - p)));
            if is_first { self.bodies[&b].contains(&(x + by)) } else { self.bodies[&a].contains(&(x - shift)) }
        })
    }

    /// The shortest translation of `a`, beyond `shift`, that leaves a distance of `gap` between `a` and `b`, among some directions: that in which the volume in common shrinks fastest, and the normals of facets that cross. `None`
    /// if there is none up to the length `limit`, or if one body is wholly inside the other.
    pub fn separation(&self, bodies: [u32; 2], shift: &Vector3<f64>, gap: f64, limit: f64) -> Option<Separation> {
        let local = self.local(bodies, shift, limit + gap);
        let mut best: Option<Separation> = None;
        for direction in self.directions(&local, bodies, shift, gap) {
            let most = best.map_or(limit, |best| best.length);
            let is_free = |length: f64| {
                self.relation_of(&local, bodies, shift, &(direction * length), gap) == Relation::Apart(None)
            };
            let (mut low, mut high) = (0.0, gap.max(PRECISION * limit).min(most));
            let mut free = is_free(high);
            while !free && high < most {
                (low, high) = (high, (2.0 * high).min(most));
                free = is_free(high);
            }
            if !free {
                continue;
            }
            while high - low > PRECISION * limit.max(gap) {
                let middle = 0.5 * (low + high);
                if is_free(middle) { high = middle } else { low = middle }
            }
            if best.is_none_or(|best| high < best.length) {
                best = Some(Separation { direction, length: high });
            }
        }
        best
    }

    /// Directions in which `a` may be moved out of `b`, the most promising first.
    fn directions(&self, local: &Local, [a, b]: [u32; 2], shift: &Vector3<f64>, reach: f64) -> Vec<Vector3<f64>> {
        let check = check_initial(&local.skin, &self.rules, &local.q, reach);
        let is_first = |facet: u32| self.rules.body(local.skin.facets()[facet as usize].class) == a;
        let mut areas = vec![Vector3::zeros(); local.skin.facets().len()];
        for (t, triangle) in local.skin.triangles().iter().enumerate() {
            let [p, q, r] = triangle.map(|vertex| local.skin.at(vertex, &local.q));
            areas[local.skin.facet_of_triangle(t as u32) as usize] += (q - p).cross(&(r - p));
        }
        // Out of a facet of `b`, or against one of `a`.
        let out_of = |facet: u32| {
            let normal = areas[facet as usize].try_normalize(0.0).unwrap_or_default();
            if is_first(facet) { -normal } else { normal }
        };
        let is_closed = [a, b].map(|body| self.bodies[&body].is_closed);
        let is_open = |facet: u32| !is_closed[usize::from(!is_first(facet))];
        let crossed: Vec<u32> = check.crossings.iter().map(|([_, facet], _)| *facet).collect();
        // A body has to leave an open surface on its outer side.
        let of_open: Vec<u32> = crossed.iter().copied().filter(|&facet| is_open(facet)).collect();
        let normals: Vec<Vector3<f64>> = if !of_open.is_empty() {
            of_open.into_iter().map(out_of).collect()
        } else if !crossed.is_empty() {
            crossed.into_iter().map(out_of).collect()
        } else {
            check.nearest.values().flat_map(|nearest| nearest.facets.map(out_of)).collect()
        };
        let shrinking = if is_closed == [true; 2] { self.shrinking([a, b], shift) } else { Vector3::zeros() };
        let sum: Vector3<f64> = normals.iter().sum();
        let Some(first) = shrinking.try_normalize(0.0).or_else(|| sum.try_normalize(0.0)) else { return normals };
        let mut list = vec![first];
        let mut others: Vec<Vector3<f64>> = normals.into_iter().filter(|n| n.dot(&first) > ALIGNED).collect();
        others.sort_by(|n, m| m.dot(&first).total_cmp(&n.dot(&first)));
        for n in others {
            if list.len() < DIRECTIONS && list.iter().all(|known| known.dot(&n) < 1.0 - 1e-12) {
                list.push(n);
            }
        }
        list
    }

    /// Minus the gradient of the volume in common by the motion of `a`: the area of the part of its surface that lies inside `b`, inwards; and the same of `b`, outwards.
    fn shrinking(&self, [a, b]: [u32; 2], shift: &Vector3<f64>) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        let [first, second] = [&self.bodies[&a], &self.bodies[&b]];
        for (own, other, by, sign) in [(first, second, *shift, -1.0), (second, first, -shift, 1.0)] {
            for [p, q, r] in &own.triangles {
                let normal = (q - p).cross(&(r - p));
                // Just outside: what is in the same plane as the other surface does not count.
                let outwards = by + skin_depth(&normal);
                for [l, m, n] in SAMPLES {
                    if other.contains(&(p * l + q * m + r * n + outwards)) {
                        sum += normal * (sign * 0.5 / SAMPLES.len() as f64);
                    }
                }
            }
        }
        // What cancels leaves round-off.
        let scale = first.bounds().max - first.bounds().min;
        if sum.norm() > 1e-12 * scale.norm_squared() { sum } else { Vector3::zeros() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interaction;

    /// Boxes of edge one at these places, each a body.
    fn boxes(places: &[[f64; 3]]) -> (Vec<SkinFacet>, Vec<f64>, Interactions) {
        const FACES: [[u32; 4]; 6] =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let (mut facets, mut q) = (Vec::new(), Vec::new());
        for (body, place) in places.iter().enumerate() {
            for z in [0.0, 1.0] {
                CORNERS.iter().for_each(|c| q.extend([place[0] + c[0], place[1] + c[1], place[2] + z]));
            }
            let nodes = FACES.map(|face| face.map(|n| n + 8 * body as u32));
            facets.extend(nodes.map(|nodes| SkinFacet { nodes: nodes.into(), class: body as u32 }));
        }
        let mut rules = Interactions::none(&(0..places.len() as u32).map(|b| (b, 1.0)).collect::<Vec<_>>());
        let all = Some(Interaction { modulus: 1.0, friction: None });
        (0..places.len() as u32).for_each(|a| (0..a).for_each(|b| rules.set(a, b, all.clone())));
        (facets, q, rules)
    }

    #[test]
    fn boxes_leave_each_other_on_the_short_way() {
        for (place, direction, depth) in [
            ([0.2, 0.1, -0.9], [0.0, 0.0, -1.0], 0.1),
            ([0.95, 0.3, 0.2], [1.0, 0.0, 0.0], 0.05),
            ([0.9, -0.98, 0.1], [0.0, -1.0, 0.0], 0.02),
        ] {
            let (facets, q, rules) = boxes(&[place, [0.0; 3]]);
            let skin = Skin::new(facets, &q, &|_| None);
            let overlaps = Overlaps::new(&skin, &rules, &q);
            assert_eq!(overlaps.relation([0, 1], &Vector3::zeros(), 0.1), Relation::Cross);
            let found = overlaps.separation([0, 1], &Vector3::zeros(), 0.0, 1.0).unwrap();
            assert!((found.direction - Vector3::from(direction)).norm() < 1e-12, "{found:?}");
            assert!((found.length - depth).abs() < 1e-5, "{found:?}");
            let with_gap = overlaps.separation([0, 1], &Vector3::zeros(), 0.03, 1.0).unwrap();
            assert!((with_gap.length - depth - 0.03).abs() < 1e-5, "{with_gap:?}");
            // It is the other way round for the other one.
            let other = overlaps.separation([1, 0], &Vector3::zeros(), 0.0, 1.0).unwrap();
            assert!((other.direction + found.direction).norm() < 1e-12);
            let moved = found.direction * (depth + 0.01);
            let Relation::Apart(Some(distance)) = overlaps.relation([0, 1], &moved, 0.1) else { panic!() };
            assert!((distance - 0.01).abs() < 1e-12, "{distance}");
            assert_eq!(overlaps.separation([0, 1], &Vector3::zeros(), 0.0, 0.5 * depth), None);
        }
    }

    #[test]
    fn columns_with_common_sides_overlap_or_touch() {
        let (facets, q, rules) = boxes(&[[0.0, 0.0, 0.9], [0.0; 3]]);
        let skin = Skin::new(facets, &q, &|_| None);
        let overlaps = Overlaps::new(&skin, &rules, &q);
        let relation = |z: f64| overlaps.relation([0, 1], &Vector3::new(0.0, 0.0, z), 0.0);
        assert_eq!([relation(0.0), relation(0.05)], [Relation::Cross; 2]);
        // Round-off of 0.9 + 0.1 is touch.
        assert_eq!([relation(0.1), relation(0.2), relation(-1.9)], [Relation::Apart(None); 3]);
        let found = overlaps.separation([0, 1], &Vector3::zeros(), 0.0, 1.0).unwrap();
        assert!((found.direction - Vector3::z()).norm() < 1e-12 && (found.length - 0.1).abs() < 1e-5, "{found:?}");
        // On a face, not at its corners.
        let touching = overlaps.relation([0, 1], &Vector3::new(0.3, 0.2, 0.1), 0.0);
        assert_eq!(touching, Relation::Apart(None));
    }

    #[test]
    fn a_body_inside_another_one_has_no_way() {
        let (facets, mut q, rules) = boxes(&[[0.0; 3], [0.0; 3]]);
        q[..24].iter_mut().for_each(|x| *x = 0.3 + 0.2 * *x);
        let skin = Skin::new(facets, &q, &|_| None);
        let overlaps = Overlaps::new(&skin, &rules, &q);
        assert_eq!(overlaps.relation([0, 1], &Vector3::zeros(), 0.01), Relation::Inside);
        assert_eq!(overlaps.relation([1, 0], &Vector3::zeros(), 0.01), Relation::Inside);
        assert_eq!(overlaps.relation([0, 1], &Vector3::new(0.0, 0.0, 2.0), 0.01), Relation::Apart(None));
        assert_eq!(overlaps.separation([0, 1], &Vector3::zeros(), 0.0, 0.1), None);
        assert!(overlaps.is_enclosed([0, 1]) && overlaps.is_enclosed([1, 0]));
        // It looks out.
        q[..24].iter_mut().for_each(|x| *x += 0.6);
        let overlaps = Overlaps::new(&skin, &rules, &q);
        assert_eq!(overlaps.relation([0, 1], &Vector3::zeros(), 0.01), Relation::Cross);
        assert!(!overlaps.is_enclosed([0, 1]) && !overlaps.is_enclosed([1, 0]));
    }
}
