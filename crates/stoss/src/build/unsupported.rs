//! Tables of the scene format that this build of the program cannot simulate.

use crate::scene::{Problem, Scene};

/// One problem that names the scene's tables that need the feature `multibody`, at the first of them; `None` if there are none, or it is built in.
pub(super) fn unsupported(scene: &Scene) -> Option<Problem> {
    if cfg!(feature = "multibody") {
        return None;
    }
    let tables = [
        ("rigid[0]", "[[rigid]]", scene.rigids.is_empty()),
        ("beam[0]", "[[beam]]", scene.beams.is_empty()),
        ("string[0]", "[[string]]", scene.strings.is_empty()),
        ("mass[0]", "[[mass]]", scene.masses.is_empty()),
        ("joint[0]", "[[joint]]", scene.joints.is_empty()),
        ("support[0]", "[[support]]", scene.supports.is_empty()),
        ("spring[0]", "[[spring]]", scene.springs.is_empty()),
    ];
    let found: Vec<_> = tables.into_iter().filter(|&(_, _, empty)| !empty).collect();
    let &(key, ..) = found.first()?;
    let names: Vec<&str> = found.iter().map(|&(_, name, _)| name).collect();
    let message = format!("this build of Stoss has no multibody systems, thus no {}", names.join(", "));
    Some(Problem::at(scene, key, "", message, "build it with the cargo feature `multibody`"))
}
