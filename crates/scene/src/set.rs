//! `[[set]]`: sets of a body by a box or a plane.

use crate::read::{Node, Table, is_name};
use crate::split_set;
use crate::world::{World, meshed_part};
use stoss_scene_derive::table;

/// `[[set]]`: nodes, facets and elements of a body, or of a rigid body with a surface, inside a box or on a plane, in the reference configuration after placement.
/// Exactly one of `box` and `plane`.
#[table(context(World<'_>), check = set)]
pub struct SetDefinition {
    /// Name of the set, written `body.name`; unique.
    #[key(example = "\"plate.rim\"", with = set_name)]
    pub name: String,
    /// Name of the body, or of the rigid body with a surface.
    #[key(example = "\"plate\"", by = |node, world| meshed_part(node, world, true))]
    pub body: String,
    /// An axis-parallel box that contains the set, its boundary included.
    #[key(name = "box")]
    pub inside: Option<BoxRegion>,
    /// A plane on which the set lies, within a tolerance.
    pub plane: Option<PlaneRegion>,
}

impl SetDefinition {
    /// Name of the set within its body (`rim` of `plate.rim`).
    pub fn local_name(&self) -> &str {
        split_set(&self.name).map_or(&self.name, |(_, set)| set)
    }
}

/// An axis-parallel box.
#[table(check_all = box_region)]
#[derive(Copy)]
pub struct BoxRegion {
    /// Smallest coordinates (a length each); `-inf` is allowed.
    #[key(dimension = Length, example = "[0, 0, 0]", extended)]
    pub min: [f64; 3],
    /// Largest coordinates (a length each), not below `min`; `inf` is allowed.
    #[key(dimension = Length, example = "[1, 1, 1]", extended)]
    pub max: [f64; 3],
}

/// A plane.
#[table]
#[derive(Copy)]
pub struct PlaneRegion {
    /// A point on the plane.
    #[key(dimension = Length, example = "[0, 0, 0]")]
    pub point: [f64; 3],
    /// Normal of the plane, of any length but zero.
    #[key(dimension = Number, example = "[0, 0, 1]", direction)]
    pub normal: [f64; 3],
    /// Largest distance of a node from the plane (length), positive; a millionth of the size of the body if left out.
    #[key(dimension = Length, positive)]
    pub tolerance: Option<f64>,
}

fn set_name(node: &Node<'_>, _: &World<'_>, _: &SetDefinitionKeys) -> Option<String> {
    let text = node.text()?;
    let Some((_, set)) = split_set(&text) else {
        let remedy = "write the name of the body, a dot, and the name of the set";
        return node.fail("is not of the form `body.set`", remedy);
    };
    if !is_name(set) {
        return node.fail("is not a valid name", "use letters, digits, `-` and `_` only after the dot");
    }
    Some(text)
}

fn set(keys: &SetDefinitionKeys, table: &Table<'_>, _: &World<'_>) -> Option<()> {
    let own = match (&keys.body, keys.name.as_deref().and_then(split_set)) {
        (Some(body), Some((owner, set))) if owner != body => table.fail(
            "name",
            format!("does not start with the set's body `{body}`"),
            format!("call it \"{body}.{set}\""),
        ),
        _ => Some(()),
    };
    let one_region = match (table.has("box"), table.has("plane")) {
        (true, true) => table.fail("plane", "a set has either a box or a plane", "remove one of them"),
        (false, false) => table.missing("box", "box = { min = [0, 0, 0], max = [1, 1, 1] }"),
        _ => Some(()),
    };
    own.and(one_region)
}

fn box_region<C>(region: &BoxRegion, table: &Table<'_>, _: &C) -> Option<()> {
    let BoxRegion { min, max } = region;
    if let Some(i) = (0..3).find(|&i| min[i] > max[i]) {
        let axis = ["x", "y", "z"][i];
        return table.fail("max", format!("is below `min` = {min:?} in {axis}"), "exchange or correct the corners");
    }
    Some(())
}
