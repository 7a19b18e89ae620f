//! What a scene of plane sections can have.

use super::table::Table;
use super::world::raw;
use crate::{Body, MeshSource, PlaneSection};
use std::collections::BTreeSet;
use toml::de::DeValue;

/// What stands in the whole of space, and not in a section.
const SPATIAL: [&str; 7] = ["beam", "string", "mass", "joint", "spring", "support", "general_contact"];
/// Keys of loads that a section has no place for.
const TURNING: [&str; 2] = ["moment", "angular_velocity"];

/// Reports what does not go with sections, and plane meshes in scenes without one. `held` are the rigid bodies whose motion is prescribed all the time.
pub(super) fn check(
    root: &Table<'_>,
    section: Option<PlaneSection>,
    bodies: &[Option<Body>],
    held: &BTreeSet<String>,
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
    for table in root.tables("load").iter().flatten() {
        for key in TURNING.into_iter().filter(|key| table.has(key)) {
            fail(
                table,
                key,
                "has no place in a scene of plane sections",
                "remove it, or model the whole in space without `section`",
            );
        }
    }
    good
}
