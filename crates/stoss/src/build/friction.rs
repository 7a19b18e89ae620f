//! Friction of a contact: the laws of the catalogue and a program's own, and which schemes have it.

use super::pair::PairInput;
use super::{FrictionPlan, OwnLaws, ParameterError, Problems};
use crate::scene;
use std::sync::Arc;
use stoss_contact::friction::{Friction, FrictionLaw, Stick, SurfaceVelocity, entry};
use stoss_integrators::{GradientRule, SCHEMES};

/// The law that a scene names under a key; reports what is wrong and returns `None` then.
pub(super) fn law(
    item: &scene::Friction,
    key: &str,
    laws: &OwnLaws,
    problems: &mut Problems<'_>,
) -> Option<Arc<dyn FrictionLaw>> {
    let made = match entry(&item.law) {
        Some(entry) => entry.law.with(scene::given(&item.parameters)).map_err(ParameterError::from),
        None => laws.make_friction(item),
    };
    made.map_err(|ParameterError { key: parameter, message, remedy }| match parameter.as_str() {
        "" => problems.add(key.to_owned(), &item.law, message, remedy),
        "law" => problems.add(format!("{key}.law"), &item.law, message, remedy),
        parameter => problems.add(format!("{key}.{parameter}"), "", message, remedy),
    })
    .ok()
}

/// Name of a scheme under which the contact acts, and which evaluates contact where there is neither friction nor coordinate augmentation.
pub(super) fn scheme_elsewhere(pair: &PairInput<'_>) -> Option<String> {
    let label = pair.item.label();
    let mut elsewhere = pair.phases.with(&label).filter(|phase| !Friction::is_available(phase.rule()));
    elsewhere.find_map(|phase| Some(phase.integrator()?.scheme.clone()))
}

/// The schemes that have friction and coordinate augmentation, for a remedy: those that gain no energy in impacts first.
pub(super) fn schemes_that_fit() -> String {
    let all = || SCHEMES.iter().filter_map(|entry| Some((entry.name, entry.with([]).ok()?)));
    let fit = || {
        all().filter(|(_, scheme)| {
            scheme.claims().constraints && Friction::is_available(scheme.rule(1.0).constraint.rule)
        })
    };
    let names = |gains: bool| {
        let list: Vec<String> = fit()
            .filter(|(_, scheme)| scheme.rule(1.0).gains_energy_in_impacts() == gains)
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        list.join(", ")
    };
    format!("{} (or, gaining energy in impacts, {})", names(false), names(true))
}

/// The friction of a contact, and what it is called in reports; reports what is wrong and returns `None` then. `complementarity`: Young's modulus
/// of the softer body over an edge.
pub(super) fn friction(
    pair: &PairInput<'_>,
    item: &scene::Friction,
    complementarity: f64,
    problems: &mut Problems<'_>,
) -> Option<(Friction, FrictionPlan)> {
    let key = format!("{}.friction", pair.key);
    if let Some(scheme) = scheme_elsewhere(pair) {
        let message = format!("contact with friction is not available with the scheme `{scheme}`");
        problems.add(key, "", message, format!("use {}, or remove the friction", schemes_that_fit()));
        return None;
    }
    let law = law(item, &key, pair.laws, problems)?;
    if !law.sticks()
        && let Some(name) = item.given.key()
    {
        let message = format!("belongs to stick, and the law `{}` has none", item.law);
        problems.add(format!("{key}.{name}"), "", message, "remove it");
        return None;
    }
    let (penalty, stick) = match item.sticking() {
        Some(s) => (s.penalty, s.stick()),
        None => (None, scene::Stick::Penalty),
    };
    let stiffness = Friction::tangential_stiffness(penalty, complementarity);
    let label = pair.item.label();
    let at_end = pair.phases.with(&label).all(|phase| phase.rule() == GradientRule::EndPoint);
    let mortar = item.slip.is_some() || pair.item.method.has("slip");
    let plan = FrictionPlan {
        law: item.law.clone(),
        parameters: item.parameters.clone(),
        stiffness: (law.sticks() && stick != scene::Stick::Multiplier).then_some(stiffness),
        default_stiffness: penalty.is_none(),
        stick: law.sticks().then(|| stick.name().to_owned()),
        stepping: if at_end { "end" } else { "step" }.to_owned(),
        slip: mortar.then(|| item.slip.unwrap_or(scene::Slip::Objective).name().to_owned()),
    };
    let stick = match stick {
        scene::Stick::Penalty => Stick::Penalty,
        scene::Stick::Multiplier => Stick::Multiplier,
    };
    let made = Friction::between_bodies(law, penalty, stick, complementarity);
    let friction = made.map_err(|error| problems.add(key, "", error.to_string(), "correct the parameter")).ok()?;
    let row = |row: Vec<f64>| (row[0], [row[1], row[2], row[3]]);
    let friction = match &pair.item.surface_velocity {
        Some(velocity) => {
            friction.with_surface_velocity(SurfaceVelocity::new(velocity.rows().into_iter().map(row).collect()))
        }
        None => friction,
    };
    Some((friction, plan))
}
