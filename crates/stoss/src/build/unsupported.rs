//! Tables of the scene format that this build of the program cannot simulate.

use crate::scene::{FrameFormat, LinearSolver, Problem, Scene};

/// Message of a program without the feature `mpi`.
#[cfg_attr(feature = "mpi", allow(dead_code, reason = "of a program that has it"))]
pub(super) const NO_PETSC: &str = "this build of Stoss has no PETSc";

/// The first table or key that needs a feature which is not built in.
pub(super) fn unsupported(scene: &Scene) -> Option<Problem> {
    multibody(scene).or_else(|| vtkhdf(scene)).or_else(|| general(scene)).or_else(|| petsc(scene))
}

/// The solver PETSc needs the feature `mpi`.
fn petsc(scene: &Scene) -> Option<Problem> {
    (scene.solver.linear == LinearSolver::Petsc && !cfg!(feature = "mpi")).then(|| {
        let remedy = "build it with the cargo feature `mpi` (docs/guide/clusters.md), or choose linear = \"auto\"";
        Problem::at(scene, "solver.linear", "petsc", NO_PETSC, remedy)
    })
}

/// General contact needs the feature `general`.
fn general(scene: &Scene) -> Option<Problem> {
    let is_wanted = scene.general_contact.as_ref().is_some_and(|table| table.enabled);
    (is_wanted && !cfg!(feature = "general")).then(|| {
        let message = "this build of Stoss has no general contact";
        Problem::at(scene, "general_contact", "", message, "build it with the cargo feature `general`")
    })
}

/// Frames in a format that needs the feature `vtkhdf`, where files of results are built in at all.
fn vtkhdf(scene: &Scene) -> Option<Problem> {
    let is_wanted = cfg!(feature = "output") && scene.output.format == FrameFormat::Vtkhdf;
    (is_wanted && !cfg!(feature = "vtkhdf")).then(|| {
        let remedy = "build it with the cargo feature `vtkhdf`, or choose format = \"vtu\"";
        Problem::at(scene, "output.format", "vtkhdf", "this build of Stoss has no VTKHDF", remedy)
    })
}

/// One problem that names the scene's tables that need the feature `multibody`, at the first of them; `None` if there are none, or it is built in.
fn multibody(scene: &Scene) -> Option<Problem> {
    if cfg!(feature = "multibody") {
        return None;
    }
    let tables = [
        ("rigid[0]", "[[rigid]]", scene.rigids.is_empty()),
        ("beam[0]", "[[beam]]", scene.beams.is_empty()),
        ("string[0]", "[[string]]", scene.strings.is_empty()),
        ("mass[0]", "[[mass]]", scene.masses.is_empty()),
        ("joint[0]", "[[joint]]", scene.joints.is_empty()),
        ("coupling[0]", "[[coupling]]", scene.couplings.is_empty()),
        ("equation[0]", "[[equation]]", scene.equations.is_empty()),
        ("support[0]", "[[support]]", scene.supports.is_empty()),
        ("spring[0]", "[[spring]]", scene.springs.is_empty()),
        ("load", "`moment` of [[load]]", scene.loads.iter().all(|load| load.moment.is_none())),
    ];
    let found: Vec<_> = tables.into_iter().filter(|&(_, _, empty)| !empty).collect();
    let &(key, ..) = found.first()?;
    let names: Vec<&str> = found.iter().map(|&(_, name, _)| name).collect();
    let message = format!("this build of Stoss has no multibody systems, thus no {}", names.join(", "));
    Some(Problem::at(scene, key, "", message, "build it with the cargo feature `multibody`"))
}

#[cfg(not(feature = "multibody"))]
#[cfg(test)]
mod tests {
    use crate::build::build;
    use crate::scene::parse;
    use std::path::Path;

    /// Each table alone is refused at its place, with the feature as the remedy; a scene without them is not.
    #[test]
    fn tables_of_multibody_systems_are_refused_where_it_is_not_built_in() {
        let head = "[scene]\ntitle = \"none\"\nkind = \"dynamic\"\n[time]\nend = 1.0\nstep = 0.1\nintegrator = { scheme = \"energy-momentum\" }\n";
        let body = "[[body]]\nname = \"l\"\nmesh = { generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }\nmaterial = { law = \"neo-hooke\", \
             young = 100.0, poisson = 0.3 }\ndensity = 1.0\n";
        let tables = [
            ("rigid", "name = \"a\"\nmass = 1.0\neuler = [1, 1, 1]\ncentre = [0, 0, 0]\n"),
            (
                "beam",
                "name = \"a\"\npoints = [[0, 0, 0], [1, 0, 0]]\nelements = 2\nup = [0, 1, 0]\nsection = { shape = \"rectangle\", size = [0.02, 0.05] }\nyoung = 1.0\npoisson = 0.3\n\
                 density = 1.0\n",
            ),
            ("string", "name = \"a\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nelements = 2\naxial = 1.0\nmass = 1.0\n"),
            ("mass", "name = \"a\"\nat = [0, 0, 0]\nmass = 1.0\n"),
            ("joint", "name = \"a\"\nkind = \"ball\"\nbetween = [\"ground\", \"l.left\"]\nat = [0, 0, 0]\n"),
            (
                "spring",
                "name = \"a\"\nbetween = [\"ground\", \"l.left\"]\nat = [[-1, 0, 0], [0, 0, 0]]\nstiffness = 1.0\n",
            ),
        ];
        for (name, keys) in tables {
            let text = format!("{head}{body}[[{name}]]\n{keys}");
            let scene = parse(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
            let message = build(&scene, Path::new(".")).map(|_| ()).unwrap_err().to_string();
            for part in [&format!("{name}[0]"), &format!("no [[{name}]]"), "cargo feature `multibody`"] {
                assert!(message.contains(part), "{name}: {message}");
            }
        }
        let scene = parse(&format!("{head}{body}"), "test.toml").unwrap_or_else(|e| panic!("{e}"));
        assert!(build(&scene, Path::new(".")).is_ok());
    }
}
