//! Reader of the frames that `stoss` writes: VTK XML UnstructuredGrid of hexahedra, arrays inline, either text or base64
//! with a byte-count header, little-endian, not compressed. Not a general VTK reader.

use std::collections::BTreeMap;
use std::path::Path;

use crate::base64;
use crate::{Outcome, read};

/// VTK's number of the linear hexahedron.
const HEXAHEDRON: f64 = 12.0;

/// Values on points or cells, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Array {
    /// Numbers in a row.
    pub components: usize,
    /// All rows.
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

/// One frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Coordinates of the points as stored.
    pub points: Vec<[f64; 3]>,
    /// Points of each hexahedron in VTK's order (that of formulation §3.1).
    pub hexahedra: Vec<[usize; 8]>,
    /// Arrays on points by name.
    pub point_data: BTreeMap<String, Array>,
    /// Arrays on cells by name.
    pub cell_data: BTreeMap<String, Array>,
}

/// Reads a file.
pub fn load(path: &Path) -> Outcome<Grid> {
    parse(&read(path)?).map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Reads the text of a file.
pub fn parse(text: &str) -> Result<Grid, String> {
    let header = Element::first(text, "VTKFile").ok_or("no VTKFile element")?;
    if header.attribute("byte_order").is_some_and(|order| order != "LittleEndian") {
        return Err("byte_order is not LittleEndian".into());
    }
    if header.attribute("compressor").is_some() {
        return Err("compressed arrays are not read".into());
    }
    let wide = header.attribute("header_type") == Some("UInt64");
    let section = |name: &str| Element::first(text, name).map(|section| arrays(section.content, wide)).transpose();
    let coordinates = section("Points")?.and_then(|mut found| found.pop()).ok_or("no points")?.1;
    if coordinates.components != 3 {
        return Err(format!("points have {} components, not 3", coordinates.components));
    }
    let points: Vec<[f64; 3]> = coordinates.values.as_chunks::<3>().0.to_vec();
    let cells: BTreeMap<String, Array> = section("Cells")?.unwrap_or_default().into_iter().collect();
    let grid = Grid {
        hexahedra: hexahedra(&cells, points.len())?,
        point_data: section("PointData")?.unwrap_or_default().into_iter().collect(),
        cell_data: section("CellData")?.unwrap_or_default().into_iter().collect(),
        points,
    };
    for (place, data, count) in
        [("point", &grid.point_data, grid.points.len()), ("cell", &grid.cell_data, grid.hexahedra.len())]
    {
        for (name, array) in data {
            if array.values.len() != count * array.components {
                return Err(format!("{place} array {name} has {} values for {count} {place}s", array.values.len()));
            }
        }
    }
    Ok(grid)
}

/// Time and path (relative to the collection) of every frame of a `.pvd` file.
pub fn collection(mut text: &str) -> Result<Vec<(f64, String)>, String> {
    let mut frames = Vec::new();
    while let Some(element) = Element::first(text, "DataSet") {
        let time =
            element.attribute("timestep").and_then(|time| time.parse().ok()).ok_or("a DataSet without timestep")?;
        frames.push((time, element.attribute("file").ok_or("a DataSet without file")?.to_owned()));
        text = &text[element.end..];
    }
    Ok(frames)
}

fn hexahedra(cells: &BTreeMap<String, Array>, points: usize) -> Result<Vec<[usize; 8]>, String> {
    let array = |name: &str| cells.get(name).map(|array| &array.values).ok_or(format!("no cell array {name}"));
    let (connectivity, offsets, types) = (array("connectivity")?, array("offsets")?, array("types")?);
    if offsets.len() != types.len() {
        return Err(format!("{} offsets for {} types", offsets.len(), types.len()));
    }
    if let Some(place) = connectivity.iter().position(|point| *point < 0.0 || *point >= points as f64) {
        return Err(format!("connectivity[{place}] = {} names none of {points} points", connectivity[place]));
    }
    let mut start = 0;
    let mut found = Vec::with_capacity(types.len());
    for (cell, (end, kind)) in offsets.iter().zip(types).enumerate() {
        let end = *end as usize;
        if *kind == HEXAHEDRON {
            let row = connectivity.get(start..end).and_then(|row| <&[f64; 8]>::try_from(row).ok());
            let row = row.ok_or(format!("cell {cell} is a hexahedron without 8 points"))?;
            found.push(row.map(|point| point as usize));
        }
        start = end;
    }
    Ok(found)
}

/// One XML element of a document without comments, as far as it is needed here.
struct Element<'a> {
    tag: &'a str,
    content: &'a str,
    end: usize,
}

impl<'a> Element<'a> {
    /// The first element of that name; `end` is the place behind it.
    fn first(text: &'a str, name: &str) -> Option<Self> {
        let open = format!("<{name}");
        let mut from = 0;
        let start = loop {
            let start = from + text[from..].find(&open)?;
            from = start + open.len();
            if text[from..].starts_with(|next: char| next.is_whitespace() || next == '>' || next == '/') {
                break start;
            }
        };
        let tag_end = start + text[start..].find('>')?;
        let tag = &text[start + open.len()..tag_end];
        if let Some(tag) = tag.strip_suffix('/') {
            return Some(Self { tag, content: "", end: tag_end + 1 });
        }
        let close = format!("</{name}>");
        let length = text[tag_end + 1..].find(&close)?;
        let content = &text[tag_end + 1..tag_end + 1 + length];
        Some(Self { tag, content, end: tag_end + 1 + length + close.len() })
    }

    fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.tag;
        while let Some((key, after)) = rest.split_once('=') {
            let (value, next) = after.trim_start().strip_prefix('"')?.split_once('"')?;
            if key.trim() == name {
                return Some(value);
            }
            rest = next;
        }
        None
    }
}

fn arrays(mut section: &str, wide: bool) -> Result<Vec<(String, Array)>, String> {
    let mut found = Vec::new();
    while let Some(element) = Element::first(section, "DataArray") {
        let name = element.attribute("Name").unwrap_or_default().to_owned();
        let components = match element.attribute("NumberOfComponents") {
            Some(count) => {
                count.parse().ok().filter(|count| *count > 0).ok_or(format!("array {name}: components {count}"))?
            }
            None => 1,
        };
        let values = values(&element, wide).map_err(|error| format!("array {name}: {error}"))?;
        if values.len() % components != 0 {
            return Err(format!("array {name}: {} values are no rows of {components}", values.len()));
        }
        found.push((name, Array { components, values }));
        section = &section[element.end..];
    }
    Ok(found)
}

fn values(element: &Element, wide: bool) -> Result<Vec<f64>, String> {
    match element.attribute("format") {
        Some("ascii") => element
            .content
            .split_whitespace()
            .map(|word| word.parse().map_err(|_| format!("{word:?} is no number")))
            .collect(),
        Some("binary") => {
            let bytes = base64::decode(element.content)?;
            let header = if wide { 8 } else { 4 };
            let (count, data) = bytes.split_at_checked(header).ok_or("no byte count")?;
            let count = if wide { u64_of(count) } else { u64::from(u32_of(count)) };
            if count != data.len() as u64 {
                return Err(format!("header says {count} bytes, {} follow", data.len()));
            }
            numbers(data, element.attribute("type").unwrap_or_default())
        }
        other => Err(format!("format {other:?} is not read")),
    }
}

fn u64_of(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))
}

fn u32_of(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
}

fn numbers(data: &[u8], kind: &str) -> Result<Vec<f64>, String> {
    let convert: fn(&[u8]) -> f64 = match kind {
        "Float64" => |bytes| f64::from_bits(u64_of(bytes)),
        "Float32" => |bytes| f64::from(f32::from_bits(u32_of(bytes))),
        "Int64" => |bytes| u64_of(bytes) as i64 as f64,
        "Int32" => |bytes| f64::from(u32_of(bytes) as i32),
        "UInt8" => |bytes| f64::from(bytes[0]),
        _ => return Err(format!("type {kind:?} is not read")),
    };
    let size = match kind {
        "UInt8" => 1,
        "Float32" | "Int32" => 4,
        _ => 8,
    };
    if !data.len().is_multiple_of(size) {
        return Err(format!("{} bytes are no whole number of {kind}", data.len()));
    }
    Ok(data.chunks_exact(size).map(convert).collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn encode(bytes: &[u8]) -> String {
        const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut text = String::new();
        for group in bytes.chunks(3) {
            let word = (0..3).fold(0u32, |word, i| word << 8 | u32::from(group.get(i).copied().unwrap_or(0)));
            for i in 0..4 {
                let digit = DIGITS[(word >> (18 - 6 * i) & 63) as usize];
                text.push(if i > group.len() { '=' } else { char::from(digit) });
            }
        }
        text
    }

    fn binary(bytes: &[u8]) -> String {
        encode(&[&(bytes.len() as u64).to_le_bytes(), bytes].concat())
    }

    fn float_array(name: &str, components: usize, values: &[f64], ascii: bool) -> String {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let text: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
        let (format, content) = if ascii { ("ascii", text.join(" ")) } else { ("binary", binary(&bytes)) };
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"{format}\">\n\
             {content}\n</DataArray>\n"
        )
    }

    /// Text of a frame with one array `speed` on the points.
    pub fn write(points: &[[f64; 3]], hexahedra: &[[usize; 8]], speed: &[f64], ascii: bool) -> String {
        let connectivity: Vec<u8> = hexahedra.iter().flatten().flat_map(|p| (*p as i64).to_le_bytes()).collect();
        let offsets: Vec<u8> = (1..=hexahedra.len() as i64).flat_map(|cell| (8 * cell).to_le_bytes()).collect();
        let types = vec![12u8; hexahedra.len()];
        let integers = |kind: &str, name: &str, bytes: &[u8]| {
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"binary\">{}</DataArray>\n", binary(bytes))
        };
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n\
             <PointData>\n{}</PointData>\n<CellData/>\n<Points>\n{}</Points>\n<Cells>\n{}{}{}</Cells>\n</Piece>\n\
             </UnstructuredGrid>\n</VTKFile>\n",
            points.len(),
            hexahedra.len(),
            float_array("speed", 1, speed, ascii),
            float_array("Points", 3, points.as_flattened(), ascii),
            integers("Int64", "connectivity", &connectivity),
            integers("Int64", "offsets", &offsets),
            integers("UInt8", "types", &types),
        )
    }

    /// The eight corners of a unit cube in VTK's order.
    pub const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];

    #[test]
    fn text_and_binary_give_the_same_grid() {
        let points = CUBE.map(|point| point.map(|x| 0.1 + x / 3.0));
        let speed = [0.0, -1.5, 1e-300, 2.0, f64::MAX, 5.0, 6.0, 7.0];
        for ascii in [true, false] {
            let grid = parse(&write(&points, &[[0, 1, 2, 3, 4, 5, 6, 7]], &speed, ascii)).unwrap();
            assert_eq!(grid.points, points);
            assert_eq!(grid.hexahedra, [[0, 1, 2, 3, 4, 5, 6, 7]]);
            assert_eq!(grid.point_data["speed"].values, speed);
            assert_eq!(grid.point_data["speed"].magnitude(1), -1.5);
            assert!(grid.cell_data.is_empty());
        }
    }

    #[test]
    fn every_number_type_is_read() {
        assert_eq!(numbers(&(-3i64).to_le_bytes(), "Int64").unwrap(), [-3.0]);
        assert_eq!(numbers(&(-3i32).to_le_bytes(), "Int32").unwrap(), [-3.0]);
        assert_eq!(numbers(&0.25f32.to_le_bytes(), "Float32").unwrap(), [0.25]);
        assert_eq!(numbers(&0.1f64.to_le_bytes(), "Float64").unwrap(), [0.1]);
        assert_eq!(numbers(&[255], "UInt8").unwrap(), [255.0]);
        assert!(numbers(&[0; 7], "Float64").is_err());
        assert!(numbers(&[0; 8], "String").is_err());
    }

    #[test]
    fn frames_of_a_collection() {
        let text = "<VTKFile><Collection><DataSet timestep=\"0\" part=\"0\" file=\"frames/a.vtu\"/>\n\
                    <DataSet timestep=\"1e-1\" file=\"frames/b.vtu\"></DataSet></Collection></VTKFile>";
        assert_eq!(collection(text).unwrap(), [(0.0, "frames/a.vtu".to_owned()), (0.1, "frames/b.vtu".to_owned())]);
        assert!(collection("<DataSet file=\"a\"/>").is_err());
    }

    #[test]
    fn damaged_files_are_refused() {
        let good = write(&CUBE, &[[0, 1, 2, 3, 4, 5, 6, 7]], &[0.0; 8], true);
        let damage = [
            good.replace("LittleEndian", "BigEndian"),
            good.replace("Name=\"connectivity\"", "Name=\"other\""),
            good.replace("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\""),
            good.replace("format=\"ascii\"", "format=\"appended\""),
            write(&CUBE[..7], &[[0, 1, 2, 3, 4, 5, 6, 7]], &[0.0; 7], true),
            write(&CUBE, &[[0, 1, 2, 3, 4, 5, 6, 7]], &[0.0; 7], true),
            good[..good.len() / 4].to_owned(),
        ];
        for (number, text) in damage.iter().enumerate() {
            assert!(parse(text).is_err(), "damage {number}");
        }
    }
}
