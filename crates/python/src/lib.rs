//! The native module of the Python package `stoss`: runs step by step, meshes into files, frames out of files. What users see of it is in the Python
//! files beside it (`crates/python/stoss`).

mod errors;
mod mesh;
mod results;
mod session;

use errors::Refused;
use pyo3::prelude::*;
use std::path::PathBuf;
use stoss::run::RunOptions;

/// The plan of a run, line by line, or all problems of the scene.
#[pyfunction]
fn check(py: Python<'_>, path: PathBuf, parameters: Vec<(String, String)>) -> PyResult<String> {
    let options = RunOptions { set: parameters, ..RunOptions::default() };
    let plan = py.detach(|| stoss::run::check_scene_for(&path, &options));
    plan.map(|plan| plan.to_string()).map_err(|error| Refused::of(&error).raise(py))
}

/// A text of TOML as JSON.
#[pyfunction]
fn toml_to_json(py: Python<'_>, text: &str) -> PyResult<String> {
    let table = text.parse::<toml::Table>().map_err(|error| Refused::scene(&error.to_string()).raise(py))?;
    serde_json::to_string(&table).map_err(|error| Refused::scene(&error.to_string()).raise(py))
}

/// Sets the number of threads of all runs of this process; before the first one.
#[pyfunction]
fn set_threads(py: Python<'_>, threads: usize) -> PyResult<()> {
    stoss::run::set_threads(threads).map_err(|error| Refused::option(&error).raise(py))
}

/// The JSON schema of scenes.
#[pyfunction]
fn schema() -> String {
    stoss::scene::json_schema()
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<session::Session>()?;
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(toml_to_json, module)?)?;
    module.add_function(wrap_pyfunction!(set_threads, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(mesh::write_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(results::frames, module)?)?;
    module.add_function(wrap_pyfunction!(results::frame, module)?)?;
    module.add_function(wrap_pyfunction!(results::write_page, module)?)?;
    module.add_function(wrap_pyfunction!(results::judge, module)?)?;
    Ok(())
}
