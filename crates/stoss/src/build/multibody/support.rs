//! Elastic supports of a scene.

use super::super::Problems;
use super::super::condition::{resolve, solid_facets};
use super::super::placed::Placed;
use crate::scene::{Scene, SupportPer};
use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_multibody::{ElasticSupport, SupportedNode};
use stoss_reference_element::FaceNodes;

/// A node with a smaller part of the area than this of the largest part has none.
const SMALLEST_PART: f64 = 1e-9;

/// Adds the supports as parts.
pub(super) fn supports(scene: &Scene, placed: &[Placed], model: &mut Model, problems: &mut Problems<'_>) {
    for (s, item) in scene.supports.iter().enumerate() {
        let key = format!("support[{s}].set");
        let weights: Option<(usize, BTreeMap<u32, f64>)> = match item.per {
            SupportPer::Node => resolve(placed, &key, &item.set, problems, Placed::nodes_of)
                .map(|(body, nodes)| (body, nodes.into_iter().map(|node| (node, 1.0)).collect())),
            SupportPer::Area => resolve(placed, &key, &item.set, problems, solid_facets)
                .and_then(|(body, facets)| Some((body, areas(&facets, model, &key, problems)?))),
        };
        let Some((body, weights)) = weights else { continue };
        // cannot fail: the reader refused other frames.
        let Some(axes) = item.axes() else { continue };
        let node = |(vector, weight): (u32, f64)| SupportedNode {
            vector,
            at: std::array::from_fn(|i| model.reference[3 * vector as usize + i]),
            axes,
            stiffness: item.stiffness.map(|k| k * weight),
            damping: item.damping.map(|d| d * weight),
        };
        let nodes = weights.into_iter().map(node).collect();
        // Bodies of the scene come first, and a set of another part was refused.
        let length = model.bodies.get(body).map_or(1.0, |body| body.solid.characteristic_length());
        match ElasticSupport::new(&item.part_name(s), nodes, length) {
            Ok(support) => model.parts.push(Box::new(support)),
            Err(error) => problems.add(key, &item.set, error.to_string(), "mend the support's data"),
        }
    }
}

/// The part of each node in the reference area of facets: the nodal forces of a unit traction.
fn areas(facets: &[FaceNodes], model: &Model, key: &str, problems: &mut Problems<'_>) -> Option<BTreeMap<u32, f64>> {
    let mut force = vec![0.0; model.reference.len()];
    if let Err(error) = stoss_fe_solid::dead_traction(facets, &model.reference, [1.0, 0.0, 0.0], &mut force) {
        problems.add(key.to_owned(), "", error.to_string(), "mend the mesh or choose another set");
        return None;
    }
    let areas: BTreeMap<u32, f64> =
        facets.iter().flat_map(|face| face.iter()).map(|&node| (node, force[3 * node as usize])).collect();
    let largest = areas.values().copied().fold(0.0, f64::max);
    if areas.values().any(|area| *area <= SMALLEST_PART * largest) {
        let message =
            "a support per area has faces with six or eight nodes, whose corners have no positive part of the area";
        let remedy = "use `per = \"node\"`, or elements of 4, 6, 8 or 27 nodes";
        problems.add(key.to_owned(), "", message, remedy);
        return None;
    }
    Some(areas)
}
