//! Faces of cells, as data: what loads, surfaces and pictures see of a cell.
//!
//! A face has the nodes and the shape functions of its cell. Contact works on [`FacetKind`], linear facets: a linear face is one,
//! a quadratic face is divided into several whose corners are its nodes ([`FaceKind::pieces`]).

use crate::quadrature::{GAUSS_QUAD_2, GAUSS_QUAD_3};
use crate::{FacetKind, FacetNodes, Nodal, quad4, tri3, triangle};
use std::ops::Deref;

/// Most nodes of a face.
pub const MAX_FACE_NODES: usize = 9;

/// Shape functions of a face, zero beyond its nodes.
pub type FaceShape = [f64; MAX_FACE_NODES];
/// Gradients of the shape functions of a face: row the node, column the direction; zero beyond the nodes.
pub type FaceGradient = [[f64; 2]; MAX_FACE_NODES];

/// A kind of face. Quadratic faces have their corners first, then the middles of the edges in order, then the centre.
///
/// Deliberately exhaustive, as [`crate::CellKind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FaceKind {
    /// The linear triangle, see [`tri3`].
    Tri3,
    /// The bilinear quadrilateral, see [`quad4`].
    Quad4,
    /// The quadratic triangle.
    Tri6,
    /// The serendipity quadrilateral.
    Quad8,
    /// The biquadratic quadrilateral.
    Quad9,
}

/// The piecewise linear surface that contact sees of a face, [`FaceKind::trace`].
#[derive(Clone, Copy, Debug)]
pub struct Trace {
    /// Nodes and weights of each vertex; the corners first, each itself.
    pub vertices: &'static [&'static [(u8, f64)]],
    /// Facets as places in `vertices`, of three or four.
    pub facets: &'static [&'static [u8]],
}

const CORNERS: [&[(u8, f64)]; 4] = [&[(0, 1.0)], &[(1, 1.0)], &[(2, 1.0)], &[(3, 1.0)]];

/// Weight of the middle node in the vertex at the middle of an edge.
const M: f64 = 4.0 / 3.0;
/// Weight of each end node in the vertex at the middle of an edge.
const E: f64 = -1.0 / 6.0;

/// What tells one kind from another. One constant a kind.
struct Data {
    name: &'static str,
    nodes: &'static [[f64; 2]],
    linear: FacetKind,
    pieces: &'static [&'static [u8]],
    trace: Trace,
    rule: &'static [([f64; 2], f64)],
    vtk: u8,
}

const TRI: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
const QUAD: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];
const QUAD_8: [[f64; 2]; 8] = [QUAD[0], QUAD[1], QUAD[2], QUAD[3], QUAD[4], QUAD[5], QUAD[6], QUAD[7]];

/// The quarters of a quadrilateral with nodes in the middles of its edges and in its centre.
const QUARTERS: &[&[u8]] = &[&[0, 4, 8, 7], &[4, 1, 5, 8], &[8, 5, 2, 6], &[7, 8, 6, 3]];

static TRI3: Data = Data {
    name: "tri3",
    nodes: &tri3::VERTICES,
    linear: FacetKind::Tri3,
    pieces: &[&[0, 1, 2]],
    trace: Trace { vertices: &[CORNERS[0], CORNERS[1], CORNERS[2]], facets: &[&[0, 1, 2]] },
    rule: &triangle::THREE,
    vtk: 5,
};

static QUAD4: Data = Data {
    name: "quad4",
    nodes: &quad4::VERTICES,
    linear: FacetKind::Quad4,
    pieces: &[&[0, 1, 2, 3]],
    trace: Trace { vertices: &CORNERS, facets: &[&[0, 1, 2, 3]] },
    rule: &GAUSS_QUAD_2,
    vtk: 9,
};

static TRI6: Data = Data {
    name: "tri6",
    nodes: &TRI,
    linear: FacetKind::Tri3,
    pieces: &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
    trace: Trace {
        vertices: &[
            CORNERS[0],
            CORNERS[1],
            CORNERS[2],
            &[(3, M), (0, E), (1, E)],
            &[(4, M), (1, E), (2, E)],
            &[(5, M), (2, E), (0, E)],
        ],
        facets: &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
    },
    rule: &triangle::SEVEN,
    vtk: 22,
};

static QUAD8: Data = Data {
    name: "quad8",
    nodes: &QUAD_8,
    linear: FacetKind::Quad4,
    pieces: &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[7, 6, 3], &[4, 5, 6, 7]],
    trace: Trace {
        vertices: &[
            CORNERS[0],
            CORNERS[1],
            CORNERS[2],
            CORNERS[3],
            &[(4, M), (0, E), (1, E)],
            &[(5, M), (1, E), (2, E)],
            &[(6, M), (2, E), (3, E)],
            &[(7, M), (3, E), (0, E)],
            &[
                (0, -5.0 / 12.0),
                (1, -5.0 / 12.0),
                (2, -5.0 / 12.0),
                (3, -5.0 / 12.0),
                (4, 2.0 / 3.0),
                (5, 2.0 / 3.0),
                (6, 2.0 / 3.0),
                (7, 2.0 / 3.0),
            ],
        ],
        facets: QUARTERS,
    },
    rule: &GAUSS_QUAD_3,
    vtk: 23,
};

static QUAD9: Data = Data {
    name: "quad9",
    nodes: &QUAD,
    linear: FacetKind::Quad4,
    pieces: QUARTERS,
    trace: Trace {
        vertices: &[
            CORNERS[0],
            CORNERS[1],
            CORNERS[2],
            CORNERS[3],
            &[(4, M), (0, E), (1, E)],
            &[(5, M), (1, E), (2, E)],
            &[(6, M), (2, E), (3, E)],
            &[(7, M), (3, E), (0, E)],
            &[
                (8, M * M),
                (4, M * E),
                (5, M * E),
                (6, M * E),
                (7, M * E),
                (0, E * E),
                (1, E * E),
                (2, E * E),
                (3, E * E),
            ],
        ],
        facets: QUARTERS,
    },
    rule: &GAUSS_QUAD_3,
    vtk: 28,
};

impl FaceKind {
    /// All kinds of faces.
    pub const ALL: [Self; 5] = [Self::Tri3, Self::Quad4, Self::Tri6, Self::Quad8, Self::Quad9];

    fn data(self) -> &'static Data {
        match self {
            Self::Tri3 => &TRI3,
            Self::Quad4 => &QUAD4,
            Self::Tri6 => &TRI6,
            Self::Quad8 => &QUAD8,
            Self::Quad9 => &QUAD9,
        }
    }

    /// The kind's name in messages.
    pub fn name(self) -> &'static str {
        self.data().name
    }

    /// Number of nodes.
    #[inline]
    pub fn node_count(self) -> usize {
        self.data().nodes.len()
    }

    /// Natural coordinates of the nodes.
    pub fn nodes(self) -> &'static [[f64; 2]] {
        self.data().nodes
    }

    /// The linear facet with the same corners; its number of corners is that of the face.
    #[inline]
    pub fn linear(self) -> FacetKind {
        self.data().linear
    }

    /// Number of corners.
    #[inline]
    pub fn corner_count(self) -> usize {
        self.linear().node_count()
    }

    /// True for faces with nodes on their edges.
    #[inline]
    pub fn is_quadratic(self) -> bool {
        self.node_count() > self.corner_count()
    }

    /// True for a quadratic quadrilateral without a node in its centre.
    #[inline]
    pub fn lacks_centre(self) -> bool {
        self.trace().vertices.len() > self.node_count()
    }

    /// Linear facets that the face is divided into, as local nodes: triangles and quadrilaterals with the orientation of the face.
    pub fn pieces(self) -> &'static [&'static [u8]] {
        self.data().pieces
    }

    /// The piecewise linear surface that contact sees of the face.
    ///
    /// Of a linear face it is the face. Of a quadratic one it is made of linear facets whose vertices are combinations of the nodes such that
    /// `sum_v w_vJ int H_v dA = int N_J dA` with the piecewise linear functions `H_v` of the vertices: a uniform pressure on the facets has the nodal forces of the
    /// face, and under the facets lies the volume that lies under the face. In the middle of an edge the vertex is a third of the arch above the node,
    /// `4/3 x_m - (x_a + x_b)/6`, of all kinds alike, so that neighbours fit. The weights of a vertex add up to one and keep linear
    /// functions: forces on vertices that go to the nodes with these weights keep their resultant and their moment.
    #[inline]
    pub fn trace(self) -> Trace {
        self.data().trace
    }

    /// Points and weights: exact for products of a shape function with the normal of a plane face that has straight edges with nodes in their
    /// middles, a parallelogram if it has four; and for a follower pressure on a bilinear face.
    #[inline]
    pub fn rule(self) -> &'static [([f64; 2], f64)] {
        self.data().rule
    }

    /// VTK's number.
    pub fn vtk(self) -> u8 {
        self.data().vtk
    }

    /// The kind with these numbers of corners and nodes.
    pub fn with_nodes(corners: usize, nodes: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.corner_count() == corners && kind.node_count() == nodes)
    }

    /// Shape functions at `xi`.
    pub fn shape(self, xi: [f64; 2]) -> FaceShape {
        self.functions(xi).map(|(n, _)| n)
    }

    /// Gradients of the shape functions at `xi`.
    pub fn shape_gradient(self, xi: [f64; 2]) -> FaceGradient {
        self.functions(xi).map(|(_, dn)| dn)
    }

    /// Functions of the nodes that are linear on the facets of the trace: for what belongs to surfaces and has values at nodes, as pressures of contact. None is negative, they add up to one
    /// and keep linear functions. The middle of a face without a node there has the mean of the nodes on the edges. Of linear faces they are the shape functions.
    pub fn piecewise_shape(self, xi: [f64; 2]) -> FaceShape {
        let nodes = self.nodes();
        // In natural coordinates facets are triangles and parallelograms.
        let place = |v: u8| nodes.get(usize::from(v)).copied().unwrap_or_default();
        // Coordinates along the edges from the first vertex, and how far inside: negative outside.
        let within = |facet: &[u8]| -> ([f64; 2], f64) {
            let [origin, u, v] = [facet[0], facet[1], facet[facet.len() - 1]].map(place);
            let [u, v, x] = [u, v, xi].map(|end| [end[0] - origin[0], end[1] - origin[1]]);
            let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
            let [s, t] = [cross(x, v) / cross(u, v), cross(u, x) / cross(u, v)];
            let inside = if facet.len() == 3 { s.min(t).min(1.0 - s - t) } else { s.min(t).min(1.0 - s).min(1.0 - t) };
            ([s, t], inside)
        };
        let mut out = [0.0; MAX_FACE_NODES];
        let facets = self.trace().facets.iter().map(|facet| (facet, within(facet)));
        let Some((facet, (along, _))) = facets.max_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b)) else { return out };
        let shape = match facet.len() {
            3 => FacetKind::Tri3.shape(along),
            _ => FacetKind::Quad4.shape(along.map(|part| 2.0 * part - 1.0)),
        };
        let (corners, count) = (self.corner_count(), self.node_count());
        for (&v, n) in facet.iter().zip(shape) {
            match usize::from(v) {
                v if v < count => out[v] += n,
                _ => out[corners..count].iter_mut().for_each(|w| *w += n / (count - corners) as f64),
            }
        }
        out
    }

    fn functions(self, xi: [f64; 2]) -> [(f64, [f64; 2]); MAX_FACE_NODES] {
        let mut out = [(0.0, [0.0; 2]); MAX_FACE_NODES];
        match self {
            Self::Tri3 | Self::Quad4 => {
                let (n, dn) = (self.linear().shape(xi), self.linear().shape_gradient(xi));
                for (out, pair) in out.iter_mut().zip(n.into_iter().zip(dn)) {
                    *out = pair;
                }
            }
            Self::Tri6 => {
                let (l, slopes) = (tri3::shape(xi), tri3::shape_gradient());
                for a in 0..3 {
                    let b = (a + 1) % 3;
                    out[a] = (l[a] * (2.0 * l[a] - 1.0), slopes[a].map(|s| (4.0 * l[a] - 1.0) * s));
                    let dn = std::array::from_fn(|d| 4.0 * (l[a] * slopes[b][d] + l[b] * slopes[a][d]));
                    out[3 + a] = (4.0 * l[a] * l[b], dn);
                }
            }
            Self::Quad8 => {
                for (out, v) in out.iter_mut().zip(QUAD_8) {
                    let p = [1.0 + xi[0] * v[0], 1.0 + xi[1] * v[1]];
                    *out = match v.iter().position(|&c| c == 0.0) {
                        None => {
                            let last = p[0] + p[1] - 3.0;
                            let dn = [0.25 * v[0] * p[1] * (last + p[0]), 0.25 * v[1] * p[0] * (last + p[1])];
                            (0.25 * p[0] * p[1] * last, dn)
                        }
                        Some(along) => {
                            let across = 1 - along;
                            let bubble = 0.5 * (1.0 - xi[along] * xi[along]);
                            let mut dn = [0.0; 2];
                            dn[along] = -xi[along] * p[across];
                            dn[across] = bubble * v[across];
                            (bubble * p[across], dn)
                        }
                    };
                }
            }
            Self::Quad9 => {
                let lines = xi.map(crate::line::line);
                for (out, v) in out.iter_mut().zip(QUAD) {
                    let at = |a: usize| {
                        lines[a][if v[a] < 0.0 {
                            0
                        } else if v[a] > 0.0 {
                            1
                        } else {
                            2
                        }]
                    };
                    let (f, g) = (at(0), at(1));
                    *out = (f[0] * g[0], [f[1] * g[0], f[0] * g[1]]);
                }
            }
        }
        out
    }
}

impl std::fmt::Display for FaceKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Nodes of a face by number, in the order of its kind. A slice of [`FaceKind::node_count`] numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FaceNodes {
    kind: FaceKind,
    /// The first number again beyond the nodes of the kind.
    nodes: [u32; MAX_FACE_NODES],
}

impl FaceNodes {
    /// Nodes from the number of each.
    pub fn from_fn(kind: FaceKind, mut node: impl FnMut(usize) -> u32) -> Self {
        let mut nodes = [node(0); MAX_FACE_NODES];
        for (k, n) in nodes[..kind.node_count()].iter_mut().enumerate().skip(1) {
            *n = node(k);
        }
        Self { kind, nodes }
    }

    /// The kind of the face.
    #[inline]
    pub fn kind(&self) -> FaceKind {
        self.kind
    }

    /// The corners.
    #[inline]
    pub fn corners(&self) -> &[u32] {
        &self.nodes[..self.kind.corner_count()]
    }

    /// The linear facet on the corners.
    pub fn linear(&self) -> FacetNodes {
        Nodal::from_fn(self.kind.linear(), |k| self.nodes[k])
    }

    /// The linear facets that the face is divided into; the face itself if it is linear.
    pub fn pieces(&self) -> impl Iterator<Item = FacetNodes> + '_ {
        self.kind.pieces().iter().map(|piece| {
            let kind = if piece.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
            Nodal::from_fn(kind, |k| self.nodes[usize::from(piece[k])])
        })
    }

    /// The face with other node numbers: `f` of each.
    pub fn map(&self, mut f: impl FnMut(u32) -> u32) -> Self {
        Self::from_fn(self.kind, |k| f(self.nodes[k]))
    }
}

impl Deref for FaceNodes {
    type Target = [u32];
    #[inline]
    fn deref(&self) -> &[u32] {
        &self.nodes[..self.kind.node_count()]
    }
}

impl From<FacetNodes> for FaceNodes {
    fn from(nodes: FacetNodes) -> Self {
        let kind = match nodes.kind() {
            FacetKind::Tri3 => FaceKind::Tri3,
            FacetKind::Quad4 => FaceKind::Quad4,
        };
        Self::from_fn(kind, |k| nodes[k])
    }
}

impl From<[u32; 4]> for FaceNodes {
    fn from(nodes: [u32; 4]) -> Self {
        Self::from_fn(FaceKind::Quad4, |k| nodes[k])
    }
}

impl From<[u32; 3]> for FaceNodes {
    fn from(nodes: [u32; 3]) -> Self {
        Self::from_fn(FaceKind::Tri3, |k| nodes[k])
    }
}
