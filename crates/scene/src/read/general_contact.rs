//! Reads `[general_contact]`.

use super::node::{Node, is_name};
use super::world::{World, part_name, surface_reference};
use crate::{GeneralContact, GeneralFriction, GeneralPair, Initial};

pub(super) fn general_contact(node: &Node<'_>, world: &World<'_>) -> Option<GeneralContact> {
    let table = node.table()?;
    let enabled = table.default("enabled", true, Node::boolean);
    let plain = GeneralContact::default();
    let thickness = table.optional("thickness", |n| {
        if n.is_string() && n.string_value() == Some("auto") { Some(None) } else { n.positive().map(Some) }
    });
    let stiffness = table.default("stiffness", plain.stiffness, Node::positive);
    let modulus = table.optional("modulus", Node::positive);
    let friction = table.default("friction", plain.friction, |n| friction(n, world));
    let slip_velocity = table.optional("slip_velocity", Node::positive);
    let damping = table.default("damping", plain.damping, Node::not_negative);
    let with_itself = table.default("self", plain.with_itself, Node::boolean);
    let initial = table.default("initial", plain.initial, |n| n.choice(Initial::NAMES, Initial::from_name));
    let of_pair = |key| -> Option<Option<()>> {
        table.optional(key, |n| {
            n.fail(
                "is not for general contact: its layer has no row that could keep a gap, and a layer of another thickness would be another stiffness",
                "name the pair of surfaces in a [[contact]], which has this key",
            )
        })
    };
    let no_rows = (of_pair("overlap"), of_pair("interference"), of_pair("closing_friction"));
    let surfaces = |n: &Node<'_>| n.list(|n| surface(n, world));
    let include = table.default("include", Vec::new(), surfaces);
    let exclude = table.default("exclude", Vec::new(), surfaces);
    let pairs = table.default("pairs", Vec::new(), |n| n.list(|n| pair(n, world)));
    table.finish();
    let (Some(_), Some(_), Some(_)) = no_rows else { return None };
    Some(GeneralContact {
        enabled: enabled?,
        thickness: thickness?.flatten(),
        stiffness: stiffness?,
        modulus: modulus?,
        friction: friction?,
        slip_velocity: slip_velocity?,
        damping: damping?,
        with_itself: with_itself?,
        initial: initial?,
        include: include?,
        exclude: exclude?,
        pairs: pairs?,
    })
}

fn pair(node: &Node<'_>, world: &World<'_>) -> Option<GeneralPair> {
    let table = node.table()?;
    let between = table.required("between", "between = [\"block\", \"plate\"]", |n| n.array(|n| part_name(n, world)));
    let friction = table.optional("friction", |n| friction(n, world));
    let modulus = table.optional("modulus", Node::positive);
    table.finish();
    Some(GeneralPair { between: between?, friction: friction?, modulus: modulus? })
}

/// A coefficient, or a law.
fn friction(node: &Node<'_>, world: &World<'_>) -> Option<GeneralFriction> {
    if !node.is_table() {
        return node.not_negative().map(GeneralFriction::Coefficient);
    }
    let law = super::friction::friction(node, None, world.own_friction)?;
    let key = law.given.key().or(law.slip.map(|_| "slip"));
    if let Some(key) = key {
        return node.fail(
            format!("has `{key}`, which is not for general contact: bodies stick there like springs of the shear stiffness of the layer, or creep below `slip_velocity`"),
            "remove it",
        );
    }
    Some(GeneralFriction::Law(law))
}

/// A part, or facets of one.
fn surface(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    match node.string_value() {
        Some(text) if is_name(text) => part_name(node, world),
        _ => surface_reference(node, world),
    }
}
