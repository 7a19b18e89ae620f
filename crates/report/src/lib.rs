//! Reading the files that a run leaves, charts and pictures of them, and the page that shows a run.
//!
//! - [`folder`]: a folder of results; [`page`]: one HTML file with the run as an animation, its charts and its verdict;
//! - [`plot`]: lines over linear or logarithmic axes, plane curves, maps of coloured cells;
//! - [`picture`]: one picture of a frame, as SVG or PNG; [`animation`]: all frames as GIF;
//! - [`values`]: tables of the fields along a line and on a plane section;
//! - [`diagnosis`]: the page that says why a run stopped, with pictures of the place;
//! - [`paint`]: surfaces of bodies, lines and points, coloured by a field;
//! - [`sweep`]: a folder of a sweep; [`vtu`]: frames; [`table`]: tables with comma-separated values.
//!
//! An SVG text refers to nothing outside of itself. Not here: running anything, and which scene is drawn how.

pub mod animation;
pub mod diagnosis;
pub mod folder;
pub mod page;
pub mod paint;
pub mod picture;
pub mod plot;
mod svg_path;
pub mod sweep;
pub mod table;
pub mod units;
pub mod values;
pub mod vtu;

use std::path::Path;

/// Result of reading or drawing; the error is a message for people.
pub type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The text of a file.
///
/// # Errors
/// What the system says, with the name of the file.
pub fn read(path: &Path) -> Outcome<String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()).into())
}
