//! The faces of a master's body beside the rims of the master, which node-to-surface contact takes as well (theory/node-to-surface#rims).

use super::pair::PairInput;
use crate::scene::split_set;
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;

/// Component of a unit normal from which on a support in that direction holds the facet in its plane, and cosine of its angle with an inclined one.
const HELD: f64 = 0.5;
const ALONG: f64 = 0.9;

/// What of the master's body lies beside the rims of the master and can be touched: not what supports hold in its plane, as in planes of symmetry, nor surfaces of other contacts and of ties.
pub(super) fn beside(pair: &PairInput<'_>, model: &Model) -> Vec<FacetNodes> {
    let (scene, body, slave) = (pair.scene, &pair.placed[pair.bodies[1]], pair.facets[0]);
    let Ok(boundary) = body.facets_of(BOUNDARY) else { return Vec::new() };
    let of_body = |set: &str| {
        let named = split_set(set).filter(|(name, _)| *name == body.name);
        named.and_then(|(_, set)| body.facets_of(set).ok()).unwrap_or_default()
    };
    let key = |facet: &FacetNodes| facet.iter().copied().collect::<BTreeSet<u32>>();
    let others = scene.contacts.iter().filter(|other| !std::ptr::eq(*other, pair.item));
    let others = others
        .flat_map(|other| other.surfaces())
        .chain(scene.ties.iter().flat_map(|tie| [&tie.slave[..], &tie.master[..]]));
    let others: BTreeSet<BTreeSet<u32>> = others.flat_map(of_body).map(|facet| key(&facet)).collect();
    let slave_nodes: BTreeSet<u32> =
        slave.iter().flatten().chain(pair.line.iter().map(|(node, _)| node)).copied().collect();
    let support = pair.first_held_nodes(model);
    let inclined: Vec<([f64; 3], BTreeSet<u32>)> = scene
        .prescriptions
        .iter()
        .filter_map(|item| {
            let (_, set) = split_set(item.set.as_deref()?).filter(|(name, _)| *name == body.name)?;
            Some((item.normal?, body.nodes_of(set).ok()?.into_iter().collect()))
        })
        .collect();
    let is_held = |facet: &FacetNodes, normal: &[f64; 3]| {
        let of = |node: u32| support.prescribed(node);
        let across = |node: u32| (0..3).all(|c| of(node)[c] || normal[c].abs() < HELD);
        let is_along = |direction: &[f64; 3]| {
            let [dot, length] =
                [[direction, normal], [direction, direction]].map(|[a, b]| (0..3).map(|c| a[c] * b[c]).sum::<f64>());
            dot.abs() > ALONG * length.sqrt()
        };
        let by_components = facet.iter().all(|&node| across(node)) && !facet.iter().all(|&node| of(node) == [true; 3]);
        by_components
            || inclined
                .iter()
                .any(|(direction, nodes)| is_along(direction) && facet.iter().all(|node| nodes.contains(node)))
    };
    let longest =
        slave.iter().flat_map(|facet| (0..facet.len()).map(move |k| [facet[k], facet[(k + 1) % facet.len()]]));
    let x = |node: u32| -> [f64; 3] { std::array::from_fn(|i| model.reference[3 * node as usize + i]) };
    let longest = longest.map(|[a, b]| x(a).iter().zip(x(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt());
    let reach = longest.chain(pair.line.iter().map(|(_, length)| *length)).fold(0.0, f64::max);
    stoss_contact::beside_rims(pair.facets[1], &boundary, &model.reference, reach, |facet, normal| {
        !facet.iter().any(|node| slave_nodes.contains(node)) && !others.contains(&key(facet)) && !is_held(facet, normal)
    })
}
