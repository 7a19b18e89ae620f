//! One picture of a run as SVG text or PNG, without a browser: a frame seen from a direction, coloured by a field.

use std::fmt;
use std::ops::RangeInclusive;
use std::path::Path;

use crate::Outcome;
use crate::folder::Folder;
use crate::page::{Field, title};
use crate::paint::{Camera, Finish, Layout, Primitives, Shot, Style, draw_raster, draw_svg};
use crate::units;
use crate::vtu::{Array, Grid};

/// Width of what is drawn in pixels.
pub(crate) const WIDTH: f64 = 720.0;

/// Pixels of a PNG picture for one of an SVG picture, if no size is given: screens are fine.
const FINENESS: f64 = 2.0;

/// Direction of the eye unless another is asked for: that of the page.
pub(crate) const CAMERA: Camera = Camera { azimuth: -60.0, elevation: 22.0 };

/// Array of what is drawn, which has no other array's name: that of the displacement moves the points.
const DRAWN: &str = "drawn field";
const DISPLACEMENT: &str = "displacement";
const VON_MISES: &str = "von_mises";

/// Which frame is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Which {
    /// The last frame.
    #[default]
    Last,
    /// The frame of this number, counted from zero.
    Number(usize),
    /// The frame nearest to a time.
    Nearest(f64),
}

/// Options of a picture: what is drawn and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The frame.
    pub frame: Which,
    /// Name of the field; without one it is the von Mises stress if it is stored, else the size of the displacement.
    pub field: Option<String>,
    /// Direction from what is drawn to the eye.
    pub view: Option<[f64; 3]>,
    /// Names of the bodies; all if there is none.
    pub bodies: Vec<String>,
    /// Values at the ends of the colour bar; without them the smallest and the largest visible value.
    pub range: Option<[f64; 2]>,
    /// Width and height in pixels; without them the height follows from what is drawn.
    pub size: Option<[u32; 2]>,
    /// Factor of the displacements; without it one.
    pub deformation: Option<f64>,
}

/// An option that does not fit to the folder; the message names the folder, the option, its value and what there is.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfit(pub(crate) String);

impl fmt::Display for Unfit {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for Unfit {}

/// A folder with options that fit to it as far as that can be told without frames.
pub(crate) struct Motif<'a> {
    pub folder: Folder,
    pub camera: Camera,
    options: &'a Options,
}

impl<'a> Motif<'a> {
    pub fn open(path: &Path, options: &'a Options) -> Outcome<Self> {
        let folder = Folder::open(path)?;
        let is_section = folder.run.as_ref().is_some_and(|run| run.get("section").is_some());
        let view = options.view.or(is_section.then_some([0.0, 0.0, 1.0]));
        let camera = camera(view).map_err(|text| unfit(&folder, text))?;
        if let Some([a, b]) = options.range.filter(|[a, b]| !(a < b && (b - a).is_finite())) {
            let text = format!("--range {a},{b}: give two finite numbers, the smaller first");
            return Err(unfit(&folder, text).into());
        }
        if let Some([width, height]) = options.size.filter(|size| size.iter().any(|n| !SIZES.contains(n))) {
            let text = format!("--size {width}x{height}: give {} to {} pixels each", SIZES.start(), SIZES.end());
            return Err(unfit(&folder, text).into());
        }
        if let Some(factor) = options.deformation.filter(|factor| !factor.is_finite()) {
            return Err(unfit(&folder, format!("--deformation {factor}: give a finite number")).into());
        }
        if folder.frames.is_empty() {
            let notes: String = folder.notes.iter().map(|note| format!("; {note}")).collect();
            return Err(format!("{}: no frames to draw{notes}", path.display()).into());
        }
        Ok(Self { folder, camera, options })
    }

    /// The chosen bodies in a frame.
    pub fn grid(&self, frame: usize) -> Outcome<Grid> {
        let grid = self.folder.grid(frame)?;
        Ok(chosen(&grid, &self.folder.bodies, &self.options.bodies).map_err(|text| unfit(&self.folder, text))?)
    }

    /// Factor of the displacements.
    pub fn factor(&self) -> f64 {
        self.options.deformation.unwrap_or(1.0)
    }

    /// Title above the picture.
    pub fn title(&self) -> String {
        let bodies = &self.options.bodies;
        let bodies = if bodies.is_empty() { String::new() } else { format!(": {}", bodies.join(", ")) };
        format!("{}{bodies}", title(&self.folder))
    }

    /// Snapshot of a frame: its surface and the text below.
    pub fn shot(&self, frame: usize, grid: &Grid, surface: Primitives) -> Outcome<Shot> {
        let frame_of = &self.folder.frames[frame];
        if !surface.places().flatten().all(f64::is_finite) {
            return Err(format!("{}: positions that are not finite cannot be drawn", frame_of.path.display()).into());
        }
        let shape = if crate::vtu::is_undeformed(grid) { ", undeformed: no displacement is stored" } else { "" };
        let factor =
            self.options.deformation.map(|factor| format!(", displacements times {factor}")).unwrap_or_default();
        let caption = format!("time {}, frame {frame}{shape}{factor}", time(&self.folder, frame_of.time));
        Ok(Shot { caption, surface })
    }
}

pub(crate) fn unfit(folder: &Folder, text: String) -> Unfit {
    Unfit(format!("{}: {text}", folder.path().display()))
}

/// Widths and heights that are drawn.
const SIZES: RangeInclusive<u32> = 64..=8192;

/// Draws a frame of a folder of results; returns the text of an SVG file.
///
/// # Errors
/// [`Unfit`] for an option that does not fit; else what is wrong with the folder or the frame, with its name.
pub fn picture(path: &Path, options: &Options) -> Outcome<String> {
    let (shot, camera, title, label) = composed(path, options)?;
    let (style, layout) = around(options, &title, &label);
    Ok(draw_svg(&[shot], camera, &style, &layout))
}

/// The picture as of [`picture`], as the bytes of a PNG file.
///
/// # Errors
/// The errors of [`picture`].
pub fn png(path: &Path, options: &Options) -> Outcome<Vec<u8>> {
    let (shot, camera, title, label) = composed(path, options)?;
    let (style, layout) = around(options, &title, &label);
    let raster =
        draw_raster(&[shot], camera, &style, &layout, (FINENESS, Finish::FINE)).ok_or("the picture has no pixels")?;
    Ok(raster.png()?)
}

/// What is drawn of a frame, with camera, title and label.
fn composed(path: &Path, options: &Options) -> Outcome<(Shot, Camera, String, String)> {
    let motif = Motif::open(path, options)?;
    let number = number(&motif.folder, options.frame).map_err(|text| unfit(&motif.folder, text))?;
    let grid = motif.grid(number)?;
    let coloured = coloured(&motif.folder, &grid, options.field.as_deref(), motif.factor());
    let (surface, label) = coloured.map_err(|text| unfit(&motif.folder, text))?;
    Ok((motif.shot(number, &grid, surface)?, motif.camera, motif.title(), label))
}

pub(crate) fn around<'a>(options: &Options, title: &'a str, label: &'a str) -> (Style<'a>, Layout) {
    let range = options.range.map(|[a, b]| (a, b));
    (Style { title, label, width: WIDTH, range }, Layout { size: options.size, window: None })
}

/// The camera for a direction towards the eye. Seen from right above or below, x points to the right.
fn camera(view: Option<[f64; 3]>) -> Result<Camera, String> {
    let Some([x, y, z]) = view else { return Ok(CAMERA) };
    let flat = x.hypot(y);
    if !flat.hypot(z).is_normal() {
        return Err(format!("--view {x},{y},{z}: give a direction that is not zero, for instance 1,-2,1"));
    }
    let azimuth = if flat == 0.0 { -90.0 } else { y.atan2(x).to_degrees() };
    Ok(Camera { azimuth, elevation: z.atan2(flat).to_degrees() })
}

/// Number of the frame among the frames, of which there is at least one.
pub(crate) fn number(folder: &Folder, which: Which) -> Result<usize, String> {
    let last = folder.frames.len() - 1;
    match which {
        Which::Last => Ok(last),
        Which::Number(number) if number <= last => Ok(number),
        Which::Number(number) => Err(format!("--frame {number}: there are the frames 0 to {last}")),
        Which::Nearest(time) if time.is_finite() => {
            let away = |&k: &usize| (folder.frames[k].time - time).abs();
            Ok((0..=last).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(last))
        }
        Which::Nearest(time) => Err(format!("--time {time}: give a finite number")),
    }
}

/// The cells of these bodies, with all points.
fn chosen(grid: &Grid, names: &[String], wanted: &[String]) -> Result<Grid, String> {
    if wanted.is_empty() {
        return Ok(grid.clone());
    }
    let counts = [grid.elements.len(), grid.facets.len(), grid.lines.len(), grid.vertices.len()];
    let total = counts.iter().sum::<usize>();
    let numbers = grid.cell_data.get("body").filter(|array| array.values.len() == total);
    let body_of = |cell: usize| numbers.map_or(0, |numbers| numbers.values[cell].clamp(0.0, 1e6) as usize);
    let name = |body: usize| names.get(body).cloned().unwrap_or_else(|| format!("body {body}"));
    let mut present: Vec<usize> = (0..total).map(body_of).collect();
    present.sort_unstable();
    present.dedup();
    let known: Vec<String> = present.iter().map(|&body| name(body)).collect();
    if let Some(unknown) = wanted.iter().find(|body| !known.contains(body)) {
        return Err(format!("--body {unknown}: there is no such body in the frame; there are {}", known.join(", ")));
    }
    let present: Vec<usize> = present.into_iter().filter(|&body| wanted.contains(&name(body))).collect();
    let is_chosen = |cell: usize| present.binary_search(&body_of(cell)).is_ok();
    let first = [0, counts[0], counts[0] + counts[1], counts[0] + counts[1] + counts[2]];
    let of = |kind: usize| (0..counts[kind]).filter(move |k| is_chosen(first[kind] + k));
    let values = (0..total).filter(|&cell| is_chosen(cell)).map(|cell| body_of(cell) as f64).collect();
    Ok(Grid {
        points: grid.points.clone(),
        elements: crate::vtu::chosen(&grid.elements, of(0)),
        facets: of(1).map(|k| grid.facets[k]).collect(),
        lines: of(2).map(|k| grid.lines[k].clone()).collect(),
        vertices: of(3).map(|k| grid.vertices[k]).collect(),
        point_data: grid.point_data.clone(),
        cell_data: [("body".to_owned(), Array { components: 1, values })].into(),
        ..Grid::default()
    })
}

/// Names of all fields of a frame, for a message.
fn known(grid: &Grid) -> String {
    Field::of(grid).iter().map(Field::name).collect::<Vec<_>>().join(", ")
}

/// The surface with displacements times a factor and the values of a field, and the field's name for people with its unit; nothing if there is no such field.
pub(crate) fn surface(
    folder: &Folder,
    grid: &Grid,
    name: &str,
    factor: f64,
) -> Result<Option<(Primitives, String)>, String> {
    let fields = Field::of(grid);
    let Some(field) = fields.iter().find(|field| field.name() == name) else { return Ok(None) };
    let points: Vec<usize> = (0..grid.points.len()).collect();
    let values = field.values(grid, &points).into_iter().map(f64::from).collect();
    let mut grid = grid.clone();
    grid.point_data.insert(DRAWN.to_owned(), Array { components: 1, values });
    if let Some(displacement) = grid.point_data.get_mut(DISPLACEMENT) {
        displacement.values.iter_mut().for_each(|value| *value *= factor);
    }
    let unit = units::of_field(folder, &field.array);
    Ok(Some((Primitives::new(&grid, DRAWN)?, units::with_unit(&field.label, unit.as_deref()))))
}

pub(crate) fn has_values(surface: &Primitives) -> bool {
    surface.values().any(f64::is_finite)
}

/// The field that is drawn if none is asked for.
pub(crate) fn default_field(folder: &Folder, grid: &Grid) -> Result<&'static str, String> {
    for name in [VON_MISES, DISPLACEMENT].into_iter().filter(|name| grid.point_data.contains_key(*name)) {
        if surface(folder, grid, name, 1.0)?.is_some_and(|(surface, _)| has_values(&surface)) {
            return Ok(name);
        }
    }
    Err(format!("neither {VON_MISES} nor {DISPLACEMENT} has values to draw: name one by --field: {}", known(grid)))
}

pub(crate) fn no_such_field(grid: &Grid, name: &str) -> String {
    format!("--field {name}: there is no such field in the frame; there are {}", known(grid))
}

pub(crate) fn no_values(grid: &Grid, name: &str) -> String {
    format!("--field {name}: it has no values on what is drawn; choose other bodies, or one of {}", known(grid))
}

/// The surface with the values of a field that is there and has some, and the field's name for people with its unit.
pub(crate) fn coloured(
    folder: &Folder,
    grid: &Grid,
    wanted: Option<&str>,
    factor: f64,
) -> Result<(Primitives, String), String> {
    let name = wanted.map_or_else(|| default_field(folder, grid), Ok)?;
    match surface(folder, grid, name, factor)? {
        None => Err(no_such_field(grid, name)),
        Some((surface, _)) if !has_values(&surface) => Err(no_values(grid, name)),
        Some(found) => Ok(found),
    }
}

/// A time with six digits at most, and its unit if the run has units.
pub(crate) fn time(folder: &Folder, value: f64) -> String {
    let number = match rounded(value) {
        number if number == 0.0 || (1.0e-4..1.0e7).contains(&number.abs()) => number.to_string(),
        number => format!("{number:e}"),
    };
    units::of_time(folder).map_or_else(|| number.clone(), |unit| format!("{number} {unit}"))
}

/// A number with six digits at most.
pub(crate) fn rounded(value: f64) -> f64 {
    // cannot fail: what was written as a number is read as one.
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_is_where_the_view_points() {
        for view in [[1.0, -2.0, 0.5], [-3.0, 0.1, -1.0], [0.0, 0.0, 2.0], [0.0, 0.0, -2.0]] {
            let [right, up, near] = camera(Some(view)).unwrap().view().project(view);
            let length = view.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(right.abs() < 1e-14 && up.abs() < 1e-14 && (near - length).abs() < 1e-14, "{view:?}");
        }
        let [right, up, _] = camera(Some([0.0, 0.0, 1.0])).unwrap().view().project([3.0, 4.0, 0.0]);
        assert!((right - 3.0).abs() < 1e-14 && (up - 4.0).abs() < 1e-14);
        for view in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 1.0]] {
            assert!(camera(Some(view)).unwrap_err().contains("--view"));
        }
    }

    /// Places move by the factor, and the displacement as a field stays what it is.
    #[test]
    fn displacements_are_enlarged() {
        let path = tempfile::tempdir().unwrap();
        std::fs::write(path.path().join("balance.csv"), "step,time\n").unwrap();
        let folder = Folder::open(path.path()).unwrap();
        let mut grid = crate::vtu::tests::cube(&[1.0; 8]);
        let values = grid.points.iter().flatten().map(|x| 0.25 * x).collect();
        grid.point_data.insert(DISPLACEMENT.into(), Array { components: 3, values });
        for (factor, farthest) in [(0.0, 1.0), (1.0, 1.25), (4.0, 2.0), (-2.0, 0.5)] {
            let (surface, _) = surface(&folder, &grid, DISPLACEMENT, factor).unwrap().unwrap();
            assert_eq!(surface.places().flatten().fold(0.0, f64::max), farthest);
            assert!((surface.values().fold(0.0, f64::max) - 0.25 * 3.0_f64.sqrt()).abs() < 1e-7);
        }
    }

    #[test]
    fn times_are_short() {
        assert_eq!([0.1 + 0.2, 1.23456789, 0.0].map(|time| rounded(time).to_string()), ["0.3", "1.23457", "0"]);
    }
}
