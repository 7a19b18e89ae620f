//! Frames of results as [`crate::write_vtu`] writes them: the cells in their order, arrays by name.

use std::collections::BTreeMap;
use std::path::Path;

use crate::MeshIoError;
use crate::lines::syntax;
use crate::vtu::{TIME, VTK_POLY_LINE, VTK_VERTEX};
use crate::vtu_file::{self, Named};
use stoss_mesh::Elements;
use stoss_reference_element::{CellKind, FaceKind, FaceNodes};

/// Values on points or cells, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Array {
    /// Numbers in a row.
    pub components: usize,
    /// Values of all rows.
    pub values: Vec<f64>,
}

impl Array {
    /// Row `index`.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.values[index * self.components..(index + 1) * self.components]
    }

    /// Euclidean length of row `index`; of a scalar the value itself, with its sign.
    pub fn magnitude(&self, index: usize) -> f64 {
        match self.row(index) {
            [value] => *value,
            row => row.iter().map(|value| value * value).sum::<f64>().sqrt(),
        }
    }
}

/// One frame. Cells stand in the order elements, facets, lines, vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VtuData {
    /// Coordinates of the points as stored.
    pub points: Vec<[f64; 3]>,
    /// Kinds and points of the elements.
    pub elements: Elements,
    /// Kinds and points of the facets of surfaces.
    pub facets: Vec<FaceNodes>,
    /// Points of each line.
    pub lines: Vec<Vec<u32>>,
    /// Single points.
    pub vertices: Vec<u32>,
    /// Arrays on points by name.
    pub point_data: BTreeMap<String, Array>,
    /// Arrays on cells by name.
    pub cell_data: BTreeMap<String, Array>,
    /// Arrays of the frame by name.
    pub field_data: BTreeMap<String, Array>,
    /// The time.
    pub time: Option<f64>,
}

impl VtuData {
    /// Takes over cells; `None` if there are others than those that are written, or in another order.
    pub(crate) fn add_cells<'a>(&mut self, cells: impl Iterator<Item = (u8, &'a [u32])>) -> Option<()> {
        for (kind, cell) in cells {
            let solid = CellKind::ALL.into_iter().find(|solid| solid.table().vtk == kind);
            let facet = FaceKind::ALL.into_iter().find(|facet| facet.vtk() == kind);
            let after_facets = self.lines.len() + self.vertices.len();
            match (kind, solid, facet) {
                (_, Some(solid), _) if self.facets.len() + after_facets == 0 && cell.len() == solid.node_count() => {
                    self.elements.push(solid, cell);
                }
                (_, _, Some(facet)) if after_facets == 0 && cell.len() == facet.node_count() => {
                    self.facets.push(FaceNodes::from_fn(facet, |k| cell[k]));
                }
                (VTK_POLY_LINE, ..) if self.vertices.is_empty() && cell.len() >= 2 => self.lines.push(cell.to_vec()),
                (VTK_VERTEX, ..) => self.vertices.push(*<&[u32; 1]>::try_from(cell).ok()?.first()?),
                _ => return None,
            }
        }
        Some(())
    }
}

/// Reads a file.
///
/// # Errors
/// [`MeshIoError::Io`], [`MeshIoError::Syntax`] with line and remedy.
pub fn read_vtu(path: impl AsRef<Path>) -> Result<VtuData, MeshIoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    read_vtu_from_bytes(path, &bytes)
}

/// [`read_vtu`] for a file in memory; `path` is used in messages only.
///
/// # Errors
/// [`MeshIoError::Syntax`].
pub fn read_vtu_from_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<VtuData, MeshIoError> {
    let path = path.as_ref();
    let file = vtu_file::read(path, bytes, |_, _| true)?;
    let error = |line, value: &str, remedy: &str| {
        Err(syntax(path, line, value, format_args!("{remedy}; only frames written by Stoss are read")))
    };
    let mut pieces = file.pieces.into_iter();
    let (Some(piece), None) = (pieces.next(), pieces.next()) else {
        return error(1, "several pieces", "expected one piece");
    };
    let mut data = VtuData::default();
    if data.add_cells(piece.cells()).is_none() {
        return error(piece.line, "the cells", "expected elements, facets, lines and vertices, in this order");
    }
    let arrays = |fields: Vec<Named>| {
        fields.into_iter().map(|f| (f.name, Array { components: f.components, values: f.values })).collect()
    };
    data.field_data = arrays(file.field_data);
    data.time = data.field_data.remove(TIME).and_then(|time| time.values.first().copied());
    (data.points, data.point_data, data.cell_data) = (piece.points, arrays(piece.point_data), arrays(piece.cell_data));
    Ok(data)
}
