//! Snapshots side by side, in rows if there are many, as SVG: visible faces, lines and points from back to front,
//! coloured, faces lightly shaded and with thin edges.

use std::fmt::Write;

use super::bar::{HEIGHT as BAR, bar};
use super::camera::{Camera, View, cross, dot};
use super::colour;
use super::surface::{Quad, Surface};

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

/// Every face is drawn as `PARTS * PARTS` pieces of one colour each.
const PARTS: usize = 2;

/// Pieces are drawn this much wider, in pixels, so that no seams show between them.
const OVERLAP: f64 = 0.35;

/// Facets of rigid bodies and lines are drawn in parts of this length in pixels at most, so that what is behind one end and before the other comes in the right
/// order.
const LONGEST: f64 = 24.0;

/// Most parts of an edge of a facet.
const MOST_PARTS: usize = 40;

/// Width of lines, diameter of points and width of the dark rims around both, in pixels.
const LINE: f64 = 3.2;
const DOT: f64 = 9.0;
const RIM: f64 = 0.7;

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
type Piece = (String, [[f64; 2]; 4]);

/// Snapshots in a row: all up to four, then as many as make two rows.
pub fn columns(shots: usize) -> usize {
    if shots <= 4 { shots.max(1) } else { shots.div_ceil(2) }
}

/// Draws the snapshots to one scale and with one colour range.
pub fn draw(shots: &[Shot], camera: Camera, style: &Style) -> String {
    let view = camera.view();
    let corners = shots.iter().flat_map(|shot| shot.surface.places());
    let ([left, low], [right, high]) = bounds(corners.map(|corner| view.project(corner)).map(|[x, y, _]| [x, y]));
    // At most twice as high as wide.
    let missing = (0.5 * (high - low) - (right - left)).max(0.0);
    let (left, right) = (left - 0.5 * missing, right + 0.5 * missing);
    let scale = style.width / (right - left).max(1e-300);
    let height = (high - low) * scale;
    let screen = |x: f64, y: f64| [(x - left) * scale, (high - y) * scale];
    let visible = |shot: &Shot| Visible {
        faces: uncovered(faces(&shot.surface, &view, screen)),
        strokes: strokes(&shot.surface, &view, screen, scale),
    };
    let visible: Vec<Visible> = shots.iter().map(visible).collect();
    let of_faces = visible.iter().flat_map(|shot| &shot.faces).flat_map(|face| face.values);
    let of_strokes = visible.iter().flat_map(|shot| &shot.strokes).map(|stroke| stroke.value);
    let (least, most) = style.range.unwrap_or_else(|| range(of_faces.chain(of_strokes)));
    let columns = columns(shots.len());
    let rows = shots.len().div_ceil(columns) as f64;
    let total = [MARGIN + columns as f64 * (style.width + MARGIN), TITLE + rows * (height + CAPTION) + BAR + MARGIN];
    let mut out = String::new();
    // Writing to a String does not fail.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" width=\"{:.0}\" height=\"{:.0}\" \
         font-family=\"sans-serif\" fill=\"#333\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{MARGIN}\" y=\"25\" font-size=\"18\">{}</text>",
        total[0], total[1], total[0], total[1], style.title
    );
    for (number, (shot, visible)) in shots.iter().zip(&visible).enumerate() {
        let x = MARGIN + (number % columns) as f64 * (style.width + MARGIN);
        let y = TITLE + (number / columns) as f64 * (height + CAPTION);
        let _ = writeln!(out, "<g transform=\"translate({x:.1} {y:.1})\">");
        snapshot(&mut out, visible, (least, most));
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"14\" text-anchor=\"middle\">{}</text>\n</g>",
            0.5 * style.width,
            height + 18.0,
            shot.caption
        );
    }
    bar(&mut out, style.label, (least, most), total);
    out.push_str("</svg>\n");
    out
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
        return vec![(*quad, [true; 4])];
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
fn pieces(face: &Face, range: (f64, f64)) -> Vec<Piece> {
    let parts = (0..PARTS).flat_map(|i| (0..PARTS).map(move |j| (i as f64, j as f64)));
    let mut pieces: Vec<Piece> = parts
        .map(|(i, j)| {
            let at = |x: f64, y: f64| ((i + x) / PARTS as f64, (j + y) / PARTS as f64);
            let [value] = blend(at(0.5, 0.5), face.values.map(|value| [value]));
            let fill = colour::hex((value - range.0) / (range.1 - range.0), face.light);
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

fn snapshot(out: &mut String, visible: &Visible, range: (f64, f64)) {
    out.push_str(
        "<g fill=\"none\" stroke=\"#222\" stroke-opacity=\".5\" stroke-width=\".5\" stroke-linejoin=\"round\">\n",
    );
    let mut strokes = visible.strokes.iter().peekable();
    for face in &visible.faces {
        while let Some(behind) = strokes.next_if(|stroke| stroke.nearness < face.nearness) {
            stroke(out, behind, range);
        }
        draw_face(out, face, range);
    }
    strokes.for_each(|before| stroke(out, before, range));
    out.push_str("</g>\n");
}

fn draw_face(out: &mut String, face: &Face, range: (f64, f64)) {
    for (fill, corners) in &pieces(face, range) {
        let _ = write!(out, "<path stroke=\"none\" fill=\"{fill}\" d=\"");
        path(out, &widened(corners));
        out.push_str("z\"/>");
    }
    if face.edges == [true; 4] {
        out.push_str("<path d=\"");
        path(out, &face.corners);
        out.push_str("z\"/>\n");
    } else if face.edges.contains(&true) {
        out.push_str("<path d=\"");
        for k in (0..4).filter(|&k| face.edges[k]) {
            path(out, &[face.corners[k], face.corners[(k + 1) % 4]]);
        }
        out.push_str("\"/>\n");
    } else {
        out.push('\n');
    }
}

/// A part of a line, or a disc, with a dark rim.
fn stroke(out: &mut String, stroke: &Stroke, range: (f64, f64)) {
    let fill = colour::hex((stroke.value - range.0) / (range.1 - range.0), 1.0);
    let [from, to] = stroke.ends;
    if from == to {
        let (x, y, radius) = (from[0], from[1], 0.5 * DOT);
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke-opacity=\"1\" stroke-width=\"{RIM}\"/>"
        );
        return;
    }
    // Round ends of the colour alone join the parts of a line without gaps.
    for (colour, width, cap) in [("#222", LINE + 2.0 * RIM, "butt"), (fill.as_str(), LINE, "round")] {
        let _ = write!(
            out,
            "<path stroke=\"{colour}\" stroke-opacity=\"1\" stroke-width=\"{width:.1}\" stroke-linecap=\"{cap}\" d=\""
        );
        path(out, &stroke.ends);
        out.push_str("\"/>");
    }
    out.push('\n');
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

/// Absolute start, then relative lines, in tenths of a pixel.
fn path(out: &mut String, points: &[[f64; 2]]) {
    let mut last = [0.0; 2];
    for (number, point) in points.iter().enumerate() {
        let rounded = point.map(|x| (x * 10.0).round());
        let _ = write!(out, "{}", if number == 0 { 'M' } else { 'l' });
        let [x, y] = [tenths(rounded[0] - last[0]), tenths(rounded[1] - last[1])];
        let _ = write!(out, "{x}{}{y}", if y.starts_with('-') { "" } else { " " });
        last = rounded;
    }
}

/// A number of tenths without needless digits.
fn tenths(value: f64) -> String {
    let text = format!("{}", value / 10.0);
    match (text.strip_prefix("0."), text.strip_prefix("-0.")) {
        (Some(digits), _) => format!(".{digits}"),
        (_, Some(digits)) => format!("-.{digits}"),
        _ => text,
    }
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

/// Smallest and largest finite value, moved apart if they are equal; zero and one if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values = values.filter(|value| value.is_finite());
    let (least, most) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
    match most - least {
        apart if apart > 0.0 => (least, most),
        0.0 => (least.min(0.0), least.max(0.0) + 1.0),
        _ => (0.0, 1.0),
    }
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
        let faces = |svg: &str| svg.matches("<path d=").count();
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
        assert_eq!(["translate(14.0 ", "translate(228.0 ", "translate(442.0 "].map(places), [2, 2, 1]);
        assert_eq!(places(" 38.0)"), 3);
    }

    #[test]
    fn numbers_in_paths_are_short_and_exact() {
        let mut out = String::new();
        path(&mut out, &[[1.26, 0.5], [1.26, 0.5], [0.0, 10.0]]);
        assert_eq!(out, "M1.3 .5l0 0l-1.3 9.5");
    }

    #[test]
    fn constant_fields_have_a_range() {
        assert_eq!(range([2.0, 2.0].into_iter()), (0.0, 3.0));
        assert_eq!(range([0.0].into_iter()), (0.0, 1.0));
        assert_eq!(range([f64::NAN, f64::INFINITY].into_iter()), (0.0, 1.0));
    }
}
