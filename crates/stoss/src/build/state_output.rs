//! Which bodies have what scenes ask of the states of materials, in words.

use super::Problems;
use crate::scene::Scene;
use crate::solver::Model;

/// A body with its law, as `` `block` (neo-hooke) ``.
pub(super) fn of_law(scene: &Scene, body: usize) -> String {
    let body = &scene.bodies[body];
    let given = &body.material.inelasticity;
    let keys = [
        ("plasticity", given.plasticity.is_some()),
        ("prony", !given.prony.is_empty()),
        ("mullins", given.mullins.is_some()),
        ("fibres", given.fibres.is_some()),
    ];
    let keys: Vec<&str> = keys.iter().filter(|(_, has)| *has).map(|(key, _)| *key).collect();
    match keys[..] {
        [] => format!("`{}` ({})", body.name, body.material.law),
        _ => format!("`{}` ({} with {})", body.name, body.material.law, keys.join(" and ")),
    }
}

/// What a material needs for a quantity of this name.
pub(super) fn remedy(name: &str) -> &'static str {
    match name {
        "back_stress" => "remove it, or give the material `plasticity` with a `kinematic_modulus`",
        "viscous_strain" => "remove it, or give the material `prony`",
        _ => "remove it, or give the material `plasticity`",
    }
}

/// Refuses fields of states that no body has: frames would have nothing of them.
pub(super) fn check_fields(scene: &Scene, model: &Model, problems: &mut Problems<'_>) {
    for field in scene.output.fields.iter().flatten().filter(|field| field.is_of_state()) {
        let name = field.name();
        if model.bodies.iter().any(|body| body.solid.state_output(name).is_some()) {
            continue;
        }
        let bodies: Vec<String> = (0..model.bodies.len()).map(|body| of_law(scene, body)).collect();
        let message = match bodies[..] {
            [] => "there is no deformable body".to_owned(),
            [ref one] => format!("{one} has none"),
            _ => format!("none of the bodies has it: {}", bodies.join(", ")),
        };
        problems.add("output.fields".to_owned(), name, message, remedy(name));
    }
}

/// Refuses a limit of the plastic increment where nothing yields.
pub(super) fn check_limit(scene: &Scene, model: &Model, problems: &mut Problems<'_>) {
    let Some(limit) = scene.time.max_plastic_increment else { return };
    if model.bodies.iter().any(|body| body.solid.mechanisms().plastic) {
        return;
    }
    let bodies: Vec<String> = (0..model.bodies.len()).map(|body| of_law(scene, body)).collect();
    let message = match bodies[..] {
        [] => "there is no deformable body that could yield".to_owned(),
        _ => format!("no body yields: {}", bodies.join(", ")),
    };
    let remedy = "remove it, or give a material `plasticity`";
    problems.add("time.max_plastic_increment".to_owned(), limit, message, remedy);
}
