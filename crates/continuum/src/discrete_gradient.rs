//! The energy-momentum stress: a discrete gradient of the energy in the strain (formulation (3.2)-(3.3), thesis
//! (5.59)-(5.61)).

use crate::{ConstitutiveError, HyperelasticLaw, SymmetricTensor2, Tensor4};

/// Strain increments `|C_np1 - C_n|` below this use the stress at the mean strain alone. The energy error of that is of
/// third order, below `1e-17` of the modulus; the quotient would carry round-off of the order `1e-16 / |dC|` instead.
pub const SMALLEST_STRAIN_INCREMENT: f64 = 1.0e-6;

/// Mean strain, increment and its square.
struct Increment {
    mean: SymmetricTensor2,
    delta: SymmetricTensor2,
    square: f64,
}

impl Increment {
    fn new(c_n: &SymmetricTensor2, c_np1: &SymmetricTensor2) -> Self {
        let delta = *c_np1 - *c_n;
        Self { mean: (*c_n + *c_np1) * 0.5, delta, square: delta.double_contract(&delta) }
    }

    fn has_quotient(&self, law: &(impl HyperelasticLaw + ?Sized)) -> bool {
        !law.is_quadratic() && self.square > SMALLEST_STRAIN_INCREMENT * SMALLEST_STRAIN_INCREMENT
    }

    /// `k` of (3.2).
    fn quotient(&self, energy_n: f64, energy_np1: f64, mean_stress: &SymmetricTensor2) -> f64 {
        (2.0 * (energy_np1 - energy_n) - mean_stress.double_contract(&self.delta)) / self.square
    }
}

/// `S_alg = S(C_mean) + k dC` with `S_alg : dC / 2 = W(C_np1) - W(C_n)`.
///
/// `energy_n` is `W(C_n)`, which the caller keeps for the step.
///
/// # Errors
/// Those of the law at `C_np1` or at the mean.
pub fn energy_momentum_stress(
    law: &(impl HyperelasticLaw + ?Sized),
    c_n: &SymmetricTensor2,
    energy_n: f64,
    c_np1: &SymmetricTensor2,
) -> Result<SymmetricTensor2, ConstitutiveError> {
    let increment = Increment::new(c_n, c_np1);
    let mean_stress = law.stress(&increment.mean)?;
    let energy_np1 = law.energy(c_np1)?;
    if !increment.has_quotient(law) {
        return Ok(mean_stress);
    }
    let k = increment.quotient(energy_n, energy_np1, &mean_stress);
    Ok(mean_stress + increment.delta * k)
}

/// `S_alg` and `A` of (3.3): `d S_alg = A : dE_np1`, that is `dS_v = A dE_v` with `E_v = C_v/2` (shears doubled). `A` has no
/// major symmetry.
///
/// # Errors
/// Those of the law at `C_np1` or at the mean.
pub fn energy_momentum_stress_and_tangent(
    law: &(impl HyperelasticLaw + ?Sized),
    c_n: &SymmetricTensor2,
    energy_n: f64,
    c_np1: &SymmetricTensor2,
) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
    let increment = Increment::new(c_n, c_np1);
    let (mean_stress, elasticity) = law.stress_and_elasticity(&increment.mean)?;
    let mut tangent = elasticity * 0.5;
    if !increment.has_quotient(law) {
        // Also here an inadmissible end state has to be found.
        law.energy(c_np1)?;
        return Ok((mean_stress, tangent));
    }
    let (energy_np1, stress_np1) = law.energy_and_stress(c_np1)?;
    let k = increment.quotient(energy_n, energy_np1, &mean_stress);
    let delta = increment.delta;
    let slope = (stress_np1 - mean_stress - elasticity.double_contract_left(&delta) * 0.25 - delta * (2.0 * k))
        * (1.0 / increment.square);
    tangent.add_scaled(2.0 * k, &Tensor4::symmetric_identity());
    tangent.add_dyad(2.0, &delta, &slope);
    Ok((mean_stress + delta * k, tangent))
}
