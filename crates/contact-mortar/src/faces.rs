//! The faces behind the facets of a surface: facets say where a point is, faces what its position is (theory/mortar#faces).

use crate::local::{FacetMatrix, NodeMatrix, NodeVector, matrix};
use nalgebra::SMatrix;
use stoss_contact::{ContactError, ContactSurface};
use stoss_reference_element::{FacePiece, FacetNodes, MAX_FACE_NODES, MAX_NODES};

/// Quadratic faces that the facets of a surface are pieces of. Empty if all facets are linear faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faces(Vec<FacePiece>);

impl Faces {
    /// The faces from their pieces, in the order of the facets of the surface.
    pub fn new(pieces: &[FacePiece]) -> Self {
        let is_quadratic = pieces.iter().any(|piece| piece.face().kind().is_quadratic());
        Self(if is_quadratic { pieces.to_vec() } else { Vec::new() })
    }

    /// The contact surface of these facets, with their faces. `side` is for messages.
    pub(crate) fn surface<F: Copy + Into<FacePiece>>(
        side: &'static str,
        facets: &[F],
        reference: &[f64],
    ) -> Result<(ContactSurface, Self), ContactError> {
        let pieces: Vec<FacePiece> = facets.iter().map(|&facet| facet.into()).collect();
        let facets: Vec<FacetNodes> = pieces.iter().map(FacePiece::facet).collect();
        Ok((ContactSurface::new(side, &facets, reference)?, Self::new(&pieces)))
    }

    /// Quadratic faces that the facets are pieces of, in their order; empty if all are linear.
    pub(crate) fn pieces(&self) -> &[FacePiece] {
        &self.0
    }

    /// Whether all facets are linear faces.
    pub(crate) fn are_linear(&self) -> bool {
        self.0.is_empty()
    }

    /// The quadratic face that a facet (local number) is a piece of; `None` of a linear one.
    pub fn of(&self, facet: u32) -> Option<&FacePiece> {
        self.0.get(facet as usize).filter(|piece| piece.face().kind().is_quadratic())
    }

    /// Global nodes that positions of points of a facet are made of: those of its face.
    pub(crate) fn nodes<'a>(&'a self, surface: &'a ContactSurface, facet: u32) -> &'a [u32] {
        match self.of(facet) {
            Some(piece) => piece.face_nodes(),
            None => &surface.facets()[facet as usize],
        }
    }

    /// Puts corners that are no nodes of their faces where the nodes say.
    pub(crate) fn follow(&self, q: &mut [f64]) {
        for piece in &self.0 {
            let nodes = piece.face_nodes();
            for (corner, node) in piece.facet().iter().enumerate().filter(|(_, node)| !nodes.contains(node)) {
                let shape = piece.face().kind().shape(piece.corners()[corner]);
                let sum = |i: usize| nodes.iter().zip(shape).map(|(&n, w)| w * q[3 * n as usize + i]).sum::<f64>();
                let x: [f64; 3] = std::array::from_fn(sum);
                q[3 * *node as usize..][..3].copy_from_slice(&x);
            }
        }
    }
}

/// Matrix over the nodes of a facet and those of a face; zero where there is no node.
pub type FaceMatrix = [[f64; MAX_FACE_NODES]; MAX_NODES];

type WideMatrix = SMatrix<f64, MAX_NODES, MAX_FACE_NODES>;

/// Integrals of the products of functions on a slave facet (rows) with those of the nodes that positions are made of (columns): the nodes of a linear facet, or of a
/// quadratic face.
#[derive(Clone, Copy, Debug)]
pub enum FaceBlock {
    /// Integrals of a linear facet.
    Linear(SMatrix<f64, MAX_NODES, MAX_NODES>),
    /// Integrals of a quadratic face.
    Quadratic(SMatrix<f64, MAX_NODES, MAX_FACE_NODES>),
}

impl FaceBlock {
    /// The integrals of the face if there is one, else of the facet.
    pub(crate) fn of(facet: &FacetMatrix, face: Option<&FaceMatrix>) -> Self {
        match face {
            Some(face) => Self::Quadratic(WideMatrix::from_fn(|i, j| face[i][j])),
            None => Self::Linear(matrix(facet)),
        }
    }

    /// The integrals of a quadratic face, from its entries.
    pub(crate) fn quadratic(entry: impl Fn(usize, usize) -> f64) -> Self {
        Self::Quadratic(WideMatrix::from_fn(entry))
    }

    /// `left` times the block.
    pub(crate) fn after(&self, left: &NodeMatrix) -> Self {
        match self {
            Self::Linear(m) => Self::Linear(left * m),
            Self::Quadratic(m) => Self::Quadratic(left * m),
        }
    }

    /// The sum of two blocks of the same nodes.
    pub(crate) fn plus(self, other: &Self) -> Self {
        match (self, other) {
            (Self::Linear(a), Self::Linear(b)) => Self::Linear(a + b),
            (Self::Quadratic(a), Self::Quadratic(b)) => Self::Quadratic(a + b),
            (a, _) => a,
        }
    }

    /// Sums of the rows.
    pub(crate) fn row_sums(&self) -> NodeVector {
        match self {
            Self::Linear(m) => m.column_sum(),
            Self::Quadratic(m) => m.column_sum(),
        }
    }

    /// Sum of a row.
    pub fn sum_of_row(&self, row: usize) -> f64 {
        match self {
            Self::Linear(m) => (0..MAX_NODES).map(|k| m[(row, k)]).sum(),
            Self::Quadratic(m) => (0..MAX_FACE_NODES).map(|k| m[(row, k)]).sum(),
        }
    }

    /// The integrals with rows that add up to these numbers to the last digit, from which they differ by round-off: what is missing goes to the largest entry.
    pub(crate) fn with_row_sums(mut self, sums: &[f64; MAX_NODES]) -> Self {
        if let Self::Quadratic(m) = &mut self {
            for (a, sum) in sums.iter().enumerate() {
                let missing = sum - (0..MAX_FACE_NODES).map(|k| m[(a, k)]).sum::<f64>();
                let largest = (0..MAX_FACE_NODES).fold(0, |l, k| if m[(a, k)].abs() > m[(a, l)].abs() { k } else { l });
                m[(a, largest)] += missing;
            }
        }
        self
    }

    /// Adds multiples of the entries of the first `rows` rows and `nodes` nodes: to entry `(a, k)` of `out` at the place `at(a, k)`.
    #[inline]
    pub(crate) fn add_to(
        &self,
        [rows, nodes]: [usize; 2],
        factor: f64,
        at: impl Fn(usize, usize) -> usize,
        out: &mut [f64],
    ) {
        match self {
            Self::Linear(m) => {
                for a in 0..rows {
                    (0..nodes).for_each(|k| out[at(a, k)] += factor * m[(a, k)]);
                }
            }
            Self::Quadratic(m) => {
                for a in 0..rows {
                    (0..nodes).for_each(|k| out[at(a, k)] += factor * m[(a, k)]);
                }
            }
        }
    }

    /// Entry of a row and a node.
    #[inline]
    pub fn at(&self, row: usize, node: usize) -> f64 {
        match self {
            Self::Linear(m) => m[(row, node)],
            Self::Quadratic(m) => m[(row, node)],
        }
    }
}
