//! The surface of a body as triangles, and exact answers to what is inside.

use nalgebra::Vector3;
use robust::{Coord3D, orient3d};
use std::collections::{BTreeMap, HashMap};
use stoss_geometry::{Aabb, BoundingVolumeTree};

/// Faces of a hexahedron, seen counter-clockwise from outside.
const FACES: [[usize; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Directions of rays, tried in turn: along an axis but for a little, so that they meet neither edges nor nodes of regular meshes.
const DIRECTIONS: [[f64; 3]; 6] = [
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

/// How a segment meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// Not at all.
    None,
    /// Through its inside: -1 from outside inwards, 1 outwards.
    Through(i32),
    /// Through an edge, a corner, or within the plane.
    Degenerate,
}

/// How the segment from `p` to `r` meets a triangle. Exact.
pub fn meeting(p: &Vector3<f64>, r: &Vector3<f64>, [a, b, c]: [&Vector3<f64>; 3]) -> Meeting {
    let (from, to) = (side(a, b, c, p), side(a, b, c, r));
    if from == to && from != 0 {
        return Meeting::None;
    }
    let around = [side(p, r, a, b), side(p, r, b, c), side(p, r, c, a)];
    if around.contains(&1) && around.contains(&-1) {
        return Meeting::None;
    }
    if from == 0 || to == 0 || around.contains(&0) {
        return Meeting::Degenerate;
    }
    Meeting::Through(to)
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

/// A closed surface of quadrilaterals, four triangles each.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Global numbers of the nodes on it.
    pub nodes: Vec<u32>,
    /// The numbers 0, 1, ... as many as there are nodes.
    places: Vec<u32>,
    /// Corners of each quadrilateral, as places in `nodes`, counter-clockwise seen from outside.
    pub quads: Vec<[u32; 4]>,
    /// The element behind each quadrilateral.
    pub elements: Vec<u32>,
    /// The elements behind the quadrilaterals, each once: its nodes, and the first of its quadrilaterals.
    pub skin: Vec<([u32; 8], u32)>,
    /// Present centres of these elements.
    pub cores: Vec<Vector3<f64>>,
    /// Edges of the triangles, as places in `points`, each once.
    pub edges: Vec<[u32; 2]>,
    /// Present positions: nodes, then centres of the quadrilaterals.
    pub points: Vec<Vector3<f64>>,
    /// Boxes of the triangles.
    pub tree: BoundingVolumeTree,
    /// Box around everything.
    pub bounds: Aabb,
}

impl Surface {
    /// The outside of hexahedra: faces that belong to one of them only.
    pub fn new(hexahedra: &[[u32; 8]]) -> Self {
        let mut seen: HashMap<[u32; 4], (u32, u32)> = HashMap::new();
        let corners = |e: usize, f: usize| FACES[f].map(|k| hexahedra[e][k]);
        for e in 0..hexahedra.len() {
            for f in 0..6 {
                let mut key = corners(e, f);
                key.sort_unstable();
                seen.entry(key).and_modify(|entry| entry.1 += 1).or_insert(((6 * e + f) as u32, 1));
            }
        }
        let mut faces: Vec<u32> = seen.into_values().filter(|&(_, count)| count == 1).map(|(face, _)| face).collect();
        faces.sort_unstable();
        let all = faces.iter().flat_map(|&face| corners(face as usize / 6, face as usize % 6));
        let mut nodes: Vec<u32> = all.collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place: BTreeMap<u32, u32> = nodes.iter().enumerate().map(|(k, &node)| (node, k as u32)).collect();
        let quads: Vec<[u32; 4]> =
            faces.iter().map(|&face| corners(face as usize / 6, face as usize % 6).map(|node| place[&node])).collect();
        let mut edges = Vec::new();
        for (q, quad) in quads.iter().enumerate() {
            for k in 0..4 {
                let (a, b) = (quad[k], quad[(k + 1) % 4]);
                edges.push([a.min(b), a.max(b)]);
                edges.push([a, (nodes.len() + q) as u32]);
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let points = vec![Vector3::zeros(); nodes.len() + quads.len()];
        let elements: Vec<u32> = faces.iter().map(|face| face / 6).collect();
        // Faces are in the order of their elements.
        let first = (0..elements.len()).filter(|&k| k == 0 || elements[k] != elements[k - 1]);
        let skin: Vec<_> = first.map(|k| (hexahedra[elements[k] as usize], k as u32)).collect();
        let mut surface = Self {
            places: (0..nodes.len() as u32).collect(),
            nodes,
            quads,
            elements,
            cores: vec![Vector3::zeros(); skin.len()],
            skin,
            edges,
            points,
            tree: BoundingVolumeTree::default(),
            bounds: Aabb::empty(),
        };
        let boxes: Vec<Aabb> = (0..surface.triangle_count()).map(|_| Aabb::from_points([&Vector3::zeros()])).collect();
        surface.tree = BoundingVolumeTree::build(&boxes);
        surface
    }

    /// Takes over positions; the first time the tree is built anew.
    pub fn place(&mut self, q: &[f64], build: bool) {
        self.points_at(q);
        let Self { nodes, quads, points, tree, bounds, .. } = self;
        let corner = |t: usize| corners_of(t, nodes.len(), quads);
        let box_of = |t: usize| Aabb::from_points(corner(t).map(|k| &points[k as usize]));
        if build {
            let boxes: Vec<Aabb> = (0..4 * quads.len()).map(box_of).collect();
            *tree = BoundingVolumeTree::build(&boxes);
        } else {
            tree.refit(box_of);
        }
        *bounds = tree.bounds();
    }

    fn points_at(&mut self, q: &[f64]) {
        let Self { nodes, quads, points, skin, cores, .. } = self;
        let at = |node: u32| Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3]);
        for (point, &node) in points.iter_mut().zip(nodes.iter()) {
            *point = at(node);
        }
        for (core, (nodes, _)) in cores.iter_mut().zip(skin.iter()) {
            *core = nodes.iter().fold(Vector3::zeros(), |sum, &node| sum + at(node)) / 8.0;
        }
        for (c, quad) in quads.iter().enumerate() {
            let sum = quad.iter().fold(Vector3::zeros(), |sum, &k| sum + points[k as usize]);
            points[nodes.len() + c] = sum / 4.0;
        }
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        4 * self.quads.len()
    }

    /// The nodes that a place in `points` belongs to: itself, or the corners of the quadrilateral whose centre it is.
    pub fn nodes_of(&self, point: u32) -> &[u32] {
        let k = point as usize;
        match k.checked_sub(self.nodes.len()) {
            None => &self.places[k..=k],
            Some(quad) => &self.quads[quad],
        }
    }

    /// Corners of a triangle as places in `points`.
    pub fn corners(&self, triangle: usize) -> [u32; 3] {
        corners_of(triangle, self.nodes.len(), &self.quads)
    }

    /// Corners of a triangle.
    pub fn triangle(&self, triangle: usize) -> [&Vector3<f64>; 3] {
        self.corners(triangle).map(|k| &self.points[k as usize])
    }

    /// Mean edge length of the quadrilateral of a triangle.
    pub fn edge_length(&self, triangle: usize) -> f64 {
        let quad = self.quads[triangle / 4];
        (0..4).map(|k| (self.points[quad[k] as usize] - self.points[quad[(k + 1) % 4] as usize]).norm()).sum::<f64>()
            / 4.0
    }

    /// Whether a point is inside: how often the surface winds about it is not zero. A point on the surface is not inside.
    pub fn contains(&self, x: &Vector3<f64>) -> bool {
        if !self.bounds.contains(x) {
            return false;
        }
        let size = (self.bounds.max - self.bounds.min).norm();
        'ray: for direction in DIRECTIONS {
            let end = x + Vector3::from(direction) * (2.0 * size);
            let mut winding = 0;
            let mut degenerate = false;
            self.tree.query(&Aabb::from_points([x, &end]), |t| match meeting(x, &end, self.triangle(t)) {
                Meeting::None => {}
                Meeting::Through(way) => winding += way,
                Meeting::Degenerate => degenerate = true,
            });
            if degenerate {
                continue 'ray;
            }
            return winding != 0;
        }
        // All rays meet an edge only if the point is on the surface.
        false
    }

    /// Distance to the surface and the nearest triangle.
    pub fn nearest(&self, x: &Vector3<f64>) -> (f64, usize) {
        let mut best = 0;
        let distance = self.tree.nearest(x, f64::INFINITY, |t, bound| {
            let distance = (x - nearest_point(x, self.triangle(t))).norm();
            if distance < bound {
                best = t;
                distance
            } else {
                bound
            }
        });
        (distance, best)
    }
}

fn corners_of(triangle: usize, nodes: usize, quads: &[[u32; 4]]) -> [u32; 3] {
    let (quad, k) = (quads[triangle / 4], triangle % 4);
    [quad[k], quad[(k + 1) % 4], (nodes + triangle / 4) as u32]
}

/// Whether a point is inside a hexahedron, its faces taken as four triangles each; not if it is on its surface.
pub fn inside_hexahedron(corners: &[Vector3<f64>; 8], x: &Vector3<f64>) -> bool {
    let bounds = Aabb::from_points(corners);
    if !bounds.contains(x) {
        return false;
    }
    let size = (bounds.max - bounds.min).norm();
    'ray: for direction in DIRECTIONS {
        let end = x + Vector3::from(direction) * (2.0 * size);
        let mut winding = 0;
        for face in FACES {
            let centre = face.iter().fold(Vector3::zeros(), |sum, &k| sum + corners[k]) / 4.0;
            for k in 0..4 {
                match meeting(x, &end, [&corners[face[k]], &corners[face[(k + 1) % 4]], &centre]) {
                    Meeting::None => {}
                    Meeting::Through(way) => winding += way,
                    Meeting::Degenerate => continue 'ray,
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
    fn a_cube_winds_about_its_inside_and_not_about_its_surface() {
        let q: Vec<f64> = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .concat()
            .into_iter()
            .map(f64::from)
            .collect();
        let mut cube = Surface::new(&[[0, 1, 2, 3, 4, 5, 6, 7]]);
        cube.place(&q, true);
        assert_eq!((cube.quads.len(), cube.nodes.len(), cube.edges.len()), (6, 8, 12 + 24));
        assert!(cube.contains(&Vector3::new(0.5, 0.5, 0.5)) && cube.contains(&Vector3::new(1e-12, 0.5, 0.25)));
        for outside in [[1.5, 0.5, 0.5], [0.0, 0.3, 0.4], [1.0, 1.0, 1.0], [0.5, 0.0, 0.5], [-1e-12, 0.5, 0.25]] {
            assert!(!cube.contains(&Vector3::from(outside)), "{outside:?}");
        }
        let (distance, triangle) = cube.nearest(&Vector3::new(0.5, 0.4, 0.8));
        assert!((distance - 0.2).abs() < 1e-15 && cube.triangle(triangle).iter().all(|x| x.z == 1.0));
        let corners: [Vector3<f64>; 8] = std::array::from_fn(|k| Vector3::from_column_slice(&q[3 * k..3 * k + 3]));
        assert!(inside_hexahedron(&corners, &Vector3::new(0.2, 0.9, 0.5)));
        assert!(!inside_hexahedron(&corners, &Vector3::new(0.2, 1.0, 0.5)));
    }
}
