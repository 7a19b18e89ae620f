//! What the scene says of pairs of bodies in general contact, and what contradicts itself there.

use super::friction::law;
use super::general_schemes::sorted;
use super::placed::index;
use super::{OwnLaws, Placed, Problems};
use crate::scene::{Edges, Friction, GeneralContact as Table, GeneralFriction, Parameter, Scene, split_set};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use stoss_contact::friction::{FrictionLaw, Sliding};

/// Name in messages and tables.
pub(super) const NAME: &str = "general";

/// Friction of all pairs of parts.
#[derive(Default)]
pub(super) struct Frictions {
    plain: Option<Rubbing>,
    /// Friction of contacts that leave their edges to general contact, by their two parts, the one with the smaller number first.
    contacts: BTreeMap<[usize; 2], Rubbing>,
    /// Friction by the number of the pair in the table; nothing of pairs that say nothing.
    pairs: BTreeMap<usize, Option<Rubbing>>,
}

/// A law with what the scene says of it.
#[derive(Clone)]
struct Rubbing {
    law: Arc<dyn FrictionLaw>,
    said: Friction,
}

impl Rubbing {
    fn new(said: &Friction, key: &str, laws: &OwnLaws, problems: &mut Problems<'_>) -> Option<Self> {
        Some(Self { law: law(said, key, laws, problems)?, said: said.clone() })
    }

    /// Coefficient at rest and at unit pressure, by which the rougher one of two is known.
    fn roughness(&self) -> f64 {
        let at = |speed| self.law.coefficient(&Sliding::steady(speed)).value;
        if self.law.sticks() { at(0.0) } else { at(FAST) }
    }
}

/// A slip speed at which a law that does not stick has its full friction.
const FAST: f64 = 1e100;

impl Frictions {
    /// What the scene says, with the laws of the program; reports what is wrong. Of several contacts between two parts the rougher one counts.
    pub fn of(scene: &Scene, placed: &[Placed], table: &Table, laws: &OwnLaws, problems: &mut Problems<'_>) -> Self {
        let mut all = Self::default();
        let of_table = |key: &str, said: &GeneralFriction, problems: &mut Problems<'_>| {
            said.law().and_then(|said| Rubbing::new(&said, key, laws, problems))
        };
        all.plain = of_table("general_contact.friction", &table.friction, problems);
        for (k, pair) in table.pairs.iter().enumerate() {
            if let Some(said) = &pair.friction {
                all.pairs.insert(k, of_table(&format!("general_contact.pairs[{k}].friction"), said, problems));
            }
        }
        for (c, contact) in scene.contacts.iter().enumerate().filter(|(_, contact)| contact.edges == Edges::General) {
            let [a, b] = contact.surfaces().map(|set| index(placed, split_set(set).map_or(set, |(part, _)| part)));
            let (Some(a), Some(b), Some(said)) = (a, b, &contact.friction) else { continue };
            let Some(new) = Rubbing::new(said, &format!("contact[{c}].friction"), laws, problems) else { continue };
            let parts = [a.min(b), a.max(b)];
            if all.contacts.get(&parts).is_none_or(|known| known.roughness() < new.roughness()) {
                all.contacts.insert(parts, new);
            }
        }
        all
    }

    /// Friction between two parts, of which a pair of the table may say something: what `pairs` say goes before what contacts say.
    pub fn between(&self, pair: Option<usize>, [a, b]: [usize; 2]) -> Option<Arc<dyn FrictionLaw>> {
        let of_contact = || self.contacts.get(&[a.min(b), a.max(b)]).or(self.plain.as_ref());
        let found = match pair.and_then(|k| self.pairs.get(&k)) {
            Some(of_pair) => of_pair.as_ref(),
            None => of_contact(),
        };
        found.map(|of| Arc::clone(&of.law))
    }

    /// Names of the laws, and their parameters with the names of the parts, for the plan.
    pub fn said(&self, placed: &[Placed], table: &Table) -> (String, BTreeMap<String, Parameter>) {
        let of_pairs = self.pairs.iter().filter_map(|(k, of)| {
            let [a, b] = &table.pairs[*k].between;
            Some((format!(" of {a} and {b}"), of.as_ref()?))
        });
        let of_contacts = self.contacts.iter().filter_map(|([a, b], of)| {
            let names = [&placed[*a].name[..], &placed[*b].name[..]];
            let is_pair = |k: &usize| sorted(table.pairs[*k].between.each_ref().map(|name| &name[..])) == sorted(names);
            (!self.pairs.keys().any(is_pair)).then(|| (format!(" of {} and {}", names[0], names[1]), of))
        });
        let all: Vec<(String, &Rubbing)> =
            self.plain.iter().map(|of| (String::new(), of)).chain(of_contacts).chain(of_pairs).collect();
        let laws: BTreeSet<&str> = all.iter().map(|(_, of)| &of.said.law[..]).collect();
        let parameters = all.iter().flat_map(|(parts, of)| {
            of.said.parameters.iter().map(move |(name, value)| (format!("{name}{parts}"), value.clone()))
        });
        (laws.into_iter().collect::<Vec<_>>().join(", "), parameters.collect())
    }
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
