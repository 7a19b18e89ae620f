//! How a surface turns at its edges, and how much of that belongs to the body and how much to its mesh.

use super::Lists;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Angle of an edge, in rad, from which on it is one of the body, not of the mesh.
const SHARP: f64 = 0.5;

/// Size of the triangles and unevenness of the surface around a corner of a triangle, as far as it goes on without a sharp edge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Around {
    /// Mean area of the triangles.
    pub size: f64,
    /// Largest angle at the edges, in rad: by so much the normals of facets miss those of the smooth surface that they follow.
    pub roughness: f64,
}

impl Around {
    /// The mean at a place in a triangle, by the shares of its corners: continuous from triangle to triangle.
    fn mean(of: &[Self; 3], shares: [f64; 3]) -> Self {
        let mut mean = Self::default();
        for (around, share) in of.iter().zip(shares) {
            mean.size += around.size * share;
            mean.roughness += around.roughness * share;
        }
        mean
    }
}

/// Angles of a surface in the reference.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfaceAngles {
    /// Angle by which the surface turns at each edge: positive where it is convex, `PI` at a rim.
    angle: Vec<f64>,
    /// The triangles at each edge and their corners opposite of it; `u32::MAX` for those that a rim lacks.
    beside: Vec<[u32; 2]>,
    opposite: Vec<[u32; 2]>,
    /// Largest angle at the edges of each vertex.
    vertex_angle: Vec<f64>,
    /// Triangles around each vertex; zero at a rim.
    fan: Vec<u32>,
    triangles_at: Lists,
    around: Vec<[Around; 3]>,
    /// The sheet of each triangle: triangles that are connected across edges at which the surface goes on.
    sheet: Vec<u32>,
}

impl SurfaceAngles {
    /// The shape of triangles with corners at `positions`, and their edges in ascending order.
    pub fn new(triangles: &[[u32; 3]], edges: &[[u32; 2]], positions: &[Vector3<f64>]) -> Self {
        let n = positions.len();
        let double_area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            (b - a).cross(&(c - a))
        };
        let areas: Vec<Vector3<f64>> = triangles.iter().map(double_area).collect();
        let normal = |t: u32| areas[t as usize].try_normalize(0.0).unwrap_or_default();
        let mut shape = Self {
            angle: Vec::with_capacity(edges.len()),
            beside: vec![[u32::MAX; 2]; edges.len()],
            opposite: vec![[u32::MAX; 2]; edges.len()],
            vertex_angle: vec![0.0; n],
            fan: vec![0; n],
            ..Self::default()
        };
        let mut met = vec![0u32; edges.len()];
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for [p, q, o] in [[a, b, c], [b, c, a], [c, a, b]] {
                let Ok(e) = edges.binary_search(&[p.min(q), p.max(q)]) else { continue };
                if let Some(k) = (met[e] < 2).then_some(met[e] as usize) {
                    (shape.beside[e][k], shape.opposite[e][k]) = (t as u32, o);
                }
                met[e] += 1;
            }
        }
        triangles.iter().flatten().for_each(|&v| shape.fan[v as usize] += 1);
        for (e, edge) in edges.iter().enumerate() {
            let [s, t] = shape.beside[e];
            let angle = if met[e] == 2 {
                let [m, n] = [normal(s), normal(t)];
                let size = m.cross(&n).norm().atan2(m.dot(&n));
                let out = m.dot(&(positions[shape.opposite[e][1] as usize] - positions[edge[0] as usize]));
                if out <= 0.0 { size } else { -size }
            } else {
                edge.iter().for_each(|&v| shape.fan[v as usize] = 0);
                PI
            };
            shape.angle.push(angle);
            for &v in edge {
                let most = &mut shape.vertex_angle[v as usize];
                *most = angle.abs().max(*most);
            }
        }
        let mut corners: Vec<(u32, u32)> =
            triangles.iter().enumerate().flat_map(|(t, corners)| corners.map(|v| (v, t as u32))).collect();
        corners.sort_unstable();
        shape.triangles_at = Lists::of_pairs(n, &corners);
        shape.around = shape.look_around(triangles, edges, &areas);
        shape.sheet = shape.sheets(triangles, edges);
        shape
    }

    fn sheets(&self, triangles: &[[u32; 3]], edges: &[[u32; 2]]) -> Vec<u32> {
        let mut sheet = vec![u32::MAX; triangles.len()];
        let mut front = Vec::new();
        for first in 0..triangles.len() {
            if sheet[first] != u32::MAX {
                continue;
            }
            sheet[first] = first as u32;
            front.push(first);
            while let Some(t) = front.pop() {
                let [a, b, c] = triangles[t];
                for [p, q] in [[a, b], [b, c], [c, a]] {
                    let Ok(e) = edges.binary_search(&[p.min(q), p.max(q)]) else { continue };
                    for s in self.beside[e].into_iter().filter(|&s| s != u32::MAX && self.goes_on(e)) {
                        if sheet[s as usize] == u32::MAX {
                            sheet[s as usize] = first as u32;
                            front.push(s as usize);
                        }
                    }
                }
            }
        }
        sheet
    }

    /// The sheet of a triangle.
    pub fn sheet(&self, triangle: u32) -> u32 {
        self.sheet[triangle as usize]
    }

    /// What is around the corners of the triangles.
    fn look_around(&self, triangles: &[[u32; 3]], edges: &[[u32; 2]], areas: &[Vector3<f64>]) -> Vec<[Around; 3]> {
        let mut all = vec![[Around::default(); 3]; triangles.len()];
        let mut part: Vec<u32> = Vec::new();
        for v in 0..self.fan.len() as u32 {
            let here = self.triangles_at.of(v);
            let mut left: Vec<u32> = here.to_vec();
            // The triangles around a vertex fall into parts that go on across even edges.
            while let Some(first) = left.pop() {
                part.clear();
                part.push(first);
                let (mut next, mut roughness) = (0, 0.0_f64);
                while let Some(&t) = part.get(next) {
                    next += 1;
                    for q in triangles[t as usize].into_iter().filter(|&q| q != v) {
                        let Ok(e) = edges.binary_search(&[v.min(q), v.max(q)]) else { continue };
                        if self.angle[e].abs() > SHARP {
                            continue;
                        }
                        roughness = roughness.max(self.angle[e].abs());
                        for s in self.beside[e] {
                            if let Some(k) = left.iter().position(|&l| l == s) {
                                part.push(left.swap_remove(k));
                            }
                        }
                    }
                }
                let size = part.iter().map(|&t| 0.5 * areas[t as usize].norm()).sum::<f64>() / part.len() as f64;
                for &t in &part {
                    let corner = triangles[t as usize].iter().position(|&q| q == v).unwrap_or_default();
                    all[t as usize][corner] = Around { size, roughness };
                }
            }
        }
        all
    }

    /// What is around a place in a triangle.
    pub fn around(&self, triangle: u32, shares: [f64; 3]) -> Around {
        Around::mean(&self.around[triangle as usize], shares)
    }

    /// Whether an edge is one of the body.
    pub fn is_sharp_edge(&self, edge: usize) -> bool {
        self.angle[edge].abs() > SHARP
    }

    /// Whether the surface goes on at an edge: it does not turn inward by much.
    pub fn goes_on(&self, edge: usize) -> bool {
        self.angle[edge] > -SHARP
    }

    /// The corners opposite of an edge.
    pub fn opposite(&self, edge: usize) -> [u32; 2] {
        self.opposite[edge]
    }

    /// The triangles at an edge.
    pub fn beside(&self, edge: usize) -> [u32; 2] {
        self.beside[edge]
    }

    /// Largest angle at a vertex.
    pub fn vertex_angle(&self, vertex: u32) -> f64 {
        self.vertex_angle[vertex as usize]
    }

    /// Whether a vertex is a corner, or on an edge, of the body.
    pub fn is_sharp(&self, vertex: u32) -> bool {
        self.vertex_angle[vertex as usize] > SHARP
    }

    /// Number of triangles around a vertex; zero at a rim.
    pub fn fan(&self, vertex: u32) -> u32 {
        self.fan[vertex as usize]
    }

    /// The triangles around a vertex.
    pub fn triangles_at(&self, vertex: u32) -> &[u32] {
        self.triangles_at.of(vertex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A roof of two slopes: the ridge turns by twice its slope, the rims are sharp, and what is around a corner is the same for both sides of an even ridge.
    #[test]
    fn angles_of_a_roof() {
        for (height, sharp) in [(0.1, false), (2.0, true), (-0.1, false)] {
            let x = [[0.0, 0.0, height], [0.0, 1.0, height], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]].map(Vector3::from);
            let triangles = [[0, 2, 1], [0, 1, 3]];
            let edges = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3]];
            let shape = SurfaceAngles::new(&triangles, &edges, &x);
            let angle = 2.0 * f64::atan(height);
            assert!((shape.angle[0] - angle).abs() < 1e-15);
            assert!(shape.is_sharp_edge(0) == sharp && shape.is_sharp_edge(1) && shape.goes_on(0));
            assert_eq!((shape.beside(0), shape.opposite(0), shape.opposite(1)), ([0, 1], [2, 3], [1, u32::MAX]));
            assert_eq!([shape.fan(0), shape.fan(3)], [0, 0]);
            let around = shape.around(0, [0.5, 0.0, 0.5]);
            assert!((around.roughness - if sharp { 0.0 } else { angle.abs() }).abs() < 1e-15);
            assert!((around.size - 0.5 * (1.0 + height * height).sqrt()).abs() < 1e-15);
            assert_eq!(shape.triangles_at(1), [0, 1]);
            assert_eq!([shape.sheet(0), shape.sheet(1)], [0, 0]);
        }
    }
}
