//! The faces of a body beside the rims of a surface: where a surface ends at an edge of its body, the body goes on.

use crate::position;
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet};
use stoss_geometry::{Aabb, BoundingVolumeTree, Patch};
use stoss_reference_element::FacetNodes;

/// Angle between neighbouring facets, in rad, from which on there is an edge of the body.
const SHARP: f64 = 0.5;

/// A facet with what is asked of it.
struct Facing {
    nodes: BTreeSet<u32>,
    normal: Vector3<f64>,
    centre: Vector3<f64>,
}

fn edges(facet: &FacetNodes) -> impl Iterator<Item = [u32; 2]> {
    let count = facet.len();
    (0..count).map(move |k| {
        let (a, b) = (facet[k], facet[(k + 1) % count]);
        [a.min(b), a.max(b)]
    })
}

/// The facets of `boundary`, of the same body as `surface`, that lie beside a rim of it, across a convex edge of the body, and those that go on from there without an edge, as far as they are within
/// `reach` (a length) of the rim; `reference` has the positions of all nodes (`3 * nodes` lengths). `may` is asked of a facet and its outward unit normal whether it can be touched. In the order of `boundary`.
///
/// A point that passes over such a rim has a gap to what is beside it, small and continuous, where a surface that ends there lets it go: the height of the rim in the other body appears and disappears
/// with a move of no length, and no state need be in equilibrium (theory/node-to-surface#rims).
pub fn beside_rims(
    surface: &[FacetNodes],
    boundary: &[FacetNodes],
    reference: &[f64],
    reach: f64,
    may: impl Fn(&FacetNodes, &[f64; 3]) -> bool,
) -> Vec<FacetNodes> {
    let facing = |facet: &FacetNodes| {
        let patch = Patch::new(facet.map(|node| position(reference, node)));
        let corners = || facet.iter().map(|&node| position(reference, node));
        let centre = corners().sum::<Vector3<f64>>() / facet.len() as f64;
        let normal = patch.normal([0.0; 2]);
        Facing { nodes: facet.iter().copied().collect(), normal, centre }
    };
    let all: Vec<Facing> = boundary.iter().map(facing).collect();
    let own: BTreeSet<BTreeSet<u32>> = surface.iter().map(|facet| facet.iter().copied().collect()).collect();
    let is_own: Vec<bool> = all.iter().map(|facet| own.contains(&facet.nodes)).collect();
    let mut at_edge: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (f, facet) in boundary.iter().enumerate() {
        edges(facet).for_each(|edge| at_edge.entry(edge).or_default().push(f));
    }
    let angle =
        |f: usize, g: usize| all[f].normal.cross(&all[g].normal).norm().atan2(all[f].normal.dot(&all[g].normal));
    let touchable = |g: usize| !is_own[g] && may(&boundary[g], &all[g].normal.into());
    let (mut found, mut rim, mut next) = (vec![false; all.len()], BTreeSet::new(), Vec::new());
    for (edge, facets) in &at_edge {
        let &[f, g] = &facets[..] else { continue };
        let (f, g) = if is_own[f] { (f, g) } else { (g, f) };
        let turns_away = (all[g].centre - all[f].centre).dot(&all[f].normal) < 0.0;
        if is_own[f] && turns_away && angle(f, g) > SHARP && touchable(g) {
            rim.extend(*edge);
            next.push(g);
        }
    }
    let rim: Vec<Vector3<f64>> = rim.into_iter().map(|node| position(reference, node)).collect();
    let tree = BoundingVolumeTree::build(&rim.iter().map(|x| Aabb { min: *x, max: *x }).collect::<Vec<Aabb>>());
    let is_near = |g: usize| {
        let mut corners = boundary[g].iter().map(|&node| position(reference, node));
        corners.any(|x| tree.nearest(&x, f64::INFINITY, |k, nearest| nearest.min((x - rim[k]).norm())) <= reach)
    };
    while let Some(f) = next.pop() {
        if std::mem::replace(&mut found[f], true) {
            continue;
        }
        let across = edges(&boundary[f]).filter_map(|edge| at_edge.get(&edge)).flatten().copied();
        next.extend(across.filter(|&g| !found[g] && angle(f, g) <= SHARP && touchable(g) && is_near(g)));
    }
    boundary.iter().zip(found).filter(|(_, found)| *found).map(|(facet, _)| *facet).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of 1 x 1 x 3 cubes: its bottom, its four sides of three facets, its top.
    fn column() -> (Vec<FacetNodes>, Vec<f64>) {
        let node = |i: u32, j: u32, k: u32| i + 2 * j + 4 * k;
        let mut facets: Vec<FacetNodes> = vec![[node(0, 0, 0), node(0, 1, 0), node(1, 1, 0), node(1, 0, 0)].into()];
        for k in 0..3 {
            for [a, b] in [[[0, 0], [1, 0]], [[1, 0], [1, 1]], [[1, 1], [0, 1]], [[0, 1], [0, 0]]] {
                let at = |[i, j]: [u32; 2], k: u32| node(i, j, k);
                facets.push([at(a, k), at(b, k), at(b, k + 1), at(a, k + 1)].into());
            }
        }
        facets.push([node(0, 0, 3), node(1, 0, 3), node(1, 1, 3), node(0, 1, 3)].into());
        let reference = (0..16).flat_map(|n| [f64::from(n % 2), f64::from(n / 2 % 2), f64::from(n / 4)]).collect();
        (facets, reference)
    }

    #[test]
    fn sides_beside_a_bottom() {
        let (facets, reference) = column();
        let count = |reach: f64, may: &dyn Fn(&FacetNodes, &[f64; 3]) -> bool| {
            beside_rims(&facets[..1], &facets, &reference, reach, may).len()
        };
        // The first ring is beside the rim in any case.
        assert_eq!(count(0.0, &|_, _| true), 4);
        assert_eq!(count(1.0, &|_, _| true), 8);
        assert_eq!(count(5.0, &|_, _| true), 12);
        // A plane of symmetry.
        assert_eq!(count(5.0, &|_, normal| normal[0] > -0.5), 9);
        // The floor of a notch ends at its walls, which it does not turn away from.
        let inside: Vec<FacetNodes> = facets.iter().map(|f| [f[3], f[2], f[1], f[0]].into()).collect();
        assert_eq!(beside_rims(&inside[..1], &inside, &reference, 5.0, |_, _| true).len(), 0);
    }

    /// The sides of a box with lines at random heights and places: what the surface at its bottom gets is what a search among all facets gives.
    #[test]
    fn sides_of_a_random_box_are_those_that_all_pairs_of_nodes_give() {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (around, up, mut partial) = (24_u32, 6_u32, 0);
        for _ in 0..20 {
            // Corners of a box, and points at random places between them.
            let mut angles: Vec<f64> =
                (0..around).map(|k| f64::from(k / 6) + if k % 6 == 0 { 0.0 } else { next() }).collect();
            angles.sort_by(f64::total_cmp);
            let mut heights: Vec<f64> = (0..=up).map(|k| if k == 0 { 0.0 } else { 3.0 * next() }).collect();
            heights.sort_by(f64::total_cmp);
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
            let ring = |s: f64| {
                let (k, part) = (s as usize, s.fract());
                [0, 1].map(|i| corners[k][i] + part * (corners[k + 1][i] - corners[k][i]))
            };
            let mut reference: Vec<f64> = Vec::new();
            for z in &heights {
                angles.iter().for_each(|&s| reference.extend(ring(s).into_iter().chain([*z])));
            }
            let middle = around * (up + 1);
            reference.extend([0.5, 0.5, 0.0]);
            let node = |k: u32, l: u32| k % around + around * l;
            let bottom: Vec<FacetNodes> = (0..around).map(|k| [node(k + 1, 0), node(k, 0), middle].into()).collect();
            let quad = |k: u32, l: u32| -> FacetNodes {
                [node(k, l), node(k + 1, l), node(k + 1, l + 1), node(k, l + 1)].into()
            };
            let places: Vec<[u32; 2]> = (0..up).flat_map(|l| (0..around).map(move |k| [k, l])).collect();
            let sides = places.iter().map(|&[k, l]| quad(k, l));
            let all: Vec<FacetNodes> = bottom.iter().copied().chain(sides).collect();
            let reach = 1.5 * next();
            let found = beside_rims(&bottom, &all, &reference, reach, |_, _| true);
            // A facet is near or not, and is reached from the rim along its own column or from beside, on the same side.
            let near = |[k, l]: [u32; 2]| {
                let of_facet = [node(k, l), node(k + 1, l), node(k + 1, l + 1), node(k, l + 1)];
                let mut pairs = of_facet.into_iter().flat_map(|a| (0..around).map(move |b| [a, b]));
                pairs.any(|[a, b]| (position(&reference, a) - position(&reference, b)).norm() <= reach)
            };
            let mut expected: BTreeSet<[u32; 2]> = (0..around).map(|k| [k, 0]).collect();
            loop {
                let touches = |&[k, l]: &[u32; 2]| {
                    let beside =
                        [[(k + 1) % around, l], [(k + around - 1) % around, l], [k, l + 1], [k, l.wrapping_sub(1)]];
                    beside.into_iter().any(|other| other[0] / 6 == k / 6 && expected.contains(&other))
                };
                let more: Vec<[u32; 2]> =
                    places.iter().filter(|at| !expected.contains(*at) && touches(at) && near(**at)).copied().collect();
                if more.is_empty() {
                    break;
                }
                expected.extend(more);
            }
            let expected: Vec<FacetNodes> =
                places.iter().filter(|at| expected.contains(*at)).map(|&[k, l]| quad(k, l)).collect();
            assert_eq!(found, expected);
            partial += usize::from(found.len() > around as usize && found.len() < places.len());
        }
        assert!(partial > 5, "{partial}");
    }
}
