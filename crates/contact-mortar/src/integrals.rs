//! Integrals of the shape functions over the segments of one slave facet.

use crate::{Factors, TriangleRule, for_each_point};
use nalgebra::Vector3;
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal};
use stoss_segmentation::FacetSegmentation;

/// Matrix over the nodes of two facets; zero where there is no node.
pub type FacetMatrix = [[f64; MAX_NODES]; MAX_NODES];

/// Integrals with one master facet.
#[derive(Clone, Debug, PartialEq)]
pub struct PairIntegrals {
    /// Local number of the master facet.
    pub master_facet: u32,
    /// Its kind.
    pub master_kind: FacetKind,
    /// `int N_i^(1) N_k^(2) dA`, an area.
    pub coupling: FacetMatrix,
    /// `int N_i N_j dA` over this pair only.
    pub mass: FacetMatrix,
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
    /// One entry for each master facet opposite, in the order of the segments.
    pub pairs: Vec<PairIntegrals>,
    /// Parametric area of the covered part over that of the facet: 1 if wholly covered.
    pub covered: f64,
}

/// Integrals over the segments of a facet, with factors at the points. `corners` gives the positions of a master facet.
pub fn facet_integrals(
    found: &FacetSegmentation,
    corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
    rule: TriangleRule,
    factors: &Factors,
) -> FacetIntegrals {
    let kind = found.frame.kind();
    let mut out = FacetIntegrals {
        kind,
        shape: [0.0; MAX_NODES],
        opposite: [0.0; MAX_NODES],
        mass: [[0.0; MAX_NODES]; MAX_NODES],
        pairs: Vec::new(),
        covered: found.parametric_area() / kind.area(),
    };
    for segment in &found.segments {
        if out.pairs.last().is_none_or(|p| p.master_facet != segment.master_facet) {
            out.pairs.push(PairIntegrals {
                master_facet: segment.master_facet,
                master_kind: segment.master_map.kind(),
                coupling: [[0.0; MAX_NODES]; MAX_NODES],
                mass: [[0.0; MAX_NODES]; MAX_NODES],
            });
        }
        let Some(pair) = out.pairs.last_mut() else { continue };
        let master = corners(segment.master_facet);
        let facing = factors.facing_of(&found.frame, &master, false);
        for_each_point(segment, &found.frame, &master, rule, |p| {
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
