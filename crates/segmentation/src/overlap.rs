//! Area common to two convex polygons in floating point, for checks and for sheets one behind the other.

use crate::cell::{cross, sub};
use crate::{MAX_VERTICES, Segment};

const ROOM: usize = 2 * MAX_VERTICES + 2;
/// Vertices closer than this fraction of the polygon coincide: a side between them has no direction. A longer side must not be left out: the
/// polygon would have no end there, and beside a master edge that nearly follows a slave edge its neighbour may be as narrow as that side.
const ROUND_OFF: f64 = 1e-14;

/// The sides of a segment's image as their ends, without those of vertices that coincide to round-off: they have no direction.
pub(crate) fn sides(segment: &Segment) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let v = segment.vertices();
    let length = |[p, q]: [[f64; 2]; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
    let size = v.iter().map(|w| length([v[0].image, w.image])).fold(0.0, f64::max);
    let ends = (0..v.len()).map(|k| [v[k].image, v[(k + 1) % v.len()].image]);
    ends.filter(move |ends| length(*ends) > ROUND_OFF * size)
}

/// Area that the images of two segments have in common (Sutherland-Hodgman).
pub(crate) fn common_area(a: &Segment, b: &Segment) -> f64 {
    let mut polygon = [[0.0; 2]; ROOM];
    let mut count = a.vertices().len();
    for (p, v) in polygon.iter_mut().zip(a.vertices()) {
        *p = v.image;
    }
    for [p, q] in sides(b) {
        let side = |x: [f64; 2]| cross(sub(q, p), sub(x, p));
        let (mut next, mut kept) = ([[0.0; 2]; ROOM], 0);
        for i in 0..count {
            let (x, y) = (polygon[i], polygon[(i + 1) % count]);
            let (sx, sy) = (side(x), side(y));
            if sx >= 0.0 && kept < ROOM {
                next[kept] = x;
                kept += 1;
            }
            if (sx > 0.0 && sy < 0.0 || sx < 0.0 && sy > 0.0) && kept < ROOM {
                let f = sx / (sx - sy);
                next[kept] = [x[0] + f * (y[0] - x[0]), x[1] + f * (y[1] - x[1])];
                kept += 1;
            }
        }
        (polygon, count) = (next, kept);
        if count < 3 {
            return 0.0;
        }
    }
    let p = &polygon[..count];
    (1..count - 1).map(|k| 0.5 * cross(sub(p[k], p[0]), sub(p[k + 1], p[0]))).sum::<f64>().max(0.0)
}
