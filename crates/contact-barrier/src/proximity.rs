//! Which pairs may come near each other in a step, without looking for them in every iteration.
//!
//! Every point has a region in which it is expected to stay. Pairs whose regions, grown by half of the layer's thickness, overlap are the candidates: as long as all points stay in their regions, no other pair
//! can be in the layer, nor can others pass through each other. A point that leaves its region, or is about to, gets a larger one, and the candidates are found anew.

use crate::{Interactions, PairTerm, Skin};
use nalgebra::Vector3;
use stoss_geometry::{Aabb, CandidatePair, CandidateSearch, PairKind, safe_fraction};

/// Part of the distance of a pair that an iteration leaves of it at least.
const KEEP: f64 = 0.1;

/// Room around the expected motion of a point, in parts of the motion.
const ROOM: f64 = 0.5;

/// A pair that may come near in the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Facets of the two primitives, the smaller number first.
    pub facets: [u32; 2],
    /// Points in the order of the kind.
    pub points: [u32; 4],
    /// Energy without the modulus of the layer.
    pub term: PairTerm,
    /// Classes of the first and of the second primitive.
    pub classes: [u32; 2],
    /// Whether the first primitive is a point of integration: those lie in facets, and cannot pass through others unless these do.
    pub is_inner: bool,
}

impl Candidate {
    fn key(&self) -> ([u32; 2], PairKind, [u32; 4]) {
        (self.facets, self.term.kind, self.points)
    }

    /// The four points.
    pub fn of(&self, x: &[Vector3<f64>]) -> [Vector3<f64>; 4] {
        self.points.map(|p| x[p as usize])
    }
}

/// Regions of the points and the pairs that follow.
#[derive(Debug, Default)]
pub(crate) struct Proximity {
    search: CandidateSearch,
    regions: Vec<Aabb>,
    found: Vec<CandidatePair>,
    pub candidates: Vec<Candidate>,
    margin: f64,
    thickness: f64,
}

impl Proximity {
    pub fn new(skin: &Skin, thickness: f64) -> Self {
        let points = (0..skin.point_count() as u32).collect();
        Self {
            search: CandidateSearch::new(points, skin.edges().to_vec(), skin.triangles().to_vec()),
            thickness,
            ..Self::default()
        }
    }

    /// Regions around straight motions from `x` by `increment`, and their candidates.
    pub fn begin(
        &mut self,
        skin: &Skin,
        rules: &Interactions,
        x: &[Vector3<f64>],
        increment: impl Fn(u32) -> Vector3<f64>,
    ) {
        self.regions.clear();
        let mut motions = 0.0;
        for (p, x) in x.iter().enumerate() {
            let motion = increment(p as u32);
            motions += motion.norm();
            self.regions.push(Aabb::swept(x, &(x + motion), 0.0));
        }
        self.margin = (ROOM * motions / x.len().max(1) as f64).max(0.5 * self.thickness);
        let margin = self.margin;
        self.regions.iter_mut().for_each(|region| *region = region.inflated(margin));
        self.find(skin, rules);
    }

    /// Makes sure that the points at `x` are in their regions; returns whether the candidates are new.
    pub fn hold(&mut self, skin: &Skin, rules: &Interactions, x: impl Iterator<Item = Vector3<f64>>) -> bool {
        let mut left = false;
        for (region, x) in self.regions.iter_mut().zip(x) {
            if !region.contains(&x) {
                let here = Aabb { min: x, max: x };
                let excursion = region.distance_squared(&x).sqrt();
                *region = region.union(&here.inflated(self.margin.max(ROOM * excursion)));
                left = true;
            }
        }
        if left {
            self.find(skin, rules);
        }
        left
    }

    fn find(&mut self, skin: &Skin, rules: &Interactions) {
        let Self { search, regions, found, candidates, thickness, .. } = self;
        let class = |facet: u32| skin.facets()[facet as usize].class;
        let facets = |pair: &CandidatePair| {
            let [a, b] = pair.primitives;
            match pair.kind {
                PairKind::VertexTriangle => [skin.facet_of_point(pair.points[0]), skin.facet_of_triangle(b)],
                _ => [skin.facet_of_edge(a), skin.facet_of_edge(b)],
            }
        };
        let is_inner = |pair: &CandidatePair| {
            pair.kind == PairKind::VertexTriangle && pair.points[0] as usize >= skin.vertex_count()
        };
        search.find(
            |p| regions[p as usize].inflated(0.5 * *thickness),
            |pair| {
                let [f, g] = facets(pair);
                rules.between(class(f), class(g)).is_some()
                    && !(pair.kind == PairKind::VertexTriangle && skin.is_beside(pair.points[0], pair.primitives[1]))
                    && !(is_inner(pair) && rules.share(class(f), class(g)) == 0.0)
            },
            found,
        );
        candidates.clear();
        candidates.extend(found.iter().map(|pair| {
            let [f, g] = facets(pair);
            let classes = [class(f), class(g)];
            let (weight, parallel) = match pair.kind {
                PairKind::VertexTriangle => {
                    (skin.point_weight(pair.points[0], rules.share(classes[0], classes[1])), None)
                }
                _ => {
                    let (weight, parallel) = skin.edge_weight(pair.primitives);
                    (weight, Some(parallel))
                }
            };
            Candidate {
                facets: [f.min(g), f.max(g)],
                points: pair.points,
                term: PairTerm { kind: pair.kind, weight, parallel },
                classes,
                is_inner: is_inner(pair),
            }
        }));
        candidates.sort_unstable_by_key(Candidate::key);
    }

    /// Part of the motion `increment` from `x`, at most 1, on which no pair comes nearer than a tenth of its distance.
    pub fn safe_fraction(&self, x: &[Vector3<f64>], increment: &[Vector3<f64>]) -> f64 {
        let mut fraction: f64 = 1.0;
        for candidate in self.candidates.iter().filter(|candidate| !candidate.is_inner) {
            let [x, d] = [candidate.of(x), candidate.of(increment)];
            let first = candidate.term.kind.first_count();
            let around = |of: std::ops::Range<usize>| {
                of.fold(Aabb::empty(), |all, i| all.union(&Aabb::swept(&x[i], &(x[i] + d[i]), 0.0)))
            };
            // Boxes that stay apart by more than the layer leave enough of any distance that matters.
            if around(0..first).inflated(self.thickness).overlaps(&around(first..4)) {
                fraction = fraction.min(safe_fraction(candidate.term.kind, &x, &d, KEEP));
            }
        }
        fraction
    }
}
