//! Energies of the change of volume: the split of a law, the discrete gradient of `J` (theory/elements#gradient). Not the averages of elements.

use crate::{HyperelasticLaw, SymmetricTensor2, Tensor4};
use std::sync::Arc;

/// A law as the sum `W(C) + U(J)` of a part that stays moderate when the law becomes incompressible, and an energy of the change of volume with the rest.
#[derive(Clone, Debug)]
pub struct VolumetricSplit {
    /// `W`. Need not be a law on its own: its stress is that of the law at `J = 1`.
    pub rest: Arc<dyn HyperelasticLaw>,
    /// `U`.
    pub volume: Arc<dyn VolumetricEnergy>,
}

/// An energy `U(J)` of the change of volume, per reference volume, for `J > 0`. Pure functions, called from several threads.
pub trait VolumetricEnergy: std::fmt::Debug + Send + Sync {
    /// `U(J)`, zero at 1.
    fn energy(&self, j: f64) -> f64;
    /// The pressure `U'(J)` (a stress, positive in tension) and `U''(J)`.
    fn pressure(&self, j: f64) -> (f64, f64);
    /// `p = (U(b) - U(a)) / (b - a)`, and its derivative by `b`, to round-off also for `a = b`, where they are `U'` and `U''/2`.
    fn divided_difference(&self, a: f64, b: f64) -> (f64, f64);
}

/// `(ln b - ln a) / (b - a)` and its derivative by `b`, without a difference of logarithms: with `r = (b - a)/(a + b)` it is
/// `2 atanh(r) / (r (a + b))`. For positive `a` and `b`.
pub fn logarithm_divided_difference(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let r = (b - a) / sum;
    let s = r * r;
    // Both are exact to round-off where they meet.
    let (g, slope) = if r.abs() < 0.02 {
        (
            1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s / 9.0))),
            r * (2.0 / 3.0 + s * (4.0 / 5.0 + s * (6.0 / 7.0 + s * (8.0 / 9.0)))),
        )
    } else {
        let g = r.atanh() / r;
        (g, (1.0 / (1.0 - s) - g) / r)
    };
    (2.0 * g / sum, (4.0 * a * slope / sum - 2.0 * g) / (sum * sum))
}

/// Cofactors `det(a) a^-1` of a symmetric tensor.
#[inline]
fn cofactor(a: &SymmetricTensor2) -> SymmetricTensor2 {
    a.inverse_with_det(1.0)
}

/// The discrete gradient `K` of `J = sqrt(det C)`: `K : (C1 - C0) = J1 - J0` exactly, for steps of any size.
///
/// `K = (cof C0 + cof C1 + cof(C0 + C1)) / (6 (J0 + J1))`: the derivative of `det(C0 + t dC)` is quadratic in `t`, so that Simpson's rule integrates it to
/// `J1^2 - J0^2`. Symmetric; `J C^-1 / 2`, the gradient, at `C0 = C1`.
#[inline]
pub fn discrete_jacobian_gradient(c0: &SymmetricTensor2, j0: f64, c1: &SymmetricTensor2, j1: f64) -> SymmetricTensor2 {
    (cofactor(c0) + cofactor(c1) + cofactor(&(*c0 + *c1))) * (1.0 / (6.0 * (j0 + j1)))
}

/// `A` with `dK = A : dE1` for a change of `C1 = 1 + 2 E1`, given `K`. No major symmetry.
#[inline]
pub fn discrete_jacobian_gradient_tangent(
    c0: &SymmetricTensor2,
    j0: f64,
    c1: &SymmetricTensor2,
    j1: f64,
    gradient: &SymmetricTensor2,
) -> Tensor4 {
    let scale = 1.0 / (j0 + j1);
    let mut tangent = cross_product(&((*c0 + *c1 * 2.0) * (scale / 3.0)));
    // J1 C1^-1 = cof C1 / J1
    tangent.add_dyad(-scale / j1, gradient, &cofactor(c1));
    tangent
}

/// The tensor cross product with `m`, which is the derivative of the cofactors: `cof(m + e) = cof m + m x e + cof e`.
fn cross_product(m: &SymmetricTensor2) -> Tensor4 {
    let [xx, yy, zz, xy, yz, xz] = m.0;
    let (hx, hy, hz, hxy, hyz, hxz) = (0.5 * xx, 0.5 * yy, 0.5 * zz, 0.5 * xy, 0.5 * yz, 0.5 * xz);
    Tensor4([
        [0.0, zz, yy, 0.0, -yz, 0.0],
        [zz, 0.0, xx, 0.0, 0.0, -xz],
        [yy, xx, 0.0, -xy, 0.0, 0.0],
        [0.0, 0.0, -xy, -hz, hxz, hyz],
        [-yz, 0.0, 0.0, hxz, -hx, hxy],
        [0.0, -xz, 0.0, hyz, hxy, -hy],
    ])
}

/// The stress `2 p K` of a pressure `p` whose work over a step is `p (J1 - J0)`, at one configuration: `p J C^-1`, and its moduli `2 dS/dC` for a fixed `p`.
pub fn pressure_stress(p: f64, c: &SymmetricTensor2, j: f64) -> (SymmetricTensor2, Tensor4) {
    let inverse = c.inverse_with_det(j * j);
    let mut moduli = Tensor4::inverse_derivative(&inverse) * (2.0 * p * j);
    moduli.add_dyad(p * j, &inverse, &inverse);
    (inverse * (p * j), moduli)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn strain() -> impl Strategy<Value = SymmetricTensor2> {
        // Diagonally dominant: positive definite.
        proptest::array::uniform6(-0.3..0.3_f64).prop_map(|v| SymmetricTensor2::IDENTITY + SymmetricTensor2(v))
    }

    proptest! {
        #[test]
        fn the_gradient_gives_the_change_of_volume(c0 in strain(), d in proptest::array::uniform6(-0.3..0.3_f64), power in 0.0..9.0_f64) {
            let c1 = c0 + SymmetricTensor2(d) * 10f64.powf(-power) * 0.5;
            let (j0, j1) = (c0.det().sqrt(), c1.det().sqrt());
            prop_assume!(c1.det() > 0.01);
            let k = discrete_jacobian_gradient(&c0, j0, &c1, j1);
            prop_assert!((k.double_contract(&(c1 - c0)) - (j1 - j0)).abs() < 1e-14 * j0.max(j1).max(1.0));
            // The gradient itself at one state.
            let one = discrete_jacobian_gradient(&c0, j0, &c0, j0);
            prop_assert!((one - c0.inverse() * (0.5 * j0)).norm() < 1e-14 * one.norm() * 10.0);
        }

        #[test]
        fn tangents_match_differences(c0 in strain(), c1 in strain(), d in proptest::array::uniform6(-1.0..1.0_f64), p in -3.0..3.0_f64) {
            let d = SymmetricTensor2(d);
            let j = |c: &SymmetricTensor2| c.det().sqrt();
            let k = |c: &SymmetricTensor2| discrete_jacobian_gradient(&c0, j(&c0), c, j(c));
            let h = 1e-4;
            let difference = |f: &dyn Fn(&SymmetricTensor2) -> SymmetricTensor2| {
                let at = |t: f64| f(&(c1 + d * t));
                ((at(h) - at(-h)) * 8.0 - (at(2.0 * h) - at(-2.0 * h))) * (1.0 / (12.0 * h))
            };
            let found = discrete_jacobian_gradient_tangent(&c0, j(&c0), &c1, j(&c1), &k(&c1)).double_contract_right(&(d * 0.5));
            prop_assert!((found - difference(&k)).norm() < 1e-9);
            let (stress, moduli) = pressure_stress(p, &c1, j(&c1));
            prop_assert!((stress - discrete_jacobian_gradient(&c1, j(&c1), &c1, j(&c1)) * (2.0 * p)).norm() < 1e-13);
            let of_pressure = |c: &SymmetricTensor2| pressure_stress(p, c, j(c)).0;
            prop_assert!((moduli.double_contract_right(&(d * 0.5)) - difference(&of_pressure)).norm() < 1e-8);
        }

        #[test]
        fn quotient_of_logarithms(a in 0.05..20.0_f64, power in -12.0..1.0_f64, sign in proptest::bool::ANY) {
            let b = a * if sign { 1.0 + 10f64.powf(power) } else { 1.0 / (1.0 + 10f64.powf(power)) };
            let (l, slope) = logarithm_divided_difference(a, b);
            let x = (b - a) / a;
            let exact = x.ln_1p() / x / a;
            if x != 0.0 {
                prop_assert!((l - exact).abs() < 1e-15 * 10.0 * exact, "{} {}", l, exact);
            }
            let h = 1e-3 * b;
            let at = |t: f64| logarithm_divided_difference(a, b + t).0;
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            prop_assert!((slope - difference).abs() < 1e-10 * slope.abs());
        }
    }
}
