//! VTK unstructured grids (`.vtu`) of any program as meshes.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | hexahedra (types 12, 25, 29), voxels (11), tetrahedra (10, 24), wedges (13, 26) | elements; nodes on edges stay where they are |
//! | array of the cells of whole numbers, one a cell | element set `array=value` for each value, but not of zeros and ones of a floating-point type |
//! | array of the cells of zeros and ones | also the set `array` of its ones; of triangles (5, 22) and quadrilaterals (9, 23, 28) a facet set |
//! | array of the cells with three components | vectors of the elements, such as directions of fibres |
//! | array of the points of zeros and ones | the node set `array` of its ones |
//!
//! Several pieces are put side by side. Cells without a volume are left out with a note, but for those of a facet set. Parallel
//! files (`.pvtu`) and other compressions than zlib are refused.

mod arrays;
mod cells;

use std::collections::BTreeSet;
use std::path::Path;

use crate::contents::{Source, entry};
use crate::include::Include;
use crate::place::FileLocation;
use crate::{Contents, MeshIoError, xml};
use arrays::Arrays;

/// An array with more different values than this is no list of groups.
const GROUPS: usize = 256;

/// Whether a text begins like a VTU file.
pub(crate) fn recognise(text: &str) -> bool {
    text.contains("<VTKFile") && text.contains("\"UnstructuredGrid\"")
}

/// A named array of one number a cell or a point.
struct Named {
    name: String,
    values: Vec<f64>,
    /// Whole numbers by their type, not only by their values.
    is_integer: bool,
}

/// What was read of a piece so far.
#[derive(Default)]
struct Piece {
    points: usize,
    cells: usize,
    coordinates: Vec<f64>,
    connectivity: Vec<f64>,
    offsets: Vec<f64>,
    types: Vec<f64>,
    cell_arrays: Vec<Named>,
    cell_vectors: Vec<(String, Vec<[f64; 3]>)>,
    point_arrays: Vec<Named>,
}

/// Reads a file.
pub(crate) fn read(path: &Path, bytes: &[u8], _: Include<'_>) -> Result<Contents, MeshIoError> {
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
    let mut contents = Contents::new(path, "VTK unstructured grid (VTU)");
    let mut section = "";
    let (mut piece, mut is_file, mut is_closed) = (None::<(Piece, usize)>, false, false);
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
                piece = Some((Piece { points, cells, ..Piece::default() }, tag.end));
            }
            name @ ("PointData" | "CellData" | "Points" | "Cells") => section = name,
            "/PointData" | "/CellData" | "/Points" | "/Cells" => section = "",
            "DataArray" => {
                if let Some((piece, _)) = &mut piece {
                    array(&arrays, &tag, section, piece)?;
                }
            }
            "/Piece" => {
                if let Some((piece, start)) = piece.take() {
                    add(&arrays, piece, start, &mut contents)?;
                    is_closed = true;
                }
            }
            _ => {}
        }
    }
    if !is_file || !is_closed || piece.is_some() {
        let what = if is_file { "end of file" } else { "no <VTKFile> tag" };
        return Err(arrays.error(text.len(), what, "expected a VTU file with a complete piece; write it again"));
    }
    Ok(contents)
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

fn array(arrays: &Arrays, tag: &xml::Tag, section: &str, piece: &mut Piece) -> Result<(), MeshIoError> {
    let name = tag.attribute("Name").and_then(xml::unescape).unwrap_or_default();
    match (section, name.as_str()) {
        ("Points", _) => piece.coordinates = arrays.values(tag)?,
        ("Cells", "connectivity") => piece.connectivity = arrays.values(tag)?,
        ("Cells", "offsets") => piece.offsets = arrays.values(tag)?,
        ("Cells", "types") => piece.types = arrays.values(tag)?,
        ("CellData" | "PointData", _) if tag.attribute("NumberOfComponents").is_none_or(|n| n == "1") => {
            // Text, for instance, makes no groups.
            if tag.attribute("type").is_none_or(|kind| !["Int", "UInt", "Float"].iter().any(|n| kind.starts_with(n))) {
                return Ok(());
            }
            let count = if section == "CellData" { piece.cells } else { piece.points };
            let values = arrays.values(tag)?;
            if values.len() != count {
                let value = format!("array {name:?} with {} values", values.len());
                return Err(arrays.error(tag.end, value, format!("expected {count}")));
            }
            let of = if section == "CellData" { &mut piece.cell_arrays } else { &mut piece.point_arrays };
            let is_integer = tag.attribute("type").is_some_and(|kind| !kind.starts_with("Float"));
            of.push(Named { name, values, is_integer });
        }
        ("CellData", _) if tag.attribute("NumberOfComponents") == Some("3") => {
            let values = arrays.values(tag)?;
            if values.len() != 3 * piece.cells {
                let value = format!("array {name:?} with {} values", values.len());
                return Err(arrays.error(tag.end, value, format!("expected {}", 3 * piece.cells)));
            }
            piece.cell_vectors.push((name, values.as_chunks::<3>().0.to_vec()));
        }
        _ => {}
    }
    Ok(())
}

/// Puts a piece beside those that are there.
fn add(arrays: &Arrays, piece: Piece, start: usize, contents: &mut Contents) -> Result<(), MeshIoError> {
    let place = FileLocation { file: 0, at: arrays.line(start) as u64 };
    let (points, cells) = (piece.points, piece.cells);
    let fits = piece.coordinates.len() == points.saturating_mul(3)
        && piece.offsets.len() == cells
        && piece.types.len() == cells
        && contents.nodes.len().saturating_add(points) < u32::MAX as usize;
    if !fits {
        let value = format!("{points} points, {cells} cells");
        let remedy = "the arrays of this piece have other lengths: the file is damaged, write it again";
        return Err(contents.error(place, value, remedy));
    }
    let first_node = contents.nodes.len() as u32;
    for x in piece.coordinates.as_chunks::<3>().0 {
        if !x.iter().all(|c| c.is_finite()) {
            return Err(contents.error(place, format_args!("{x:?}"), "expected the finite coordinates of a point"));
        }
        contents.node_source.push(Source { number: contents.nodes.len() as u64, place });
        contents.nodes.push(*x);
    }
    let groups = Groups::new(&piece.cell_arrays);
    let mut begin = 0;
    for cell in 0..cells {
        let bad = |contents: &Contents, remedy: &str| Err(contents.error(place, format!("cell {cell}"), remedy));
        let end = piece.offsets[cell];
        let nodes = if end >= 0.0 { piece.connectivity.get(begin..end as usize) } else { None };
        let Some(nodes) = nodes else { return bad(contents, "its offset does not fit the connectivity") };
        begin = end as usize;
        if !nodes.iter().all(|&n| n >= 0.0 && n < points as f64) {
            return bad(contents, "it has a point that does not exist");
        }
        let nodes: Vec<u32> = nodes.iter().map(|&n| first_node + n as u32).collect();
        let names = groups.of(cell);
        let before = contents.elements.len();
        cells::add(contents, piece.types[cell] as u8, cell, &nodes, &names, place)?;
        if contents.elements.len() > before {
            for (name, vectors) in &piece.cell_vectors {
                // Elements of pieces without this array have none.
                let of_elements = contents.element_vectors.entry(name.clone()).or_default();
                of_elements.resize(before, [f64::NAN; 3]);
                of_elements.push(vectors[cell]);
            }
        }
    }
    for Named { name, values, .. } in piece.point_arrays.iter().filter(|a| is_choice(&a.values)) {
        let chosen = (0..points).filter(|&n| values[n] == 1.0).map(|n| first_node + n as u32);
        entry(&mut contents.node_sets, name).extend(chosen);
    }
    Ok(())
}

/// Zeros and ones, not only zeros.
fn is_choice(values: &[f64]) -> bool {
    values.iter().all(|&v| v == 0.0 || v == 1.0) && values.contains(&1.0)
}

/// The arrays that make groups.
struct Groups<'a> {
    arrays: Vec<(&'a Named, bool)>,
}

/// The groups of a cell.
pub(super) struct Names {
    /// `array=value`.
    values: Vec<String>,
    /// Arrays of zeros and ones.
    choices: Vec<String>,
}

impl<'a> Groups<'a> {
    fn new(arrays: &'a [Named]) -> Groups<'a> {
        let few = |values: &[f64]| {
            let mut seen = BTreeSet::new();
            values.iter().all(|v| {
                v.fract() == 0.0 && v.abs() < 1e15 && {
                    seen.insert(*v as i64);
                    seen.len() <= GROUPS
                }
            })
        };
        let arrays = arrays.iter().filter(|a| few(&a.values)).map(|a| (a, is_choice(&a.values))).collect();
        Groups { arrays }
    }

    fn of(&self, cell: usize) -> Names {
        let mut names = Names { values: Vec::new(), choices: Vec::new() };
        for (Named { name, values, is_integer }, is_choice) in &self.arrays {
            // Zeros and ones that are no integers are a set and its rest, as this crate writes them.
            if *is_integer || !*is_choice {
                names.values.push(format!("{name}={}", values[cell]));
            }
            if *is_choice && values[cell] == 1.0 {
                names.choices.push(name.clone());
            }
        }
        names
    }
}
