//! Gauss points of a segment, the same for both sides.

use nalgebra::Vector3;
use stoss_reference_element::{
    MAX_NODES, Nodal,
    triangle::{self},
};
use stoss_segmentation::{Foot, LOCAL, MASTER, PointDerivative, Segment, SlaveFrame};

/// A Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// Convective coordinates on the slave.
    pub slave: [f64; 2],
    /// Convective coordinates on the master.
    pub master: [f64; 2],
    /// Shape functions of the slave.
    pub slave_shape: [f64; MAX_NODES],
    /// Shape functions of the master.
    pub master_shape: [f64; MAX_NODES],
    /// `w_g |a1 x a2| det(d xi / d eta)`, an area of the slave (theory/segmentation#eq-points).
    pub weight: f64,
    /// `(x2 - x1) . n0` along the normal of the segmentation plane, a length.
    pub gap: f64,
}

/// Derivatives of a point with respect to the components of the slave's and the master's nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointVariation {
    /// Derivatives of both coordinates.
    pub coordinates: PointDerivative,
    /// Derivatives of the weight.
    pub weight: [f64; LOCAL],
    /// Derivatives of the gap.
    pub gap: [f64; LOCAL],
}

fn linear(eta: &[f64; 3], p: [[f64; 2]; 3]) -> [f64; 2] {
    std::array::from_fn(|i| eta[0] * p[0][i] + eta[1] * p[1][i] + eta[2] * p[2][i])
}

fn combine(weights: [f64; MAX_NODES], x: &Nodal<Vector3<f64>>) -> Vector3<f64> {
    let x = x.padded();
    x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2] + x[3] * weights[3]
}

fn tangents(xi: [f64; 2], x: &Nodal<Vector3<f64>>) -> [Vector3<f64>; 2] {
    let gradient = x.kind().shape_gradient(xi);
    [combine(gradient.map(|g| g[0]), x), combine(gradient.map(|g| g[1]), x)]
}

/// The three corners of a triangle of the fan around the centroid, in the slave's coordinates, and twice its signed area there.
fn triangle_of(segment: &Segment, centroid: [f64; 2], edge: [usize; 2]) -> ([[f64; 2]; 3], f64) {
    let [q, r] = edge.map(|k| segment.vertices()[k].slave);
    let (u, v) = ([q[0] - centroid[0], q[1] - centroid[1]], [r[0] - centroid[0], r[1] - centroid[1]]);
    ([centroid, q, r], u[0] * v[1] - u[1] * v[0])
}

fn point_at(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &Nodal<Vector3<f64>>,
    images: &Nodal<[f64; 2]>,
    corners: [[f64; 2]; 3],
    eta: &[f64; 3],
    parametric_weight: f64,
) -> (QuadraturePoint, Foot) {
    let slave = linear(eta, corners);
    let foot = segment.project_on(frame, master, images, slave);
    let [a1, a2] = tangents(slave, frame.corners());
    let point = QuadraturePoint {
        slave,
        master: foot.master,
        slave_shape: frame.kind().shape(slave),
        master_shape: master.kind().shape(foot.master),
        weight: parametric_weight * a1.cross(&a2).norm(),
        gap: foot.gap,
    };
    (point, foot)
}

/// Visits the Gauss points of a segment: those of the triangles around its centroid, each projected from the slave on the master along the normal of
/// the segmentation plane. `master`: corners of the segment's master facet.
///
/// A fan from one of the vertices would jump when another one becomes the first, and so would the error of the quadrature; around the centroid
/// of area integrals are continuous functions of the positions. (The thesis's map, linear in the triangle on both sides, is not.)
pub fn for_each_point(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &Nodal<Vector3<f64>>,
    mut visit: impl FnMut(&QuadraturePoint),
) {
    let centroid = segment.centroid();
    let images = master.map(|x| frame.image(&x));
    for edge in segment.fan() {
        let (corners, det) = triangle_of(segment, centroid, edge);
        for &(eta, w) in &triangle::SEVEN {
            visit(&point_at(segment, frame, master, &images, corners, &triangle::shape(eta), w * det).0);
        }
    }
}

/// Visits the points as [`for_each_point`], with first derivatives.
pub fn for_each_point_with_derivatives(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &Nodal<Vector3<f64>>,
    mut visit: impl FnMut(&QuadraturePoint, &PointVariation),
) {
    let vertex = segment.vertex_derivatives(frame, master);
    let centroid = segment.centroid();
    let of_centroid = segment.centroid_derivative(&vertex);
    let images = master.map(|x| frame.image(&x));
    let corners = frame.corners();
    let normal = frame.normal();
    let a12 = combine(frame.kind().mixed_derivative(), corners);
    let mut variation = PointVariation { coordinates: PointDerivative::ZERO, weight: [0.0; LOCAL], gap: [0.0; LOCAL] };
    for edge in segment.fan() {
        let (ends, det) = triangle_of(segment, centroid, edge);
        let [p, q, r] = ends;
        let (u, v) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        let [dp, dq, dr] = [&of_centroid, &vertex[edge[0]].slave, &vertex[edge[1]].slave];
        let det_variation: [f64; LOCAL] = std::array::from_fn(|k| {
            (dq[0][k] - dp[0][k]) * v[1] + u[0] * (dr[1][k] - dp[1][k])
                - (dq[1][k] - dp[1][k]) * v[0]
                - u[1] * (dr[0][k] - dp[0][k])
        });
        for &(eta, w) in &triangle::SEVEN {
            let eta = triangle::shape(eta);
            let parametric_weight = w * det;
            let (point, foot) = point_at(segment, frame, master, &images, ends, &eta, parametric_weight);
            let slave = &mut variation.coordinates.slave;
            for i in 0..2 {
                for k in 0..LOCAL {
                    slave[i][k] = eta[0] * dp[i][k] + eta[1] * dq[i][k] + eta[2] * dr[i][k];
                }
            }
            let master_xi = segment.project_derivative(frame, master, point.slave, &foot, slave);
            // d|c| = c/|c| . (da1 x a2 + a1 x da2), da1 = N_I,1 dx_I + a12 dxi2, da2 = N_I,2 dx_I + a12 dxi1.
            let [a1, a2] = tangents(point.slave, corners);
            let c = a1.cross(&a2);
            let density = c.norm();
            let unit = c / density;
            let (by_a1, by_a2) = (a2.cross(&unit), unit.cross(&a1));
            let (by_xi1, by_xi2) = (by_a2.dot(&a12), by_a1.dot(&a12));
            let gradient = frame.kind().shape_gradient(point.slave);
            // dg = n0 . (dx2 - dx1): x2 - x1 has the direction of n0, so that the turning of n0 drops out. Facets that were split have affine maps.
            let slope = |gradient: [[f64; 2]; MAX_NODES], x: &Nodal<Vector3<f64>>| -> [f64; 2] {
                [0, 1].map(|b| normal.dot(&combine(gradient.map(|g| g[b]), x)))
            };
            let [s1, s2] = slope(segment.slave_map.weights_gradient(point.slave), corners);
            let [m1, m2] = slope(segment.master_map.weights_gradient(point.master), master);
            let (on_slave, on_master) =
                (segment.slave_map.weights(point.slave), segment.master_map.weights(point.master));
            for k in 0..LOCAL {
                let mut d = by_xi1 * slave[0][k] + by_xi2 * slave[1][k];
                let mut g = m1 * master_xi[0][k] + m2 * master_xi[1][k] - s1 * slave[0][k] - s2 * slave[1][k];
                if k < MASTER {
                    d += gradient[k / 3][0] * by_a1[k % 3] + gradient[k / 3][1] * by_a2[k % 3];
                    g -= on_slave[k / 3] * normal[k % 3];
                } else {
                    g += on_master[k / 3 - MAX_NODES] * normal[k % 3];
                }
                variation.weight[k] = w * det_variation[k] * density + parametric_weight * d;
                variation.gap[k] = g;
            }
            variation.coordinates.master = master_xi;
            visit(&point, &variation);
        }
    }
}
