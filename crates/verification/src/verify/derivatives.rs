//! Numerical derivatives of laws and elements, and the worst error over many states.

use stoss_continuum::{
    HyperelasticLaw, SymmetricTensor2, Tensor4, energy_momentum_stress, energy_momentum_stress_and_tangent,
};
use stoss_numerical_derivative::{
    Comparison, DerivativeError, Method, Step, Workspace, check_jacobian, compare_jacobians, jacobian,
};

use super::check::{Bound, Check};
use super::laws::twice_by_tensor;
use super::states::smallest_eigenvalue;
use crate::workspace::Outcome;

/// The worst of many errors.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// Largest error; infinite if one was not a number.
    pub error: f64,
    /// Number of errors seen.
    pub count: usize,
    /// What is known of the largest one.
    pub note: String,
}

impl Worst {
    /// Takes an error into account.
    pub fn see(&mut self, error: f64, note: impl FnOnce() -> String) {
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > self.error {
            (self.error, self.note) = (error, note());
        }
        self.count += 1;
    }

    /// Takes a comparison of Jacobians into account.
    pub fn see_entry(&mut self, worst: &Comparison) {
        self.see(worst.relative_error, || {
            format!(
                "entry ({}, {}): {:.6e}, numerically {:.6e}",
                worst.row, worst.column, worst.analytic, worst.numerical
            )
        });
    }

    /// The row of the worst entry; one without any state falls short.
    pub fn check(&self, scene: &str, quantity: &str, bound: f64) -> Check {
        let measured = if self.count == 0 { f64::NAN } else { self.error };
        let note = format!("{} states; {}", self.count, self.note);
        Check::new(scene, quantity, measured, Bound::AtMost(bound)).noted(note.trim_end_matches("; "))
    }
}

/// A step for derivatives by `C`: relative to the smallest eigenvalue, because near collapse relative changes matter.
fn step(c: &SymmetricTensor2) -> Step {
    Step::Fixed(Method::Central.unit_step() * smallest_eigenvalue(c))
}

fn tensor(components: &[f64]) -> SymmetricTensor2 {
    SymmetricTensor2(std::array::from_fn(|a| components[a]))
}

/// Writes a tensor, or NaN for an error.
fn put(out: &mut [f64], value: Result<SymmetricTensor2, impl Sized>) {
    match value {
        Ok(value) => out.copy_from_slice(&value.0),
        Err(_) => out.fill(f64::NAN),
    }
}

/// `2 dW/dC` of the law's own energy by central differences.
pub fn stress_by_differences(law: &dyn HyperelasticLaw, c: &SymmetricTensor2) -> Outcome<SymmetricTensor2> {
    let mut energy = |x: &[f64], out: &mut [f64]| out[0] = law.energy(&tensor(x)).unwrap_or(f64::NAN);
    let mut gradient = [0.0; 6];
    jacobian(&mut energy, &c.0, Method::Central, step(c), &mut Workspace::default(), &mut gradient)?;
    Ok(twice_by_tensor(&gradient))
}

/// `CC = 2 dS/dC` against central differences of the law's stress.
pub fn elasticity(law: &dyn HyperelasticLaw, c: &SymmetricTensor2) -> Outcome<Comparison> {
    let (_, analytic) = law.stress_and_elasticity(c)?;
    let mut stress = |x: &[f64], out: &mut [f64]| put(out, law.stress(&tensor(x)));
    Ok(by_strain(&analytic, &mut stress, c)?)
}

/// `A` of `dS_alg = A dE_np1` (theory/integrators#eq-ems-tangent) against central differences of the energy-momentum stress.
pub fn energy_momentum(
    law: &dyn HyperelasticLaw,
    (c_n, c_np1): &(SymmetricTensor2, SymmetricTensor2),
) -> Outcome<Comparison> {
    let energy_n = law.energy(c_n)?;
    let (_, analytic) = energy_momentum_stress_and_tangent(law, c_n, energy_n, c_np1)?;
    let mut stress = |x: &[f64], out: &mut [f64]| put(out, energy_momentum_stress(law, c_n, energy_n, &tensor(x)));
    Ok(by_strain(&analytic, &mut stress, c_np1)?)
}

/// Moduli against the derivatives of a stress by `E = (C - 1)/2`: `dS_v = A dE_v` with doubled shears in `E_v`.
fn by_strain(
    analytic: &Tensor4,
    stress: &mut impl FnMut(&[f64], &mut [f64]),
    c: &SymmetricTensor2,
) -> Result<Comparison, DerivativeError> {
    let mut numerical = [0.0; 36];
    jacobian(stress, &c.0, Method::Central, step(c), &mut Workspace::default(), &mut numerical)?;
    for (k, entry) in numerical.iter_mut().enumerate() {
        *entry *= if k % 6 < 3 { 2.0 } else { 1.0 };
    }
    compare_jacobians(analytic.0.as_flattened(), &numerical, 6)
}

/// A tangent (row-major) of a force against central differences; positions of order one.
pub fn force(
    force: &mut impl FnMut(&[f64], &mut [f64]),
    positions: &[f64],
    tangent: &[f64],
) -> Result<Comparison, DerivativeError> {
    check_jacobian(force, positions, tangent, Method::Central, Step::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::laws::LAWS;

    #[test]
    fn the_worst_error_is_kept_and_a_nan_is_worse_than_any() {
        let mut worst = Worst::default();
        assert!(!worst.check("s", "q", 1.0).holds(), "no state, no verdict");
        worst.see(0.5, || "first".into());
        worst.see(0.1, || "second".into());
        assert_eq!(worst.check("s", "q", 1.0).note, "2 states; first");
        assert!(worst.check("s", "q", 1.0).holds());
        worst.see(f64::NAN, || "third".into());
        worst.see(0.9, || "fourth".into());
        let check = worst.check("s", "q", 1.0);
        assert!(!check.holds() && check.note == "4 states; third");
    }

    /// A law with a fault in one entry of its elasticity tensor, and a factor on its stress.
    #[derive(Debug)]
    struct Faulty<'a>(&'a dyn HyperelasticLaw, f64);

    impl HyperelasticLaw for Faulty<'_> {
        fn name(&self) -> &str {
            "faulty"
        }
        fn energy(&self, c: &SymmetricTensor2) -> Result<f64, stoss_continuum::ConstitutiveError> {
            self.0.energy(c)
        }
        fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, stoss_continuum::ConstitutiveError> {
            self.0.stress(c)
        }
        fn stress_and_elasticity(
            &self,
            c: &SymmetricTensor2,
        ) -> Result<(SymmetricTensor2, Tensor4), stoss_continuum::ConstitutiveError> {
            let (stress, mut elasticity) = self.0.stress_and_elasticity(c)?;
            elasticity.0[3][1] += self.1;
            Ok((stress, elasticity))
        }
        fn small_strain_moduli(&self) -> stoss_continuum::SmallStrainModuli {
            self.0.small_strain_moduli()
        }
    }

    #[test]
    fn a_fault_of_one_entry_is_found_where_it_is() {
        let law = LAWS[1].energy.law().unwrap();
        let (c, next) = (tensor(&[1.2, 0.9, 1.1, 0.1, -0.2, 0.05]), tensor(&[1.1, 1.0, 1.3, 0.0, -0.1, 0.1]));
        assert!(elasticity(law.as_ref(), &c).unwrap().relative_error < 1e-8);
        assert!(energy_momentum(law.as_ref(), &(c, next)).unwrap().relative_error < 1e-8);
        let faulty = Faulty(law.as_ref(), 1.0);
        for worst in [elasticity(&faulty, &c).unwrap(), energy_momentum(&faulty, &(c, next)).unwrap()] {
            assert_eq!((worst.row, worst.column), (3, 1));
            assert!(worst.relative_error > 1e-5);
        }
        let numerical = stress_by_differences(law.as_ref(), &c).unwrap();
        assert!((numerical - law.stress(&c).unwrap()).norm() < 1e-8 * 865.0);
    }
}
