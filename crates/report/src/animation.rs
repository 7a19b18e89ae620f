//! The frames of a run as an animated GIF: one view, one range of colours, and of each frame only what has changed.

use std::borrow::Cow;
use std::path::Path;

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use crate::Outcome;
use crate::paint::{Colour, Finish, Layout, Raster, Style, colour, draw_raster, value_range, window};
use crate::picture::{self, Motif, Options, unfit};

/// Speed and choice of the frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Frames a second; files have hundredths of a second.
    pub fps: f64,
    /// Every how many stored frames one is shown; the last one always is.
    pub every: usize,
    /// Whether it starts again after its end.
    pub repeats: bool,
}

impl Default for Pace {
    fn default() -> Self {
        Self { fps: 12.5, every: 1, repeats: true }
    }
}

/// Frames a second that viewers show: they slow down what has less than two hundredths a frame.
const FPS: std::ops::RangeInclusive<f64> = 0.1..=50.0;

/// Colours of the map and greys in the palette; its first entry is for what has not changed.
const TONES: usize = 30;
const GREYS: usize = 40;
const UNCHANGED: u8 = 0;

/// Lights under which faces are drawn, and before them one that is as dark as their edges.
const LIGHTS: [f64; 7] = [0.45, 0.62, 0.71, 0.8, 0.89, 0.97, 1.04];

/// Bits a channel by which the nearest colour of the palette is looked up.
const BITS: u32 = 6;

/// Faces have the colours of the palette, so that no speckles come from rounding.
const FINISH: Finish = Finish { parts: 2, colour: of_palette };

fn of_palette(value: f64, light: f64) -> Colour {
    let steps = (TONES - 1) as f64;
    let away = |known: &&f64| (**known - light).abs();
    let light = LIGHTS.iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(&1.0);
    colour((value.clamp(0.0, 1.0) * steps).round() / steps, *light)
}

/// Draws the frames of a folder; returns the bytes of a GIF file. The frame of the options is not looked at.
///
/// # Errors
/// [`picture::Unfit`] for an option that does not fit; else what is wrong with the folder or a frame, with its name.
pub fn gif(path: &Path, options: &Options, pace: Pace) -> Outcome<Vec<u8>> {
    let motif = Motif::open(path, options)?;
    let refuse = |text: String| unfit(&motif.folder, text);
    if !FPS.contains(&pace.fps) {
        return Err(refuse(format!("--fps {}: give {} to {}", pace.fps, FPS.start(), FPS.end())).into());
    }
    let last = motif.folder.frames.len() - 1;
    let numbers: Vec<usize> = (0..last).step_by(pace.every.max(1)).chain([last]).collect();
    let first = motif.grid(0)?;
    let name =
        options.field.as_deref().map_or_else(|| picture::default_field(&motif.folder, &first), Ok).map_err(refuse)?;
    let shot = |number: usize| {
        let grid = motif.grid(number)?;
        let found = picture::surface(&motif.folder, &grid, name, motif.factor()).map_err(refuse)?;
        let (surface, label) = found.ok_or_else(|| refuse(picture::no_such_field(&grid, name)))?;
        Outcome::Ok((motif.shot(number, &grid, surface)?, label))
    };
    // The view and the range are those of all frames, which are read twice: together they may be more than memory holds.
    let (mut low, mut high, mut ends, mut label) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], None, String::new());
    for &number in &numbers {
        let (shot, found) = shot(number)?;
        let [least, most] = window([&shot.surface].into_iter(), motif.camera);
        (low, high) = (std::array::from_fn(|k| low[k].min(least[k])), std::array::from_fn(|k| high[k].max(most[k])));
        if picture::has_values(&shot.surface) {
            let (least, most) = value_range([&shot.surface].into_iter());
            ends = Some(ends.map_or((least, most), |(low, high): (f64, f64)| (low.min(least), high.max(most))));
        }
        label = found;
    }
    let ends = ends.ok_or_else(|| refuse(picture::no_values(&first, name)))?;
    let title = motif.title();
    let range = Some(options.range.map_or(ends, |[a, b]| (a, b)));
    let style = Style { title: &title, label: &label, width: picture::WIDTH, range };
    let layout = Layout { size: options.size, window: Some([low, high]) };
    let palette = Palette::new();
    let delay = (100.0 / pace.fps).round() as u16;
    let mut file: Option<Encoder<Vec<u8>>> = None;
    let mut before = Vec::new();
    for &number in &numbers {
        let (shot, _) = shot(number)?;
        let raster =
            draw_raster(&[shot], motif.camera, &style, &layout, (1.0, FINISH)).ok_or("the picture has no pixels")?;
        let [width, height] = raster.size().map(u16::try_from);
        let [width, height] = [width?, height?];
        let now = palette.indices(&raster);
        let encoder = match &mut file {
            Some(encoder) => encoder,
            None => {
                let mut encoder = Encoder::new(Vec::new(), width, height, palette.colours.as_flattened())?;
                encoder.set_repeat(if pace.repeats { Repeat::Infinite } else { Repeat::Finite(0) })?;
                file.insert(encoder)
            }
        };
        encoder.write_frame(&Frame { delay, ..changed(&before, &now, width) })?;
        before = now;
    }
    match file {
        Some(encoder) => Ok(encoder.into_inner()?),
        None => Err("there are no frames to draw".into()),
    }
}

/// The smallest rectangle with all that differs from the picture before, of which what is equal is left out; all of the first picture.
fn changed(before: &[u8], now: &[u8], width: u16) -> Frame<'static> {
    let wide = usize::from(width);
    let differs = |place: usize| before.get(place) != Some(&now[place]);
    let (mut left, mut right, mut top, mut bottom) = (wide, 0, usize::MAX, 0);
    for place in (0..now.len()).filter(|&place| differs(place)) {
        let (x, y) = (place % wide, place / wide);
        (left, right, top, bottom) = (left.min(x), right.max(x), top.min(y), bottom.max(y));
    }
    if top == usize::MAX {
        (left, right, top, bottom) = (0, 0, 0, 0);
    }
    let places = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * wide + x));
    let buffer: Vec<u8> = places.map(|place| if differs(place) { now[place] } else { UNCHANGED }).collect();
    // cannot fail: sides of a picture whose width and height are 16-bit numbers.
    let [left, top, width, height] = [left, top, right + 1 - left, bottom + 1 - top].map(|n| n as u16);
    let transparent = Some(UNCHANGED);
    Frame {
        left,
        top,
        width,
        height,
        transparent,
        dispose: DisposalMethod::Keep,
        buffer: Cow::Owned(buffer),
        ..Frame::default()
    }
}

/// The colours of a picture: those of the map in several shades, and greys.
struct Palette {
    colours: Vec<Colour>,
    /// Nearest entry of the colours that begin with the same [`BITS`] bits in each channel.
    nearest: Vec<u8>,
}

impl Palette {
    fn new() -> Self {
        let mut colours = vec![[255; 3]];
        for tone in (0..TONES).map(|tone| tone as f64 / (TONES - 1) as f64) {
            colours.extend(LIGHTS.map(|light| of_palette(tone, light)));
        }
        colours.extend((0..GREYS).map(|grey| [(255 * grey / (GREYS - 1)) as u8; 3]));
        let side = 1 << BITS;
        // The darkest and the lightest channel stay what they are.
        let channel = |code: usize| (255 * code / (side - 1)) as u8;
        let cells = (0..side * side * side).map(|code| [code / side / side, code / side % side, code % side]);
        let nearest = cells.map(|cell| nearest(&colours, cell.map(channel))).collect();
        Self { colours, nearest }
    }

    fn indices(&self, raster: &Raster) -> Vec<u8> {
        let side = (1 << BITS) - 1;
        let code = |channel: u8| (usize::from(channel) * side + 127) / 255;
        let place = |colour: Colour| colour.into_iter().fold(0, |place, channel| (place << BITS) | code(channel));
        raster.colours().map(|colour| self.nearest[place(colour)]).collect()
    }
}

/// The entry of the palette that differs least; never that of what has not changed.
fn nearest(colours: &[Colour], wanted: Colour) -> u8 {
    let apart =
        |&k: &usize| -> i32 { colours[k].iter().zip(wanted).map(|(a, b)| (i32::from(*a) - i32::from(b)).pow(2)).sum() };
    (1..colours.len()).min_by_key(apart).unwrap_or(1) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_differs_is_kept() {
        let before = vec![1; 12];
        let mut now = before.clone();
        (now[5], now[10]) = (7, 9);
        let frame = changed(&before, &now, 4);
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 1, 2, 2));
        assert_eq!(frame.buffer.as_ref(), [7, UNCHANGED, UNCHANGED, 9]);
        let first = changed(&[], &now, 4);
        assert_eq!((first.width, first.height, first.buffer.as_ref()), (4, 3, now.as_slice()));
        assert_eq!(changed(&now, &now, 4).buffer.as_ref(), [UNCHANGED]);
    }

    #[test]
    fn white_is_white_and_faces_have_colours_of_the_palette() {
        let palette = Palette::new();
        assert!(palette.colours.len() <= 256);
        assert_eq!(palette.colours[usize::from(nearest(&palette.colours, [255; 3]))], [255; 3]);
        for (tone, light) in (0..=50).flat_map(|k| LIGHTS.map(|light| (f64::from(k) / 50.0, light))) {
            let wanted = of_palette(tone, light);
            assert_eq!(palette.colours[usize::from(nearest(&palette.colours, wanted))], wanted);
            let apart = colour(tone, light).iter().zip(wanted).map(|(a, b)| a.abs_diff(b)).max().unwrap();
            assert!(apart <= 12, "{tone} {light}");
        }
    }
}
