//! Snapshots side by side, in rows if there are many, with title, captions and colour bar.

use super::bar::{HEIGHT as BAR, bar};
use super::camera::Camera;
use super::canvas::{Anchor, Canvas};
use super::letters;
use super::raster::Raster;
use super::surface::Primitives;
use super::svg::Svg;
use super::visible::{Finish, Visible, bounds, range};

/// One snapshot.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Text below the snapshot.
    pub caption: String,
    /// Faces, lines and points of the snapshot.
    pub surface: Primitives,
}

/// What stands around the snapshots.
#[derive(Clone, Copy, Debug)]
pub struct Style<'a> {
    /// Text above the snapshots.
    pub title: &'a str,
    /// Text at the colour bar.
    pub label: &'a str,
    /// Width of a snapshot in pixels.
    pub width: f64,
    /// Values at the ends of the colour bar; without them the smallest and the largest visible value.
    pub range: Option<(f64, f64)>,
}

const MARGIN: f64 = 14.0;
const TITLE: f64 = 38.0;
const CAPTION: f64 = 26.0;

/// Snapshots in a row: all up to four, then as many as make two rows.
pub fn columns(shots: usize) -> usize {
    if shots <= 4 { shots.max(1) } else { shots.div_ceil(2) }
}

/// What a picture has beside its natural form, in which it is as high as what is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layout {
    /// Width and height of the whole picture in pixels.
    pub size: Option<[u32; 2]>,
    /// Smallest and largest coordinates to the right and upwards of what is shown, see [`window`]; without it everything is shown.
    pub window: Option<[[f64; 2]; 2]>,
}

/// Natural width in pixels of a picture with one snapshot whose letters are as large as they are.
const NATURAL: [f64; 2] = [748.0, 500.0];

impl Layout {
    /// Pixels for a unit of the composition: letters grow with large pictures, and stay as they are in small ones.
    fn scale(&self) -> f64 {
        let Some(size) = self.size else { return 1.0 };
        let parts = [0, 1].map(|k| f64::from(size[k]) / NATURAL[k]);
        parts[0].min(parts[1]).max(1.0)
    }
}

/// Smallest and largest coordinates in the picture plane, to the right and upwards, of what a camera sees of surfaces.
pub fn window<'a>(surfaces: impl Iterator<Item = &'a Primitives>, camera: Camera) -> [[f64; 2]; 2] {
    let view = camera.view();
    let corners = surfaces.flat_map(Primitives::places).map(|corner| view.project(corner));
    let (low, high) = bounds(corners.map(|[x, y, _]| [x, y]));
    [low, high]
}

/// Smallest and largest finite value of surfaces, as the ends of a colour bar.
pub fn value_range<'a>(surfaces: impl Iterator<Item = &'a Primitives>) -> (f64, f64) {
    range(surfaces.flat_map(Primitives::values))
}

/// Draws the snapshots to one scale and with one colour range, as the text of an SVG file.
pub fn draw(shots: &[Shot], camera: Camera, style: &Style) -> String {
    draw_svg(shots, camera, style, &Layout::default())
}

/// Draws the snapshots as [`draw`], with a layout.
pub fn draw_svg(shots: &[Shot], camera: Camera, style: &Style, layout: &Layout) -> String {
    let plan = Plan::new(shots, camera, style, layout);
    let shown = layout.size.map_or(plan.total, |size| size.map(f64::from));
    let mut svg = Svg::new(plan.total, shown);
    plan.draw(shots, camera, style, Finish::COARSE, &mut svg);
    svg.finish()
}

/// Draws the snapshots as [`draw_svg`], as pixels. Without a size every unit of the composition has `fineness` of them.
pub fn draw_raster(
    shots: &[Shot],
    camera: Camera,
    style: &Style,
    layout: &Layout,
    (fineness, finish): (f64, Finish),
) -> Option<Raster> {
    let plan = Plan::new(shots, camera, style, layout);
    let scale = if layout.size.is_some() { layout.scale() } else { fineness };
    let size = layout.size.unwrap_or(plan.total.map(|length| (length * scale).ceil() as u32));
    let mut raster = Raster::new(size, scale)?;
    plan.draw(shots, camera, style, finish, &mut raster);
    Some(raster)
}

/// Where everything stands.
struct Plan {
    /// Lower left and upper right corner of what is shown, in the picture plane.
    low: [f64; 2],
    high: [f64; 2],
    /// Pixels of a unit of length.
    scale: f64,
    /// Width and height of a snapshot.
    shot: [f64; 2],
    /// Width and height of the whole picture.
    total: [f64; 2],
}

impl Plan {
    fn new(shots: &[Shot], camera: Camera, style: &Style, layout: &Layout) -> Self {
        let [low, high] = layout.window.unwrap_or_else(|| window(shots.iter().map(|shot| &shot.surface), camera));
        let columns = columns(shots.len()) as f64;
        let rows = (shots.len() as f64 / columns).ceil();
        let around = [MARGIN + columns * MARGIN, TITLE + rows * CAPTION + BAR + MARGIN];
        let Some(size) = layout.size else {
            // At most twice as high as wide.
            let missing = (0.5 * (high[1] - low[1]) - (high[0] - low[0])).max(0.0);
            let (low, high) = ([low[0] - 0.5 * missing, low[1]], [high[0] + 0.5 * missing, high[1]]);
            let scale = style.width / (high[0] - low[0]).max(1e-300);
            let shot = [style.width, (high[1] - low[1]) * scale];
            return Self { low, high, scale, shot, total: [around[0] + columns * shot[0], around[1] + rows * shot[1]] };
        };
        let total = size.map(|length| f64::from(length) / layout.scale());
        let shot = [(total[0] - around[0]) / columns, (total[1] - around[1]) / rows].map(|length| length.max(1.0));
        let scale = (0..2).map(|k| shot[k] / (high[k] - low[k]).max(1e-300)).fold(f64::INFINITY, f64::min);
        // In the middle of its place.
        let missing: [f64; 2] = std::array::from_fn(|k| 0.5 * (shot[k] / scale - (high[k] - low[k])));
        let moved = |corner: [f64; 2], sign: f64| std::array::from_fn(|k| corner[k] + sign * missing[k]);
        Self { low: moved(low, -1.0), high: moved(high, 1.0), scale, shot, total }
    }

    fn draw(&self, shots: &[Shot], camera: Camera, style: &Style, finish: Finish, canvas: &mut dyn Canvas) {
        let view = camera.view();
        let screen = |x: f64, y: f64| [(x - self.low[0]) * self.scale, (self.high[1] - y) * self.scale];
        let visible: Vec<Visible> =
            shots.iter().map(|shot| Visible::new(&shot.surface, &view, screen, self.scale)).collect();
        let ends = style.range.unwrap_or_else(|| range(visible.iter().flat_map(Visible::values)));
        let columns = columns(shots.len());
        let size = letters::fitted(style.title, 18.0, self.total[0] - 2.0 * MARGIN);
        canvas.text(style.title, [MARGIN, 25.0], size, Anchor::Start);
        for (number, (shot, visible)) in shots.iter().zip(&visible).enumerate() {
            let x = MARGIN + (number % columns) as f64 * (self.shot[0] + MARGIN);
            let y = TITLE + (number / columns) as f64 * (self.shot[1] + CAPTION);
            canvas.enter([x, y]);
            visible.draw(canvas, ends, finish);
            canvas.leave();
            let place = [x + 0.5 * self.shot[0], y + self.shot[1] + 18.0];
            canvas.text(&shot.caption, place, letters::fitted(&shot.caption, 14.0, self.shot[0]), Anchor::Middle);
        }
        bar(canvas, style.label, ends, self.total, finish.colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera = Camera { azimuth: 30.0, elevation: 30.0 };
    const STYLE: Style = Style { title: "t", label: "l", width: 200.0, range: None };

    fn cube() -> Primitives {
        let grid = crate::vtu::tests::cube(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        Primitives::new(&grid, "speed").unwrap()
    }

    #[test]
    fn equal_snapshots_are_drawn_equally_and_in_plain_numbers() {
        let shot = || Shot { caption: String::new(), surface: cube() };
        let [one, two] = [draw(&[shot()], CAMERA, &STYLE), draw(&[shot(), shot()], CAMERA, &STYLE)];
        let faces = |svg: &str| svg.matches("<path stroke=\"#222222\" d=").count();
        assert_eq!([faces(&one), faces(&two)], [3, 6]);
        assert!(!two.contains("NaN") && !two.contains("inf"));
    }

    #[test]
    fn many_snapshots_stand_in_two_rows() {
        assert_eq!([0, 1, 4, 5, 6, 7].map(columns), [1, 1, 4, 3, 3, 4]);
        let shots: Vec<Shot> = (0..5).map(|k| Shot { caption: format!("shot {k}"), surface: cube() }).collect();
        let svg = draw(&shots, CAMERA, &STYLE);
        let places = |wanted: &str| svg.matches(wanted).count();
        // Three columns: 14, 228 and 442 pixels from the left, the first two twice.
        assert_eq!(["translate(14 ", "translate(228 ", "translate(442 "].map(places), [2, 2, 1]);
        assert_eq!(places(" 38)"), 3);
    }

    #[test]
    fn a_constant_field_is_drawn() {
        let svg = draw(
            &[Shot {
                caption: String::new(),
                surface: Primitives::new(&crate::vtu::tests::cube(&[-38.5; 8]), "speed").unwrap(),
            }],
            CAMERA,
            &STYLE,
        );
        assert_eq!(svg.matches(">-38.5<").count(), 3, "{svg}");
    }
}
