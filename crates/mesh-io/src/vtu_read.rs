//! Reads VTU files that [`crate::write_vtu`] wrote: for tests, pictures and comparisons.
//!
//! This is not a reader of VTU files in general: one piece, the cells that are written in their order, inline
//! binary arrays without compression.

use std::path::Path;

use crate::lines::syntax;
use crate::vtu::{TIME, VTK_POLY_LINE, VTK_VERTEX};
use crate::{MeshIoError, xml};
use stoss_mesh::Elements;
use stoss_reference_element::{CellKind, FaceKind, FaceNodes};

/// A named array read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnedField {
    /// Name of the array.
    pub name: String,
    /// Number of components.
    pub components: usize,
    /// The values, all components of the first point or cell first.
    pub values: Vec<f64>,
}

/// The content of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VtuData {
    /// Coordinates.
    pub points: Vec<[f64; 3]>,
    /// Kinds and points of the elements.
    pub elements: Elements,
    /// Kinds and points of the facets.
    pub facets: Vec<FaceNodes>,
    /// Points of the lines.
    pub lines: Vec<Vec<u32>>,
    /// Single points.
    pub vertices: Vec<u32>,
    /// Fields of the points.
    pub point_data: Vec<OwnedField>,
    /// Fields of the cells: elements, facets, lines, vertices.
    pub cell_data: Vec<OwnedField>,
    /// Fields of the frame.
    pub field_data: Vec<OwnedField>,
    /// The time.
    pub time: Option<f64>,
}

impl VtuData {
    /// The field of the points with this name.
    pub fn point_field(&self, name: &str) -> Option<&OwnedField> {
        self.point_data.iter().find(|f| f.name == name)
    }

    /// Takes over cells, of which `offsets` are the ends in `nodes`; `None` if there are others than those that are written, or in another order.
    pub(crate) fn add_cells(&mut self, nodes: &[i64], offsets: &[i64], kinds: &[u8]) -> Option<()> {
        let mut start = 0;
        for (&end, &kind) in offsets.iter().zip(kinds) {
            let end = usize::try_from(end).ok()?;
            let cell: Vec<u32> = nodes.get(start..end)?.iter().map(|&n| n as u32).collect();
            start = end;
            let solid = CellKind::ALL.into_iter().find(|solid| solid.table().vtk == kind);
            let facet = FaceKind::ALL.into_iter().find(|facet| facet.vtk() == kind);
            let after_facets = self.lines.len() + self.vertices.len();
            match (kind, solid, facet) {
                (_, Some(solid), _) if self.facets.len() + after_facets == 0 && cell.len() == solid.node_count() => {
                    self.elements.push(solid, &cell);
                }
                (_, _, Some(facet)) if after_facets == 0 && cell.len() == facet.node_count() => {
                    self.facets.push(FaceNodes::from_fn(facet, |k| cell[k]));
                }
                (VTK_POLY_LINE, ..) if self.vertices.is_empty() && cell.len() >= 2 => self.lines.push(cell),
                (VTK_VERTEX, ..) => self.vertices.push(*<&[u32; 1]>::try_from(cell.as_slice()).ok()?.first()?),
                _ => return None,
            }
        }
        (offsets.len() == kinds.len() && start == nodes.len()).then_some(())
    }
}

/// Reads a file.
///
/// # Errors
/// [`MeshIoError::Io`], [`MeshIoError::Syntax`] with line and remedy.
pub fn read_vtu(path: impl AsRef<Path>) -> Result<VtuData, MeshIoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    read_vtu_from_str(path, &String::from_utf8_lossy(&bytes))
}

/// [`read_vtu`] for a text in memory; `path` is used in messages only.
///
/// # Errors
/// [`MeshIoError::Syntax`].
pub fn read_vtu_from_str(path: impl AsRef<Path>, text: &str) -> Result<VtuData, MeshIoError> {
    Reader { path: path.as_ref(), text, position: 0 }.read()
}

struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    position: usize,
}

const REMEDY: &str = "only VTU files written by Stoss are read";

impl<'a> Reader<'a> {
    fn error(&self, value: &str, remedy: &str) -> MeshIoError {
        let line =
            self.text.as_bytes()[..self.position.min(self.text.len())].iter().filter(|&&b| b == b'\n').count() + 1;
        syntax(self.path, line, value, format_args!("{remedy}; {REMEDY}"))
    }

    fn read(mut self) -> Result<VtuData, MeshIoError> {
        let mut data = VtuData::default();
        let (mut section, mut counts) = ("", None);
        let (mut nodes, mut offsets, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
        let mut closed = false;
        while let Some(tag) = xml::next_tag(self.text, self.position) {
            self.position = tag.end;
            match tag.name() {
                "VTKFile" => {
                    let expected =
                        [("type", "UnstructuredGrid"), ("byte_order", "LittleEndian"), ("header_type", "UInt64")];
                    if tag.attribute("compressor").is_some()
                        || expected.iter().any(|(k, v)| tag.attribute(k) != Some(v))
                    {
                        return Err(
                            self.error(tag.text, "expected an uncompressed little-endian grid with UInt64 headers")
                        );
                    }
                }
                "Piece" => {
                    let count = |name| tag.attribute(name).and_then(|v| v.parse::<usize>().ok());
                    let (Some(points), Some(cells), None) = (count("NumberOfPoints"), count("NumberOfCells"), counts)
                    else {
                        return Err(self.error(tag.text, "expected one piece with numbers of points and cells"));
                    };
                    counts = Some((points, cells));
                }
                name @ ("FieldData" | "PointData" | "CellData" | "Points" | "Cells") => section = name,
                "DataArray" => {
                    let name = tag.attribute("Name").and_then(xml::unescape);
                    let Some(name) = name else { return Err(self.error(tag.text, "expected an array with a name")) };
                    let components = tag.attribute("NumberOfComponents").unwrap_or("1").parse::<usize>().unwrap_or(0);
                    let bytes = self.array(&tag)?;
                    match (section, name.as_str(), tag.attribute("type")) {
                        ("Cells", "connectivity", Some("Int64")) => nodes = self.values(&bytes, i64::from_le_bytes)?,
                        ("Cells", "offsets", Some("Int64")) => offsets = self.values(&bytes, i64::from_le_bytes)?,
                        ("Cells", "types", Some("UInt8")) => kinds = bytes,
                        (_, _, Some("Float64")) if components > 0 => {
                            let values = self.values(&bytes, f64::from_le_bytes)?;
                            let field = OwnedField { name, components, values };
                            match section {
                                "Points" if components == 3 => data.points = field.values.as_chunks().0.to_vec(),
                                "FieldData" if field.name == TIME => data.time = field.values.first().copied(),
                                "FieldData" => data.field_data.push(field),
                                "PointData" => data.point_data.push(field),
                                "CellData" => data.cell_data.push(field),
                                _ => return Err(self.error(tag.text, "unexpected array")),
                            }
                        }
                        _ => return Err(self.error(tag.text, "unexpected array")),
                    }
                }
                "/VTKFile" => closed = true,
                _ => {}
            }
        }
        let Some((points, cells)) = counts.filter(|_| closed) else {
            return Err(self.error("end of file", "the file is cut off"));
        };
        let fits = |fields: &[OwnedField], tuples: usize| {
            fields.iter().all(|f| f.components.checked_mul(tuples) == Some(f.values.len()))
        };
        let consistent = data.points.len() == points
            && kinds.len() == cells
            && nodes.iter().all(|&n| usize::try_from(n).is_ok_and(|n| n < points && n <= u32::MAX as usize))
            && fits(&data.point_data, points)
            && fits(&data.cell_data, cells)
            && data.add_cells(&nodes, &offsets, &kinds).is_some();
        if !consistent {
            return Err(self.error("the arrays", "their lengths and contents must fit the numbers of points and cells"));
        }
        Ok(data)
    }

    /// The bytes of the array whose tag was just read.
    fn array(&self, tag: &xml::Tag) -> Result<Vec<u8>, MeshIoError> {
        let end = self.text[tag.end..].find('<').map(|i| tag.end + i);
        let (Some(end), Some("binary")) = (end, tag.attribute("format")) else {
            return Err(self.error(tag.text, "expected an inline binary array"));
        };
        let bytes = crate::base64::decode(&self.text[tag.end..end]);
        match bytes.as_deref().and_then(|b| b.split_first_chunk::<8>()) {
            Some((length, content)) if u64::from_le_bytes(*length) == content.len() as u64 => Ok(content.to_vec()),
            _ => Err(self.error(tag.text, "the array is not base64, or its length is wrong")),
        }
    }

    fn values<T, const N: usize>(&self, bytes: &[u8], convert: fn([u8; N]) -> T) -> Result<Vec<T>, MeshIoError> {
        let (chunks, rest) = bytes.as_chunks::<N>();
        if !rest.is_empty() {
            return Err(self.error("an array", "its length does not fit its type"));
        }
        Ok(chunks.iter().map(|&c| convert(c)).collect())
    }
}
