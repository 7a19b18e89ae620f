//! VTU: one frame of results as a VTK unstructured grid (XML, version 1.0).
//!
//! Arrays are inline, `format="binary"`: base64 of an 8-byte length and the values, little endian, not compressed. Coordinates
//! and fields are `Float64`, connectivity and offsets `Int64`, cell types `UInt8`. NaN is written as it is. The order of cells is elements
//! (VTK's types 10, 12, 13, 24, 25, 26, 29), facets (5, 9, 22, 23, 28), lines (4), vertices (1). The order of nodes is the same.
//! The time goes into the field array `TimeValue`, which VTK's XML readers take as the time of the frame.
//!
//! Parallel pieces, compression and other cells are not here.

use std::io::{self, Write};
use std::path::Path;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;

use crate::atomic::{self, WriteError};
use crate::{MeshIoError, xml};
use stoss_mesh::CellBlock;
use stoss_reference_element::FaceNodes;

/// Name of the field array that holds the time.
pub(crate) const TIME: &str = "TimeValue";
/// VTK's number of a line through any number of points.
pub(crate) const VTK_POLY_LINE: u8 = 4;
/// VTK's number of a single point.
pub(crate) const VTK_VERTEX: u8 = 1;

/// A named array with a fixed number of components a point or a cell.
///
/// ParaView takes 3 components as a vector and 6 as a symmetric tensor in the order xx, yy, zz, xy, yz, xz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field<'a> {
    /// Name of the array in ParaView.
    pub name: &'a str,
    /// Number of components.
    pub components: usize,
    /// The values, all components of the first point or cell first.
    pub values: &'a [f64],
}

/// A frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VtuFrame<'a> {
    /// Coordinates of the points. (For deformed pictures write the reference coordinates and a displacement field.)
    pub points: &'a [[f64; 3]],
    /// Kinds and points of the elements, as [`stoss_mesh::Elements::blocks`] gives them.
    pub elements: &'a [CellBlock],
    /// Points of facets, for instance of surfaces without a volume mesh.
    pub facets: &'a [FaceNodes],
    /// Points of lines from one end to the other, two at least.
    pub lines: &'a [Vec<u32>],
    /// Points that are drawn by themselves.
    pub vertices: &'a [u32],
    /// Fields with one tuple a point.
    pub point_data: Vec<Field<'a>>,
    /// Fields with one tuple a cell: elements, facets, lines, vertices.
    pub cell_data: Vec<Field<'a>>,
    /// Fields of the frame as a whole, of any number of tuples.
    pub field_data: Vec<Field<'a>>,
    /// The time of the frame.
    pub time: Option<f64>,
}

impl VtuFrame<'_> {
    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        let elements: usize = self.elements.iter().map(CellBlock::len).sum();
        elements + self.facets.len() + self.lines.len() + self.vertices.len()
    }

    /// Type and points of each cell, in the order of the file.
    pub(crate) fn cells(&self) -> impl Iterator<Item = (u8, &[u32])> + Clone {
        let elements = self.elements.iter().flat_map(|block| {
            let kind = block.kind().table().vtk;
            block.iter().map(move |nodes| (kind, nodes))
        });
        let facets = self.facets.iter().map(|nodes| (nodes.kind().vtk(), &**nodes));
        let lines = self.lines.iter().map(|nodes| (VTK_POLY_LINE, nodes.as_slice()));
        let vertices = self.vertices.iter().map(|node| (VTK_VERTEX, std::slice::from_ref(node)));
        elements.chain(facets).chain(lines).chain(vertices)
    }

    /// Checks that everything fits together.
    ///
    /// # Errors
    /// [`MeshIoError::Output`]: lengths, names that are empty, repeated or not possible in XML, cells with points that do not
    /// exist, lines of less than two points.
    pub fn validate(&self) -> Result<(), MeshIoError> {
        let bad = |name: &str, problem: String| Err(MeshIoError::Output { name: name.to_owned(), problem });
        for (e, (kind, nodes)) in self.cells().enumerate() {
            if let Some(n) = nodes.iter().find(|&&n| n as usize >= self.points.len()) {
                return bad("cells", format!("cell {e} has point {n}, but there are {} points", self.points.len()));
            }
            if kind == VTK_POLY_LINE && nodes.len() < 2 {
                return bad("cells", format!("cell {e} is a line of {} points", nodes.len()));
            }
        }
        let groups = [
            (&self.point_data, Some(self.points.len()), "points"),
            (&self.cell_data, Some(self.cell_count()), "cells"),
            (&self.field_data, None, ""),
        ];
        for (fields, tuples, what) in groups {
            for (i, field) in fields.iter().enumerate() {
                let reserved = tuples.is_none() && field.name == TIME;
                if field.name.is_empty() || xml::escape(field.name).is_none() || reserved {
                    return bad(
                        field.name,
                        "a name must not be empty, have control characters, or be that of the time".to_owned(),
                    );
                }
                if fields[..i].iter().any(|f| f.name == field.name) {
                    return bad(field.name, "there are two fields of this name".to_owned());
                }
                let c = field.components;
                if c == 0 || field.values.len() % c != 0 {
                    return bad(field.name, format!("{} values cannot have {c} components", field.values.len()));
                }
                if let Some(tuples) = tuples.filter(|&t| t * c != field.values.len()) {
                    return bad(
                        field.name,
                        format!("{} values with {c} components do not fit {tuples} {what}", field.values.len()),
                    );
                }
            }
        }
        Ok(())
    }
}

/// Writes a frame to a file, under a temporary name first.
///
/// # Errors
/// [`MeshIoError::Output`] if the data do not fit together, [`MeshIoError::Io`].
pub fn write_vtu(path: impl AsRef<Path>, frame: &VtuFrame) -> Result<(), MeshIoError> {
    frame.validate()?;
    atomic::write(path.as_ref(), |out| write_frame(out, frame).map_err(WriteError::Io))
}

/// Writes a frame to anything; buffer it if it is a file.
///
/// # Errors
/// [`MeshIoError::Output`] if the data do not fit together, [`MeshIoError::Io`] (without a path).
pub fn write_vtu_to(out: &mut impl Write, frame: &VtuFrame) -> Result<(), MeshIoError> {
    frame.validate()?;
    write_frame(out, frame).map_err(|source| MeshIoError::Io { path: "(stream)".into(), source })
}

fn write_frame(out: &mut impl Write, frame: &VtuFrame) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(out, "<UnstructuredGrid>")?;
    if frame.time.is_some() || !frame.field_data.is_empty() {
        writeln!(out, "<FieldData>")?;
        if let Some(time) = frame.time {
            field(out, &Field { name: TIME, components: 1, values: &[time] }, true)?;
        }
        frame.field_data.iter().try_for_each(|f| field(out, f, true))?;
        writeln!(out, "</FieldData>")?;
    }
    let (points, cells) = (frame.points.len(), frame.cell_count());
    writeln!(out, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")?;
    for (tag, fields) in [("PointData", &frame.point_data), ("CellData", &frame.cell_data)] {
        writeln!(out, "<{tag}>")?;
        fields.iter().try_for_each(|f| field(out, f, false))?;
        writeln!(out, "</{tag}>")?;
    }
    writeln!(out, "<Points>")?;
    field(out, &Field { name: "Points", components: 3, values: frame.points.as_flattened() }, false)?;
    writeln!(out, "</Points>\n<Cells>")?;
    let counts = frame.cells().map(|(_, nodes)| nodes.len());
    let nodes = frame.cells().flat_map(|(_, nodes)| nodes.iter().map(|&n| i64::from(n).to_le_bytes()));
    array(out, "type=\"Int64\" Name=\"connectivity\"", counts.clone().sum(), nodes)?;
    let mut end = 0;
    let offsets = counts.map(|count| {
        end += count as i64;
        end.to_le_bytes()
    });
    array(out, "type=\"Int64\" Name=\"offsets\"", cells, offsets)?;
    array(out, "type=\"UInt8\" Name=\"types\"", cells, frame.cells().map(|(kind, _)| [kind]))?;
    writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

fn field(out: &mut impl Write, field: &Field, count: bool) -> io::Result<()> {
    let name = xml::escape(field.name).unwrap_or_default(); // validated
    let mut attributes = format!("type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{}\"", field.components);
    if count {
        attributes.push_str(&format!(" NumberOfTuples=\"{}\"", field.values.len() / field.components));
    }
    array(out, &attributes, field.values.len(), field.values.iter().map(|v| v.to_le_bytes()))
}

fn array<const N: usize>(
    out: &mut impl Write,
    attributes: &str,
    count: usize,
    values: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    writeln!(out, "<DataArray {attributes} format=\"binary\">")?;
    let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
    encoder.write_all(&((N * count) as u64).to_le_bytes())?;
    for value in values {
        encoder.write_all(&value)?;
    }
    encoder.finish()?;
    drop(encoder);
    writeln!(out, "\n</DataArray>")
}
