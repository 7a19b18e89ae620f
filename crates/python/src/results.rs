//! Folders of results: frames, the page, the verdict.

use crate::errors::Refused;
use crate::session::{array1, array2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use stoss_report::folder::Folder;
use stoss_report::vtu::Grid;

/// Times of the frames, names of the bodies, notes on what could not be read.
#[pyfunction]
pub fn frames(py: Python<'_>, out: PathBuf) -> PyResult<(Vec<f64>, Vec<String>, Vec<String>)> {
    let folder = Folder::open(&out).map_err(|error| Refused::output(&error.to_string()).raise(py))?;
    Ok((folder.frames.iter().map(|frame| frame.time).collect(), folder.bodies, folder.notes))
}

/// One frame: `points` (n, 3), `cells` and `cell_types` as VTK has them, `point_data` and `cell_data`.
#[pyfunction]
pub fn frame(py: Python<'_>, out: PathBuf, number: usize) -> PyResult<Bound<'_, PyDict>> {
    let read = || {
        let folder = Folder::open(&out).map_err(|error| error.to_string())?;
        match folder.frames.get(number) {
            Some(frame) => Ok((frame.time, folder.grid(number).map_err(|error| error.to_string())?)),
            None => Err(format!("{}: there is no frame {number}, but {}", out.display(), folder.frames.len())),
        }
    };
    let (time, grid) = py.detach(read).map_err(|error| Refused::output(&error).raise(py))?;
    let (cells, types) = cells(&grid);
    let data = |arrays: &std::collections::BTreeMap<String, stoss_report::vtu::Array>| -> PyResult<_> {
        let dict = PyDict::new(py);
        for (name, array) in arrays {
            match array.components {
                1 => dict.set_item(name, array1(py, &array.values))?,
                n => dict.set_item(name, array2(py, &array.values, n)?)?,
            }
        }
        Ok(dict)
    };
    let result = PyDict::new(py);
    result.set_item("time", time)?;
    result.set_item("points", array2(py, grid.points.as_flattened(), 3)?)?;
    result.set_item("cells", array1(py, &cells))?;
    result.set_item("cell_types", array1(py, &types))?;
    result.set_item("point_data", data(&grid.point_data)?)?;
    result.set_item("cell_data", data(&grid.cell_data)?)?;
    Ok(result)
}

/// Number of nodes and nodes, cell after cell; VTK's type of each.
fn cells(grid: &Grid) -> (Vec<i64>, Vec<u8>) {
    let (mut cells, mut types) = (Vec::new(), Vec::new());
    let mut push = |vtk: u8, nodes: &mut dyn Iterator<Item = i64>| {
        let start = cells.len();
        cells.push(0);
        cells.extend(nodes);
        cells[start] = (cells.len() - start - 1) as i64;
        types.push(vtk);
    };
    for (kind, nodes) in grid.elements.cells() {
        push(kind.table().vtk, &mut nodes.iter().map(|&node| i64::from(node)));
    }
    for facet in &grid.facets {
        push(facet.kind().vtk(), &mut facet.iter().map(|&node| i64::from(node)));
    }
    for line in &grid.lines {
        push(4, &mut line.iter().map(|&node| i64::from(node)));
    }
    for &vertex in &grid.vertices {
        push(1, &mut std::iter::once(i64::from(vertex)));
    }
    (cells, types)
}

/// Writes the page of a run; its file, and notes on what it has to leave out.
#[pyfunction]
pub fn write_page(py: Python<'_>, out: PathBuf) -> PyResult<(PathBuf, Vec<String>)> {
    let notes = py.detach(|| stoss_report::page::write(&[&out]).map_err(|error| error.to_string()));
    let notes = notes.map_err(|error| Refused::output(&error).raise(py))?;
    Ok((out.join(stoss_report::page::NAME), notes))
}

/// The verdict on what is stored.
#[pyfunction]
pub fn judge(py: Python<'_>, out: PathBuf) -> PyResult<String> {
    let verdict = py.detach(|| stoss::run::judge_folder(&out));
    verdict.map(|verdict| verdict.to_string()).map_err(|error| Refused::output(&error.to_string()).raise(py))
}
