//! Vectors in the segmentation plane, and the exact predicate of orientation.

use robust::{Coord, orient2d};

/// `a - b`.
pub(crate) fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// `a x b`, a number in the plane.
pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Positive if `a`, `b`, `c` run counter-clockwise, negative if clockwise, zero if they are on a line; its sign is exact.
pub(crate) fn orient(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    orient2d(coord(a), coord(b), coord(c))
}
