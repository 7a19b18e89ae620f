//! Reads the friction of a contact.

use super::material::parameters;
use super::node::Node;
use super::table::Table;
use crate::friction::Sticking;
use crate::{
    CoulombFriction, Friction, MidpointFriction, OwnFriction, RegularisedFriction, Slip, StaticDynamicFriction, Stick,
};

/// `mortar`: the contact's method, if known; `own_laws`: names of the laws beside the catalogue.
pub(super) fn friction(node: &Node<'_>, mortar: Option<bool>, own_laws: &[&str]) -> Option<Friction> {
    let table = node.table_like("{ law = \"coulomb\", mu = 0.3 }")?;
    let names: Vec<&str> = Friction::NAMES.iter().chain(own_laws).copied().collect();
    let reader = table.required("law", "law = \"coulomb\"", |n| {
        n.choice(&names, |name| match name {
            "coulomb" => Some(coulomb as fn(&Table<'_>) -> _),
            "static-dynamic" => Some(static_dynamic),
            "regularised" => Some(regularised),
            name if own_laws.contains(&name) => Some(own),
            _ => None,
        })
    });
    // Without a law it is not known which other keys are right.
    let reader = reader?;
    let slip = table.optional("slip", |n| {
        if mortar == Some(false) {
            return n.fail("is for mortar contact only", "remove it, or set method = \"mortar\"");
        }
        n.choice(Slip::NAMES, Slip::from_name)
    });
    let friction = reader(&table);
    table.finish();
    Some(friction?.with_slip(slip?))
}

/// Beside the keys of stick, numbers and lists of numbers; which there are is the law's own business.
fn own(table: &Table<'_>) -> Option<Friction> {
    let law = table.required("law", "law = \"mine\"", Node::name);
    let penalty = table.optional("penalty", Node::positive);
    let stick = table.optional("stick", |n| n.choice(Stick::NAMES, Stick::from_name));
    let midpoint = table.optional("midpoint", |n| n.choice(MidpointFriction::NAMES, MidpointFriction::from_name));
    let parameters = parameters(table);
    let (law, penalty, stick, midpoint) = (law?, penalty?, stick?, midpoint?);
    sticking_of(table, penalty, stick, midpoint)?;
    Some(Friction::Own(OwnFriction { law, penalty, stick, midpoint, slip: None, parameters: parameters? }))
}

fn sticking(table: &Table<'_>) -> Option<Sticking> {
    let penalty = table.optional("penalty", Node::positive);
    let stick = table.optional("stick", |n| n.choice(Stick::NAMES, Stick::from_name));
    let midpoint = table.optional("midpoint", |n| n.choice(MidpointFriction::NAMES, MidpointFriction::from_name));
    let (penalty, stick, midpoint) = (penalty?, stick?, midpoint?);
    sticking_of(table, penalty, stick, midpoint)
}

/// The keys of stick, if they fit each other.
fn sticking_of(
    table: &Table<'_>,
    penalty: Option<f64>,
    stick: Option<Stick>,
    midpoint: Option<MidpointFriction>,
) -> Option<Sticking> {
    let sticking = Sticking { penalty, stick, midpoint };
    let useless = match sticking.stick() {
        Stick::Penalty => None,
        Stick::Augmented => midpoint.map(|_| "midpoint"),
        Stick::Multiplier => penalty.map(|_| "penalty").or(midpoint.map(|_| "midpoint")),
    };
    if let Some(key) = useless {
        let stick = sticking.stick().name();
        let message = format!("has no effect with stick = \"{stick}\", which is exact");
        return table.fail(key, message, "remove it, or set stick = \"penalty\"");
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
