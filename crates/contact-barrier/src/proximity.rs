//! Which pairs may come near each other in a step, without looking for them in every iteration.
//!
//! All points follow a *path*: straight lines from common starts, passed during the same time, and some room around them. Pairs that the paths, with the room, may bring together are the candidates: as long
//! as the points are somewhere on their paths, all at the same time, no other pair can be in the layer, nor can others pass through each other. Only relative motion counts, so a body that flies, turns or
//! bends far in a step has no more candidates than one at rest. Where an iterate leaves the paths, they start again from it.

use crate::{Interactions, Skin};
use nalgebra::Vector3;
use stoss_geometry::{BoundingVolume, BoundingVolumeTree, ClosestPair, MovingBox, PairKind, closest, safe_fraction};

/// Part of the distance of a pair that an iteration leaves of it at least.
const KEEP: f64 = 0.1;

/// Room around the paths, in parts of the mean motion, and at most in parts of a mean edge.
const ROOM: [f64; 2] = [0.5, 0.1];

/// Candidates on a path: so many for each point, and so many in any case. A motion over many facets at once would make every pair one: it is shortened until they are fewer.
const MOST: [usize; 2] = [250, 200_000];

/// A path is not made shorter than this part of the motion.
const SHORTEST: f64 = 1.0 / 1024.0;

/// A pair that may come near in the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Facets of the two primitives, the smaller number first.
    pub facets: [u32; 2],
    /// What the primitives are.
    pub kind: PairKind,
    /// Points in the order of the kind.
    pub points: [u32; 4],
    /// The triangle that a point is against, twice; or the two edges in the order of the points.
    pub of: [u32; 2],
    /// Classes of the first and of the second primitive.
    pub classes: [u32; 2],
    /// Whether the first primitive is a point of integration: those lie in facets, and cannot pass through others unless these do.
    pub is_integration_point: bool,
}

impl Candidate {
    fn key(&self) -> ([u32; 2], PairKind, [u32; 4]) {
        (self.facets, self.kind, self.points)
    }

    /// The four points.
    pub fn of(&self, x: &[Vector3<f64>]) -> [Vector3<f64>; 4] {
        self.points.map(|p| x[p as usize])
    }

    /// Whether the two primitives may come nearer than `distance` on the way from `x` by `motion`.
    pub fn may_meet(&self, x: &[Vector3<f64>; 4], motion: &[Vector3<f64>; 4], distance: f64) -> bool {
        let first = self.kind.first_count();
        let around = |of: std::ops::Range<usize>| {
            of.fold(MovingBox::empty(), |all, i| all.union(&MovingBox::new(&x[i], &motion[i], 0.5 * distance)))
        };
        around(0..first).overlaps(&around(first..4))
    }
}

/// The paths of the points and the pairs that follow.
#[derive(Debug, Default)]
pub(crate) struct Proximity {
    /// Facets of each class, and a tree over them.
    trees: Vec<(Vec<u32>, BoundingVolumeTree<MovingBox>)>,
    triangles: Vec<MovingBox>,
    edges: Vec<MovingBox>,
    start: Vec<Vector3<f64>>,
    motion: Vec<Vector3<f64>>,
    room: f64,
    pub candidates: Vec<Candidate>,
    /// Candidates from the start of the step, which remain candidates wherever they go.
    kept: Vec<Candidate>,
    thickness: f64,
    edge: f64,
    most: [usize; 2],
}

impl Proximity {
    pub fn new(skin: &Skin, thickness: f64) -> Self {
        let count = skin.facets().iter().map(|facet| facet.class as usize + 1).max().unwrap_or(0);
        let mut trees = vec![(Vec::new(), BoundingVolumeTree::default()); count];
        for (f, facet) in skin.facets().iter().enumerate() {
            trees[facet.class as usize].0.push(f as u32);
        }
        Self { trees, thickness, edge: skin.mean_edge(), most: MOST, ..Self::default() }
    }

    /// Paths from `x` by `motion`, and their candidates.
    pub fn begin(
        &mut self,
        skin: &Skin,
        rules: &Interactions,
        x: &[Vector3<f64>],
        motion: impl Fn(u32) -> Vector3<f64>,
    ) {
        self.kept.clear();
        self.follow(skin, rules, x, &(0..x.len() as u32).map(motion).collect::<Vec<_>>());
    }

    /// Keeps the candidates for the rest of the step: what acts, and what begins, is decided by places at its start, which must not be missing later.
    pub fn keep(&mut self) {
        self.kept.clone_from(&self.candidates);
    }

    /// Makes sure that the way from `x` by a part of `increment` (none: no motion) is on the paths; returns that part, and whether the candidates are new. The part is less than 1 where all
    /// of it would make too many candidates.
    pub fn hold(
        &mut self,
        skin: &Skin,
        rules: &Interactions,
        x: &[Vector3<f64>],
        increment: Option<&[Vector3<f64>]>,
    ) -> (f64, bool) {
        let is_held = match increment {
            None => self.holds(x.iter().copied()),
            Some(d) => self.holds(x.iter().copied()) && self.holds(x.iter().zip(d).map(|(x, d)| x + d)),
        };
        if is_held {
            return (1.0, false);
        }
        let motion: Vec<_> = (0..x.len()).map(|p| increment.map_or_else(Vector3::zeros, |d| d[p])).collect();
        (self.follow(skin, rules, x, &motion), true)
    }

    /// Whether the points are on their paths, with the room around them, all at the same time. The points between two such places are, too.
    fn holds(&self, x: impl Iterator<Item = Vector3<f64>> + Clone) -> bool {
        let paths = || self.start.iter().zip(&self.motion);
        let (along, square) = x.clone().zip(paths()).fold((0.0, 0.0), |(along, square), (x, (start, motion))| {
            (along + (x - start).dot(motion), square + motion.norm_squared())
        });
        let t = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
        x.zip(paths()).all(|(x, (start, motion))| (x - start - motion * t).amax() <= self.room)
    }

    fn follow(&mut self, skin: &Skin, rules: &Interactions, x: &[Vector3<f64>], motion: &[Vector3<f64>]) -> f64 {
        let mut part = 1.0;
        let moves = motion.iter().any(|d| *d != Vector3::zeros());
        while !self.try_follow(skin, rules, x, motion.iter().map(|d| d * part), moves && part > SHORTEST) {
            part *= 0.5;
        }
        part
    }

    /// Begins the paths again; false if that makes too many candidates, and these are `limited`.
    fn try_follow(
        &mut self,
        skin: &Skin,
        rules: &Interactions,
        x: &[Vector3<f64>],
        motion: impl Iterator<Item = Vector3<f64>>,
        limited: bool,
    ) -> bool {
        self.start.clear();
        self.start.extend_from_slice(x);
        self.motion.clear();
        self.motion.extend(motion);
        let mean = self.motion.iter().map(Vector3::norm).sum::<f64>() / x.len().max(1) as f64;
        let [part, most] = ROOM;
        self.room = (part * mean).min(most * self.edge).max(0.5 * self.thickness);
        let [each, any] = self.most;
        self.find(skin, rules, if limited { any.max(each * x.len()) } else { usize::MAX })
    }

    /// Finds the candidates; false if there are more than `most`, of which the rest is not looked for.
    fn find(&mut self, skin: &Skin, rules: &Interactions, most: usize) -> bool {
        let Self { trees, triangles, edges, start, motion, room, candidates, kept, thickness, .. } = self;
        let around = *room + 0.5 * *thickness;
        let of_point = |p: &u32| MovingBox::new(&start[*p as usize], &motion[*p as usize], around);
        let of_points = |points: &[u32]| points.iter().map(of_point).fold(MovingBox::empty(), |a, b| a.union(&b));
        triangles.clear();
        triangles.extend(skin.triangles().iter().map(|points| of_points(points)));
        edges.clear();
        edges.extend(skin.edges().iter().map(|points| of_points(points)));
        let paths = Paths { skin, start, motion, triangles, edges, around };
        for (facets, tree) in trees.iter_mut() {
            let around = |k: usize| paths.of_facet(facets[k]);
            if tree.len() == facets.len() {
                tree.refit(around);
            } else {
                *tree = BoundingVolumeTree::build(&(0..facets.len()).map(around).collect::<Vec<_>>());
            }
        }
        candidates.clear();
        for (a, (first, tree)) in trees.iter().enumerate() {
            for (b, (second, other)) in trees.iter().enumerate().skip(a) {
                if rules.between(a as u32, b as u32).is_none() {
                    continue;
                }
                let mut visit = |k: usize, l: usize| {
                    if candidates.len() <= most {
                        paths.pairs(first[k], second[l], candidates);
                    }
                };
                if a == b {
                    tree.own_pairs(&mut visit);
                } else {
                    tree.pairs(other, &mut visit);
                }
            }
        }
        let is_complete = candidates.len() <= most;
        candidates.extend_from_slice(kept);
        candidates.sort_unstable_by_key(Candidate::key);
        candidates.dedup_by_key(|candidate| candidate.key());
        is_complete
    }

    /// Whether a pair is in the layer at the start of the paths or at their end; most of the others are there for the room around them.
    pub fn expects(&self, candidate: &Candidate) -> bool {
        let (x, motion) = (candidate.of(&self.start), candidate.of(&self.motion));
        candidate.may_meet(&x, &motion, self.thickness)
            && [0.0, 1.0].iter().any(|&t| {
                let there = std::array::from_fn(|i| x[i] + motion[i] * t);
                closest(candidate.kind, &there).distance_squared < self.thickness * self.thickness
            })
    }

    /// Part of the motion `increment` from `x`, at most 1, on which no pair comes nearer than a tenth of its distance.
    pub fn safe_fraction(&self, x: &[Vector3<f64>], increment: &[Vector3<f64>]) -> (f64, Option<&Candidate>) {
        let mut least = (1.0, None);
        for candidate in self.candidates.iter().filter(|candidate| !candidate.is_integration_point) {
            let [x, d] = [candidate.of(x), candidate.of(increment)];
            // What stays apart by more than the layer leaves enough of any distance that matters.
            if candidate.may_meet(&x, &d, self.thickness) {
                let fraction = safe_fraction(candidate.kind, &x, &d, KEEP);
                if fraction < least.0 {
                    least = (fraction, Some(candidate));
                }
            }
        }
        least
    }
}

/// Where the points may be.
struct Paths<'a> {
    skin: &'a Skin,
    start: &'a [Vector3<f64>],
    motion: &'a [Vector3<f64>],
    triangles: &'a [MovingBox],
    edges: &'a [MovingBox],
    around: f64,
}

impl Paths<'_> {
    fn of_point(&self, p: u32) -> MovingBox {
        MovingBox::new(&self.start[p as usize], &self.motion[p as usize], self.around)
    }

    fn of_facet(&self, facet: u32) -> MovingBox {
        let triangles = self.skin.triangles_of(facet);
        triangles.iter().fold(MovingBox::empty(), |all, &t| all.union(&self.triangles[t as usize]))
    }

    fn class(&self, facet: u32) -> u32 {
        self.skin.facets()[facet as usize].class
    }

    /// Adds the pairs of primitives of two facets, which may be the same.
    fn pairs(&self, f: u32, g: u32, found: &mut Vec<Candidate>) {
        self.points_on(f, g, found);
        if f != g {
            self.points_on(g, f, found);
        }
        self.edges_on(f, g, found);
    }

    /// Points of `f` against triangles of `g`.
    fn points_on(&self, f: u32, g: u32, found: &mut Vec<Candidate>) {
        let (skin, whole) = (self.skin, self.of_facet(g));
        let classes = [f, g].map(|facet| self.class(facet));
        let mut add = |point: u32| {
            let here = self.of_point(point);
            if !here.overlaps(&whole) {
                return;
            }
            for &t in skin.triangles_of(g) {
                if !skin.is_adjacent(point, t) && here.overlaps(&self.triangles[t as usize]) {
                    let [a, b, c] = skin.triangles()[t as usize];
                    found.push(Candidate {
                        facets: [f.min(g), f.max(g)],
                        kind: PairKind::VertexTriangle,
                        points: [point, a, b, c],
                        of: [t, t],
                        classes,
                        is_integration_point: skin.is_integration_point(point),
                    });
                }
            }
        };
        skin.vertices_of(f).iter().for_each(|&v| add(v));
        skin.triangles_of(f).iter().flat_map(|&t| skin.integration_points(t)).for_each(add);
    }

    /// Edges of `f` against edges of `g`.
    fn edges_on(&self, f: u32, g: u32, found: &mut Vec<Candidate>) {
        let (skin, whole) = (self.skin, self.of_facet(g));
        for &k in skin.edges_of(f) {
            let e = skin.edges()[k as usize];
            let here = &self.edges[k as usize];
            if !here.overlaps(&whole) {
                continue;
            }
            for &l in skin.edges_of(g) {
                let other = skin.edges()[l as usize];
                // Within a facet each pair is met twice.
                let is_pair = (f != g || k < l) && e.iter().all(|p| !other.contains(p));
                if is_pair && here.overlaps(&self.edges[l as usize]) {
                    // The edge with the smaller numbers comes first.
                    let ([[a, b], [c, d]], [f, g], of) =
                        if e < other { ([e, other], [f, g], [k, l]) } else { ([other, e], [g, f], [l, k]) };
                    found.push(Candidate {
                        facets: [f.min(g), f.max(g)],
                        kind: PairKind::EdgeEdge,
                        points: [a, b, c, d],
                        of,
                        classes: [f, g].map(|facet| self.class(facet)),
                        is_integration_point: false,
                    });
                }
            }
        }
    }
}

/// The nearest one of some candidates at `x`, and how.
pub(crate) fn nearest(candidates: &[Candidate], of: &[u32], x: &[Vector3<f64>]) -> Option<(u32, ClosestPair)> {
    let all = of.iter().map(|&k| {
        let c = &candidates[k as usize];
        (k, closest(c.kind, &c.of(x)))
    });
    all.min_by(|a, b| a.1.distance_squared.total_cmp(&b.1.distance_squared))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Interaction, SkinFacet};
    use fastrand::Rng;
    use stoss_reference_element::FacetNodes;

    const THICKNESS: f64 = 0.05;

    /// Loose quadrilaterals and triangles of two classes, with common nodes within each.
    fn soup(rng: &mut Rng) -> (Skin, Vec<f64>) {
        let mut facets = Vec::new();
        for class in 0..2u32 {
            let first = class * 12;
            for _ in 0..6 {
                let mut nodes: Vec<u32> = (first..first + 12).collect();
                rng.shuffle(&mut nodes);
                let nodes = match rng.bool() {
                    true => FacetNodes::from([nodes[0], nodes[1], nodes[2], nodes[3]]),
                    false => FacetNodes::from([nodes[0], nodes[1], nodes[2]]),
                };
                facets.push(SkinFacet { nodes, class });
            }
        }
        let q: Vec<f64> = (0..72).map(|_| rng.f64()).collect();
        (Skin::new(facets, &q, &|_| None), q)
    }

    /// Every pair of primitives that may act.
    fn all(skin: &Skin, rules: &Interactions) -> Vec<(PairKind, [u32; 4])> {
        let class = |facet: u32| skin.facets()[facet as usize].class;
        let mut pairs = Vec::new();
        for p in 0..skin.point_count() as u32 {
            for (t, &[a, b, c]) in skin.triangles().iter().enumerate() {
                let classes = [u32::from(skin.terms(p)[0].0 >= 12), class(skin.facet_of_triangle(t as u32))];
                if rules.between(classes[0], classes[1]).is_some() && !skin.is_adjacent(p, t as u32) {
                    pairs.push((PairKind::VertexTriangle, [p, a, b, c]));
                }
            }
        }
        for (k, e) in skin.edges().iter().enumerate() {
            for (l, f) in skin.edges().iter().enumerate().skip(k + 1) {
                let classes = [k, l].map(|edge| class(skin.facet_of_edge(edge as u32)));
                if rules.between(classes[0], classes[1]).is_some() && e.iter().all(|p| !f.contains(p)) {
                    pairs.push((PairKind::EdgeEdge, [e[0], e[1], f[0], f[1]]));
                }
            }
        }
        pairs
    }

    /// What comes into the layer on the paths, with the room around them, is a candidate, and so is what was kept; the paths start again where they are left.
    #[test]
    fn nothing_near_is_missed() {
        let mut rng = Rng::with_seed(7);
        let (mut near, mut renewed) = (0, 0);
        for case in 0..60 {
            let (skin, q) = soup(&mut rng);
            let mut rules = Interactions::none(&[(0, 1.0), (1, 1.0)]);
            for (a, b) in [(0, 0), (0, 1), (1, 1)].into_iter().filter(|&(a, b)| a != b || case % 2 == 0) {
                rules.set(a, b, Some(Interaction { modulus: 1.0, friction: None }));
            }
            let all = all(&skin, &rules);
            let place = |q: &[f64]| (0..skin.point_count() as u32).map(|p| skin.at(p, q)).collect::<Vec<_>>();
            let wild =
                |rng: &mut Rng, size: f64| (0..q.len()).map(|_| size * (2.0 * rng.f64() - 1.0)).collect::<Vec<_>>();
            // A large common motion, and a small one of each node.
            let motion: Vec<f64> =
                wild(&mut rng, 0.1).iter().enumerate().map(|(i, d)| d + [30.0, 5.0, -9.0][i % 3]).collect();
            let (x, d) = (place(&q), place(&motion));
            let mut proximity = Proximity::new(&skin, THICKNESS);
            proximity.begin(&skin, &rules, &x, |p| d[p as usize]);
            let is_inside = |pair: &(PairKind, [u32; 4]), x: &[Vector3<f64>]| {
                closest(pair.0, &pair.1.map(|p| x[p as usize])).distance_squared.sqrt() < THICKNESS
            };
            let first: Vec<_> = proximity.candidates.iter().map(Candidate::key).collect();
            proximity.keep();
            let mut check = |proximity: &Proximity, x: &[Vector3<f64>]| {
                for pair in all.iter().filter(|pair| is_inside(pair, x)) {
                    near += 1;
                    let found = proximity.candidates.iter().any(|c| (c.kind, c.points) == *pair);
                    assert!(found, "case {case}: {pair:?}");
                }
            };
            for t in [0.0, 0.3, 1.0] {
                let deviation = place(&wild(&mut rng, 0.99 * proximity.room));
                let there: Vec<_> = (0..x.len()).map(|p| x[p] + d[p] * t + deviation[p]).collect();
                check(&proximity, &there);
            }
            // Elsewhere, and from there by a large motion.
            let far: Vec<_> = x.iter().map(|x| x * 1.3).collect();
            renewed += usize::from(proximity.hold(&skin, &rules, &far, Some(&d)) == (1.0, true));
            for t in [0.0, 0.5, 1.0] {
                let there: Vec<_> = (0..x.len()).map(|p| far[p] + d[p] * t).collect();
                check(&proximity, &there);
                assert!(!proximity.hold(&skin, &rules, &there, None).1, "the way is on the paths");
            }
            let now: std::collections::BTreeSet<_> = proximity.candidates.iter().map(Candidate::key).collect();
            assert!(first.iter().all(|key| now.contains(key)), "what was kept");
        }
        assert!(near > 1000 && renewed == 60, "{near} pairs near, {renewed} renewed");
    }

    /// Motions past many facets are shortened; on what is left of them nothing is missed.
    #[test]
    fn wild_motions_are_shortened() {
        let mut rng = Rng::with_seed(3);
        let (mut near, mut shortened) = (0, 0);
        for _ in 0..30 {
            let (skin, q) = soup(&mut rng);
            let mut rules = Interactions::none(&[(0, 1.0), (1, 1.0)]);
            rules.set(0, 1, Some(Interaction { modulus: 1.0, friction: None }));
            let place = |q: &[f64]| (0..skin.point_count() as u32).map(|p| skin.at(p, q)).collect::<Vec<_>>();
            let motion: Vec<f64> = (0..q.len()).map(|_| 20.0 * (rng.f64() - 0.5)).collect();
            let (x, d) = (place(&q), place(&motion));
            let mut proximity = Proximity::new(&skin, THICKNESS);
            proximity.begin(&skin, &rules, &x, |_| Vector3::zeros());
            let at_rest = proximity.candidates.len();
            proximity.most = [0, 2 * at_rest + 100];
            let (part, is_new) = proximity.hold(&skin, &rules, &x, Some(&d));
            assert!(is_new && part > SHORTEST, "{part:e}");
            assert!(proximity.candidates.len() <= 2 * at_rest + 100);
            shortened += usize::from(part < 1.0);
            for t in [0.0, 0.5, 1.0] {
                let there: Vec<_> = (0..x.len()).map(|p| x[p] + d[p] * (part * t)).collect();
                assert!(!proximity.hold(&skin, &rules, &there, None).1, "the way is on the paths");
                for (kind, points) in all(&skin, &rules) {
                    let distance = closest(kind, &points.map(|p| there[p as usize])).distance_squared.sqrt();
                    if distance < THICKNESS {
                        near += 1;
                        let is_known = proximity.candidates.iter().any(|c| (c.kind, c.points) == (kind, points));
                        assert!(is_known, "{points:?}");
                    }
                }
            }
            // Nothing moves: all of them.
            proximity.most = [0, 1];
            proximity.begin(&skin, &rules, &x, |_| Vector3::zeros());
            assert_eq!(proximity.candidates.len(), at_rest);
        }
        assert!(near > 300 && shortened > 20, "{near} near, {shortened} shortened");
    }
}
