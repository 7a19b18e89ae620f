//! Areas of a surface that are in contact, at its nodes.

use crate::Skin;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_contact::position;

/// A point of integration in contact with a triangle.
pub(super) struct Meeting {
    pub point: u32,
    /// Triangle that the point is in.
    pub own: u32,
    pub triangle: u32,
    /// Shares of the corners of that triangle in the place that the point is next to.
    pub weights: [f64; 3],
    /// Reference area that the pair stands for.
    pub weight: f64,
}

/// Vectors of the current areas of the triangles.
pub(super) fn areas_of_triangles(skin: &Skin, q: &[f64]) -> Vec<Vector3<f64>> {
    let of_vertex = |vertex: u32| {
        let mut x = Vector3::zeros();
        skin.shares(vertex, 1.0, &mut |k, share| x += position(q, skin.surface_nodes()[k]) * share);
        x
    };
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(of_vertex);
        (b - a).cross(&(c - a)) * 0.5
    };
    skin.triangles().iter().map(area).collect()
}

/// Vectors of the current areas that belong to the surface nodes, of what is in contact and of all, with their sizes.
///
/// A facet is in contact where its points of integration are, each of which stands for its part of the facet, or, if that is more, where those of others meet it (facets of rigid bodies, and large ones, whose own points do not act).
pub(super) struct Areas {
    vectors: [Vec<Vector3<f64>>; 2],
    sizes: [Vec<f64>; 2],
}

impl Areas {
    pub fn of(skin: &Skin, triangles: &[Vector3<f64>], meets: &[Meeting]) -> Self {
        let n = skin.surface_nodes().len();
        let mut areas =
            Self { vectors: [(); 2].map(|()| vec![Vector3::zeros(); n]), sizes: [(); 2].map(|()| vec![0.0; n]) };
        for (area, corners) in triangles.iter().zip(skin.triangles()) {
            corners.iter().for_each(|&corner| areas.add(skin, 1, corner, area / 3.0, 1.0));
        }
        // A point may meet several triangles, and counts once.
        let mut points: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        meets.iter().for_each(|m| *points.entry((m.point, m.own)).or_default() += 1.0);
        let size = |t: u32| triangles[t as usize].norm();
        let facet = |t: u32| skin.facet_of_triangle(t) as usize;
        let mut by_own = vec![0.0; skin.facets().len()];
        let mut by_others = vec![0.0; skin.facets().len()];
        points.keys().for_each(|&(_, t)| by_own[facet(t)] += size(t) / 3.0);
        // What the pair stands for, as it is now.
        let met = |m: &Meeting| {
            let stretch = size(m.own) / skin.reference_area(m.own).max(f64::MIN_POSITIVE);
            m.weight * stretch / points[&(m.point, m.own)]
        };
        meets.iter().for_each(|m| by_others[facet(m.triangle)] += met(m));
        for &(point, t) in points.keys().filter(|&&(_, t)| by_own[facet(t)] >= by_others[facet(t)]) {
            areas.add(skin, 0, point, triangles[t as usize] / 3.0, 1.0);
        }
        for m in meets.iter().filter(|m| by_own[facet(m.triangle)] < by_others[facet(m.triangle)]) {
            let area = triangles[m.triangle as usize].try_normalize(0.0).unwrap_or_default() * met(m);
            for (&corner, share) in skin.triangles()[m.triangle as usize].iter().zip(m.weights) {
                areas.add(skin, 0, corner, area, share);
            }
        }
        areas
    }

    /// Adds a share of the area at a point.
    fn add(&mut self, skin: &Skin, kind: usize, point: u32, area: Vector3<f64>, share: f64) {
        let size = area.norm();
        skin.shares(point, share, &mut |k, share| {
            self.vectors[kind][k] += area * share;
            self.sizes[kind][k] += size * share;
        });
    }

    /// Area and normal of a surface node.
    pub fn at(&self, k: usize) -> (f64, Vector3<f64>) {
        let kind = usize::from(self.sizes[0][k] == 0.0);
        (self.sizes[kind][k], self.vectors[kind][k].try_normalize(0.0).unwrap_or_default())
    }
}
