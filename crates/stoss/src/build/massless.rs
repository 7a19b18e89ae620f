//! Surfaces that give up their mass to the nodes behind them.

use super::Problems;
use super::phase::{Phase, Phases};
use super::placed::{Placed, index};
use crate::scene::{Contact, Scene, SurfaceMass, split_set};
use crate::solver::Model;
use std::collections::{BTreeMap, BTreeSet};
use stoss_fe_solid::Massless;

/// Schemes that carry positions and velocities alone: accelerations, forces of the start or momenta of a node need its mass.
const SCHEMES: [&str; 3] = ["energy-momentum", "midpoint", "backward-euler"];

/// Linear elements behind a surface from which on the rebound is right to 4 %.
const ENOUGH: usize = 6;

/// Takes the mass of the surfaces of contacts that ask for it.
pub(super) fn surfaces(
    scene: &Scene,
    placed: &[Placed],
    phases: &Phases,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) {
    // Nodes by body, and the contacts that name them.
    let mut found: BTreeMap<usize, (BTreeSet<u32>, Vec<(usize, &str)>)> = BTreeMap::new();
    let asks = |item: &Contact| item.surface_mass == SurfaceMass::None;
    for (c, item) in scene.contacts.iter().enumerate().filter(|(_, item)| asks(item)) {
        let key = format!("contact[{c}].surface_mass");
        let Some((b, set)) = item.surfaces().into_iter().find_map(|set| deformable(placed, set)) else {
            let message = "is for deformable bodies, and neither side is one";
            problems.add(key, "none", message, "remove it");
            continue;
        };
        let label = item.label();
        let mut schemes = phases.with(&label).filter_map(Phase::integrator).map(|integrator| &integrator.scheme);
        if let Some(scheme) = schemes.find(|scheme| !SCHEMES.contains(&scheme.as_str())) {
            let message = format!("is not for the scheme `{scheme}`, which needs the mass of every node");
            problems.add(key, "none", message, format!("use one of {}", SCHEMES.join(", ")));
            continue;
        }
        // A set that is not there is reported where the contact is made.
        if let Ok(nodes) = placed[b].nodes_of(set) {
            let (of_body, contacts) = found.entry(b).or_default();
            of_body.extend(nodes);
            contacts.push((c, set));
        }
    }
    for (b, (nodes, contacts)) in found {
        let (body, name) = (&model.bodies[b], &placed[b].name);
        match Massless::new(&body.solid, body.mass_kind, nodes) {
            Ok(massless) => {
                let is_quadratic = body.solid.elements().kinds().iter().any(|kind| kind.is_quadratic());
                let across = massless.layers() * if is_quadratic { 2 } else { 1 };
                if across < ENOUGH {
                    warnings.push(format!(
                        "body `{name}`: {} {} behind the surface without mass: its rebound may be off by more than 4 % (its energy is not). Take {} or more, or leave `surface_mass` out",
                        massless.layers(),
                        if massless.layers() == 1 { "element" } else { "elements" },
                        if is_quadratic { ENOUGH / 2 } else { ENOUGH },
                    ));
                }
                model.bodies[b].massless = Some(massless);
            }
            Err(error) => {
                let sets: Vec<String> = contacts.iter().map(|(_, set)| format!("`{name}.{set}`")).collect();
                let message = format!("cannot be had for {} of body `{name}`: {error}", sets.join(" and "));
                let remedy = "take two or more linear elements across the body, or quadratic ones by `cell`, or name less of its surface, or remove `surface_mass`";
                problems.add(format!("contact[{}].surface_mass", contacts[0].0), "none", message, remedy);
            }
        }
    }
}

/// The body and the set in it that a reference names, if the body is deformable.
fn deformable<'a>(placed: &[Placed], reference: &'a str) -> Option<(usize, &'a str)> {
    let (name, set) = split_set(reference)?;
    let b = index(placed, name).filter(|&b| placed[b].mesh().is_some())?;
    Some((b, set))
}
