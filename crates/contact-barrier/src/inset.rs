//! Surfaces a little below those of the bodies, for bodies that touch at the start or nearly so.

use crate::{Interactions, Skin};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;
use stoss_geometry::{Aabb, BoundingVolumeTree, PairKind, closest};

/// Normals that are the same up to this are one.
const SAME: f64 = 1e-9;

/// Cosine of the angle between two normals, one of them turned around, from which on facets face each other.
pub(crate) const OPPOSITE: f64 = 0.5;

/// Cosine of the angle between neighbours up to which a surface goes on.
const GOES_ON: f64 = 0.94;

/// The shortest `m` with `n . m >= d` for all of the unit normals `n` with their depths `d >= 0` (lengths). With the depth 1: 1 on a plane, `sqrt 2` at the edge and `sqrt 3` at the corner of a cube; at an edge of which one face has the depth
/// 1 and the other one 0 it is the normal of the first. `None` if there is none, as where facets of a vertex face each other.
///
/// Points `m` below the vertices of two bodies that a plane separates are at least `2 d` apart: a plane that supports a body at a vertex has a normal that is a convex combination of those of the facets there that face
/// the plane, up to its length, and if these have the depth `d`, `n . m >= d` holds for it as well. Facets of the depth 0 keep the point inside of the body, so that the rim of a base goes along the side walls.
pub fn mitre(facets: &[(Vector3<f64>, f64)]) -> Option<Vector3<f64>> {
    let mut distinct: Vec<(Vector3<f64>, f64)> = Vec::new();
    for (n, d) in facets {
        match distinct.iter_mut().find(|(other, _)| other.dot(n) >= 1.0 - SAME) {
            Some((_, depth)) => *depth = depth.max(*d),
            None => distinct.push((*n, *d)),
        }
    }
    let round_off = SAME * distinct.iter().map(|(_, d)| *d).fold(0.0, f64::max);
    let mut best: Option<Vector3<f64>> = None;
    let mut consider = |m: Vector3<f64>| {
        let admissible = m.iter().all(|c| c.is_finite()) && distinct.iter().all(|(n, d)| n.dot(&m) >= d - round_off);
        if admissible && best.is_none_or(|best| m.norm_squared() < best.norm_squared()) {
            best = Some(m);
        }
    };
    for (i, (n, d)) in distinct.iter().enumerate() {
        consider(n * *d);
        for (j, (o, e)) in distinct.iter().enumerate().skip(i + 1) {
            // The shortest vector with both products equal to the depths: the mean of these along the sum, half of their difference along the difference.
            let g = n.dot(o);
            consider((n + o) * (0.5 * (d + e) / (1.0 + g)) + (n - o) * (0.5 * (d - e) / (1.0 - g)));
            for (p, f) in &distinct[j + 1..] {
                let rows = Matrix3::from_rows(&[n.transpose(), o.transpose(), p.transpose()]);
                if let Some(inverse) = rows.try_inverse() {
                    consider(inverse * Vector3::new(*d, *e, *f));
                }
            }
        }
    }
    best
}

/// Which triangles of bodies face each other.
#[derive(Debug)]
pub struct Facing<'a> {
    skin: &'a Skin,
    rules: &'a Interactions,
    /// Places of the vertices.
    x: Vec<Vector3<f64>>,
    /// Unit normals of the triangles, outward.
    normals: Vec<Vector3<f64>>,
    tree: BoundingVolumeTree,
    /// Triangles of the same body across the three sides where the surface goes on without an edge; `starts` has where those of each begin.
    starts: Vec<u32>,
    beyond: Vec<u32>,
}

impl<'a> Facing<'a> {
    /// A skin at the positions `q` (`3 * nodes`, lengths).
    pub fn new(skin: &'a Skin, rules: &'a Interactions, q: &[f64]) -> Self {
        let x: Vec<Vector3<f64>> = (0..skin.vertex_count() as u32).map(|v| skin.at(v, q)).collect();
        let triangles = skin.triangles();
        let corners = |&[a, b, c]: &[u32; 3]| [a, b, c].map(|v| x[v as usize]);
        let normal = |triangle: &[u32; 3]| {
            let [a, b, c] = corners(triangle);
            (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
        };
        let normals: Vec<Vector3<f64>> = triangles.iter().map(normal).collect();
        let boxes: Vec<Aabb> = triangles.iter().map(|triangle| Aabb::from_points(&corners(triangle))).collect();
        let body = |t: u32| rules.body(skin.facets()[skin.facet_of_triangle(t) as usize].class);
        let mut sides: Vec<(u32, [u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
        for (t, &[a, b, c]) in (0..).zip(triangles) {
            sides.extend([[a, b], [b, c], [c, a]].map(|[p, q]| (body(t), [p.min(q), p.max(q)], t)));
        }
        sides.sort_unstable();
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for at_side in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            for (k, &(_, _, s)) in at_side.iter().enumerate() {
                let goes_on = |t: &u32| normals[s as usize].dot(&normals[*t as usize]) > GOES_ON;
                let others = at_side[k + 1..].iter().map(|side| side.2).filter(goes_on);
                pairs.extend(others.flat_map(|t| [[s, t], [t, s]]));
            }
        }
        pairs.sort_unstable();
        let starts = (0..=triangles.len() as u32).map(|t| pairs.partition_point(|pair| pair[0] < t) as u32).collect();
        let beyond = pairs.into_iter().map(|pair| pair[1]).collect();
        Self { skin, rules, tree: BoundingVolumeTree::build(&boxes), x, normals, starts, beyond }
    }

    /// Unit normal of a triangle, outward.
    pub fn normal(&self, triangle: u32) -> Vector3<f64> {
        self.normals[triangle as usize]
    }

    fn class(&self, t: u32) -> u32 {
        self.skin.facets()[self.skin.facet_of_triangle(t) as usize].class
    }

    /// Body of a triangle.
    pub fn body(&self, triangle: u32) -> u32 {
        self.rules.body(self.class(triangle))
    }

    fn corners(&self, t: u32) -> [Vector3<f64>; 3] {
        self.skin.triangles()[t as usize].map(|v| self.x[v as usize])
    }

    /// Longest side of a triangle, a length.
    pub fn longest_side(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.corners(triangle);
        (b - a).norm().max((c - b).norm()).max((a - c).norm())
    }

    /// Whether a part of the second triangle is in front of the first one, or behind it by no more than `behind`.
    fn is_before(&self, t: u32, s: u32, behind: f64) -> bool {
        let (origin, normal) = (self.corners(t)[0], &self.normals[t as usize]);
        self.corners(s).iter().any(|p| (p - origin).dot(normal) >= -behind)
    }

    fn is_near(&self, s: u32, t: u32, reach: f64) -> bool {
        let (p, q) = (self.corners(s), self.corners(t));
        let square = reach * reach;
        let corner_near = |p: &[Vector3<f64>; 3], [a, b, c]: [Vector3<f64>; 3]| {
            p.iter().any(|p| closest(PairKind::VertexTriangle, &[*p, a, b, c]).distance_squared < square)
        };
        let sides = |[a, b, c]: [Vector3<f64>; 3]| [[a, b], [b, c], [c, a]];
        let sides_near = || {
            sides(p).iter().any(|[a, b]| {
                sides(q).iter().any(|[c, d]| closest(PairKind::EdgeEdge, &[*a, *b, *c, *d]).distance_squared < square)
            })
        };
        corner_near(&p, q) || corner_near(&q, p) || sides_near()
    }

    /// Triangles of a body that face another one, or the same one elsewhere, by the numbers of both: within `reach` of the triangle (a length), with normals that are opposite up to 60 degrees, and each in front of the
    /// other, or behind it by no more than `behind` (a length). Only what may act on each other counts. Ascending.
    pub fn find(&self, reach: impl Fn(u32) -> f64, behind: f64) -> BTreeMap<[u32; 2], Vec<u32>> {
        let triangles = self.skin.triangles();
        let mut facing: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        let mut met: Vec<u32> = Vec::new();
        for t in 0..triangles.len() as u32 {
            let (body, class, normal, reach) = (self.body(t), self.class(t), self.normal(t), reach(t));
            met.clear();
            self.tree.query(&self.tree.item_box(t as usize).inflated(reach), |s| {
                let s = s as u32;
                let other = self.body(s);
                let is_opposite = self.normals[s as usize].dot(&normal) < -OPPOSITE && !met.contains(&other);
                let may_act = || self.rules.between(class, self.class(s)).is_some();
                let is_other =
                    || body != other || triangles[t as usize].iter().all(|v| !triangles[s as usize].contains(v));
                let faces =
                    || self.is_before(t, s, behind) && self.is_before(s, t, behind) && self.is_near(t, s, reach);
                if is_opposite && may_act() && is_other() && faces() {
                    met.push(other);
                }
            });
            for &other in &met {
                facing.entry([body, other]).or_default().push(t);
            }
        }
        facing
    }

    /// The triangles given, and all that the surface goes on to from there without an edge (20 degrees): the whole bottom of a block, all of a ball. Ascending.
    pub fn whole(&self, triangles: &[u32]) -> Vec<u32> {
        let mut marked = triangles.to_vec();
        let mut known = vec![false; self.normals.len()];
        marked.iter().for_each(|&t| known[t as usize] = true);
        let mut next = 0;
        while let Some(&t) = marked.get(next) {
            next += 1;
            for &s in &self.beyond[self.starts[t as usize] as usize..self.starts[t as usize + 1] as usize] {
                if !std::mem::replace(&mut known[s as usize], true) {
                    marked.push(s);
                }
            }
        }
        marked.sort_unstable();
        marked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Interaction, SkinFacet};
    use proptest::prelude::*;

    fn of_depth(depth: f64, normals: &[Vector3<f64>]) -> Option<Vector3<f64>> {
        mitre(&normals.iter().map(|n| (*n, depth)).collect::<Vec<_>>())
    }

    #[test]
    fn faces_edges_corners_and_wedges() {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        assert!((of_depth(1.0, &[x, x]).unwrap().norm() - 1.0).abs() < 1e-15);
        assert!((of_depth(0.2, &[x, y]).unwrap().norm() - 0.2 * 2f64.sqrt()).abs() < 1e-15);
        assert!((of_depth(1.0, &[x, y, z]).unwrap().norm() - 3f64.sqrt()).abs() < 1e-14);
        // A wedge of the angle alpha: 1 / sin(alpha / 2).
        let alpha = 0.4f64;
        let other = Vector3::new(-alpha.cos(), alpha.sin(), 0.0);
        assert!((of_depth(1.0, &[x, other]).unwrap().norm() - 1.0 / (0.5 * alpha).sin()).abs() < 1e-12);
        assert_eq!(of_depth(1.0, &[x, -x]), None);
        // Faces that face nobody: their rim stays on them, or inside of them where they lean.
        assert!((mitre(&[(z, 1.0), (x, 0.0), (y, 0.0)]).unwrap() - z).norm() < 1e-15);
        let leaning = Vector3::new(0.8, 0.0, -0.6);
        let m = mitre(&[(z, 1.0), (leaning, 0.0)]).unwrap();
        assert!((m - Vector3::new(0.75, 0.0, 1.0)).norm() < 1e-14 && m.dot(&leaning).abs() < 1e-15);
        assert!((mitre(&[(z, 1.0), (Vector3::new(0.8, 0.0, 0.6), 0.0)]).unwrap() - z).norm() < 1e-15);
        assert_eq!(mitre(&[(z, 0.0), (x, 0.0)]), Some(Vector3::zeros()));
    }

    proptest! {
        /// Admissible, and no longer than any admissible vector of a random sample.
        #[test]
        fn it_is_the_shortest(seeds in prop::collection::vec(prop::array::uniform4(-1.0..1.0f64), 1..6), tries in prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 200)) {
            let facets: Vec<(Vector3<f64>, f64)> = seeds.iter().map(|s| (Vector3::new(s[0], s[1], 1.5).normalize(), s[3].max(0.0))).collect();
            let m = mitre(&facets).unwrap();
            prop_assert!(facets.iter().all(|(n, d)| n.dot(&m) >= d - 1e-8));
            for t in tries {
                let t = Vector3::from(t);
                if facets.iter().all(|(n, d)| n.dot(&t) >= *d) {
                    prop_assert!(t.norm() >= m.norm() * (1.0 - 1e-8));
                }
            }
        }
    }

    /// Boxes between two corners, each a body.
    fn boxes(corners: &[[[f64; 3]; 2]]) -> (Vec<SkinFacet>, Vec<f64>, Interactions) {
        const FACES: [[u32; 4]; 6] =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let (mut facets, mut q) = (Vec::new(), Vec::new());
        for (body, [low, high]) in corners.iter().enumerate() {
            for z in [low[2], high[2]] {
                [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
                    .iter()
                    .for_each(|c| q.extend([c[0], c[1], z]));
            }
            let nodes = FACES.map(|face| face.map(|n| n + 8 * body as u32));
            facets.extend(nodes.map(|nodes| SkinFacet { nodes: nodes.into(), class: body as u32 }));
        }
        let mut rules = Interactions::none(&(0..corners.len() as u32).map(|b| (b, 1.0)).collect::<Vec<_>>());
        let all = Some(Interaction { modulus: 1.0, friction: None });
        (0..corners.len() as u32).for_each(|a| (0..a).for_each(|b| rules.set(a, b, all.clone())));
        (facets, q, rules)
    }

    /// Faces of a cube in the order of `boxes` that have four triangles each.
    fn faces(triangles: &[u32]) -> Vec<u32> {
        let mut faces: Vec<u32> = triangles.iter().map(|t| t / 4 % 6).collect();
        faces.dedup();
        faces
    }

    #[test]
    fn bases_face_what_they_stand_on() {
        // A block on a slab, and a plate on the block, thinner than the reach.
        let (facets, q, rules) = boxes(&[
            [[-2.0, -2.0, -1.0], [2.0, 2.0, 0.0]],
            [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]],
            [[0.0, 0.0, 1.0], [1.0, 1.0, 1.01]],
        ]);
        let skin = Skin::new(facets, &q, &|_| None);
        let facing = Facing::new(&skin, &rules, &q);
        let found = facing.find(|_| 0.1, 1e-9);
        let of = |pair: [u32; 2]| faces(&facing.whole(&found[&pair]));
        assert_eq!([of([0, 1]), of([1, 0]), of([1, 2]), of([2, 1])], [vec![1], vec![0], vec![1], vec![0]]);
        assert_eq!(found.len(), 4);
    }

    #[test]
    fn what_stands_on_an_edge_faces_with_both_sides() {
        let (facets, mut q, rules) = boxes(&[[[-2.0, -2.0, -1.0], [2.0, 2.0, 0.0]], [[0.0; 3], [1.0; 3]]]);
        // The block turned by 45 degrees about its lower edge along y.
        for x in q[24..].chunks_mut(3) {
            let s = 0.5f64.sqrt();
            (x[0], x[2]) = (s * (x[0] - x[2]), s * (x[0] + x[2]));
        }
        let skin = Skin::new(facets, &q, &|_| None);
        let facing = Facing::new(&skin, &rules, &q);
        let found = facing.find(|_| 0.1, 1e-9);
        // Both sides lean by 45 degrees: they face the slab.
        assert_eq!(found.values().map(|list| faces(list).len()).sum::<usize>(), 3);
    }
}
