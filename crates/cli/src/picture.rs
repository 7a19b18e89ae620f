//! `stoss picture`: a frame as an SVG or PNG file, or all frames as a GIF file.

use crate::terminal::{say, tell};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss_report::animation::{Pace, gif};
use stoss_report::picture::{Options, Unfit, Which, picture, png};

/// What `stoss picture` is asked for.
#[derive(clap::Args)]
pub struct Picture {
    /// A folder of results.
    out: PathBuf,
    /// The picture: FILE.svg or FILE.png, or FILE.gif for an animation.
    file: PathBuf,
    /// Number of the frame, counted from 0 [default: the last].
    #[arg(long, value_name = "N", conflicts_with = "time")]
    frame: Option<usize>,
    /// The frame nearest to this time.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    time: Option<f64>,
    /// The field to colour by [default: von_mises if the frame has it, else displacement]; an unknown name lists the fields.
    #[arg(long, value_name = "F")]
    field: Option<String>,
    /// Direction from the bodies to the eye; z is up [default: that of the page of `stoss report`].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    view: Option<[f64; 3]>,
    /// Draw this body only; may be given several times [default: all].
    #[arg(long, value_name = "B")]
    body: Vec<String>,
    /// Values at the ends of the colour bar [default: the smallest and the largest visible value].
    #[arg(long, value_name = "A,B", allow_hyphen_values = true, value_parser = numbers::<2>)]
    range: Option<[f64; 2]>,
    /// Width and height in pixels [default: SVG and GIF 748 pixels wide, PNG twice as many; the height follows from what is drawn].
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Factor of the displacements [default: 1].
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    deformation: Option<f64>,
    /// Animation: frames per second.
    #[arg(long, value_name = "N", default_value_t = Pace::default().fps)]
    fps: f64,
    /// Animation: every Nth frame only, and the last.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// Animation: stop at the last frame instead of starting again.
    #[arg(long)]
    once: bool,
}

/// Width and height with an `x` between.
fn size(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once(['x', 'X']).map(|(width, height)| [width, height].map(|part| part.trim().parse()));
    match parts {
        Some([Ok(width), Ok(height)]) => Ok([width, height]),
        _ => Err("give width and height in pixels, for instance 1280x720".to_owned()),
    }
}

/// Numbers with commas between.
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| format!("give {N} numbers with commas between them and without blanks"))
}

/// Carries out `stoss picture`.
pub fn write(asked: Picture) -> ExitCode {
    let Picture { out, file, frame, time, field, view, body, range, size, deformation, fps, every, once } = asked;
    let ending = file.extension().map(|ending| ending.to_ascii_lowercase().to_string_lossy().into_owned());
    let ending = ending.unwrap_or_default();
    let wrong = |text: &str| {
        say!("error: {}: {text}", file.display());
        ExitCode::from(2)
    };
    if !["svg", "png", "gif"].contains(&ending.as_str()) {
        return wrong("name a picture that ends with .svg or .png, or an animation that ends with .gif");
    }
    if ending == "gif" && (frame.is_some() || time.is_some()) {
        return wrong("an animation has all frames; --frame and --time are for one picture (.svg, .png)");
    }
    let pace = Pace { fps, every: every as usize, repeats: !once };
    if ending != "gif" && pace != Pace::default() {
        return wrong("--fps, --every and --once are for an animation (.gif)");
    }
    let frame = match (frame, time) {
        (Some(number), _) => Which::Number(number),
        (None, Some(time)) => Which::Nearest(time),
        (None, None) => Which::Last,
    };
    let options = Options { frame, field, view, bodies: body, range, size, deformation };
    let bytes = match ending.as_str() {
        "svg" => picture(&out, &options).map(String::into_bytes),
        "png" => png(&out, &options),
        _ => gif(&out, &options, pace),
    };
    match bytes.and_then(|bytes| save(&file, &bytes)) {
        Ok(()) => tell(&file.display().to_string()),
        Err(error) => {
            say!("error: {error}");
            ExitCode::from(if error.is::<Unfit>() { 2 } else { 1 })
        }
    }
}

fn save(file: &Path, bytes: &[u8]) -> stoss_report::Outcome<()> {
    std::fs::write(file, bytes).map_err(|error| format!("{}: {error}", file.display()).into())
}
