//! What the page knows of a run, packed: a length (4 bytes, little endian), a header of that length in JSON, and arrays one behind the other, all
//! of it in one gzip member. The header says where each array is, counted from its own end.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::time::SystemTime;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;
use serde_json::Value;

use super::coding::{Scale, encode};
use super::distance;
use super::fields::{self, Field};
use super::shape::{Body, Connectivity};
use super::tables::{self, Columns};
use crate::Outcome;
use crate::folder::Folder;
use crate::units;
use crate::vtu::Grid;

/// Most numbers in the streams of all runs: they fill 2 bytes each in a browser's memory. Beyond, frames are left out evenly.
const NUMBERS: usize = 40_000_000;
/// Largest code of a position, and of a displacement.
const CODES: f64 = 65_535.0;
const SIGNED_CODES: f64 = 32_767.0;
/// The array that moves the nodes.
const DISPLACEMENT: &str = "displacement";

/// Bytes of the payload at which an array is: start and length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ByteRange {
    start: usize,
    bytes: usize,
}

/// Positions and fields over the frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Animation {
    /// Times of the frames.
    times: Vec<f64>,
    /// Every how many stored frames one is shown.
    every: usize,
    bodies: Vec<Body>,
    /// Number of nodes.
    nodes: usize,
    /// Smallest corner and edges of the box of the reference configuration: `position = corner + code / 65535 edge`.
    corner: [f64; 3],
    edges: [f64; 3],
    /// Largest size of each component of the displacement: `displacement = largest code / 32767` with signed codes.
    largest: [f64; 3],
    /// Facets (four `u32`), segments (two), points (one), elements (eight), and the points of the frames that the nodes are (one).
    facets: ByteRange,
    /// Sides of each facet that are edges of elements, as bits.
    sides: ByteRange,
    segments: ByteRange,
    points: ByteRange,
    elements: ByteRange,
    numbers: ByteRange,
    /// Positions in the reference configuration: `x` of all nodes, `y`, `z`.
    reference: ByteRange,
    /// Displacements of the frames, streams in the same order.
    displacement: ByteRange,
    arrays: Vec<PackedArray>,
    fields: Vec<PackedField>,
}

/// An array over the frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct PackedArray {
    /// Name of the array in the frames.
    name: String,
    /// Name of the array for people.
    label: String,
    components: Vec<Component>,
}

/// A component of an array.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Component {
    /// Largest magnitude, see [`Scale::Root`]; nothing for [`Scale::Integer`].
    largest: Option<f64>,
    stream: ByteRange,
}

/// A field that the page makes of an array. Those of the displacement are not among them: the page makes them of what moves the nodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct PackedField {
    #[serde(flatten)]
    field: Field,
    /// Number of the array among those that are packed.
    array: usize,
    /// Unit of the field, if it has one.
    unit: Option<String>,
}

/// The header.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Header<'a> {
    name: &'a str,
    values: &'a BTreeMap<String, f64>,
    summary: Option<&'a Value>,
    run: Option<&'a Value>,
    setup: Option<&'a Value>,
    tables: Vec<Columns>,
    animation: Option<Animation>,
    notes: Vec<String>,
}

/// Options by which a run is packed.
#[derive(Clone, Debug)]
pub struct Packing<'a> {
    /// Name of the run on the page.
    pub name: &'a str,
    /// Values of the parameters by which it differs from the other runs of the page.
    pub values: &'a BTreeMap<String, f64>,
    /// Number of runs on the page: they share what a browser can hold.
    pub runs: usize,
    /// Whether time counts more than bytes.
    pub is_fast: bool,
}

/// What tells a frame from another, without reading it.
#[derive(Clone, Debug, PartialEq)]
struct Stamp {
    path: PathBuf,
    time: f64,
    written: Option<(SystemTime, u64)>,
}

/// Frames that were read: packing a run again while it grows reads the new ones only.
#[derive(Debug, Default)]
pub struct Cache {
    shape: Connectivity,
    fields: Vec<Field>,
    /// Names and numbers of components of the arrays.
    arrays: Vec<(String, usize)>,
    stamps: Vec<Stamp>,
    streams: Streams,
    /// The frames have no displacement.
    is_undeformed: bool,
}

/// Displacements and values of the drawn nodes in all frames.
#[derive(Debug, Default)]
struct Streams {
    times: Vec<f64>,
    reference: Vec<[f64; 3]>,
    displacement: Vec<[f64; 3]>,
    /// Values of every component of every array.
    components: Vec<Vec<f32>>,
}

/// Packs a run; the notes say what is missing or was left out.
///
/// # Errors
/// None but of the compression.
pub fn pack(folder: &Folder, packing: &Packing, cache: &mut Cache) -> Outcome<(Vec<u8>, Vec<String>)> {
    let mut notes = folder.notes.clone();
    let mut arrays = Vec::new();
    let animation = animation(folder, packing.runs, cache, &mut arrays, &mut notes);
    let tables = tables::all(folder, packing.runs, &mut notes);
    let header = Header {
        name: packing.name,
        values: packing.values,
        summary: folder.summary.as_ref(),
        run: folder.run.as_ref(),
        setup: folder.setup.as_ref(),
        tables,
        animation,
        notes: notes.clone(),
    };
    let header = serde_json::to_vec(&header)?;
    let level = if packing.is_fast { Compression::fast() } else { Compression::default() };
    let mut out = GzEncoder::new(Vec::new(), level);
    out.write_all(&(header.len() as u32).to_le_bytes())?;
    out.write_all(&header)?;
    out.write_all(&arrays)?;
    Ok((out.finish()?, notes))
}

/// The animation; nothing for a folder without frames that can be read.
fn animation(
    folder: &Folder,
    runs: usize,
    cache: &mut Cache,
    arrays: &mut Vec<u8>,
    notes: &mut Vec<String>,
) -> Option<Animation> {
    if folder.frames.is_empty() {
        return None;
    }
    if cache.stamps.first() != Some(&stamp(folder, 0)) {
        let first = frame(folder, 0).map_err(|error| notes.push(error.to_string())).ok()?;
        *cache = Cache::new(&first, folder, runs, notes);
    }
    if cache.shape.nodes.is_empty() {
        return None;
    }
    if cache.is_undeformed {
        let folder = folder.path().display();
        notes.push(format!("{folder}: the frames have no displacement: bodies are shown where they were at the start"));
    }
    let count = folder.frames.len();
    let most = (NUMBERS / runs.max(1) / cache.numbers()).max(2);
    let every = count.div_ceil(most);
    if every > 1 {
        notes.push(format!("{}: only one frame in {every} is shown, because there are many", folder.path().display()));
    }
    let numbers: Vec<usize> = (0..count - 1).step_by(every).chain([count - 1]).collect();
    cache.read(folder, &numbers, notes);
    if cache.stamps.is_empty() {
        return None;
    }
    Some(cache.packed(folder, every, arrays))
}

/// A frame; that of a scene before its run with the distances between bodies.
fn frame(folder: &Folder, number: usize) -> Outcome<Grid> {
    let mut grid = folder.grid(number)?;
    if let Some(distances) = folder.setup.as_ref().and_then(|_| distance::distances(&grid)) {
        grid.point_data.insert(distance::NAME.to_owned(), distances);
    }
    Ok(grid)
}

fn stamp(folder: &Folder, frame: usize) -> Stamp {
    let frame = &folder.frames[frame];
    let written = std::fs::metadata(&frame.path).and_then(|data| Ok((data.modified()?, data.len()))).ok();
    Stamp { path: frame.path.clone(), time: frame.time, written }
}

impl Cache {
    /// What the first frame has; the inside of bodies is left out where the frames would be too much with it.
    fn new(first: &Grid, folder: &Folder, runs: usize, notes: &mut Vec<String>) -> Self {
        let is_kept = |name: &str| name != DISPLACEMENT && !fields::is_made_of_stress(name, first);
        let arrays: Vec<(String, usize)> = first
            .point_data
            .iter()
            .filter(|(name, _)| is_kept(name))
            .map(|(name, array)| (name.clone(), array.components))
            .collect();
        let streams = vec![Vec::new(); arrays.iter().map(|(_, components)| components).sum()];
        let of_shape = |shape: Connectivity| {
            let reference = shape.nodes.iter().map(|&point| first.points[point]).collect();
            let streams = Streams { reference, components: streams.clone(), ..Streams::default() };
            let (fields, arrays) = (Field::of(first), arrays.clone());
            Self { shape, fields, arrays, stamps: Vec::new(), streams, is_undeformed: crate::vtu::is_undeformed(first) }
        };
        let whole = of_shape(Connectivity::new(first, &folder.bodies, true));
        if whole.numbers() * folder.frames.len() <= NUMBERS / runs.max(1) {
            return whole;
        }
        notes.push(format!("{}: the inside of the bodies is left out, because it is much", folder.path().display()));
        of_shape(Connectivity::new(first, &folder.bodies, false))
    }

    /// Count of the numbers of a frame.
    fn numbers(&self) -> usize {
        self.shape.nodes.len() * (3 + self.streams.components.len())
    }

    /// Reads these frames as far as they can be read, but for those at the beginning that are known.
    fn read(&mut self, folder: &Folder, numbers: &[usize], notes: &mut Vec<String>) {
        let nodes = self.shape.nodes.len();
        let same = self.stamps.iter().zip(numbers).take_while(|(known, number)| **known == stamp(folder, **number));
        let known = same.count();
        self.stamps.truncate(known);
        self.streams.times.truncate(known);
        self.streams.displacement.truncate(known * nodes);
        self.streams.components.iter_mut().for_each(|values| values.truncate(known * nodes));
        for &number in &numbers[known..] {
            // Before reading: what is written again meanwhile is read again.
            let stamp = stamp(folder, number);
            let fits = |grid: Grid| if self.shape.fits(&grid) { Ok(grid) } else { Err(unlike(folder, number).into()) };
            let grid = match frame(folder, number).and_then(fits) {
                Ok(grid) => grid,
                Err(error) => {
                    notes.push(format!("{error}; this frame and those after it are not shown"));
                    break;
                }
            };
            self.stamps.push(stamp);
            self.add(folder.frames[number].time, &grid);
        }
    }

    fn add(&mut self, time: f64, grid: &Grid) {
        let Self { shape, arrays, streams, .. } = self;
        streams.times.push(time);
        let displacement = grid.point_data.get(DISPLACEMENT).filter(|array| array.components == 3);
        streams.displacement.extend(shape.nodes.iter().map(|&point| {
            let moved = displacement.map_or(&[0.0; 3][..], |array| array.row(point));
            // What is no number stays where it was.
            std::array::from_fn(|k| if moved[k].is_finite() { moved[k] } else { 0.0 })
        }));
        let places = arrays.iter().flat_map(|(name, components)| (0..*components).map(move |k| (name, *components, k)));
        for ((name, components, k), values) in places.zip(&mut streams.components) {
            let array = grid.point_data.get(name).filter(|array| array.components == components);
            let value = |&point: &usize| array.map_or(f32::NAN, |array| array.row(point)[k] as f32);
            values.extend(shape.nodes.iter().map(value));
        }
    }

    fn packed(&self, folder: &Folder, every: usize, arrays: &mut Vec<u8>) -> Animation {
        let Self { shape, streams, .. } = self;
        let nodes = shape.nodes.len();
        let mut put = |bytes: &mut dyn FnMut(&mut Vec<u8>)| {
            let start = arrays.len();
            bytes(arrays);
            ByteRange { start, bytes: arrays.len() - start }
        };
        let mut whole = |numbers: &[u32]| put(&mut |out| out.extend(numbers.iter().flat_map(|n| n.to_le_bytes())));
        let facets = whole(shape.facets.as_flattened());
        let sides = whole(&shape.sides);
        let segments = whole(shape.segments.as_flattened());
        let points = whole(&shape.points);
        let elements = whole(shape.elements.as_flattened());
        let numbers = whole(&shape.nodes.iter().map(|&point| point as u32).collect::<Vec<_>>());
        let (corner, edges) = bounds(&streams.reference);
        let code = |place: &[f64; 3], k: usize| match edges[k] > 0.0 {
            true => ((place[k] - corner[k]) / edges[k] * CODES).round() as u16,
            false => 0,
        };
        let codes = by_axis(&streams.reference, nodes, code);
        let reference = put(&mut |out| encode(&codes, 3 * nodes, out));
        let largest =
            std::array::from_fn(|k| streams.displacement.iter().fold(0.0, |most: f64, u| most.max(u[k].abs())));
        let code = |moved: &[f64; 3], k: usize| match largest[k] > 0.0 {
            true => (moved[k] / largest[k] * SIGNED_CODES).round() as i16 as u16,
            false => 0,
        };
        let codes = by_axis(&streams.displacement, nodes, code);
        let displacement = put(&mut |out| encode(&codes, 3 * nodes, out));
        let mut components = streams.components.iter();
        let mut packed = Vec::new();
        for (name, count) in &self.arrays {
            let values: Vec<&Vec<f32>> = components.by_ref().take(*count).collect();
            // What has no value anywhere is no array.
            if values.iter().any(|values| values.iter().any(|value| value.is_finite())) {
                let components = values.iter().map(|values| component(values, nodes, &mut put)).collect();
                packed.push(PackedArray { name: name.clone(), label: fields::label(name), components });
            }
        }
        let fields = self.fields.iter().filter_map(|field| {
            let array = packed.iter().position(|array| array.name == field.array)?;
            Some(PackedField { field: field.clone(), array, unit: units::of_field(folder, &field.array) })
        });
        let (fields, bodies, times) = (fields.collect(), shape.bodies.clone(), streams.times.clone());
        Animation {
            times,
            every,
            bodies,
            nodes,
            corner,
            edges,
            largest,
            facets,
            sides,
            segments,
            points,
            elements,
            numbers,
            reference,
            displacement,
            arrays: packed,
            fields,
        }
    }
}

/// Codes of the rows of vectors, `x` of all nodes, `y`, `z` in each.
fn by_axis(vectors: &[[f64; 3]], nodes: usize, code: impl Fn(&[f64; 3], usize) -> u16 + Copy) -> Vec<u16> {
    vectors.chunks(nodes).flat_map(|row| (0..3).flat_map(move |k| row.iter().map(move |v| code(v, k)))).collect()
}

fn component(
    values: &[f32],
    nodes: usize,
    put: &mut impl FnMut(&mut dyn FnMut(&mut Vec<u8>)) -> ByteRange,
) -> Component {
    let scale = Scale::of(values);
    let codes: Vec<u16> = values.iter().map(|value| scale.code(*value)).collect();
    let largest = match scale {
        Scale::Root { largest } => Some(largest),
        Scale::Integer => None,
    };
    Component { largest, stream: put(&mut |out| encode(&codes, nodes, out)) }
}

fn unlike(folder: &Folder, frame: usize) -> String {
    format!("{}: it has other cells or points than the first frame", folder.frames[frame].path.display())
}

/// Smallest corner and edges of the box around places.
fn bounds(places: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for place in places {
        for k in 0..3 {
            low[k] = low[k].min(place[k]);
            high[k] = high[k].max(place[k]);
        }
    }
    (low, std::array::from_fn(|k| high[k] - low[k]))
}
