//! Laws in closed form, written once for a strain and for several side by side: energy, stress, and moduli that are a sum of four tensors. Not the laws.

use crate::state::{Strain, finite_energy, finite_pair, finite_stress};
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, Strains, SymmetricTensor2, Tensor4, Wanted};
use stoss_tensor::components::inverse_derivative;
use stoss_tensor::wide::{self, LANES, Number, Operation, Simd, SymmetricTensors};

/// Energy, stress and moduli as formulas for any kind of number. Every law with this trait gets the methods of [`stoss_continuum::HyperelasticLaw`] by [`evaluations!`].
pub(crate) trait ClosedForm {
    /// Whether energies need `ln J`.
    const ENERGY_OF_LOGARITHM: bool;
    /// Whether stresses and moduli do.
    const STRESS_OF_LOGARITHM: bool;
    /// `W`.
    fn stored<T: Number>(&self, strain: &Strain<T>) -> T;
    /// `S`.
    fn stress_of<T: Number>(&self, strain: &Strain<T>) -> [T; 6];
    /// `CC`.
    fn moduli_of<T: Number>(&self, strain: &Strain<T>) -> Moduli<T>;
}

/// `CC = a dC^-1/dC + b C^-1 (x) C^-1 + c 1 (x) 1 + d I`, `I` the symmetric unit tensor of fourth order.
pub(crate) struct Moduli<T> {
    pub inverse_derivative: T,
    pub inverse_square: T,
    pub sphere: f64,
    pub unit: f64,
}

impl<T: Number> Moduli<T> {
    /// A component.
    #[inline(always)]
    fn at(&self, inverse: &[T; 6], row: usize, column: usize) -> T {
        let of_inverse = inverse_derivative(inverse, row, column) * self.inverse_derivative
            + inverse[row] * self.inverse_square * inverse[column];
        let sphere = if row < 3 && column < 3 { self.sphere } else { 0.0 };
        let constant = match (row == column, row < 3) {
            (true, true) => sphere + self.unit,
            (true, false) => 0.5 * self.unit,
            _ => sphere,
        };
        if constant == 0.0 { of_inverse } else { of_inverse + of_inverse.like(constant) }
    }
}

/// Values at all strains with the processor's vectors; one strain after the other if one of them has none.
pub(crate) fn evaluate<L: ClosedForm + HyperelasticLaw>(
    law: &L,
    strains: &Strains<'_>,
    mut wanted: Wanted<'_>,
) -> Result<(), (usize, ConstitutiveError)> {
    let evaluation = Evaluation { law, strains: strains.all, wanted: &mut wanted };
    if wide::dispatch(evaluation) { Ok(()) } else { strains.one_by_one(law, wanted) }
}

struct Evaluation<'a, 'b, L> {
    law: &'a L,
    strains: &'a SymmetricTensors,
    wanted: &'a mut Wanted<'b>,
}

impl<L: ClosedForm> Operation for Evaluation<'_, '_, L> {
    /// Whether every strain has its values.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { law, strains, wanted: Wanted { energies, stresses, moduli } } = self;
        // Zero as long as all is finite.
        let (mut determinants, mut zero) = ([0.0; LANES], [0.0; LANES]);
        for part in 0..wide::parts::<S>() {
            let with_logarithm = L::STRESS_OF_LOGARITHM || (L::ENERGY_OF_LOGARITHM && energies.is_some());
            let strain = Strain::new(strains.load(simd, part), with_logarithm);
            strain.determinant.store(&mut determinants, part);
            let mut excess = strain.determinant * 0.0;
            if let Some(energies) = energies {
                let energy = law.stored(&strain);
                excess = excess + energy * 0.0;
                energy.store(energies, part);
            }
            if let Some(stresses) = stresses {
                let stress = law.stress_of(&strain);
                for x in &stress {
                    excess = excess + *x * 0.0;
                }
                stresses.store(&stress, part);
            }
            if let Some(moduli) = moduli {
                let form = law.moduli_of(&strain);
                for row in 0..6 {
                    for column in row..6 {
                        let value = form.at(&strain.inverse, row, column);
                        excess = excess + value * 0.0;
                        value.store(&mut moduli.0[row][column], part);
                        if column > row {
                            value.store(&mut moduli.0[column][row], part);
                        }
                    }
                }
            }
            excess.store(&mut zero, part);
        }
        determinants.iter().all(|x| *x > 0.0) & zero.iter().all(|x| *x == 0.0)
    }
}

/// `W`.
#[inline]
pub(crate) fn energy<L: ClosedForm>(law: &L, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
    finite_energy(law.stored(&Strain::admissible(c, L::ENERGY_OF_LOGARITHM)?))
}

/// `S`.
#[inline]
pub(crate) fn stress<L: ClosedForm>(law: &L, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
    finite_stress(SymmetricTensor2(law.stress_of(&Strain::admissible(c, L::STRESS_OF_LOGARITHM)?)))
}

/// `W` and `S`.
#[inline]
pub(crate) fn energy_and_stress<L: ClosedForm>(
    law: &L,
    c: &SymmetricTensor2,
) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
    let strain = Strain::admissible(c, L::ENERGY_OF_LOGARITHM || L::STRESS_OF_LOGARITHM)?;
    Ok((finite_energy(law.stored(&strain))?, finite_stress(SymmetricTensor2(law.stress_of(&strain)))?))
}

/// `S` and `CC`.
#[inline]
pub(crate) fn stress_and_elasticity<L: ClosedForm>(
    law: &L,
    c: &SymmetricTensor2,
) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
    let strain = Strain::admissible(c, L::STRESS_OF_LOGARITHM)?;
    let (form, mut moduli) = (law.moduli_of(&strain), Tensor4::ZERO);
    for row in 0..6 {
        for column in row..6 {
            let value = form.at(&strain.inverse, row, column);
            (moduli.0[row][column], moduli.0[column][row]) = (value, value);
        }
    }
    finite_pair(SymmetricTensor2(law.stress_of(&strain)), moduli)
}

/// The evaluations of [`stoss_continuum::HyperelasticLaw`] for a law with [`ClosedForm`].
macro_rules! evaluations {
    () => {
        fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
            closed_form::energy(self, c)
        }
        fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
            closed_form::stress(self, c)
        }
        fn energy_and_stress(&self, c: &SymmetricTensor2) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
            closed_form::energy_and_stress(self, c)
        }
        fn stress_and_elasticity(
            &self,
            c: &SymmetricTensor2,
        ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
            closed_form::stress_and_elasticity(self, c)
        }
        fn evaluate(&self, strains: &Strains<'_>, wanted: Wanted<'_>) -> Result<(), (usize, ConstitutiveError)> {
            closed_form::evaluate(self, strains, wanted)
        }
    };
}
pub(crate) use evaluations;
