//! Fourth-order tensors with minor symmetries.

use crate::{INDEX_PAIRS, SymmetricTensor2, components};
use std::ops::{Add, Mul};

/// A fourth-order tensor with both minor symmetries (`C_ijkl = C_jikl = C_ijlk`), major symmetry not assumed.
///
/// Entry `[a][b]` is the plain component `C_ijkl`, `a = (ij)`, `b = (kl)` in the order 11, 22, 33, 12, 23, 13; no factor is
/// hidden in the shear rows or columns. Hence `stress_v = C strain_v`, the 6x6 product, holds with plain stresses
/// (`S_11 .. S_12 ..`) and strains with doubled shears (`E_11 .. 2 E_12 ..`): the sum over `kl` meets each shear twice.
/// A derivative by *stored* plain components, `d S_ij / d E_12` with `E_12 = E_21` changed together, is `2 C_ij12`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tensor4(pub [[f64; 6]; 6]);

impl Tensor4 {
    /// The zero tensor.
    pub const ZERO: Self = Self([[0.0; 6]; 6]);

    /// The tensor from plain components.
    pub fn from_fn(component: impl Fn(usize, usize, usize, usize) -> f64) -> Self {
        Self(INDEX_PAIRS.map(|(i, j)| INDEX_PAIRS.map(|(k, l)| component(i, j, k, l))))
    }

    /// `1 (x) 1`: `delta_ij delta_kl`.
    pub fn identity_dyad() -> Self {
        Self::dyad(&SymmetricTensor2::IDENTITY, &SymmetricTensor2::IDENTITY)
    }

    /// Symmetric unit tensor `S_ijkl = (delta_ik delta_jl + delta_il delta_jk)/2`.
    pub const fn symmetric_identity() -> Self {
        let mut s = [[0.0; 6]; 6];
        let mut a = 0;
        while a < 6 {
            s[a][a] = if a < 3 { 1.0 } else { 0.5 };
            a += 1;
        }
        Self(s)
    }

    /// `a (x) b`: `a_ij b_kl`.
    #[inline]
    pub fn dyad(a: &SymmetricTensor2, b: &SymmetricTensor2) -> Self {
        Self(a.0.map(|x| b.0.map(|y| x * y)))
    }

    /// `-(A_ik A_jl + A_il A_jk)/2`. With `A = C^-1` this is `d C^-1 / d C` (theory/kinematics#eq-identities).
    #[inline]
    pub fn inverse_derivative(inverse: &SymmetricTensor2) -> Self {
        let mut c = [[0.0; 6]; 6];
        for a in 0..6 {
            for b in a..6 {
                c[a][b] = components::inverse_derivative(&inverse.0, a, b);
                c[b][a] = c[a][b];
            }
        }
        Self(c)
    }

    /// Adds `factor * other`.
    #[inline]
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        for (row, other) in self.0.iter_mut().zip(&other.0) {
            for (x, y) in row.iter_mut().zip(other) {
                *x += factor * y;
            }
        }
    }

    /// Adds `factor * a (x) b`.
    #[inline]
    pub fn add_dyad(&mut self, factor: f64, a: &SymmetricTensor2, b: &SymmetricTensor2) {
        for (row, x) in self.0.iter_mut().zip(&a.0) {
            for (entry, y) in row.iter_mut().zip(&b.0) {
                *entry += factor * x * y;
            }
        }
    }

    /// `C : e`.
    #[inline]
    pub fn double_contract_right(&self, e: &SymmetricTensor2) -> SymmetricTensor2 {
        let v = e.with_doubled_shears();
        SymmetricTensor2(self.0.map(|row| row.iter().zip(&v).map(|(c, x)| c * x).sum()))
    }

    /// `e : C`.
    #[inline]
    pub fn double_contract_left(&self, e: &SymmetricTensor2) -> SymmetricTensor2 {
        let v = e.with_doubled_shears();
        let mut out = [0.0; 6];
        for (row, x) in self.0.iter().zip(&v) {
            for (o, c) in out.iter_mut().zip(row) {
                *o += x * c;
            }
        }
        SymmetricTensor2(out)
    }

    /// `C_klij`.
    pub fn major_transpose(&self) -> Self {
        Self(std::array::from_fn(|a| std::array::from_fn(|b| self.0[b][a])))
    }

    /// True if no component is infinite or NaN.
    #[inline]
    pub fn is_finite(&self) -> bool {
        // Without a branch an entry.
        self.0.as_flattened().iter().fold(true, |finite, x| finite & x.is_finite())
    }

    /// Largest magnitude of a component; NaN is ignored.
    pub fn max_abs(&self) -> f64 {
        self.0.iter().flatten().fold(0.0, |m, x| m.max(x.abs()))
    }
}

impl Add for Tensor4 {
    type Output = Self;
    #[inline]
    fn add(mut self, other: Self) -> Self {
        self.add_scaled(1.0, &other);
        self
    }
}

impl Mul<f64> for Tensor4 {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|row| row.map(|x| factor * x)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn symmetric_identity_maps_to_itself() {
        let e = SymmetricTensor2([1.0, -2.0, 0.5, 0.25, 3.0, -1.0]);
        assert_eq!(Tensor4::symmetric_identity().double_contract_right(&e), e);
        assert_eq!(Tensor4::identity_dyad().double_contract_right(&e), SymmetricTensor2::IDENTITY * e.trace());
    }

    #[test]
    fn finite_or_not() {
        let mut t = Tensor4::symmetric_identity();
        assert!(t.is_finite());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            t.0[4][2] = bad;
            assert!(!t.is_finite());
        }
    }

    proptest! {
        #[test]
        fn product_of_components_is_the_double_contraction(c in proptest::collection::vec(-1.0..1.0_f64, 81), e in proptest::array::uniform6(-1.0..1.0_f64)) {
            // Against the sum over all nine pairs of a tensor with minor symmetries and no other.
            let full = |i: usize, j: usize, k: usize, l: usize| {
                let (i, j, k, l) = (i.min(j), i.max(j), k.min(l), k.max(l));
                c[27 * i + 9 * j + 3 * k + l]
            };
            let t = Tensor4::from_fn(full);
            let e = SymmetricTensor2(e);
            let m = e.to_matrix();
            let sum = |component: &dyn Fn(usize, usize, usize, usize) -> f64| {
                SymmetricTensor2(INDEX_PAIRS.map(|(i, j)| {
                    (0..9).map(|n| component(i, j, n / 3, n % 3) * m[(n / 3, n % 3)]).sum()
                }))
            };
            prop_assert!((t.double_contract_right(&e) - sum(&full)).norm() < 1e-13);
            prop_assert!((t.double_contract_left(&e) - sum(&|i, j, k, l| full(k, l, i, j))).norm() < 1e-13);
            prop_assert!((t.major_transpose().double_contract_right(&e) - t.double_contract_left(&e)).norm() < 1e-13);
        }

        #[test]
        fn inverse_derivative_is_the_derivative(v in proptest::array::uniform6(-0.3..0.3_f64), d in proptest::array::uniform6(-1.0..1.0_f64)) {
            let c = SymmetricTensor2::IDENTITY + SymmetricTensor2(v);
            let d = SymmetricTensor2(d);
            let h = 1e-5;
            let difference = ((c + d * h).inverse() - (c - d * h).inverse()) * (0.5 / h);
            let exact = Tensor4::inverse_derivative(&c.inverse()).double_contract_right(&d);
            prop_assert!((difference - exact).norm() < 1e-6 * (1.0 + exact.norm()));
        }

        #[test]
        fn left_and_right_agree_with_components(a in proptest::array::uniform6(-1.0..1.0_f64), b in proptest::array::uniform6(-1.0..1.0_f64), e in proptest::array::uniform6(-1.0..1.0_f64)) {
            let (a, b, e) = (SymmetricTensor2(a), SymmetricTensor2(b), SymmetricTensor2(e));
            let t = Tensor4::dyad(&a, &b);
            prop_assert!((t.double_contract_right(&e) - a * b.double_contract(&e)).norm() < 1e-13);
            prop_assert!((t.double_contract_left(&e) - b * a.double_contract(&e)).norm() < 1e-13);
            prop_assert_eq!(t.major_transpose(), Tensor4::dyad(&b, &a));
        }
    }
}
