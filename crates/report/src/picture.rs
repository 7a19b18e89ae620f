//! One picture of a run as SVG, without a browser: a frame seen from a direction, coloured by a field.

use std::fmt;
use std::path::Path;

use crate::Outcome;
use crate::folder::Folder;
use crate::page::{Field, escaped, title};
use crate::paint::{Camera, Shot, Style, Surface, draw};
use crate::vtu::{Array, Grid};

/// Width of what is drawn in pixels.
const WIDTH: f64 = 720.0;

/// Direction of the eye unless another is asked for: that of the page.
pub(crate) const CAMERA: Camera = Camera { azimuth: -60.0, elevation: 22.0 };

/// Displacement is the only vector that moves the points; its size is a field like the others.
const DISPLACEMENT: &str = "displacement";
const VON_MISES: &str = "von_mises";

/// Which frame is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Which {
    /// The last one.
    #[default]
    Last,
    /// By its number, counted from zero.
    Number(usize),
    /// The one nearest to a time.
    Nearest(f64),
}

/// What is drawn and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The frame.
    pub frame: Which,
    /// Name of the field; without one it is the von Mises stress if it is stored, else the size of the displacement.
    pub field: Option<String>,
    /// From what is drawn to the eye.
    pub view: Option<[f64; 3]>,
    /// Names of the bodies; all if there is none.
    pub bodies: Vec<String>,
    /// Values at the ends of the colour bar; without them the smallest and the largest visible value.
    pub range: Option<[f64; 2]>,
}

/// An option that does not fit to the folder; the message names the folder, the option, its value and what there is.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfit(String);

impl fmt::Display for Unfit {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for Unfit {}

/// Draws a frame of a folder of results; returns the text of an SVG file.
///
/// # Errors
/// [`Unfit`] for an option that does not fit; else what is wrong with the folder or the frame, with its name.
pub fn picture(path: &Path, options: &Options) -> Outcome<String> {
    let folder = Folder::open(path)?;
    let unfit = |text: String| Unfit(format!("{}: {text}", path.display()));
    let camera = camera(options.view).map_err(unfit)?;
    if let Some([a, b]) = options.range.filter(|[a, b]| !(a < b && (b - a).is_finite())) {
        return Err(unfit(format!("--range {a},{b}: give two finite numbers, the smaller first")).into());
    }
    if folder.frames.is_empty() {
        let notes: String = folder.notes.iter().map(|note| format!("; {note}")).collect();
        return Err(format!("{}: no frames to draw{notes}", path.display()).into());
    }
    let number = number(&folder, options.frame).map_err(unfit)?;
    let frame = &folder.frames[number];
    let grid = folder.grid(number)?;
    let grid = chosen(&grid, &folder.bodies, &options.bodies).map_err(unfit)?;
    let (surface, label) = coloured(&grid, options.field.as_deref()).map_err(unfit)?;
    if !surface.places().flatten().all(f64::is_finite) {
        return Err(format!("{}: positions that are not finite cannot be drawn", frame.path.display()).into());
    }
    let bodies = if options.bodies.is_empty() { String::new() } else { format!(": {}", options.bodies.join(", ")) };
    let title = escaped(&format!("{}{bodies}", title(&folder)));
    let caption = format!("time {}, frame {number}", rounded(frame.time));
    let range = options.range.map(|[a, b]| (a, b));
    let style = Style { title: &title, label: &escaped(&label), width: WIDTH, range };
    Ok(draw(&[Shot { caption, surface }], camera, &style))
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
fn number(folder: &Folder, which: Which) -> Result<usize, String> {
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
    let counts = [grid.hexahedra.len(), grid.facets.len(), grid.lines.len(), grid.vertices.len()];
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
        hexahedra: of(0).map(|k| grid.hexahedra[k]).collect(),
        facets: of(1).map(|k| grid.facets[k].clone()).collect(),
        lines: of(2).map(|k| grid.lines[k].clone()).collect(),
        vertices: of(3).map(|k| grid.vertices[k]).collect(),
        point_data: grid.point_data.clone(),
        cell_data: [("body".to_owned(), Array { components: 1, values })].into(),
    })
}

/// The surface with the values of a field, and the field's name for people.
pub(crate) fn coloured(grid: &Grid, wanted: Option<&str>) -> Result<(Surface, String), String> {
    let fields = Field::of(grid);
    let mut known: Vec<String> = fields.iter().map(Field::name).collect();
    known.extend(grid.point_data.contains_key(DISPLACEMENT).then(|| DISPLACEMENT.to_owned()));
    let known = known.join(", ");
    let surface = |name: &str| -> Result<Option<(Surface, String)>, String> {
        if name == DISPLACEMENT && grid.point_data.contains_key(name) {
            return Ok(Some((Surface::new(grid, name)?, name.to_owned())));
        }
        let Some(field) = fields.iter().find(|field| field.name() == name) else { return Ok(None) };
        let points: Vec<usize> = (0..grid.points.len()).collect();
        let values = field.values(grid, &points).into_iter().map(f64::from).collect();
        let mut grid = grid.clone();
        grid.point_data.insert(name.to_owned(), Array { components: 1, values });
        Ok(Some((Surface::new(&grid, name)?, field.label.clone())))
    };
    let has_values = |surface: &Surface| surface.values().any(f64::is_finite);
    let Some(name) = wanted else {
        for name in [VON_MISES, DISPLACEMENT] {
            if let Some(found) = surface(name)?.filter(|(surface, _)| has_values(surface)) {
                return Ok(found);
            }
        }
        return Err(format!("neither {VON_MISES} nor {DISPLACEMENT} has values to draw: name one by --field: {known}"));
    };
    match surface(name)? {
        None => Err(format!("--field {name}: there is no such field in the frame; there are {known}")),
        Some((surface, _)) if !has_values(&surface) => {
            Err(format!("--field {name}: it has no values on what is drawn; choose other bodies, or one of {known}"))
        }
        Some(found) => Ok(found),
    }
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

    #[test]
    fn times_are_short() {
        assert_eq!([0.1 + 0.2, 1.23456789, 0.0].map(|time| rounded(time).to_string()), ["0.3", "1.23457", "0"]);
    }
}
