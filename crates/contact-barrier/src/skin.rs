//! The surfaces of all bodies as one set of vertices, edges, triangles and points of integration.

mod shape;

use crate::EdgeMollifier;
use nalgebra::Vector3;
use shape::{Around, SurfaceAngles};
use std::collections::BTreeSet;
use stoss_contact::position;
use stoss_reference_element::FacetNodes;

/// Weight of the vertices and edges against that of the surface, which keeps out what points of integration do not see: corners, and edges that cross.
pub(crate) const GUARD: f64 = 0.01;

/// Ratio of two areas from which on the larger one no longer counts as it is: what it meets then has no more of it than this many of its own.
const UNEVEN: f64 = 3.0;

/// Ratio of angles from which on the rougher of two surfaces has all of the points: it begins to have more of them where its angles are [`FLAT`] larger, and
/// has all of them from `ROUGHER` times those of the other and twice [`FLAT`] on.
const ROUGHER: f64 = 2.0;

/// Angles, in rad, below which surfaces are flat.
const FLAT: f64 = 0.025;

/// Barycentric coordinate of a point of integration at the two corners that it is far from: near the corners, so that a base acts up to its rim. The quadrature is exact for linear fields whatever it is (1/6: for quadratic ones).
const CORNER: f64 = 0.02;

/// Barycentric coordinates of the three points of integration of a triangle: [`CORNER`] is their choice.
const GAUSS: [[f64; 3]; 3] = {
    let near = 1.0 - 2.0 * CORNER;
    [[near, CORNER, CORNER], [CORNER, near, CORNER], [CORNER, CORNER, near]]
};

/// A facet of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinFacet {
    /// Global nodes, outward.
    pub nodes: FacetNodes,
    /// Class of the facet, which [`Interactions`](crate::Interactions) asks for.
    pub class: u32,
}

/// What general contact sees of the bodies: points that are linear in the nodes, and the primitives that they span.
///
/// A quadrilateral is four triangles about the mean of its corners. Vertices come first, points of integration behind them: three in each triangle, with a third of its reference area each.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    starts: Vec<u32>,
    terms: Vec<(u32, f64)>,
    vertex_count: usize,
    /// Nodes of the first vertices, ascending; the centres of quadrilaterals come behind them.
    nodes: Vec<u32>,
    /// Facet by which a point is found: that of a point of integration, one of those around a vertex.
    point_facet: Vec<u32>,
    /// Reference area that belongs to a point.
    point_area: Vec<f64>,
    facets: Vec<SkinFacet>,
    /// Nodes on which the points of each facet depend, ascending; `facet_starts` has where each begins.
    facet_starts: Vec<u32>,
    facet_nodes: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    triangle_facet: Vec<u32>,
    edges: Vec<[u32; 2]>,
    edge_facet: Vec<u32>,
    /// Triangles, vertices and edges of each facet.
    triangles_of: Lists,
    vertices_of: Lists,
    edges_of: Lists,
    edge_area: Vec<f64>,
    edge_square: Vec<f64>,
    shape: SurfaceAngles,
}

impl Skin {
    /// The skin of facets with nodes at `reference` (`3 * nodes`, lengths). `place(node)` gives the nodes and weights (of sum one) that a vertex is made of where it does not lie in its node.
    ///
    /// The order of facets decides the order of sums, nothing else.
    pub fn new(facets: Vec<SkinFacet>, reference: &[f64], place: &dyn Fn(u32) -> Option<Vec<(u32, f64)>>) -> Self {
        let mut nodes: Vec<u32> = facets.iter().flat_map(|f| f.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        // cannot fail: these are the nodes of the facets.
        let vertex_of = |node: u32| nodes.binary_search(&node).unwrap_or_default() as u32;
        let mut skin = Self { starts: vec![0], ..Self::default() };
        // Positions of the true surface, for areas and lengths.
        let mut positions: Vec<Vector3<f64>> = Vec::with_capacity(nodes.len() + facets.len());
        for &node in &nodes {
            skin.push(&place(node).unwrap_or_else(|| vec![(node, 1.0)]));
            positions.push(position(reference, node));
        }
        for (f, facet) in facets.iter().enumerate() {
            let corners: Vec<u32> = facet.nodes.iter().map(|&node| vertex_of(node)).collect();
            if let [a, b, c] = corners[..] {
                skin.triangles.push([a, b, c]);
                skin.triangle_facet.push(f as u32);
                continue;
            }
            let share = 1.0 / corners.len() as f64;
            let centre = skin.push(&skin.mean(corners.iter().map(|&corner| (corner, share))));
            positions.push(corners.iter().map(|&corner| positions[corner as usize] * share).sum());
            for k in 0..corners.len() {
                skin.triangles.push([corners[k], corners[(k + 1) % corners.len()], centre]);
                skin.triangle_facet.push(f as u32);
            }
        }
        skin.vertex_count = positions.len();
        skin.nodes = nodes;
        skin.edges = edges_of(&skin.triangles);
        skin.facets = facets;
        skin.shape = SurfaceAngles::new(&skin.triangles, &skin.edges, &positions);
        skin.measure(&positions);
        skin.collect_nodes();
        let count = skin.facets.len();
        skin.triangles_of = Lists::new(count, &skin.triangle_facet);
        skin.vertices_of = Lists::new(count, &skin.point_facet[..skin.vertex_count]);
        skin.edges_of = Lists::new(count, &skin.edge_facet);
        skin
    }

    fn push(&mut self, terms: &[(u32, f64)]) -> u32 {
        self.terms.extend_from_slice(terms);
        self.starts.push(self.terms.len() as u32);
        self.starts.len() as u32 - 2
    }

    /// Terms of a weighted mean of points, by node.
    fn mean(&self, of: impl Iterator<Item = (u32, f64)>) -> Vec<(u32, f64)> {
        let mut terms: Vec<(u32, f64)> =
            of.flat_map(|(point, share)| self.terms(point).iter().map(move |&(node, w)| (node, w * share))).collect();
        terms.sort_by_key(|term| term.0);
        terms.dedup_by(|later, first| {
            let same = later.0 == first.0;
            if same {
                first.1 += later.1;
            }
            same
        });
        terms
    }

    /// Areas and lengths, points of integration.
    fn measure(&mut self, positions: &[Vector3<f64>]) {
        self.point_area = vec![0.0; self.vertex_count];
        self.point_facet = vec![u32::MAX; self.vertex_count];
        self.edge_area = vec![0.0; self.edges.len()];
        self.edge_facet = vec![u32::MAX; self.edges.len()];
        for (t, &[a, b, c]) in self.triangles.clone().iter().enumerate() {
            let [xa, xb, xc] = [a, b, c].map(|v| positions[v as usize]);
            let third = (xb - xa).cross(&(xc - xa)).norm() / 6.0;
            let facet = self.triangle_facet[t];
            for v in [a, b, c] {
                self.point_area[v as usize] += third;
                let home = &mut self.point_facet[v as usize];
                *home = facet.min(*home);
            }
            for [p, q] in [[a, b], [b, c], [c, a]] {
                let Ok(e) = self.edges.binary_search(&[p.min(q), p.max(q)]) else { continue };
                self.edge_area[e] += third;
                self.edge_facet[e] = facet.min(self.edge_facet[e]);
            }
        }
        self.edge_square =
            self.edges.iter().map(|e| (positions[e[1] as usize] - positions[e[0] as usize]).norm_squared()).collect();
        for t in 0..self.triangles.len() {
            let corners = self.triangles[t];
            let [xa, xb, xc] = corners.map(|v| positions[v as usize]);
            let third = (xb - xa).cross(&(xc - xa)).norm() / 6.0;
            for shares in GAUSS {
                let terms = self.mean(corners.into_iter().zip(shares));
                self.push(&terms);
                self.point_area.push(third);
                self.point_facet.push(self.triangle_facet[t]);
            }
        }
    }

    fn collect_nodes(&mut self) {
        let mut of_facet: Vec<Vec<u32>> = vec![Vec::new(); self.facets.len()];
        for (triangle, &facet) in self.triangles.iter().zip(&self.triangle_facet) {
            for &v in triangle {
                of_facet[facet as usize].extend(self.terms(v).iter().map(|term| term.0));
            }
        }
        self.facet_starts.push(0);
        for mut nodes in of_facet {
            nodes.sort_unstable();
            nodes.dedup();
            self.facet_nodes.extend(nodes);
            self.facet_starts.push(self.facet_nodes.len() as u32);
        }
    }

    /// Number of vertices, the centres of quadrilaterals among them; they come first among the points.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Nodes of the facets, ascending: node `k` belongs to vertex `k`.
    pub fn surface_nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Whether vertices lie elsewhere than in their nodes.
    pub(crate) fn is_inset(&self) -> bool {
        self.nodes.iter().enumerate().any(|(k, &node)| self.terms(k as u32) != [(node, 1.0)])
    }

    /// Hands out the places among [`Self::surface_nodes`] at which a point lies in the undeformed surface, with their shares, of sum one: other than [`Self::terms`] they know nothing of vertices below the surface.
    pub fn shares(&self, point: u32, share: f64, visit: &mut dyn FnMut(usize, f64)) {
        if (point as usize) < self.nodes.len() {
            visit(point as usize, share);
        } else if (point as usize) < self.vertex_count {
            let nodes = &self.facets[self.point_facet[point as usize] as usize].nodes;
            for node in nodes.iter() {
                // cannot fail: these are the nodes of the facets.
                visit(self.nodes.binary_search(node).unwrap_or_default(), share / nodes.len() as f64);
            }
        } else {
            let inner = point as usize - self.vertex_count;
            let corners = self.triangles[inner / GAUSS.len()];
            for (corner, part) in corners.into_iter().zip(GAUSS[inner % GAUSS.len()]) {
                self.shares(corner, share * part, visit);
            }
        }
    }

    /// Number of points: vertices and points of integration.
    pub fn point_count(&self) -> usize {
        self.point_facet.len()
    }

    /// Mean length of the edges of the triangles in the reference.
    pub(crate) fn mean_edge(&self) -> f64 {
        self.edge_square.iter().map(|square| square.sqrt()).sum::<f64>() / self.edge_square.len().max(1) as f64
    }

    /// Nodes and weights of a point.
    pub fn terms(&self, point: u32) -> &[(u32, f64)] {
        &self.terms[self.starts[point as usize] as usize..self.starts[point as usize + 1] as usize]
    }

    /// A point of a vector of all nodes: its position if `q` are positions.
    pub fn at(&self, point: u32, q: &[f64]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for &(node, weight) in self.terms(point) {
            sum += position(q, node) * weight;
        }
        sum
    }

    /// All points of a vector of all nodes.
    pub(crate) fn place(&self, q: &[f64], points: &mut Vec<Vector3<f64>>) {
        points.clear();
        points.extend((0..self.point_count() as u32).map(|p| self.at(p, q)));
    }

    /// The facets.
    pub fn facets(&self) -> &[SkinFacet] {
        &self.facets
    }

    /// Nodes on which the points of a facet depend, ascending.
    pub fn nodes_of(&self, facet: u32) -> &[u32] {
        &self.facet_nodes[self.facet_starts[facet as usize] as usize..self.facet_starts[facet as usize + 1] as usize]
    }

    /// The triangles, as points.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// All edges of the triangles, as points.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The triangles of a facet.
    pub fn triangles_of(&self, facet: u32) -> &[u32] {
        self.triangles_of.of(facet)
    }

    /// The vertices that belong to a facet: its centre, and those of which it is the first facet.
    pub fn vertices_of(&self, facet: u32) -> &[u32] {
        self.vertices_of.of(facet)
    }

    /// The edges that belong to a facet: those of which it is the first facet.
    pub fn edges_of(&self, facet: u32) -> &[u32] {
        self.edges_of.of(facet)
    }

    /// The points of integration of a triangle.
    pub(crate) fn integration_points(&self, triangle: u32) -> std::ops::Range<u32> {
        let first = self.vertex_count as u32 + GAUSS.len() as u32 * triangle;
        first..first + GAUSS.len() as u32
    }

    /// The triangle that a point of integration is in; none for vertices.
    pub(crate) fn triangle_of_integration_point(&self, point: u32) -> Option<u32> {
        (point as usize).checked_sub(self.vertex_count).map(|k| (k / GAUSS.len()) as u32)
    }

    /// Reference area that belongs to a point.
    pub(crate) fn area_of_point(&self, point: u32) -> f64 {
        self.point_area[point as usize]
    }

    /// Reference area of a facet.
    pub(crate) fn area_of_facet(&self, facet: u32) -> f64 {
        self.triangles_of(facet).iter().map(|&t| self.reference_area(t)).sum()
    }

    /// The facet by which a point is found.
    pub(crate) fn facet_of_point(&self, point: u32) -> u32 {
        self.point_facet[point as usize]
    }

    /// Reference area of a triangle.
    pub(crate) fn reference_area(&self, triangle: u32) -> f64 {
        GAUSS.len() as f64 * self.point_area[self.integration_points(triangle).start as usize]
    }

    /// Vertices of which a point is a mean, with their shares.
    pub(crate) fn corners_of(&self, point: u32, visit: &mut dyn FnMut(u32, f64)) {
        match (point as usize).checked_sub(self.vertex_count) {
            None => visit(point, 1.0),
            Some(k) => {
                let corners = self.triangles[k / GAUSS.len()];
                corners.into_iter().zip(GAUSS[k % GAUSS.len()]).for_each(|(v, share)| visit(v, share));
            }
        }
    }

    /// The number of an edge; none if it is no edge.
    pub(crate) fn edge(&self, a: u32, b: u32) -> Option<usize> {
        self.edges.binary_search(&[a.min(b), a.max(b)]).ok()
    }

    /// Whether two vertices are the ends of an edge of the body.
    pub(crate) fn is_sharp_edge(&self, a: u32, b: u32) -> bool {
        self.edge(a, b).is_some_and(|edge| self.shape.is_sharp_edge(edge))
    }

    /// Whether a vertex is a corner, or on an edge, of the body.
    pub(crate) fn is_sharp(&self, vertex: u32) -> bool {
        self.shape.is_sharp(vertex)
    }

    /// Number of triangles around a vertex; zero at a rim.
    pub(crate) fn fan(&self, vertex: u32) -> u32 {
        self.shape.fan(vertex)
    }

    /// The triangles around a vertex.
    pub(crate) fn triangles_at(&self, vertex: u32) -> &[u32] {
        self.shape.triangles_at(vertex)
    }

    /// The corners opposite of an edge; `u32::MAX` at a rim.
    pub(crate) fn opposite(&self, edge: u32) -> [u32; 2] {
        self.shape.opposite(edge as usize)
    }

    /// The triangles at the edge between two vertices; `u32::MAX` at a rim.
    pub(crate) fn beside(&self, a: u32, b: u32) -> [u32; 2] {
        self.edge(a, b).map_or([u32::MAX; 2], |edge| self.shape.beside(edge))
    }

    /// The sheet of a triangle: what is connected with it across edges at which the surface does not turn inward by much.
    pub(crate) fn sheet(&self, triangle: u32) -> u32 {
        self.shape.sheet(triangle)
    }

    /// Whether two triangles are neighbours across such an edge.
    pub(crate) fn goes_on(&self, s: u32, t: u32) -> bool {
        let [a, b] = [s, t].map(|t| self.triangles[t as usize]);
        let mut common = a.into_iter().filter(|v| b.contains(v));
        match (common.next(), common.next()) {
            (Some(p), Some(q)) => self.edge(p, q).is_some_and(|edge| self.shape.goes_on(edge)),
            _ => false,
        }
    }

    /// Whether a point is one of integration.
    pub fn is_integration_point(&self, point: u32) -> bool {
        point as usize >= self.vertex_count
    }

    /// The facet that a triangle belongs to.
    pub fn facet_of_triangle(&self, triangle: u32) -> u32 {
        self.triangle_facet[triangle as usize]
    }

    /// The facet that an edge belongs to; the first one of those at it.
    pub(crate) fn facet_of_edge(&self, edge: u32) -> u32 {
        self.edge_facet[edge as usize]
    }

    /// Whether a point is too near to a triangle on the surface itself to be in contact with it: a vertex and a triangle around it, a point of integration and a triangle that shares a corner with its own.
    pub fn is_adjacent(&self, point: u32, triangle: u32) -> bool {
        let corners = &self.triangles[triangle as usize];
        let own = match (point as usize).checked_sub(self.vertex_count) {
            Some(k) => &self.triangles[k / GAUSS.len()][..],
            None => std::slice::from_ref(&point),
        };
        own.iter().any(|v| corners.contains(v))
    }

    /// Weight of a point against a place in a triangle, an area; theory/barrier#eq-weight.
    ///
    /// `share` is the part of its area that a point of integration has against a surface like its own: one half where both sides are summed. Against much larger triangles it has more and against much
    /// smaller ones less, and more where its own surface is rougher. The parts of two surfaces at one place have the sum one, and they depend continuously on it: `shares` are those of the corners of the triangle.
    /// `corners`, from 0 to 1, are by how much the point's surface and the other one meet each other there with an edge or a corner of their body, which has all of the points then.
    /// A vertex has [`Self::guard_weight`]; it has none opposite a surface that is much rougher than its own.
    pub fn point_weight(&self, point: u32, triangle: u32, shares: [f64; 3], share: f64, corners: [f64; 2]) -> f64 {
        let area = self.point_area[point as usize];
        let other = self.shape.around(triangle, shares);
        let ends = (corners[0] - corners[1]).clamp(-1.0, 1.0);
        if (point as usize) < self.vertex_count {
            // Areas of vertices are a third of those of some six triangles.
            let own = Around { size: 0.5 * area, roughness: self.shape.vertex_angle(point) };
            return self.guard_weight(point, triangle) * (1.0 - rougher(&other, &own).max(-ends));
        }
        let place = point as usize - self.vertex_count;
        let own = self.shape.around((place / GAUSS.len()) as u32, GAUSS[place % GAUSS.len()]);
        // Sizes as far as they differ by more than a little.
        let bound = UNEVEN * own.size.min(other.size);
        let [a, b] = [own.size.max(bound), other.size.max(bound)];
        let (by_own, by_other) = ((1.0 - share) * a * a, share * b * b);
        let by_size = if by_other > 0.0 { by_other / (by_own + by_other) } else { 0.0 };
        let by_shape = by_size + rougher(&own, &other) * (1.0 - by_size) - rougher(&other, &own) * by_size;
        area * if ends > 0.0 { by_shape + ends * (1.0 - by_shape) } else { by_shape + ends * by_shape }
    }

    /// Weight of a vertex against a triangle, an area: a small part of its own, and not more than of a few of the largest at the triangle's corners.
    pub fn guard_weight(&self, vertex: u32, triangle: u32) -> f64 {
        let corners = self.triangles[triangle as usize].map(|v| self.point_area[v as usize]);
        let most = UNEVEN * corners.into_iter().fold(0.0, f64::max);
        0.5 * GUARD * self.point_area[vertex as usize].min(most)
    }

    /// Weight of two edges, an area, and the factor that fades them out where they are parallel. It is a small part of the mean of the areas that belong to them, and not more than of a few of the smaller one.
    pub fn edge_weight(&self, [e, f]: [u32; 2]) -> (f64, EdgeMollifier) {
        let [e, f] = [e as usize, f as usize];
        let (own, other) = (self.edge_area[e], self.edge_area[f]);
        let weight = 0.25 * GUARD * (own + other).min(2.0 * UNEVEN * own.min(other));
        (weight, EdgeMollifier::of_edges(self.edge_square[e], self.edge_square[f]))
    }
}

/// Degree to which one surface is rougher than another one that has not much smaller triangles, from 0 to 1: then its points follow its shape, and points of the smoother one would meet it at an angle.
fn rougher(own: &Around, other: &Around) -> f64 {
    let (low, high) = (other.roughness + FLAT, ROUGHER * (other.roughness + FLAT));
    let by_angle = ((own.roughness - low) / (high - low)).clamp(0.0, 1.0);
    // All at equal sizes and at UNEVEN times the area, none at twice of that.
    let by_size = (2.0 - own.size / (UNEVEN * other.size)).clamp(0.0, 1.0);
    by_angle * by_size
}

/// Lists of numbers, one after the other.
#[derive(Clone, Debug, Default)]
struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// The items of each of `count` owners, ascending.
    fn new(count: usize, owners: &[u32]) -> Self {
        let mut starts = vec![0u32; count + 1];
        owners.iter().for_each(|&owner| starts[owner as usize + 1] += 1);
        (0..count).for_each(|k| starts[k + 1] += starts[k]);
        let mut next = starts.clone();
        let mut items = vec![0; owners.len()];
        for (item, &owner) in owners.iter().enumerate() {
            items[next[owner as usize] as usize] = item as u32;
            next[owner as usize] += 1;
        }
        Self { starts, items }
    }

    /// The second numbers of pairs in ascending order, by the first ones.
    fn of_pairs(count: usize, pairs: &[(u32, u32)]) -> Self {
        let mut starts = vec![0u32; count + 1];
        pairs.iter().for_each(|pair| starts[pair.0 as usize + 1] += 1);
        (0..count).for_each(|k| starts[k + 1] += starts[k]);
        Self { starts, items: pairs.iter().map(|pair| pair.1).collect() }
    }

    fn of(&self, owner: u32) -> &[u32] {
        &self.items[self.starts[owner as usize] as usize..self.starts[owner as usize + 1] as usize]
    }
}

/// Whether triangles enclose a volume: each side is met once in either direction.
pub fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let sides: BTreeSet<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.iter().all(|&[a, b]| sides.contains(&[b, a]))
}

/// All edges of triangles, each once, with the smaller number first; sorted.
fn edges_of(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_two_triangles() {
        assert_eq!(edges_of(&[[2, 0, 1], [1, 3, 2]]), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert!(edges_of(&[]).is_empty());
    }

    #[test]
    fn lists_of_owners() {
        let lists = Lists::new(3, &[2, 0, 2]);
        assert_eq!([0, 1, 2].map(|owner| lists.of(owner).to_vec()), [vec![1], vec![], vec![0, 2]]);
    }
}
