//! Multiplier spaces on a slave facet.

use crate::FacetIntegrals;
use nalgebra::{Matrix4, SymmetricEigen, Vector4};

/// Which functions the multipliers are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MultiplierSpace {
    /// The slave's shape functions: `D` couples the nodes of a facet.
    #[default]
    Standard,
    /// Functions biorthogonal to the slave's shape functions on the covered part: `D` is diagonal.
    Dual,
}

/// Below this smallest eigenvalue of the scaled mass matrix (1/9 for a parallelogram that is wholly covered) dual
/// functions would be larger than 1e7 and their integrals lose all digits.
const SMALLEST_EIGENVALUE: f64 = 1e-7;

/// Multiplier functions `phi_A = sum_i C_Ai N_i` of one facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiplierBasis {
    /// Coefficients `C_Ai`: row the multiplier, column the shape function.
    pub coefficients: [[f64; 4]; 4],
    /// Whether the facet is covered too little for dual functions: standard functions, lumped `D`.
    pub lumped: bool,
    diagonal: bool,
    inverse_mass: Matrix4<f64>,
}

fn rows(m: &Matrix4<f64>) -> [[f64; 4]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}

fn matrix(m: &[[f64; 4]; 4]) -> Matrix4<f64> {
    Matrix4::from_fn(|i, j| m[i][j])
}

impl MultiplierBasis {
    /// The functions of a facet with these integrals.
    pub fn new(space: MultiplierSpace, integrals: &FacetIntegrals) -> Self {
        let standard = |diagonal| Self {
            coefficients: rows(&Matrix4::identity()),
            lumped: diagonal,
            diagonal,
            inverse_mass: Matrix4::zeros(),
        };
        if space == MultiplierSpace::Standard {
            return standard(false);
        }
        // Scaled to unit row sums of the constant: the eigenvalues tell how well the functions are told apart.
        if integrals.shape.iter().any(|s| s.is_nan() || *s <= 0.0) {
            return standard(true);
        }
        let scale = Vector4::from(integrals.shape).map(|s| 1.0 / s.sqrt());
        let mass = matrix(&integrals.mass);
        let scaled = Matrix4::from_fn(|i, j| scale[i] * mass[(i, j)] * scale[j]);
        let eigen = SymmetricEigen::new(scaled).eigenvalues;
        let smallest = eigen.iter().fold(f64::INFINITY, |m: f64, &e| m.min(e));
        let inverse = (smallest > SMALLEST_EIGENVALUE).then(|| scaled.try_inverse()).flatten();
        let Some(inverse) = inverse else { return standard(true) };
        let inverse_mass = Matrix4::from_fn(|i, j| scale[i] * inverse[(i, j)] * scale[j]);
        let c = Matrix4::from_fn(|i, j| integrals.shape[i] * inverse_mass[(i, j)]);
        Self { coefficients: rows(&c), lumped: false, diagonal: true, inverse_mass }
    }

    /// Whether `D` is diagonal: dual or lumped.
    pub fn is_diagonal(&self) -> bool {
        self.diagonal
    }

    /// `phi_A` at a point with shape functions `shape`.
    pub fn values(&self, shape: &[f64; 4]) -> [f64; 4] {
        self.coefficients.map(|c| (0..4).map(|i| c[i] * shape[i]).sum())
    }

    /// `D_AJ = int phi_A N_J dA`. Dual and lumped: diagonal, `int phi_A dA` as the row sums of
    /// [`MultiplierBasis::master_block`], with which they have to agree even where dual functions are large.
    pub fn slave_block(&self, integrals: &FacetIntegrals) -> [[f64; 4]; 4] {
        if !self.diagonal {
            return rows(&(matrix(&self.coefficients) * matrix(&integrals.mass)));
        }
        let mut d = [[0.0; 4]; 4];
        for pair in &integrals.pairs {
            for (a, row) in self.master_block(&pair.coupling).iter().enumerate() {
                d[a][a] += row.iter().sum::<f64>();
            }
        }
        d
    }

    /// `M_AK = int phi_A N_K^(2) dA` from `int N_i N_K^(2) dA` of a pair.
    pub fn master_block(&self, coupling: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
        rows(&(matrix(&self.coefficients) * matrix(coupling)))
    }

    /// `d C` for variations of `int N_i` and `int N_i N_j` over the whole covered part: `dC = (diag(d shape) - C d
    /// mass) mass^-1`. Zero for standard and lumped functions.
    pub fn coefficient_variation(&self, shape: &[f64; 4], mass: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
        let diagonal = Matrix4::from_diagonal(&Vector4::from(*shape));
        rows(&((diagonal - matrix(&self.coefficients) * matrix(mass)) * self.inverse_mass))
    }
}
