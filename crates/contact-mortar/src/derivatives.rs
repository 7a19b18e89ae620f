//! Derivatives of the integrals of a pair.

use crate::{Factors, TriangleRule, for_each_point_with_derivatives};
use nalgebra::Vector3;
use stoss_reference_element::{MAX_NODES, Nodal};
use stoss_segmentation::{LOCAL, Segment, SlaveFrame};

/// Derivatives of a pair's integrals with respect to its nodal components (slave `3 I + c`, master `MASTER + 3 K + c`).
#[derive(Clone, Debug, PartialEq)]
pub struct PairDerivatives {
    /// Of `int N_i dA`.
    pub shape: [[f64; LOCAL]; MAX_NODES],
    /// Of `int N_i N_j dA`.
    pub mass: [[[f64; LOCAL]; MAX_NODES]; MAX_NODES],
    /// Of `int N_i N_k^(2) dA`.
    pub coupling: [[[f64; LOCAL]; MAX_NODES]; MAX_NODES],
}

impl PairDerivatives {
    /// All zero.
    pub const ZERO: Self = Self {
        shape: [[0.0; LOCAL]; MAX_NODES],
        mass: [[[0.0; LOCAL]; MAX_NODES]; MAX_NODES],
        coupling: [[[0.0; LOCAL]; MAX_NODES]; MAX_NODES],
    };
}

/// Adds the derivatives of the integrals over `segment` to `out`.
pub fn pair_derivatives(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &Nodal<Vector3<f64>>,
    rule: TriangleRule,
    factors: &Factors,
    out: &mut PairDerivatives,
) {
    let facing = factors.facing_of(frame, master, true);
    for_each_point_with_derivatives(segment, frame, master, rule, |p, d| {
        let (mut p, mut d) = (*p, *d);
        factors.apply_with_derivatives(&facing, &mut p, &mut d);
        let (g1, g2) = (frame.kind().shape_gradient(p.slave), master.kind().shape_gradient(p.master));
        let (s, m) = (&d.coordinates.slave, &d.coordinates.master);
        // Filled in place: arrays that closures return are copied.
        let (mut dn1, mut dn2) = ([[0.0; LOCAL]; MAX_NODES], [[0.0; LOCAL]; MAX_NODES]);
        for i in 0..MAX_NODES {
            for k in 0..LOCAL {
                dn1[i][k] = g1[i][0] * s[0][k] + g1[i][1] * s[1][k];
                dn2[i][k] = g2[i][0] * m[0][k] + g2[i][1] * m[1][k];
            }
        }
        for i in 0..MAX_NODES {
            let n = p.slave_shape[i];
            let mut dwn = [0.0; LOCAL];
            for k in 0..LOCAL {
                dwn[k] = d.weight[k] * n + p.weight * dn1[i][k];
            }
            out.shape[i].iter_mut().zip(&dwn).for_each(|(o, d)| *o += d);
            let wn = p.weight * n;
            for j in 0..MAX_NODES {
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
