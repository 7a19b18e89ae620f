//! Derivatives of the integrals of a pair.

use crate::{Factors, for_each_point_with_derivatives};
use nalgebra::Vector3;
use stoss_reference_element::{FacePiece, MAX_FACE_NODES, MAX_NODES, Nodal};
use stoss_segmentation::{LOCAL, Segment, SlaveFrame};

/// Derivatives of integrals over the nodes of a facet and those of a face.
pub type FaceDerivatives = [[[f64; LOCAL]; MAX_FACE_NODES]; MAX_NODES];

/// Derivatives of a pair's integrals with respect to its nodal components (slave `3 I + c`, master `MASTER + 3 K + c`).
#[derive(Clone, Debug, PartialEq)]
pub struct PairDerivatives {
    /// Derivatives of `int N_i dA`.
    pub shape: [[f64; LOCAL]; MAX_NODES],
    /// Derivatives of `int N_i N_j dA`.
    pub mass: [[[f64; LOCAL]; MAX_NODES]; MAX_NODES],
    /// Derivatives of `int N_i N_k^(2) dA`.
    pub coupling: [[[f64; LOCAL]; MAX_NODES]; MAX_NODES],
    /// Derivatives of `int N_i N_J dA` with the functions of the slave's face, then of the master's; of quadratic ones only.
    pub faces: [Option<Box<FaceDerivatives>>; 2],
}

impl PairDerivatives {
    /// Derivatives that are all zero.
    pub const ZERO: Self = Self {
        shape: [[0.0; LOCAL]; MAX_NODES],
        mass: [[[0.0; LOCAL]; MAX_NODES]; MAX_NODES],
        coupling: [[[0.0; LOCAL]; MAX_NODES]; MAX_NODES],
        faces: [None, None],
    };
}

/// Adds the derivatives of the integrals over `segment` to `out`. `faces`: the quadratic faces that the facets of slave and master are pieces of.
pub fn pair_derivatives(
    segment: &Segment,
    frame: &SlaveFrame,
    master: &Nodal<Vector3<f64>>,
    faces: [Option<&FacePiece>; 2],
    factors: &Factors,
    out: &mut PairDerivatives,
) {
    let facing = factors.facing_of(frame, master, true);
    for (face, of) in faces.iter().zip(&mut out.faces) {
        if face.is_some() && of.is_none() {
            *of = Some(Box::new([[[0.0; LOCAL]; MAX_FACE_NODES]; MAX_NODES]));
        }
    }
    for_each_point_with_derivatives(segment, frame, master, |p, d| {
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
        let at = [p.slave, p.master];
        let shapes = [0, 1]
            .map(|side| faces[side].map(|f| (f.face_nodes().len(), f.shape(at[side]), f.shape_gradient(at[side]))));
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
            if faces == [None; 2] {
                continue;
            }
            let sides = [s, m].into_iter().zip(&shapes).zip(&mut out.faces);
            for ((motion, shapes), of) in sides {
                let (Some((count, shape, gradient)), Some(of)) = (shapes, of) else { continue };
                for (j, of) in of[i][..*count].iter_mut().enumerate() {
                    let g = gradient[j].map(|g| wn * g);
                    for k in 0..LOCAL {
                        of[k] += dwn[k] * shape[j] + g[0] * motion[0][k] + g[1] * motion[1][k];
                    }
                }
            }
        }
    });
}
