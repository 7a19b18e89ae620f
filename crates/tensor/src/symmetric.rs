//! Symmetric second-order tensors.

use crate::{INDEX_PAIRS, Tensor2, components};
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A symmetric second-order tensor: plain components 11, 22, 33, 12, 23, 13 (shears not doubled).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SymmetricTensor2(pub [f64; 6]);

impl SymmetricTensor2 {
    /// The unit tensor.
    pub const IDENTITY: Self = Self([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    /// The zero tensor.
    pub const ZERO: Self = Self([0.0; 6]);

    /// The tensor from plain components in the order 11, 22, 33, 12, 23, 13.
    #[inline]
    pub const fn from_components(components: [f64; 6]) -> Self {
        Self(components)
    }

    /// Plain components in the order 11, 22, 33, 12, 23, 13.
    #[inline]
    pub const fn to_components(self) -> [f64; 6] {
        self.0
    }

    /// Components in the same order with doubled shears (engineering strains), so that the product with the plain components of a stress is the double contraction.
    #[inline]
    pub fn with_doubled_shears(self) -> [f64; 6] {
        let [a, b, c, d, e, f] = self.0;
        [a, b, c, 2.0 * d, 2.0 * e, 2.0 * f]
    }

    /// The symmetric part of a matrix.
    #[inline]
    pub fn from_matrix(m: &Tensor2) -> Self {
        Self(INDEX_PAIRS.map(|(i, j)| if i == j { m[(i, i)] } else { 0.5 * (m[(i, j)] + m[(j, i)]) }))
    }

    /// The tensor as a full matrix.
    #[inline]
    pub fn to_matrix(self) -> Tensor2 {
        let [xx, yy, zz, xy, yz, xz] = self.0;
        Tensor2::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// `C = F^T F`.
    #[inline]
    pub fn right_cauchy_green(deformation_gradient: &Tensor2) -> Self {
        let f = deformation_gradient;
        Self(INDEX_PAIRS.map(|(i, j)| f[(0, i)] * f[(0, j)] + f[(1, i)] * f[(1, j)] + f[(2, i)] * f[(2, j)]))
    }

    /// First invariant, the trace `a_ii`.
    #[inline]
    pub fn trace(&self) -> f64 {
        components::trace(&self.0)
    }

    /// Third invariant, the determinant.
    #[inline]
    pub fn det(&self) -> f64 {
        components::determinant(self.0)
    }

    /// Inverse, given the determinant (which must not be zero).
    #[inline]
    pub fn inverse_with_det(&self, det: f64) -> Self {
        Self(components::inverse(self.0, det))
    }

    /// Inverse; infinite or NaN if singular.
    #[inline]
    pub fn inverse(&self) -> Self {
        self.inverse_with_det(self.det())
    }

    /// `a : b = a_ij b_ij`.
    #[inline]
    pub fn double_contract(&self, other: &Self) -> f64 {
        components::double_contraction(&self.0, &other.0)
    }

    /// Frobenius norm `sqrt(a : a)`.
    #[inline]
    pub fn norm(&self) -> f64 {
        self.double_contract(self).sqrt()
    }

    /// `a a`.
    #[inline]
    pub fn square(&self) -> Self {
        let m = self.to_matrix();
        Self::from_matrix(&(m * m))
    }

    /// Second invariant `(tr(a)^2 - tr(a^2))/2`.
    #[inline]
    pub fn i2(&self) -> f64 {
        components::second(self.0)
    }

    /// True if no component is infinite or NaN.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }

    /// `Q a Q^T`.
    #[inline]
    pub fn rotated(&self, rotation: &Tensor2) -> Self {
        Self::from_matrix(&(rotation * self.to_matrix() * rotation.transpose()))
    }
}

impl Add for SymmetricTensor2 {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl AddAssign for SymmetricTensor2 {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for SymmetricTensor2 {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Neg for SymmetricTensor2 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Mul<f64> for SymmetricTensor2 {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| factor * x))
    }
}

impl Mul<SymmetricTensor2> for f64 {
    type Output = SymmetricTensor2;
    #[inline]
    fn mul(self, tensor: SymmetricTensor2) -> SymmetricTensor2 {
        tensor * self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tensor() -> impl Strategy<Value = SymmetricTensor2> {
        proptest::array::uniform6(-2.0..2.0_f64).prop_map(SymmetricTensor2)
    }

    proptest! {
        #[test]
        fn agrees_with_the_full_matrix(a in tensor(), b in tensor()) {
            let (ma, mb) = (a.to_matrix(), b.to_matrix());
            prop_assert!((a.det() - ma.determinant()).abs() < 1e-13);
            prop_assert!((a.double_contract(&b) - (ma * mb).trace()).abs() < 1e-13);
            prop_assert!((a.i2() - 0.5 * (ma.trace().powi(2) - (ma * ma).trace())).abs() < 1e-12);
            prop_assert!((a.square().to_matrix() - ma * ma).norm() < 1e-12);
            prop_assert!((a.norm() - ma.norm()).abs() < 1e-13);
            prop_assert_eq!(SymmetricTensor2::from_matrix(&ma), a);
            if a.det().abs() > 0.1 {
                prop_assert!((ma * a.inverse().to_matrix() - Tensor2::identity()).norm() < 1e-10);
            }
        }

        #[test]
        fn right_cauchy_green_is_the_product(f in proptest::array::uniform9(-2.0..2.0_f64)) {
            let f = Tensor2::from_column_slice(&f);
            prop_assert!((SymmetricTensor2::right_cauchy_green(&f).to_matrix() - f.transpose() * f).norm() < 1e-13);
        }
    }
}
