//! The surface of a cube divided into quadrilaterals, and its projection onto the sphere.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;

/// Lattice points and outward quadrilaterals of the surface of a box of `n` cells along each axis. The quadrilaterals
/// go face by face: x-, x+, y-, y+, z-, z+.
pub(crate) fn cube_surface(n: [usize; 3]) -> (Vec<[usize; 3]>, Vec<[u32; 4]>) {
    let mut numbers: HashMap<[usize; 3], u32> = HashMap::new();
    let mut points = Vec::new();
    let mut quads = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, n[axis]] {
            for j in 0..n[v] {
                for i in 0..n[u] {
                    // u, v, axis are right-handed: counter-clockwise seen from outside on the positive side
                    let mut ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
                    if side == 0 {
                        ring.reverse();
                    }
                    quads.push(ring.map(|[di, dj]| {
                        let mut point = [0; 3];
                        (point[axis], point[u], point[v]) = (side, i + di, j + dj);
                        *numbers.entry(point).or_insert_with(|| {
                            points.push(point);
                            points.len() as u32 - 1
                        })
                    }));
                }
            }
        }
    }
    (points, quads)
}

/// Unit directions and outward quadrilaterals of the cubed sphere with `n x n` quadrilaterals a face, divided evenly in
/// angle.
pub(crate) fn cubed_sphere(n: usize) -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
    // tan(pi/4 (2 i / n - 1)), exactly antisymmetric and exactly 1 at the ends, so that faces meet
    let tangent = |i: usize| -> f64 {
        let twice = 2 * i as i64 - n as i64;
        let value = if twice.unsigned_abs() as usize == n {
            1.0
        } else {
            (FRAC_PI_4 * twice.unsigned_abs() as f64 / n as f64).tan()
        };
        if twice < 0 { -value } else { value }
    };
    let (points, quads) = cube_surface([n; 3]);
    let direction = |point: [usize; 3]| {
        let t = point.map(tangent);
        let length = t.iter().map(|c| c * c).sum::<f64>().sqrt();
        t.map(|c| c / length)
    };
    (points.into_iter().map(direction).collect(), quads)
}
