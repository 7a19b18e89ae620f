//! Simulations from scenes that are written in a test.

pub mod units;

use std::path::Path;
use stoss::build::build;
use stoss::solver::Simulation;

/// The simulation of a scene; mesh files are relative to `folder`.
pub fn simulation_in(text: &str, folder: &Path) -> Simulation {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, folder).unwrap_or_else(|e| panic!("{e}")).simulation
}

/// The simulation of a scene without mesh files.
pub fn simulation(text: &str) -> Simulation {
    simulation_in(text, Path::new("."))
}

/// Keys of the problems for which a scene is refused, when it is read or when it is built, in the order of the file.
pub fn problem_keys(text: &str) -> Vec<String> {
    let errors = match stoss::scene::parse(text, "test.toml") {
        Err(errors) => errors,
        Ok(scene) => match build(&scene, Path::new(".")) {
            Err(errors) => errors,
            Ok(_) => panic!("accepted: {text}"),
        },
    };
    errors.problems().iter().map(|problem| problem.key.clone()).collect()
}

/// Scene of the two hexahedra of the thesis's Table 6.2 (theory/examples#two-elements): the upper one falls on the lower one and slides on it. `moved` is
/// added to the position of the upper one; `contact` are the keys of the contact but for its surfaces.
pub fn two_blocks(scheme: &str, step: f64, end: f64, moved: [f64; 3], contact: &str) -> String {
    format!(
        r#"
[scene]
title = "two blocks"
kind = "dynamic"
[time]
end = {end:?}
step = {step:?}
integrator = {{ scheme = "{scheme}" }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [-0.5, -1.0, 1.1], max = [0.5, 0.0, 2.1], divisions = [1, 1, 1] }}
position = {moved:?}
material = {{ law = "neo-hooke", lambda = 1298.1, mu = 865.3846 }}
density = 1000.0
velocity = [0.0, 0.1, -0.04]
[[body]]
name = "lower"
material = {{ law = "neo-hooke", lambda = 1298.1, mu = 865.3846 }}
density = 1000.0
[body.mesh]
generator = "hexahedron"
divisions = [1, 1, 1]
corners = [
    [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.2, 1.0, 0.0], [-1.5, 1.5, 0.0],
    [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.2, 1.0, 1.0], [-1.5, 1.5, 1.0],
]
[[contact]]
slave = "upper.bottom"
master = "lower.top"
{contact}
"#
    )
}

/// Largest distance of `values` from the first one, divided by the largest norm.
pub fn drift(values: &[[f64; 3]]) -> f64 {
    let norm = |a: [f64; 3]| a[0].hypot(a[1]).hypot(a[2]);
    let scale = values.iter().map(|v| norm(*v)).fold(0.0, f64::max);
    let far = values.iter().map(|v| norm(std::array::from_fn(|i| v[i] - values[0][i]))).fold(0.0, f64::max);
    far / scale
}
