//! Surfaces that move with few vectors: all nodes of a rigid body's surface are carried by its centre and directors.

use crate::{ContactError, ContactSurface, position};
use nalgebra::Vector3;
use stoss_geometry::{Aabb, BoundingVolumeTree};

/// How far a surface may turn or deform after its tree was fitted, in lengths of facets, before it is fitted again: as long as boxes have not moved farther than
/// that from where a translation takes them, queries that allow for it visit a few facets more.
const REFIT_MOTION: f64 = 2.0;

/// A bounding-volume tree over the facets of a surface, and where the surface was when it was fitted.
#[derive(Clone, Debug)]
pub struct SurfaceTree {
    tree: BoundingVolumeTree,
    /// Positions of the carriers, of a surface without those of its nodes; empty if not known.
    fitted: Vec<Vector3<f64>>,
}

impl SurfaceTree {
    /// The tree at positions `q`.
    ///
    /// # Errors
    /// [`ContactError::MissingNode`] if `q` is too short.
    pub fn new(surface: &ContactSurface, q: &[f64]) -> Result<Self, ContactError> {
        let count = q.len() / 3;
        let short = |facet: usize| surface.facets()[facet].iter().copied().find(|&n| n as usize >= count);
        if let Some((facet, node)) = (0..surface.facets().len()).find_map(|f| Some((f, short(f)?))) {
            return Err(ContactError::MissingNode { facet: facet as u32, node, count });
        }
        let boxes: Vec<Aabb> = (0..surface.facets().len()).map(|facet| facet_box(surface, facet, q)).collect();
        let mut tree = Self { tree: BoundingVolumeTree::build(&boxes), fitted: Vec::new() };
        tree.note(surface, q);
        Ok(tree)
    }

    fn note(&mut self, surface: &ContactSurface, q: &[f64]) {
        match surface.carriers() {
            Some(carriers) => self.fitted = carriers.values(q),
            None => {
                self.fitted.clear();
                self.fitted.extend(surface.nodes().iter().map(|&n| position(q, n)));
            }
        }
    }

    /// Fits the tree to positions `q`: that of a surface with carriers when it has turned too far, and then in few steps; else by one pass over the facets.
    pub fn update(&mut self, surface: &ContactSurface, q: &[f64]) {
        let has_moved_far = || self.motion(surface, q).1 > REFIT_MOTION * surface.length_scale();
        if surface.carriers().is_none() || has_moved_far() {
            self.tree.refit(|facet| facet_box(surface, facet, q));
            self.note(surface, q);
        }
    }

    /// Forgets where it was fitted: whoever tells a surface what carries it has to fit the tree again.
    pub fn forget(&mut self) {
        self.fitted.clear();
    }

    /// The motion of the surface from where the tree was fitted to `q`: a translation, and how far a node is at most from where that takes it. One pass over
    /// the nodes if the surface has no carriers.
    pub fn motion(&self, surface: &ContactSurface, q: &[f64]) -> (Vector3<f64>, f64) {
        match surface.carriers() {
            Some(_) if self.fitted.is_empty() => (Vector3::zeros(), f64::INFINITY),
            Some(carriers) => carriers.motion(&self.fitted, q),
            None => {
                let moved = || surface.nodes().iter().zip(&self.fitted).map(|(&n, old)| position(q, n) - old);
                let shift = moved().sum::<Vector3<f64>>() / self.fitted.len() as f64;
                (shift, moved().map(|u| (u - shift).norm()).fold(0.0, f64::max))
            }
        }
    }

    /// The tree.
    pub fn tree(&self) -> &BoundingVolumeTree {
        &self.tree
    }
}

/// The box around a facet at positions `q`.
fn facet_box(surface: &ContactSurface, facet: usize, q: &[f64]) -> Aabb {
    Aabb::from_points(&surface.patch(facet as u32, q).corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane of 6 x 5 facets on a frame of three vectors, moved and turned by anything: every node is within the bound of the place that the translation
    /// gives, and queries that allow for it find what is there.
    #[test]
    fn motions_of_carriers_bound_those_of_nodes() {
        let weights: Vec<[(u32, f64); 3]> =
            (0..42).map(|k| [(42, 1.0), (43, f64::from(k % 7) - 2.0), (44, 0.3 * f64::from(k / 7))]).collect();
        let facet = |k: u32| [k, k + 1, k + 8, k + 7];
        let facets: Vec<[u32; 4]> = (0..35).filter(|k| k % 7 != 6).map(facet).collect();
        let place = |carriers: [[f64; 3]; 3]| -> Vec<f64> {
            let of = |w: &[(u32, f64); 3]| {
                std::array::from_fn::<_, 3, _>(|i| (0..3).map(|k| w[k].1 * carriers[k][i]).sum::<f64>())
            };
            weights.iter().flat_map(of).chain(carriers.into_iter().flatten()).collect()
        };
        let start = place([[0.1, 0.2, 0.3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let mut surface = ContactSurface::new("master", &facets, &start).unwrap();
        surface.set_carriers(&|node| weights.get(node as usize).map(|w| &w[..]));
        assert!(surface.carriers().is_some());
        let mut tree = SurfaceTree::new(&surface, &start).unwrap();
        assert_eq!(tree.motion(&surface, &start), (Vector3::zeros(), 0.0));
        let mut turned = start.clone();
        for step in 1..40 {
            let (sine, cosine) = (0.07 * f64::from(step)).sin_cos();
            turned = place([[3.0, 0.2 * f64::from(step), -1.0], [cosine, 0.0, sine], [0.1 * sine, cosine, 0.0]]);
            let (shift, excess) = tree.motion(&surface, &turned);
            for &node in surface.nodes() {
                let off = position(&turned, node) - position(&start, node) - shift;
                // The tree may have been fitted since.
                assert!(step > 1 || off.norm() <= excess, "{step}: {} > {excess}", off.norm());
            }
            tree.update(&surface, &turned);
            let (shift, excess) = tree.motion(&surface, &turned);
            assert!(excess <= REFIT_MOTION * surface.length_scale());
            for f in 0..facets.len() {
                let now = facet_box(&surface, f, &turned);
                let mut found = false;
                let region = Aabb { min: now.min - shift, max: now.max - shift };
                tree.tree().query(&region.inflated(excess), |other| found |= other == f);
                assert!(found, "facet {f} at step {step}");
            }
        }
        assert!(tree.motion(&surface, &start).1 > 0.0 && turned != start);
    }
}
