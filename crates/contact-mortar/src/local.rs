//! Matrices and vectors over the nodes of a facet.

use nalgebra::{SMatrix, SVector};
use stoss_reference_element::MAX_NODES;

/// Matrix over the nodes of two facets; zero where there is no node.
pub type FacetMatrix = [[f64; MAX_NODES]; MAX_NODES];

/// Matrix and vector over the nodes of a facet; zero where there is no node.
pub(crate) type NodeMatrix = SMatrix<f64, MAX_NODES, MAX_NODES>;
pub(crate) type NodeVector = SVector<f64, MAX_NODES>;

pub(crate) fn matrix(m: &FacetMatrix) -> NodeMatrix {
    NodeMatrix::from_fn(|i, j| m[i][j])
}

pub(crate) fn rows_of(m: &NodeMatrix) -> FacetMatrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}
