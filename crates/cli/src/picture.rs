//! `stoss picture`: a frame as an SVG file.

use crate::terminal::{say, tell};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss_report::picture::{Options, Unfit, Which, picture};

/// What `stoss picture` is asked for.
#[derive(clap::Args)]
pub struct Picture {
    /// A folder of results.
    out: PathBuf,
    /// The picture: FILE.svg.
    file: PathBuf,
    /// Number of the frame, counted from 0 [default: the last].
    #[arg(long, value_name = "N", conflicts_with = "time")]
    frame: Option<usize>,
    /// The frame nearest to this time.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Colours by this field [default: von_mises if the frame has it, else displacement]; an unknown name lists the fields.
    #[arg(long, value_name = "F")]
    field: Option<String>,
    /// Direction from the bodies to the eye; z is up [default: that of the page of `stoss report`].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    view: Option<[f64; 3]>,
    /// Draws this body only; may be given several times [default: all].
    #[arg(long, value_name = "B")]
    body: Vec<String>,
    /// Values at the ends of the colour bar [default: the smallest and the largest visible value].
    #[arg(long, value_name = "A,B", allow_hyphen_values = true, value_parser = numbers::<2>)]
    range: Option<[f64; 2]>,
}

/// Numbers with commas between.
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| format!("give {N} numbers with commas and without blanks between them"))
}

/// Carries out `stoss picture`.
pub fn write(asked: Picture) -> ExitCode {
    let Picture { out, file, frame, time, field, view, body, range } = asked;
    let ending = file.extension().map(|ending| ending.to_ascii_lowercase());
    if ending.is_none_or(|ending| ending != "svg") {
        say!(
            "error: {}: pictures are written as SVG only: name a file that ends with .svg; browsers and most programs for \
             pictures turn it into PNG",
            file.display()
        );
        return ExitCode::from(2);
    }
    let frame = match (frame, time) {
        (Some(number), _) => Which::Number(number),
        (None, Some(time)) => Which::Nearest(time),
        (None, None) => Which::Last,
    };
    match draw(&out, &file, &Options { frame, field, view, bodies: body, range }) {
        Ok(()) => tell(&file.display().to_string()),
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(if error.is::<Unfit>() { 2 } else { 1 })
        }
    }
}

fn draw(out: &Path, file: &Path, options: &Options) -> stoss_report::Outcome<()> {
    let text = picture(out, options)?;
    std::fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()).into())
}
