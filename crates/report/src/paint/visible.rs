//! What is visible of a surface: faces, lines and points from back to front, coloured, faces lightly shaded and with thin edges.

use super::camera::{View, cross, dot};
use super::canvas::{Canvas, Colour, DOT, LINE};
use super::colour::colour;
use super::surface::{Primitives, Quad};

/// Fineness of colours.
#[derive(Clone, Copy, Debug)]
pub struct Finish {
    /// Every face is drawn as `parts * parts` pieces of one colour each.
    pub parts: usize,
    /// Colour of a value between zero and one under a light.
    pub colour: fn(f64, f64) -> Colour,
}

impl Finish {
    /// The finish for files that grow with every piece.
    pub const COARSE: Self = Self { parts: 2, colour };
    /// The finish for pixels.
    pub const FINE: Self = Self { parts: 4, colour };
}

/// Pieces are drawn this much wider, in pixels, so that no seams show between them.
const OVERLAP: f64 = 0.35;

/// Facets of rigid bodies and lines are drawn in parts of this length in pixels at most, so that what is behind one end and before the other comes in the right
/// order.
const LONGEST: f64 = 24.0;

/// Most parts of an edge of a facet.
const MOST_PARTS: usize = 40;

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

/// What is drawn of a surface, from back to front each.
pub(super) struct Visible {
    faces: Vec<Face>,
    strokes: Vec<Stroke>,
}

/// Colour and corners of a part of a face.
type Piece = (Colour, [[f64; 2]; 4]);

impl Visible {
    /// The visible parts of a surface; `screen` takes coordinates of the picture plane to pixels, of which a unit of length has `scale`.
    pub(super) fn new(surface: &Primitives, view: &View, screen: impl Fn(f64, f64) -> [f64; 2], scale: f64) -> Self {
        Self { faces: uncovered(faces(surface, view, &screen)), strokes: strokes(surface, view, &screen, scale) }
    }

    /// All values that are drawn.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        let of_faces = self.faces.iter().flat_map(|face| face.values);
        of_faces.chain(self.strokes.iter().map(|stroke| stroke.value))
    }

    /// Draws it with this range of values.
    pub(super) fn draw(&self, canvas: &mut dyn Canvas, range: (f64, f64), finish: Finish) {
        let mut strokes = self.strokes.iter().peekable();
        for face in &self.faces {
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
}

/// Faces turned towards the eye, of open surfaces all, from back to front.
fn faces(surface: &Primitives, view: &View, screen: impl Fn(f64, f64) -> [f64; 2]) -> Vec<Face> {
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
fn strokes(surface: &Primitives, view: &View, screen: impl Fn(f64, f64) -> [f64; 2], scale: f64) -> Vec<Stroke> {
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
pub(super) fn bounds(points: impl Iterator<Item = [f64; 2]>) -> ([f64; 2], [f64; 2]) {
    points.fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), point| {
        (std::array::from_fn(|k| low[k].min(point[k])), std::array::from_fn(|k| high[k].max(point[k])))
    })
}

/// A range whose ends differ by less than this part of them is that of a constant.
const CONSTANT: f64 = 1.0e-12;

/// Smallest and largest finite value, twice the same if they differ by round-off only; zero and one if there is none.
pub(super) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
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
    use super::super::camera::Camera;
    use super::*;

    const CAMERA: Camera = Camera { azimuth: 30.0, elevation: 30.0 };

    #[test]
    fn three_faces_of_a_cube_are_visible_from_back_to_front() {
        let grid = crate::vtu::tests::cube(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let surface = Primitives::new(&grid, "speed").unwrap();
        let found = faces(&surface, &CAMERA.view(), |x, y| [100.0 * x, 100.0 * y]);
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
    fn constant_fields_have_a_range() {
        assert_eq!(range([-38.5, -38.5].into_iter()), (-38.5, -38.5));
        assert_eq!(range([1.1, 1.1 + 1e-15].into_iter()), (1.1, 1.1));
        assert_eq!(range([0.0].into_iter()), (0.0, 0.0));
        assert_eq!(range([f64::NAN, f64::INFINITY].into_iter()), (0.0, 1.0));
        assert_eq!([place_in(2.0, (2.0, 2.0)), place_in(2.0, (0.0, 8.0))], [0.5, 0.25]);
        assert!(place_in(f64::NAN, (2.0, 2.0)).is_nan());
    }
}
