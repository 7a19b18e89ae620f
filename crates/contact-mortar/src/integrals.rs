//! Integrals of the shape functions over the segments of one slave facet.

use crate::faces::{FaceBlock, FaceMatrix};
use crate::local::FacetMatrix;
use crate::{Faces, Factors, for_each_point};
use nalgebra::Vector3;
use stoss_reference_element::{FacePiece, FaceShape, FacetKind, MAX_FACE_NODES, MAX_NODES, Nodal};
use stoss_segmentation::FacetSegmentation;

/// Integrals with one master facet.
#[derive(Clone, Debug, PartialEq)]
pub struct PairIntegrals {
    /// Local number of the master facet.
    pub master_facet: u32,
    /// Kind of the master facet.
    pub master_kind: FacetKind,
    /// `int N_i^(1) N_k^(2) dA`, an area.
    pub coupling: FacetMatrix,
    /// `int N_i N_j dA` over this pair only.
    pub mass: FacetMatrix,
    /// `int N_i^(1) N_K dA` with the functions of the master's face if that is quadratic.
    pub face: Option<FaceMatrix>,
}

impl PairIntegrals {
    /// The coupling with the nodes that the master's positions are made of.
    pub(crate) fn block(&self) -> FaceBlock {
        FaceBlock::of(&self.coupling, self.face.as_ref())
    }
}

/// Integrals over the covered part of one slave facet.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetIntegrals {
    /// The kind of the facet.
    pub kind: FacetKind,
    /// `int N_i dA`, an area.
    pub shape: [f64; MAX_NODES],
    /// `int N_i dA` without the factors of the gap, however deep or far the master is, an area.
    pub opposite: [f64; MAX_NODES],
    /// `int N_i N_j dA`, an area.
    pub mass: FacetMatrix,
    /// `int N_i N_J dA` with the functions of the slave's face if that is quadratic.
    pub face: Option<FaceMatrix>,
    /// One entry for each master facet opposite, in the order of the segments.
    pub pairs: Vec<PairIntegrals>,
    /// Parametric area of the covered part over that of the facet: 1 if wholly covered.
    pub covered: f64,
}

fn add_products(weighted: &[f64; MAX_NODES], shape: &FaceShape, out: &mut FaceMatrix) {
    for (row, w) in out.iter_mut().zip(weighted) {
        row.iter_mut().zip(shape).for_each(|(o, n)| *o += w * n);
    }
}

/// Integrals over the segments of a facet, with factors at the points. `corners` gives the positions of a master facet; faces: that which the slave facet is a piece of,
/// if it is quadratic, and those of the master.
pub fn facet_integrals(
    found: &FacetSegmentation,
    corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
    slave_face: Option<&FacePiece>,
    master_faces: &Faces,
    factors: &Factors,
) -> FacetIntegrals {
    let kind = found.frame.kind();
    let mut out = FacetIntegrals {
        kind,
        shape: [0.0; MAX_NODES],
        opposite: [0.0; MAX_NODES],
        mass: [[0.0; MAX_NODES]; MAX_NODES],
        face: slave_face.map(|_| [[0.0; MAX_FACE_NODES]; MAX_NODES]),
        pairs: Vec::new(),
        covered: found.parametric_area() / kind.area(),
    };
    for segment in &found.segments {
        let master_face = master_faces.of(segment.master_facet);
        if out.pairs.last().is_none_or(|p| p.master_facet != segment.master_facet) {
            out.pairs.push(PairIntegrals {
                master_facet: segment.master_facet,
                master_kind: segment.master_map.kind(),
                coupling: [[0.0; MAX_NODES]; MAX_NODES],
                mass: [[0.0; MAX_NODES]; MAX_NODES],
                face: master_face.map(|_| [[0.0; MAX_FACE_NODES]; MAX_NODES]),
            });
        }
        let Some(pair) = out.pairs.last_mut() else { continue };
        let master = corners(segment.master_facet);
        let facing = factors.facing_of(&found.frame, &master, false);
        for_each_point(segment, &found.frame, &master, |p| {
            let mut p = *p;
            for i in 0..MAX_NODES {
                out.opposite[i] += facing.value * p.weight * p.slave_shape[i];
            }
            factors.apply(&facing, &mut p);
            for i in 0..MAX_NODES {
                let w = p.weight * p.slave_shape[i];
                out.shape[i] += w;
                for j in 0..MAX_NODES {
                    pair.mass[i][j] += w * p.slave_shape[j];
                    pair.coupling[i][j] += w * p.master_shape[j];
                }
            }
            let weighted = || p.slave_shape.map(|n| p.weight * n);
            if let (Some(face), Some(sum)) = (slave_face, &mut out.face) {
                add_products(&weighted(), &face.shape(p.slave), sum);
            }
            if let (Some(face), Some(sum)) = (master_face, &mut pair.face) {
                add_products(&weighted(), &face.shape(p.master), sum);
            }
        });
    }
    for pair in &out.pairs {
        for i in 0..MAX_NODES {
            for j in 0..MAX_NODES {
                out.mass[i][j] += pair.mass[i][j];
            }
        }
    }
    out
}
