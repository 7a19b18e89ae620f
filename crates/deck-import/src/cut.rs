//! Bolts that are cut at the surface of a `*PRE-TENSION SECTION`, in the mesh beside the scene.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::{Elements, Mesh};
use stoss_mesh_io::Solids;
use stoss_mesh_io::deck::Deck;

use crate::left_out::List;
use crate::severity::Severity;

/// A cut: for each node of the surface the one on the side of the surface's elements and its copy on the other side.
pub(crate) struct Cut {
    /// Index in [`Deck::pretensions`].
    pub pretension: usize,
    pub pairs: Vec<(u32, u32)>,
    /// Unit normal from the elements of the surface to the other side.
    pub normal: [f64; 3],
}

/// Cuts the mesh at all surfaces of pretension. Copies of nodes have numbers that no line of a deck names.
pub(crate) fn cuts(deck: &Deck, solids: &mut Solids, list: &mut List) -> Vec<Cut> {
    let mut all = Vec::new();
    for (p, item) in deck.pretensions.iter().enumerate() {
        let Some(name) = &item.surface else { continue };
        let own = solids.mesh.facet_sets.iter().find(|(other, _)| other.eq_ignore_ascii_case(name));
        let Some(facets) = own.map(|(_, facets)| facets.clone()).filter(|facets| !facets.is_empty()) else { continue };
        let first = solids.mesh.nodes.len();
        let normal = mean_normal(&solids.mesh, &facets);
        let Some(normal) = normal else { continue };
        let Some(pairs) = cut(&mut solids.mesh, &facets, normal) else { continue };
        let copies = solids.mesh.nodes.len() - first;
        solids.node_numbers.extend((0..copies as u64).map(|k| u64::MAX - (first as u64 + k)));
        let consequence =
            format!("the mesh beside the scene is cut at {name}: {copies} nodes are doubled, and joined by equations");
        list.add(Severity::Note, item.place, "*PRE-TENSION SECTION", consequence, "");
        all.push(Cut { pretension: p, pairs, normal });
    }
    all
}

/// Unit vector along the sum of the areas of facets, outward of their elements.
fn mean_normal(mesh: &Mesh, facets: &[stoss_mesh::Facet]) -> Option<[f64; 3]> {
    let mut sum = [0.0; 3];
    for facet in facets {
        let corners: Vec<[f64; 3]> = facet.nodes.corners().iter().map(|&node| mesh.nodes[node as usize]).collect();
        for k in 1..corners.len() - 1 {
            let [a, b] = [k, k + 1].map(|k| -> [f64; 3] { std::array::from_fn(|i| corners[k][i] - corners[0][i]) });
            (0..3).for_each(|i| sum[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
        }
    }
    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0).then(|| sum.map(|x| x / length))
}

/// Gives the elements on the side of the normal nodes of their own; the nodes of the surface with their copies. Nothing if there is no element on that side.
fn cut(mesh: &mut Mesh, facets: &[stoss_mesh::Facet], normal: [f64; 3]) -> Option<Vec<(u32, u32)>> {
    let surface: BTreeSet<u32> = facets.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
    let is_beyond = |nodes: &[u32]| {
        let touching: Vec<u32> = nodes.iter().copied().filter(|node| surface.contains(node)).collect();
        let mean = |of: &[u32], i: usize| of.iter().map(|&n| mesh.nodes[n as usize][i]).sum::<f64>() / of.len() as f64;
        !touching.is_empty() && (0..3).map(|i| normal[i] * (mean(nodes, i) - mean(&touching, i))).sum::<f64>() > 0.0
    };
    let beyond: Vec<bool> = mesh.elements.iter().map(is_beyond).collect();
    if !beyond.contains(&true) {
        return None;
    }
    let first = mesh.nodes.len() as u32;
    let copies: BTreeMap<u32, u32> = surface.into_iter().zip(first..).collect();
    let places: Vec<[f64; 3]> = copies.keys().map(|&node| mesh.nodes[node as usize]).collect();
    mesh.nodes.extend(places);
    let mut elements = Elements::default();
    for ((kind, nodes), beyond) in mesh.elements.cells().zip(beyond) {
        let own = |node: &u32| if beyond { *copies.get(node).unwrap_or(node) } else { *node };
        elements.push(kind, &nodes.iter().map(own).collect::<Vec<u32>>());
    }
    mesh.elements = elements;
    renew_facets(mesh);
    Some(copies.into_iter().collect())
}

/// Facets of sets with the present nodes of their elements.
fn renew_facets(mesh: &mut Mesh) {
    let mut sets = std::mem::take(&mut mesh.facet_sets);
    for facet in sets.values_mut().flatten() {
        *facet = mesh.facet(facet.element, usize::from(facet.local));
    }
    mesh.facet_sets = sets;
}
