//! Reads `[[support]]`.

use super::node::Node;
use super::table::Table;
use super::world::{World, set_reference};
use crate::{Kind, PartKind, Support, SupportPer, split_set};

pub(super) fn support(table: &Table<'_>, world: &World<'_>) -> Option<Support> {
    let set = table.required("set", "set = \"block.bottom\"", |n| supported_set(n, world));
    let per = table.default("per", Support::default_per(), |n| n.choice(SupportPer::NAMES, SupportPer::from_name));
    let frame = table.optional("frame", |n| n.array(Node::direction));
    let stiffness = table.default("stiffness", [0.0; 3], |n| n.array(Node::not_negative));
    let damping = table.default("damping", [0.0; 3], |n| n.array(Node::not_negative));
    table.finish();
    let support = Support { set: set?, per: per?, frame: frame?, stiffness: stiffness?, damping: damping? };
    if support.axes().is_none() {
        let message = "its two directions are parallel";
        return table.fail(
            "frame",
            message,
            "give the first axis and another direction, for instance [[1, 1, 0], [-1, 1, 0]]",
        );
    }
    if support.stiffness == [0.0; 3] && support.damping == [0.0; 3] {
        return table.fail("stiffness", "a support needs stiffness or damping", "add `stiffness = [0.0, 0.0, 1e5]`");
    }
    if support.stiffness == [0.0; 3] && world.kind == Some(Kind::QuasiStatic) {
        return table.fail(
            "damping",
            "a quasi-static scene has no velocities: dashpots alone exert no force",
            "add `stiffness`, remove the support, or set [scene] kind = \"dynamic\"",
        );
    }
    Some(support)
}

fn supported_set(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    match split_set(&text).and_then(|(part, _)| world.part(part)) {
        Some(part) if part.kind != PartKind::Body => node.fail(
            format!("`{}` is {}: a support acts on deformable bodies", part.name, part.kind.noun()),
            "use a [[spring]] or a [[joint]] to the ground",
        ),
        _ => Some(text),
    }
}
