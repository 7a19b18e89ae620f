//! Snapshots side by side, in rows if there are many: visible faces, lines and points from back to front,
//! coloured, faces lightly shaded and with thin edges.

use super::bar::{HEIGHT as BAR, bar};
use super::camera::{Camera, View, cross, dot};
use super::canvas::{Anchor, Canvas, Colour, DOT, LINE};
use super::colour::colour;
use super::letters;
use super::raster::Raster;
use super::surface::{Quad, Surface};
use super::svg::Svg;

/// One snapshot.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Below the snapshot.
    pub caption: String,
    /// What is drawn.
    pub surface: Surface,
}

/// What stands around the snapshots.
#[derive(Clone, Copy, Debug)]
pub struct Style<'a> {
    /// Above.
    pub title: &'a str,
    /// At the colour bar.
    pub label: &'a str,
    /// Width of a snapshot in pixels.
    pub width: f64,
    /// Values at the ends of the colour bar; without them the smallest and the largest visible value.
    pub range: Option<(f64, f64)>,
}

/// How fine colours are.
#[derive(Clone, Copy, Debug)]
pub struct Finish {
    /// Every face is drawn as `parts * parts` pieces of one colour each.
    pub parts: usize,
    /// Colour of a value between zero and one under a light.
    pub colour: fn(f64, f64) -> Colour,
}

impl Finish {
    /// For files that grow with every piece.
    pub const COARSE: Self = Self { parts: 2, colour };
    /// For pixels.
    pub const FINE: Self = Self { parts: 4, colour };
}

/// Pieces are drawn this much wider, in pixels, so that no seams show between them.
const OVERLAP: f64 = 0.35;

/// Facets of rigid bodies and lines are drawn in parts of this length in pixels at most, so that what is behind one end and before the other comes in the right
/// order.
const LONGEST: f64 = 24.0;

/// Most parts of an edge of a facet.
const MOST_PARTS: usize = 40;

const MARGIN: f64 = 14.0;
const TITLE: f64 = 38.0;
const CAPTION: f64 = 26.0;

/// A face in the picture plane.
struct Face {
    nearness: f64,
    corners: [[f64; 2]; 4],
    values: [f64; 4],
    light: f64,
    /// Which of the edges are drawn: those that are no division of a facet.
    edges: [bool; 4],
}

/// A part of a line, or a point if both ends are the same.
struct Stroke {
    nearness: f64,
    ends: [[f64; 2]; 2],
    value: f64,
}

/// What is drawn of a snapshot, from back to front each.
struct Visible {
    faces: Vec<Face>,
    strokes: Vec<Stroke>,
}

/// Colour and corners of a part of a face.
type Piece = (Colour, [[f64; 2]; 4]);

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
pub fn window<'a>(surfaces: impl Iterator<Item = &'a Surface>, camera: Camera) -> [[f64; 2]; 2] {
    let view = camera.view();
    let corners = surfaces.flat_map(Surface::places).map(|corner| view.project(corner));
    let (low, high) = bounds(corners.map(|[x, y, _]| [x, y]));
    [low, high]
}

/// Smallest and largest finite value of surfaces, as the ends of a colour bar.
pub fn value_range<'a>(surfaces: impl Iterator<Item = &'a Surface>) -> (f64, f64) {
    range(surfaces.flat_map(Surface::values))
}

/// Draws the snapshots to one scale and with one colour range, as the text of an SVG file.
pub fn draw(shots: &[Shot], camera: Camera, style: &Style) -> String {
    draw_svg(shots, camera, style, &Layout::default())
}

/// As [`draw`], with a layout.
pub fn draw_svg(shots: &[Shot], camera: Camera, style: &Style, layout: &Layout) -> String {
    let plan = Plan::new(shots, camera, style, layout);
    let shown = layout.size.map_or(plan.total, |size| size.map(f64::from));
    let mut svg = Svg::new(plan.total, shown);
    plan.draw(shots, camera, style, Finish::COARSE, &mut svg);
    svg.finish()
}

/// As [`draw_svg`], as pixels. Without a size every unit of the composition has `fineness` of them.
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
    /// Of the whole picture.
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
        let visible = |shot: &Shot| Visible {
            faces: uncovered(faces(&shot.surface, &view, screen)),
            strokes: strokes(&shot.surface, &view, screen, self.scale),
        };
        let visible: Vec<Visible> = shots.iter().map(visible).collect();
        let of_faces = visible.iter().flat_map(|shot| &shot.faces).flat_map(|face| face.values);
        let of_strokes = visible.iter().flat_map(|shot| &shot.strokes).map(|stroke| stroke.value);
        let ends = style.range.unwrap_or_else(|| range(of_faces.chain(of_strokes)));
        let columns = columns(shots.len());
        let size = letters::fitted(style.title, 18.0, self.total[0] - 2.0 * MARGIN);
        canvas.text(style.title, [MARGIN, 25.0], size, Anchor::Start);
        for (number, (shot, visible)) in shots.iter().zip(&visible).enumerate() {
            let x = MARGIN + (number % columns) as f64 * (self.shot[0] + MARGIN);
            let y = TITLE + (number / columns) as f64 * (self.shot[1] + CAPTION);
            canvas.enter([x, y]);
            snapshot(canvas, visible, ends, finish);
            canvas.leave();
            let place = [x + 0.5 * self.shot[0], y + self.shot[1] + 18.0];
            canvas.text(&shot.caption, place, letters::fitted(&shot.caption, 14.0, self.shot[0]), Anchor::Middle);
        }
        bar(canvas, style.label, ends, self.total, finish.colour);
    }
}

/// Faces turned towards the eye, of open surfaces all, from back to front.
fn faces(surface: &Surface, view: &View, screen: impl Fn(f64, f64) -> [f64; 2]) -> Vec<Face> {
    let mut faces = Vec::new();
    for quad in &surface.quads {
        let [a, b, c, d] = quad.corners;
        let normal = cross(difference(c, a), difference(d, b));
        let length = dot(normal, normal).sqrt();
        let towards = dot(normal, view.eye);
        if length == 0.0 || towards == 0.0 || towards < 0.0 && !quad.has_back {
            continue;
        }
        let light = shade(normal.map(|entry| entry / length.copysign(towards)), view);
        for (quad, edges) in divided(quad, view, &screen) {
            faces.push(Face {
                nearness: view.project(blend((0.5, 0.5), quad.corners))[2],
                corners: on_screen(quad.corners, view, &screen),
                values: quad.values,
                light,
                edges,
            });
        }
    }
    faces.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    faces
}

fn on_screen<const N: usize>(
    places: [[f64; 3]; N],
    view: &View,
    screen: &impl Fn(f64, f64) -> [f64; 2],
) -> [[f64; 2]; N] {
    places.map(|place| {
        let [x, y, _] = view.project(place);
        screen(x, y)
    })
}

/// Parts of a facet of a rigid body, with the edges that are edges of the facet; other faces are left whole.
fn divided(quad: &Quad, view: &View, screen: &impl Fn(f64, f64) -> [f64; 2]) -> Vec<(Quad, [bool; 4])> {
    let [a, b, c, d] = on_screen(quad.corners, view, screen);
    let parts = |one: f64, other: f64| match quad.is_rigid {
        true => ((one.max(other) / LONGEST).ceil() as usize).clamp(1, MOST_PARTS),
        false => 1,
    };
    let apart = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    let (n, m) = (parts(apart(a, b), apart(c, d)), parts(apart(b, c), apart(d, a)));
    if (n, m) == (1, 1) {
        return vec![(*quad, quad.edges)];
    }
    let part = |i: usize, j: usize| {
        let at = |x: usize, y: usize| ((i + x) as f64 / n as f64, (j + y) as f64 / m as f64);
        let places = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
        let corners = places.map(|at| blend(at, quad.corners));
        let values = places.map(|at| blend(at, quad.values.map(|value| [value]))[0]);
        (Quad { corners, values, ..*quad }, [j == 0, i + 1 == n, j + 1 == m, i == 0])
    };
    (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| part(i, j)).collect()
}

/// Lines in parts, and points, from back to front; all a little nearer than they are, so that faces on which they lie do not cover them.
fn strokes(surface: &Surface, view: &View, screen: impl Fn(f64, f64) -> [f64; 2], scale: f64) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let mut add = |ends: [[f64; 3]; 2], value: f64, width: f64| {
        let near = ends.map(|end| view.project(end)[2]);
        let nearness = 0.5 * (near[0] + near[1]) + width / scale;
        strokes.push(Stroke { nearness, ends: on_screen(ends, view, &screen), value });
    };
    for line in &surface.lines {
        for (ends, values) in line.points.windows(2).zip(line.values.windows(2)) {
            let along = difference(ends[1], ends[0]);
            let count = (dot(along, along).sqrt() * scale / LONGEST).ceil().clamp(1.0, MOST_PARTS as f64);
            let at = |k: f64| std::array::from_fn(|i| ends[0][i] + k / count * along[i]);
            for k in (0..count as usize).map(|k| k as f64) {
                let value = values[0] + (k + 0.5) / count * (values[1] - values[0]);
                add([at(k), at(k + 1.0)], value, LINE);
            }
        }
    }
    for (place, value) in &surface.points {
        add([*place, *place], *value, DOT);
    }
    strokes.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    strokes
}

/// Parts of a face, or the whole face if they all have the same colour.
fn pieces(face: &Face, range: (f64, f64), Finish { parts, colour }: Finish) -> Vec<Piece> {
    let all = (0..parts).flat_map(|i| (0..parts).map(move |j| (i as f64, j as f64)));
    let mut pieces: Vec<Piece> = all
        .map(|(i, j)| {
            let at = |x: f64, y: f64| ((i + x) / parts as f64, (j + y) / parts as f64);
            let [value] = blend(at(0.5, 0.5), face.values.map(|value| [value]));
            let fill = colour(place_in(value, range), face.light);
            (fill, [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)].map(|at| blend(at, face.corners)))
        })
        .collect();
    if pieces.iter().all(|piece| piece.0 == pieces[0].0) {
        pieces.truncate(1);
        pieces[0].1 = face.corners;
    }
    pieces
}

/// Leaves out the faces that are hidden behind later ones: those that own no sample of a raster of half pixels.
fn uncovered(faces: Vec<Face>) -> Vec<Face> {
    const FINENESS: f64 = 2.0;
    let raster = |face: &Face| face.corners.map(|corner| corner.map(|x| x * FINENESS));
    let ([left, top], [right, bottom]) = bounds(faces.iter().flat_map(raster));
    let (columns, rows) = ((right - left).ceil() as usize + 1, (bottom - top).ceil() as usize + 1);
    let mut owner = vec![None; columns * rows];
    for (number, face) in faces.iter().enumerate() {
        let corners = raster(face).map(|[x, y]| [x - left, y - top]);
        let (low, high) = bounds(corners.into_iter());
        for row in low[1].floor() as usize..=high[1].ceil() as usize {
            for column in low[0].floor() as usize..=high[0].ceil() as usize {
                let sample = [column as f64, row as f64];
                if column < columns && row < rows && inside(sample, &corners) {
                    owner[row * columns + column] = Some(number);
                }
            }
        }
    }
    let mut seen = vec![false; faces.len()];
    owner.into_iter().flatten().for_each(|number| seen[number] = true);
    faces.into_iter().zip(seen).filter(|(_, seen)| *seen).map(|(face, _)| face).collect()
}

/// True if a point lies in a convex quadrilateral of either orientation.
fn inside(point: [f64; 2], corners: &[[f64; 2]; 4]) -> bool {
    let side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])
    };
    let sides = [side(0), side(1), side(2), side(3)];
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}

/// Bilinear interpolation between the corners of a unit square.
fn blend<const N: usize>((x, y): (f64, f64), corners: [[f64; N]; 4]) -> [f64; N] {
    let weights = [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
    std::array::from_fn(|k| weights.iter().zip(corners).map(|(weight, corner)| weight * corner[k]).sum())
}

/// Brightness of a face: light from the upper left behind the eye, and some from everywhere.
fn shade(normal: [f64; 3], view: &View) -> f64 {
    let light: [f64; 3] = std::array::from_fn(|k| 0.62 * view.eye[k] + 0.65 * view.up[k] - 0.44 * view.right[k]);
    0.62 + 0.42 * dot(normal, light).max(0.0)
}

fn snapshot(canvas: &mut dyn Canvas, visible: &Visible, range: (f64, f64), finish: Finish) {
    let mut strokes = visible.strokes.iter().peekable();
    for face in &visible.faces {
        while let Some(behind) = strokes.next_if(|stroke| stroke.nearness < face.nearness) {
            draw_stroke(canvas, behind, range, finish);
        }
        for (fill, corners) in &pieces(face, range, finish) {
            canvas.piece(*fill, &widened(corners));
        }
        canvas.edges(&face.corners, face.edges);
    }
    strokes.for_each(|before| draw_stroke(canvas, before, range, finish));
}

/// A part of a line, or a disc.
fn draw_stroke(canvas: &mut dyn Canvas, stroke: &Stroke, range: (f64, f64), finish: Finish) {
    let fill = (finish.colour)(place_in(stroke.value, range), 1.0);
    match stroke.ends {
        [from, to] if from == to => canvas.disc(fill, from),
        ends => canvas.line(fill, &ends),
    }
}

/// Corners moved away from the middle by [`OVERLAP`].
fn widened(corners: &[[f64; 2]; 4]) -> [[f64; 2]; 4] {
    let middle: [f64; 2] = std::array::from_fn(|k| corners.iter().map(|corner| corner[k]).sum::<f64>() / 4.0);
    corners.map(|corner| {
        let away = [corner[0] - middle[0], corner[1] - middle[1]];
        let length = away[0].hypot(away[1]).max(OVERLAP);
        std::array::from_fn(|k| corner[k] + OVERLAP * away[k] / length)
    })
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Smallest and largest coordinates.
fn bounds(points: impl Iterator<Item = [f64; 2]>) -> ([f64; 2], [f64; 2]) {
    points.fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), point| {
        (std::array::from_fn(|k| low[k].min(point[k])), std::array::from_fn(|k| high[k].max(point[k])))
    })
}

/// A range whose ends differ by less than this part of them is that of a constant.
const CONSTANT: f64 = 1.0e-12;

/// Smallest and largest finite value, twice the same if they differ by round-off only; zero and one if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values = values.filter(|value| value.is_finite());
    let (least, most) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
    match most - least {
        apart if apart > CONSTANT * least.abs().max(most.abs()) => (least, most),
        apart if apart >= 0.0 => (least, least),
        _ => (0.0, 1.0),
    }
}

/// Where a value is between the ends of a range: zero to one. All of a constant is in the middle.
fn place_in(value: f64, (least, most): (f64, f64)) -> f64 {
    if least == most && value.is_finite() { 0.5 } else { (value - least) / (most - least) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera = Camera { azimuth: 30.0, elevation: 30.0 };
    const STYLE: Style = Style { title: "t", label: "l", width: 200.0, range: None };

    fn cube() -> Surface {
        let grid = crate::vtu::tests::cube(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        Surface::new(&grid, "speed").unwrap()
    }

    #[test]
    fn three_faces_of_a_cube_are_visible_from_back_to_front() {
        let found = faces(&cube(), &CAMERA.view(), |x, y| [100.0 * x, 100.0 * y]);
        assert_eq!(found.len(), 3);
        assert!(found.is_sorted_by(|a, b| a.nearness <= b.nearness));
        assert_eq!(uncovered(found).len(), 3);
    }

    #[test]
    fn what_lies_behind_is_left_out() {
        let square = |nearness: f64, half: f64| Face {
            nearness,
            corners: [[-half, -half], [half, -half], [half, half], [-half, half]],
            values: [0.0; 4],
            light: 1.0,
            edges: [true; 4],
        };
        let left = uncovered(vec![square(0.0, 5.0), square(1.0, 20.0), square(2.0, 5.0)]);
        assert_eq!(left.iter().map(|face| face.nearness).collect::<Vec<_>>(), [1.0, 2.0]);
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
    fn constant_fields_have_a_range() {
        assert_eq!(range([-38.5, -38.5].into_iter()), (-38.5, -38.5));
        assert_eq!(range([1.1, 1.1 + 1e-15].into_iter()), (1.1, 1.1));
        assert_eq!(range([0.0].into_iter()), (0.0, 0.0));
        assert_eq!(range([f64::NAN, f64::INFINITY].into_iter()), (0.0, 1.0));
        assert_eq!([place_in(2.0, (2.0, 2.0)), place_in(2.0, (0.0, 8.0))], [0.5, 0.25]);
        assert!(place_in(f64::NAN, (2.0, 2.0)).is_nan());
        let svg = draw(
            &[Shot {
                caption: String::new(),
                surface: Surface::new(&crate::vtu::tests::cube(&[-38.5; 8]), "speed").unwrap(),
            }],
            CAMERA,
            &STYLE,
        );
        assert_eq!(svg.matches(">-38.5<").count(), 3, "{svg}");
    }
}
