//! Von Mises plasticity with isotropic and linear kinematic hardening and an overstress (theory/inelastic#plasticity). A branch of [`crate::Inelastic`].

use crate::error::{MaterialError, finite};
use crate::hardening::Hardening;
use crate::logarithmic::LogModuli;
use stoss_continuum::{Loss, StepStress, SymmetricTensor2};

const NAME: &str = "plasticity";

/// Overstress `stress (a' / rate)^exponent` above the yield stress, of the rate `a'` of the equivalent plastic strain (Perzyna, Norton).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overstress {
    /// The overstress at the rate `rate` (stress).
    pub stress: f64,
    /// A rate (1 over time).
    pub rate: f64,
    /// The exponent, positive.
    pub exponent: f64,
}

/// Yield stress and hardening.
#[derive(Clone, Debug, PartialEq)]
pub struct Plasticity {
    /// Isotropic hardening.
    pub hardening: Hardening,
    /// Modulus of linear kinematic hardening in uniaxial stress (stress), not negative.
    pub kinematic: f64,
    /// Rate dependence, if there is any.
    pub overstress: Option<Overstress>,
}

impl Plasticity {
    /// Refuses what cannot be, for the elastic shear modulus.
    pub(crate) fn check(&self, shear: f64) -> Result<(), MaterialError> {
        let refuse = |parameter, value, range| Err(MaterialError::OutOfRange { law: NAME, parameter, value, range });
        self.hardening.check()?;
        finite(NAME, &[("kinematic_modulus", self.kinematic)])?;
        if self.kinematic < 0.0 {
            return refuse("kinematic_modulus", self.kinematic, "zero or positive");
        }
        let slope = self.hardening.smallest_slope();
        if slope <= -(3.0 * shear + self.kinematic) {
            return refuse(
                "hardening_modulus",
                slope,
                "above -(3 mu + kinematic_modulus), or the return has no solution",
            );
        }
        if let Some(Overstress { stress, rate, exponent }) = self.overstress {
            for (parameter, value) in [("stress", stress), ("rate", rate), ("exponent", exponent)] {
                finite(NAME, &[(parameter, value)])?;
                if value <= 0.0 {
                    return refuse(parameter, value, "positive (overstress)");
                }
            }
        }
        Ok(())
    }
}

/// The elastic shear modulus with what yields behind it.
#[derive(Clone, Debug)]
pub(crate) struct J2 {
    pub mu: f64,
    pub of: Plasticity,
}

/// State behind the map: equivalent plastic strain, back strain.
#[derive(Clone, Copy)]
pub(crate) struct J2State {
    pub alpha: f64,
    pub back: SymmetricTensor2,
}

/// What a return to the yield surface gives.
pub(crate) struct Return {
    /// Increment of the equivalent plastic strain.
    pub increment: f64,
    /// `2 mu e - 2/3 H_k b_n` of the trial state, and its von Mises measure.
    relative: SymmetricTensor2,
    mises: f64,
    /// `3 mu + H_k + sigma_y' + overstress'` at the increment.
    stiffness: f64,
}

impl Return {
    /// The flow: deviatoric, `sqrt(2/3)` of its norm is the increment.
    pub fn flow(&self) -> SymmetricTensor2 {
        if self.increment == 0.0 { SymmetricTensor2::ZERO } else { self.relative * (1.5 * self.increment / self.mises) }
    }
}

/// Value, stress and moduli in terms of the deviator of the strain.
pub(crate) struct LogResponse {
    pub energy: f64,
    pub stress: SymmetricTensor2,
    pub moduli: LogModuli,
}

impl J2 {
    pub fn has_back_strain(&self) -> bool {
        self.of.kinematic > 0.0
    }

    /// Back stress of a back strain.
    pub fn back_stress(&self, back: &SymmetricTensor2) -> SymmetricTensor2 {
        *back * (2.0 / 3.0 * self.of.kinematic)
    }

    /// Overstress, its slope by the increment, and its potential, for an increment in the time `t`.
    fn overstress(&self, increment: f64, t: f64) -> (f64, f64, f64) {
        let Some(Overstress { stress, rate, exponent: m }) = self.of.overstress else { return (0.0, 0.0, 0.0) };
        let r = increment / (t * rate);
        let slope = if increment > 0.0 { stress * m * r.powf(m - 1.0) / (t * rate) } else { 0.0 };
        (stress * r.powf(m), slope, stress * t * rate / (m + 1.0) * r.powf(m + 1.0))
    }

    /// Radial return from the elastic trial strain `e` (deviatoric) in the time `t`.
    pub fn solve(&self, e: &SymmetricTensor2, state: &J2State, t: f64) -> Return {
        let kinematic = self.of.kinematic;
        let relative = *e * (2.0 * self.mu) + state.back * (-2.0 / 3.0 * kinematic);
        let mises = 1.5_f64.sqrt() * relative.norm();
        let stiff = 3.0 * self.mu + kinematic;
        let (yield_stress, slope) = self.of.hardening.at(state.alpha);
        let yielding = mises - yield_stress;
        let has_time = self.of.overstress.is_none() || t > 0.0;
        if !(yielding > 1e-13 * mises && has_time) {
            return Return { increment: 0.0, relative, mises, stiffness: stiff };
        }
        // The residual falls with x. Newton's method inside of a bracket; it ends on the change of x before the bracket is asked, for its last bisection would
        // destroy the root.
        let (mut low, mut high) = (0.0, mises / stiff);
        let mut x = if self.of.overstress.is_some() { 1e-3 * high } else { yielding / (stiff + slope.max(0.0)) };
        let mut stiffness = stiff;
        for _ in 0..100 {
            let ((s, ds), (o, d_o, _)) = (self.of.hardening.at(state.alpha + x), self.overstress(x, t));
            let residual = mises - stiff * x - s - o;
            stiffness = stiff + ds + d_o;
            let mut new = x + residual / stiffness;
            if (new - x).abs() <= 4.0 * f64::EPSILON * x {
                x = new;
                break;
            }
            if residual > 0.0 {
                low = x
            } else {
                high = x
            }
            if !(new > low && new < high) {
                new = 0.5 * (low + high);
            }
            x = new;
        }
        Return { increment: x, relative, mises, stiffness }
    }

    /// `w_t(e) = min (stored + s0 x + P_t(x))` and its derivatives (theory/inelastic#eq-potential); without hardening energy of the begin.
    pub fn respond(&self, e: &SymmetricTensor2, state: &J2State, t: f64) -> LogResponse {
        let (mu, kinematic) = (self.mu, self.of.kinematic);
        let found = self.solve(e, state, t);
        let x = found.increment;
        if x == 0.0 {
            return self.elastic(e);
        }
        let n = found.relative * (1.5_f64.sqrt() / found.mises);
        let flow = n * (1.5_f64.sqrt() * x);
        let s = *e - flow;
        let energy = mu * s.double_contract(&s)
            + kinematic / 3.0 * (flow + state.back * 2.0).double_contract(&flow)
            + self.of.hardening.stored(state.alpha, state.alpha + x)
            + self.of.hardening.initial() * x
            + if self.of.overstress.is_some() { self.overstress(x, t).2 } else { 0.0 };
        let across = 2.0 * mu * (1.0 - 3.0 * mu * x / found.mises);
        let along = 2.0 * mu * (1.0 - 3.0 * mu / found.stiffness);
        let moduli = LogModuli { unit: across, sphere: -across / 3.0, along: along - across, direction: n };
        LogResponse { energy, stress: s * (2.0 * mu), moduli }
    }

    /// Energy, stress and moduli of a step without flow.
    pub fn elastic(&self, e: &SymmetricTensor2) -> LogResponse {
        LogResponse {
            energy: self.mu * e.double_contract(e),
            stress: *e * (2.0 * self.mu),
            moduli: LogModuli::shear(2.0 * self.mu),
        }
    }

    /// The time in which the return of a step's law flows: at the mean strain, whose stress a discrete gradient takes, half of the step is done.
    pub fn time(stress: StepStress, dt: f64) -> f64 {
        match stress {
            StepStress::DiscreteGradient => 0.5 * dt,
            StepStress::End | StepStress::Frozen => dt,
        }
    }

    /// Energy that hardening keeps.
    pub fn hardening_energy(&self, state: &J2State) -> f64 {
        self.of.kinematic / 3.0 * state.back.double_contract(&state.back) + self.of.hardening.stored(0.0, state.alpha)
    }

    /// What was lost by the return `found` in a step from the elastic strain `e_n` to the trial strain `e_np1` (deviators).
    pub fn loss(
        &self,
        found: &Return,
        state: &J2State,
        [e_n, e_np1]: [&SymmetricTensor2; 2],
        stress: StepStress,
        dt: f64,
    ) -> Loss {
        let x = found.increment;
        let plain = self.of.hardening.initial() * x;
        let plastic = match (&self.of.overstress, stress) {
            (None, _) => plain,
            (Some(_), StepStress::DiscreteGradient) => {
                // Work less the change of the stored energy; at least `plain` (theory/inelastic#overstress).
                let t = Self::time(stress, dt);
                let work = self.respond(e_np1, state, t).energy - self.respond(e_n, state, t).energy;
                let flow = found.flow();
                let s = *e_np1 - flow;
                let stored = self.mu * (s.double_contract(&s) - e_n.double_contract(e_n))
                    + self.of.kinematic / 3.0 * (flow + state.back * 2.0).double_contract(&flow)
                    + self.of.hardening.stored(state.alpha, state.alpha + x);
                work - stored
            }
            (Some(_), _) => plain + if x > 0.0 { self.overstress(x, dt).0 * x } else { 0.0 },
        };
        Loss { plastic, ..Loss::default() }
    }
}
