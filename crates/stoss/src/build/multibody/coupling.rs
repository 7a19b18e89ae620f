//! Couplings of sets of deformable bodies: to rigid bodies of the scene, and to reference bodies, which are what joints, springs and moments hold of a set.

use super::Parts;
use crate::build::Problems;
use crate::build::condition::{resolve, solid_facets};
use crate::build::placed::Placed;
use crate::scene::{Coupling, PartKind, Scene, split_set};
use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_multibody::{ConstraintSet, CouplingError, RigidBody, distributing_coupling, kinematic_coupling};

const REMEDY: &str = "choose a set with three nodes or more that are not on a line";

/// Principal axes do not matter for a body without mass.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Adds a body without mass for every set that a joint, spring or moment names, in the weighted centre of its nodes; returns the equations that couple them.
pub(super) fn couplings(
    scene: &Scene,
    placed: &[Placed],
    model: &mut Model,
    parts: &mut Parts,
    problems: &mut Problems<'_>,
) -> Vec<ConstraintSet> {
    let of_joints = scene.joints.iter().enumerate().flat_map(|(j, item)| {
        let coupling = item.coupling.unwrap_or(Coupling::Distributing);
        let turns = item.kind.needs_orientation();
        (0..2).map(move |k| (format!("joint[{j}].between[{k}]"), &item.between[k], coupling, turns))
    });
    let of_springs = scene.springs.iter().enumerate().flat_map(|(s, item)| {
        (0..2).map(move |k| (format!("spring[{s}].between[{k}]"), &item.between[k], Coupling::Distributing, false))
    });
    let of_loads = scene.loads.iter().enumerate().filter(|(_, item)| item.moment.is_some());
    let of_loads =
        of_loads.filter_map(|(l, item)| Some((format!("load[{l}].set"), item.set.as_ref()?, item.coupling(), true)));
    let mut sets = Vec::new();
    for (key, name, coupling, turns) in of_joints.chain(of_springs).chain(of_loads) {
        let Some((part, _)) = split_set(name) else { continue };
        if !matches!(scene.part(part), Some((PartKind::Body, _)))
            || parts.couplings.contains_key(&(name.clone(), coupling))
        {
            continue;
        }
        let Some((b, nodes)) = resolve(placed, &key, name, problems, Placed::nodes_of) else { continue };
        if let ([node], false) = (&nodes[..], turns) {
            parts.nodes.insert(name.clone(), *node);
            continue;
        }
        let weights = weights(&placed[b], name, &nodes, &model.reference);
        let position = |node: u32| -> [f64; 3] { std::array::from_fn(|i| model.reference[3 * node as usize + i]) };
        let total: f64 = weights.iter().map(|(_, w)| w).sum();
        let centre: [f64; 3] =
            std::array::from_fn(|i| weights.iter().map(|&(n, w)| w * position(n)[i]).sum::<f64>() / total);
        let square = |n: u32| (0..3).map(|i| (position(n)[i] - centre[i]).powi(2)).sum::<f64>();
        let spread = (weights.iter().map(|&(n, w)| w * square(n)).sum::<f64>() / total).sqrt();
        let label = format!("{name} ({coupling} coupling)");
        let first = model.node_count() as u32;
        let made = RigidBody::massless(&label, first, centre, AXES, spread)
            .map_err(|error| error.to_string())
            .and_then(|body| {
                let set = couple(coupling, &label, &body, &weights, &model.reference);
                set.map(|set| (body, set)).map_err(|error| error.to_string())
            });
        match made {
            Ok((body, set)) => {
                model.reference.extend(body.reference().iter().flatten());
                if scene.is_dynamic() {
                    let item = &scene.bodies[b];
                    let [x, y, z] = item.velocity_gradient;
                    // The turning part of the velocity gradient.
                    let turn = [z[1] - y[2], x[2] - z[0], y[0] - x[1]].map(|w| 0.5 * w);
                    let spin = std::array::from_fn(|i| item.angular_velocity[i] + turn[i]);
                    model.velocity.extend(body.velocity(item.initial_velocity(centre), spin).iter().flatten());
                }
                model.parts.push(Box::new(body.clone()));
                parts.couplings.insert((name.clone(), coupling), body);
                sets.push(set);
            }
            Err(message) => problems.add(key, name, message, REMEDY),
        }
    }
    sets
}

/// Adds the couplings to rigid bodies of the scene.
pub(super) fn named(
    scene: &Scene,
    placed: &[Placed],
    parts: &Parts,
    model: &Model,
    problems: &mut Problems<'_>,
) -> Vec<ConstraintSet> {
    let mut sets = Vec::new();
    for (c, item) in scene.couplings.iter().enumerate() {
        let key = format!("coupling[{c}].set");
        let Some(body) = parts.rigid(&item.rigid) else { continue };
        let Some((b, nodes)) = resolve(placed, &key, &item.set, problems, Placed::nodes_of) else { continue };
        let weights = weights(&placed[b], &item.set, &nodes, &model.reference);
        match couple(item.kind, &item.name, body, &weights, &model.reference) {
            Ok(set) => sets.push(set),
            Err(error) => problems.add(key, &item.set, error.to_string(), REMEDY),
        }
    }
    sets
}

/// The equations of nodes with weights that are coupled to a body.
fn couple(
    kind: Coupling,
    name: &str,
    body: &RigidBody,
    weights: &[(u32, f64)],
    reference: &[f64],
) -> Result<ConstraintSet, CouplingError> {
    match kind {
        Coupling::Kinematic => {
            let nodes: Vec<u32> = weights.iter().map(|(node, _)| *node).collect();
            kinematic_coupling(name, body, &nodes, reference)
        }
        Coupling::Distributing => distributing_coupling(name, body, weights, reference),
    }
}

/// Areas that belong to the nodes of a set of facets, `int N dA`, which is not positive at corners of some quadratic faces; of a set of facets of another part equal shares of the facets, of a set without facets all alike.
pub(super) fn weights(placed: &Placed, name: &str, nodes: &[u32], reference: &[f64]) -> Vec<(u32, f64)> {
    let set = split_set(name).map_or(name, |(_, set)| set);
    if let Some(weights) = consistent(placed, set, nodes, reference) {
        return weights;
    }
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    for facet in placed.facets_of(set).unwrap_or_default() {
        let area = stoss_contact::facet_area_vector(&facet, reference).iter().map(|a| a * a).sum::<f64>().sqrt();
        for &node in facet.iter() {
            *areas.entry(node).or_default() += area / facet.len() as f64;
        }
    }
    if nodes.iter().all(|node| areas.get(node).is_some_and(|&area| area > 0.0)) {
        nodes.iter().map(|&node| (node, areas[&node])).collect()
    } else {
        nodes.iter().map(|&node| (node, 1.0)).collect()
    }
}

/// `int N dA` of the nodes over the facets of a solid's set; nothing if a node has no facet.
fn consistent(placed: &Placed, set: &str, nodes: &[u32], reference: &[f64]) -> Option<Vec<(u32, f64)>> {
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    for facet in solid_facets(placed, set).ok()? {
        let shares = stoss_fe_solid::area_matrix(&facet, reference).ok()?;
        for (row, &node) in shares.chunks_exact(facet.len()).zip(facet.iter()) {
            *areas.entry(node).or_default() += row.iter().sum::<f64>();
        }
    }
    nodes.iter().map(|node| Some((*node, *areas.get(node)?))).collect()
}
