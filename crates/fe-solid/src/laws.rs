//! Which function of the strain each Gauss point of an element is: the law of the body, or that of a step from the point's state. Not where states are kept
//! (`block`), not what elements do with the function.

use crate::ForceRule;
use std::ops::Range;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, Material, PointStep, StepLaw, StepStress, SymmetricTensor2, Tensor4,
};

/// The laws of the points of an element.
#[derive(Clone, Copy)]
pub(crate) struct Laws<'a> {
    law: &'a dyn HyperelasticLaw,
    /// Nothing of an elastic law.
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
    /// Of an elastic law: of all points the same.
    pub fn elastic(law: &'a dyn HyperelasticLaw) -> Self {
        Self { law, history: None }
    }

    /// Of a material for the states of an element at the begin of a step of the size `dt`.
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

    /// A value at each of the Gauss points from `first` on: of all of them together where they have one law, else of one after the other. `of` is told the law and which of the points are asked for.
    #[inline]
    fn evaluate<T>(
        &self,
        first: usize,
        out: &mut [T],
        of: impl Fn(&dyn HyperelasticLaw, Range<usize>, &mut [T]) -> Result<(), PointError>,
    ) -> Result<(), PointError> {
        if self.history.is_none() {
            return of(self.law, 0..out.len(), out).map_err(|(k, error)| (first + k, error));
        }
        out.chunks_mut(1)
            .enumerate()
            .try_for_each(|(l, out)| of(&*self.at(first + l), l..l + 1, out).map_err(|(_, error)| (first + l, error)))
    }

    /// `W` at the Gauss points from `first` on.
    #[inline]
    pub fn energies(&self, first: usize, c: &[SymmetricTensor2], out: &mut [f64]) -> Result<(), PointError> {
        self.evaluate(first, out, |law, points, out| law.energies(&c[points], out))
    }

    /// `S` there.
    #[inline]
    pub fn stresses(
        &self,
        first: usize,
        c: &[SymmetricTensor2],
        out: &mut [SymmetricTensor2],
    ) -> Result<(), PointError> {
        self.evaluate(first, out, |law, points, out| law.stresses(&c[points], out))
    }

    /// `S` and `2 dS/dC` there.
    #[inline]
    pub fn stresses_and_elasticities(
        &self,
        first: usize,
        c: &[SymmetricTensor2],
        out: &mut [(SymmetricTensor2, Tensor4)],
    ) -> Result<(), PointError> {
        self.evaluate(first, out, |law, points, out| law.stresses_and_elasticities(&c[points], out))
    }

    /// The energy-momentum stress there, of points with these strains and energies at the start.
    #[inline]
    pub fn energy_momentum_stresses(
        &self,
        first: usize,
        (c_n, energy_n): (&[SymmetricTensor2], &[f64]),
        c_np1: &[SymmetricTensor2],
        out: &mut [SymmetricTensor2],
    ) -> Result<(), PointError> {
        self.evaluate(first, out, |law, points, out| {
            let (c_n, energy_n) = (&c_n[points.clone()], &energy_n[points.clone()]);
            stoss_continuum::energy_momentum_stresses(law, c_n, energy_n, &c_np1[points], out)
        })
    }

    /// The same with its tangent.
    #[inline]
    pub fn energy_momentum_stresses_and_tangents(
        &self,
        first: usize,
        (c_n, energy_n): (&[SymmetricTensor2], &[f64]),
        c_np1: &[SymmetricTensor2],
        out: &mut [(SymmetricTensor2, Tensor4)],
    ) -> Result<(), PointError> {
        self.evaluate(first, out, |law, points, out| {
            let (c_n, energy_n) = (&c_n[points.clone()], &energy_n[points.clone()]);
            stoss_continuum::energy_momentum_stresses_and_tangents(law, c_n, energy_n, &c_np1[points], out)
        })
    }
}

/// A Gauss point at which the law has no value, and why.
pub(crate) type PointError = (usize, ConstitutiveError);
