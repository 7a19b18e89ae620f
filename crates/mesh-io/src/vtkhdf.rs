//! VTKHDF: all frames of a run in one HDF5 file, as an unstructured grid over time (VTK 9.2 and later, ParaView 5.12 and later).
//!
//! The group `VTKHDF` has points and cells once, arrays on points with the rows of all frames below each other (`PointData`), arrays on cells
//! once (`CellData`), and the group `Steps` with the time of every frame and the places of its rows. The group `Stoss` has the numbers of
//! the steps. A frame is appended in place, and between two frames the file is closed and complete. Every frame has the points, cells and
//! arrays of the first one, and the same values on cells.
//!
//! What is read are files that this module wrote. Nothing is locked: a program that reads while a frame is written must be able to try again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::atomic;
use crate::{Array, MeshIoError, VtuData, VtuFrame};
use rust_hdf5::{DatatypeMessage, H5Dataset, H5File, H5Group, H5Type, Hdf5Error};

/// Numbers in a chunk of an array with one number a frame.
const CHUNK: usize = 64;
/// Level of the deflation, from 1 (fast) to 9.
const LEVEL: u32 = 4;
/// Arrays of the group `Steps` that are the same for every frame: there is one part, and its points and cells are not repeated.
const CONSTANTS: [(&str, i64); 5] =
    [("PartOffsets", 0), ("NumberOfParts", 1), ("PointOffsets", 0), ("CellOffsets", 0), ("ConnectivityIdOffsets", 0)];
const COUNT: &str = "NSteps";
const GRID: &str = "VTKHDF";
const STEPS: &str = "VTKHDF/Steps";
const TIMES: &str = "VTKHDF/Steps/Values";
const OURS: &str = "Stoss";
const NUMBERS: &str = "Stoss/StepNumbers";

fn error(path: &Path, problem: impl std::fmt::Display) -> MeshIoError {
    MeshIoError::Container { path: path.to_owned(), problem: problem.to_string() }
}

/// Writes a file with one frame, of this step, under a temporary name first.
///
/// # Errors
/// [`MeshIoError::Output`] if the data do not fit together, if there is no time, or for fields of the frame as a whole, which are not
/// stored; [`MeshIoError::Io`], [`MeshIoError::Container`].
pub fn create_vtkhdf(path: impl AsRef<Path>, frame: &VtuFrame, step: u64) -> Result<(), MeshIoError> {
    let path = path.as_ref();
    let time = time(frame)?;
    atomic::through(path, |scratch| fill(scratch, frame, step, time).map_err(|problem| error(path, problem)))
}

fn fill(path: &Path, frame: &VtuFrame, step: u64, time: f64) -> Result<(), Hdf5Error> {
    let file = H5File::options().no_locking().create(path)?;
    let grid = file.create_group(GRID)?;
    grid.set_attr_array_numeric("Version", &[2_i64, 2])?;
    let kind = "UnstructuredGrid";
    // VTK takes a string of fixed length only.
    let fixed = DatatypeMessage::FixedString { size: kind.len() as u32, padding: 1, charset: 0 };
    grid.set_attr_typed("Type", fixed, kind.as_bytes().to_vec())?;
    let ids: Vec<i64> = frame.cells().flat_map(|(_, nodes)| nodes.iter().map(|&node| i64::from(node))).collect();
    let counts = [frame.points.len(), frame.cell_count(), ids.len()];
    for (name, count) in ["NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"].into_iter().zip(counts) {
        plain(&grid, name, &[1], &[count as i64])?;
    }
    let mut ends = vec![0];
    frame.cells().for_each(|(_, nodes)| ends.push(ends[ends.len() - 1] + nodes.len() as i64));
    let kinds: Vec<u8> = frame.cells().map(|(kind, _)| kind).collect();
    let [points, cells, _] = counts;
    plain(&grid, "Points", &[points, 3], frame.points.as_flattened())?;
    plain(&grid, "Connectivity", &[ids.len()], &ids)?;
    plain(&grid, "Offsets", &[cells + 1], &ends)?;
    plain(&grid, "Types", &[cells], &kinds)?;
    let steps = grid.create_group("Steps")?;
    steps.set_attr_numeric(COUNT, &1_i64)?;
    growing(&steps, "Values", time)?;
    for (name, value) in CONSTANTS {
        growing(&steps, name, value)?;
    }
    let (data, offsets) = (grid.create_group("PointData")?, steps.create_group("PointDataOffsets")?);
    for field in &frame.point_data {
        let shape = shape(points, field.components);
        let most: Vec<Option<usize>> = std::iter::once(None).chain(shape[1..].iter().map(|&n| Some(n))).collect();
        let empty = [&[0], &shape[1..]].concat();
        let set = data.new_dataset::<f64>().shape(empty).chunk(&shape).max_shape(&most).shuffle_deflate(LEVEL);
        set.create(field.name)?.append(field.values)?;
        growing(&offsets, field.name, 0_i64)?;
    }
    let (data, offsets) = (grid.create_group("CellData")?, steps.create_group("CellDataOffsets")?);
    for field in &frame.cell_data {
        plain(&data, field.name, &shape(cells, field.components), field.values)?;
        growing(&offsets, field.name, 0_i64)?;
    }
    growing(&file.create_group(OURS)?, "StepNumbers", step)?;
    file.close_no_sync()
}

/// Rows, and columns if there is more than one.
fn shape(rows: usize, columns: usize) -> Vec<usize> {
    if columns == 1 { vec![rows] } else { vec![rows, columns] }
}

fn plain<T: H5Type>(group: &H5Group, name: &str, shape: &[usize], values: &[T]) -> Result<(), Hdf5Error> {
    group.new_dataset::<T>().shape(shape).create(name)?.write_raw(values)
}

/// An array with one number a frame.
fn growing<T: H5Type>(group: &H5Group, name: &str, value: T) -> Result<(), Hdf5Error> {
    group.new_dataset::<T>().shape([0]).chunk(&[CHUNK]).max_shape(&[None]).create(name)?.append(&[value])
}

fn time(frame: &VtuFrame) -> Result<f64, MeshIoError> {
    frame.validate()?;
    let bad =
        |name: &str, problem: &str| Err(MeshIoError::Output { name: name.to_owned(), problem: problem.to_owned() });
    match (frame.time, frame.field_data.first()) {
        (_, Some(field)) => bad(field.name, "fields of a whole frame are not stored in VTKHDF files"),
        (None, _) => bad("time", "frames of a VTKHDF file have a time"),
        (Some(time), None) => Ok(time),
    }
}

/// Appends a frame to a file that this module wrote.
///
/// # Errors
/// The errors of [`create_vtkhdf`]; [`MeshIoError::Output`] if the frame has other numbers of points or cells, or other arrays, than the file.
pub fn append_vtkhdf(path: impl AsRef<Path>, frame: &VtuFrame, step: u64) -> Result<(), MeshIoError> {
    let path = path.as_ref();
    let time = time(frame)?;
    let before = VtkhdfFile::open(path)?;
    if !before.takes(frame)? {
        let problem = "points, cells or arrays are not those of the frames that the file has".to_owned();
        return Err(MeshIoError::Output { name: "frame".to_owned(), problem });
    }
    let count = before.frames.len();
    drop(before);
    add(path, frame, step, time, count).map_err(|problem| error(path, problem))
}

fn add(path: &Path, frame: &VtuFrame, step: u64, time: f64, count: usize) -> Result<(), Hdf5Error> {
    let file = writable(path)?;
    let first = (count * frame.points.len()) as i64;
    for field in &frame.point_data {
        file.dataset_writer(&format!("{GRID}/PointData/{}", field.name))?.append(field.values)?;
        file.dataset_writer(&format!("{STEPS}/PointDataOffsets/{}", field.name))?.append(&[first])?;
    }
    for field in &frame.cell_data {
        file.dataset_writer(&format!("{STEPS}/CellDataOffsets/{}", field.name))?.append(&[0_i64])?;
    }
    for (name, value) in CONSTANTS {
        file.dataset_writer(&format!("{STEPS}/{name}"))?.append(&[value])?;
    }
    file.dataset_writer(TIMES)?.append(&[time])?;
    file.dataset_writer(NUMBERS)?.append(&[step])?;
    counted(file, count + 1)
}

fn writable(path: &Path) -> Result<H5File, Hdf5Error> {
    H5File::options().no_locking().open_rw(path)
}

/// Sets the number of frames and closes the file.
fn counted(file: H5File, count: usize) -> Result<(), Hdf5Error> {
    file.root_group().group(STEPS)?.set_attr_numeric(COUNT, &(count as i64))?;
    file.close_no_sync()
}

/// Keeps the first frames of a file, `count` of them, and removes all others.
///
/// # Errors
/// [`MeshIoError::Container`]; also if there are fewer frames, or none is to be kept.
pub fn keep_vtkhdf(path: impl AsRef<Path>, count: usize) -> Result<(), MeshIoError> {
    let path = path.as_ref();
    let before = VtkhdfFile::open(path)?;
    let found = before.frames.len();
    if count == 0 || found < count {
        return Err(error(path, format!("it has {found} frames, {count} of them cannot be kept")));
    }
    if found == count {
        return Ok(());
    }
    let names = before.names("PointData")?;
    let on_cells = before.names("CellData")?;
    let rows = count * before.points;
    drop(before);
    let cut = || -> Result<(), Hdf5Error> {
        let file = writable(path)?;
        let cut = |name: &str, rows: usize| {
            let set = file.dataset_writer(name)?;
            let mut shape = set.shape();
            shape[0] = rows;
            set.set_extent(&shape)
        };
        for name in &names {
            cut(&format!("{GRID}/PointData/{name}"), rows)?;
            cut(&format!("{STEPS}/PointDataOffsets/{name}"), count)?;
        }
        for name in &on_cells {
            cut(&format!("{STEPS}/CellDataOffsets/{name}"), count)?;
        }
        for (name, _) in CONSTANTS {
            cut(&format!("{STEPS}/{name}"), count)?;
        }
        cut(TIMES, count)?;
        cut(NUMBERS, count)?;
        counted(file, count)
    };
    cut().map_err(|problem| error(path, problem))
}

/// A file that is open for reading.
pub struct VtkhdfFile {
    path: PathBuf,
    file: H5File,
    points: usize,
    cells: usize,
    /// Step and time of every frame.
    frames: Vec<(u64, f64)>,
}

impl std::fmt::Debug for VtkhdfFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VtkhdfFile").field("path", &self.path).field("frames", &self.frames).finish_non_exhaustive()
    }
}

impl VtkhdfFile {
    /// Opens a file.
    ///
    /// # Errors
    /// [`MeshIoError::Container`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, MeshIoError> {
        let path = path.as_ref();
        let failed = |problem: Hdf5Error| error(path, problem);
        let file = H5File::options().no_locking().open(path).map_err(failed)?;
        let number = |name: &str| {
            let values =
                file.dataset(&format!("{GRID}/{name}")).and_then(|set| set.read_raw::<i64>()).map_err(failed)?;
            let value = values.first().and_then(|&value| usize::try_from(value).ok());
            value.ok_or_else(|| error(path, format!("{name} must be a number that is not negative")))
        };
        let (points, cells) = (number("NumberOfPoints")?, number("NumberOfCells")?);
        let steps = file.dataset(NUMBERS).and_then(|set| set.read_raw::<u64>()).map_err(failed)?;
        let times = file.dataset(TIMES).and_then(|set| set.read_raw::<f64>()).map_err(failed)?;
        if steps.len() != times.len() {
            return Err(error(
                path,
                format!("it has {} steps and {} times: it is damaged, write it again", steps.len(), times.len()),
            ));
        }
        let frames = steps.into_iter().zip(times).collect();
        Ok(Self { path: path.to_owned(), file, points, cells, frames })
    }

    /// Step and time of every frame.
    pub fn frames(&self) -> &[(u64, f64)] {
        &self.frames
    }

    /// Reads a frame, counted from 0; arrays by name.
    ///
    /// # Errors
    /// [`MeshIoError::Container`], also for a frame that does not exist.
    pub fn read(&self, frame: usize) -> Result<VtuData, MeshIoError> {
        let failed = |problem: Hdf5Error| error(&self.path, problem);
        let &(_, time) =
            self.frames.get(frame).ok_or_else(|| error(&self.path, format!("there is no frame {frame}")))?;
        let mut data = VtuData { time: Some(time), ..VtuData::default() };
        data.points = self.set("Points")?.read_raw::<f64>().map_err(failed)?.as_chunks().0.to_vec();
        let nodes = self.set("Connectivity")?.read_raw::<i64>().map_err(failed)?;
        let ends = self.set("Offsets")?.read_raw::<i64>().map_err(failed)?;
        let kinds = self.set("Types")?.read_raw::<u8>().map_err(failed)?;
        let numbers = nodes.iter().map(|&n| u32::try_from(n).ok().filter(|&n| (n as usize) < self.points));
        let numbers: Option<Vec<u32>> = numbers.collect();
        let cell =
            |ends: &[i64]| numbers.as_deref()?.get(usize::try_from(ends[0]).ok()?..usize::try_from(ends[1]).ok()?);
        let cells: Option<Vec<(u8, &[u32])>> =
            kinds.iter().zip(ends.windows(2)).map(|(&kind, ends)| Some((kind, cell(ends)?))).collect();
        let fits = data.points.len() == self.points
            && kinds.len() == self.cells
            && ends.len() == self.cells + 1
            && ends.first() == Some(&0)
            && ends.last().is_some_and(|&end| end as usize == nodes.len())
            && cells.is_some_and(|cells| data.add_cells(cells.into_iter()).is_some());
        if !fits {
            return Err(error(&self.path, "points and cells do not fit their numbers"));
        }
        data.point_data = self.fields("PointData", frame, self.points)?;
        data.cell_data = self.fields("CellData", frame, self.cells)?;
        Ok(data)
    }

    fn set(&self, name: &str) -> Result<H5Dataset, MeshIoError> {
        self.file.dataset(&format!("{GRID}/{name}")).map_err(|problem| error(&self.path, problem))
    }

    /// Names of the arrays of a group, sorted.
    fn names(&self, group: &str) -> Result<Vec<String>, MeshIoError> {
        let names = self.file.root_group().group(&format!("{GRID}/{group}")).and_then(|group| group.dataset_names());
        let mut names = names.map_err(|problem| error(&self.path, problem))?;
        names.sort();
        Ok(names)
    }

    /// Arrays of a group in a frame, by name.
    fn fields(&self, group: &str, frame: usize, rows: usize) -> Result<BTreeMap<String, Array>, MeshIoError> {
        let failed = |problem: Hdf5Error| error(&self.path, problem);
        let field = |name: String| {
            let offset = self.set(&format!("Steps/{group}Offsets/{name}"))?;
            let offset = offset.read_slice::<i64>(&[frame], &[1]).map_err(failed)?;
            let set = self.set(&format!("{group}/{name}"))?;
            let components = set.shape().get(1).copied().unwrap_or(1);
            let first = offset.first().and_then(|&first| usize::try_from(first).ok());
            let first = first.ok_or_else(|| error(&self.path, format!("the array {name} is cut off")))?;
            let counts = shape(rows, components);
            let starts = [&[first], &vec![0; counts.len() - 1][..]].concat();
            let values = set.read_slice::<f64>(&starts, &counts).map_err(failed)?;
            Ok((name, Array { components, values }))
        };
        self.names(group)?.into_iter().map(field).collect()
    }

    /// Whether a frame has the points, cells and arrays of those in the file.
    fn takes(&self, frame: &VtuFrame) -> Result<bool, MeshIoError> {
        let groups = [("PointData", &frame.point_data), ("CellData", &frame.cell_data)];
        for (group, fields) in groups {
            let mut names: Vec<&str> = fields.iter().map(|field| field.name).collect();
            names.sort_unstable();
            if self.names(group)? != names {
                return Ok(false);
            }
            for field in fields {
                if self.set(&format!("{group}/{}", field.name))?.shape().get(1).copied().unwrap_or(1)
                    != field.components
                {
                    return Ok(false);
                }
            }
        }
        Ok(self.points == frame.points.len() && self.cells == frame.cell_count())
    }
}
