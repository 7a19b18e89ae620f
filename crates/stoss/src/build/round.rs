//! Surfaces of linear cells that the scene calls round: facets of their own for contact (theory/barrier#round).

use super::{Problems, general_contact};
use crate::scene::{RoundShape, RoundSurface, Scene, split_set};
use stoss_contact::round::{BoundaryFacet, Finer, RoundFault, RoundKind, RoundSurfaces};
use stoss_mesh::{Facet, Mesh};
use stoss_tensor::Vector3;

/// Entries `round` that no contact knows: mortar contact has flat facets.
pub(super) fn warnings(scene: &Scene) -> Vec<String> {
    if general_contact(scene).is_some() {
        return Vec::new();
    }
    let knows = |body: &str| {
        let others = scene.contacts.iter().filter(|contact| !contact.method.integrates);
        let mut surfaces = others.flat_map(|c| c.slave.iter().chain(&c.master).chain(c.between.iter().flatten()));
        surfaces.any(|surface| split_set(surface).is_some_and(|(of, _)| of == body))
    };
    let unknown = scene.bodies.iter().filter(|body| !body.round.is_empty() && !knows(&body.name));
    unknown
        .map(|body| format!("`round` of body {} has no effect: only general contact and `nts` know it; remove it, or use one of them", body.name))
        .collect()
}

/// Fits the round surfaces of a body: finer facets in place of its linear ones on them, and beside them.
pub(super) fn finer_facets(key: &str, surfaces: &[RoundSurface], mesh: &Mesh, problems: &mut Problems<'_>) -> Finer {
    let at = |node: u32| Vector3::from(mesh.nodes[node as usize]);
    let linear = |facet: &Facet| BoundaryFacet { number: (facet.element, facet.local), nodes: facet.nodes.linear() };
    let mut round = RoundSurfaces::default();
    for (k, RoundSurface { set, surface }) in surfaces.iter().enumerate() {
        let key = format!("{key}.round[{k}].set");
        let facets = match mesh.facets_of(set) {
            Ok(facets) => facets,
            Err(error) => {
                problems.add(key, set, error.to_string(), "name a set of facets of the mesh");
                continue;
            }
        };
        if facets.iter().any(|facet| facet.nodes.kind().is_quadratic()) {
            let message = "has quadratic facets, which are curved already";
            problems.add(key, set, message, "remove the entry: it is for linear elements");
            continue;
        }
        let kind = match surface {
            RoundShape::Cylinder => RoundKind::Cylinder,
            RoundShape::Sphere => RoundKind::Sphere,
        };
        let facets: Vec<BoundaryFacet> = facets.iter().map(linear).collect();
        let one = "name the facets of one round surface, or remove the entry";
        let (message, remedy) = match round.add(&facets, kind, &at) {
            Ok(()) => continue,
            Err(RoundFault::TooCoarse) => (
                format!("has sides that span more than 60 degrees of the {surface} that fits best"),
                "use at least six elements around, or remove the entry: as many points lie on many surfaces",
            ),
            Err(RoundFault::Twice { facet: (element, local) }) => (
                format!("has facet {local} of element {element}, which an entry before has, too"),
                "name each facet once",
            ),
            Err(RoundFault::Off { off, arch }) => (
                format!(
                    "its nodes are up to {off:.2e} off the {surface} that fits best, whose sides have arches of {arch:.2e}"
                ),
                one,
            ),
            Err(_) => (format!("no {surface} fits its nodes"), one),
        };
        problems.add(key, set, message, remedy);
    }
    let boundary = mesh.boundary_facets();
    round.finer(boundary.iter().filter(|facet| !facet.nodes.kind().is_quadratic()).map(linear), &at)
}
