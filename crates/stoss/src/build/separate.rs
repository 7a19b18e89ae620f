//! Bodies that overlap at the start: how deep, and `initial = "separate"`, which moves them apart.

use super::general_table::Frictions;
use super::interacting::{self, Classes};
use super::phase::Phase;
use super::tie::Ties;
use super::{Placed, Problems};
use crate::scene::{Initial, Scene, split_set};
use crate::solver::Model;
use stoss_contact_barrier::{self as barrier, Interactions, SeparationFault, Skin, THICKNESS, layer_edge};
use stoss_tensor::Vector3;

/// A length as in other messages.
pub(super) fn format_length(length: f64) -> String {
    format!("{length:.3e}")
}

/// Moves bodies that overlap apart, if the scene asks for it: meshes and reference positions, so no stress arises. `lines` get what was done. False if that failed,
/// with a problem: bodies that may not be moved, or not so far.
pub(super) fn separate(
    scene: &Scene,
    placed: &mut [Placed],
    ties: &Ties,
    first: &Phase,
    model: &mut Model,
    problems: &mut Problems<'_>,
    lines: &mut Vec<String>,
) -> bool {
    let wanted = scene.general_contact.as_ref().filter(|table| table.enabled && table.initial == Initial::Separate);
    let Some(table) = wanted else { return true };
    // What is wrong with the table is reported where the contact is made.
    let mut ignored = Problems { scene, list: Vec::new() };
    let Classes { facets, classes, apart } = interacting::facets(scene, placed, table, ties, &mut ignored);
    let mut rules = interacting::interactions(
        scene,
        placed,
        table,
        &Frictions::default(),
        model,
        &classes,
        &apart,
        &mut Vec::new(),
    );
    interacting::without_joined_overlaps(scene, placed, table, &facets, &model.reference, &mut rules);
    if facets.is_empty() || !ignored.list.is_empty() {
        return true;
    }
    let skin = Skin::new(facets, &model.reference, &|_| None);
    let is_rigid = |part: u32| placed[part as usize].mesh().is_none();
    let edge = layer_edge(&skin, &rules, &is_rigid, &model.reference);
    let thickness = table.thickness.unwrap_or(THICKNESS * edge);
    let moves = match motions(scene, placed, first, model, &skin, &rules, thickness) {
        Ok(moves) => moves,
        Err((message, remedy)) => {
            problems.add("general_contact.initial".into(), table.initial, message, remedy);
            return false;
        }
    };
    for (p, by) in moves.iter().enumerate().filter(|(_, by)| **by != Vector3::zeros()) {
        let part = &mut placed[p];
        let super::placed::Discretisation::Solid { mesh, .. } = &mut part.shape else { continue };
        if let Err(error) = mesh.transform(None, (*by).into()) {
            problems.add("general_contact.initial".into(), table.initial, error.to_string(), "correct the mesh");
            return false;
        }
        let (first, count) = (part.first_node as usize, mesh.nodes.len());
        model.reference[3 * first..3 * (first + count)].copy_from_slice(mesh.nodes.as_flattened());
        model.embedding.follow(&mut model.reference);
        let message = "so that it no longer overlaps";
        let size = format_length(by.norm());
        lines.push(format!("{}: moved by {size}, {}, {message}", part.name, interacting::point((*by).into(), edge)));
    }
    true
}

/// Motions of all parts, the least ones in the sense of mass times squared motion, volumes in place of masses.
fn motions(
    scene: &Scene,
    placed: &[Placed],
    first: &Phase,
    model: &Model,
    skin: &Skin,
    rules: &Interactions,
    thickness: f64,
) -> Result<Vec<Vector3>, (String, String)> {
    let name = |body: u32| &placed[body as usize].name;
    let holds: Vec<Option<&str>> = (0..placed.len()).map(|p| hold(scene, placed, first, model, p)).collect();
    // How easily a body moves: one over its volume.
    let volume = |p: usize| {
        model.bodies.iter().find(|body| body.nodes.start == placed[p].first_node).map(|body| body.solid.volume())
    };
    let ease: Vec<f64> = (0..placed.len())
        .map(|p| volume(p).filter(|_| holds[p].is_none()).map_or(0.0, |volume| 1.0 / volume))
        .collect();
    barrier::separate(skin, rules, &model.reference, &ease, thickness).map_err(|fault| match fault {
        SeparationFault::Inside { bodies: [a, b] } => {
            (format!("`{}` and `{}`: one is wholly inside the other", name(a), name(b)), "move one of them".into())
        }
        SeparationFault::Held { bodies: [a, b] } => {
            let [first, second] = [a, b].map(|body| holds[body as usize].unwrap_or("has no volume"));
            let message = format!(
                "`{}` and `{}` overlap, and neither may be moved: the first {first}, the second {second}",
                name(a),
                name(b)
            );
            (message, "correct the scene there".into())
        }
        SeparationFault::TooDeep { bodies: [a, b], most } => {
            let may = [a, b].into_iter().zip(most).filter(|(_, most)| *most > 0.0);
            let may = may.map(|(body, most)| format!("of `{}` by {}", name(body), format_length(most)));
            let message = format!(
                "`{}` and `{}` overlap too deeply: no motion {}, a quarter of the smallest extent, separates them",
                name(a),
                name(b),
                may.collect::<Vec<_>>().join(" and ")
            );
            (message, "move one of them".to_owned())
        }
        SeparationFault::NoRoom { bodies: [a, b] } => (
            format!("there is no room for `{}` and `{}` between bodies that may not be moved", name(a), name(b)),
            "move bodies apart in the scene".into(),
        ),
        SeparationFault::TooFar { body, by, most } => {
            let message = format!(
                "`{}` would have to be moved by {}, more than {}, a quarter of its smallest extent",
                name(body),
                format_length(by),
                format_length(most)
            );
            (message, "move it, or the body that it overlaps".into())
        }
        SeparationFault::StillOverlap { rounds } => {
            (format!("after {rounds} rounds some bodies still overlap"), "move bodies apart in the scene".into())
        }
        // What is new there is told in its words.
        other => (other.to_string(), "move bodies apart in the scene".into()),
    })
}

/// Whether an equation has a term of the part.
fn in_equations(scene: &Scene, part: &str) -> bool {
    let mut terms = scene.equations.iter().flat_map(|equation| &equation.terms);
    let of = |set: &str| split_set(set).is_some_and(|(own, _)| own == part);
    terms.any(|term| term.set.as_deref().is_some_and(of) || term.body.as_deref() == Some(part))
}

/// Why a part may not be moved, by what acts in the first stage, as the end of a sentence; nothing if it may.
fn hold(scene: &Scene, placed: &[Placed], first: &Phase, model: &Model, p: usize) -> Option<&'static str> {
    let Some(mesh) = placed[p].mesh() else { return Some("is rigid") };
    let nodes = placed[p].first_node..placed[p].first_node + mesh.nodes.len() as u32;
    let is_own = |set: &str| split_set(set).is_some_and(|(part, _)| part == placed[p].name);
    let joints = scene.joints.iter().map(|joint| (&joint.name, &joint.between));
    let joined = joints.chain(scene.springs.iter().map(|spring| (&spring.name, &spring.between)));
    let joined = joined.filter(|(name, _)| first.acts(Some(name))).map(|(_, between)| between);
    let inclined = scene.prescriptions.iter().filter(|item| item.is_inclined() && first.acts(item.name.as_deref()));
    let prescribed = first.held_nodes(model);
    if nodes.into_iter().any(|node| prescribed.prescribed(node).contains(&true))
        || inclined.filter_map(|item| item.set.as_deref()).any(is_own)
    {
        Some("has prescribed motion")
    } else if scene.supports.iter().any(|support| is_own(&support.set)) {
        Some("has a support")
    } else if scene.ties.iter().any(|tie| is_own(&tie.slave) || is_own(&tie.master)) {
        Some("is tied")
    } else if joined.flatten().any(|side| is_own(side)) {
        Some("has a joint or a spring")
    } else if scene.couplings.iter().any(|coupling| is_own(&coupling.set)) || in_equations(scene, &placed[p].name) {
        Some("has a coupling or an equation")
    } else if scene
        .contacts
        .iter()
        .any(|contact| first.acts(Some(&contact.label())) && contact.surfaces().iter().any(|set| is_own(set)))
    {
        Some("has a named contact")
    } else {
        None
    }
}
