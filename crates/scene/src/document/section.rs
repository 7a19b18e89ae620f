//! What a scene of plane sections can have.

use crate::read::Table;
use crate::world::raw;
use crate::{Body, Component, Gravity, Header, Kind, Load, MeshSource, PlaneSection, Prescribe, Series};
use std::collections::BTreeSet;
use toml::de::DeValue;

/// What stands in the whole of space, and not in a section.
const SPATIAL: [&str; 7] = ["beam", "string", "joint", "spring", "support", "coupling", "general_contact"];

/// What was read of the scene.
pub(crate) struct Content<'a> {
    pub bodies: &'a [Option<Body>],
    /// The rigid bodies whose motion is prescribed all the time.
    pub held: &'a BTreeSet<String>,
    pub loads: &'a [Option<Load>],
    pub prescriptions: &'a [Option<Prescribe>],
}

/// Whether a value of a series is along an axis that has none.
fn leaves(series: &Series, across: [bool; 3]) -> bool {
    series.columns() == 3
        && series.rows().iter().any(|row| (0..3).any(|i| across[i] && row.get(i + 1).is_some_and(|v| *v != 0.0)))
}

/// Reports what does not go with sections and planes of symmetry, and plane meshes in scenes without a section.
pub(crate) fn check(root: &Table<'_>, header: &Header, gravity: Option<&Gravity>, content: &Content<'_>) -> Option<()> {
    let Content { bodies, held, loads, prescriptions } = *content;
    let (kind, section) = (header.kind, header.section);
    let mut good = Some(());
    let mut fail = |table: &Table<'_>, key, message: &str, remedy: &str| {
        let failed: Option<()> = table.fail(key, message, remedy);
        good = failed;
    };
    for (table, body) in root.tables("body").iter().zip(bodies) {
        let (Some(table), Some(body)) = (table, body) else { continue };
        match (section, &body.mesh) {
            (Some(_), MeshSource::Generator(generator)) if !generator.is_plane() => {
                fail(
                    table,
                    "mesh",
                    "is a solid, and the scene has a `section`",
                    "take the generator `rectangle` or `disc`, or a file of plane elements",
                );
            }
            (None, MeshSource::Generator(generator)) if generator.is_plane() => {
                fail(
                    table,
                    "mesh",
                    "is plane",
                    "say in [scene] what it is a `section` of, or take a solid: `block`, `cylinder`",
                );
            }
            _ => {}
        }
        if section.is_some() && body.rotation.as_slice().iter().any(|turn| turn.axis[..2] != [0.0; 2]) {
            fail(table, "rotation", "turns the section out of its plane", "turn about the axis [0, 0, 1]");
        }
        if section.is_some() && body.position[2] != 0.0 {
            fail(table, "position", "moves the section out of its plane", "write 0 for z");
        }
    }
    let is_ring = section == Some(PlaneSection::Axisymmetric);
    // Along these axes the model is the same everywhere, or mirrored, and loads along them are balanced by others or by nothing.
    let mut across = [is_ring, false, section.is_some()];
    header.symmetry.as_slice().iter().for_each(|axis| across[axis.index()] = true);
    if gravity.is_some_and(|gravity| (0..3).any(|i| across[i] && gravity.acceleration[i] != 0.0)) {
        fail(root, "gravity", "has a component along which the model is a section or mirrored", "write 0 for it");
    }
    if section.is_none() {
        return good;
    }
    for (table, body) in root.tables("body").iter().zip(bodies) {
        let (Some(table), Some(body)) = (table, body) else { continue };
        if body.velocity[2] != 0.0 || (is_ring && body.velocity[0] != 0.0) {
            fail(table, "velocity", "leads out of the section", "write 0 for z, and for x of a body of revolution");
        }
        if (0..3).any(|i| body.angular_velocity[i] != 0.0 && (is_ring || i != 2)) {
            fail(table, "angular_velocity", "leads out of the section", "remove it");
        }
    }
    for (table, prescribe) in root.tables("prescribe").iter().zip(prescriptions) {
        let (Some(table), Some(prescribe)) = (table, prescribe) else { continue };
        let of_z = prescribe.components.iter().position(|component| *component == Component::Z);
        let moves = |k: usize| prescribe.rows().iter().any(|row| row.get(k + 1).is_some_and(|value| *value != 0.0));
        if of_z.is_some_and(moves)
            || prescribe.translation.as_ref().is_some_and(|series| leaves(series, [false, false, true]))
        {
            fail(table, "components", "moves out of the section along z", "leave z out");
        }
        if prescribe.rotation.as_ref().is_some_and(|rotation| is_ring || rotation.axis[..2] != [0.0; 2]) {
            fail(table, "rotation", "turns out of the section", "turn about z, in sections of plates and long bodies");
        }
    }
    for key in SPATIAL.into_iter().filter(|key| root.has(key)) {
        fail(
            root,
            key,
            "has no place in a scene of plane sections",
            "remove it, or model the whole in space without `section`",
        );
    }
    if kind != Kind::QuasiStatic && root.has("mass") {
        fail(
            root,
            "mass",
            "has no place in the motion of plane sections",
            "remove it, or model the whole in space without `section`",
        );
    }
    for table in root.tables("rigid").iter().flatten() {
        let is_fixed = table.get("fixed").is_some_and(|node| matches!(node.value, DeValue::Boolean(true)));
        if !is_fixed && !raw(table, "name").is_some_and(|name| held.contains(&name)) {
            fail(
                table,
                "fixed",
                "a rigid body of a scene of plane sections is a tool, whose motion is prescribed",
                "prescribe its motion, or write `fixed = true`",
            );
        }
    }
    let along = if is_ring { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    for (table, load) in root.tables("load").iter().zip(loads) {
        let (Some(table), Some(load)) = (table, load) else { continue };
        if table.has("moment") {
            fail(
                table,
                "moment",
                "has no place in a scene of plane sections",
                "remove it, or model the whole in space without `section`",
            );
        }
        // Around a ring tractions along its radius are in balance.
        if load.kind().is_some_and(|(_, series)| leaves(series, [false, false, true])) {
            fail(table, "set", "has a component out of the section", "write 0 for z");
        }
        let is_off = |axis: &[f64; 3]| (0..3).any(|i| along[i] == 0.0 && axis[i] != 0.0);
        if table.has("angular_velocity") && load.axis.as_ref().is_some_and(is_off) {
            fail(table, "axis", "is not that of the section", "a body of revolution turns about y, all else about z");
        }
    }
    good
}
