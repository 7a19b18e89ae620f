//! Where the middle of an edge lies on a boundary that is curved, from the nodes of the linear mesh alone.
//!
//! Edges between facets whose normals differ by less than [`FEATURE`] belong to a smooth surface, whose normal at a node is
//! `sum a x b / (|a|^2 |b|^2)` over the facets around it with their edges `a`, `b`, which is exact on spheres (N. Max, 1999). The edge is the cubic with the chord's projections on the tangent planes as tangents; with `d = x_b - x_a` its middle is
//!
//! ```text
//! x = (x_a + x_b)/2 + ( (n_b . d) n_b - (n_a . d) n_a ) / 8
//! ```
//! (A. Vlachos et al., Curved PN triangles, 2001). At the rim of a smooth surface, where facets are on one side only, that normal is biased: there the parabola with the
//! tangent of the other end is taken, `x = (x_a + x_b)/2 + (n_b . d) n_b / 4`. Edges between facets that meet at a larger angle belong to a line, whose tangent
//! at a node is that of the circle through it and its two neighbours on the line, and are treated likewise. On circles and spheres the middle is at the right place up to fourth
//! order; plane boundaries stay plane.

use std::collections::BTreeMap;

use crate::Mesh;
use crate::vector::{Vector, cross, distance, dot, minus, unit};

/// Cosine of the angle of two facets from which on their edge is sharp, 34.4 degrees: a chamfer of 45 degrees is, a round side of twelve facets is not.
const FEATURE: f64 = 0.825;
/// Cosine of the angle from which on a surface is certainly meant to have an edge.
const CERTAIN: f64 = 0.5;

/// The boundary of a linear mesh.
pub(super) struct Curves {
    /// Corners of the facets.
    facets: Vec<Vec<u32>>,
    /// Facets of each edge of the boundary.
    edges: BTreeMap<[u32; 2], Vec<usize>>,
    /// Facets at each node.
    around: BTreeMap<u32, Vec<usize>>,
    normals: Vec<Vector>,
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
        let mut curves = Self { facets, edges, around, normals, lines: BTreeMap::new() };
        let sharp: Vec<[u32; 2]> = curves.edges.keys().copied().filter(|&edge| !curves.is_smooth(edge)).collect();
        for [a, b] in sharp {
            curves.lines.entry(a).or_default().push(b);
            curves.lines.entry(b).or_default().push(a);
        }
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

    /// The middle of the edge between two nodes of the mesh, at the places `x`.
    pub fn middle(&self, x: &[Vector], a: u32, b: u32) -> Vector {
        let (xa, xb) = (x[a as usize], x[b as usize]);
        let d = minus(xb, xa);
        let edge = [a.min(b), a.max(b)];
        // Parts of the chord that are not along the curve at the ends.
        let bent: [Option<Vector>; 2] = if self.edges.contains_key(&edge) && !self.is_smooth(edge) {
            [a, b].map(|node| {
                self.tangent(x, node, edge).map(|t| minus(d, t.map(|c| c * dot(d, d).sqrt() * dot(t, d).signum())))
            })
        } else {
            let common = |f: &&usize| self.facets[**f].contains(&a) && self.facets[**f].contains(&b);
            let Some(&facet) = self.around.get(&a).and_then(|list| list.iter().find(common)) else {
                return std::array::from_fn(|i| 0.5 * (xa[i] + xb[i]));
            };
            let [at_a, at_b] = [a, b].map(|node| self.normal(x, node, facet));
            let off = |(normal, _): (Vector, bool)| normal.map(|c| c * dot(normal, d));
            match (at_a.1, at_b.1) {
                (true, false) => [None, Some(off(at_b))],
                (false, true) => [Some(off(at_a)), None],
                _ => [Some(off(at_a)), Some(off(at_b))],
            }
        };
        let shift = |i: usize| match bent {
            [Some(a), Some(b)] => (b[i] - a[i]) / 8.0,
            [None, Some(b)] => b[i] / 4.0,
            [Some(a), None] => -a[i] / 4.0,
            [None, None] => 0.0,
        };
        std::array::from_fn(|i| 0.5 * (xa[i] + xb[i]) + shift(i))
    }

    /// Normal of the smooth surface of a facet at one of its nodes, and whether its rim is there.
    fn normal(&self, x: &[Vector], node: u32, facet: usize) -> (Vector, bool) {
        let (mut group, mut is_rim, mut next) = (vec![facet], false, 0);
        while let Some(&f) = group.get(next) {
            next += 1;
            let nodes = &self.facets[f];
            let k = nodes.iter().position(|&n| n == node).unwrap_or(0);
            for other in [nodes[(k + 1) % nodes.len()], nodes[(k + nodes.len() - 1) % nodes.len()]] {
                let edge = [node.min(other), node.max(other)];
                if self.is_smooth(edge) {
                    group.extend(
                        self.edges[&edge].iter().copied().filter(|g| *g != f && !group.contains(g)).collect::<Vec<_>>(),
                    );
                } else {
                    is_rim = true;
                }
            }
        }
        let mut sum = [0.0; 3];
        for f in group {
            let nodes = &self.facets[f];
            let k = nodes.iter().position(|&n| n == node).unwrap_or(0);
            let [before, after] =
                [k + nodes.len() - 1, k + 1].map(|k| minus(x[nodes[k % nodes.len()] as usize], x[node as usize]));
            let (normal, weight) = (cross(after, before), 1.0 / (dot(after, after) * dot(before, before)));
            sum = std::array::from_fn(|i| sum[i] + weight * normal[i]);
        }
        (unit(sum).unwrap_or(self.normals[facet]), is_rim)
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
