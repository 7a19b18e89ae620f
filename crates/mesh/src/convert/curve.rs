//! Where the middle of an edge lies on a boundary that is curved, from the nodes of the linear mesh alone.
//!
//! Edges between facets whose normals differ by less than [`FEATURE`] belong to a smooth surface, whose normal at a node is
//! `sum a x b / (|a|^2 |b|^2)` over the facets around it with their edges `a`, `b`, which is exact on spheres (N. Max, 1999). With `d = x_b - x_a` and `H = |n_a + n_b|/2`,
//! the cosine of half the angle between the normals, the middle of an edge is
//!
//! ```text
//! x = (x_a + x_b)/2 + d . (n_b - n_a) / (4 (1 + H)) (n_a + n_b) / |n_a + n_b|
//! ```
//!
//! which is exact for chords of spheres and of circular cylinders in any direction: the part of the chord in the plane of both normals is `d . (n_b - n_a) / (2 sin(t/2))`, `t`
//! their angle, and the arc's height over it that part times `tan(t/4)/2`. Elsewhere it is the cubic of A. Vlachos et al. (Curved PN triangles, 2001) up to fourth order.
//!
//! At the rim of a smooth surface, where facets are on one side only, the sum above is biased. There the normal is the nearest one to it for which `(n_a + n_b) . d = 0` along the
//! edges to nodes whose normals are known, a relation that every chord of a sphere and of a cylinder satisfies, and every other surface to third order; nodes without such a neighbour
//! follow in the next round.
//!
//! Edges between facets that meet at a larger angle belong to a line, whose tangent at a node is that of the circle through it and its two neighbours on the line. With tangents
//! `t_a`, `t_b` the middle is `(x_a + x_b)/2 + |d| (t_a - t_b) / (4 (1 + |t_a + t_b|/2))`, exact on circles; where the line ends the tangent is the mirror image of that at the other end.
//! Plane boundaries stay plane.

use std::collections::BTreeMap;

use crate::Mesh;
use crate::vector::{Vector, cross, distance, dot, minus, norm, unit};

/// Cosine of the angle of two facets from which on their edge is sharp, 34.4 degrees: a chamfer of 45 degrees is, a round side of twelve facets is not.
const FEATURE: f64 = 0.825;
/// Cosine of the angle from which on a surface is certainly meant to have an edge.
const CERTAIN: f64 = 0.5;

/// Part of the larger eigenvalue below which the smaller one says nothing: edges that all have nearly one direction.
const ONE_DIRECTION: f64 = 0.05;

/// Facets around a node that belong to one smooth surface.
struct Corner {
    node: u32,
    facets: Vec<usize>,
    normal: Vector,
    /// Whether the normal is known: all around the node, or in agreement with neighbours.
    known: bool,
    /// Other ends of the edges of the surface's rim.
    rim: Vec<u32>,
}

/// The boundary of a linear mesh.
pub(super) struct Curves {
    /// Corners of the facets.
    facets: Vec<Vec<u32>>,
    /// Facets of each edge of the boundary.
    edges: BTreeMap<[u32; 2], Vec<usize>>,
    /// Facets at each node.
    around: BTreeMap<u32, Vec<usize>>,
    normals: Vec<Vector>,
    corners: Vec<Corner>,
    /// Number of the corner of each facet at each of its nodes.
    corner_of: Vec<Vec<usize>>,
    /// Neighbours of a node along edges that are not smooth.
    lines: BTreeMap<u32, Vec<u32>>,
}

impl Curves {
    pub fn new(mesh: &Mesh) -> Self {
        let facets: Vec<Vec<u32>> = mesh.boundary_facets().iter().map(|f| f.nodes.corners().to_vec()).collect();
        let x = |n: u32| mesh.nodes[n as usize];
        let (mut edges, mut around) = (BTreeMap::<_, Vec<usize>>::new(), BTreeMap::<_, Vec<usize>>::new());
        let mut normals = Vec::with_capacity(facets.len());
        for (f, nodes) in facets.iter().enumerate() {
            for (k, &a) in nodes.iter().enumerate() {
                let b = nodes[(k + 1) % nodes.len()];
                edges.entry([a.min(b), a.max(b)]).or_default().push(f);
                around.entry(a).or_default().push(f);
            }
            // Twice the area of a polygon that may be warped: the diagonals of a quadrilateral.
            let last = nodes.len() - 1;
            let normal = cross(minus(x(nodes[2]), x(nodes[0])), minus(x(nodes[last]), x(nodes[1])));
            let of_triangle = cross(minus(x(nodes[1]), x(nodes[0])), minus(x(nodes[2]), x(nodes[0])));
            normals.push(unit(if last == 3 { normal } else { of_triangle }).unwrap_or_default());
        }
        let (corners, corner_of) = (Vec::new(), facets.iter().map(|nodes| vec![usize::MAX; nodes.len()]).collect());
        let mut curves = Self { facets, edges, around, normals, corners, corner_of, lines: BTreeMap::new() };
        let sharp: Vec<[u32; 2]> = curves.edges.keys().copied().filter(|&edge| !curves.is_smooth(edge)).collect();
        for [a, b] in sharp {
            curves.lines.entry(a).or_default().push(b);
            curves.lines.entry(b).or_default().push(a);
        }
        curves.find_corners(&mesh.nodes);
        curves.settle_rims(&mesh.nodes);
        curves
    }

    /// Whether an edge of the boundary has two facets that meet smoothly.
    fn is_smooth(&self, edge: [u32; 2]) -> bool {
        match self.edges[&edge][..] {
            [f, g] => dot(self.normals[f], self.normals[g]) > FEATURE,
            _ => false,
        }
    }

    /// Number of edges that are sharp, and may be those of a coarse mesh of a smooth surface.
    pub fn perhaps_smooth_edges(&self) -> usize {
        let is_perhaps_smooth = |facets: &&Vec<usize>| match facets[..] {
            [f, g] => (CERTAIN..=FEATURE).contains(&dot(self.normals[f], self.normals[g])),
            _ => false,
        };
        self.edges.values().filter(is_perhaps_smooth).count()
    }

    /// The middle of the edge between two nodes of the mesh, at the places `x` of its nodes.
    pub fn middle(&self, x: &[Vector], a: u32, b: u32) -> Vector {
        let (xa, xb) = (x[a as usize], x[b as usize]);
        let d = minus(xb, xa);
        let edge = [a.min(b), a.max(b)];
        let shift = if self.edges.contains_key(&edge) && !self.is_smooth(edge) {
            let along = [a, b].map(|node| {
                self.tangent(x, node, edge).map(|t| t.map(|c| c * dot(t, d).signum())).filter(|t| dot(*t, d) > 0.0)
            });
            self.off_line(d, along)
        } else {
            let at = |f: usize, node: u32| self.facets[f].iter().position(|&n| n == node);
            let corners = self.around.get(&a).and_then(|list| {
                list.iter().find_map(|&f| {
                    Some([a, b].map(|n| at(f, n).map(|k| self.corner_of[f][k]))).filter(|c| c[1].is_some())
                })
            });
            match corners {
                Some([Some(at_a), Some(at_b)]) => off_surface(d, self.corners[at_a].normal, self.corners[at_b].normal),
                _ => [0.0; 3],
            }
        };
        std::array::from_fn(|i| 0.5 * (xa[i] + xb[i]) + shift[i])
    }

    /// The way from the middle of a chord `d` to that of the arc with these unit tangents at its ends.
    fn off_line(&self, d: Vector, along: [Option<Vector>; 2]) -> Vector {
        let mirrored = |t: Vector| {
            let twice = 2.0 * dot(t, d) / dot(d, d);
            std::array::from_fn(|i| twice * d[i] - t[i])
        };
        let [ta, tb] = match along {
            [Some(a), Some(b)] => [a, b],
            [Some(a), None] => [a, mirrored(a)],
            [None, Some(b)] => [mirrored(b), b],
            [None, None] => return [0.0; 3],
        };
        let half_cosine = 0.5 * norm(std::array::from_fn(|i| ta[i] + tb[i]));
        minus(ta, tb).map(|c| c * norm(d) / (4.0 * (1.0 + half_cosine)))
    }

    /// The facets around each node, divided at sharp edges, with the normals from all of them.
    fn find_corners(&mut self, x: &[Vector]) {
        for (&node, around) in &self.around {
            for &first in around {
                let place = |f: usize| self.facets[f].iter().position(|&n| n == node).unwrap_or(0);
                if self.corner_of[first][place(first)] != usize::MAX {
                    continue;
                }
                let (mut group, mut rim, mut next) = (vec![first], Vec::new(), 0);
                let mut sum = [0.0; 3];
                while let Some(&f) = group.get(next) {
                    next += 1;
                    let (nodes, k) = (&self.facets[f], place(f));
                    self.corner_of[f][k] = self.corners.len();
                    let others = [nodes[(k + 1) % nodes.len()], nodes[(k + nodes.len() - 1) % nodes.len()]];
                    for other in others {
                        let edge = [node.min(other), node.max(other)];
                        if self.is_smooth(edge) {
                            let more = self.edges[&edge].iter().copied().find(|g| *g != f && !group.contains(g));
                            group.extend(more);
                        } else {
                            rim.push(other);
                        }
                    }
                    let [after, before] = others.map(|other| minus(x[other as usize], x[node as usize]));
                    let (normal, weight) = (cross(after, before), 1.0 / (dot(after, after) * dot(before, before)));
                    sum = std::array::from_fn(|i| sum[i] + weight * normal[i]);
                }
                let normal = unit(sum).unwrap_or(self.normals[first]);
                self.corners.push(Corner { node, facets: group, normal, known: rim.is_empty(), rim });
            }
        }
    }

    /// The normals at rims, from their neighbours inwards; then those in the middle of a rim of surfaces that are one facet wide, and what follows from them.
    fn settle_rims(&mut self, x: &[Vector]) {
        loop {
            let found: Vec<(usize, Vector)> = (0..self.corners.len())
                .filter(|&c| !self.corners[c].known)
                .filter_map(|c| self.normal_by_neighbours(x, c).map(|normal| (c, normal)))
                .collect();
            for &(c, normal) in &found {
                (self.corners[c].normal, self.corners[c].known) = (normal, true);
            }
            if found.is_empty() {
                break;
            }
        }
        let mut any = false;
        for corner in self.corners.iter_mut().filter(|corner| !corner.known) {
            if let [p, q] = corner.rim[..] {
                let [p, q] = [p, q].map(|n| minus(x[n as usize], x[corner.node as usize]));
                corner.known = dot(p, q) < -FEATURE * norm(p) * norm(q);
                any |= corner.known;
            }
        }
        if any {
            self.settle_rims(x);
        }
    }

    /// The normal nearest to that of a corner for which `(n_a + n_b) . d = 0` to all neighbours whose normals are known, in the sense of least squares.
    fn normal_by_neighbours(&self, x: &[Vector], corner: usize) -> Option<Vector> {
        let Corner { node, facets, normal: start, .. } = &self.corners[corner];
        let mut chords: Vec<(Vector, f64)> = Vec::new();
        for &f in facets {
            let nodes = &self.facets[f];
            let k = nodes.iter().position(|n| n == node)?;
            for other in [(k + 1) % nodes.len(), (k + nodes.len() - 1) % nodes.len()] {
                let neighbour = &self.corners[self.corner_of[f][other]];
                if let (true, Some(d)) = (neighbour.known, unit(minus(x[nodes[other] as usize], x[*node as usize]))) {
                    chords.push((d, dot(d, neighbour.normal)));
                }
            }
        }
        if chords.is_empty() {
            return None;
        }
        // Two axes across the normal; few steps of Newton's method, since a normal has the length one.
        let mut normal = *start;
        for _ in 0..6 {
            let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
            let p = unit(cross(normal, std::array::from_fn(|i| if i == least { 1.0 } else { 0.0 })))?;
            let q = cross(normal, p);
            let (mut m, mut r) = ([0.0; 3], [0.0; 2]);
            for (d, other) in &chords {
                let (a, b, off) = (dot(p, *d), dot(q, *d), dot(normal, *d) + other);
                m = [m[0] + a * a, m[1] + a * b, m[2] + b * b];
                r = [r[0] - a * off, r[1] - b * off];
            }
            // Eigenvalues and vectors of a symmetric matrix of two rows.
            let (mean, angle) = (0.5 * (m[0] + m[2]), 0.5 * (2.0 * m[1]).atan2(m[0] - m[2]));
            let radius = (0.25 * (m[0] - m[2]).powi(2) + m[1] * m[1]).sqrt();
            let mut step = [0.0; 2];
            for (value, [c, s]) in
                [(mean + radius, [angle.cos(), angle.sin()]), (mean - radius, [-angle.sin(), angle.cos()])]
            {
                if value > ONE_DIRECTION * (mean + radius) {
                    let along = (c * r[0] + s * r[1]) / value;
                    step = [step[0] + along * c, step[1] + along * s];
                }
            }
            normal = unit(std::array::from_fn(|i| normal[i] + step[0] * p[i] + step[1] * q[i]))?;
        }
        Some(if dot(normal, *start) > FEATURE { normal } else { *start })
    }

    /// Unit tangent at a node of the line that an edge belongs to, in either sense; none where the line ends or has a corner.
    fn tangent(&self, x: &[Vector], node: u32, edge: [u32; 2]) -> Option<Vector> {
        let [p, q] = self.lines.get(&node)?[..] else { return None };
        let other = if edge.contains(&p) { q } else { p };
        let end = if edge.contains(&p) { p } else { q };
        let at = x[node as usize];
        let (along, back) = (minus(x[end as usize], at), minus(at, x[other as usize]));
        let (l, m) = (distance(x[end as usize], at), distance(at, x[other as usize]));
        if dot(along, back) <= FEATURE * l * m {
            return None;
        }
        unit(std::array::from_fn(|i| along[i] / (l * l) + back[i] / (m * m)))
    }
}

/// The way from the middle of a chord `d` to the surface with these unit normals at its ends.
fn off_surface(d: Vector, na: Vector, nb: Vector) -> Vector {
    let sum: Vector = std::array::from_fn(|i| na[i] + nb[i]);
    let half_cosine = 0.5 * norm(sum);
    match unit(sum) {
        Some(mean) => mean.map(|c| c * dot(d, minus(nb, na)) / (4.0 * (1.0 + half_cosine))),
        None => [0.0; 3],
    }
}
