//! Exact answers to where points and segments are relative to triangles and elements.

use nalgebra::Vector3;
use robust::{Coord, Coord3D, orient2d, orient3d};
use stoss_geometry::Aabb;
use stoss_reference_element::CellKind;

/// Directions of rays, tried in turn: along an axis but for a little, so that they meet neither edges nor nodes of regular meshes.
pub const DIRECTIONS: [[f64; 3]; 6] = [
    [1.0, 0.012_345_678_9, 0.007_654_321_1],
    [-0.009_182_736_4, 1.0, 0.013_579_246_8],
    [0.011_223_344_5, -0.008_877_665_4, 1.0],
    [-1.0, 0.021_436_587_0, -0.017_263_549_8],
    [0.019_283_746_5, -1.0, -0.023_456_789_1],
    [0.271_828_182_8, 0.314_159_265_4, 0.577_215_664_9],
];

/// Which side of the plane through `a`, `b`, `c` a point is on: 1 outside (counter-clockwise seen from there), -1 inside, 0 on it. Exact.
fn side(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, p: &Vector3<f64>) -> i32 {
    let coord = |v: &Vector3<f64>| Coord3D { x: v.x, y: v.y, z: v.z };
    let value = orient3d(coord(a), coord(b), coord(c), coord(p));
    // `robust` gives a positive number where the point sees the triangle clockwise.
    if value < 0.0 {
        1
    } else if value > 0.0 {
        -1
    } else {
        0
    }
}

/// Whether a point is on a triangle, its edges and corners included. Exact.
pub fn is_on(x: &Vector3<f64>, [a, b, c]: [&Vector3<f64>; 3]) -> bool {
    if side(a, b, c, x) != 0 {
        return false;
    }
    // In the plane: without the coordinate along which the triangle is seen largest.
    let axis = (b - a).cross(&(c - a)).iamax();
    let flat = |p: &Vector3<f64>| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    let turns = [[a, b], [b, c], [c, a]].map(|[p, q]| orient2d(flat(p), flat(q), flat(x)));
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}

/// How a segment intersects a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intersection {
    /// No intersection.
    None,
    /// Through its inside: -1 from outside inwards, 1 outwards.
    Through(i32),
    /// Through an edge, a corner, or within the plane.
    Degenerate,
}

/// How the segment from `p` to `r` intersects a triangle. Exact.
pub fn intersect(p: &Vector3<f64>, r: &Vector3<f64>, [a, b, c]: [&Vector3<f64>; 3]) -> Intersection {
    let (from, to) = (side(a, b, c, p), side(a, b, c, r));
    if from == to && from != 0 {
        return Intersection::None;
    }
    let around = [side(p, r, a, b), side(p, r, b, c), side(p, r, c, a)];
    if around.contains(&1) && around.contains(&-1) {
        return Intersection::None;
    }
    if from == 0 || to == 0 || around.contains(&0) {
        return Intersection::Degenerate;
    }
    Intersection::Through(to)
}

/// The point of a triangle nearest to `x`.
pub fn nearest_point(x: &Vector3<f64>, [a, b, c]: [&Vector3<f64>; 3]) -> Vector3<f64> {
    let on_segment = |u: &Vector3<f64>, v: &Vector3<f64>| {
        let d = v - u;
        let square = d.norm_squared();
        let t = if square > 0.0 { ((x - u).dot(&d) / square).clamp(0.0, 1.0) } else { 0.0 };
        u + d * t
    };
    let normal = (b - a).cross(&(c - a));
    let square = normal.norm_squared();
    let beside = |u: &Vector3<f64>, v: &Vector3<f64>| (v - u).cross(&(x - u)).dot(&normal) >= 0.0;
    if square > 0.0 && beside(a, b) && beside(b, c) && beside(c, a) {
        return x - normal * ((x - a).dot(&normal) / square);
    }
    let all = [on_segment(a, b), on_segment(b, c), on_segment(c, a)];
    let nearer = |u: Vector3<f64>, v: Vector3<f64>| if (x - v).norm() < (x - u).norm() { v } else { u };
    nearer(nearer(all[0], all[1]), all[2])
}

/// Whether a point is inside an element: linear pieces of its faces, of quadrilaterals four triangles about their centres; not if it is on its surface.
pub fn inside_element(kind: CellKind, nodes: &[Vector3<f64>], x: &Vector3<f64>) -> bool {
    let bounds = Aabb::from_points(nodes);
    if !bounds.contains(x) {
        return false;
    }
    let size = (bounds.max - bounds.min).norm();
    'ray: for direction in DIRECTIONS {
        let end = x + Vector3::from(direction) * (2.0 * size);
        let mut winding = 0;
        for face in kind.faces() {
            for piece in face.kind.pieces() {
                let corner = |k: usize| &nodes[usize::from(face.nodes[usize::from(piece[k % piece.len()])])];
                let centre = (0..piece.len()).fold(Vector3::zeros(), |sum, k| sum + corner(k)) / piece.len() as f64;
                let about_centre = |k: usize| [corner(k), corner(k + 1), &centre];
                let (first, rest) =
                    if piece.len() == 3 { ([corner(0), corner(1), corner(2)], 1) } else { (about_centre(0), 4) };
                for k in 0..rest {
                    let triangle = if k == 0 { first } else { about_centre(k) };
                    match intersect(x, &end, triangle) {
                        Intersection::None => {}
                        Intersection::Through(way) => winding += way,
                        Intersection::Degenerate => continue 'ray,
                    }
                }
            }
        }
        return winding != 0;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sign_of_a_side_is_that_of_the_outward_normal() {
        let [a, b, c] = [Vector3::zeros(), Vector3::x(), Vector3::y()];
        assert_eq!([1.0, -1.0, 0.0].map(|z| side(&a, &b, &c, &Vector3::new(0.1, 0.1, z))), [1, -1, 0]);
    }

    #[test]
    fn points_on_a_triangle_are_found_exactly() {
        let [a, b, c] = [Vector3::new(0.0, 0.0, 1.0), Vector3::new(2.0, 0.0, 1.5), Vector3::new(0.0, 2.0, 1.0)];
        let at = |u: f64, v: f64| a + (b - a) * u + (c - a) * v;
        for [u, v] in [[0.25, 0.25], [0.0, 0.0], [0.5, 0.5], [0.0, 0.75], [1.0, 0.0]] {
            assert!(is_on(&at(u, v), [&a, &b, &c]) && is_on(&at(u, v), [&a, &c, &b]), "{u} {v}");
            assert!(!is_on(&(at(u, v) + Vector3::z() * 1e-15), [&a, &b, &c]));
        }
        for [u, v] in [[-0.25, 0.25], [0.75, 0.5], [1.5, 0.0]] {
            assert!(!is_on(&at(u, v), [&a, &b, &c]), "{u} {v}");
        }
    }

    #[test]
    fn a_cube_has_its_inside_without_its_surface() {
        let corners: [Vector3<f64>; 8] =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
                .map(|x| Vector3::from(x.map(f64::from)));
        assert!(inside_element(CellKind::Hex8, &corners, &Vector3::new(0.2, 0.9, 0.5)));
        assert!(!inside_element(CellKind::Hex8, &corners, &Vector3::new(0.2, 1.0, 0.5)));
    }
}
