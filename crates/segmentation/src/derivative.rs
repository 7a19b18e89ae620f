//! First derivatives of the vertices' coordinates with respect to the nodes of both facets.
//!
//! Every point satisfies `t_a . (x1(xi1) - x2(xi2)) = 0` with tangents `t_a` normal to `n0`. With `x2 - x1 = g n0`
//! the variation is
//!
//! `t_a . (N1_I dx1_I - N2_K dx2_K + g dn0) + t_a . a_b dxi1_b - t_a . m_b dxi2_b = 0`,
//!
//! in which the tangents' own variation has dropped out. What is fixed (a corner, an edge) follows from the vertex's
//! origin.

use crate::frame::weighted;
use crate::segment::SMALLEST_AREA;
use crate::{Foot, MAX_VERTICES, Provenance, Segment, SlaveFrame};
use nalgebra::Vector3;
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal};

/// Columns of a derivative: components of the slave nodes, then from [`MASTER`] on of the master nodes. Columns of nodes that a facet does not
/// have are zero.
pub const LOCAL: usize = 2 * MASTER;

/// The first column of the master.
pub const MASTER: usize = 3 * MAX_NODES;

/// Derivatives of the coordinates of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointDerivative {
    /// `d xi1_b / d x`, two rows.
    pub slave: [[f64; LOCAL]; 2],
    /// `d xi2_b / d x`, two rows.
    pub master: [[f64; LOCAL]; 2],
}

impl PointDerivative {
    /// The derivative of a point that does not move: zeros.
    pub const ZERO: Self = Self { slave: [[0.0; LOCAL]; 2], master: [[0.0; LOCAL]; 2] };
}

/// Solves `[[m0, m1]]` (rows) for the right side; zero if the matrix is singular to round-off, as for edges that lie
/// on each other.
fn solve(m: [[f64; 2]; 2], r: [f64; 2]) -> [f64; 2] {
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let scale = (m[0][0].abs() + m[1][0].abs()) * (m[0][1].abs() + m[1][1].abs());
    if det.abs() <= 1e-12 * scale {
        return [0.0; 2];
    }
    [(r[0] * m[1][1] - r[1] * m[0][1]) / det, (m[0][0] * r[1] - m[1][0] * r[0]) / det]
}

fn edge_direction(kind: FacetKind, edge: u8) -> [f64; 2] {
    let [a, b] = kind.side(edge as usize).map(|corner| kind.vertices()[corner]);
    [b[0] - a[0], b[1] - a[1]]
}

fn apply(m: [[f64; 2]; 2], u: [f64; 2]) -> [f64; 2] {
    [m[0][0] * u[0] + m[0][1] * u[1], m[1][0] * u[0] + m[1][1] * u[1]]
}

impl Segment {
    /// Tangents of both facets in the plane: `T_ab = t_a . x_,b`.
    fn plane_tangents(
        &self,
        frame: &SlaveFrame,
        master: &Nodal<Vector3<f64>>,
        slave_xi: [f64; 2],
        master_xi: [f64; 2],
    ) -> [[[f64; 2]; 2]; 2] {
        let t = frame.tangents();
        let of = |gradient: [[f64; 2]; MAX_NODES], x: &Nodal<Vector3<f64>>| -> [[f64; 2]; 2] {
            let a: [Vector3<f64>; 2] = std::array::from_fn(|b| weighted(&gradient.map(|g| g[b]), x));
            std::array::from_fn(|i| std::array::from_fn(|b| t[i].dot(&a[b])))
        };
        [
            of(self.slave_map.weights_gradient(slave_xi), frame.corners()),
            of(self.master_map.weights_gradient(master_xi), master),
        ]
    }

    /// `t_a . (N1_I dx1_I - N2_K dx2_K + g dn0)`: what does not go over the coordinates.
    fn explicit(&self, frame: &SlaveFrame, slave_xi: [f64; 2], master_xi: [f64; 2], gap: f64) -> [[f64; LOCAL]; 2] {
        let (w1, w2) = (self.slave_map.weights(slave_xi), self.master_map.weights(master_xi));
        let dn = frame.normal_derivatives();
        let t = frame.tangents();
        // Filled in place: arrays that closures return are copied.
        let mut rows = [[0.0; LOCAL]; 2];
        for (row, t) in rows.iter_mut().zip(&t) {
            for i in 0..MAX_NODES {
                let turned = dn[i].transpose() * t * gap;
                for c in 0..3 {
                    row[3 * i + c] = w1[i] * t[c] + turned[c];
                    row[MASTER + 3 * i + c] = -w2[i] * t[c];
                }
            }
        }
        rows
    }

    /// Derivatives of the coordinates of every vertex; entries beyond the number of vertices are zero.
    ///
    /// A vertex at which two parallel edges meet has none; zero is returned for it.
    pub fn vertex_derivatives(
        &self,
        frame: &SlaveFrame,
        master: &Nodal<Vector3<f64>>,
    ) -> [PointDerivative; MAX_VERTICES] {
        let mut out = [PointDerivative::ZERO; MAX_VERTICES];
        for (derivative, v) in out.iter_mut().zip(self.vertices()) {
            let b = self.explicit(frame, v.slave, v.master, v.gap);
            let [t1, t2] = self.plane_tangents(frame, master, v.slave, v.master);
            for k in 0..LOCAL {
                let r = [b[0][k], b[1][k]];
                let (slave, foot) = match v.provenance {
                    Provenance::Slave(_) | Provenance::Cut => ([0.0; 2], solve(t2, r)),
                    Provenance::Master(_) => (solve(t1, [-r[0], -r[1]]), [0.0; 2]),
                    Provenance::Intersection { slave_edge, master_edge } => {
                        let (u1, u2) =
                            (edge_direction(frame.kind(), slave_edge), edge_direction(master.kind(), master_edge));
                        let (e1, e2) = (apply(t1, u1), apply(t2, u2));
                        let [s, m] = solve([[e1[0], -e2[0]], [e1[1], -e2[1]]], [-r[0], -r[1]]);
                        ([s * u1[0], s * u1[1]], [m * u2[0], m * u2[1]])
                    }
                };
                for i in 0..2 {
                    derivative.slave[i][k] = slave[i];
                    derivative.master[i][k] = foot[i];
                }
            }
        }
        out
    }

    /// Derivatives of [`Segment::centroid`] from those of the vertices.
    pub fn centroid_derivative(&self, vertices: &[PointDerivative; MAX_VERTICES]) -> [[f64; LOCAL]; 2] {
        let points = self.vertices();
        let mut out = [[0.0; LOCAL]; 2];
        let area = self.parametric_area();
        if area <= SMALLEST_AREA {
            let share = 1.0 / points.len() as f64;
            for vertex in &vertices[..points.len()] {
                for (row, d) in out.iter_mut().zip(&vertex.slave) {
                    row.iter_mut().zip(d).for_each(|(o, d)| *o += share * d);
                }
            }
            return out;
        }
        // c = sum_t det_t (a + b + d) / 3 / sum_t det_t, so that dc = (sum_t ddet_t (mean_t - c) + det_t dmean_t) / sum_t det_t.
        let centroid = self.centroid();
        let inverse = 0.5 / area;
        for t in self.triangles() {
            let det = self.triangle_determinant(t);
            let [a, b, c] = t.map(|k| points[k].slave);
            let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
            let [da, db, dc] = t.map(|k| &vertices[k].slave);
            let away: [f64; 2] = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0 - centroid[i]);
            for k in 0..LOCAL {
                let ddet = (db[0][k] - da[0][k]) * v[1] + u[0] * (dc[1][k] - da[1][k])
                    - (db[1][k] - da[1][k]) * v[0]
                    - u[1] * (dc[0][k] - da[0][k]);
                for i in 0..2 {
                    out[i][k] += inverse * (ddet * away[i] + det * (da[i][k] + db[i][k] + dc[i][k]) / 3.0);
                }
            }
        }
        out
    }

    /// Derivative of the master coordinates of a foot (see [`Segment::project`]) whose slave coordinates vary by
    /// `slave_derivative`.
    pub fn project_derivative(
        &self,
        frame: &SlaveFrame,
        master: &Nodal<Vector3<f64>>,
        slave: [f64; 2],
        foot: &Foot,
        slave_derivative: &[[f64; LOCAL]; 2],
    ) -> [[f64; LOCAL]; 2] {
        let b = self.explicit(frame, slave, foot.master, foot.gap);
        let [t1, t2] = self.plane_tangents(frame, master, slave, foot.master);
        let mut out = [[0.0; LOCAL]; 2];
        for k in 0..LOCAL {
            let moved = apply(t1, [slave_derivative[0][k], slave_derivative[1][k]]);
            let d = solve(t2, [b[0][k] + moved[0], b[1][k] + moved[1]]);
            out[0][k] = d[0];
            out[1][k] = d[1];
        }
        out
    }
}
