//! Reads the friction of a contact.

use super::node::Node;
use super::table::Table;
use crate::friction::Sticking;
use crate::{CoulombFriction, Friction, MidpointFriction, RegularisedFriction, Slip, StaticDynamicFriction, Stick};

/// `mortar`: the contact's method, if known.
pub(super) fn friction(node: &Node<'_>, mortar: Option<bool>) -> Option<Friction> {
    let table = node.table()?;
    let reader = table.required("law", "law = \"coulomb\"", |n| {
        n.choice(Friction::NAMES, |name| match name {
            "coulomb" => Some(coulomb as fn(&Table<'_>) -> _),
            "static-dynamic" => Some(static_dynamic),
            "regularised" => Some(regularised),
            _ => None,
        })
    });
    // Without a law it is not known which other keys are right.
    let friction = reader?(&table);
    let slip = table.optional("slip", |n| {
        if mortar == Some(false) {
            return n.fail("is for mortar contact only", "remove it, or set method = \"mortar\"");
        }
        n.choice(Slip::NAMES, Slip::from_name)
    });
    table.finish();
    Some(friction?.with_slip(slip?))
}

fn sticking(table: &Table<'_>) -> Option<Sticking> {
    let penalty = table.optional("penalty", Node::positive);
    let stick = table.optional("stick", |n| n.choice(Stick::NAMES, Stick::from_name));
    let midpoint = table.optional("midpoint", |n| n.choice(MidpointFriction::NAMES, MidpointFriction::from_name));
    let (penalty, stick, midpoint) = (penalty?, stick?, midpoint?);
    let sticking = Sticking { penalty, stick, midpoint: midpoint.unwrap_or(Sticking::DEFAULT_MIDPOINT) };
    if sticking.stick() == Stick::Multiplier {
        let useless = [("penalty", penalty.is_some()), ("midpoint", midpoint.is_some())];
        for (key, _) in useless.into_iter().filter(|(_, given)| *given) {
            return table.fail(
                key,
                "has no effect on stick by multipliers, which is exact",
                "remove it, or set stick = \"penalty\"",
            );
        }
    }
    Some(sticking)
}

fn coulomb(table: &Table<'_>) -> Option<Friction> {
    let mu = table.required("mu", "mu = 0.3", Node::not_negative);
    let sticking = sticking(table);
    let (mu, Sticking { penalty, stick, midpoint }) = (mu?, sticking?);
    Some(Friction::Coulomb(CoulombFriction { mu, penalty, stick, midpoint, slip: None }))
}

fn static_dynamic(table: &Table<'_>) -> Option<Friction> {
    let mu_static = table.required("mu_static", "mu_static = 0.5", Node::not_negative);
    let mu_dynamic = table.required("mu_dynamic", "mu_dynamic = 0.3", Node::not_negative);
    let speed = table.required("speed", "speed = 0.01", Node::positive);
    let sticking = sticking(table);
    let (mu_static, mu_dynamic) = (mu_static?, mu_dynamic?);
    if mu_static < mu_dynamic {
        return table.fail(
            "mu_static",
            format!("is below `mu_dynamic` = {mu_dynamic}"),
            "let the coefficient at rest be the larger one",
        );
    }
    let (speed, Sticking { penalty, stick, midpoint }) = (speed?, sticking?);
    Some(Friction::StaticDynamic(StaticDynamicFriction {
        mu_static,
        mu_dynamic,
        speed,
        penalty,
        stick,
        midpoint,
        slip: None,
    }))
}

fn regularised(table: &Table<'_>) -> Option<Friction> {
    let mu = table.required("mu", "mu = 0.3", Node::not_negative);
    let speed = table.required("speed", "speed = 0.01", Node::positive);
    Some(Friction::Regularised(RegularisedFriction { mu: mu?, speed: speed?, slip: None }))
}
