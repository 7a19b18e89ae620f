//! The closest point of the closed patch, globally.

use crate::Patch;
use crate::patch::Monomials;
use crate::polynomial::sign_changes_of_quintic;
use nalgebra::Vector3;

/// Where on a closed patch a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchFeature {
    /// The open facet.
    Interior,
    /// The open edge from corner `k` to the next one.
    Edge(usize),
    /// Corner `k`.
    Vertex(usize),
}

/// Result of [`Patch::closest_point`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Coordinates in the closed facet; on an edge `FacetKind::edge_excess` is exactly zero, at a corner they are exactly those of the vertex.
    pub xi: [f64; 2],
    /// The closest point itself.
    pub point: Vector3<f64>,
    /// Squared distance.
    pub distance_squared: f64,
    /// Interior, edge or corner.
    pub feature: PatchFeature,
}

struct Candidate {
    xi: [f64; 2],
    distance_squared: f64,
    feature: PatchFeature,
}

impl Patch {
    /// The point of the closed patch with the smallest distance to `x`, warped patches and points far away included.
    ///
    /// Where the squared distance is convex on the square (always near a patch that is not badly warped, and for triangles without a sliver of an angle), Newton's method or the
    /// closest edge settles it. Otherwise every stationary point is visited: with `xi^1` eliminated, the stationary points are roots of a
    /// polynomial of degree five in `xi^2`.
    pub fn closest_point(&self, x: &Vector3<f64>) -> ClosestPoint {
        let patch = self.monomials();
        let target = x - self.corners[0];
        let candidate = closest(&patch, &target);
        let point = match candidate.feature {
            PatchFeature::Vertex(k) => self.corners[k],
            _ => self.corners[0] + patch.point(candidate.xi),
        };
        ClosestPoint {
            xi: candidate.xi,
            point,
            distance_squared: candidate.distance_squared,
            feature: candidate.feature,
        }
    }
}

fn closest(patch: &Monomials, target: &Vector3<f64>) -> Candidate {
    let convex = is_convex(patch, target);
    if convex && let Some(interior) = newton_inside(patch, target, patch.kind.centre()) {
        return interior;
    }
    let mut best = closest_edge(patch, target);
    if convex && is_minimal_at_boundary(patch, target, &best) {
        return best;
    }
    for_each_stationary_point(patch, target, |xi| {
        // The polynomial's root may have lost digits; Newton restores them, if it stays.
        let polished = newton_inside(patch, target, xi);
        let raw = Candidate {
            xi,
            distance_squared: (target - patch.point(xi)).norm_squared(),
            feature: PatchFeature::Interior,
        };
        for candidate in polished.into_iter().chain([raw]) {
            if candidate.distance_squared < best.distance_squared {
                best = candidate;
            }
        }
    });
    best
}

/// Whether half the Hessian `m_ab - r . a_ab` of the squared distance is positive definite on the whole square `|xi^a| <= 1` (sufficient).
fn is_convex(patch: &Monomials, target: &Vector3<f64>) -> bool {
    // |a_1|^2 is a quadratic in xi^2 only, |a_2|^2 in xi^1 only; the mixed entry is bilinear, hence largest in a corner.
    let c_12_squared = patch.c_12.norm_squared();
    let smallest = |c: &Vector3<f64>| {
        let b = c.dot(&patch.c_12);
        let t = if c_12_squared > 0.0 { (-b / c_12_squared).clamp(-1.0, 1.0) } else { 0.0 };
        c.norm_squared() + t * (2.0 * b + t * c_12_squared)
    };
    let constant = patch.c_1.dot(&patch.c_2) - (target - patch.c_0).dot(&patch.c_12);
    let (s_1, s_2) = (2.0 * patch.c_1.dot(&patch.c_12), 2.0 * patch.c_2.dot(&patch.c_12));
    let mixed = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .iter()
        .map(|t: &[f64; 2]| (constant + s_1 * t[0] + s_2 * t[1] + 2.0 * c_12_squared * t[0] * t[1]).abs())
        .fold(0.0, f64::max);
    // The margin keeps Newton's matrix well conditioned.
    0.99 * smallest(&patch.c_1) * smallest(&patch.c_2) > mixed * mixed
}

/// Plain Newton that must stay in the open facet; `None` if it leaves it or does not converge.
fn newton_inside(patch: &Monomials, target: &Vector3<f64>, start: [f64; 2]) -> Option<Candidate> {
    let mut xi = start;
    for iteration in 0..12 {
        let r = target - patch.point(xi);
        let [a_1, a_2] = patch.tangents(xi);
        let gradient = [r.dot(&a_1), r.dot(&a_2)];
        let (m_11, m_22) = (a_1.dot(&a_1), a_2.dot(&a_2));
        let h_12 = a_1.dot(&a_2) - r.dot(&patch.c_12);
        let determinant = m_11 * m_22 - h_12 * h_12;
        if determinant.is_nan() || determinant <= 0.0 {
            return None;
        }
        let step = [
            (m_22 * gradient[0] - h_12 * gradient[1]) / determinant,
            (m_11 * gradient[1] - h_12 * gradient[0]) / determinant,
        ];
        xi = [xi[0] + step[0], xi[1] + step[1]];
        let length = step[0].abs().max(step[1].abs());
        // The first step of a far target may overshoot a little before it turns back.
        if patch.kind.excess(xi) >= if iteration < 3 { 0.5 } else { 0.0 } {
            return None;
        }
        // Convergence is quadratic: after a step of 1e-8 the error is round-off.
        if length < 1e-8 {
            let inside = patch.kind.excess(xi) < 0.0;
            let distance_squared = (target - patch.point(xi)).norm_squared();
            return inside.then_some(Candidate { xi, distance_squared, feature: PatchFeature::Interior });
        }
    }
    None
}

/// Nearest point of the boundary; of equal ones the first edge's.
fn closest_edge(patch: &Monomials, target: &Vector3<f64>) -> Candidate {
    let vertices = patch.kind.vertices();
    let mut best = Candidate { xi: [0.0; 2], distance_squared: f64::INFINITY, feature: PatchFeature::Vertex(0) };
    for k in 0..patch.kind.edge_count() {
        let next = patch.kind.next(k);
        let start = patch.point(vertices[k]);
        let edge = patch.point(vertices[next]) - start;
        let length_squared = edge.norm_squared();
        let t = (target - start).dot(&edge) / length_squared;
        let (xi, feature) = if t < 1.0 && t > 0.0 {
            let (from, to) = (vertices[k], vertices[next]);
            // What is the same number in both corners stays exact.
            let along = |i: usize| if from[i] == to[i] { from[i] } else { from[i] + t * (to[i] - from[i]) };
            ([along(0), along(1)], PatchFeature::Edge(k))
        } else if t >= 1.0 {
            (vertices[next], PatchFeature::Vertex(next))
        } else {
            (vertices[k], PatchFeature::Vertex(k))
        };
        let distance_squared = (target - patch.point(xi)).norm_squared();
        if distance_squared < best.distance_squared {
            best = Candidate { xi, distance_squared, feature };
        }
    }
    best
}

/// Whether the best point of the boundary is the best of the facet, for a convex distance.
fn is_minimal_at_boundary(patch: &Monomials, target: &Vector3<f64>, best: &Candidate) -> bool {
    let r = target - patch.point(best.xi);
    let [a_1, a_2] = patch.tangents(best.xi);
    match best.feature {
        // The distance falls along a direction if its product with r is positive.
        PatchFeature::Edge(k) => {
            let inward = patch.kind.inward(k);
            inward[0] * r.dot(&a_1) + inward[1] * r.dot(&a_2) <= 0.0
        }
        // Both directions into the facet are edges, which have been searched.
        PatchFeature::Vertex(_) => true,
        PatchFeature::Interior => false,
    }
}

/// Visits every minimum of the squared distance in the open facet (and perhaps other stationary points).
///
/// For fixed `t = xi^2` the patch is a line `c_0 + t c_2 + xi^1 a`, `a = c_1 + t c_12`. With `b = x - c_0 - t c_2` its nearest point has
/// `xi^1 = B / A`, `A = a . a`, `B = a . b`, and the squared distance `D - B^2 / A`, `D = b . b`, is stationary where
/// `D' A^2 - 2 B B' A + B^2 A' = 0`.
fn for_each_stationary_point(patch: &Monomials, target: &Vector3<f64>, mut visit: impl FnMut([f64; 2])) {
    let d = target - patch.c_0;
    let a = [patch.c_1.norm_squared(), 2.0 * patch.c_1.dot(&patch.c_12), patch.c_12.norm_squared()];
    let b = [d.dot(&patch.c_1), d.dot(&patch.c_12) - patch.c_2.dot(&patch.c_1), -patch.c_2.dot(&patch.c_12)];
    let d_slope = [-2.0 * d.dot(&patch.c_2), 2.0 * patch.c_2.norm_squared()];
    let a_slope = [a[1], 2.0 * a[2]];
    let b_slope = [b[1], 2.0 * b[2]];
    let mut polynomial = [0.0; 6];
    for (i, a_i) in a.iter().enumerate() {
        for (j, a_j) in a.iter().enumerate() {
            for (k, d_k) in d_slope.iter().enumerate() {
                polynomial[i + j + k] += a_i * a_j * d_k;
            }
        }
    }
    for (i, b_i) in b.iter().enumerate() {
        for j in 0..3 {
            for k in 0..2 {
                polynomial[i + j + k] += b_i * (b[j] * a_slope[k] - 2.0 * a[j] * b_slope[k]);
            }
        }
    }
    let mut roots = [0.0; 5];
    let count = sign_changes_of_quintic(&polynomial, &mut roots);
    for &t in &roots[..count] {
        let denominator = a[0] + t * (a[1] + t * a[2]);
        let xi_1 = (b[0] + t * (b[1] + t * b[2])) / denominator;
        if patch.kind.excess([xi_1, t]) < 0.0 {
            visit([xi_1, t]);
        }
    }
}
