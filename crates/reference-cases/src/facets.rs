//! Pairs of quadrilateral facets and the area that they have in common, clipped in another way than any that the
//! program uses.

use nalgebra::{Rotation3, Vector3};

/// Corners of a facet.
pub type Quad = [Vector3<f64>; 4];

/// A point of the plane.
pub type Point = [f64; 2];

/// Corners of the square of side 2 about the origin, counter-clockwise.
pub const SQUARE: [Point; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// What makes a random facet of the square; see [`RandomQuad::place`].
#[derive(Clone, Copy, Debug)]
pub struct RandomQuad {
    /// How far the corners are moved, in sides of the unit square.
    pub moves: Quad,
    /// Rotation vector.
    pub tilt: Vector3<f64>,
    /// Translation.
    pub shift: Vector3<f64>,
    /// Square of the factor of the size.
    pub scale: f64,
    /// Whether the facet is on a lattice of 1/2, where corners and edges of several facets coincide.
    pub snap: bool,
}

impl RandomQuad {
    /// Ranges of tilt, shift and scale that give overlaps of every kind, for generators.
    pub const TILT: f64 = 0.5;
    /// Range of the shift, see [`Self::TILT`].
    pub const SHIFT: f64 = 1.2;
    /// Smallest and largest scale, see [`Self::TILT`].
    pub const SCALE: [f64; 2] = [0.05, 20.0];

    /// The facet.
    pub fn place(&self) -> Quad {
        let turn = Rotation3::from_scaled_axis(self.tilt);
        let scale = self.scale.sqrt();
        std::array::from_fn(|k| {
            let x = Vector3::new(SQUARE[k][0], SQUARE[k][1], 0.0) + self.moves[k];
            if self.snap {
                (x * scale * 2.0).map(f64::round) * 0.5
            } else {
                turn * x * scale + self.shift + Vector3::new(0.0, 0.0, self.shift.x)
            }
        })
    }
}

/// A plane facet at the height `z`.
pub fn flat(p: [Point; 4], z: f64) -> Quad {
    p.map(|p| Vector3::new(p[0], p[1], z))
}

/// Numbered the other way round: it looks to the other side.
pub fn reversed(q: Quad) -> Quad {
    [q[0], q[3], q[2], q[1]]
}

fn cross(o: Point, a: Point, b: Point) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

/// Extent in y of a triangle at `x`.
fn extent(t: &[Point; 3], x: f64) -> (f64, f64) {
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        if (a[0] - x) * (b[0] - x) < 0.0 {
            let y = a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
            range = (range.0.min(y), range.1.max(y));
        }
    }
    range
}

/// Area of the intersection of two triangles by slabs: between the abscissae of all corners and of all intersections
/// of sides the height of the intersection is linear in x. An abscissa that round-off adds or moves does no harm.
fn triangles_common(s: [Point; 3], m: [Point; 3]) -> f64 {
    let mut cuts = [0.0; 15];
    let mut count = 6;
    for (cut, p) in cuts.iter_mut().zip(s.iter().chain(&m)) {
        *cut = p[0];
    }
    for i in 0..3 {
        for j in 0..3 {
            let (a, b, c, d) = (s[i], s[(i + 1) % 3], m[j], m[(j + 1) % 3]);
            let (u, v) = (cross(c, d, a), cross(c, d, b));
            if u * v < 0.0 {
                cuts[count] = a[0] + u / (u - v) * (b[0] - a[0]);
                count += 1;
            }
        }
    }
    let cuts = &mut cuts[..count];
    cuts.sort_by(f64::total_cmp);
    let slab = |w: &[f64]| {
        let x = 0.5 * (w[0] + w[1]);
        let (p, q) = (extent(&s, x), extent(&m, x));
        let height = p.1.min(q.1) - p.0.max(q.0);
        if w[1] > w[0] && height > 0.0 { (w[1] - w[0]) * height } else { 0.0 }
    };
    cuts.windows(2).map(slab).sum()
}

/// Area common to two simple quadrilaterals (also reflex ones) as a sum over signed fans of triangles.
fn quads_common(s: [Point; 4], m: [Point; 4]) -> f64 {
    let fan = |q: [Point; 4]| {
        [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]
            .map(|t| if cross(t[0], t[1], t[2]) >= 0.0 { (1.0, t) } else { (-1.0, [t[0], t[2], t[1]]) })
    };
    let mut sum = 0.0;
    for (a, s) in fan(s) {
        for (b, m) in fan(m) {
            sum += a * b * triangles_common(s, m);
        }
    }
    sum
}

fn crosses_itself(q: [Point; 4]) -> bool {
    let cut = |a: Point, b: Point, c: Point, d: Point| {
        cross(a, b, c) * cross(a, b, d) <= 0.0 && cross(c, d, a) * cross(c, d, b) <= 0.0
    };
    cut(q[0], q[1], q[2], q[3]) || cut(q[1], q[2], q[3], q[0])
}

/// Images in the plane normal to the slave at its centre, by an orthonormal frame made here: the sum of the products of
/// neighbouring corners has the direction of the diagonals' product.
fn images(s: &Quad, m: &Quad) -> ([Point; 4], [Point; 4]) {
    let n = (0..4).map(|k| s[k].cross(&s[(k + 1) % 4])).sum::<Vector3<f64>>().normalize();
    let helper = if n.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let t1 = n.cross(&helper).normalize();
    let t2 = n.cross(&t1);
    let f = |x: Vector3<f64>| [t1.dot(&(x - s[0])), t2.dot(&(x - s[0]))];
    (s.map(f), m.map(f))
}

/// Area that a master facet `m` (outward, towards the slave) covers of the image of the slave facet `s`, and the area of
/// that image. Nothing if an image crosses itself.
pub fn common_area(s: &Quad, m: &Quad) -> Option<(f64, f64)> {
    let (a, b) = images(s, m);
    let b = [b[0], b[3], b[2], b[1]];
    let area = |q: [Point; 4]| 0.5 * (cross(q[0], q[1], q[2]) + cross(q[0], q[2], q[3]));
    if crosses_itself(a) || crosses_itself(b) {
        return None;
    }
    Some((if area(b) <= 0.0 { 0.0 } else { quads_common(a, b) }, area(a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_worked_out_by_hand() {
        let s = flat(SQUARE, 0.0);
        let common = |m: Quad| common_area(&s, &m).unwrap();
        assert_eq!(common(reversed(s)), (4.0, 4.0));
        assert_eq!(common(s).0, 0.0, "from behind");
        let moved = reversed(s.map(|x| x + Vector3::new(0.5, 1.0, 0.3)));
        assert!((common(moved).0 - 1.5).abs() < 1e-14);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_4);
        let octagon = 8.0 * (std::f64::consts::PI / 8.0).tan();
        assert!((common(reversed(s.map(|x| turn * x))).0 - octagon).abs() < 1e-14);
        assert!(common_area(&s, &flat([SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]], 0.0)).is_none(), "bow tie");
    }
}
