//! Closest points of pairs of primitives: vertex and triangle, edge and edge, vertex and edge, two vertices.
//!
//! A pair has up to four points `x_i`. A point of the first primitive minus one of the second is `r = sum_i c_i x_i` with weights whose
//! sum is zero; the weights of all such pairs of points are the compact convex set `K` of [`PairKind`]. The squared distance is
//! `D = min over K of |r|^2`, and [`closest`] gives weights of the minimum. Which of them are zero tells the features (corners, edges, insides)
//! that are closest, and so in which directions the minimum may move: [`ClosestPair::free_directions`].
//!
//! It is not a signed distance: a pair that has passed through each other has a positive distance again.
//!
//! **Accuracy.** The minimum of a sliver or of nearly parallel edges is found by orthogonalisation, not by normal equations: the weights are
//! those of points moved by a few units of round-off, so `D` is, for *any* shape, exact to a few units of round-off of `d L` and of `L^2 eps`, with
//! `d` the distance and `L` the largest distance of two points. Weights themselves are as ill-conditioned as the pair is.
//!
//! **Degenerate pairs.** An edge of length zero counts as its first corner, a triangle without area as its three edges. Of several closest
//! points (parallel edges that overlap) one is taken: an end of an edge, the first in the order of the points. Coordinates whose squared differences
//! underflow count as equal; no finite input whose squared differences do not overflow gives a NaN.

use nalgebra::Vector3;

/// What the two primitives of a pair are, and so the order of its points and the set `K` of its weights.
///
/// Where a pair has fewer than four points, the weights of the others are zero, and the others may be any finite points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PairKind {
    /// Vertex `x_0`, triangle `x_1 x_2 x_3`: `c = (1, -b_1, -b_2, -b_3)`, `b >= 0`, `b_1 + b_2 + b_3 = 1`.
    VertexTriangle,
    /// Edge `x_0 x_1`, edge `x_2 x_3`: `c = (1 - s, s, -(1 - t), -t)`, `s` and `t` from 0 to 1.
    EdgeEdge,
    /// Vertex `x_0`, edge `x_1 x_2`: `c = (1, -(1 - t), -t, 0)`, `t` from 0 to 1.
    VertexEdge,
    /// Vertices `x_0` and `x_1`: `c = (1, -1, 0, 0)`.
    VertexVertex,
}

impl PairKind {
    /// Number of points.
    pub const fn point_count(self) -> usize {
        match self {
            Self::VertexTriangle | Self::EdgeEdge => 4,
            Self::VertexEdge => 3,
            Self::VertexVertex => 2,
        }
    }

    /// Number of points of the first primitive; those of the second follow.
    pub const fn first_count(self) -> usize {
        match self {
            Self::EdgeEdge => 2,
            Self::VertexTriangle | Self::VertexEdge | Self::VertexVertex => 1,
        }
    }
}

/// The features in whose insides the closest points lie, by the places of their points in the pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairFeature {
    /// A corner of the first primitive, one of the second.
    VertexVertex([usize; 2]),
    /// A corner (of either primitive), and the inside of an edge of the other.
    VertexEdge(usize, [usize; 2]),
    /// The vertex and the inside of the triangle.
    VertexTriangle,
    /// The insides of both edges.
    EdgeEdge,
}

/// Result of [`closest`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPair {
    /// The kind that was asked for.
    pub kind: PairKind,
    /// Weights `c` of the closest points; those of corners that take no part are exactly zero.
    pub weights: [f64; 4],
    /// Squared distance `D = |sum_i c_i x_i|^2`.
    pub distance_squared: f64,
}

/// Directions in which the weights of the closest points may move to either side; see [`ClosestPair::free_directions`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeDirections {
    directions: [[f64; 4]; 2],
    count: usize,
}

impl FreeDirections {
    /// The directions `B_a`, none to two of them.
    pub fn as_slice(&self) -> &[[f64; 4]] {
        &self.directions[..self.count]
    }
}

/// `sum_i c_i x_i` for weights whose sum is zero, from differences of the points: a common translation costs no digits.
pub fn combine(weights: &[f64; 4], points: &[Vector3<f64>; 4]) -> Vector3<f64> {
    (points[1] - points[0]) * weights[1] + (points[2] - points[0]) * weights[2] + (points[3] - points[0]) * weights[3]
}

/// Weights of the closest points of a pair, and its squared distance. See the head of the module for accuracy and degenerate pairs.
///
/// ```
/// use nalgebra::Vector3;
/// use stoss_geometry::{PairFeature, PairKind, closest};
/// let [p, a] = [Vector3::new(0.25, 0.5, 2.0), Vector3::zeros()];
/// let pair = closest(PairKind::VertexTriangle, &[p, a, Vector3::x(), Vector3::y()]);
/// assert_eq!(pair.weights, [1.0, -0.25, -0.25, -0.5]);
/// assert_eq!(pair.distance_squared, 4.0);
/// assert_eq!(pair.feature(), PairFeature::VertexTriangle);
/// ```
pub fn closest(kind: PairKind, points: &[Vector3<f64>; 4]) -> ClosestPair {
    let mut best = Best::new(kind, points);
    match kind {
        PairKind::VertexTriangle => vertex_triangle(&mut best),
        PairKind::EdgeEdge => edge_edge(&mut best),
        PairKind::VertexEdge => best.try_vertex_edge(0, [1, 2]),
        PairKind::VertexVertex => best.take([1.0, -1.0, 0.0, 0.0]),
    }
    best.pair
}

impl ClosestPair {
    /// The features in whose insides the closest points lie: those whose corners have a weight.
    pub fn feature(&self) -> PairFeature {
        let first = self.kind.first_count();
        let carries = |i: &usize| self.weights[*i] != 0.0;
        let mut on_first = (0..first).filter(carries);
        let mut on_second = (first..4).filter(carries);
        let (a, b) = (on_first.next().unwrap_or(0), on_second.next().unwrap_or(first));
        match (on_first.next(), on_second.next(), on_second.next()) {
            (None, None, _) => PairFeature::VertexVertex([a, b]),
            (None, Some(end), None) => PairFeature::VertexEdge(a, [b, end]),
            (Some(end), None, _) => PairFeature::VertexEdge(b, [a, end]),
            (Some(_), Some(_), _) => PairFeature::EdgeEdge,
            (None, Some(_), Some(_)) => PairFeature::VertexTriangle,
        }
    }

    /// A basis `B_a` of the directions in which the weights may move to either side without leaving `K` or the present features.
    ///
    /// `c + sum_a gamma_a B_a` is a pair of points of the same features for small `gamma`; at the minimum `r . sum_i B_ai x_i = 0`. The sum of each direction is zero.
    /// There are two for the inside of a triangle and for two crossing edges, one for a corner and an edge, none for two corners. An entry is 1, -1 or 0.
    pub fn free_directions(&self) -> FreeDirections {
        let mut free = FreeDirections { directions: [[0.0; 4]; 2], count: 0 };
        let first = self.kind.first_count();
        for (range, sign) in [(0..first, -1.0), (first..4, 1.0)] {
            let mut base = None;
            for i in range {
                if self.weights[i] == 0.0 {
                    continue;
                }
                match base {
                    None => base = Some(i),
                    Some(base) => {
                        free.directions[free.count][base] = sign;
                        free.directions[free.count][i] = -sign;
                        free.count += 1;
                    }
                }
            }
        }
        free
    }
}

/// The best weights so far.
struct Best<'a> {
    points: &'a [Vector3<f64>; 4],
    pair: ClosestPair,
    /// Amount by which the best weights violate the condition of the minimum.
    violation: f64,
    /// Round-off of a difference of two points.
    noise: f64,
}

impl<'a> Best<'a> {
    fn new(kind: PairKind, points: &'a [Vector3<f64>; 4]) -> Self {
        let extent = points[1..kind.point_count()].iter().map(|x| (x - points[0]).norm()).fold(0.0, f64::max);
        let pair = ClosestPair { kind, weights: [0.0; 4], distance_squared: f64::INFINITY };
        Self { points, pair, violation: f64::INFINITY, noise: 4.0 * f64::EPSILON * extent }
    }

    /// Takes the weights, without a look at what was there.
    fn take(&mut self, weights: [f64; 4]) {
        self.pair.weights = weights;
        self.pair.distance_squared = combine(&weights, self.points).norm_squared();
    }

    /// Takes the weights if they are better than those so far: nearer by more than round-off, or else with less violation of the condition of the minimum.
    ///
    /// That condition is `r . (x_i - x_j) >= D` for all corners `(i, j)` of `K`. Next to the minimum a comparison of squared distances resolves weights to the root of round-off only, and
    /// `r . dr` is what the work of a contact force depends on; next to a contact the condition has no digits, and the distance has.
    fn try_weights(&mut self, weights: [f64; 4]) {
        let (x, kind) = (self.points, self.pair.kind);
        let r = combine(&weights, x);
        let distance_squared = r.norm_squared();
        let along = |i: usize| r.dot(&(x[i] - x[0]));
        let first = (0..kind.first_count()).map(along).fold(f64::INFINITY, f64::min);
        let second = (kind.first_count()..kind.point_count()).map(along).fold(f64::NEG_INFINITY, f64::max);
        let violation = distance_squared - (first - second);
        let gain = self.pair.distance_squared - distance_squared;
        let noise = self.noise * (self.noise + self.pair.distance_squared.sqrt());
        // The first one is taken in any case, also where squares overflow.
        if gain > noise || (gain >= -noise && violation < self.violation) || self.pair.weights == [0.0; 4] {
            self.pair.weights = weights;
            self.pair.distance_squared = distance_squared;
            self.violation = violation;
        }
    }

    /// The closest point of the closed edge to a corner of the other primitive.
    fn try_vertex_edge(&mut self, vertex: usize, edge: [usize; 2]) {
        let [a, b] = edge.map(|k| self.points[k]);
        let e = b - a;
        let t = (self.points[vertex] - a).dot(&e) / e.norm_squared();
        // The place on an edge of length zero is not a number, which is not positive: its first corner.
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        let sign = if vertex < self.pair.kind.first_count() { 1.0 } else { -1.0 };
        let mut weights = [0.0; 4];
        weights[vertex] = sign;
        weights[edge[0]] = -sign * (1.0 - t);
        weights[edge[1]] = -sign * t;
        self.try_weights(weights);
    }
}

/// Squared sine below which a pair counts as ill-conditioned: the inside is compared with the boundary.
const ILL_CONDITIONED: f64 = 1e-12;

/// Squared sine below which what is left of a vector after orthogonalisation is round-off alone.
const PARALLEL: f64 = 16.0 * f64::EPSILON * f64::EPSILON;

/// The part of `v` across `u`. The second pass makes it orthogonal to `u` to round-off of its own length, however short it is.
fn across(v: &Vector3<f64>, u: &Vector3<f64>) -> Vector3<f64> {
    let squared = u.norm_squared();
    let h = v - u * (v.dot(u) / squared);
    h - u * (h.dot(u) / squared)
}

/// The minimum of `|w - s u - t v|^2` over all `s`, `t`, with the squared sine between `u` and `v`. `u` should be the longer one.
/// None where `u` and `v` are parallel to round-off or of length zero.
fn plane_minimum(w: &Vector3<f64>, u: &Vector3<f64>, v: &Vector3<f64>) -> Option<(f64, f64, f64)> {
    let h = across(v, u);
    let (hh, vv) = (h.norm_squared(), v.norm_squared());
    // Not a number if `u` is zero.
    if hh <= PARALLEL * vv || hh.is_nan() {
        return None;
    }
    let t = w.dot(&h) / hh;
    let s = (w - v * t).dot(u) / u.norm_squared();
    Some((s, t, hh / vv))
}

fn vertex_triangle(best: &mut Best<'_>) {
    let x = best.points;
    let edge = |k: usize| x[(k + 1) % 3 + 1] - x[k + 1];
    let lengths = [0, 1, 2].map(|k| edge(k).norm_squared());
    // The longest edge is the base, so that the height is shorter than both other edges.
    let base = (1..3).fold(0, |longest, k| if lengths[k] > lengths[longest] { k } else { longest });
    let (end, apex) = ((base + 1) % 3, (base + 2) % 3);
    let origin = x[base + 1];
    if let Some((s, t, sine_squared)) = plane_minimum(&(x[0] - origin), &edge(base), &(x[apex + 1] - origin)) {
        let rest = 1.0 - s - t;
        if s > 0.0 && t > 0.0 && rest > 0.0 {
            let mut weights = [1.0, 0.0, 0.0, 0.0];
            weights[base + 1] = -rest;
            weights[end + 1] = -s;
            weights[apex + 1] = -t;
            if sine_squared > ILL_CONDITIONED {
                return best.take(weights);
            }
            best.try_weights(weights);
        }
    }
    for edge in [[1, 2], [2, 3], [3, 1]] {
        best.try_vertex_edge(0, edge);
    }
}

fn edge_edge(best: &mut Best<'_>) {
    let x = best.points;
    let (u, v, w) = (x[1] - x[0], x[3] - x[2], x[2] - x[0]);
    // x_0 + s u against x_2 + t v: the minimum of |w - s u + t v|.
    let inside = if u.norm_squared() >= v.norm_squared() {
        plane_minimum(&w, &u, &v).map(|(s, t, sine)| (s, -t, sine))
    } else {
        plane_minimum(&w, &v, &u).map(|(t, s, sine)| (s, -t, sine))
    };
    if let Some((s, t, sine_squared)) = inside
        && s > 0.0
        && s < 1.0
        && t > 0.0
        && t < 1.0
    {
        let weights = [1.0 - s, s, -(1.0 - t), -t];
        if sine_squared > ILL_CONDITIONED {
            return best.take(weights);
        }
        best.try_weights(weights);
    }
    best.try_vertex_edge(0, [2, 3]);
    best.try_vertex_edge(1, [2, 3]);
    best.try_vertex_edge(2, [0, 1]);
    best.try_vertex_edge(3, [0, 1]);
}
