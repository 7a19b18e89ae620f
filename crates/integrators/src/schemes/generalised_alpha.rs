//! Generalised-alpha family (theory/integrators#eq-generalised-alpha; thesis (5.27)-(5.31), (6.21) corrected, (6.24), (6.25)).

use crate::{Claims, Combination, ConstraintTerm, ForceRule, ForceTerm, GradientRule, HistoryTerm, Scheme, StepRule};

/// How forces are averaged over the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceAverage {
    /// `F((1 - alpha_f) q_np1 + alpha_f q_n)`, as in (6.21) of the thesis.
    #[default]
    Configuration,
    /// `(1 - alpha_f) F(q_np1) + alpha_f F(q_n)`, as in (5.27) of the thesis.
    Forces,
}

/// `M [(1 - alpha_m) a_np1 + alpha_m a_n] + F at n+1-alpha_f - [(1 - alpha_f) (G^T p)_np1 + alpha_f (G^T p)_n] = 0` with Newmark's formulae
/// `q_np1 = q_n + dt v_n + dt^2 [(1/2 - beta) a_n + beta a_np1]`, `v_np1 = v_n + dt [(1 - gamma) a_n + gamma a_np1]`.
///
/// Second order for `gamma = 1/2 - alpha_m + alpha_f`; conserves linear momentum; dissipates high frequencies of linear systems. Nothing bounds
/// the energy of stiff nonlinear ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralisedAlpha {
    name: &'static str,
    /// Weight of the old acceleration.
    pub alpha_m: f64,
    /// Weight of the old forces.
    pub alpha_f: f64,
    /// Newmark's beta.
    pub beta: f64,
    /// Newmark's gamma.
    pub gamma: f64,
    /// Average of the forces over the step.
    pub average: ForceAverage,
}

impl GeneralisedAlpha {
    /// Second-order member with `beta = (1 - alpha_m + alpha_f)^2 / 4`, which damps high frequencies most: thesis (5.31).
    fn optimal(name: &'static str, alpha_m: f64, alpha_f: f64) -> Self {
        let s = 1.0 - alpha_m + alpha_f;
        Self { name, alpha_m, alpha_f, beta: 0.25 * s * s, gamma: s - 0.5, average: ForceAverage::default() }
    }

    /// The scheme with a spectral radius `rho_inf` in `[0, 1]` at infinite frequency:
    /// `alpha_m = (2 rho - 1)/(rho + 1)`, `alpha_f = rho/(rho + 1)`.
    pub fn chung_hulbert(rho_inf: f64) -> Self {
        let d = rho_inf + 1.0;
        Self::optimal("generalised-alpha", (2.0 * rho_inf - 1.0) / d, rho_inf / d)
    }

    /// Hilber, Hughes, Taylor: `alpha_m = 0`, `alpha_f = (1 - rho)/(1 + rho)`, `rho_inf` in `[1/2, 1]`.
    pub fn hht(rho_inf: f64) -> Self {
        Self::optimal("hht", 0.0, (1.0 - rho_inf) / (1.0 + rho_inf))
    }

    /// Wood, Bossak, Zienkiewicz: `alpha_f = 0`, `alpha_m = (rho - 1)/(rho + 1)`, `rho_inf` in `[0, 1]`.
    pub fn wbz(rho_inf: f64) -> Self {
        Self::optimal("wbz", (rho_inf - 1.0) / (rho_inf + 1.0), 0.0)
    }

    /// Newmark: `alpha_m = alpha_f = 0`.
    pub fn newmark(beta: f64, gamma: f64) -> Self {
        Self { name: "newmark", alpha_m: 0.0, alpha_f: 0.0, beta, gamma, average: ForceAverage::default() }
    }
}

impl Scheme for GeneralisedAlpha {
    fn name(&self) -> &'static str {
        self.name
    }
    fn claims(&self) -> Claims {
        let second = (self.gamma - (0.5 - self.alpha_m + self.alpha_f)).abs() < 1e-12;
        Claims {
            order: if second { 2 } else { 1 },
            linear_momentum: true,
            angular_momentum: false,
            energy: false,
            constraints: true,
        }
    }
    fn rule(&self, dt: f64) -> StepRule {
        let Self { alpha_m, alpha_f, beta, gamma, average, .. } = *self;
        let new = 1.0 - alpha_f;
        // a_np1 = [q_np1 - q_n - dt v_n]/(beta dt^2) - (1/(2 beta) - 1) a_n
        let acceleration = Combination {
            increment: 1.0 / (beta * dt * dt),
            velocity: -1.0 / (beta * dt),
            acceleration: 1.0 - 0.5 / beta,
        };
        let scaled = |factor: f64, velocity: f64, old: f64| Combination {
            increment: factor * acceleration.increment,
            velocity: factor * acceleration.velocity + velocity,
            acceleration: factor * acceleration.acceleration + old,
        };
        let by_forces = average == ForceAverage::Forces;
        let force = if by_forces {
            ForceTerm { rule: ForceRule::END_POINT, weight: new }
        } else {
            ForceTerm { rule: ForceRule::Configuration { theta: new }, weight: 1.0 }
        };
        StepRule {
            inertia: scaled(1.0 - alpha_m, 0.0, alpha_m),
            force,
            constraint: ConstraintTerm { rule: GradientRule::EndPoint, weight: new },
            history: (alpha_f != 0.0).then_some(HistoryTerm { weight: alpha_f, force: by_forces, constraint: true }),
            velocity: scaled(dt * gamma, 1.0, dt * (1.0 - gamma)),
            impulse: None,
            acceleration: Some(acceleration),
        }
    }
}
