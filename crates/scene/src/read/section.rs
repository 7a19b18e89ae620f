//! What a scene of plane sections can have.

use super::table::Table;
use super::world::raw;
use crate::{Body, Kind, Load, MeshSource, PlaneSection};
use std::collections::BTreeSet;
use toml::de::DeValue;

/// What stands in the whole of space, and not in a section.
const SPATIAL: [&str; 7] = ["beam", "string", "joint", "spring", "support", "coupling", "general_contact"];

/// Reports what does not go with sections, and plane meshes in scenes without one. `held` are the rigid bodies whose motion is prescribed all the time.
pub(super) fn check(
    root: &Table<'_>,
    kind: Option<Kind>,
    section: Option<PlaneSection>,
    bodies: &[Option<Body>],
    held: &BTreeSet<String>,
    loads: &[Option<Load>],
) -> Option<()> {
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
    if section.is_none() {
        return good;
    }
    for key in SPATIAL.into_iter().filter(|key| root.has(key)) {
        fail(
            root,
            key,
            "has no place in a scene of plane sections",
            "remove it, or model the whole in space without `section`",
        );
    }
    if kind != Some(Kind::QuasiStatic) && root.has("mass") {
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
    let along = if section == Some(PlaneSection::Axisymmetric) { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
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
        let is_off = |axis: &[f64; 3]| (0..3).any(|i| along[i] == 0.0 && axis[i] != 0.0);
        if table.has("angular_velocity") && load.axis.as_ref().is_some_and(is_off) {
            fail(table, "axis", "is not that of the section", "a body of revolution turns about y, all else about z");
        }
    }
    good
}
