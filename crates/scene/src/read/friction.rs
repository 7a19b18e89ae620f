//! Reads the friction of a contact.

use super::catalogue;
use super::contact_method::of_method;
use super::node::Node;
use super::table::Table;
use crate::{ContactMethod, Friction, MidpointFriction, Slip, Stick, Sticking};
use stoss_contact::friction::{FrictionEntry, entry};

/// `method`: that of the contact, if known; `own_laws`: names of the laws beside the catalogue.
pub(super) fn friction(node: &Node<'_>, method: Option<ContactMethod>, own_laws: &[&str]) -> Option<Friction> {
    let table = node.table_like("{ law = \"coulomb\", mu = 0.3 }")?;
    let mut names: Vec<&str> = Friction::names().collect();
    names.extend_from_slice(own_laws);
    let law = table.required("law", "law = \"coulomb\"", |n| {
        n.choice(&names, |name| names.contains(&name).then(|| name.to_owned()))
    });
    // Without a law it is not known which other keys are right.
    let law = law?;
    let slip = table.optional("slip", |n| {
        of_method(n, "slip", method)?;
        n.choice(Slip::NAMES, Slip::from_name)
    });
    let entry = entry(&law);
    let sticks = entry.is_none_or(FrictionEntry::sticks);
    let given = if sticks { sticking(&table) } else { Some(Sticking::default()) };
    let parameters = match entry {
        Some(entry) => catalogue::of_row(&table, &entry.law),
        None => catalogue::parameters(&table),
    };
    table.finish();
    Some(Friction { law, given: given?, slip: slip?, parameters: parameters? })
}

/// The keys of stick, if they fit each other.
fn sticking(table: &Table<'_>) -> Option<Sticking> {
    let penalty = table.optional("penalty", Node::positive);
    let stick = table.optional("stick", |n| n.choice(Stick::NAMES, Stick::from_name));
    let midpoint = table.optional("midpoint", |n| n.choice(MidpointFriction::NAMES, MidpointFriction::from_name));
    let sticking = Sticking { penalty: penalty?, stick: stick?, midpoint: midpoint? };
    let useless = match sticking.stick() {
        Stick::Penalty => None,
        Stick::Augmented => sticking.midpoint.map(|_| "midpoint"),
        Stick::Multiplier => sticking.penalty.map(|_| "penalty").or(sticking.midpoint.map(|_| "midpoint")),
    };
    if let Some(key) = useless {
        let stick = sticking.stick().name();
        let message = format!("has no effect with stick = \"{stick}\", which is exact");
        return table.fail(key, message, "remove it, or set stick = \"penalty\"");
    }
    Some(sticking)
}
