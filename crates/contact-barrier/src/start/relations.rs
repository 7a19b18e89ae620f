//! Bodies that lie in each other at the start.

use super::Bodies;
use crate::{Interaction, Interactions, Overlaps, Relation, Separation, Skin, SkinFacet};

type Vector3 = nalgebra::Vector3<f64>;

/// How deep two bodies overlap: the shortest way out for the first one.
pub(super) fn depth(skin: &Skin, rules: &Interactions, reference: &[f64], [a, b]: [u32; 2]) -> Option<Separation> {
    let overlaps = Overlaps::new(skin, rules, reference);
    let limit = overlaps.extents(a)[0].min(overlaps.extents(b)[0]);
    overlaps.separation([a, b], &Vector3::zeros(), 0.0, limit)
}

/// Whether two bodies are free of each other after a motion by no more than `limit`.
pub(super) fn slight<'a>(
    skin: &Skin,
    rules: &Interactions,
    reference: &'a [f64],
    limit: f64,
) -> impl Fn([u32; 2]) -> bool + use<'a> {
    let overlaps = Overlaps::new(skin, rules, reference);
    move |[a, b]| a != b && overlaps.separation([a, b], &Vector3::zeros(), 0.0, limit).is_some()
}

/// Two bodies of which one lies in the other although no edge goes through a facet: wholly, or with common planes. Those for which `is_slight` holds are left out.
pub(super) fn inside(
    skin: &Skin,
    rules: &Interactions,
    reference: &[f64],
    is_slight: &impl Fn([u32; 2]) -> bool,
) -> Option<([u32; 2], Relation)> {
    let overlaps = Overlaps::new(skin, rules, reference);
    let relation = |pair| (pair, overlaps.relation(pair, &Vector3::zeros(), 0.0));
    let mut relations = rules.body_pairs().into_iter().map(relation);
    relations.find(|(pair, relation)| !matches!(relation, Relation::Apart(_)) && !is_slight(*pair))
}

/// Two bodies of which one is wholly inside the other: of whole bodies, also where some of their surfaces are left out. [`inside`] knows only what acts.
pub(super) fn enclosed(bodies: &dyn Bodies, rules: &Interactions, reference: &[f64]) -> Option<[u32; 2]> {
    let count = bodies.count();
    let bounds = |part: u32| {
        let x = |node: u32| Vector3::from_column_slice(&reference[3 * node as usize..3 * node as usize + 3]);
        let none = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
        bodies.surface(part).iter().flatten().fold(none, |[low, high], &node| [low.inf(&x(node)), high.sup(&x(node))])
    };
    let boxes: Vec<[Vector3; 2]> = (0..count).map(bounds).collect();
    let holds = |outer: u32, inner: u32| {
        let ([low, high], [first, last]) = (boxes[outer as usize], boxes[inner as usize]);
        (0..3).all(|i| first[i] >= low[i] && last[i] <= high[i] && first[i] <= last[i])
    };
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let is_near = |[a, b]: &[u32; 2]| (holds(*a, *b) || holds(*b, *a)) && rules.acts_between([*a, *b]);
    let pairs: Vec<[u32; 2]> = pairs.filter(is_near).collect();
    if pairs.is_empty() {
        return None;
    }
    let mut all = Interactions::none(&(0..count).map(|part| (part, 1.0)).collect::<Vec<_>>());
    pairs.iter().for_each(|&[a, b]| all.set(a, b, Some(Interaction { modulus: 1.0, friction: None })));
    let facets = (0..count)
        .filter(|part| pairs.iter().any(|pair| pair.contains(part)))
        .flat_map(|class| bodies.surface(class).into_iter().map(move |nodes| SkinFacet { nodes, class }));
    let skin = Skin::new(facets.collect(), reference, &|_| None);
    let overlaps = Overlaps::new(&skin, &all, reference);
    pairs.into_iter().find(|pair| overlaps.is_enclosed(*pair))
}
