//! The battery passes a right law and finds each way in which it can be wrong.

use std::panic::{AssertUnwindSafe, catch_unwind};
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};
use stoss_testkit::laws::{EnergyOracle, against_dual_numbers, battery, invariants};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    EnergyOffset,
    StressAtRest,
    Moduli,
    EnergyScaled,
    TangentScaled,
    TangentUnsymmetric,
    Anisotropic,
    AcceptsCollapse,
    Infinite,
    EnergyAndStress,
    SaysQuadratic,
}

/// `W = mu/2 (I1 - 3 - ln det C)`, whose first Lamé constant is zero, with a fault.
#[derive(Debug)]
struct Law(Fault);

const MU: f64 = 3.0;

impl Law {
    fn det(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let det_c = c.det();
        if self.0 == Fault::AcceptsCollapse && det_c <= 0.0 && c.is_finite() {
            return Ok(1e-3);
        }
        if det_c <= 0.0 {
            return Err(ConstitutiveError::NonPositiveJacobian { det_c });
        }
        if self.0 != Fault::Infinite && !(det_c.is_finite() && c.inverse_with_det(det_c).is_finite()) || det_c.is_nan()
        {
            return Err(ConstitutiveError::NonFinite);
        }
        Ok(det_c)
    }

    /// `a (C_11 - 1)^4` vanishes at the reference state with its first three derivatives.
    fn anisotropy(&self, c: &SymmetricTensor2) -> [f64; 3] {
        let x = if self.0 == Fault::Anisotropic { c.0[0] - 1.0 } else { 0.0 };
        [0.1 * x.powi(4), 0.4 * x.powi(3), 1.2 * x * x]
    }
}

impl HyperelasticLaw for Law {
    fn name(&self) -> &str {
        "faulty"
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let w = 0.5 * MU * (c.trace() - 3.0 - self.det(c)?.ln()) + self.anisotropy(c)[0];
        let w = match self.0 {
            Fault::EnergyOffset => w + 1e-6,
            Fault::EnergyScaled => w * (1.0 + 1e-5),
            _ => w,
        };
        if w.is_finite() || self.0 == Fault::Infinite { Ok(w) } else { Err(ConstitutiveError::NonFinite) }
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        Ok(self.stress_and_elasticity(c)?.0)
    }
    fn energy_and_stress(&self, c: &SymmetricTensor2) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let factor = if self.0 == Fault::EnergyAndStress { 1.0 + 1e-9 } else { 1.0 };
        Ok((self.energy(c)?, self.stress(c)? * factor))
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let inverse = c.inverse_with_det(self.det(c)?);
        let mut stress = (SymmetricTensor2::IDENTITY - inverse) * MU;
        let mut elasticity = Tensor4::inverse_derivative(&inverse) * (-2.0 * MU);
        let [_, first, second] = self.anisotropy(c);
        stress.0[0] += 2.0 * first;
        elasticity.0[0][0] += 4.0 * second;
        match self.0 {
            Fault::StressAtRest => stress += SymmetricTensor2::IDENTITY * 1e-8,
            Fault::TangentScaled => {
                // Right at rest.
                elasticity = elasticity * (1.0 + 1e-4 * (c.trace() - 3.0));
            }
            Fault::TangentUnsymmetric => elasticity.0[0][4] += 1e-9 * MU * c.0[3],
            _ => {}
        }
        let finite = stress.is_finite() && elasticity.is_finite();
        if finite || self.0 == Fault::Infinite { Ok((stress, elasticity)) } else { Err(ConstitutiveError::NonFinite) }
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(0.0, if self.0 == Fault::Moduli { MU * (1.0 + 1e-9) } else { MU })
    }
    fn is_quadratic(&self) -> bool {
        self.0 == Fault::SaysQuadratic
    }
}

struct Energy;
impl EnergyOracle for Energy {
    fn energy<D: num_dual::DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        (invariants::trace(c) - 3.0 - invariants::det(c).ln()) * (0.5 * MU)
    }
}

/// The panic's message, if there was a panic.
fn complaint(check: impl FnOnce()) -> Option<String> {
    let payload = catch_unwind(AssertUnwindSafe(check)).err()?;
    Some(payload.downcast_ref::<String>().cloned().unwrap_or_else(|| "no message".into()))
}

#[test]
fn a_right_law_passes() {
    battery(&Law(Fault::None), 1e-13);
    against_dual_numbers(&Law(Fault::None), &Energy, 1e-11);
}

#[test]
fn each_fault_is_found_and_named() {
    for (fault, expected) in [
        (Fault::EnergyOffset, "at C = 1"),
        (Fault::StressAtRest, "at C = 1"),
        (Fault::Moduli, "small-strain moduli"),
        (Fault::EnergyScaled, "2 dW/dC"),
        (Fault::TangentScaled, "2 dS/dC"),
        (Fault::TangentUnsymmetric, "major symmetry"),
        (Fault::Anisotropic, "not isotropic"),
        (Fault::AcceptsCollapse, "accepts"),
        (Fault::Infinite, "at SymmetricTensor2"),
        (Fault::EnergyAndStress, "energy_and_stress"),
        (Fault::SaysQuadratic, "directionality"),
    ] {
        let text = complaint(|| battery(&Law(fault), 1e-13)).unwrap_or_else(|| panic!("{fault:?} passes the battery"));
        assert!(text.contains(expected), "{fault:?} is reported as: {text}");
    }
}

#[test]
fn dual_numbers_find_a_wrong_derivative() {
    for fault in [Fault::EnergyScaled, Fault::TangentScaled, Fault::Anisotropic] {
        assert!(complaint(|| against_dual_numbers(&Law(fault), &Energy, 1e-9)).is_some(), "{fault:?} passes");
    }
}

#[test]
fn traces_of_powers_agree_with_closed_forms() {
    // Integer powers are polynomials; a half-integer power of a square of a matrix is one of the matrix.
    let c = [1.3, 0.7, 2.1, 0.2, -0.3, 0.1];
    let a = SymmetricTensor2(c);
    let close = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-12, "{x} against {y}");
    let powers = invariants::traces_of_powers(c, &[1.0, 2.0, -1.0]);
    close(powers[0], a.trace());
    close(powers[1], a.double_contract(&a));
    close(powers[2], a.inverse().trace());
    close(invariants::traces_of_powers(a.square().0, &[0.5])[0], a.trace());
    close(invariants::traces_of_powers([4.0, 4.0, 4.0, 0.0, 0.0, 0.0], &[1.3])[0], 3.0 * 4.0_f64.powf(1.3));
}
