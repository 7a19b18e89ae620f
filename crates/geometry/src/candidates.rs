//! Pairs of primitives whose boxes overlap: what may come near each other in a step.
//!
//! A primitive moves inside the box around the boxes of its points, as long as every point stays in its own. So it is enough to say where each *point* may be: at one place, or on
//! the straight line from a start to an end ([`Aabb::swept`]), and half of the distance more that is of interest. Pairs that share a point are none: their distance is zero.
//!
//! The pairs come sorted by kind and points, whatever the order of the lists and the structure of the trees, so sums over them have the same bits everywhere.

use crate::{Aabb, BoundingVolumeTree, PairKind};

/// A pair of primitives; ordered by kind, then points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CandidatePair {
    /// [`PairKind::VertexTriangle`] or [`PairKind::EdgeEdge`].
    pub kind: PairKind,
    /// Points in the order of the kind. Of two edges the one with the smaller numbers comes first.
    pub points: [u32; 4],
    /// Places of the two primitives in the lists of the search: vertex and triangle, or edge and edge.
    pub primitives: [u32; 2],
}

/// Vertices against triangles, edges against edges.
#[derive(Clone, Debug, Default)]
pub struct CandidateSearch {
    vertices: Vec<u32>,
    edges: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    edge_tree: BoundingVolumeTree,
    triangle_tree: BoundingVolumeTree,
}

impl CandidateSearch {
    /// A search for pairs of one of the vertices and one of the triangles, and of two of the edges, as numbers of points. Each primitive should be listed once.
    pub fn new(vertices: Vec<u32>, edges: Vec<[u32; 2]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { vertices, edges, triangles, ..Self::default() }
    }

    /// Builds the trees anew at the next search. They are fitted to the boxes of every search; this is worth it after large motions.
    pub fn rebuild(&mut self) {
        self.edge_tree = BoundingVolumeTree::default();
        self.triangle_tree = BoundingVolumeTree::default();
    }

    /// Replaces `found` by all pairs without a common point whose boxes overlap and that `admits` takes, sorted.
    ///
    /// `box_of(point)` is where a point may be. It is asked several times for each point.
    pub fn find(
        &mut self,
        box_of: impl Fn(u32) -> Aabb,
        admits: impl Fn(&CandidatePair) -> bool,
        found: &mut Vec<CandidatePair>,
    ) {
        found.clear();
        let Self { vertices, edges, triangles, edge_tree, triangle_tree } = self;
        fit(triangle_tree, triangles, &box_of);
        fit(edge_tree, edges, &box_of);
        for (v, &p) in vertices.iter().enumerate() {
            triangle_tree.query(&box_of(p), |t| {
                let [a, b, c] = triangles[t];
                let pair = CandidatePair {
                    kind: PairKind::VertexTriangle,
                    points: [p, a, b, c],
                    primitives: [v as u32, t as u32],
                };
                if ![a, b, c].contains(&p) && admits(&pair) {
                    found.push(pair);
                }
            });
        }
        for (k, &e) in edges.iter().enumerate() {
            edge_tree.query(edge_tree.item_box(k), |l| {
                let f = edges[l];
                // Each pair is met twice.
                if l <= k || e.iter().any(|p| f.contains(p)) {
                    return;
                }
                let ([[a, b], [c, d]], [k, l]) = if e < f { ([e, f], [k, l]) } else { ([f, e], [l, k]) };
                let (points, primitives) = ([a, b, c, d], [k as u32, l as u32]);
                let pair = CandidatePair { kind: PairKind::EdgeEdge, points, primitives };
                if admits(&pair) {
                    found.push(pair);
                }
            });
        }
        found.sort_unstable();
    }
}

/// Fits a tree to primitives; builds it if there is none.
fn fit<const N: usize>(tree: &mut BoundingVolumeTree, primitives: &[[u32; N]], box_of: impl Fn(u32) -> Aabb) {
    let around = |item: usize| primitives[item].iter().fold(Aabb::empty(), |b, &p| b.union(&box_of(p)));
    if tree.len() == primitives.len() {
        tree.refit(around);
    } else {
        let boxes: Vec<Aabb> = (0..primitives.len()).map(around).collect();
        *tree = BoundingVolumeTree::build(&boxes);
    }
}

/// All edges of triangles, each once, with the smaller number first; sorted.
pub fn edges_of(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}
