//! Matrices at a point, and at several points side by side.

use stoss_continuum::wide::{LANES, Several, Simd, Wide};

/// A 3x3 matrix, `[row][column]`.
pub type Matrix3 = [[f64; 3]; 3];

/// A 3x3 matrix at each of [`LANES`] points, `[row][column][point]`.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Matrices(pub [[Several; 3]; 3]);

impl Matrices {
    pub const ZERO: Self = Self([[[0.0; LANES]; 3]; 3]);

    /// The matrix of a point.
    #[inline(always)]
    pub fn get(&self, point: usize) -> Matrix3 {
        let mut out = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                out[i][j] = self.0[i][j][point];
            }
        }
        out
    }

    /// Replaces the matrix of a point.
    #[inline(always)]
    pub fn set(&mut self, point: usize, matrix: &Matrix3) {
        for i in 0..3 {
            for j in 0..3 {
                self.0[i][j][point] = matrix[i][j];
            }
        }
    }

    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, part: usize) -> [[Wide<S>; 3]; 3] {
        let mut out = [[Wide::splat(simd, 0.0); 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                out[i][j] = Wide::load(simd, &self.0[i][j], part);
            }
        }
        out
    }
}
