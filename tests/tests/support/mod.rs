//! Simulations from scenes that are written in a test.

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

/// Largest distance of `values` from the first one, divided by the largest norm.
#[allow(dead_code, reason = "each test binary uses a part")]
pub fn drift(values: &[[f64; 3]]) -> f64 {
    let norm = |a: [f64; 3]| a[0].hypot(a[1]).hypot(a[2]);
    let scale = values.iter().map(|v| norm(*v)).fold(0.0, f64::max);
    let far = values.iter().map(|v| norm(std::array::from_fn(|i| v[i] - values[0][i]))).fold(0.0, f64::max);
    far / scale
}
