//! Facets as data: kinds of facets, and values at the nodes of a facet of any kind.
//!
//! A surface may have facets of several kinds. What contact needs of a kind is asked of [`FacetKind`], so that no other place tells kinds apart.
//! [`Nodal`] has one value a node with room for [`MAX_NODES`], without allocation.
//!
//! Arrays `[_; MAX_NODES]` of shape functions and of their derivatives are zero beyond the nodes of the kind. So sums over all
//! `MAX_NODES` places are right for every kind.

use crate::quadrature::GAUSS_QUAD_2;
use crate::{quad4, tri3, triangle};
use std::ops::Deref;

/// Most nodes of a facet.
pub const MAX_NODES: usize = 4;

/// A kind of facet.
///
/// Deliberately exhaustive, as [`crate::CellKind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FacetKind {
    /// The bilinear quadrilateral, see [`quad4`].
    Quad4,
    /// The linear triangle, see [`tri3`].
    Tri3,
}

/// What tells one kind from another. One constant a kind.
struct Data {
    name: &'static str,
    vertices: &'static [[f64; 2]],
    edges: usize,
    sides: &'static [[usize; 2]],
    inward: &'static [[f64; 2]],
    diagonals: [[f64; MAX_NODES]; 2],
    triangles: &'static [[usize; 3]],
    pieces: &'static [[[u8; 3]; 2]],
    centre: [f64; 2],
    area: f64,
    rule: &'static [([f64; 2], f64)],
    mixed_derivative: [f64; MAX_NODES],
}

/// `sqrt(sqrt(3) / 2)`.
const A: f64 = 0.930_604_859_102_099_6;
/// `A / sqrt(3)`.
const B: f64 = 0.537_284_965_911_771;

static QUAD4: Data = Data {
    name: "quad4",
    vertices: &quad4::VERTICES,
    edges: 4,
    sides: &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]],
    inward: &[[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]],
    diagonals: [[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]],
    triangles: &[[0, 1, 2], [0, 2, 3]],
    pieces: &[[[1, 2, 3], [3, 0, 1]], [[0, 1, 2], [2, 3, 0]]],
    centre: [0.0, 0.0],
    area: 4.0,
    rule: &GAUSS_QUAD_2,
    mixed_derivative: quad4::mixed_derivative(),
};

static TRI3: Data = Data {
    name: "tri3",
    vertices: &tri3::VERTICES,
    edges: 3,
    sides: &[[0, 1], [1, 2], [2, 0]],
    inward: &[[0.0, 1.0], [-1.0, -1.0], [1.0, 0.0]],
    diagonals: [[-A, A, 0.0, 0.0], [-B, -B, 2.0 * B, 0.0]],
    triangles: &[[0, 1, 2]],
    pieces: &[],
    centre: [1.0 / 3.0, 1.0 / 3.0],
    area: 0.5,
    rule: &triangle::THREE,
    mixed_derivative: [0.0; MAX_NODES],
};

impl FacetKind {
    /// All kinds of facets.
    pub const ALL: [Self; 2] = [Self::Quad4, Self::Tri3];

    fn data(self) -> &'static Data {
        match self {
            Self::Quad4 => &QUAD4,
            Self::Tri3 => &TRI3,
        }
    }

    /// The kind's name in messages.
    pub fn name(self) -> &'static str {
        self.data().name
    }

    /// Number of nodes.
    #[inline]
    pub const fn node_count(self) -> usize {
        match self {
            Self::Quad4 => quad4::NODE_COUNT,
            Self::Tri3 => tri3::NODE_COUNT,
        }
    }

    /// Number of edges, which is that of corners. Edge `k` runs from corner `k` to the next one, [`FacetKind::side`].
    #[inline]
    pub fn edge_count(self) -> usize {
        self.data().edges
    }

    /// Natural coordinates of the nodes, counter-clockwise.
    #[inline]
    pub fn vertices(self) -> &'static [[f64; 2]] {
        self.data().vertices
    }

    /// Shape functions at `xi`.
    #[inline]
    pub fn shape(self, xi: [f64; 2]) -> [f64; MAX_NODES] {
        match self {
            Self::Quad4 => quad4::shape(xi),
            Self::Tri3 => {
                let [a, b, c] = tri3::shape(xi);
                [a, b, c, 0.0]
            }
        }
    }

    /// Gradients of the shape functions at `xi`: row the node, column the direction.
    #[inline]
    pub fn shape_gradient(self, xi: [f64; 2]) -> [[f64; 2]; MAX_NODES] {
        match self {
            Self::Quad4 => quad4::shape_gradient(xi),
            Self::Tri3 => {
                let [a, b, c] = tri3::shape_gradient();
                [a, b, c, [0.0; 2]]
            }
        }
    }

    /// Mixed second derivatives `N_I,12`, constant. The kinds that there are have no other second derivatives.
    #[inline]
    pub fn mixed_derivative(self) -> [f64; MAX_NODES] {
        self.data().mixed_derivative
    }

    /// Natural coordinates of the centre.
    #[inline]
    pub fn centre(self) -> [f64; 2] {
        self.data().centre
    }

    /// Area in natural coordinates.
    #[inline]
    pub fn area(self) -> f64 {
        self.data().area
    }

    /// Points and weights of a quadrature rule that integrates the shape functions over a parallelogram or a plane triangle exactly; the weights add up to
    /// [`FacetKind::area`].
    #[inline]
    pub fn rule(self) -> &'static [([f64; 2], f64)] {
        self.data().rule
    }

    /// Edges, then diagonals: the corners between which they run.
    #[inline]
    pub fn sides(self) -> &'static [[usize; 2]] {
        self.data().sides
    }

    /// Ends of an edge or a diagonal.
    #[inline]
    pub fn side(self, side: usize) -> [usize; 2] {
        self.data().sides[side]
    }

    /// Number of the side between two corners.
    pub fn side_between(self, a: usize, b: usize) -> Option<usize> {
        self.sides().iter().position(|&s| s == [a, b] || s == [b, a])
    }

    /// The corner after this one.
    #[inline]
    pub fn next(self, corner: usize) -> usize {
        (corner + 1) % self.edge_count()
    }

    /// The corner before this one, which is also the number of the edge that ends in this one.
    #[inline]
    pub fn previous(self, corner: usize) -> usize {
        (corner + self.edge_count() - 1) % self.edge_count()
    }

    /// Coefficients of the nodes in two vectors `d_1`, `d_2` whose cross product is twice the area vector of the plane facet. Of a
    /// quadrilateral its diagonals. Of a triangle one edge and the median on it, scaled so that `d_1 d_1^T + d_2 d_2^T` does not depend on which edge.
    #[inline]
    pub fn diagonals(self) -> [[f64; MAX_NODES]; 2] {
        self.data().diagonals
    }

    /// Triangles that the facet is divided into for coarse purposes: corners, counter-clockwise.
    #[inline]
    pub fn triangles(self) -> &'static [[usize; 3]] {
        self.data().triangles
    }

    /// The ways to divide a facet whose image is not convex in two triangles: corners, counter-clockwise. None for triangles.
    #[inline]
    pub fn pieces(self) -> &'static [[[u8; 3]; 2]] {
        self.data().pieces
    }

    /// How far `xi` lies beyond the line of an edge, in halves of an edge: positive outside, zero on the edge.
    #[inline]
    pub fn edge_excess(self, edge: usize, xi: [f64; 2]) -> f64 {
        match self {
            Self::Quad4 => [-xi[1], xi[0], xi[1], -xi[0]][edge] - 1.0,
            Self::Tri3 => 2.0 * [-xi[1], xi[0] + xi[1] - 1.0, -xi[0]][edge],
        }
    }

    /// How far `xi` lies outside of the facet, in halves of an edge: positive outside, zero on the boundary.
    #[inline]
    pub fn excess(self, xi: [f64; 2]) -> f64 {
        match self {
            Self::Quad4 => xi[0].abs().max(xi[1].abs()) - 1.0,
            Self::Tri3 => 2.0 * (xi[0] + xi[1] - 1.0).max(-xi[0]).max(-xi[1]),
        }
    }

    /// A direction in natural coordinates that leads from an edge into the facet.
    #[inline]
    pub fn inward(self, edge: usize) -> [f64; 2] {
        self.data().inward[edge]
    }

    /// A point of the closed facet near `xi`: `xi` itself inside, otherwise the nearest one in natural coordinates.
    #[inline]
    pub fn clamp(self, xi: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Quad4 => xi.map(|x| x.clamp(-1.0, 1.0)),
            Self::Tri3 => {
                let beyond = 0.5 * (xi[0] + xi[1] - 1.0).max(0.0);
                let first = (xi[0] - beyond).clamp(0.0, 1.0);
                [first, (xi[1] - beyond).clamp(0.0, 1.0 - first)]
            }
        }
    }

    /// Place of a point on an edge, from `-1` in its first corner to `1` in the second.
    #[inline]
    pub fn along_edge(self, edge: usize, xi: [f64; 2]) -> f64 {
        match self {
            Self::Quad4 => [xi[0], xi[1], -xi[0], -xi[1]][edge],
            Self::Tri3 => [2.0 * xi[0] - 1.0, 2.0 * xi[1] - 1.0, 1.0 - 2.0 * xi[1]][edge],
        }
    }

    /// The point at a place `-1 <= s <= 1` of an edge; [`FacetKind::edge_excess`] is exactly zero there.
    #[inline]
    pub fn on_edge(self, edge: usize, s: f64) -> [f64; 2] {
        match self {
            Self::Quad4 => [[s, -1.0], [1.0, s], [-s, 1.0], [-1.0, -s]][edge],
            Self::Tri3 => {
                let t = 0.5 * (1.0 + s);
                [[t, 0.0], [1.0 - t, t], [0.0, 1.0 - t]][edge]
            }
        }
    }
}

impl std::fmt::Display for FacetKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// One value for each node of a facet, in the order of the facet's kind. A slice of [`FacetKind::node_count`] values.
///
/// From an array of 3 or 4 values it becomes the triangle or the quadrilateral with these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Nodal<T> {
    kind: FacetKind,
    /// The first value again beyond the nodes of the kind.
    values: [T; MAX_NODES],
}

/// Nodes of a facet by number.
pub type FacetNodes = Nodal<u32>;

impl<T: Copy> Nodal<T> {
    /// Values from a function of the node.
    #[inline]
    pub fn from_fn(kind: FacetKind, mut value: impl FnMut(usize) -> T) -> Self {
        let mut values = [value(0); MAX_NODES];
        for (k, v) in values[..kind.node_count()].iter_mut().enumerate().skip(1) {
            *v = value(k);
        }
        Self { kind, values }
    }

    /// The kind of the facet.
    #[inline]
    pub fn kind(&self) -> FacetKind {
        self.kind
    }

    /// Values at all places: the first value stands where there is no node. In sums with weights that are zero there it does no harm.
    #[inline]
    pub fn padded(&self) -> &[T; MAX_NODES] {
        &self.values
    }

    /// The function's value at each node.
    #[inline]
    pub fn map<U: Copy>(&self, mut f: impl FnMut(T) -> U) -> Nodal<U> {
        Nodal::from_fn(self.kind, |k| f(self.values[k]))
    }
}

impl<T> Deref for Nodal<T> {
    type Target = [T];
    #[inline]
    fn deref(&self) -> &[T] {
        &self.values[..self.kind.node_count()]
    }
}

impl<T> IntoIterator for Nodal<T> {
    type Item = T;
    type IntoIter = std::iter::Take<std::array::IntoIter<T, MAX_NODES>>;
    #[inline]
    fn into_iter(self) -> Self::IntoIter {
        self.values.into_iter().take(self.kind.node_count())
    }
}

impl<'a, T> IntoIterator for &'a Nodal<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;
    #[inline]
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<T: Copy> From<[T; 4]> for Nodal<T> {
    #[inline]
    fn from(values: [T; 4]) -> Self {
        Self { kind: FacetKind::Quad4, values }
    }
}

impl<T: Copy> From<[T; 3]> for Nodal<T> {
    #[inline]
    fn from([a, b, c]: [T; 3]) -> Self {
        Self { kind: FacetKind::Tri3, values: [a, b, c, a] }
    }
}
