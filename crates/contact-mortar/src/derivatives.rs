//! Derivatives of the integrals of a pair.

use crate::{Factors, TriangleRule, for_each_point_with_derivatives};
use nalgebra::Vector3;
use stoss_reference_element::quad4;
use stoss_segmentation::{LOCAL, Segment, SlaveFrame};

/// Derivatives of a pair's integrals with respect to its 24 nodal components (slave `3 I + c`, master `12 + 3 K + c`).
#[derive(Clone, Debug, PartialEq)]
pub struct PairDerivatives {
    /// Of `int N_i dA`.
    pub shape: [[f64; LOCAL]; 4],
    /// Of `int N_i N_j dA`.
    pub mass: [[[f64; LOCAL]; 4]; 4],
    /// Of `int N_i N_k^(2) dA`.
    pub coupling: [[[f64; LOCAL]; 4]; 4],
}

impl PairDerivatives {
    /// All zero.
    pub const ZERO: Self =
        Self { shape: [[0.0; LOCAL]; 4], mass: [[[0.0; LOCAL]; 4]; 4], coupling: [[[0.0; LOCAL]; 4]; 4] };
}

/// Adds the derivatives of the integrals over `segment` to `out`.
pub fn pair_derivatives(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &[Vector3<f64>; 4],
    rule: TriangleRule,
    factors: &Factors,
    out: &mut PairDerivatives,
) {
    let facing = factors.facing_of(frame, master, true);
    for_each_point_with_derivatives(segment, frame, master, rule, |p, d| {
        let (mut p, mut d) = (*p, *d);
        factors.apply_with_derivatives(&facing, &mut p, &mut d);
        let (g1, g2) = (quad4::shape_gradient(p.slave), quad4::shape_gradient(p.master));
        let (s, m) = (&d.coordinates.slave, &d.coordinates.master);
        let along = |g: [f64; 2], x: &[[f64; LOCAL]; 2]| -> [f64; LOCAL] {
            std::array::from_fn(|k| g[0] * x[0][k] + g[1] * x[1][k])
        };
        let (dn1, dn2) = (g1.map(|g| along(g, s)), g2.map(|g| along(g, m)));
        for i in 0..4 {
            let n = p.slave_shape[i];
            let dwn: [f64; LOCAL] = std::array::from_fn(|k| d.weight[k] * n + p.weight * dn1[i][k]);
            out.shape[i].iter_mut().zip(&dwn).for_each(|(o, d)| *o += d);
            let wn = p.weight * n;
            for j in 0..4 {
                let (n1, n2) = (p.slave_shape[j], p.master_shape[j]);
                let (mass, coupling) = (&mut out.mass[i][j], &mut out.coupling[i][j]);
                for k in 0..LOCAL {
                    mass[k] += dwn[k] * n1 + wn * dn1[j][k];
                    coupling[k] += dwn[k] * n2 + wn * dn2[j][k];
                }
            }
        }
    });
}

/// A linear functional of the gap vectors of a pair: `sum_i nu_i . int N_i phi (x1 - x2) dA` with the factors `phi`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GapFunctional<'a> {
    pub rule: TriangleRule,
    pub factors: &'a Factors,
    /// `nu_i`, one a corner of the slave facet.
    pub weights: [Vector3<f64>; 4],
}

/// Step of the differences, in lengths of the facet.
const STEP: f64 = 1e-6;

impl GapFunctional<'_> {
    /// Adds the gradient over one segment.
    fn add_gradient(&self, segment: &Segment, frame: &SlaveFrame, master: &[Vector3<f64>; 4], out: &mut [f64; LOCAL]) {
        let facing = self.factors.facing_of(frame, master, true);
        let normal = frame.normal();
        let turned = frame.normal_derivatives();
        let along = self.weights.map(|w| w.dot(&normal));
        for_each_point_with_derivatives(segment, frame, master, self.rule, |p, d| {
            let (mut p, mut d) = (*p, *d);
            self.factors.apply_with_derivatives(&facing, &mut p, &mut d);
            // s = -gamma sum_i N_i nu_i . n0, times the weight of the point.
            let g1 = quad4::shape_gradient(p.slave);
            let (mut value, mut slope, mut lever) = (0.0, [0.0; 2], Vector3::zeros());
            for i in 0..4 {
                value += p.slave_shape[i] * along[i];
                slope[0] += g1[i][0] * along[i];
                slope[1] += g1[i][1] * along[i];
                lever += self.weights[i] * p.slave_shape[i];
            }
            let xi = &d.coordinates.slave;
            let (by_weight, by_gap, by_shape) = (-p.gap * value, -p.weight * value, -p.weight * p.gap);
            for k in 0..LOCAL {
                out[k] += by_weight * d.weight[k] + by_gap * d.gap[k] + by_shape * (slope[0] * xi[0][k] + slope[1] * xi[1][k]);
            }
            for (i, turned) in turned.iter().enumerate() {
                let t = turned.transpose() * lever * by_shape;
                (0..3).for_each(|c| out[3 * i + c] += t[c]);
            }
        });
    }

    fn gradient(&self, segments: &[Segment], frame: &SlaveFrame, master: &[Vector3<f64>; 4]) -> [f64; LOCAL] {
        let mut out = [0.0; LOCAL];
        segments.iter().for_each(|segment| self.add_gradient(segment, frame, master, &mut out));
        out
    }

    /// Second derivative over the segments of one pair, with respect to its 24 nodal components: differences of the gradient, with the vertices of the polygons
    /// keeping their origins. `None` if a facet is degenerate.
    pub fn hessian(
        &self,
        segments: &[Segment],
        slave: &[Vector3<f64>; 4],
        master: &[Vector3<f64>; 4],
    ) -> Option<Box<[[f64; LOCAL]; LOCAL]>> {
        let size = ((slave[2] - slave[0]).norm() + (slave[3] - slave[1]).norm()) * 0.5;
        let h = STEP * size;
        let at = |slave: &[Vector3<f64>; 4], master: &[Vector3<f64>; 4]| {
            let frame = SlaveFrame::new(*slave).ok()?;
            let moved: Vec<Segment> = segments.iter().map(|segment| segment.moved(&frame, master)).collect();
            Some(self.gradient(&moved, &frame, master))
        };
        let base = at(slave, master)?;
        let mut out = Box::new([[0.0; LOCAL]; LOCAL]);
        // Nothing changes in a translation: the last node's columns are minus the sums of the others.
        for k in 0..LOCAL - 3 {
            let (mut x, mut y) = (*slave, *master);
            let node = if k < 12 { &mut x[k / 3] } else { &mut y[k / 3 - 4] };
            node[k % 3] += h;
            let moved = at(&x, &y)?;
            for row in 0..LOCAL {
                let d = (moved[row] - base[row]) / h;
                out[row][k] = d;
                out[row][LOCAL - 3 + k % 3] -= d;
            }
        }
        for i in 0..LOCAL {
            for j in 0..i {
                let mean = 0.5 * (out[i][j] + out[j][i]);
                (out[i][j], out[j][i]) = (mean, mean);
            }
        }
        Some(out)
    }
}
