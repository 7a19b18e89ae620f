//! Which bodies have what scenes ask of the states of materials, in words.

use super::Problems;
use crate::scene::{Material, Scene};
use crate::solver::Model;
use stoss_continuum::{HyperelasticLaw, SmallStrainModuli};

/// A law with what it does beside being elastic, and its moduli at small strains: of one that relaxes those of fast strains and those of the relaxed material.
pub(super) fn described(material: &Material, law: &dyn HyperelasticLaw) -> String {
    let fast = law.small_strain_moduli();
    let say =
        |moduli: SmallStrainModuli| format!("E = {:.6e}, nu = {:.4}", moduli.young_modulus(), moduli.poisson_ratio());
    let given = &material.inelasticity;
    let has = law.history().map(|history| history.mechanisms()).unwrap_or_default();
    let does = [
        (has.plastic, "yields"),
        (has.viscous, "relaxes"),
        (has.softening, "softens"),
        (given.fibres.is_some(), "has fibres"),
    ];
    let does: Vec<&str> = does.iter().filter(|(has, _)| *has).map(|(_, does)| *does).collect();
    let that = if does.is_empty() { String::new() } else { format!(" that {}", does.join(" and ")) };
    let relaxing: f64 = given.prony.iter().map(|[share, _]| share).sum();
    let fibres = if given.fibres.is_some() { ", without the fibres" } else { "" };
    match relaxing > 0.0 {
        false => format!("{}{that} ({} at small strains{fibres})", law.name(), say(fast)),
        true => {
            let relaxed = SmallStrainModuli { shear: fast.shear * (1.0 - relaxing), bulk: fast.bulk };
            format!(
                "{}{that} ({} at small fast strains, instantaneous; {} relaxed, long-term{fibres})",
                law.name(),
                say(fast),
                say(relaxed)
            )
        }
    }
}

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
