//! The surface of a body as triangles, and what is inside of it.

use crate::WatchFacet;
use crate::curved::CurvedFace;
use crate::predicates::{DIRECTIONS, Intersection, intersect, is_on, nearest_point};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_geometry::{Aabb, BoundingVolumeTree};
use stoss_mesh::{Elements, FacetIndex};
use stoss_reference_element::FaceNodes;

/// Smallest cosine of the angle between the normals of two facets of a smooth surface: 40 degrees.
pub(crate) const SMOOTH: f64 = 0.766;

/// A facet: places of its corners in `nodes`, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    corners: [u32; 4],
    count: usize,
}

impl Facet {
    /// The facet with three or four corners.
    fn new(corners: &[u32], place: impl Fn(u32) -> u32) -> Self {
        let count = corners.len().min(4);
        Self { corners: std::array::from_fn(|k| place(corners[k % count])), count }
    }

    /// The corners.
    pub fn corners(&self) -> &[u32] {
        &self.corners[..self.count]
    }

    /// The edges, from corner to corner.
    fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.count).map(|k| [self.corners[k], self.corners[(k + 1) % self.count]])
    }
}

/// A point inside of a body, behind a facet.
#[derive(Clone, Copy, Debug)]
enum Inner {
    /// Mean of so many corners of an element, from this place in `core_corners` on.
    Element(u32, u32),
    /// Distance behind the centre of the facet: in a rigid body it is always the same point.
    Behind(f64),
    /// Mean of the nodes.
    Middle,
}

/// A surface of triangles and quadrilaterals; of the latter each is four triangles about its centre. That of a solid is closed.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Global numbers of the nodes on it.
    pub nodes: Vec<u32>,
    /// The numbers 0, 1, ... as many as there are nodes.
    places: Vec<u32>,
    /// The facets.
    pub facets: Vec<Facet>,
    /// The facets around each node.
    facets_at: Vec<Vec<u32>>,
    /// Edges of one facet only, as places in `points`, sorted: the rim of an open surface.
    rim: Vec<[u32; 2]>,
    /// Whether it encloses a volume.
    pub is_closed: bool,
    /// Whether it is that of a rigid body, whose facets may be much larger than those of the others.
    pub is_rigid: bool,
    /// Corners of the triangles as places in `points`, and their facets.
    triangles: Vec<([u32; 3], u32)>,
    /// The element behind each facet; none of a rigid body.
    pub elements: Vec<u32>,
    /// The quadratic faces.
    curved: Vec<CurvedFace>,
    /// Quadratic face that each facet is a piece of and the natural coordinates of its corners there; empty without any.
    pieces: Vec<Option<(u32, [[f64; 2]; 4])>>,
    /// Points inside, with a facet before each.
    inner: Vec<(Inner, u32)>,
    /// Global numbers of the corners of the elements that have such a point.
    core_corners: Vec<u32>,
    /// The present positions of the points inside.
    cores: Vec<Vector3<f64>>,
    /// Edges of the triangles, as places in `points`, each once.
    pub edges: Vec<[u32; 2]>,
    /// A facet of each edge.
    edge_facets: Vec<u32>,
    /// Present positions: nodes, then centres of the facets.
    pub points: Vec<Vector3<f64>>,
    /// Boxes of the triangles.
    pub tree: BoundingVolumeTree,
    /// Box around everything.
    pub bounds: Aabb,
}

impl Surface {
    /// The outside of a solid: the faces that belong to one element only, quadratic ones in pieces.
    pub fn of_elements(all: &Elements) -> Self {
        let boundary = FacetIndex::new(all).boundary();
        let pieces: Vec<_> =
            boundary.iter().flat_map(|facet| facet.nodes.pieces().map(|piece| (piece, facet.element))).collect();
        let elements: Vec<u32> = pieces.iter().map(|(_, element)| *element).collect();
        let mut surface = Self::of(pieces.iter().map(|(piece, _)| &piece[..]));
        surface.set_curved(boundary.iter().map(|facet| &facet.nodes));
        // Each element once, with the first of its faces; they are in the order of the elements.
        let mut inner = Vec::new();
        for k in (0..elements.len()).filter(|&k| k == 0 || elements[k] != elements[k - 1]) {
            let element = elements[k] as usize;
            let corners = &all[element][..all.kind(element).table().corners];
            inner.push((Inner::Element(surface.core_corners.len() as u32, corners.len() as u32), k as u32));
            surface.core_corners.extend_from_slice(corners);
        }
        surface.cores_at(inner);
        Self { elements, ..surface }
    }

    /// The surface of a rigid body, with its positions in the reference.
    pub fn of_facets(facets: &[WatchFacet], is_closed: bool, reference: &[f64]) -> Self {
        /// Halvings of an edge length on the way to a point inside.
        const HALVINGS: i32 = 20;
        let mut surface = Self::of(facets.iter().map(WatchFacet::corners));
        (surface.is_rigid, surface.is_closed) = (true, is_closed);
        if is_closed {
            surface.place(reference, true);
            let behind = |f: usize| {
                let depths = (1..HALVINGS).map(|k| surface.length(f as u32) * 0.5_f64.powi(k));
                let mut inside = depths.filter(|&depth| surface.contains(&surface.behind(f, depth)));
                inside.next().map(|depth| (Inner::Behind(depth), f as u32))
            };
            let middle = surface.contains(&surface.middle()).then_some((Inner::Middle, 0));
            let inner = (0..surface.facets.len()).filter_map(behind).chain(middle).collect();
            surface.cores_at(inner);
        }
        surface
    }

    /// The surface of facets by global node numbers.
    fn of<'a>(list: impl Iterator<Item = &'a [u32]> + Clone) -> Self {
        let mut nodes: Vec<u32> = list.clone().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place: BTreeMap<u32, u32> = nodes.iter().enumerate().map(|(k, &node)| (node, k as u32)).collect();
        let facets: Vec<Facet> = list.map(|corners| Facet::new(corners, |node| place[&node])).collect();
        let (mut edges, mut triangles, mut facets_at) = (Vec::new(), Vec::new(), vec![Vec::new(); nodes.len()]);
        let mut outer: Vec<[u32; 2]> = Vec::new();
        for (f, facet) in facets.iter().enumerate() {
            let centre = (nodes.len() + f) as u32;
            for [a, b] in facet.edges() {
                facets_at[a as usize].push(f as u32);
                edges.push(([a.min(b), a.max(b)], f as u32));
                outer.push([a.min(b), a.max(b)]);
                if facet.count == 4 {
                    edges.push(([a, centre], f as u32));
                    triangles.push(([a, b, centre], f as u32));
                }
            }
            if let [a, b, c] = *facet.corners() {
                triangles.push(([a, b, c], f as u32));
            }
        }
        edges.sort_unstable();
        edges.dedup_by_key(|(ends, _)| *ends);
        let (edges, edge_facets) = edges.into_iter().unzip();
        outer.sort_unstable();
        let rim = outer.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect();
        let boxes = vec![Aabb::from_points([&Vector3::zeros()]); triangles.len()];
        Self {
            places: (0..nodes.len() as u32).collect(),
            points: vec![Vector3::zeros(); nodes.len() + facets.len()],
            nodes,
            facets,
            facets_at,
            rim,
            is_closed: true,
            is_rigid: false,
            triangles,
            elements: Vec::new(),
            curved: Vec::new(),
            pieces: Vec::new(),
            inner: Vec::new(),
            core_corners: Vec::new(),
            cores: Vec::new(),
            edges,
            edge_facets,
            tree: BoundingVolumeTree::build(&boxes),
            bounds: Aabb::empty(),
        }
    }

    /// The faces that the facets are pieces of, in their order.
    fn set_curved<'a>(&mut self, faces: impl Iterator<Item = &'a FaceNodes> + Clone) {
        if !faces.clone().any(|face| face.kind().is_quadratic()) {
            return;
        }
        for face in faces {
            let kind = face.kind();
            for piece in kind.pieces() {
                let corner = |k: usize| kind.nodes()[usize::from(piece[k % piece.len()])];
                let own = (self.curved.len() as u32, std::array::from_fn(corner));
                self.pieces.push(kind.is_quadratic().then_some(own));
            }
            if kind.is_quadratic() {
                // cannot fail: a face's nodes are nodes of its pieces.
                let place = |node: u32| self.nodes.binary_search(&node).map_or(0, |k| k as u32);
                self.curved.push(CurvedFace::new(face, place));
            }
        }
    }

    /// The quadratic face that a facet is a piece of, and the natural coordinates of the facet's corners.
    fn curved(&self, facet: u32) -> Option<(&CurvedFace, &[[f64; 2]; 4])> {
        let (face, corners) = self.pieces.get(facet as usize)?.as_ref()?;
        Some((&self.curved[*face as usize], corners))
    }

    /// The point of the surface at the part `t` of an edge: on the quadratic face that the edge is a chord of, or on the edge.
    pub fn on_edge(&self, [a, b]: [u32; 2], t: f64) -> Vector3<f64> {
        let straight = || self.points[a as usize].lerp(&self.points[b as usize], t);
        if self.pieces.is_empty() {
            return straight();
        }
        let Ok(edge) = self.edges.binary_search(&[a, b]) else { return straight() };
        let facet = self.edge_facets[edge];
        let Some((face, natural)) = self.curved(facet) else { return straight() };
        let corners = self.facets[facet as usize];
        let at = |k: u32| {
            let corner = corners.corners().iter().position(|&corner| corner == k);
            corner.map_or_else(|| centre(&natural[..corners.count]), |k| natural[k])
        };
        let (from, to) = (at(a), at(b));
        face.point(&self.points, [0, 1].map(|i: usize| from[i] + t * (to[i] - from[i])))
    }

    /// Whether a facet is a piece of a quadratic face, whose arch over it is known.
    pub fn is_piece(&self, facet: u32) -> bool {
        self.curved(facet).is_some()
    }

    /// Height of a point over the quadratic face that a triangle is a part of (a length, positive outside); nothing over a linear one.
    pub fn height_over_face(&self, x: &Vector3<f64>, triangle: usize) -> Option<f64> {
        let facet = self.facet(triangle);
        let (face, natural) = self.curved(facet)?;
        let (own, corners) = (self.corners(triangle), self.facets[facet as usize]);
        // Natural coordinates of the corners of the triangle, one of which may be the centre of the facet.
        let centre = centre(&natural[..corners.count]);
        let xi = own.map(|k| corners.corners().iter().position(|&corner| corner == k).map_or(centre, |k| natural[k]));
        let weights = weights(&nearest_point(x, self.triangle(triangle)), self.triangle(triangle))?;
        let start = [0, 1].map(|i: usize| (0..3).map(|k| weights[k] * xi[k][i]).sum());
        face.height(&self.points, x, start)
    }

    fn cores_at(&mut self, inner: Vec<(Inner, u32)>) {
        self.cores = vec![Vector3::zeros(); inner.len()];
        self.inner = inner;
    }

    /// Takes over positions; the first time the tree is built again. A rigid surface that stays where it is takes one comparison.
    pub fn place(&mut self, q: &[f64], build: bool) {
        let at = |node: u32| &q[3 * node as usize..3 * node as usize + 3];
        let mut pairs = self.nodes.iter().zip(&self.points);
        if !build && self.is_rigid && pairs.all(|(&node, point)| at(node) == point.as_slice()) {
            return;
        }
        self.points_at(q);
        let Self { triangles, points, tree, bounds, .. } = self;
        let box_of = |t: usize| Aabb::from_points(triangles[t].0.map(|k| &points[k as usize]));
        if build {
            let boxes: Vec<Aabb> = (0..triangles.len()).map(box_of).collect();
            *tree = BoundingVolumeTree::build(&boxes);
        } else {
            tree.refit(box_of);
        }
        *bounds = tree.bounds();
    }

    fn points_at(&mut self, q: &[f64]) {
        let at = |node: u32| Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3]);
        let Self { nodes, facets, points, curved, pieces, .. } = self;
        for (point, &node) in points.iter_mut().zip(nodes.iter()) {
            *point = at(node);
        }
        for (f, facet) in facets.iter().enumerate() {
            if let Some(Some((face, natural))) = pieces.get(f) {
                points[nodes.len() + f] = curved[*face as usize].point(points, centre(&natural[..facet.count]));
                continue;
            }
            let sum = facet.corners().iter().fold(Vector3::zeros(), |sum, &k| sum + points[k as usize]);
            points[nodes.len() + f] = sum / facet.count as f64;
        }
        for k in 0..self.inner.len() {
            self.cores[k] = match self.inner[k] {
                (Inner::Element(first, count), _) => {
                    let corners = &self.core_corners[first as usize..(first + count) as usize];
                    corners.iter().fold(Vector3::zeros(), |sum, &node| sum + at(node)) / f64::from(count)
                }
                (Inner::Behind(depth), f) => self.behind(f as usize, depth),
                (Inner::Middle, _) => self.middle(),
            };
        }
    }

    /// The point so far behind the centre of a facet.
    fn behind(&self, facet: usize, depth: f64) -> Vector3<f64> {
        let centre = self.points[self.nodes.len() + facet];
        let around = self.facets[facet].edges().map(|edge| edge.map(|k| self.points[k as usize] - centre));
        let normal = around.fold(Vector3::zeros(), |sum, [a, b]| sum + a.cross(&b));
        centre - normal.try_normalize(0.0).unwrap_or_default() * depth
    }

    /// The mean of the nodes.
    fn middle(&self) -> Vector3<f64> {
        self.points[..self.nodes.len()].iter().sum::<Vector3<f64>>() / self.nodes.len().max(1) as f64
    }

    /// Points inside, each with the facet before it.
    pub fn cores(&self) -> impl Iterator<Item = (&Vector3<f64>, u32)> {
        self.cores.iter().zip(&self.inner).map(|(core, (_, facet))| (core, *facet))
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The nodes that a place in `points` belongs to: itself, or the corners of the facet whose centre it is.
    pub fn nodes_of(&self, point: u32) -> &[u32] {
        let k = point as usize;
        match k.checked_sub(self.nodes.len()) {
            None => &self.places[k..=k],
            Some(facet) => self.facets[facet].corners(),
        }
    }

    /// Points and edges of the triangles of a rigid surface that reach into a region, in their order: all that can be inside of it.
    pub fn within(&self, region: &Aabb) -> (Vec<u32>, Vec<[u32; 2]>) {
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        self.tree.query(region, |t| {
            let corners = self.corners(t);
            points.extend(corners);
            edges.extend([[0, 1], [1, 2], [2, 0]].map(|ends| {
                let [a, b] = ends.map(|k: usize| corners[k]);
                [a.min(b), a.max(b)]
            }));
        });
        points.sort_unstable();
        points.dedup();
        edges.sort_unstable();
        edges.dedup();
        (points, edges)
    }

    /// Corners of a triangle as places in `points`.
    pub fn corners(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].0
    }

    /// Corners of a triangle.
    pub fn triangle(&self, triangle: usize) -> [&Vector3<f64>; 3] {
        self.corners(triangle).map(|k| &self.points[k as usize])
    }

    /// The element behind a triangle; only of a solid.
    pub fn element(&self, triangle: usize) -> Option<u32> {
        self.elements.get(self.triangles[triangle].1 as usize).copied()
    }

    /// Mean edge length of a facet.
    pub fn length(&self, facet: u32) -> f64 {
        let facet = &self.facets[facet as usize];
        let lengths = facet.edges().map(|[a, b]| (self.points[a as usize] - self.points[b as usize]).norm());
        lengths.sum::<f64>() / facet.count as f64
    }

    /// Distance of a point to what the facets of two triangles have in common, a corner or an edge, with the points of the surface at `at`; nothing if they do not meet.
    pub fn nearest_common(
        &self,
        triangles: [usize; 2],
        x: &Vector3<f64>,
        at: impl Fn(usize) -> Vector3<f64>,
    ) -> Option<f64> {
        let [first, second] = triangles.map(|t| self.facets[self.triangles[t].1 as usize].corners());
        let common = || first.iter().filter(|corner| second.contains(corner)).map(|&corner| at(corner as usize));
        let distances = common().flat_map(|a| common().map(move |b| (x - nearest_point(x, [&a, &b, &b])).norm()));
        distances.min_by(f64::total_cmp)
    }

    /// Mean edge length of the facet of a triangle.
    pub fn edge_length(&self, triangle: usize) -> f64 {
        self.length(self.triangles[triangle].1)
    }

    /// What a depth below a triangle is measured by, for a point of another body: the mean edge length of the facet, of a rigid body that of the other's
    /// facet if it is smaller.
    pub fn depth_unit(&self, triangle: usize, body: &Self, point: u32) -> f64 {
        let own = self.edge_length(triangle);
        if !self.is_rigid {
            return own;
        }
        let facet = (point as usize)
            .checked_sub(body.nodes.len())
            .map(|facet| facet as u32)
            // cannot fail: a node of the surface is one of a facet.
            .unwrap_or(body.facets_at[body.nodes_of(point)[0] as usize].last().copied().unwrap_or(0));
        own.min(body.length(facet))
    }

    /// Facet of a triangle.
    pub fn facet(&self, triangle: usize) -> u32 {
        self.triangles[triangle].1
    }

    /// The facets around a node, a place in `nodes`.
    pub fn facets_at(&self, node: u32) -> &[u32] {
        &self.facets_at[node as usize]
    }

    /// Unit normal of a facet, the mean of those of its triangles by their areas; zero of a facet without area.
    pub fn normal(&self, facet: u32) -> Vector3<f64> {
        let centre = self.points[self.nodes.len() + facet as usize];
        let around = self.facets[facet as usize].edges().map(|edge| edge.map(|k| self.points[k as usize] - centre));
        let normal = around.fold(Vector3::zeros(), |sum, [a, b]| sum + a.cross(&b));
        normal.try_normalize(0.0).unwrap_or_default()
    }

    /// Unit vectors in the plane of a facet of an open surface, across its edges on the rim and away from it: of edges that are within `reach` of a point.
    pub fn outwards(&self, facet: u32, x: &Vector3<f64>, reach: f64) -> Vec<Vector3<f64>> {
        let normal = self.normal(facet);
        let is_rim = |[a, b]: &[u32; 2]| self.rim.binary_search(&[*a.min(b), *a.max(b)]).is_ok();
        let ends = |edge: [u32; 2]| edge.map(|k| &self.points[k as usize]);
        let near = self.facets[facet as usize].edges().filter(is_rim).map(ends);
        let near = near.filter(|[a, b]| (nearest_point(x, [a, b, b]) - x).norm() <= reach);
        near.filter_map(|[a, b]| (b - a).cross(&normal).try_normalize(0.0)).collect()
    }

    /// Centre of a facet.
    pub fn centre(&self, facet: u32) -> &Vector3<f64> {
        &self.points[self.nodes.len() + facet as usize]
    }

    /// Height over a facet of a smooth surface through its corners, at a point on it: `1/2 sum w_i n_i . (x_i - y) / n_i . n`, with the weights `w_i` of the corners at `y`, their normals
    /// `n_i` (the mean over the facets around them whose normals are within [`SMOOTH`] of that of the facet) and the normal `n` of the facet. It is exact for a
    /// surface of second order, zero at the corners, and positive where the surface is convex. Zero over a piece of a quadratic face, from which depths and distances are taken themselves.
    pub fn height_of_arch(&self, triangle: usize, y: &Vector3<f64>) -> f64 {
        let f = self.facet(triangle);
        if self.is_piece(f) {
            return 0.0;
        }
        let facet = self.facets[f as usize];
        let (corners, n) = (facet.corners(), self.normal(f));
        // Weights in the triangle; the centre of a quadrilateral hands its own to the corners.
        let [a, b, c] = self.corners(triangle);
        let Some([first, second, third]) = weights(y, self.triangle(triangle)) else { return 0.0 };
        let inside = [(a, first), (b, second), (c, third)];
        let of_centre: f64 = inside.iter().filter(|(k, _)| *k as usize >= self.nodes.len()).map(|(_, w)| w).sum();
        let height = |&corner: &u32| {
            let own: f64 = inside.iter().filter(|(k, _)| *k == corner).map(|(_, w)| w).sum();
            let weight = own + of_centre / facet.count as f64;
            let around = self.facets_at(corner).iter().map(|&f| self.normal(f));
            let smooth = around.filter(|m| m.dot(&n) > SMOOTH);
            let normal = smooth.fold(Vector3::zeros(), |sum, m| sum + m);
            let across = normal.dot(&n);
            if across > 0.0 { weight * normal.dot(&(self.points[corner as usize] - y)) / across } else { 0.0 }
        };
        0.5 * corners.iter().map(height).sum::<f64>()
    }

    /// The triangles of a facet.
    pub fn triangles_of(&self, facet: u32) -> std::ops::Range<usize> {
        let first = |f: u32| self.triangles.partition_point(|(_, of)| *of < f);
        first(facet)..first(facet + 1)
    }

    /// Height of a facet's arch over its centre.
    pub fn highest_arch(&self, facet: u32) -> f64 {
        let centre = self.centre(facet);
        self.triangles_of(facet).next().map_or(0.0, |first| self.height_of_arch(first, centre).abs())
    }

    /// Whether the point of an open surface that is nearest to `x`, on this triangle, lies on its rim: then `x` is beside the surface, and not before or behind it.
    pub fn is_beside(&self, x: &Vector3<f64>, triangle: usize) -> bool {
        /// Part of an edge that is round-off of a point.
        const ROUND_OFF: f64 = 1.0e-9;
        let foot = nearest_point(x, self.triangle(triangle));
        let near = ROUND_OFF * self.edge_length(triangle);
        let corners = self.corners(triangle);
        let on = |edge: &[u32; 2]| {
            let [a, b] = edge.map(|k| &self.points[k as usize]);
            (nearest_point(&foot, [a, b, b]) - foot).norm() <= near
        };
        self.rim.iter().filter(|edge| edge.iter().any(|end| corners.contains(end))).any(on)
    }

    /// Whether a point is inside: how often the surface winds about it is not zero. A point on the surface is not inside, and none is
    /// inside of a surface that is open.
    pub fn contains(&self, x: &Vector3<f64>) -> bool {
        if !self.is_closed || !self.bounds.contains(x) {
            return false;
        }
        // Every ray of such a point would be degenerate, and bodies that lie on each other have many.
        let mut on_surface = false;
        self.tree.query(&Aabb::from_points([x]), |t| on_surface |= is_on(x, self.triangle(t)));
        if on_surface {
            return false;
        }
        let size = (self.bounds.max - self.bounds.min).norm();
        'ray: for direction in DIRECTIONS {
            let end = x + Vector3::from(direction) * (2.0 * size);
            let mut winding = 0;
            let mut degenerate = false;
            self.tree.query(&Aabb::from_points([x, &end]), |t| match intersect(x, &end, self.triangle(t)) {
                Intersection::None => {}
                Intersection::Through(way) => winding += way,
                Intersection::Degenerate => degenerate = true,
            });
            if degenerate {
                continue 'ray;
            }
            return winding != 0;
        }
        // All rays meet an edge: the point is on the surface but for round-off.
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

/// The mean of natural coordinates.
fn centre(natural: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i: usize| natural.iter().map(|xi| xi[i]).sum::<f64>() / natural.len() as f64)
}

/// Weights of the corners of a triangle at a point of it; nothing if it has no area.
fn weights(y: &Vector3<f64>, [x, u, v]: [&Vector3<f64>; 3]) -> Option<[f64; 3]> {
    let (u, v, y) = (u - x, v - x, y - x);
    let square = u.cross(&v).norm_squared();
    let [second, third] = [y.cross(&v), u.cross(&y)].map(|w| w.dot(&u.cross(&v)) / square);
    (square > 0.0).then_some([1.0 - second - third, second, third])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_winds_about_its_inside_and_not_about_its_surface() {
        let q: Vec<f64> = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .concat()
            .into_iter()
            .map(f64::from)
            .collect();
        let mut cube = Surface::of_elements(&vec![[0, 1, 2, 3, 4, 5, 6, 7]].into());
        cube.place(&q, true);
        assert_eq!((cube.facets.len(), cube.nodes.len(), cube.edges.len()), (6, 8, 12 + 24));
        assert!(cube.contains(&Vector3::new(0.5, 0.5, 0.5)) && cube.contains(&Vector3::new(1e-12, 0.5, 0.25)));
        for outside in [[1.5, 0.5, 0.5], [0.0, 0.3, 0.4], [1.0, 1.0, 1.0], [0.5, 0.0, 0.5], [-1e-12, 0.5, 0.25]] {
            assert!(!cube.contains(&Vector3::from(outside)), "{outside:?}");
        }
        let (distance, triangle) = cube.nearest(&Vector3::new(0.5, 0.4, 0.8));
        assert!((distance - 0.2).abs() < 1e-15 && cube.triangle(triangle).iter().all(|x| x.z == 1.0));
    }
}
