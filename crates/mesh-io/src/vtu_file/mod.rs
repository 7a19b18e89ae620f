//! VTK unstructured grids (`.vtu`) of any program: their pieces with points, cells and arrays, checked against each other. Parallel files (`.pvtu`) and other compressions
//! than zlib are refused.

mod arrays;

use std::path::Path;

use crate::{MeshIoError, xml};
use arrays::Arrays;

/// A named array of numbers.
pub(crate) struct Named {
    pub name: String,
    pub components: usize,
    pub values: Vec<f64>,
    /// Whole numbers by their type, not only by their values.
    pub is_integer: bool,
}

/// Where an array is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Section {
    Field,
    Point,
    Cell,
}

/// A piece of a file, whose arrays fit its numbers of points and cells.
#[derive(Default)]
pub(crate) struct Piece {
    /// Line of its tag.
    pub line: usize,
    pub points: Vec<[f64; 3]>,
    /// Cells: VTK's type and where the points begin and end.
    cells: Vec<(u8, usize, usize)>,
    connectivity: Vec<u32>,
    pub point_data: Vec<Named>,
    pub cell_data: Vec<Named>,
}

impl Piece {
    /// VTK's type and the points of each cell.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = (u8, &[u32])> {
        self.cells.iter().map(|&(kind, begin, end)| (kind, &self.connectivity[begin..end]))
    }
}

/// A file.
#[derive(Default)]
pub(crate) struct VtuFile {
    pub pieces: Vec<Piece>,
    pub field_data: Vec<Named>,
}

/// What was read of a piece so far.
struct Raw {
    /// Where its tag ends.
    tag: usize,
    counts: [usize; 2],
    coordinates: Vec<f64>,
    connectivity: Vec<f64>,
    offsets: Vec<f64>,
    types: Vec<f64>,
    data: [Vec<Named>; 2],
}

/// Reads a file. `wants`: which arrays, by place and number of components; the others are passed over, as those are that have no numbers.
pub(crate) fn read(path: &Path, bytes: &[u8], wants: impl Fn(Section, usize) -> bool) -> Result<VtuFile, MeshIoError> {
    const APPENDED: &[u8] = b"<AppendedData";
    let xml_end = bytes.windows(APPENDED.len()).position(|w| w == APPENDED);
    let text = String::from_utf8_lossy(&bytes[..xml_end.unwrap_or(bytes.len())]);
    let mut arrays = Arrays {
        path,
        bytes,
        text: &text,
        big_endian: false,
        header: 4,
        compressed: false,
        appended: xml_end.and_then(|start| appended(bytes, start)),
    };
    let mut file = VtuFile::default();
    let (mut section, mut raw, mut is_file) = ("", None::<Raw>, false);
    // What follows appended data is not looked at.
    let mut is_closed = xml_end.is_some();
    let mut position = 0;
    while let Some(tag) = xml::next_tag(&text, position) {
        position = tag.end;
        match tag.name() {
            "VTKFile" => {
                is_file = true;
                file_tag(&mut arrays, &tag)?;
            }
            "Piece" => {
                let count = |name| tag.attribute(name).and_then(|v| v.parse::<usize>().ok());
                let (Some(points), Some(cells)) = (count("NumberOfPoints"), count("NumberOfCells")) else {
                    return Err(arrays.error(tag.end, tag.text, "a piece needs its numbers of points and cells"));
                };
                raw = Some(Raw {
                    tag: tag.end,
                    counts: [points, cells],
                    coordinates: Vec::new(),
                    connectivity: Vec::new(),
                    offsets: Vec::new(),
                    types: Vec::new(),
                    data: Default::default(),
                });
            }
            name @ ("FieldData" | "PointData" | "CellData" | "Points" | "Cells") => section = name,
            "/FieldData" | "/PointData" | "/CellData" | "/Points" | "/Cells" => section = "",
            "DataArray" => match &mut raw {
                Some(raw) => array(&arrays, &tag, section, raw, &wants)?,
                None if section == "FieldData" => file.field_data.extend(named(&arrays, &tag, Section::Field, &wants)?),
                None => {}
            },
            "/Piece" => {
                if let Some(raw) = raw.take() {
                    file.pieces.push(piece(&arrays, raw)?);
                }
            }
            "/VTKFile" => is_closed = true,
            _ => {}
        }
    }
    if !is_file || !is_closed || raw.is_some() || file.pieces.is_empty() {
        let what = if is_file { "end of file" } else { "no <VTKFile> tag" };
        return Err(arrays.error(text.len(), what, "expected a VTU file with a complete piece; write it again"));
    }
    Ok(file)
}

fn file_tag(arrays: &mut Arrays, tag: &xml::Tag) -> Result<(), MeshIoError> {
    let bad = |arrays: &Arrays, remedy: &str| Err(arrays.error(tag.end, tag.text, remedy));
    if tag.attribute("type") != Some("UnstructuredGrid") {
        return bad(arrays, "only files of type UnstructuredGrid are read: save it as .vtu, in one file");
    }
    arrays.big_endian = match tag.attribute("byte_order") {
        Some("BigEndian") => true,
        Some("LittleEndian") | None => false,
        _ => return bad(arrays, "the byte order is LittleEndian or BigEndian"),
    };
    arrays.header = match tag.attribute("header_type") {
        Some("UInt64") => 8,
        Some("UInt32") | None => 4,
        _ => return bad(arrays, "the type of headers is UInt32 or UInt64"),
    };
    arrays.compressed = match tag.attribute("compressor") {
        None => false,
        Some("vtkZLibDataCompressor") => true,
        _ => return bad(arrays, "only zlib compression is read: save it with zlib or without compression"),
    };
    Ok(())
}

/// Where appended data begin: after the underscore that follows the tag.
fn appended(bytes: &[u8], start: usize) -> Option<(usize, bool)> {
    let end = start + bytes[start..].iter().position(|&b| b == b'>')?;
    let base64 = !String::from_utf8_lossy(&bytes[start..end]).contains("\"raw\"");
    let underscore = end + bytes[end..].iter().position(|&b| b == b'_')?;
    Some((underscore + 1, base64))
}

fn array(
    arrays: &Arrays,
    tag: &xml::Tag,
    section: &str,
    raw: &mut Raw,
    wants: &impl Fn(Section, usize) -> bool,
) -> Result<(), MeshIoError> {
    let of = match (section, tag.attribute("Name")) {
        ("Points", _) => &mut raw.coordinates,
        ("Cells", Some("connectivity")) => &mut raw.connectivity,
        ("Cells", Some("offsets")) => &mut raw.offsets,
        ("Cells", Some("types")) => &mut raw.types,
        ("PointData" | "CellData", _) => {
            let is_cell = section == "CellData";
            let section = if is_cell { Section::Cell } else { Section::Point };
            if let Some(found) = named(arrays, tag, section, wants)? {
                let expected = raw.counts[usize::from(is_cell)].saturating_mul(found.components);
                if found.values.len() != expected {
                    let value = format!("array {:?} with {} values", found.name, found.values.len());
                    return Err(arrays.error(tag.end, value, format!("expected {expected}")));
                }
                raw.data[usize::from(is_cell)].push(found);
            }
            return Ok(());
        }
        _ => return Ok(()),
    };
    *of = arrays.values(tag)?;
    Ok(())
}

/// An array of numbers that is wanted.
fn named(
    arrays: &Arrays,
    tag: &xml::Tag,
    section: Section,
    wants: &impl Fn(Section, usize) -> bool,
) -> Result<Option<Named>, MeshIoError> {
    let kind = tag.attribute("type").unwrap_or_default();
    // Text, for instance, is no array of numbers.
    let is_number = ["Int", "UInt", "Float"].iter().any(|number| kind.starts_with(number));
    let components = tag.attribute("NumberOfComponents").unwrap_or("1").parse().unwrap_or(0);
    if !is_number || components == 0 || !wants(section, components) {
        return Ok(None);
    }
    let name = tag.attribute("Name").and_then(xml::unescape).unwrap_or_default();
    Ok(Some(Named { name, components, values: arrays.values(tag)?, is_integer: !kind.starts_with("Float") }))
}

/// A piece, if its arrays fit each other.
fn piece(arrays: &Arrays, raw: Raw) -> Result<Piece, MeshIoError> {
    let [points, cells] = raw.counts;
    let bad = |value: String, remedy: &str| Err(arrays.error(raw.tag, value, remedy));
    let fits = raw.coordinates.len() == points.saturating_mul(3)
        && raw.offsets.len() == cells
        && raw.types.len() == cells
        && points < u32::MAX as usize;
    if !fits {
        let remedy = "the arrays of this piece have other lengths: the file is damaged, write it again";
        return bad(format!("{points} points, {cells} cells"), remedy);
    }
    let (mut ends, mut begin) = (Vec::with_capacity(cells), 0);
    for (cell, (&end, &kind)) in raw.offsets.iter().zip(&raw.types).enumerate() {
        let end = if end >= 0.0 { end as usize } else { usize::MAX };
        let Some(nodes) = raw.connectivity.get(begin..end) else {
            return bad(format!("cell {cell}"), "its offset does not fit the connectivity");
        };
        if !nodes.iter().all(|&n| n >= 0.0 && n < points as f64) {
            return bad(format!("cell {cell}"), "it has a point that does not exist");
        }
        ends.push((kind as u8, begin, end));
        begin = end;
    }
    let [point_data, cell_data] = raw.data;
    Ok(Piece {
        line: arrays.line(raw.tag),
        points: raw.coordinates.as_chunks::<3>().0.to_vec(),
        cells: ends,
        connectivity: raw.connectivity.iter().map(|&n| n as u32).collect(),
        point_data,
        cell_data,
    })
}
