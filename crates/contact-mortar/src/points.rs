//! Gauss points of a segment, the same for both sides.

use nalgebra::Vector3;
use stoss_reference_element::{
    quad4,
    triangle::{self, TriangleRule},
};
use stoss_segmentation::{Foot, LOCAL, PointDerivative, Segment, SlaveFrame};

/// How a Gauss point finds its place on the master.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointMap {
    /// Its place on the slave, linear in the triangle, is projected along the normal of the segmentation plane
    /// (choice). Linear fields are exact between flat facets of any shape.
    #[default]
    Projected,
    /// Linear in the triangle on both sides (formulation §7.2, thesis).
    Interpolated,
}

/// Rule and map of the integrals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quadrature {
    /// Rule of each triangle.
    pub rule: TriangleRule,
    /// Place on the master.
    pub map: PointMap,
}

/// A Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// Convective coordinates on the slave.
    pub slave: [f64; 2],
    /// Convective coordinates on the master.
    pub master: [f64; 2],
    /// Shape functions of the slave.
    pub slave_shape: [f64; 4],
    /// Shape functions of the master.
    pub master_shape: [f64; 4],
    /// `w_g |a1 x a2| det(d xi / d eta)`, an area of the slave (formulation (7.1)).
    pub weight: f64,
    /// `w_g det(d xi / d eta)`, for directors that carry the area themselves (formulation §8.3).
    pub parametric_weight: f64,
    /// `(x2 - x1) . n0` along the normal of the segmentation plane, a length.
    pub gap: f64,
}

/// Derivatives of a point with respect to the 24 components of the slave's and the master's nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointVariation {
    /// Of both coordinates.
    pub coordinates: PointDerivative,
    /// Of the weight.
    pub weight: [f64; LOCAL],
    /// Of the parametric weight.
    pub parametric_weight: [f64; LOCAL],
}

fn linear(eta: &[f64; 3], p: [[f64; 2]; 3]) -> [f64; 2] {
    std::array::from_fn(|i| eta[0] * p[0][i] + eta[1] * p[1][i] + eta[2] * p[2][i])
}

fn combine(weights: [f64; 4], x: &[Vector3<f64>; 4]) -> Vector3<f64> {
    x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2] + x[3] * weights[3]
}

fn tangents(xi: [f64; 2], x: &[Vector3<f64>; 4]) -> [Vector3<f64>; 2] {
    let gradient = quad4::shape_gradient(xi);
    [combine(gradient.map(|g| g[0]), x), combine(gradient.map(|g| g[1]), x)]
}

fn point_at(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &[Vector3<f64>; 4],
    map: PointMap,
    t: [usize; 3],
    eta: &[f64; 3],
    parametric_weight: f64,
) -> (QuadraturePoint, Foot) {
    let v = t.map(|k| segment.vertices()[k]);
    let slave = linear(eta, v.map(|v| v.slave));
    let foot = match map {
        PointMap::Projected => segment.project(frame, master, slave),
        PointMap::Interpolated => {
            Foot { master: linear(eta, v.map(|v| v.master)), gap: (0..3).map(|k| eta[k] * v[k].gap).sum() }
        }
    };
    let [a1, a2] = tangents(slave, frame.corners());
    let point = QuadraturePoint {
        slave,
        master: foot.master,
        slave_shape: quad4::shape(slave),
        master_shape: quad4::shape(foot.master),
        weight: parametric_weight * a1.cross(&a2).norm(),
        parametric_weight,
        gap: foot.gap,
    };
    (point, foot)
}

/// Visits the Gauss points of all triangles of a segment. `master`: corners of the segment's master facet.
pub fn for_each_point(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &[Vector3<f64>; 4],
    quadrature: Quadrature,
    mut visit: impl FnMut(&QuadraturePoint),
) {
    for t in segment.triangles() {
        let det = segment.triangle_determinant(t);
        for &(eta, w) in quadrature.rule.points() {
            visit(&point_at(segment, frame, master, quadrature.map, t, &triangle::shape(eta), w * det).0);
        }
    }
}

/// As [`for_each_point`], with first derivatives.
pub fn for_each_point_with_derivatives(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &[Vector3<f64>; 4],
    quadrature: Quadrature,
    mut visit: impl FnMut(&QuadraturePoint, &PointVariation),
) {
    let vertex = segment.vertex_derivatives(frame, master);
    let corners = frame.corners();
    let a12 = combine(quad4::mixed_derivative(), corners);
    for t in segment.triangles() {
        let det = segment.triangle_determinant(t);
        let [p, q, r] = t.map(|k| segment.vertices()[k].slave);
        let (u, v) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        let [dp, dq, dr] = t.map(|k| &vertex[k].slave);
        let det_variation: [f64; LOCAL] = std::array::from_fn(|k| {
            (dq[0][k] - dp[0][k]) * v[1] + u[0] * (dr[1][k] - dp[1][k])
                - (dq[1][k] - dp[1][k]) * v[0]
                - u[1] * (dr[0][k] - dp[0][k])
        });
        for &(eta, w) in quadrature.rule.points() {
            let eta = triangle::shape(eta);
            let (point, foot) = point_at(segment, frame, master, quadrature.map, t, &eta, w * det);
            let mix = |row: fn(&PointDerivative) -> &[[f64; LOCAL]; 2]| -> [[f64; LOCAL]; 2] {
                std::array::from_fn(|i| {
                    std::array::from_fn(|k| (0..3).map(|m| eta[m] * row(&vertex[t[m]])[i][k]).sum())
                })
            };
            let slave = mix(|d| &d.slave);
            let foot = match quadrature.map {
                PointMap::Interpolated => mix(|d| &d.master),
                PointMap::Projected => segment.project_derivative(frame, master, point.slave, &foot, &slave),
            };
            // d|c| = c/|c| . (da1 x a2 + a1 x da2), da1 = N_I,1 dx_I + a12 dxi2, da2 = N_I,2 dx_I + a12 dxi1.
            let [a1, a2] = tangents(point.slave, corners);
            let c = a1.cross(&a2);
            let density = c.norm();
            let unit = c / density;
            let (by_a1, by_a2) = (a2.cross(&unit), unit.cross(&a1));
            let (by_xi1, by_xi2) = (by_a2.dot(&a12), by_a1.dot(&a12));
            let gradient = quad4::shape_gradient(point.slave);
            let mut variation = PointVariation {
                coordinates: PointDerivative { slave, master: foot },
                weight: [0.0; LOCAL],
                parametric_weight: det_variation.map(|d| w * d),
            };
            for k in 0..LOCAL {
                let mut d = by_xi1 * slave[0][k] + by_xi2 * slave[1][k];
                if k < 12 {
                    d += gradient[k / 3][0] * by_a1[k % 3] + gradient[k / 3][1] * by_a2[k % 3];
                }
                variation.weight[k] = variation.parametric_weight[k] * density + point.parametric_weight * d;
            }
            visit(&point, &variation);
        }
    }
}
