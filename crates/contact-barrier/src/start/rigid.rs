//! Surfaces a little below those of rigid bodies: their points are affine combinations of four nodes of the surface.

use crate::{Interaction, Interactions, Skin, SkinFacet, check_initial, is_closed};
use nalgebra::Matrix3;

type Vector3 = nalgebra::Vector3<f64>;

/// A surface whose four nodes span a smaller volume than this part of its size cubed is flat.
const FLAT: f64 = 1e-6;

/// Least distance of the surface inside to the surface, in depths: a depth, but for facets that are not plane.
const LEAST: f64 = 0.9;

/// Classes of facets: those that go inside where they were and where they are, and those that stay.
const OUTER: u32 = 0;
const INNER: u32 = 1;
const STAYS: u32 = 2;

/// Four nodes of a rigid surface that tell where any of its points is.
#[derive(Clone, Debug)]
pub(super) struct AffineBasis {
    nodes: [u32; 4],
    origin: Vector3,
    inverse: Matrix3<f64>,
}

fn at(reference: &[f64], node: u32) -> Vector3 {
    Vector3::from_column_slice(&reference[3 * node as usize..3 * node as usize + 3])
}

impl AffineBasis {
    /// Nodes of these facets that are far apart. `None` of a surface that is flat, or not closed and thus without an inside.
    pub fn of(facets: &[SkinFacet], reference: &[f64]) -> Option<Self> {
        let skin = Skin::new(facets.to_vec(), reference, &|_| None);
        if !is_closed(skin.triangles()) {
            return None;
        }
        let nodes = skin.surface_nodes();
        let x = |node: u32| at(reference, node);
        let farthest =
            |size: &dyn Fn(&Vector3) -> f64| nodes.iter().copied().max_by(|&a, &b| size(&x(a)).total_cmp(&size(&x(b))));
        let a = *nodes.first()?;
        let origin = x(a);
        let b = farthest(&|x| (x - origin).norm())?;
        let u = x(b) - origin;
        let c = farthest(&|x| u.cross(&(x - origin)).norm())?;
        let v = x(c) - origin;
        let d = farthest(&|x| u.cross(&v).dot(&(x - origin)).abs())?;
        let edges = Matrix3::from_columns(&[u, v, x(d) - origin]);
        if edges.determinant().abs() <= FLAT * u.norm().powi(3) {
            return None;
        }
        Some(Self { nodes: [a, b, c, d], origin, inverse: edges.try_inverse()? })
    }

    /// Nodes and weights, of sum one, of a point.
    pub fn terms(&self, point: [f64; 3]) -> Vec<(u32, f64)> {
        let parts = self.inverse * (Vector3::from(point) - self.origin);
        let [a, b, c, d] = self.nodes;
        let mut terms = vec![(a, 1.0 - parts.sum()), (b, parts[0]), (c, parts[1]), (d, parts[2])];
        terms.sort_by_key(|term| term.0);
        terms
    }
}

/// Whether a surface with nodes at other places, `depth` (a length) below these where facets are `inside`, stays that far from what it was there, goes through no other facet, and does not turn inside out: not so where the body is too thin.
pub(super) fn fits(
    facets: &[SkinFacet],
    inside: &[bool],
    reference: &[f64],
    depth: f64,
    place: &dyn Fn(u32) -> Option<Vec<(u32, f64)>>,
) -> bool {
    let class = |inside: &bool| if *inside { OUTER } else { STAYS };
    let all: Vec<SkinFacet> =
        facets.iter().zip(inside).map(|(facet, inside)| SkinFacet { class: class(inside), ..*facet }).collect();
    let skin = Skin::new(all.clone(), reference, place);
    let before = Skin::new(all.clone(), reference, &|_| None);
    let normal = |skin: &Skin, triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| skin.at(v, reference));
        (b - a).cross(&(c - a))
    };
    let turns = |triangle: &[u32; 3]| normal(&skin, triangle).dot(&normal(&before, triangle)) <= 0.0;
    if skin.triangles().iter().any(turns) {
        return false;
    }
    // The surface inside gets nodes of its own.
    let mut q = reference.to_vec();
    let first = (reference.len() / 3) as u32;
    let nodes = skin.surface_nodes();
    (0..nodes.len() as u32).for_each(|vertex| q.extend_from_slice(skin.at(vertex, reference).as_slice()));
    // cannot fail: these are the nodes of the facets.
    let number = |node: u32| first + nodes.binary_search(&node).unwrap_or_default() as u32;
    let inner = all.iter().filter(|facet| facet.class == OUTER);
    let inner = inner.map(|facet| SkinFacet { nodes: facet.nodes.map(number), class: INNER });
    let both = Skin::new(all.iter().copied().chain(inner).collect(), &q, &|_| None);
    let mut rules = Interactions::none(&[OUTER, INNER, STAYS].map(|class| (class, 1.0)));
    let acts = Some(Interaction { modulus: 1.0, friction: None });
    [OUTER, STAYS].into_iter().for_each(|class| rules.set(class, INNER, acts.clone()));
    let look = check_initial(&both, &rules, &q, depth);
    let nearest = look.nearest.get(&[OUTER, INNER]);
    look.crossings.is_empty() && nearest.is_none_or(|nearest| nearest.distance >= LEAST * depth)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(height: f64) -> (Vec<SkinFacet>, Vec<f64>) {
        const FACES: [[u32; 4]; 6] =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let q = [0.0, height].iter().flat_map(|&z| corners.iter().flat_map(move |c| [c[0], c[1], z])).collect();
        (FACES.iter().map(|&nodes| SkinFacet { nodes: nodes.into(), class: 3 }).collect(), q)
    }

    #[test]
    fn points_follow_any_rigid_motion() {
        let (facets, q) = cube(1.0);
        let basis = AffineBasis::of(&facets, &q).unwrap();
        let terms = basis.terms([0.1, 0.7, 0.2]);
        assert!((terms.iter().map(|term| term.1).sum::<f64>() - 1.0).abs() < 1e-15);
        // A quarter turn about z and a translation.
        let moved: Vec<f64> = q.chunks(3).flat_map(|x| [2.0 - x[1], x[0], x[2] + 5.0]).collect();
        let x: Vector3 = terms.iter().map(|&(node, w)| at(&moved, node) * w).sum();
        assert!((x - Vector3::new(1.3, 0.1, 5.2)).norm() < 1e-14);
        assert!(AffineBasis::of(&facets[..5], &q).is_none());
        let (flat, q) = cube(1e-9);
        assert!(AffineBasis::of(&flat, &q).is_none());
    }

    /// The bottom alone goes inside: the sides of the body are around it, and its top may be as near as it likes, but not below it.
    #[test]
    fn a_base_goes_inside_alone() {
        for (height, fits_it) in [(0.09, false), (0.11, true), (1.0, true)] {
            let (facets, q) = cube(height);
            let basis = AffineBasis::of(&facets, &q).unwrap();
            let place = |node: u32| {
                let x = at(&q, node);
                (x[2] == 0.0).then(|| basis.terms([x[0], x[1], 0.1]))
            };
            let inside = [true, false, false, false, false, false];
            assert_eq!(fits(&facets, &inside, &q, 0.1, &place), fits_it, "{height}");
        }
    }

    #[test]
    fn thin_bodies_have_no_room() {
        for (height, fits_it) in [(0.1, false), (0.18, false), (0.21, true), (1.0, true)] {
            let (facets, q) = cube(height);
            let basis = AffineBasis::of(&facets, &q).unwrap();
            let depth = 0.1;
            let place = |node: u32| {
                let x = at(&q, node);
                let inwards = |x: f64, high: f64| if x == 0.0 { depth } else { high - depth };
                Some(basis.terms([inwards(x[0], 1.0), inwards(x[1], 1.0), inwards(x[2], height)]))
            };
            assert_eq!(fits(&facets, &[true; 6], &q, depth, &place), fits_it, "{height}");
        }
    }
}
