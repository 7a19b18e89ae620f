//! Derivatives of the integrals of a pair.

use crate::{Quadrature, for_each_point_with_derivatives};
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
    quadrature: Quadrature,
    out: &mut PairDerivatives,
) {
    for_each_point_with_derivatives(segment, frame, master, quadrature, |p, d| {
        let (g1, g2) = (quad4::shape_gradient(p.slave), quad4::shape_gradient(p.master));
        let (s, m) = (&d.coordinates.slave, &d.coordinates.master);
        for k in 0..LOCAL {
            let dn1 = g1.map(|g| g[0] * s[0][k] + g[1] * s[1][k]);
            let dn2 = g2.map(|g| g[0] * m[0][k] + g[1] * m[1][k]);
            for i in 0..4 {
                let (n, dn) = (p.slave_shape[i], dn1[i]);
                let dwn = d.weight[k] * n + p.weight * dn;
                out.shape[i][k] += dwn;
                for j in 0..4 {
                    out.mass[i][j][k] += dwn * p.slave_shape[j] + p.weight * n * dn1[j];
                    out.coupling[i][j][k] += dwn * p.master_shape[j] + p.weight * n * dn2[j];
                }
            }
        }
    });
}
