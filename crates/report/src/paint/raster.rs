//! Pictures as pixels, with smooth edges; PNG files.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke, Transform,
};

use super::canvas::{Anchor, Canvas, Colour, DOT, EDGE, EDGE_OPACITY, EDGE_WIDTH, INK, LINE, RIM};
use super::letters;

/// Width of the strokes of letters over their size.
const WEIGHT: f64 = 0.092;

/// A picture of pixels on white.
pub struct Raster {
    pixels: Pixmap,
    scale: f64,
    origin: [f64; 2],
}

impl Raster {
    /// A white picture; nothing if it has no pixels or more than memory can hold.
    pub(super) fn new([width, height]: [u32; 2], scale: f64) -> Option<Self> {
        let mut pixels = Pixmap::new(width, height)?;
        pixels.fill(Color::WHITE);
        Some(Self { pixels, scale, origin: [0.0; 2] })
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        [self.pixels.width(), self.pixels.height()]
    }

    /// Red, green and blue of every pixel, row by row from above.
    pub fn colours(&self) -> impl Iterator<Item = Colour> + '_ {
        let opaque = |pixel: &PremultipliedColorU8| [pixel.red(), pixel.green(), pixel.blue()];
        self.pixels.pixels().iter().map(opaque)
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// None but of the compression.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, self.pixels.width(), self.pixels.height());
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        let bytes: Vec<u8> = self.colours().flatten().collect();
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(out)
    }

    fn transform(&self) -> Transform {
        let [scale, x, y] = [self.scale, self.scale * self.origin[0], self.scale * self.origin[1]].map(|x| x as f32);
        Transform::from_row(scale, 0.0, 0.0, scale, x, y)
    }

    fn fill(&mut self, path: Option<Path>, colour: Colour) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, &paint(colour, 1.0), FillRule::Winding, self.transform(), None);
        }
    }

    fn stroke(&mut self, path: Option<Path>, (colour, opacity): (Colour, f64), width: f64, line_cap: LineCap) {
        if let Some(path) = path {
            let stroke = Stroke { width: width as f32, line_cap, line_join: LineJoin::Round, ..Stroke::default() };
            self.pixels.stroke_path(&path, &paint(colour, opacity), &stroke, self.transform(), None);
        }
    }
}

fn paint(colour: Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(colour[0], colour[1], colour[2], (255.0 * opacity).round() as u8);
    paint
}

/// Lines from point to point; nothing if they have no extent.
fn path<'a>(lines: impl Iterator<Item = (&'a [[f64; 2]], bool)>) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (points, is_closed) in lines {
        for (number, [x, y]) in points.iter().map(|point| point.map(|x| x as f32)).enumerate() {
            if number == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if is_closed {
            builder.close();
        }
    }
    builder.finish()
}

impl Canvas for Raster {
    fn text(&mut self, text: &str, place: [f64; 2], size: f64, anchor: Anchor) {
        let (mut strokes, width) = letters::written(text, size);
        let left = place[0] - if anchor == Anchor::Middle { 0.5 * width } else { 0.0 };
        for point in strokes.iter_mut().flatten() {
            *point = [point[0] + left, point[1] + place[1]];
        }
        let weight = WEIGHT * size;
        let lines = strokes.iter().filter(|stroke| stroke.len() > 1).map(|stroke| (stroke.as_slice(), false));
        self.stroke(path(lines), (INK, 1.0), weight, LineCap::Round);
        for dot in strokes.iter().filter(|stroke| stroke.len() == 1) {
            let [x, y] = dot[0].map(|x| x as f32);
            self.fill(PathBuilder::from_circle(x, y, (0.62 * weight) as f32), INK);
        }
    }

    fn rectangle(&mut self, colour: Colour, corner: [f64; 2], size: [f64; 2]) {
        let [x, y, width, height] = [corner[0], corner[1], size[0], size[1]].map(|x| x as f32);
        self.fill(Rect::from_xywh(x, y, width, height).map(PathBuilder::from_rect), colour);
    }

    fn enter(&mut self, origin: [f64; 2]) {
        self.origin = origin;
    }

    fn leave(&mut self) {
        self.origin = [0.0; 2];
    }

    fn piece(&mut self, colour: Colour, corners: &[[f64; 2]; 4]) {
        self.fill(path([(corners.as_slice(), true)].into_iter()), colour);
    }

    fn edges(&mut self, corners: &[[f64; 2]; 4], chosen: [bool; 4]) {
        let sides: [[[f64; 2]; 2]; 4] = std::array::from_fn(|k| [corners[k], corners[(k + 1) % 4]]);
        let all = (chosen == [true; 4]).then_some((corners.as_slice(), true));
        let single = sides.iter().zip(chosen).filter(|(_, chosen)| *chosen && all.is_none());
        let lines = all.into_iter().chain(single.map(|(side, _)| (side.as_slice(), false)));
        self.stroke(path(lines), (EDGE, EDGE_OPACITY), EDGE_WIDTH, LineCap::Butt);
    }

    fn line(&mut self, colour: Colour, ends: &[[f64; 2]; 2]) {
        for (colour, width, cap) in [(EDGE, LINE + 2.0 * RIM, LineCap::Butt), (colour, LINE, LineCap::Round)] {
            self.stroke(path([(ends.as_slice(), false)].into_iter()), (colour, 1.0), width, cap);
        }
    }

    fn disc(&mut self, colour: Colour, centre: [f64; 2]) {
        let [x, y, radius] = [centre[0], centre[1], 0.5 * DOT].map(|x| x as f32);
        let circle = PathBuilder::from_circle(x, y, radius);
        self.fill(circle.clone(), colour);
        self.stroke(circle, (EDGE, 1.0), RIM, LineCap::Butt);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(raster: &Raster, x: u32, y: u32) -> Colour {
        raster.colours().nth((y * raster.size()[0] + x) as usize).unwrap()
    }

    #[test]
    fn what_is_filled_has_its_colour_and_comes_back_from_the_file() {
        let mut raster = Raster::new([40, 20], 2.0).unwrap();
        raster.enter([5.0, 0.0]);
        raster.piece([200, 100, 50], &[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0]]);
        raster.leave();
        raster.disc([1, 2, 3], [15.0, 5.0]);
        raster.text("I", [1.0, 8.0], 10.0, Anchor::Start);
        for (place, wanted) in
            [([11, 1], [200, 100, 50]), ([9, 1], [255; 3]), ([21, 3], [255; 3]), ([30, 10], [1, 2, 3])]
        {
            assert_eq!(pixel(&raster, place[0], place[1]), wanted, "{place:?}");
        }
        // The stroke of the letter goes from (1, 0.8) to (1, 8), and is 1.84 pixels wide.
        assert_eq!([pixel(&raster, 2, 10), pixel(&raster, 2, 19)], [INK, [255; 3]]);
        let bytes = raster.png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut found = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut found).unwrap();
        assert_eq!((info.width, info.height, info.color_type), (40, 20, png::ColorType::Rgb));
        assert!(raster.colours().flatten().eq(found));
    }

    #[test]
    fn a_picture_without_pixels_is_none() {
        assert!(Raster::new([0, 3], 1.0).is_none());
    }
}
