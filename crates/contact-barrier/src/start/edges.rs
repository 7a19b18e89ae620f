//! The edge that the layer of general contact is thin for.

use crate::{Facing, Interactions, Skin};
use std::collections::BTreeSet;

/// Thickness of the layer in parts of that edge, where it is not given.
pub const THICKNESS: f64 = 0.04;

/// A facet faces another one within so many times the longest side of its triangles.
const FEW: f64 = 2.0;

/// Distance, in parts of the shortest edge, by which facets that touch may be behind each other.
const BEHIND: f64 = 1e-4;

/// Largest edge for the layer, in shortest edges of all: what faces nothing at the start may come into contact later.
const COARSEST: f64 = 4.0;

/// The edge that the layer is thin for, a length: the shortest one of facets that face another one within a few edges and of those beside them (the sides of the elements there), four times that of all facets at most; the latter where nothing faces anything.
pub(super) fn edge_of(
    skin: &Skin,
    facing: &Facing<'_>,
    rules: &Interactions,
    is_rigid: &dyn Fn(u32) -> bool,
    reference: &[f64],
) -> f64 {
    let of_all = shortest_edge(skin, rules, is_rigid, reference, |_| true);
    // What touches may be behind by round-off.
    let found = facing.find(|t| FEW * facing.longest_side(t), BEHIND * of_all);
    let facets = || found.values().flatten().map(|&t| &skin.facets()[skin.facet_of_triangle(t) as usize]);
    let nodes: BTreeSet<u32> = facets().flat_map(|facet| facet.nodes.iter()).copied().collect();
    let is_beside = |f: u32| skin.facets()[f as usize].nodes.iter().any(|node| nodes.contains(node));
    let of_these = shortest_edge(skin, rules, is_rigid, reference, is_beside);
    if of_these.is_finite() { of_these.min(COARSEST * of_all) } else { of_all }
}

/// The shortest edge of those facets of deformable bodies that `counts` lets in; infinite if there is none. Facets of rigid ones may be slivers, and much smaller than what they touch: they count only where there is nothing else.
pub(super) fn shortest_edge(
    skin: &Skin,
    rules: &Interactions,
    is_rigid: &dyn Fn(u32) -> bool,
    reference: &[f64],
    counts: impl Fn(u32) -> bool,
) -> f64 {
    let at = |node: u32, i: usize| reference[3 * node as usize + i];
    let length = |a: u32, b: u32| (0..3).map(|i| (at(a, i) - at(b, i)).powi(2)).sum::<f64>();
    let mut shortest = [f64::INFINITY; 2];
    for (_, facet) in (0..).zip(skin.facets()).filter(|(f, _)| counts(*f)) {
        let rigid = usize::from(is_rigid(rules.body(facet.class)));
        for &[i, j] in facet.nodes.kind().sides() {
            shortest[rigid] = shortest[rigid].min(length(facet.nodes[i], facet.nodes[j]));
        }
    }
    let [deformable, rigid] = shortest;
    if deformable.is_finite() { deformable.sqrt() } else { rigid.sqrt() }
}

/// The edge, a length, that the layer between bodies is thin for at the positions `reference` (`3 * nodes`, lengths): the shortest one of what faces each other. The thickness is [`THICKNESS`] of it if nothing asks for another one.
pub fn layer_edge(skin: &Skin, rules: &Interactions, is_rigid: &dyn Fn(u32) -> bool, reference: &[f64]) -> f64 {
    edge_of(skin, &Facing::new(skin, rules, reference), rules, is_rigid, reference)
}
