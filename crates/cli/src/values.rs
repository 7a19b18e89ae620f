//! `stoss values`: values of a frame along a line or on a plane as a table.

use crate::picture::numbers;
use crate::terminal::{say, tell};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss_report::picture::{Unfit, Which};
use stoss_report::values::{Configuration, Options, SamplePoints, has_contact, values};

/// What `stoss values` is asked for.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("place").required(true).args(["line", "plane"]))]
pub struct Values {
    /// A folder of results.
    out: PathBuf,
    /// A line from one point to another, both included.
    #[arg(long, value_name = "X,Y,Z", num_args = 2, allow_hyphen_values = true, value_parser = numbers::<3>)]
    line: Option<Vec<[f64; 3]>>,
    /// Number of points on the line.
    #[arg(long, value_name = "N", default_value_t = 101, conflicts_with = "plane", value_parser = clap::value_parser!(u32).range(2..))]
    points: u32,
    /// A plane through a point with a normal: a square grid of points, as far as they are in a body.
    #[arg(long, value_name = "X,Y,Z", num_args = 2, allow_hyphen_values = true, value_parser = numbers::<3>)]
    plane: Option<Vec<[f64; 3]>>,
    /// Distance of the points on the plane [default: a fiftieth of the longer side of the section].
    #[arg(long, value_name = "D", conflicts_with = "line")]
    spacing: Option<f64>,
    /// Number of the frame, counted from 0 [default: the last].
    #[arg(long, value_name = "N", conflicts_with = "time")]
    frame: Option<usize>,
    /// The frame nearest to this time.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    time: Option<f64>,
    /// A field of the frames; may be given several times [default: all]; an unknown name lists them.
    #[arg(long, value_name = "F")]
    field: Vec<String>,
    /// Whether given points and written positions are current or reference ones.
    #[arg(long, value_name = "C", default_value = "current", value_parser = configuration)]
    configuration: Configuration,
    /// Write the table into this file instead of standard output.
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
}

fn configuration(text: &str) -> Result<Configuration, String> {
    match text {
        "current" => Ok(Configuration::Current),
        "reference" => Ok(Configuration::Reference),
        _ => Err("choose current or reference".to_owned()),
    }
}

/// Carries out `stoss values`.
pub fn write(asked: Values) -> ExitCode {
    let Values { out, line, points, plane, spacing, frame, time, field, configuration, output } = asked;
    let place = match (line.as_deref(), plane.as_deref()) {
        (Some(&[from, to]), _) => SamplePoints::Line { ends: [from, to], points: points as usize },
        (_, Some(&[point, normal])) => SamplePoints::Plane { point, normal, spacing },
        // cannot happen: one of them is required, with two values.
        _ => return ExitCode::from(2),
    };
    let frame = match (frame, time) {
        (Some(number), _) => Which::Number(number),
        (None, Some(time)) => Which::Nearest(time),
        (None, None) => Which::Last,
    };
    let written = values(&out, &Options { frame, place, fields: field, configuration });
    if written.as_ref().is_ok_and(|text| has_contact(text)) {
        say!("note: contact fields have values on the surface of a body only; inside they are empty");
    }
    match written.and_then(|text| store(&text, output.as_deref())) {
        Ok(text) => tell(&text),
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(if error.is::<Unfit>() { 2 } else { 1 })
        }
    }
}

/// Writes the table into the file, if there is one; returns what standard output gets.
fn store(text: &str, file: Option<&Path>) -> stoss_report::Outcome<String> {
    let Some(file) = file else { return Ok(text.trim_end().to_owned()) };
    std::fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(file.display().to_string())
}
