//! Reads `[[body]]`.

use super::node::Node;
use super::table::Table;
use super::world::Setting;
use super::{material, mesh};
use crate::{Body, Cell, Damping, Integration, Mass, Rotation, Rotations, RoundShape, RoundSurface, Volumetric};
use toml::de::DeValue;

/// Keys that have a meaning only with inertia.
const MOTION: [&str; 5] = ["velocity", "angular_velocity", "velocity_gradient", "velocity_about", "damping"];

/// The body and its name, which is needed even if the rest is bad.
pub(super) fn body(table: &Table<'_>, setting: Setting, own_laws: &[&str]) -> (Option<Body>, Option<String>) {
    let name = table.required("name", "name = \"ball\"", Node::name);
    let mesh =
        table.required("mesh", "mesh = { generator = \"block\", size = [1, 1, 1], divisions = [4, 4, 4] }", mesh::mesh);
    let position = table.default("position", [0.0; 3], Node::vector);
    let rotation = table.default("rotation", Rotations::default(), rotations);
    let cell = table.optional("cell", |n| n.choice(&Cell::names().collect::<Vec<_>>(), Cell::from_name));
    let round = table.default("round", Vec::new(), |n| n.list(round_surface));
    let integration =
        table.default("integration", Integration::Full, |n| n.choice(Integration::NAMES, Integration::from_name));
    let volumetric = table.optional("volumetric", |n| n.choice(Volumetric::NAMES, Volumetric::from_name));
    let material =
        table.required("material", "material = { law = \"neo-hooke\", young = 2250.0, poisson = 0.3 }", |n| {
            material::material(n, own_laws)
        });
    let density = setting.mass(table, "density", "density = 10.0");
    let mass = table.default("mass", Mass::Consistent, |n| n.choice(Mass::NAMES, Mass::from_name));
    let velocity = table.default("velocity", [0.0; 3], Node::vector);
    let angular_velocity = table.default("angular_velocity", [0.0; 3], Node::vector);
    let velocity_gradient = table.default("velocity_gradient", [[0.0; 3]; 3], |n| n.array(Node::vector));
    let velocity_about = table.default("velocity_about", [0.0; 3], Node::vector);
    let damping = table.optional("damping", damping);
    let at_rest = setting.at_rest(table, &MOTION);
    table.finish();
    let body = (|| {
        at_rest?;
        Some(Body {
            name: name.clone()?,
            mesh: mesh?,
            position: position?,
            rotation: rotation?,
            cell: cell?,
            round: round?,
            integration: integration?,
            volumetric: volumetric?,
            material: material?,
            density: density?,
            mass: mass?,
            damping: damping?,
            velocity: velocity?,
            angular_velocity: angular_velocity?,
            velocity_gradient: velocity_gradient?,
            velocity_about: velocity_about?,
        })
    })();
    (body, name)
}

fn round_surface(node: &Node<'_>) -> Option<RoundSurface> {
    let table = node.table_like("{ set = \"outer\", surface = \"cylinder\" }")?;
    let set = table.required("set", "set = \"outer\"", Node::text);
    let surface =
        table.required("surface", "surface = \"cylinder\"", |n| n.choice(RoundShape::NAMES, RoundShape::from_name));
    table.finish();
    Some(RoundSurface { set: set?, surface: surface? })
}

fn damping(node: &Node<'_>) -> Option<Damping> {
    let table = node.table_like("{ mass = 0.1, stiffness = 1e-4 }")?;
    let mass = table.default("mass", 0.0, Node::not_negative);
    let stiffness = table.default("stiffness", 0.0, Node::not_negative);
    table.finish();
    let damping = Damping { mass: mass?, stiffness: stiffness? };
    if damping == Damping::default() {
        return node
            .fail("has only factors of zero", "write { mass = 0.1, stiffness = 1e-4 } or one of them, or remove it");
    }
    Some(damping)
}

pub(super) fn rotations(node: &Node<'_>) -> Option<Rotations> {
    match node.value {
        DeValue::Array(_) => node.list(rotation).map(Rotations::Many),
        _ => rotation(node).map(Rotations::One),
    }
}

fn rotation(node: &Node<'_>) -> Option<Rotation> {
    let table = node.table()?;
    let axis = table.required("axis", "axis = [0, 0, 1]", Node::direction);
    let degrees = table.required("degrees", "degrees = 90", Node::number);
    let about = table.default("about", [0.0; 3], Node::vector);
    table.finish();
    Some(Rotation { axis: axis?, degrees: degrees?, about: about? })
}
