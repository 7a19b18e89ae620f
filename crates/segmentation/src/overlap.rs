//! Area common to two convex polygons in floating point, for checks and for sheets one behind the other.

use crate::plane::{cross, sub};
use crate::{MAX_VERTICES, Segment};

const ROOM: usize = 2 * MAX_VERTICES + 2;

/// The sides of a segment's image as their ends, without those that round-off has turned: of vertices that nearly coincide, with others of the polygon
/// farther to their right than they are long. How short a side is says nothing: beside a master edge that nearly follows a slave edge a segment
/// may be as narrow as its end, and would have none without it.
pub(crate) fn sides(segment: &Segment) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let v = segment.vertices();
    let ends = (0..v.len()).map(|k| [v[k].image, v[(k + 1) % v.len()].image]);
    ends.filter(move |&[p, q]| {
        let d = sub(q, p);
        let squared = d[0] * d[0] + d[1] * d[1];
        squared > 0.0 && v.iter().all(|w| cross(d, sub(w.image, p)) >= -squared)
    })
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
