//! Meshes of arrays into files.

use crate::errors::Refused;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use stoss::mesh::{Elements, Facet, Mesh};
use stoss::reference_element::CellKind;

/// Writes a mesh into a `.vtu` file: points (n, 3), blocks of cells as VTK's type and nodes (m, k), sets of nodes and of elements. A set of nodes that all lie on facets of the
/// boundary whose nodes are in it becomes a surface; every other one stays a set of nodes.
#[pyfunction]
pub fn write_mesh(
    py: Python<'_>,
    path: PathBuf,
    points: PyReadonlyArray2<'_, f64>,
    blocks: Vec<(u8, PyReadonlyArray2<'_, i64>)>,
    node_sets: BTreeMap<String, Vec<i64>>,
    element_sets: BTreeMap<String, Vec<i64>>,
) -> PyResult<()> {
    let refuse = |message: String| Err(Refused::scene(&message).raise(py));
    let points = points.as_array();
    if points.ncols() != 3 {
        return refuse(format!("points: an array of shape (n, 3) is needed, and this has {} columns", points.ncols()));
    }
    let nodes: Vec<[f64; 3]> = points.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    let mut elements = Elements::new();
    for (number, (vtk, cells)) in blocks.iter().enumerate() {
        let cells = cells.as_array();
        let Some(kind) = CellKind::ALL.into_iter().find(|kind| kind.table().vtk == *vtk) else {
            return refuse(format!("cells[{number}]: VTK's type {vtk} is no solid element of Stoss"));
        };
        if cells.ncols() != kind.node_count() {
            let (wanted, found) = (kind.node_count(), cells.ncols());
            return refuse(format!("cells[{number}]: {kind} has {wanted} nodes, and the array has {found} columns"));
        }
        let mut element = Vec::with_capacity(kind.node_count());
        for (row, cell) in cells.rows().into_iter().enumerate() {
            element.clear();
            for &node in cell {
                match u32::try_from(node).ok().filter(|&node| (node as usize) < nodes.len()) {
                    Some(node) => element.push(node),
                    None => {
                        let count = nodes.len();
                        return refuse(format!(
                            "cells[{number}][{row}]: node {node} does not exist: there are {count}"
                        ));
                    }
                }
            }
            elements.push(kind, &element);
        }
    }
    let mut mesh = match Mesh::new(nodes, elements) {
        Ok(mesh) => mesh,
        Err(error) => return refuse(error.to_string()),
    };
    let boundary = mesh.boundary_facets();
    for (name, numbers) in node_sets {
        let set = match numbers_below(&numbers, mesh.nodes.len()) {
            Ok(set) => set,
            Err(number) => return refuse(format!("sets[{name:?}]: there is no point {number}")),
        };
        let facets = surface(&boundary, &set);
        if facets.is_empty() {
            mesh.node_sets.insert(name, set.into_iter().collect());
        } else {
            mesh.facet_sets.insert(name, facets);
        }
    }
    for (name, numbers) in element_sets {
        match numbers_below(&numbers, mesh.elements.len()) {
            Ok(set) => mesh.element_sets.insert(name, set.into_iter().collect()),
            Err(number) => return refuse(format!("cell_sets[{name:?}]: there is no cell {number}")),
        };
    }
    let written = py.detach(|| stoss::mesh_io::write_mesh(&path, &mesh));
    written.map_err(|error| Refused::output(&error.to_string()).raise(py))
}

/// The numbers in their order, each once; or one that is not below `count`.
fn numbers_below(numbers: &[i64], count: usize) -> Result<BTreeSet<u32>, i64> {
    let number = |&number: &i64| u32::try_from(number).ok().filter(|&n| (n as usize) < count).ok_or(number);
    numbers.iter().map(number).collect()
}

/// The facets of the boundary with all nodes in a set, if they have all of its nodes.
fn surface(boundary: &[Facet], set: &BTreeSet<u32>) -> Vec<Facet> {
    let is_in = |facet: &&Facet| facet.nodes.iter().all(|node| set.contains(node));
    let facets: Vec<Facet> = boundary.iter().filter(is_in).copied().collect();
    let covered: BTreeSet<u32> = facets.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
    if covered.len() == set.len() { facets } else { Vec::new() }
}
