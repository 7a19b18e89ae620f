//! Strain and stress measures.

use stoss_tensor::{SymmetricTensor2, Tensor2};

/// Green-Lagrange strain `E = (C - 1)/2`.
pub fn green_lagrange(right_cauchy_green: &SymmetricTensor2) -> SymmetricTensor2 {
    (*right_cauchy_green - SymmetricTensor2::IDENTITY) * 0.5
}

/// Cauchy stress `F S F^T / det F`.
pub fn cauchy_stress(deformation_gradient: &Tensor2, second_piola_kirchhoff: &SymmetricTensor2) -> SymmetricTensor2 {
    let f = deformation_gradient;
    SymmetricTensor2::from_matrix(&(f * second_piola_kirchhoff.to_matrix() * f.transpose() / f.determinant()))
}

/// Von Mises stress `sqrt(3/2 dev(s) : dev(s))`.
pub fn von_mises(cauchy_stress: &SymmetricTensor2) -> f64 {
    let mean = cauchy_stress.trace() / 3.0;
    let deviator = *cauchy_stress - SymmetricTensor2::IDENTITY * mean;
    (1.5 * deviator.double_contract(&deviator)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_stress_is_its_own_von_mises_stress() {
        assert!((von_mises(&SymmetricTensor2([0.0, -7.0, 0.0, 0.0, 0.0, 0.0])) - 7.0).abs() < 1e-14);
        assert!(von_mises(&(SymmetricTensor2::IDENTITY * 3.0)) < 1e-14);
    }

    #[test]
    fn uniaxial_stretch() {
        // Along 1: S_11 = P_11 / lambda, sigma_11 = lambda S_11 lambda / J.
        let f = Tensor2::from_diagonal(&[2.0, 0.8, 0.8].into());
        let s = SymmetricTensor2([3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!((cauchy_stress(&f, &s).0[0] - 2.0 * 3.0 * 2.0 / (2.0 * 0.64)).abs() < 1e-14);
        assert_eq!(green_lagrange(&SymmetricTensor2::right_cauchy_green(&f)).0[0], 1.5);
    }
}
