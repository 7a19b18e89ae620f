//! What a law is asked for at several strains side by side.

use crate::{ConstitutiveError, HyperelasticLaw};
use stoss_tensor::wide::{Several, SymmetricTensors, Tensors4};

/// Right Cauchy-Green tensors of a few points.
#[derive(Clone, Copy, Debug)]
pub struct Strains<'a> {
    /// The tensors; those from `count` on are of no point, and may be anything.
    pub all: &'a SymmetricTensors,
    /// Number of points.
    pub count: usize,
}

/// Where the results go that are asked for; all others are not computed. Those from [`Strains::count`] on are left undefined.
#[derive(Debug, Default)]
pub struct Wanted<'a> {
    /// `W`.
    pub energies: Option<&'a mut Several>,
    /// `S`; wanted where moduli are.
    pub stresses: Option<&'a mut SymmetricTensors>,
    /// `CC`.
    pub moduli: Option<&'a mut Tensors4>,
}

impl Strains<'_> {
    /// Evaluates by the law's methods for one strain.
    ///
    /// # Errors
    /// The number of the first strain that is inadmissible, and why it is.
    pub fn one_by_one(
        &self,
        law: &(impl HyperelasticLaw + ?Sized),
        mut wanted: Wanted<'_>,
    ) -> Result<(), (usize, ConstitutiveError)> {
        (0..self.count).try_for_each(|point| self.one(law, point, &mut wanted).map_err(|error| (point, error)))
    }

    /// One of the points, by a law of its own.
    ///
    /// # Errors
    /// Why the strain is inadmissible.
    pub fn one(
        &self,
        law: &(impl HyperelasticLaw + ?Sized),
        point: usize,
        wanted: &mut Wanted<'_>,
    ) -> Result<(), ConstitutiveError> {
        let c = self.all.get(point);
        let Wanted { energies, stresses, moduli } = wanted;
        let (energy, stress) = match (energies, stresses, moduli) {
            (energies, stresses, Some(moduli)) => {
                let (stress, of_point) = law.stress_and_elasticity(&c)?;
                moduli.set(point, &of_point);
                if let Some(energies) = energies {
                    energies[point] = law.energy(&c)?;
                }
                if let Some(stresses) = stresses {
                    stresses.set(point, &stress);
                }
                return Ok(());
            }
            (Some(energies), Some(stresses), None) => {
                let (energy, stress) = law.energy_and_stress(&c)?;
                (Some((energies, energy)), Some((stresses, stress)))
            }
            (Some(energies), None, None) => (Some((energies, law.energy(&c)?)), None),
            (None, Some(stresses), None) => (None, Some((stresses, law.stress(&c)?))),
            (None, None, None) => (None, None),
        };
        if let Some((energies, energy)) = energy {
            energies[point] = energy;
        }
        if let Some((stresses, stress)) = stress {
            stresses.set(point, &stress);
        }
        Ok(())
    }
}
