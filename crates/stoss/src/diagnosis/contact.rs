//! Contacts that find no state: friction that locks, points that come and go.

use super::case::DiagnosedRun;
use super::redundant::is_prescribed_whole;
use super::{Cause, Change, Confidence, LikelyCause, Remedy, Where, toml};
use crate::scene::split_set;
use stoss_solver::FailureKind;

/// Coefficient, in multiples of the one that just locks, from which on a wedge locks also where bodies give way.
const FAR_ABOVE: f64 = 2.0;
/// Part of the coefficient that just locks that does not.
const BELOW: f64 = 0.9;
/// Angles between drive and surface, in radians, that make a wedge: below the sides are parallel, above the body stands on the surface.
const LEAST_ANGLE: f64 = 1e-3;
const MOST_ANGLE: f64 = 1.25;
/// Cosine from which on two directions count as the same.
const OPPOSITE: f64 = 0.9;
/// Changes of a contact point in one attempt from which on it comes and goes.
const MANY_CHANGES: u32 = 4;

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|a| a * a).sum::<f64>().sqrt()
}

/// A wedge locks itself where a body is driven into a gap that narrows along the drive and cannot give way: on one side is a contact, on the other a guide or a
/// second contact, and the mean angle of friction of both sides exceeds half the angle of the gap. A guide has no friction and does not narrow the gap, so that the
/// contact alone counts then. A body that is only pressed on a surface, or led along it, is no wedge.
pub(super) fn locked_by_friction(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{Cycling, InsideOut, InvertedElement, NotConverged, Unsettled};
    if !case.failed_by(&[NotConverged, Cycling, Unsettled, InvertedElement, InsideOut]) {
        return Vec::new();
    }
    let flanks: Vec<Flank> = case.contacts().filter_map(|(c, item)| Flank::of(case, c, item)).collect();
    let mut list = Vec::new();
    for (k, flank) in flanks.iter().enumerate() {
        let label = case.scene.contacts[flank.contact].label();
        let second = flanks[k + 1..].iter().find(|other| flank.is_opposite(other));
        // Sides with friction, their mean angle to the drive and their mean angle of friction.
        let (sides, angle, friction, between) = match second {
            Some(other) => (
                vec![flank, other],
                0.5 * (flank.angle + other.angle),
                0.5 * (flank.mu.atan() + other.mu.atan()),
                format!("the contacts `{label}` and `{}`", case.scene.contacts[other.contact].label()),
            ),
            None => {
                let Some(guide) = guide(case, flank) else { continue };
                (vec![flank], flank.angle, flank.mu.atan(), format!("`{}` and the guide `{guide}`", flank.other))
            }
        };
        if angle <= LEAST_ANGLE || angle >= MOST_ANGLE || friction <= angle {
            continue;
        }
        let (tangent, mu) = (angle.tan(), toml::plain(friction.tan()));
        let place = case.place();
        let is_here = place.pair.as_deref() == Some(&label)
            || place.body.as_ref().is_some_and(|body| *body == flank.driven || *body == flank.other);
        let place = match is_here {
            true => Where { text: format!("{}, contact `{label}`", place.text), pair: Some(label.clone()), ..place },
            false => Where {
                text: format!("contact `{label}`"),
                pair: Some(label.clone()),
                body: Some(flank.driven.clone()),
                ..Where::default()
            },
        };
        let degrees = angle.to_degrees();
        let evidence = vec![
            format!(
                "mu = {mu} is {:.1} times {tangent:.3}, the coefficient from which on such a wedge locks",
                friction.tan() / tangent
            ),
            format!("{} contact points of `{label}` are closed", flank.closed),
        ];
        let below = toml::number(toml::down(BELOW * tangent));
        let changes: Vec<Change> = sides
            .iter()
            .map(|side| Change::Set {
                key: format!("contact[{}].friction.{}", side.contact, side.key),
                value: below.clone(),
            })
            .collect();
        let keys: Vec<String> =
            sides.iter().map(|side| format!("`contact[{}].friction.{} = {below}`", side.contact, side.key)).collect();
        list.push(LikelyCause {
            cause: Cause::FrictionLocks,
            confidence: match (is_here, friction.tan() > FAR_ABOVE * tangent) {
                (true, true) => Confidence::High,
                (true, false) | (false, true) => Confidence::Medium,
                (false, false) => Confidence::Low,
            },
            place,
            sentence: format!(
                "friction locks the wedge: `{}` is driven between {between}, which are at {degrees:.1} degrees to the prescribed motion, and mu = {mu} is above tan {degrees:.1} = {tangent:.3}. It sticks, and the elements deform instead",
                flank.driven
            ),
            evidence,
            remedies: vec![
                Remedy { text: format!("set {} (below {tangent:.3} it slides)", keys.join(" and ")), changes },
                Remedy::words(format!("or make the angle of the wedge larger than {:.0} degrees", friction.to_degrees())),
                Remedy::words("or prescribe a force instead of a motion, or a smaller motion"),
            ],
        });
    }
    list
}

/// A closed contact with friction of a body that a prescribed motion drives against it.
struct Flank {
    /// Number in the scene.
    contact: usize,
    /// Key of the coefficient of friction, and its value.
    key: &'static str,
    mu: f64,
    /// The driven body and the one that it meets.
    driven: String,
    other: String,
    /// Prescription of the scene that drives, and the motion, relative to the other body, of unit length.
    drive: Drive,
    /// Angle between the drive and the surface, positive where the body is driven into it.
    angle: f64,
    /// Unit vector across the drive, away from the surface: where the body would give way.
    aside: [f64; 3],
    /// Mean position of the closed points.
    centre: [f64; 3],
    /// Closed points.
    closed: usize,
}

impl Flank {
    fn of(case: &DiagnosedRun<'_>, contact: usize, item: &crate::scene::Contact) -> Option<Self> {
        let (key, mu) = item.friction.as_ref()?.coefficient()?;
        let reports = case.simulation.contact_report(contact).ok()?;
        let closed: Vec<_> =
            reports.iter().zip(&case.simulation.active()[contact]).filter(|(_, active)| **active).collect();
        if closed.is_empty() || item.between.is_some() {
            // Which side of `between` is the slave, to which normals point, is not known here.
            return None;
        }
        let normal: [f64; 3] = std::array::from_fn(|i| closed.iter().map(|(r, _)| r.weight * r.normal[i]).sum());
        let (drive, is_slave) = drive(case, item)?;
        let sign = if is_slave { 1.0 } else { -1.0 } / norm(normal).max(f64::MIN_POSITIVE);
        let normal = normal.map(|n| sign * n);
        let sine = -dot(drive.direction, normal);
        let aside: [f64; 3] = std::array::from_fn(|i| normal[i] + sine * drive.direction[i]);
        let width = norm(aside);
        let body = |set: &str| split_set(set).map_or(set, |(body, _)| body).to_owned();
        let [slave, master] = item.surfaces().map(body);
        let (driven, other) = if is_slave { (slave, master) } else { (master, slave) };
        let count = closed.len() as f64;
        Some(Self {
            contact,
            key,
            mu,
            driven,
            other,
            drive,
            angle: sine.clamp(-1.0, 1.0).asin(),
            aside: aside.map(|a| a / width.max(f64::MIN_POSITIVE)),
            centre: std::array::from_fn(|i| closed.iter().map(|(r, _)| case.position(r.node)[i]).sum::<f64>() / count),
            closed: closed.len(),
        })
    }

    /// Whether another contact of the same body stops it from giving way.
    fn is_opposite(&self, other: &Self) -> bool {
        self.driven == other.driven
            && dot(self.aside, other.aside) < -OPPOSITE
            && dot(self.drive.direction, other.drive.direction) > OPPOSITE
    }
}

/// What drives a body.
struct Drive {
    /// Number of the prescription in the model.
    prescription: usize,
    /// Unit vector.
    direction: [f64; 3],
    /// Motion in a step, a length.
    length: f64,
}

/// Name of a set of the driven body, not one that is driven, that a prescription keeps from moving aside, across from the contact.
fn guide(case: &DiagnosedRun<'_>, flank: &Flank) -> Option<String> {
    let model = case.model();
    let own = model.bodies.iter().find(|body| body.solid.name() == flank.driven)?.nodes.clone();
    let driven = &model.prescriptions[flank.drive.prescription].nodes;
    model.prescriptions.iter().find_map(|prescription| {
        let nodes: Vec<u32> =
            prescription.nodes.iter().copied().filter(|node| own.contains(node) && !driven.contains(node)).collect();
        let held: f64 = prescription.components.iter().map(|&i| flank.aside[usize::from(i)].powi(2)).sum();
        let moved = dot(motion(case, prescription, *nodes.first()?), flank.aside).abs();
        let across = nodes.iter().any(|&node| {
            let x = case.position(node);
            dot(std::array::from_fn(|i| x[i] - flank.centre[i]), flank.aside) > 0.0
        });
        let is_guide = held > OPPOSITE * OPPOSITE && moved <= 1e-6 * flank.drive.length && across;
        is_guide.then(|| prescription.name.clone())
    })
}

/// Motion of a node by a prescription in the next step.
fn motion(case: &DiagnosedRun<'_>, prescription: &stoss_solver::Prescription, node: u32) -> [f64; 3] {
    let (time, dt) = (case.simulation.state().time, case.scene.time.step);
    let reference = std::array::from_fn(|i| case.model().reference[3 * node as usize + i]);
    let mut motion = [0.0; 3];
    for (column, &component) in prescription.components.iter().enumerate() {
        let at = |time| prescription.position(node, reference, time, column);
        motion[usize::from(component)] = at(time + dt) - at(time);
    }
    motion
}

/// The prescribed motion, from now on, of that body of a contact that moves more, relative to the other one, and whether it is the slave.
fn drive(case: &DiagnosedRun<'_>, item: &crate::scene::Contact) -> Option<(Drive, bool)> {
    let model = case.model();
    let of = |set: &str| {
        let name = split_set(set).map_or(set, |(body, _)| body);
        let nodes = model.bodies.iter().find(|body| body.solid.name() == name).map(|body| body.nodes.clone());
        let mut best = (0, [0.0; 3]);
        for (p, prescription) in model.prescriptions.iter().enumerate() {
            let is_own = |node: &&u32| nodes.as_ref().is_some_and(|own| own.contains(node));
            let Some(&node) = prescription.nodes.iter().find(is_own) else { continue };
            let motion = motion(case, prescription, node);
            if norm(motion) > norm(best.1) {
                best = (p, motion);
            }
        }
        best
    };
    let [slave, master] = item.surfaces().map(of);
    let is_slave = norm(slave.1) >= norm(master.1);
    let (driven, other) = if is_slave { (slave, master) } else { (master, slave) };
    let relative: [f64; 3] = std::array::from_fn(|i| driven.1[i] - other.1[i]);
    let length = norm(relative);
    let direction = relative.map(|x| x / length);
    (length > 0.0).then_some((Drive { prescription: driven.0, direction, length }, is_slave))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Points that open and close until the attempt is given up.
pub(super) fn cycles(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
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
        && !is_prescribed_whole(case, master)
    {
        let change = |key: &str, value: &String| Change::Set {
            key: format!("contact[{c}].{key}"),
            value: format!("\"{value}\""),
        };
        let text = format!(
            "exchange slave and master of `{name}`: set `contact[{c}].slave = \"{master}\"` and `contact[{c}].master = \"{slave}\"`"
        );
        remedies.push(Remedy { text, changes: vec![change("slave", master), change("master", slave)] });
    }
    remedies.extend(case.smaller_step());
    if remedies.is_empty() {
        let is_mortar = case.contacts().any(|(_, item)| item.label() == name && item.method.integrates);
        remedies.push(Remedy::words(match is_mortar {
            true => "refine the slave surface where it meets the master",
            false => "refine the slave surface where it meets the master, or set `method = \"mortar\"`, whose contact state varies less from node to node",
        }));
    }
    vec![LikelyCause {
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
