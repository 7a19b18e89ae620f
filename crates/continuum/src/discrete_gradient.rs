//! The energy-momentum stress: a discrete gradient of the energy in the strain (theory/integrators#ems; thesis
//! (5.59)-(5.61)).
//!
//! With `C_mean = (C_n + C_np1)/2`, `dC = C_np1 - C_n` and the quotient `k`
//!
//! ```text
//! S_alg = S(C_mean) + k dC,    k = (2 (W_np1 - W_n) - S(C_mean) : dC) / (dC : dC),
//! ```
//!
//! so that the work of the step is the change of energy, `S_alg : dC / 2 = W_np1 - W_n`, at any step size. It acts on `F_mid`.
//! Not here: laws, and the internal force of an element.
//!
//! # Round-off
//! The numerator is of third order in `dC`, the difference of terms of first order. An error `e` of the energies puts
//! `2 e / |dC|` into the stress. With `e` of `1e-16` of the modulus that is `1e-10` of it just above the switch, whatever the
//! stress itself is; with energies computed from `C - 1`, as those of the catalogue are, it is less by the factor `|C - 1|`, and
//! stays near `1e-10` of the *stress*. Where the quotient is left out, the energy of a step is off by about `|dC|^3 / 24`
//! times a few moduli.

use crate::{ConstitutiveError, HyperelasticLaw, Strains, SymmetricTensor2, Tensor4, Wanted};
use stoss_tensor::components::double_contraction;
use stoss_tensor::wide::{self, LANES, Number, Several, Simd, SymmetricTensors, Tensors4, Wide};

/// Strain increments `|C_np1 - C_n|` (Frobenius norm) up to this use the stress at the mean strain alone, `k = 0`. The energy error
/// of that is of third order, about `1e-18` of the modulus; the quotient's round-off grows as `1 / |dC|` instead. A larger value
/// shows as a drift of the energy in small vibrations, a smaller one as noise in the stress on which Newton's iteration stalls.
pub const SMALLEST_STRAIN_INCREMENT: f64 = 1.0e-6;

#[inline]
fn mean(c_n: &SymmetricTensor2, c_np1: &SymmetricTensor2) -> SymmetricTensor2 {
    (*c_n + *c_np1) * 0.5
}

/// Strain increment and its square.
struct Increment {
    delta: SymmetricTensor2,
    square: f64,
}

impl Increment {
    fn new(c_n: &SymmetricTensor2, c_np1: &SymmetricTensor2) -> Self {
        let delta = *c_np1 - *c_n;
        Self { delta, square: delta.double_contract(&delta) }
    }

    fn has_quotient(&self, law: &(impl HyperelasticLaw + ?Sized)) -> bool {
        let smallest = law.smallest_strain_increment();
        !law.is_quadratic() && self.square > smallest * smallest
    }

    /// `k` of theory/integrators#eq-ems.
    fn quotient(&self, energy_n: f64, energy_np1: f64, mean_stress: &SymmetricTensor2) -> f64 {
        (2.0 * (energy_np1 - energy_n) - mean_stress.double_contract(&self.delta)) / self.square
    }
}

/// `S_alg = S(C_mean) + k dC` with `S_alg : dC / 2 = W(C_np1) - W(C_n)`.
///
/// `energy_n` is `W(C_n)`, which the caller keeps for the step.
///
/// # Errors
/// The errors of the law at `C_np1` or at the mean.
pub fn energy_momentum_stress(
    law: &(impl HyperelasticLaw + ?Sized),
    c_n: &SymmetricTensor2,
    energy_n: f64,
    c_np1: &SymmetricTensor2,
) -> Result<SymmetricTensor2, ConstitutiveError> {
    let increment = Increment::new(c_n, c_np1);
    let mean_stress = law.stress(&mean(c_n, c_np1))?;
    // Also where there is no quotient an inadmissible end state has to be found.
    let energy_np1 = law.energy(c_np1)?;
    if !increment.has_quotient(law) {
        return Ok(mean_stress);
    }
    Ok(mean_stress + increment.delta * increment.quotient(energy_n, energy_np1, &mean_stress))
}

/// `S_alg` and `A` of theory/integrators#eq-ems-tangent: `d S_alg = A : dE_np1`, that is `dS_v = A dE_v` with `E_v = C_v/2` (shears doubled). `A` has no
/// major symmetry.
///
/// # Errors
/// The errors of the law at `C_np1` or at the mean.
pub fn energy_momentum_stress_and_tangent(
    law: &(impl HyperelasticLaw + ?Sized),
    c_n: &SymmetricTensor2,
    energy_n: f64,
    c_np1: &SymmetricTensor2,
) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
    let (mut stress, mut tangent) = law.stress_and_elasticity(&mean(c_n, c_np1))?;
    let end = law.energy_and_stress(c_np1)?;
    complete(law, &Increment::new(c_n, c_np1), energy_n, &end, &mut stress, &mut tangent);
    Ok((stress, tangent))
}

/// What the stress of a step needs of its start at a few points.
#[derive(Clone, Copy, Debug)]
pub struct StepStart<'a> {
    /// `C_n`.
    pub strains: &'a SymmetricTensors,
    /// `W(C_n)`.
    pub energies: &'a Several,
}

/// [`energy_momentum_stress`] or, with `moduli`, [`energy_momentum_stress_and_tangent`] at a few points of one law, with the same bits.
///
/// # Errors
/// The number of a point at which the law has no value at `C_np1` or at the mean, and why.
#[inline(always)]
pub fn energy_momentum_stresses<S: Simd>(
    simd: S,
    law: &(impl HyperelasticLaw + ?Sized),
    start: StepStart<'_>,
    end: &Strains<'_>,
    stresses: &mut SymmetricTensors,
    mut moduli: Option<&mut Tensors4>,
) -> Result<(), (usize, ConstitutiveError)> {
    let mut means = SymmetricTensors::ZERO;
    for part in 0..wide::parts::<S>() {
        let (c_n, c_np1) = (start.strains.load(simd, part), end.all.load(simd, part));
        let mut mean = c_n;
        for v in 0..6 {
            mean[v] = (c_n[v] + c_np1[v]) * 0.5;
        }
        means.store(&mean, part);
    }
    let at_mean = Wanted { energies: None, stresses: Some(stresses), moduli: moduli.as_deref_mut() };
    law.evaluate(&Strains { all: &means, count: end.count }, at_mean)?;
    // Also where there is no quotient an inadmissible end state has to be found.
    let (mut energies, mut ends) = ([0.0; LANES], SymmetricTensors::ZERO);
    let stresses_np1 = moduli.is_some().then_some(&mut ends);
    law.evaluate(end, Wanted { energies: Some(&mut energies), stresses: stresses_np1, moduli: None })?;
    let smallest = law.smallest_strain_increment();
    let smallest = if law.is_quadratic() { f64::INFINITY } else { smallest * smallest };
    for part in 0..wide::parts::<S>() {
        let (c_n, c_np1) = (start.strains.load(simd, part), end.all.load(simd, part));
        let mut delta = c_n;
        for v in 0..6 {
            delta[v] = c_np1[v] - c_n[v];
        }
        let square = double_contraction(&delta, &delta);
        let smallest = Wide::splat(simd, smallest);
        let mean_stress = stresses.load(simd, part);
        let (w_n, w_np1) = (Wide::load(simd, start.energies, part), Wide::load(simd, &energies, part));
        let k = ((w_np1 - w_n) * 2.0 - double_contraction(&mean_stress, &delta)) / square;
        let k = k.where_greater(square, smallest);
        let mut stress = mean_stress;
        for v in 0..6 {
            stress[v] = mean_stress[v] + delta[v] * k;
        }
        stresses.store(&stress, part);
        let Some(moduli) = &mut moduli else { continue };
        let inverse_square = (square.like(1.0) / square).where_greater(square, smallest);
        let stress_np1 = ends.load(simd, part);
        // dC : CC, then the slope of the quotient.
        let mut slope = [square.like(0.0); 6];
        for (v, row) in moduli.0.iter().enumerate() {
            let factor = if v < 3 { delta[v] } else { delta[v] * 2.0 };
            for (w, entry) in row.iter().enumerate() {
                slope[w] = slope[w] + factor * Wide::load(simd, entry, part);
            }
        }
        for v in 0..6 {
            let change = stress_np1[v] - mean_stress[v] - slope[v] * 0.25 - delta[v] * (k * 2.0);
            slope[v] = change * inverse_square;
        }
        for (v, row) in moduli.0.iter_mut().enumerate() {
            let doubled = delta[v] * 2.0;
            for (w, entry) in row.iter_mut().enumerate() {
                let mut value = Wide::load(simd, entry, part) * 0.5;
                if v == w {
                    value = value + k * if v < 3 { 2.0 } else { 1.0 };
                }
                (value + doubled * slope[w]).store(entry, part);
            }
        }
    }
    Ok(())
}

/// Completes stress and elasticity at the mean strain to those of the step.
#[inline]
fn complete(
    law: &(impl HyperelasticLaw + ?Sized),
    increment: &Increment,
    energy_n: f64,
    (energy_np1, stress_np1): &(f64, SymmetricTensor2),
    stress: &mut SymmetricTensor2,
    tangent: &mut Tensor4,
) {
    let (mean_stress, elasticity) = (*stress, *tangent);
    *tangent = elasticity * 0.5;
    if !increment.has_quotient(law) {
        return;
    }
    let k = increment.quotient(energy_n, *energy_np1, &mean_stress);
    let delta = increment.delta;
    let slope = (*stress_np1 - mean_stress - elasticity.double_contract_left(&delta) * 0.25 - delta * (2.0 * k))
        * (1.0 / increment.square);
    tangent.add_scaled(2.0 * k, &Tensor4::symmetric_identity());
    tangent.add_dyad(2.0, &delta, &slope);
    *stress += delta * k;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SmallStrainModuli;
    use proptest::prelude::*;

    /// `W = a/2 (tr A)^2 + b tr A A:A + mu/4 A:A` with `A = C - 1`: a cubic whose quotient is known in closed form.
    #[derive(Debug)]
    struct Cubic {
        b: f64,
        quadratic: bool,
    }

    const A: f64 = 3.0;
    const MU: f64 = 2.0;

    impl HyperelasticLaw for Cubic {
        fn name(&self) -> &str {
            "cubic"
        }
        fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
            let det_c = c.det();
            if det_c <= 0.0 {
                return Err(ConstitutiveError::NonPositiveJacobian { det_c });
            }
            let a = *c - SymmetricTensor2::IDENTITY;
            let (trace, square) = (a.trace(), a.double_contract(&a));
            Ok(0.5 * A * trace * trace + self.b * trace * square + 0.25 * MU * square)
        }
        fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
            let a = *c - SymmetricTensor2::IDENTITY;
            let spherical = 2.0 * (A * a.trace() + self.b * a.double_contract(&a));
            Ok(SymmetricTensor2::IDENTITY * spherical + a * (4.0 * self.b * a.trace() + MU))
        }
        fn stress_and_elasticity(
            &self,
            c: &SymmetricTensor2,
        ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
            let a = *c - SymmetricTensor2::IDENTITY;
            let mut cc = Tensor4::identity_dyad() * (4.0 * A);
            cc.add_dyad(8.0 * self.b, &SymmetricTensor2::IDENTITY, &a);
            cc.add_dyad(8.0 * self.b, &a, &SymmetricTensor2::IDENTITY);
            cc.add_scaled(8.0 * self.b * a.trace() + 2.0 * MU, &Tensor4::symmetric_identity());
            Ok((self.stress(c)?, cc))
        }
        fn small_strain_moduli(&self) -> SmallStrainModuli {
            SmallStrainModuli::from_lame(4.0 * A, MU)
        }
        fn is_quadratic(&self) -> bool {
            self.quadratic
        }
    }

    fn strain() -> impl Strategy<Value = SymmetricTensor2> {
        // Diagonally dominant: positive definite.
        proptest::array::uniform6(-0.3..0.3_f64).prop_map(|v| SymmetricTensor2::IDENTITY + SymmetricTensor2(v))
    }

    fn evaluate(law: &Cubic, c_n: &SymmetricTensor2, c_np1: &SymmetricTensor2) -> (SymmetricTensor2, Tensor4) {
        energy_momentum_stress_and_tangent(law, c_n, law.energy(c_n).unwrap(), c_np1).unwrap()
    }

    proptest! {
        #[test]
        fn quotient_of_a_cubic_energy(c_n in strain(), c_np1 in strain()) {
            // The cubic part of the energy along the step gives 2 (W_np1 - W_n) - S_mean : dC = b/2 tr(dC) dC : dC.
            let law = Cubic { b: 0.7, quadratic: false };
            let delta = c_np1 - c_n;
            let expected = law.stress(&((c_n + c_np1) * 0.5)).unwrap() + delta * (0.5 * 0.7 * delta.trace());
            let (stress, _) = evaluate(&law, &c_n, &c_np1);
            prop_assert!((stress - expected).norm() < 1e-14 * 10.0 / delta.norm().min(1.0));
            let change = law.energy(&c_np1).unwrap() - law.energy(&c_n).unwrap();
            prop_assert!((0.5 * stress.double_contract(&delta) - change).abs() < 1e-14 * 10.0);
            let alone = energy_momentum_stress(&law, &c_n, law.energy(&c_n).unwrap(), &c_np1).unwrap();
            prop_assert!((alone - stress).norm() < 1e-14 * 10.0 / delta.norm().min(1.0));
        }

        #[test]
        fn tangent_of_a_cubic_energy(c_n in strain(), c_np1 in strain(), direction in proptest::array::uniform6(-1.0..1.0_f64)) {
            // S_alg is a polynomial in C_np1 (previous test); its derivative in a direction D of C_np1 by the product rule, with
            // dE = D/2.
            let law = Cubic { b: 0.7, quadratic: false };
            let (delta, d) = (c_np1 - c_n, SymmetricTensor2(direction));
            let (_, cc) = law.stress_and_elasticity(&((c_n + c_np1) * 0.5)).unwrap();
            let expected = cc.double_contract_right(&d) * 0.25 + (d * delta.trace() + delta * d.trace()) * (0.5 * 0.7);
            let (_, tangent) = evaluate(&law, &c_n, &c_np1);
            prop_assert!((tangent.double_contract_right(&(d * 0.5)) - expected).norm() < 1e-13 * 10.0 / delta.norm().powi(2).min(1.0));
        }

        #[test]
        fn small_increments_and_quadratic_laws_have_no_quotient(c in strain(), direction in proptest::array::uniform6(-1.0..1.0_f64), power in 6.1..12.0_f64) {
            let direction = SymmetricTensor2(direction);
            let small = c + direction * (10.0_f64.powf(-power) / direction.norm().max(0.1));
            let large = c + direction * (0.2 / direction.norm().max(0.1));
            for (law, next) in [
                (Cubic { b: 0.7, quadratic: false }, small),
                (Cubic { b: 0.7, quadratic: false }, c),
                (Cubic { b: 0.0, quadratic: true }, large),
            ] {
                let (stress, tangent) = evaluate(&law, &c, &next);
                let (mean, cc) = law.stress_and_elasticity(&((c + next) * 0.5)).unwrap();
                prop_assert_eq!(stress, mean);
                prop_assert_eq!(tangent, cc * 0.5);
            }
        }
    }

    #[test]
    fn quadratic_energies_need_no_quotient() {
        // The claim behind `is_quadratic`: the energy balance holds without it.
        let law = Cubic { b: 0.0, quadratic: true };
        let (c_n, c_np1) = (SymmetricTensor2::IDENTITY, SymmetricTensor2([1.4, 0.8, 1.1, 0.2, -0.1, 0.3]));
        let (stress, _) = evaluate(&law, &c_n, &c_np1);
        let work = 0.5 * stress.double_contract(&(c_np1 - c_n));
        assert!((work - law.energy(&c_np1).unwrap()).abs() < 1e-15);
    }

    #[test]
    fn an_inadmissible_end_state_is_an_error() {
        // Also where the end state's energy is not needed.
        let bad = SymmetricTensor2([0.1, 1.0, 1.0, 0.6, 0.0, 0.0]);
        for law in [Cubic { b: 0.7, quadratic: false }, Cubic { b: 0.0, quadratic: true }] {
            let c_n = SymmetricTensor2::IDENTITY;
            assert!(energy_momentum_stress(&law, &c_n, 0.0, &bad).is_err());
            assert!(energy_momentum_stress_and_tangent(&law, &c_n, 0.0, &bad).is_err());
        }
    }
}
