//! Where `closing = "restore"` cannot be had: the impulse that gives back the energy of closing gaps knows no other constraints of its bodies.

use super::Problems;
use crate::scene::{Closing, Scene, split_set};
use crate::solver::Model;
use std::ops::Range;

/// Refuses `closing = "restore"` beside constraints that always act on a body of the contact: rigidity, joints, ties, couplings, supports along normals. The velocities
/// that it makes satisfy none of them (theory/mortar#restore).
pub(super) fn check(scene: &Scene, model: &Model, problems: &mut Problems<'_>) {
    for (c, item) in scene.contacts.iter().enumerate().filter(|(_, item)| item.closing == Some(Closing::Restore)) {
        let owners = item.surfaces().map(|set| split_set(set).map_or(set, |(part, _)| part));
        let vectors: Vec<(&str, Range<u32>)> =
            owners.iter().filter_map(|&name| Some((name, vectors(model, name)?))).collect();
        let held = held(model);
        // What is prescribed whole gets no velocity from the impulse.
        let owner = |node: u32| {
            let moves = |vector: u32| (0..3).any(|i| !held[3 * vector as usize + i]);
            let of = |vector: u32| {
                moves(vector).then(|| vectors.iter().find(|(_, own)| own.contains(&vector)).map(|(name, _)| *name))?
            };
            match model.embedding.carriers(node) {
                Some(carriers) => carriers.iter().find_map(|&(vector, _)| of(vector)),
                None => of(node),
            }
        };
        let mut found = None;
        for pair in model.contacts.iter().filter(|pair| pair.method.is_bilateral()) {
            let active = vec![true; pair.method.slot_count()];
            pair.method.stencils(&active, &mut |nodes, _| {
                if found.is_none() {
                    found = nodes.iter().find_map(|&node| owner(node)).map(|name| (name, pair.name.clone()));
                }
            });
        }
        let Some((body, constraint)) = found else { continue };
        let modified = "or write method = \"nts\" with constraint = \"modified\", under which contact conserves energy";
        let remedy = match item.friction {
            None => {
                format!("remove it, the energy that closing costs is then in the column `closing_loss`; {modified}")
            }
            Some(_) => "remove it, the energy that closing costs is then in the column `closing_loss`".to_owned(),
        };
        problems.add(
            format!("contact[{c}].closing"),
            "restore",
            format!(
                "gives back energy by an impulse on the surfaces alone, and `{body}` has a constraint that this impulse violates: {constraint}"
            ),
            remedy,
        );
    }
}

/// Vectors of a deformable body or of another part.
fn vectors(model: &Model, name: &str) -> Option<Range<u32>> {
    let body = model.bodies.iter().find(|body| body.solid.name() == name).map(|body| body.nodes.clone());
    body.or_else(|| model.parts.iter().find(|part| part.name() == name).map(|part| part.own_vectors()))
}

/// Components that are prescribed, whether or not a stage switches that off.
fn held(model: &Model) -> Vec<bool> {
    let mut held = vec![false; model.reference.len()];
    for prescription in &model.prescriptions {
        for &node in &prescription.nodes {
            prescription.components.iter().for_each(|&i| held[3 * node as usize + usize::from(i)] = true);
        }
    }
    held
}
