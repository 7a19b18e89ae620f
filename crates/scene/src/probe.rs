//! `[[probe]]`: quantities of a run as columns of a table.

use crate::chosen::of_which;
use crate::joint::slides;
use crate::read::{Node, Table, Value, is_name};
use crate::spelling::known;
use crate::world::{KnownProbe, World, part_name, raw, set_reference};
use crate::{Extremum, Kind, PartKind, ProbeComponent, Quantity};
use stoss_multibody::{CoordinateKind, JointEntry};
use stoss_scene_derive::table;

/// `[[probe]]`: a quantity that is written to `probes.csv`, a column for each component. Nodal quantities need `set`, or `body` and `point`, or a rigid body or point mass as `body`; energies
/// and momenta are those of `body`, or of the whole model; quantities of joints need `joint`, of equations `equation`; stresses and strains need `body` and `point`. With `reduce` the probe records the
/// extremum over the nodes of `set` or `body`, and a second column `name.node` has the number of that node in the frames.
///
/// ```toml
/// [[probe]]
/// name = "bearing"
/// quantity = "joint_force"
/// joint = "elbow"
/// ```
#[table(context(World<'_>), check = place)]
pub struct Probe {
    /// Unique name: the heading of its columns.
    #[key(example = "\"tip\"", name)]
    pub name: String,
    /// Quantity that is recorded.
    #[key(example = "\"displacement\"", with = quantity)]
    pub quantity: Quantity,
    /// Set of nodes, `part.set`.
    #[key(by = set_reference)]
    pub set: Option<String>,
    /// Name of a part. The motion of a rigid body without a `point` is that of its centre of mass.
    #[key(by = part_name)]
    pub body: Option<String>,
    /// A point in the reference configuration after placement (three lengths): the nearest node of `body` is probed, or of a rigid body the point itself; for stresses and strains the
    /// material point, which must lie in the body.
    #[key(dimension = Length)]
    pub point: Option<[f64; 3]>,
    /// Name of a joint.
    #[key(with = |node, world, keys| joint(node, keys.quantity, world))]
    pub joint: Option<String>,
    /// Name of an equation.
    #[key(by = equation)]
    pub equation: Option<String>,
    /// Records the extremum over the nodes of `set` or `body`: `max` or `min`. The mean or sum of the quantity if left out.
    #[key(with = |node, world, keys| extremum(node, world, keys.quantity))]
    pub reduce: Option<Extremum>,
    /// Component whose extremum is recorded. If left out it is the magnitude of a vector, and of strains and principal stresses the largest (`max`) or smallest
    /// (`min`) principal value. With `reduce` only.
    #[key(with = reduced_component)]
    pub component: Option<ProbeComponent>,
}

impl Probe {
    /// Names of the components of its values, empty for one value.
    pub fn components(&self) -> &'static [ProbeComponent] {
        if self.reduce.is_some() { &[] } else { self.quantity.components() }
    }
}

/// The probe, and its name with the components of its values, which `[expect]` needs even if the rest is bad.
pub(crate) fn probe(table: &Table<'_>, world: &World<'_>) -> (Option<Probe>, Option<KnownProbe>) {
    let probe = Probe::from_table(table, world);
    let components = if table.has("reduce") {
        Some(&[][..])
    } else {
        raw(table, "quantity").and_then(|name| Quantity::from_name(&name)).map(Quantity::components)
    };
    (probe, raw(table, "name").filter(|name| is_name(name)).map(|name| (name, components)))
}

fn quantity(node: &Node<'_>, world: &World<'_>, _: &ProbeKeys) -> Option<Quantity> {
    let quantity = Quantity::read(node, world)?;
    if quantity.is_dynamic() && world.kind == Some(Kind::QuasiStatic) {
        return node.fail("needs inertia", "choose another quantity, or set [scene] kind = \"dynamic\"");
    }
    if matches!(quantity, Quantity::ContactForce | Quantity::ContactMoment)
        && !world.has_contact
        && !world.has_general_contact
        && !world.has_tie
    {
        return node.fail("needs contact, and the scene has none", "add a [[contact]] or choose another quantity");
    }
    if matches!(quantity, Quantity::Reaction | Quantity::ReactionMoment) && !world.has_prescribed {
        let remedy = if world.has_elastic_support && quantity == Quantity::Reaction {
            "choose `support_force`, the force of [[support]], or add a [[prescribe]]"
        } else {
            "add a [[prescribe]] or choose another quantity"
        };
        return node.fail("needs prescribed motion, and the scene has none", remedy);
    }
    if quantity == Quantity::SupportForce && !world.has_elastic_support {
        return node.fail(
            "needs an elastic support, and the scene has none",
            "add a [[support]], or choose `reaction` for the forces of [[prescribe]]",
        );
    }
    Some(quantity)
}

fn extremum(node: &Node<'_>, world: &World<'_>, quantity: Option<Quantity>) -> Option<Extremum> {
    let reduce = Extremum::read(node, world)?;
    match quantity {
        Some(quantity) if !quantity.has_extrema() => {
            let names = Quantity::NAMES.iter().copied();
            let names = names.filter(|name| Quantity::from_name(name).is_some_and(Quantity::has_extrema));
            let list = names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            node.fail(format!("`{quantity}` has no value at each node"), format!("extrema are available of {list}"))
        }
        _ => Some(reduce),
    }
}

/// Component of an extremum.
fn reduced_component(node: &Node<'_>, _: &World<'_>, keys: &ProbeKeys) -> Option<ProbeComponent> {
    if matches!(keys.reduce, Some(None)) {
        return node.fail("is for extrema: the columns of all components are there", "remove it, or add `reduce`");
    }
    match keys.quantity.map(Quantity::components) {
        None => node.choice(ProbeComponent::NAMES, ProbeComponent::from_name),
        Some([]) => node.fail("the quantity has a single value", "remove it"),
        Some(all) => component_of(node, all),
    }
}

fn component_of(node: &Node<'_>, all: &[ProbeComponent]) -> Option<ProbeComponent> {
    let names: Vec<&str> = all.iter().map(|component| component.name()).collect();
    node.choice(&names, |name| ProbeComponent::from_name(name).filter(|component| all.contains(component)))
}

/// Reports a component that is needed: positions and stresses have no length.
fn has_component(table: &Table<'_>, quantity: Option<Quantity>) -> Option<()> {
    let needed = matches!(quantity, Some(Quantity::Position | Quantity::CauchyStress));
    if needed && table.has("reduce") && !table.has("component") {
        let first = quantity.and_then(|quantity| quantity.components().last()).map_or("z", |last| last.name());
        return table.missing("component", &format!("component = \"{first}\""));
    }
    Some(())
}

/// Reports what a quantity cannot be of.
fn place(keys: &ProbeKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let quantity = keys.quantity;
    let component = has_component(table, quantity);
    let part = keys.body.as_ref().and_then(Option::as_deref).and_then(|name| world.part(name)).map(|part| part.kind);
    let place = match quantity {
        // Reported already.
        Some(quantity) if table.has("reduce") && !quantity.has_extrema() => Some(()),
        Some(quantity) if table.has("reduce") => extremum_place(table, quantity, part),
        Some(quantity) if quantity.is_of_material() => material_place(table, quantity, part),
        Some(quantity) if quantity.is_of_equation() => {
            let keys = ["set", "body", "point", "joint"];
            let place = refuse(table, &keys, || format!("`{quantity}` belongs to an equation"));
            if table.has("equation") { place } else { table.missing("equation", "equation = \"lever\"") }
        }
        Some(quantity) if quantity.is_of_joint() => {
            let place = refuse(table, &["set", "body", "point"], || format!("`{quantity}` belongs to a joint"));
            if table.has("joint") { place } else { table.missing("joint", "joint = \"elbow\"") }
        }
        Some(quantity) => {
            let joint = refuse(table, &["joint"], || format!("`{quantity}` does not belong to a joint"));
            let place = match quantity {
                Quantity::AngularVelocity => rigid_place(table, part),
                quantity if quantity.is_nodal() => nodal_place(table, quantity, part),
                _ => refuse(table, &["set", "point"], || format!("`{quantity}` belongs to a body or to everything")),
            };
            joint.and(place)
        }
        None => Some(()),
    };
    let of_equation = match quantity {
        Some(quantity) if !quantity.is_of_equation() => {
            refuse(table, &["equation"], || format!("`{quantity}` does not belong to an equation"))
        }
        _ => Some(()),
    };
    component.and(place).and(of_equation)
}

/// Reports keys that the quantity does not have.
fn refuse(table: &Table<'_>, keys: &[&'static str], message: impl Fn() -> String) -> Option<()> {
    let mut good = Some(());
    for key in keys.iter().copied().filter(|&key| table.has(key)) {
        good = table.fail(key, message(), "remove it; name a `body` if it is not for everything");
    }
    good
}

fn joint(node: &Node<'_>, quantity: Option<Quantity>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    match world.joints.iter().find(|(joint, _)| *joint == name) {
        Some((_, Some(kind)))
            if quantity == Some(Quantity::JointAngle) && kind.coordinates.first() != Some(&CoordinateKind::Angle) =>
        {
            node.fail(
                format!("is a joint `{}`, which has no angle", kind.name),
                format!(
                    "choose one of the kinds {}",
                    of_which::<JointEntry>(|kind| kind.coordinates.first() == Some(&CoordinateKind::Angle))
                ),
            )
        }
        Some((_, Some(kind))) if quantity == Some(Quantity::JointDisplacement) && !slides(kind) => node.fail(
            format!("is a joint `{}`, for whose displacement there is no probe", kind.name),
            format!("choose one of the kinds {}; a second coordinate is in joints.csv", of_which(slides)),
        ),
        Some(_) => Some(name),
        None if !world.actions_complete => Some(name),
        None if world.joints.is_empty() => node.fail("the scene has no joint", "add a [[joint]] of this name"),
        None => {
            node.fail("is not a joint of this scene", known(&name, world.joints.iter().map(|(name, _)| name.as_str())))
        }
    }
}

fn equation(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    if world.equations.contains(&name) || !world.actions_complete {
        return Some(name);
    }
    if world.equations.is_empty() {
        return node.fail("the scene has no equation", "add an [[equation]] of this name");
    }
    node.fail("is not an equation of this scene", known(&name, world.equations.iter().map(String::as_str)))
}

/// The place of an extremum: the nodes of a set, or of a part.
fn extremum_place(table: &Table<'_>, quantity: Quantity, part: Option<PartKind>) -> Option<()> {
    for key in ["point", "joint"] {
        if table.has(key) {
            return table.fail(key, "an extremum belongs to a set or a body", "remove it");
        }
    }
    match (table.has("set"), table.has("body")) {
        (true, true) => table.fail("body", "the set names its body already", "remove it"),
        (false, false) => table.missing("body", "body = \"ball\"` or `set = \"ball.outer\""),
        _ => match part {
            Some(kind) if quantity.is_of_material() && kind != PartKind::Body => {
                let message = format!("is {}: `{quantity}` belongs to a deformable body", kind.noun());
                table.fail("body", message, "name a deformable body")
            }
            _ => Some(()),
        },
    }
}

/// The place of a stress or strain: a point of a deformable body.
fn material_place(table: &Table<'_>, quantity: Quantity, part: Option<PartKind>) -> Option<()> {
    for key in ["set", "joint"] {
        if table.has(key) {
            let remedy = "write `body` and `point`, or `reduce = \"max\"` for the largest value of a set";
            return table.fail(key, format!("`{quantity}` belongs to a point of a body"), remedy);
        }
    }
    if !table.has("body") {
        return table.missing("body", "body = \"plate\"");
    }
    match part {
        Some(kind) if kind != PartKind::Body => {
            let message = format!("is {}: `{quantity}` belongs to a deformable body", kind.noun());
            table.fail("body", message, "name a deformable body")
        }
        _ if !table.has("point") => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        _ => Some(()),
    }
}

/// The place of an angular velocity: a rigid body, of this kind if it is known.
fn rigid_place(table: &Table<'_>, part: Option<PartKind>) -> Option<()> {
    let place = refuse(table, &["set", "point"], || "an angular velocity belongs to a rigid body".to_owned());
    match part {
        Some(kind) if kind != PartKind::Rigid => {
            table.fail("body", format!("is {}, not a rigid body", kind.noun()), "name a rigid body")
        }
        None if !table.has("body") => table.missing("body", "body = \"wheel\""),
        _ => place,
    }
}

/// The place of a quantity of nodes. `part`: the kind of the part that `body` names, if it is known.
fn nodal_place(table: &Table<'_>, quantity: Quantity, part: Option<PartKind>) -> Option<()> {
    if let (Some(kind @ (PartKind::Rigid | PartKind::Mass)), false) = (part, table.has("set")) {
        let at_points = matches!(quantity, Quantity::Displacement | Quantity::Position | Quantity::Velocity);
        if table.has("point") && !(kind == PartKind::Rigid && at_points) {
            return table.fail(
                "point",
                format!("`{quantity}` of {} is a quantity of the whole part", kind.noun()),
                "remove the point",
            );
        }
        return Some(());
    }
    match (table.has("set"), table.has("body"), table.has("point")) {
        (true, false, false) | (false, true, true) => Some(()),
        (true, _, true) => table.fail("point", "a probe has either a set or a point", "remove one of them"),
        (true, true, false) => table.fail("body", "the set names its body already", "remove it"),
        (false, false, true) => table.missing("body", "body = \"plate\""),
        // An unknown part may be a rigid body.
        (false, true, false) if part.is_none() => Some(()),
        (false, true, false) => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        (false, false, false) => {
            table.missing("set", "set = \"ball.outer\"` or `body = \"ball\"` with `point = [x, y, z]")
        }
    }
}

/// The name of a probe of this scene.
pub(crate) fn probe_of(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    if world.probes_complete && !world.probes.iter().any(|(probe, _)| *probe == name) {
        if world.probes.is_empty() {
            return node.fail("the scene has no probe", "add a [[probe]] of this name");
        }
        return node
            .fail("is not a probe of this scene", known(&name, world.probes.iter().map(|(probe, _)| probe.as_str())));
    }
    Some(name)
}

/// A component of a probe, if its quantity has any.
pub(crate) fn probe_component(node: &Node<'_>, world: &World<'_>, probe: Option<&str>) -> Option<ProbeComponent> {
    match world.components(probe) {
        Some([]) => node.fail("the quantity has a single value", "remove it"),
        Some(all) => component_of(node, all),
        None => ProbeComponent::read(node, world),
    }
}

/// Reports that a component is needed: there is one if and only if the probe has several values.
pub(crate) fn component_fits(table: &Table<'_>, world: &World<'_>, probe: Option<&str>) -> Option<()> {
    match (world.components(probe), table.has("component")) {
        (Some([.., last]), false) => table.missing("component", &format!("component = \"{last}\"")),
        _ => Some(()),
    }
}
