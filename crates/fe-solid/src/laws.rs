//! Which function of the strain each Gauss point of an element is: the law of the body, or that of a step from the point's state. Not where states are kept
//! (`block`), not what elements do with the function.

use crate::ForceRule;
use stoss_continuum::wide::{Simd, SymmetricTensors, Tensors4};
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, Material, PointStep, StepLaw, StepStart, StepStress, Strains, Wanted,
};

/// The laws of the points of an element.
#[derive(Clone, Copy)]
pub(crate) struct Laws<'a> {
    law: &'a dyn HyperelasticLaw,
    /// States and step of a material with history; `None` of an elastic law.
    history: Option<History<'a>>,
}

/// The states of an element's points.
#[derive(Clone, Copy)]
struct History<'a> {
    material: &'a dyn Material,
    /// `len` numbers for each point.
    states: &'a [f64],
    len: usize,
    dt: f64,
    stress: StepStress,
}

/// The law of a point.
pub(crate) enum PointLaw<'a> {
    Elastic(&'a dyn HyperelasticLaw),
    Step(StepLaw<'a>),
}

impl<'a> std::ops::Deref for PointLaw<'a> {
    type Target = dyn HyperelasticLaw + 'a;

    #[inline]
    fn deref(&self) -> &Self::Target {
        match self {
            Self::Elastic(law) => *law,
            Self::Step(law) => law,
        }
    }
}

impl<'a> Laws<'a> {
    /// The law of an elastic body, the same at all points.
    pub fn elastic(law: &'a dyn HyperelasticLaw) -> Self {
        Self { law, history: None }
    }

    /// The laws of a material for the states of an element at the begin of a step of the size `dt`.
    ///
    /// A stress at `q_{n+theta}` is that of the end of a step of the part `theta`; without a step it is that of the state as it is.
    pub fn of_step(material: &'a dyn Material, states: &'a [f64], dt: f64, rule: Option<ForceRule>) -> Self {
        let (stress, dt) = match rule {
            None => (StepStress::Frozen, 0.0),
            Some(ForceRule::DiscreteGradient) => (StepStress::DiscreteGradient, dt),
            Some(rule @ ForceRule::Configuration { .. }) if !rule.reads_end() => (StepStress::Frozen, 0.0),
            Some(ForceRule::Configuration { theta }) => (StepStress::End, theta * dt),
        };
        let len = material.state_len();
        Self { law: material, history: Some(History { material, states, len, dt, stress }) }
    }

    /// The law of a Gauss point.
    #[inline]
    pub fn at(&self, gauss_point: usize) -> PointLaw<'a> {
        match &self.history {
            None => PointLaw::Elastic(self.law),
            Some(History { material, states, len, dt, stress }) => {
                let state = &states[gauss_point * len..(gauss_point + 1) * len];
                PointLaw::Step(StepLaw { material: *material, at: PointStep { state, dt: *dt, stress: *stress } })
            }
        }
    }

    /// State of a Gauss point; empty of an elastic law.
    pub fn state(&self, gauss_point: usize) -> &'a [f64] {
        self.history.as_ref().map_or(&[], |h| &h.states[gauss_point * h.len..(gauss_point + 1) * h.len])
    }

    /// What is wanted at the Gauss points from `first` on, the points of `strains`: side by side where they have one law, else one after the other.
    #[inline]
    pub fn evaluate(&self, first: usize, strains: &Strains<'_>, mut wanted: Wanted<'_>) -> Result<(), PointError> {
        if self.history.is_none() {
            return self.law.evaluate(strains, wanted).map_err(|(l, error)| (first + l, error));
        }
        (0..strains.count)
            .try_for_each(|l| strains.one(&*self.at(first + l), l, &mut wanted).map_err(|error| (first + l, error)))
    }

    /// The energy-momentum stress there and, if wanted, its tangent.
    #[inline(always)]
    pub fn energy_momentum<S: Simd>(
        &self,
        simd: S,
        first: usize,
        start: StepStart<'_>,
        end: &Strains<'_>,
        stresses: &mut SymmetricTensors,
        moduli: Option<&mut Tensors4>,
    ) -> Result<(), PointError> {
        if self.history.is_none() {
            return stoss_continuum::energy_momentum_stresses(simd, self.law, start, end, stresses, moduli)
                .map_err(|(l, error)| (first + l, error));
        }
        self.one_by_one(first, start, end, stresses, moduli)
    }

    fn one_by_one(
        &self,
        first: usize,
        start: StepStart<'_>,
        end: &Strains<'_>,
        stresses: &mut SymmetricTensors,
        mut moduli: Option<&mut Tensors4>,
    ) -> Result<(), PointError> {
        for l in 0..end.count {
            let (law, c_n, c_np1) = (self.at(first + l), start.strains.get(l), end.all.get(l));
            let failure = |error| (first + l, error);
            let stress = match &mut moduli {
                None => stoss_continuum::energy_momentum_stress(&*law, &c_n, start.energies[l], &c_np1),
                Some(moduli) => {
                    let found =
                        stoss_continuum::energy_momentum_stress_and_tangent(&*law, &c_n, start.energies[l], &c_np1);
                    found.map(|(stress, tangent)| {
                        moduli.set(l, &tangent);
                        stress
                    })
                }
            };
            stresses.set(l, &stress.map_err(failure)?);
        }
        Ok(())
    }
}

/// A Gauss point at which the law has no value, and why.
pub(crate) type PointError = (usize, ConstitutiveError);
