//! Multiplier spaces on a slave facet.

use crate::faces::FaceBlock;
use crate::local::{FacetMatrix, NodeMatrix, NodeVector, matrix};
use crate::{FacetIntegrals, PairIntegrals};
use nalgebra::SymmetricEigen;
use stoss_reference_element::MAX_NODES;

/// Which functions the multipliers are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MultiplierSpace {
    /// The slave's shape functions: `D` couples the nodes of a facet.
    #[default]
    Standard,
    /// Functions biorthogonal to the slave's shape functions on the covered part: `D` is diagonal.
    Dual,
}

/// Below this smallest eigenvalue of the scaled mass matrix (1/9 for a parallelogram that is wholly covered, 1/4 for a triangle) dual
/// functions would be larger than 1e7 and their integrals lose all digits.
const SMALLEST_EIGENVALUE: f64 = 1e-7;

/// Multiplier functions `phi_A = sum_i C_Ai N_i` of one facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiplierBasis {
    /// Coefficients `C_Ai`: row the multiplier, column the shape function.
    pub coefficients: FacetMatrix,
    /// Whether the facet is covered too little for dual functions: standard functions, lumped `D`.
    pub lumped: bool,
    diagonal: bool,
    inverse_mass: NodeMatrix,
}

fn rows(m: &NodeMatrix) -> FacetMatrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}

impl MultiplierBasis {
    /// The functions of a facet with these integrals.
    pub fn new(space: MultiplierSpace, integrals: &FacetIntegrals) -> Self {
        let standard = |diagonal| Self {
            coefficients: rows(&NodeMatrix::identity()),
            lumped: diagonal,
            diagonal,
            inverse_mass: NodeMatrix::zeros(),
        };
        if space == MultiplierSpace::Standard {
            return standard(false);
        }
        // Scaled to unit row sums of the constant: the eigenvalues tell how well the functions are distinguished.
        let nodes = integrals.kind.node_count();
        if integrals.shape[..nodes].iter().any(|s| s.is_nan() || *s <= 0.0) {
            return standard(true);
        }
        let scale = NodeVector::from_fn(|i, _| if i < nodes { 1.0 / integrals.shape[i].sqrt() } else { 0.0 });
        let mass = matrix(&integrals.mass);
        // Where there is no node a row of the identity, which gives no information and drops out again.
        let absent = |i: usize, j: usize| if i == j && i >= nodes { 1.0 } else { 0.0 };
        let scaled = NodeMatrix::from_fn(|i, j| scale[i] * mass[(i, j)] * scale[j] + absent(i, j));
        let eigen = SymmetricEigen::new(scaled).eigenvalues;
        let smallest = eigen.iter().fold(f64::INFINITY, |m: f64, &e| m.min(e));
        let inverse = (smallest > SMALLEST_EIGENVALUE).then(|| scaled.try_inverse()).flatten();
        let Some(inverse) = inverse else { return standard(true) };
        let inverse_mass = NodeMatrix::from_fn(|i, j| scale[i] * inverse[(i, j)] * scale[j]);
        let c = NodeMatrix::from_fn(|i, j| integrals.shape[i] * inverse_mass[(i, j)]);
        Self { coefficients: rows(&c), lumped: false, diagonal: true, inverse_mass }
    }

    /// Whether `D` is diagonal: dual or lumped.
    pub fn is_diagonal(&self) -> bool {
        self.diagonal
    }

    /// `phi_A` at a point with shape functions `shape`.
    pub fn values(&self, shape: &[f64; MAX_NODES]) -> [f64; MAX_NODES] {
        self.coefficients.map(|c| (0..MAX_NODES).map(|i| c[i] * shape[i]).sum())
    }

    /// `D_AJ = int phi_A N_J dA`. On a linear facet with dual and lumped functions diagonal, `int phi_A dA` as the row sums of
    /// [`MultiplierBasis::master_block`], with which they have to agree even where dual functions are large.
    pub fn slave_block(&self, integrals: &FacetIntegrals) -> FaceBlock {
        let c = matrix(&self.coefficients);
        if !self.diagonal {
            return FaceBlock::of(&integrals.mass, integrals.face.as_ref()).after(&c);
        }
        let mut sums = [0.0; MAX_NODES];
        for pair in &integrals.pairs {
            let block = self.master_block(pair);
            sums.iter_mut().enumerate().for_each(|(a, sum)| *sum += block.sum_of_row(a));
        }
        match &integrals.face {
            None => FaceBlock::Linear(NodeMatrix::from_diagonal(&NodeVector::from(sums))),
            Some(face) => FaceBlock::of(&integrals.mass, Some(face)).after(&c).with_row_sums(&sums),
        }
    }

    /// `M_AK = int phi_A N_K^(2) dA` of a pair.
    pub fn master_block(&self, pair: &PairIntegrals) -> FaceBlock {
        pair.block().after(&matrix(&self.coefficients))
    }

    /// `d C` for variations of `int N_i` and `int N_i N_j` over the whole covered part: `dC = (diag(d shape) - C d
    /// mass) mass^-1`. Zero for standard and lumped functions.
    pub fn coefficient_variation(&self, shape: &[f64; MAX_NODES], mass: &FacetMatrix) -> FacetMatrix {
        let diagonal = NodeMatrix::from_diagonal(&NodeVector::from(*shape));
        rows(&((diagonal - matrix(&self.coefficients) * matrix(mass)) * self.inverse_mass))
    }
}
