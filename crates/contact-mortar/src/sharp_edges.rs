//! Sharp edges of a surface in the reference configuration, and the smooth parts into which they divide it.

use crate::surfaces::{area_vector, corners};
use nalgebra::Vector3;
use stoss_contact::ContactSurface;

/// Cosine of the angle between the normals of two facets in the reference configuration from which on the edge between them is sharp, 34.4 degrees: a chamfer of
/// 45 degrees is, a round side of twelve facets is not. It lies between the edges of regular prisms with ten and with eleven sides, so that round-off
/// decides nothing.
const SHARP: f64 = 0.825;

/// Unit normals of all facets at positions `q`; zero where there is none.
pub(crate) fn unit_normals(surface: &ContactSurface, q: &[f64]) -> Vec<Vector3<f64>> {
    let facets = 0..surface.facets().len() as u32;
    facets.map(|f| area_vector(&corners(surface, f, q)).try_normalize(0.0).unwrap_or_default()).collect()
}

/// Whether an edge between facets with these reference normals is sharp.
pub(crate) fn is_sharp(normals: &[Vector3<f64>], e: usize, f: usize) -> bool {
    normals[e].dot(&normals[f]) <= SHARP
}

/// Whether a surface has sharp edges; reference normals.
pub(crate) fn has_sharp_edges(surface: &ContactSurface, normals: &[Vector3<f64>]) -> bool {
    (0..normals.len()).any(|f| surface.neighbours(f as u32).any(|e| is_sharp(normals, e as usize, f)))
}

/// More smooth parts than this, as a coarse mesh of a round body has, are taken for one.
const MOST_PARTS: usize = 12;

/// Numbers of the smooth parts into which sharp edges divide a surface, one a facet, and how many there are; reference normals.
pub(crate) fn smooth_parts(surface: &ContactSurface, normals: &[Vector3<f64>]) -> (Vec<usize>, usize) {
    const NONE: usize = usize::MAX;
    let mut parts = vec![NONE; normals.len()];
    let mut count = 0;
    for first in 0..normals.len() {
        if parts[first] != NONE {
            continue;
        }
        parts[first] = count;
        let mut reached = vec![first];
        while let Some(f) = reached.pop() {
            for e in surface.neighbours(f as u32).map(|e| e as usize) {
                if parts[e] == NONE && !is_sharp(normals, e, f) {
                    parts[e] = count;
                    reached.push(e);
                }
            }
        }
        count += 1;
    }
    if count > MOST_PARTS { (vec![0; normals.len()], 1) } else { (parts, count) }
}
