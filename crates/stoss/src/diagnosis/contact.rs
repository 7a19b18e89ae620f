//! Contacts that find no state: friction that locks, points that come and go.

use super::case::Case;
use super::{Cause, Confidence, Finding, Remedy, Where, toml};
use crate::scene::{Friction, split_set};
use stoss_solver::FailureKind;

/// Coefficient, in multiples of the one that just locks, from which on a wedge locks also where bodies give way.
const FAR_ABOVE: f64 = 2.0;
/// Part of the coefficient that just locks that does not.
const BELOW: f64 = 0.9;
/// Changes of a contact point in one attempt from which on it comes and goes.
const MANY_CHANGES: u32 = 4;

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|a| a * a).sum::<f64>().sqrt()
}

/// A wedge that is driven into a gap is locked if the coefficient of friction exceeds the tangent of its angle to the drive: no force drives it farther, only the
/// bodies give way.
pub(super) fn locked_by_friction(case: &Case<'_>) -> Vec<Finding> {
    if case.failure().is_none() {
        return Vec::new();
    }
    let mut list = Vec::new();
    for (c, item) in case.contacts() {
        let (key, mu) = match &item.friction {
            Some(Friction::Coulomb(law)) => ("mu", law.mu),
            Some(Friction::StaticDynamic(law)) => ("mu_static", law.mu_static),
            Some(Friction::Regularised(law)) => ("mu", law.mu),
            _ => continue,
        };
        let Ok(reports) = case.simulation.contact_report(c) else { continue };
        let closed: Vec<_> = reports.iter().zip(&case.simulation.active()[c]).filter(|(_, active)| **active).collect();
        if closed.is_empty() {
            continue;
        }
        let normal: [f64; 3] = std::array::from_fn(|i| closed.iter().map(|(r, _)| r.weight * r.normal[i]).sum());
        let normal = normal.map(|n| n / norm(normal).max(f64::MIN_POSITIVE));
        let Some(drive) = drive(case, item) else { continue };
        // Normals point from the master to the slave: into the gap is against them.
        let sine = -(0..3).map(|i| drive[i] * normal[i]).sum::<f64>() / norm(drive);
        if sine <= 1e-3 || sine > 0.95 {
            continue;
        }
        let tangent = sine / (1.0 - sine * sine).sqrt();
        if mu <= tangent {
            continue;
        }
        let label = item.label();
        let locks = mu > FAR_ABOVE * tangent;
        let bodies = item.surfaces().map(|set| split_set(set).map_or(set, |(body, _)| body).to_owned());
        let place = case.place();
        let is_here =
            place.pair.as_deref() == Some(&label) || place.body.as_ref().is_some_and(|body| bodies.contains(body));
        let place = match is_here {
            true => Where { text: format!("{}, contact `{label}`", place.text), pair: Some(label.clone()), ..place },
            false => Where {
                text: format!("contact `{label}`"),
                pair: Some(label.clone()),
                body: Some(bodies[0].clone()),
                ..Where::default()
            },
        };
        let angle = sine.asin().to_degrees();
        let below = toml::down(BELOW * tangent);
        list.push(Finding {
            cause: Cause::FrictionLocks,
            confidence: match (is_here, locks) {
                (true, true) => Confidence::High,
                (true, false) | (false, true) => Confidence::Medium,
                (false, false) => Confidence::Low,
            },
            place,
            sentence: format!(
                "friction locks the wedge: `{}` is driven into `{}` at {angle:.1} degrees to their surface, and mu = {mu} is above tan {angle:.1} = {tangent:.3}. It cannot slide, however hard it is driven: only the elements deform",
                bodies[0], bodies[1]
            ),
            evidence: vec![
                format!("mu = {mu} is {:.1} times the coefficient from which on the wedge locks, {tangent:.3}", mu / tangent),
                format!("{} contact points of `{label}` are closed", closed.len()),
            ],
            remedies: vec![
                Remedy::set(format!("contact[{c}].friction.{key}"), toml::number(below), &format!("below {tangent:.3} it slides")),
                Remedy::words(format!("or make the wedge blunter than {:.0} degrees", mu.atan().to_degrees())),
                Remedy::words("or prescribe a force instead of a motion, or a smaller motion"),
            ],
        });
    }
    list
}

/// The motion of the slave relative to the master that is prescribed from now on, of their most moved nodes.
fn drive(case: &Case<'_>, item: &crate::scene::Contact) -> Option<[f64; 3]> {
    let model = case.model();
    let (time, dt) = (case.simulation.state().time, case.scene.time.step);
    let of = |set: &str| {
        let name = split_set(set).map_or(set, |(body, _)| body);
        let nodes = model.bodies.iter().find(|body| body.solid.name() == name).map(|body| body.nodes.clone());
        let mut best = [0.0; 3];
        for prescription in &model.prescriptions {
            let Some(&node) =
                prescription.nodes.iter().find(|node| nodes.as_ref().is_some_and(|own| own.contains(node)))
            else {
                continue;
            };
            let reference = std::array::from_fn(|i| model.reference[3 * node as usize + i]);
            let mut motion = [0.0; 3];
            for (column, &component) in prescription.components.iter().enumerate() {
                let at = |time| prescription.position(node, reference, time, column);
                motion[usize::from(component)] = at(time + dt) - at(time);
            }
            if norm(motion) > norm(best) {
                best = motion;
            }
        }
        best
    };
    // Which is slave matters: normals point to it.
    let [slave, master] = item.surfaces();
    let (slave, master) = match case.simulation.model().contacts.iter().position(|pair| pair.name == item.label()) {
        Some(_) if item.between.is_some() => return None,
        _ => (of(slave), of(master)),
    };
    let drive = std::array::from_fn(|i| slave[i] - master[i]);
    (norm(drive) > 0.0).then_some(drive)
}

/// Points that open and close until the attempt is given up.
pub(super) fn cycles(case: &Case<'_>) -> Vec<Finding> {
    let Some(failure) = case.failure() else { return Vec::new() };
    let often = failure.slots.first().filter(|slot| slot.changes >= MANY_CHANGES);
    let cycling = case.failed_by(&[FailureKind::Cycling, FailureKind::Unsettled]);
    let slot = often.map(|slot| (slot.pair, slot.slot)).or(failure.place.slot);
    let Some((pair, slot)) = slot.filter(|_| cycling || often.is_some()) else { return Vec::new() };
    let place = case.place_of(&stoss_solver::Place {
        node: case.simulation.contact_report(pair).ok().and_then(|reports| Some(reports.get(slot)?.node)),
        slot: Some((pair, slot)),
        ..stoss_solver::Place::default()
    });
    let name = case.model().contacts[pair].name.clone();
    let mut evidence: Vec<String> = failure
        .slots
        .iter()
        .take(3)
        .map(|of| format!("{} changed its status {} times", case.slot_name(of.pair, of.slot), of.changes))
        .collect();
    evidence.push(failure.reason.clone());
    let mut remedies = Vec::new();
    if let Some((c, item)) = case.contacts().find(|(_, item)| item.label() == name)
        && let (Some(slave), Some(master)) = (&item.slave, &item.master)
    {
        let change = |key: &str, value: &String| super::Change::Set {
            key: format!("contact[{c}].{key}"),
            value: format!("\"{value}\""),
        };
        let text = format!(
            "exchange slave and master of `{name}`: set `contact[{c}].slave = \"{master}\"` and `contact[{c}].master = \"{slave}\"`"
        );
        remedies.push(Remedy { text, changes: vec![change("slave", master), change("master", slave)] });
    }
    let step = toml::number(toml::down(0.5 * case.scene.time.step));
    remedies.push(Remedy::set(case.step_key(), step, "half the present value"));
    vec![Finding {
        cause: Cause::ContactCycles,
        confidence: if cycling { Confidence::Medium } else { Confidence::Low },
        sentence: format!(
            "points of contact `{name}` open and close, or stick and slide, from iteration to iteration: no consistent contact state was found"
        ),
        place,
        evidence,
        remedies,
    }]
}
