//! Places below the surfaces of bodies.

use super::Bodies;
use super::rigid::{AffineBasis, fits};
use crate::{Facing, Interactions, Skin, SkinFacet, mitre};
use std::collections::BTreeMap;
use stoss_contact::round::BEYOND;

/// How far, in natural coordinates, a node of a curved element may lie outside of the element that it goes with at the rim of what goes inside: it goes along a chord of the side.
const BESIDE: f64 = 0.05;

/// What a node that cannot go inside needs.
pub(super) struct NoRoom {
    pub body: u32,
    pub node: u32,
    pub depth: f64,
    pub reason: &'static str,
}

/// What the skin is made for.
pub(super) struct Given<'a> {
    pub bodies: &'a dyn Bodies,
    pub rules: &'a Interactions,
    pub reference: &'a [f64],
}

/// Nodes and weights of the vertices that go below the surface, by their nodes: at the depth (a length) of each triangle, which is 0 where it stays.
pub(super) fn inset(
    given: &Given<'_>,
    skin: &Skin,
    facing: &Facing<'_>,
    bases: &BTreeMap<u32, Option<AffineBasis>>,
    depths: &[f64],
) -> Result<BTreeMap<u32, Vec<(u32, f64)>>, NoRoom> {
    let &Given { bodies, rules, reference } = given;
    let mut around: BTreeMap<u32, (u32, Vec<_>)> = BTreeMap::new();
    let mut deepest: BTreeMap<u32, f64> = BTreeMap::new();
    for (t, triangle) in (0..).zip(skin.triangles()) {
        let depth = depths[t as usize];
        let largest = deepest.entry(facing.body(t)).or_insert(0.0);
        *largest = largest.max(depth);
        for &v in triangle {
            if let [(node, _)] = skin.terms(v) {
                around.entry(*node).or_insert((facing.body(t), Vec::new())).1.push((facing.normal(t), depth));
            }
        }
    }
    let mut places = BTreeMap::new();
    for (node, (body, facets)) in around {
        if facets.iter().all(|(_, depth)| *depth == 0.0) {
            continue;
        }
        let depth = facets.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
        let no_room = |reason| NoRoom { body, node, depth, reason };
        let m = mitre(&facets).ok_or_else(|| no_room("facets there face each other"))?;
        let at = std::array::from_fn(|i| reference[3 * node as usize + i] - m[i]);
        if let Some(basis) = bases.get(&body) {
            // cannot fail: bodies without an inside have no part in the inset.
            let basis = basis.as_ref().ok_or_else(|| no_room("the surface is flat or not closed"))?;
            places.insert(node, basis.terms(at));
            continue;
        }
        // Vertices of traces of curved faces need not lie in an element: the nearest one goes on beyond its faces.
        let is_rim = facets.iter().any(|(_, depth)| *depth == 0.0);
        let beyond = match (bodies.is_carried(node), is_rim) {
            (true, _) => BEYOND,
            (false, true) => BESIDE,
            (false, false) => 0.0,
        };
        let point = bodies.material_point(body, at, beyond);
        places.insert(node, point.ok_or_else(|| no_room("the body is too thin there"))?);
    }
    for (&body, _) in bases.iter().filter(|(_, basis)| basis.is_some()) {
        let depth = deepest.get(&body).copied().unwrap_or_default();
        if depth == 0.0 {
            continue;
        }
        let of_body = facets_of(skin.facets(), rules, body);
        let own = (0..).zip(skin.facets()).filter(|(_, facet)| rules.body(facet.class) == body);
        let goes_inside = |f: u32| skin.triangles_of(f).iter().any(|&t| depths[t as usize] > 0.0);
        let inside: Vec<bool> = own.map(|(f, _)| goes_inside(f)).collect();
        let least = depths.iter().enumerate().filter(|(t, d)| **d > 0.0 && facing.body(*t as u32) == body);
        let least = least.map(|(_, d)| *d).fold(depth, f64::min);
        let place = |node: u32| places.get(&node).cloned();
        if !fits(&of_body, &inside, reference, least, &place) {
            let node = of_body.iter().zip(&inside).find(|(_, inside)| **inside).map_or(0, |(facet, _)| facet.nodes[0]);
            return Err(NoRoom { body, node, depth, reason: "the body is too thin" });
        }
    }
    Ok(places)
}

pub(super) fn facets_of(facets: &[SkinFacet], rules: &Interactions, body: u32) -> Vec<SkinFacet> {
    facets.iter().filter(|facet| rules.body(facet.class) == body).copied().collect()
}
