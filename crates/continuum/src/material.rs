//! Materials with history (theory/inelastic): the law of a step. Not a material, and not where states are kept.
//!
//! A point with an accepted state `z_n` is given, for a step of the size `h`, one scalar function of the strain: `w_n(C)`, the work per reference volume on the
//! path from `C_n` to `C`. Its stress is `S = 2 dw_n/dC`. This is what a hyperelastic law has too, so that [`StepLaw`] is one, and discrete gradients, averages
//! of elements and tangents take it as they take `W`. The work of a step is then `w_n(C_np1) - w_n(C_n)` exactly; what of it is not found as stored energy
//! of the next state is lost.

use crate::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4, VolumetricSplit};

/// What [`crate::discrete_gradient::SMALLEST_STRAIN_INCREMENT`] is to laws of a step. Smaller, because `w_n` has a kink in its second derivative where yielding
/// begins: what the quotient leaves out there is of second order in the increment.
pub const SMALLEST_STRAIN_INCREMENT_WITH_STATE: f64 = 1.0e-7;

/// Which function of the strain a point with a state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepStress {
    /// `w_n` whose discrete gradient is the stress of the step ([`crate::energy_momentum_stress`]): its stress at the mean strain, where half of the step is done,
    /// is the mean stress of the step.
    DiscreteGradient,
    /// `w_n` whose derivative is the stress at the end of the time `dt`: backward Euler, statics, and the point between the ends of midpoint rules.
    End,
    /// The stored energy `psi(C, z)` of the state as it is, without flow: of accepted states.
    Frozen,
}

/// A point in a step.
#[derive(Clone, Copy, Debug)]
pub struct PointStep<'a> {
    /// State at the begin of the step, as many numbers as [`Material::state`] says.
    pub state: &'a [f64],
    /// Time of the step, not negative. Rate-dependent flow needs time: with zero there is none.
    pub dt: f64,
    /// Which function is asked for.
    pub stress: StepStress,
}

/// How much of a [`Response`] is needed; the rest of it may be anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Want {
    /// `w`.
    Energy,
    /// `w` and the stress.
    Stress,
    /// `w`, the stress and the moduli.
    Moduli,
}

/// The function of the strain at one strain.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// `w_n(C)` or `psi(C, z)`, per reference volume.
    pub energy: f64,
    /// `S = 2 dw/dC`.
    pub stress: SymmetricTensor2,
    /// `2 dS/dC`.
    pub moduli: Tensor4,
}

/// What a step has lost at a point, per reference volume; none is negative but for round-off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loss {
    /// Energy lost by plastic flow.
    pub plastic: f64,
    /// Energy lost by viscous flow.
    pub viscous: f64,
    /// Energy lost by softening.
    pub softening: f64,
}

impl Loss {
    /// All of the loss.
    pub fn total(&self) -> f64 {
        self.plastic + self.viscous + self.softening
    }

    /// Adds `weight` times another loss.
    pub fn add(&mut self, weight: f64, other: &Self) {
        self.plastic += weight * other.plastic;
        self.viscous += weight * other.viscous;
        self.softening += weight * other.softening;
    }
}

/// Which ways of losing energy a material has: the parts of its [`Loss`] that can be other than zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mechanisms {
    /// Whether the material yields.
    pub plastic: bool,
    /// Whether the material relaxes.
    pub viscous: bool,
    /// Whether the material softens.
    pub softening: bool,
}

impl Mechanisms {
    /// All mechanisms.
    pub const ALL: Self = Self { plastic: true, viscous: true, softening: true };

    /// The mechanisms that either material has.
    pub fn or(self, other: Self) -> Self {
        Self {
            plastic: self.plastic || other.plastic,
            viscous: self.viscous || other.viscous,
            softening: self.softening || other.softening,
        }
    }
}

/// Some numbers of a state, or of what output shows of one, that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateEntry {
    /// Name in output.
    pub name: String,
    /// Number of components: 1, 3 of a vector, or 6 of a symmetric tensor in the order 11, 22, 33, 12, 23, 13.
    pub len: usize,
    /// What it measures, in one sentence.
    pub about: &'static str,
}

/// What output shows of a state: some numbers that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateOutput {
    /// Name, length, meaning.
    pub entry: StateEntry,
    /// Whether it jumps from point to point, as a switch does: nodes then get means of elements in place of extrapolations.
    pub jumps: bool,
}

/// A law with a state. As a hyperelastic law it is what a virgin point stores without flow; such a law says that it has a state by
/// [`HyperelasticLaw::history`], and its [`HyperelasticLaw::volumetric`] part must not depend on the state.
///
/// # What must hold
/// * `energy`, `stress` and `moduli` of a response are one function and its derivatives; it depends on nothing but its arguments.
/// * The stored energy is continuous from step to step: the frozen function of the new state at `C_np1` is what the step stored.
/// * [`Material::commit`] says what was lost: `w_n(C_np1) - w_n(C_n) - (psi(C_np1, z_np1) - psi(C_n, z_n))` under [`StepStress::DiscreteGradient`], to round-off.
///
/// # Errors
/// The errors of [`HyperelasticLaw`].
pub trait Material: HyperelasticLaw {
    /// The numbers of a point's state, in their order.
    fn state(&self) -> &[StateEntry];
    /// Length of the state of a point, in numbers.
    fn state_len(&self) -> usize {
        self.state().iter().map(|entry| entry.len).sum()
    }
    /// Writes the state of a point that has seen nothing.
    fn virgin(&self, state: &mut [f64]);
    /// The function of the strain that the point is.
    ///
    /// # Errors
    /// Inadmissible states, as for the trait.
    fn respond(
        &self,
        at: &PointStep<'_>,
        right_cauchy_green: &SymmetricTensor2,
        want: Want,
    ) -> Result<Response, ConstitutiveError>;
    /// Writes the state at the end of a step from `c_n` to `c_np1`, and says what was lost. Called once, when the step is accepted.
    ///
    /// # Errors
    /// Inadmissible states, as for the trait.
    fn commit(
        &self,
        at: &PointStep<'_>,
        c_n: &SymmetricTensor2,
        c_np1: &SymmetricTensor2,
        next: &mut [f64],
    ) -> Result<Loss, ConstitutiveError>;
    /// Which parts of the loss can be other than zero; all of them if the material does not say.
    fn mechanisms(&self) -> Mechanisms {
        Mechanisms::ALL
    }
    /// What output shows of a state, in the order of [`Material::output`]; nothing if the material does not say.
    fn outputs(&self) -> &[StateOutput] {
        &[]
    }
    /// Writes all numbers of [`Material::outputs`] for an accepted state; `before` is that at the begin of the step that led to it, or the state itself if there was none.
    fn output(&self, _before: &[f64], _state: &[f64], _out: &mut [f64]) {}
    /// Increment of the equivalent plastic strain between two states, which step control can limit; zero of what does not yield.
    fn flow(&self, _before: &[f64], _next: &[f64]) -> f64 {
        0.0
    }
    /// The part of the stored energy that is kept by hardening, per reference volume.
    fn hardening_energy(&self, _state: &[f64]) -> f64 {
        0.0
    }
}

/// A material at a point of a step, as a hyperelastic law.
#[derive(Clone, Copy, Debug)]
pub struct StepLaw<'a> {
    /// The material.
    pub material: &'a dyn Material,
    /// The point.
    pub at: PointStep<'a>,
}

impl HyperelasticLaw for StepLaw<'_> {
    fn name(&self) -> &str {
        self.material.name()
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        Ok(self.material.respond(&self.at, c, Want::Energy)?.energy)
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        Ok(self.material.respond(&self.at, c, Want::Stress)?.stress)
    }
    fn energy_and_stress(&self, c: &SymmetricTensor2) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let response = self.material.respond(&self.at, c, Want::Stress)?;
        Ok((response.energy, response.stress))
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let response = self.material.respond(&self.at, c, Want::Moduli)?;
        Ok((response.stress, response.moduli))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        self.material.small_strain_moduli()
    }
    fn smallest_strain_increment(&self) -> f64 {
        SMALLEST_STRAIN_INCREMENT_WITH_STATE
    }
    fn volumetric(&self) -> Option<VolumetricSplit> {
        None
    }
}
