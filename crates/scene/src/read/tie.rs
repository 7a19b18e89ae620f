//! Reads `[[tie]]`.

use super::node::Node;
use super::table::Table;
use super::world::{World, surface_reference};
use crate::{Interface, Multipliers, PartKind, Tie, TieForm, split_set};

pub(super) fn tie(table: &Table<'_>, world: &World<'_>) -> Option<Tie> {
    let name = table.optional("name", Node::name);
    let slave = table.required("slave", "slave = \"cap.bottom\"", |n| surface_reference(n, world));
    let master = table.required("master", "master = \"post.top\"", |n| surface_reference(n, world));
    let form = table.default("form", Tie::default_form(), |n| n.choice(TieForm::NAMES, TieForm::from_name));
    let interface =
        table.default("interface", Tie::default_interface(), |n| n.choice(Interface::NAMES, Interface::from_name));
    let multipliers = table.default("multipliers", Tie::default_multipliers(), |n| {
        n.choice(&["standard", "dual"], |name| Multipliers::from_name(name).filter(|m| *m != Multipliers::Centred))
    });
    let reach = table.optional("reach", Node::positive);
    table.finish();
    let (slave, master) = (slave?, master?);
    if slave == master {
        return table.fail("master", "is the slave surface itself", "choose the surface that it is tied to");
    }
    let is_rigid = |set: &str| {
        split_set(set).and_then(|(part, _)| world.part(part)).is_some_and(|part| part.kind == PartKind::Rigid)
    };
    if is_rigid(&slave) && is_rigid(&master) {
        return table.fail(
            "master",
            "belongs to a rigid body, as the slave does",
            "join them by a [[joint]], kind = \"weld\"",
        );
    }
    Some(Tie {
        name: name?,
        slave,
        master,
        form: form?,
        interface: interface?,
        multipliers: multipliers?,
        reach: reach?,
    })
}
