//! What the scene says of pairs of bodies in general contact, and what contradicts itself there.

use super::general_schemes::sorted;
use super::placed::index;
use super::{Placed, Problems};
use crate::scene::{Edges, GeneralContact as Table, Parameter, Scene, given, split_set};
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact::friction::entry;

/// A slip speed far beyond that of every law.
const FAST: f64 = 1e100;

/// Name in messages and tables.
pub(super) const NAME: &str = "general";

/// Friction of contacts that leave their edges to general contact, by their two parts, the one with the smaller number first: the largest coefficient of several contacts.
pub(super) fn of_contacts(scene: &Scene, placed: &[Placed], warnings: &mut Vec<String>) -> BTreeMap<[usize; 2], f64> {
    let mut known: BTreeMap<[usize; 2], f64> = BTreeMap::new();
    for (c, contact) in scene.contacts.iter().enumerate().filter(|(_, contact)| contact.edges == Edges::General) {
        let [a, b] = contact.surfaces().map(|set| index(placed, split_set(set).map_or(set, |(part, _)| part)));
        let (Some(a), Some(b), Some(friction)) = (a, b, &contact.friction) else { continue };
        let law = entry(&friction.law).and_then(|entry| entry.law.with(given(&friction.parameters)).ok());
        let Some(law) = law else {
            let [a, b] = contact.surfaces().map(|set| split_set(set).map_or(set, |(part, _)| part));
            warnings.push(format!(
                "contact[{c}].friction: general contact, which takes care of the edges, does not support the law `{}` and uses the `friction` of [general_contact] there; set one for the two bodies: \
                 [general_contact] pairs = [{{ between = [\"{a}\", \"{b}\"], friction = 0.2 }}]",
                friction.law
            ));
            continue;
        };
        let mu = law.coefficient(FAST);
        if law.coefficient(0.0) != mu {
            let key = friction.parameters.iter().find(|(_, value)| **value == Parameter::Number(mu));
            let key = key.map_or(String::new(), |(key, _)| format!("`{key}` = "));
            warnings.push(format!(
                "contact[{c}].friction: general contact, which takes care of the edges, supports Coulomb's law only and not `{}`: {key}{mu}, the coefficient of fast slip, is used there; below which speed it falls \
                 is said by `slip_velocity` of [general_contact]",
                friction.law
            ));
        }
        let entry = known.entry([a.min(b), a.max(b)]).or_insert(mu);
        *entry = entry.max(mu);
    }
    known
}

/// Reports pairs that are named twice, or cannot be in contact, and a contact with the name that general contact has in tables. `parts` take part.
pub(super) fn check(
    scene: &Scene,
    placed: &[Placed],
    table: &Table,
    parts: &BTreeSet<usize>,
    problems: &mut Problems<'_>,
) {
    let mut seen: BTreeMap<[&str; 2], usize> = BTreeMap::new();
    for (k, pair) in table.pairs.iter().enumerate() {
        let key = format!("general_contact.pairs[{k}].between");
        let [a, b] = [&pair.between[0][..], &pair.between[1][..]];
        let names = format!("{a}, {b}");
        if let Some(first) = seen.get(&sorted([a, b])) {
            let message = format!("is the pair of general_contact.pairs[{first}]");
            problems.add(key, names, message, "keep one of the two");
            continue;
        }
        seen.insert(sorted([a, b]), k);
        let is_out = |name: &&str| index(placed, name).is_none_or(|part| !parts.contains(&part));
        if let Some(out) = [a, b].iter().find(|name| is_out(name)) {
            let message = format!(
                "`{out}` takes no part in general contact: it is not in `include`, it is in `exclude`, or it has no surface"
            );
            problems.add(key, names, message, "remove the pair, or change `include` and `exclude`");
        } else if a == b && index(placed, a).is_some_and(|part| placed[part].mesh().is_none()) {
            problems.add(key, names, "a rigid body is not in contact with itself", "remove the pair");
        } else if a == b && !table.with_itself {
            let message = "no body is in contact with itself, for `self` is false";
            problems.add(key, names, message, "remove the pair, or set `self = true`");
        }
    }
    for (c, contact) in scene.contacts.iter().enumerate().filter(|(_, contact)| contact.label() == NAME) {
        let message = "is the name of general contact in tables and files";
        problems.add(format!("contact[{c}].name"), contact.label(), message, "choose another name");
    }
}
