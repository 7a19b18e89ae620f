//! Strain and stress measures. Not the derivatives of strains by positions, which are the elements'.

use stoss_tensor::{SymmetricTensor2, Tensor2, spectral_decomposition};

/// Green-Lagrange strain `E = (C - 1)/2`.
#[inline]
pub fn green_lagrange(right_cauchy_green: &SymmetricTensor2) -> SymmetricTensor2 {
    (*right_cauchy_green - SymmetricTensor2::IDENTITY) * 0.5
}

/// Logarithmic strain of Hencky in the current directions, `ln V = ln(F F^T)/2`: principal values are the logarithms of the
/// principal stretches. Infinite or NaN for a singular `F`.
pub fn logarithmic_strain(deformation_gradient: &Tensor2) -> SymmetricTensor2 {
    let f = deformation_gradient;
    let left = spectral_decomposition(&SymmetricTensor2::from_matrix(&(f * f.transpose())));
    let terms = left.values.iter().zip(&left.vectors).map(|(b, n)| 0.5 * b.ln() * n * n.transpose());
    SymmetricTensor2::from_matrix(&terms.sum())
}

/// Principal values of a symmetric tensor, the largest first.
pub fn principal_values(tensor: &SymmetricTensor2) -> [f64; 3] {
    let [smallest, middle, largest] = spectral_decomposition(tensor).values;
    [largest, middle, smallest]
}

/// Cauchy stress `F S F^T / det F`, positive in tension; infinite or NaN for a singular `F`.
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
    use proptest::prelude::*;

    #[test]
    fn uniaxial_stress_is_its_own_von_mises_stress() {
        assert!((von_mises(&SymmetricTensor2([0.0, -7.0, 0.0, 0.0, 0.0, 0.0])) - 7.0).abs() < 1e-14);
        assert!(von_mises(&(SymmetricTensor2::IDENTITY * 3.0)) < 1e-14);
    }

    #[test]
    fn shear_stress() {
        // sqrt(3) times a pure shear.
        assert!((von_mises(&SymmetricTensor2([4.0, 4.0, 4.0, 0.0, 0.0, -2.0])) - 2.0 * 3.0_f64.sqrt()).abs() < 1e-14);
    }

    proptest! {
        #[test]
        fn traction_on_a_deformed_area(f in proptest::array::uniform9(-0.25..0.25_f64), s in proptest::array::uniform6(-1.0..1.0_f64), n in proptest::array::uniform3(-1.0..1.0_f64)) {
            // Nanson: sigma (J F^-T N) = F S N, the force on a reference area N.
            let f = Tensor2::identity() + Tensor2::from_column_slice(&f);
            let s = SymmetricTensor2(s);
            let n = stoss_tensor::Vector3::from(n);
            let area = f.try_inverse().unwrap().transpose() * n * f.determinant();
            let force = cauchy_stress(&f, &s).to_matrix() * area;
            prop_assert!((force - f * s.to_matrix() * n).norm() < 1e-13);
        }
    }

    #[test]
    fn logarithms_of_stretches_in_the_current_directions() {
        // Stretched along 1 and 2, then turned by a right angle about 3: the stretch along 1 is found along 2.
        let turn = Tensor2::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let h = logarithmic_strain(&(turn * Tensor2::from_diagonal(&[2.0, 0.5, 1.0].into())));
        let expected = [-(2.0_f64.ln()), 2.0_f64.ln(), 0.0, 0.0, 0.0, 0.0];
        assert!(h.0.iter().zip(expected).all(|(h, e)| (h - e).abs() < 1e-15), "{h:?}");
        // Simple shear: lambda = sqrt(1 + g^2/4) + g/2 at half the angle whose cotangent is g/2; ln V = ln(lambda) (g/2, -g/2, 1)/sqrt(1 + g^2/4).
        let g: f64 = 0.7;
        let root = (1.0 + g * g / 4.0).sqrt();
        let h = logarithmic_strain(&Tensor2::new(1.0, g, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        let log = (root + g / 2.0).ln() / root;
        let expected = [log * g / 2.0, -log * g / 2.0, 0.0, log, 0.0, 0.0];
        assert!(h.0.iter().zip(expected).all(|(h, e)| (h - e).abs() < 1e-15), "{h:?}");
    }

    #[test]
    fn principal_values_fall() {
        let [a, b, c] = principal_values(&SymmetricTensor2([0.0, 5.0, 0.0, 0.0, 0.0, 3.0]));
        assert!((a - 5.0).abs() < 1e-14 && (b - 3.0).abs() < 1e-14 && (c + 3.0).abs() < 1e-14);
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
