//! What is watched: solids, then surfaces of rigid bodies in the order in which they are drawn. Nodes are counted as points, as frames do.

use crate::output::Drawing;
use crate::points::Points;
use crate::scene::{Scene, split_set};
use std::collections::{BTreeMap, BTreeSet};
use stoss_mesh::Elements;
use stoss_reference_element::{FacetKind, FacetNodes};
use stoss_solver::Model;
use stoss_watch::{TiedPair, WatchBody, WatchFacet, WatchModel, WatchShape};

/// The pairs of bodies between which the scene names a contact, in the order of the contacts; then all pairs if there is general contact.
pub(crate) fn contact_bodies(scene: &Scene, drawing: &Drawing) -> Vec<Option<[usize; 2]>> {
    let surface = |body: &str| drawing.surfaces.iter().position(|surface| surface.name == body);
    let rigid = |body: &str| surface(body).map(|k| scene.bodies.len() + k);
    let body = |set: &str| split_set(set).and_then(|(body, _)| scene.body_index(body).or_else(|| rigid(body)));
    let named = scene.contacts.iter().map(|contact| {
        let [a, b] = contact.surfaces();
        Some([body(a)?, body(b)?])
    });
    let count =
        if crate::build::general_contact(scene).is_some() { scene.bodies.len() + drawing.surfaces.len() } else { 0 };
    named.chain((0..count).flat_map(|a| (a..count).map(move |b| Some([a, b])))).collect()
}

/// Bodies, elements, surfaces and ties; contacts are none of its business. The drawing counts points.
pub(super) fn model(model: &Model, points: &Points, drawing: &Drawing) -> WatchModel {
    let solids = model.bodies.iter().map(|body| {
        let first = points.place(body.nodes.start);
        let mut elements = Elements::new();
        elements.extend(body.solid.elements(), |node| points.place(node));
        WatchBody {
            name: body.solid.name().to_owned(),
            nodes: first..first + body.nodes.len() as u32,
            shape: WatchShape::Solid(elements),
        }
    });
    let surfaces = drawing.surfaces.iter().map(|surface| WatchBody {
        name: surface.name.clone(),
        nodes: surface.nodes.clone(),
        shape: WatchShape::Surface {
            facets: surface.facets.iter().map(watched).collect(),
            is_closed: surface.is_closed,
        },
    });
    let bodies: Vec<WatchBody> = solids.chain(surfaces).collect();
    let mut ties = ties(model, points, &bodies);
    for joined in &drawing.joined {
        let [a, b] = &joined.parts;
        let place = |name: &String| bodies.iter().position(|body| body.name == *name);
        if let (Some(a), Some(b)) = (place(a), place(b)) {
            let bodies = [a.min(b), a.max(b)];
            match ties.iter_mut().find(|tie| tie.bodies == bodies) {
                Some(tie) => tie.nodes.extend(&joined.nodes),
                None => ties.push(TiedPair { nodes: joined.nodes.clone(), bodies }),
            }
        }
    }
    WatchModel { bodies, reference: points.of_all(&model.reference, 3).into_owned(), ties }
}

/// A facet as the watch takes it.
pub(super) fn watched(facet: &FacetNodes) -> WatchFacet {
    let corners = *facet.padded();
    match facet.kind() {
        FacetKind::Tri3 => WatchFacet::Triangle([corners[0], corners[1], corners[2]]),
        FacetKind::Quad4 => WatchFacet::Quadrilateral(corners),
    }
}

/// The nodes that a mesh tie holds together, by pairs of bodies. Rigidity and joints are no ties.
fn ties(model: &Model, points: &Points, bodies: &[WatchBody]) -> Vec<TiedPair> {
    let body_of = |point: u32| bodies.iter().position(|body| body.nodes.contains(&point));
    let mut ties: Vec<TiedPair> = Vec::new();
    for pair in
        model.contacts.iter().filter(|pair| pair.term.bilateral().is_some_and(|of| of.holds_surfaces_together()))
    {
        // A constraint may hand out its nodes one by one.
        let mut nodes_of_slot: BTreeMap<u32, BTreeSet<(usize, u32)>> = BTreeMap::new();
        pair.term.stencils(&vec![true; pair.term.slot_count()], &mut |nodes, slots| {
            for &slot in slots {
                let points = nodes.iter().map(|&node| points.place(node));
                let known = points.filter_map(|point| Some((body_of(point)?, point)));
                nodes_of_slot.entry(slot).or_default().extend(known);
            }
        });
        for nodes in nodes_of_slot.values() {
            let bodies: BTreeSet<usize> = nodes.iter().map(|&(body, _)| body).collect();
            for &a in &bodies {
                for &b in bodies.range(a + 1..) {
                    let known = ties.iter().position(|tie| tie.bodies == [a, b]);
                    let tie = known.unwrap_or_else(|| {
                        ties.push(TiedPair { nodes: Vec::new(), bodies: [a, b] });
                        ties.len() - 1
                    });
                    let of_both = nodes.iter().filter(|(body, _)| [a, b].contains(body)).map(|&(_, point)| point);
                    ties[tie].nodes.extend(of_both);
                }
            }
        }
    }
    for tie in &mut ties {
        tie.nodes.sort_unstable();
        tie.nodes.dedup();
    }
    ties
}
