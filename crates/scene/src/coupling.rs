//! Kinematic and distributing coupling of sets of deformable bodies to a reference point; `[[coupling]]`.

use crate::names::named;
use crate::read::Node;
use crate::world::{World, part_name, set_reference};
use crate::{PartKind, split_set};
use stoss_scene_derive::table;

named! {
    /// Coupling of a set of a deformable body to its reference point.
    Coupling {
        /// Kinematic coupling: the set moves as a rigid body with the reference point.
        Kinematic = "kinematic",
        /// Distributing coupling: the reference point follows the mean motion of the set, which can deform freely.
        Distributing = "distributing",
    }
}

/// `[[coupling]]`: nodes of a deformable body that move with a rigid body, or in whose mean it moves. Loads, prescribed motions and joints of the rigid body then act on the nodes. It needs neither mass
/// nor surface: its `position` is the reference point.
///
/// ```toml
/// [[rigid]]
/// name = "hub"
/// position = [0.0, 0.0, 0.5]
///
/// [[coupling]]
/// name = "grip"
/// kind = "distributing"
/// set = "plate.hole"
/// rigid = "hub"
/// ```
#[table(context(World<'_>))]
pub struct SetCoupling {
    /// Unique name.
    #[key(example = "\"hub\"", name)]
    pub name: String,
    /// Kind of the coupling.
    #[key(example = "\"kinematic\"")]
    pub kind: Coupling,
    /// Set of a deformable body, `body.set`. A distributing coupling needs three nodes that are not on a line.
    #[key(example = "\"plate.hole\"", by = coupled_set)]
    pub set: String,
    /// Name of the rigid body.
    #[key(example = "\"hub\"", by = reference_body)]
    pub rigid: String,
}

fn coupled_set(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    match split_set(&text).and_then(|(part, _)| world.part(part)) {
        Some(part) if part.kind != PartKind::Body => node.fail(
            format!("is a set of {}: a coupling takes nodes of deformable bodies", part.kind.noun()),
            "use a [[joint]] between such parts",
        ),
        _ => Some(text),
    }
}

fn reference_body(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = part_name(node, world)?;
    match world.part(&name) {
        Some(part) if part.kind != PartKind::Rigid => node.fail(
            format!("is {}, not a rigid body", part.kind.noun()),
            "name a [[rigid]]; it needs neither mass nor surface",
        ),
        _ => Some(name),
    }
}
