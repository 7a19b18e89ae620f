//! Elastic supports of a scene.

use super::super::Problems;
use super::super::condition::{resolve, solid_facets};
use super::super::placed::Placed;
use crate::scene::{Scene, SupportPer};
use crate::solver::Model;
use stoss_multibody::{ElasticSupport, Foundation, Supported};
use stoss_reference_element::FaceNodes;

/// Adds the supports as parts.
pub(super) fn supports(scene: &Scene, placed: &[Placed], model: &mut Model, problems: &mut Problems<'_>) {
    for (s, item) in scene.supports.iter().enumerate() {
        let key = format!("support[{s}].set");
        let at = |node: u32| -> [f64; 3] { std::array::from_fn(|i| model.reference[3 * node as usize + i]) };
        let found = match item.per {
            SupportPer::Node => resolve(placed, &key, &item.set, problems, Placed::nodes_of)
                .map(|(body, nodes)| (body, nodes.into_iter().map(|node| Supported::node(node, at(node))).collect())),
            SupportPer::Area => resolve(placed, &key, &item.set, problems, solid_facets).and_then(|(body, facets)| {
                let made = facets.iter().map(|facet| supported(facet, &model.reference, at)).collect();
                let refused = |error: stoss_fe_solid::SolidError| {
                    problems.add(key.clone(), &item.set, error.to_string(), "correct the mesh or choose another set");
                };
                Some((body, Result::<Vec<_>, _>::map_err(made, refused).ok()?))
            }),
        };
        let Some((body, items)) = found else { continue };
        // cannot fail: the reader refused other frames.
        let Some(axes) = item.axes() else { continue };
        let foundation = Foundation { axes, stiffness: item.stiffness, damping: item.damping };
        // Bodies of the scene come first, and a set of another part was refused.
        let length = model.bodies.get(body).map_or(1.0, |body| body.solid.characteristic_length());
        match ElasticSupport::new(&item.part_name(s), items, foundation, length) {
            Ok(support) => model.parts.push(Box::new(support)),
            Err(error) => problems.add(key, &item.set, error.to_string(), "correct the support's data"),
        }
    }
}

/// The nodes of a facet with the matrix of its shape functions.
fn supported(
    facet: &FaceNodes,
    reference: &[f64],
    at: impl Fn(u32) -> [f64; 3],
) -> Result<Supported, stoss_fe_solid::SolidError> {
    let shares = stoss_fe_solid::area_matrix(facet, reference)?;
    Ok(Supported { vectors: facet.to_vec(), at: facet.iter().map(|&node| at(node)).collect(), shares })
}
