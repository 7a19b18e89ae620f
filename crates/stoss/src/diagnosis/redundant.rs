//! Pressures of contact and forces of supports that are not determined, because one constraint follows from others.

use super::case::DiagnosedRun;
use super::{Cause, Change, Confidence, LikelyCause, Remedy, Where};
use crate::scene::Enforcement;
use std::collections::{BTreeMap, BTreeSet};
use stoss_solver::FailureKind;

/// Part of a normal that other constraints leave free, below which they hold it.
const HELD: f64 = 1e-2;

/// Directions in which nodes are held by prescribed motion and by supports along normals.
fn held_directions(case: &DiagnosedRun<'_>) -> BTreeMap<u32, Vec<[f64; 3]>> {
    let mut held: BTreeMap<u32, Vec<[f64; 3]>> = BTreeMap::new();
    for prescription in case.prescriptions() {
        for &node in &prescription.nodes {
            let axes = prescription
                .components
                .iter()
                .map(|&c| std::array::from_fn(|i| f64::from(u8::from(i == usize::from(c)))));
            held.entry(node).or_default().extend(axes);
        }
    }
    for pair in &case.model().contacts {
        let slots = 0..pair.term.slot_count();
        for guide in slots.filter_map(|slot| pair.supported_node(slot, case.simulation.state().time)) {
            held.entry(guide.node).or_default().push(guide.direction);
        }
    }
    held
}

/// Whether a direction is a combination of others.
fn follows(direction: [f64; 3], from: &[[f64; 3]]) -> bool {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let mut basis: Vec<[f64; 3]> = Vec::new();
    let across = |mut d: [f64; 3], basis: &[[f64; 3]]| {
        for &e in basis.iter().chain(basis) {
            let part = dot(d, e);
            (0..3).for_each(|i| d[i] -= part * e[i]);
        }
        d
    };
    for &d in from {
        let rest = across(d, &basis);
        let size = dot(rest, rest).sqrt();
        if size > 1e-6 {
            basis.push(rest.map(|r| r / size));
        }
    }
    let rest = across(direction, &basis);
    dot(direction, direction) > 0.0 && dot(rest, rest).sqrt() < HELD
}

/// Closed contact points whose pressure is not determined: on faces of quadratic elements, or where supports hold the slave along the normal.
pub(super) fn redundant(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let Some(failure) = case.failure().filter(|_| case.failed_by(&[FailureKind::Singular])) else { return Vec::new() };
    let Some((failed, _)) = failure.place.slot else { return Vec::new() };
    let held = held_directions(case);
    let mut list = Vec::new();
    for (c, item) in case.contacts() {
        if item.enforcement != Enforcement::Multiplier {
            continue;
        }
        let pair = &case.model().contacts[c];
        let (Ok(points), active) = (case.simulation.contact_report(c), &case.simulation.active()[c]) else { continue };
        let is_here = failed == c;
        let label = &pair.name;
        let place = Where { pair: Some(label.clone()), ..case.place() };
        // What closes in the step that failed is not known: all points count that are near enough to be in it.
        let near = |k: usize| active[k] || points[k].gap.is_some_and(|gap| gap <= pair.term.length_scale());
        let near: Vec<usize> = (0..points.len().min(active.len())).filter(|&k| near(k)).collect();
        let of_supports: BTreeSet<u32> = near
            .iter()
            .map(|&k| &points[k])
            .filter(|point| held.get(&point.node).is_some_and(|held| follows(point.normal, held)))
            .map(|point| point.node)
            .collect();
        let failed_support = (0..case.model().contacts[failed].term.slot_count())
            .filter_map(|slot| case.model().contacts[failed].supported_node(slot, 0.0))
            .any(|guide| of_supports.contains(&guide.node));
        if !of_supports.is_empty() && (is_here || failed_support) {
            list.push(held_twice(case, c, &of_supports, place.clone()));
        }
        let middles = near.iter().filter(|&&k| case.model().follows_its_face(points[k].node)).count();
        if is_here && middles > 0 && !item.method.integrates {
            let penalty = "or `enforcement = { penalty = k }`, with the modulus over the length of an element for `k`";
            list.push(LikelyCause {
                cause: Cause::RedundantConstraints,
                confidence: if of_supports.is_empty() { Confidence::High } else { Confidence::Medium },
                place,
                sentence: format!(
                    "the slave of `{label}` has faces with 8 nodes: the point in the middle of a face has a pressure of its own, but moves with the face. Where the slave is as fine as the master or \
                     finer, that pressure is redundant"
                ),
                evidence: vec![
                    format!("{middles} of {} points near the master are in the middle of such faces", near.len()),
                    "the undetermined unknown is a pressure, not a motion".to_owned(),
                ],
                remedies: vec![
                    Remedy::set(format!("contact[{c}].method"), "\"mortar\"", "its pressures belong to the corners of faces and are determined"),
                    Remedy::words(penalty),
                    Remedy::words("or exchange `slave` and `master`, if the other surface is coarser"),
                ],
            });
        }
    }
    list.extend(shared_nodes(case, failed));
    if list.is_empty() {
        list.extend(alone(case, failed));
    }
    list
}

/// Contacts with multipliers whose slaves have nodes in common: two pressures of such a node have one and the same motion.
fn shared_nodes(case: &DiagnosedRun<'_>, failed: usize) -> Option<LikelyCause> {
    let nodes = |c: usize| -> BTreeSet<u32> {
        let points = case.simulation.contact_report(c).unwrap_or_default();
        let reach = case.model().contacts[c].term.length_scale();
        points.iter().filter(|point| point.gap.is_some_and(|gap| gap <= reach)).map(|point| point.node).collect()
    };
    let of_failed = nodes(failed);
    let is_exact = |item: &crate::scene::Contact| item.enforcement == Enforcement::Multiplier;
    let (_, item) = case.contacts().find(|(c, item)| *c == failed && is_exact(item))?;
    let others = case.contacts().filter(|(c, other)| *c != failed && is_exact(other));
    let (other, shared) =
        others.map(|(c, other)| (other, nodes(c).intersection(&of_failed).count())).find(|(_, shared)| *shared > 0)?;
    let (label, second) = (item.label(), other.label());
    let [a, b] = [item, other].map(|item| item.surfaces()[0].to_owned());
    Some(LikelyCause {
        cause: Cause::RedundantConstraints,
        confidence: Confidence::High,
        place: Where { pair: Some(label.clone()), ..case.place() },
        sentence: format!(
            "the contacts `{label}` and `{second}` have slave nodes in common: each gives such a node a pressure, and how they share its force is not determined"
        ),
        evidence: vec![
            format!("{shared} nodes near the masters are slaves of both"),
            "the undetermined unknown is a pressure, not a motion".to_owned(),
        ],
        remedies: vec![
            Remedy::words(format!(
                "make one contact of both, with the union of the slaves (`({a}) | ({b})`) and of the masters"
            )),
            Remedy::words("or leave the nodes in common out of one of the slaves"),
        ],
    })
}

/// A pressure of mortar contact with multipliers that nothing else explains: hardly any of the slave around its node lies opposite the master.
fn alone(case: &DiagnosedRun<'_>, failed: usize) -> Option<LikelyCause> {
    let (c, item) = case.contacts().find(|(c, item)| *c == failed && item.method.integrates)?;
    let label = item.label();
    Some(LikelyCause {
        cause: Cause::RedundantConstraints,
        confidence: Confidence::Medium,
        place: Where { pair: Some(label.clone()), ..case.place() },
        sentence: format!(
            "a pressure of `{label}` has hardly any effect on the bodies: very little of the slave around its node lies opposite the master, as at a corner that touches first"
        ),
        evidence: vec!["the undetermined unknown is a pressure, not a motion".to_owned()],
        remedies: vec![Remedy::set(format!("contact[{c}].method"), "\"nts\"", "there each pressure acts at its node")],
    })
}

/// The finding for nodes that a contact and supports hold along the same direction.
fn held_twice(case: &DiagnosedRun<'_>, c: usize, nodes: &BTreeSet<u32>, place: Where) -> LikelyCause {
    let item = &case.scene.contacts[c];
    let label = item.label();
    let [slave, _] = item.surfaces();
    let supports: Vec<String> = case
        .scene
        .prescriptions
        .iter()
        .enumerate()
        .filter(|(_, given)| {
            given.set.as_ref().is_some_and(|set| case.nodes(set).iter().any(|node| nodes.contains(node)))
        })
        .map(|(p, given)| format!("`prescribe[{p}]` on `{}`", given.set.as_deref().unwrap_or_default()))
        .collect();
    let by = if supports.is_empty() { "prescribed motion".to_owned() } else { supports.join(" and ") };
    let mut remedies = vec![
        Remedy::words(format!(
            "let only one of them hold these nodes: leave the nodes that touch out of the set of the prescription (a [[set]] without them), or the nodes that are held out of `{slave}`"
        )),
        Remedy::words(
            "or `enforcement = { penalty = k }` for the contact, with the modulus over the length of an element for `k`",
        ),
    ];
    let exchanged = exchanged(case, c);
    let at = if is_prescribed_whole(case, slave) { 0 } else { 1 };
    exchanged.into_iter().for_each(|remedy| remedies.insert(at, remedy));
    LikelyCause {
        cause: Cause::RedundantConstraints,
        confidence: Confidence::High,
        place,
        sentence: format!(
            "{by} and the contact `{label}` hold the same nodes of `{slave}` along the same direction: how the force is shared between them is not determined"
        ),
        evidence: vec![
            format!("{} nodes near the master are held along the normal of the contact", nodes.len()),
            "the undetermined unknown is a pressure or the force of a support, not a motion".to_owned(),
        ],
        remedies,
    }
}

/// Whether all nodes of a set are prescribed in all components: a tool.
pub(super) fn is_prescribed_whole(case: &DiagnosedRun<'_>, set: &str) -> bool {
    let mut held: BTreeMap<u32, BTreeSet<u8>> = BTreeMap::new();
    for prescription in case.prescriptions() {
        for &node in &prescription.nodes {
            held.entry(node).or_default().extend(&prescription.components);
        }
    }
    let nodes = case.nodes(set);
    !nodes.is_empty() && nodes.iter().all(|node| held.get(node).is_some_and(|components| components.len() == 3))
}

/// Slave and master the other way round; nothing if the master is prescribed whole, too.
fn exchanged(case: &DiagnosedRun<'_>, c: usize) -> Option<Remedy> {
    let item = &case.scene.contacts[c];
    let (slave, master) = (item.slave.as_ref()?, item.master.as_ref()?);
    if is_prescribed_whole(case, master) {
        return None;
    }
    let set =
        |key: &str, value: &str| Change::Set { key: format!("contact[{c}].{key}"), value: format!("\"{value}\"") };
    Some(Remedy {
        text: format!(
            "exchange slave and master, so that the slave can move: set `contact[{c}].slave = \"{master}\"` and `contact[{c}].master = \"{slave}\"`"
        ),
        changes: vec![set("slave", master), set("master", slave)],
    })
}

#[cfg(test)]
mod tests {
    use super::follows;

    #[test]
    fn a_normal_follows_from_directions_that_span_it() {
        let r = 0.5_f64.sqrt();
        let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        assert!(follows(z, &[z]) && follows([r, 0.0, -r], &[x, z]) && follows([1e-3, 0.0, 1.0], &[z]));
        assert!(!follows(z, &[]) && !follows([r, 0.0, r], &[z]) && !follows([0.0; 3], &[x]));
        // The same direction twice is one.
        assert!(!follows(z, &[x, x]));
    }
}
