//! Which stress acts on which configuration during a step.

/// Which stress acts on which configuration during a step (theory/kinematics#force, theory/integrators#schemes).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StressRule {
    /// The force `F(q)` of hyperelasticity at one configuration `q_{n+theta} = (1 - theta) q_n + theta q_np1`: stress
    /// `S(F^T F)` and `B` both with `F = F(q_{n+theta})`.
    ///
    /// The tangent `dF/dq_np1` is `theta` times the static one, symmetric. Forces have no resultant and, about
    /// `q_{n+theta}`, no moment; what that means for the momenta of a step is the scheme's matter (both are kept for
    /// `theta = 1/2` with `q_np1 - q_n = dt (v_n + v_np1)/2`).
    Configuration {
        /// Fraction of the step, in `[0, 1]`. `q_n` is not read for 1; `q_np1` is not read for 0, whose tangent is zero
        /// and is not computed. In between `det F > 0` is demanded of `q_np1` too. A number outside extrapolates.
        theta: f64,
    },
    /// The stress of theory/integrators#eq-ems with `F_mid`. Keeps momenta, and its work is the change of strain energy.
    /// Unsymmetric tangent (theory/integrators#eq-ems-stiffness).
    EnergyMomentum,
}

impl StressRule {
    /// `S(C_np1)` with `F_np1` (statics, end-point schemes); `q_n` is not read.
    pub const END_POINT: Self = Self::Configuration { theta: 1.0 };
    /// `S(F_mid^T F_mid)` with `F_mid = F(q_mid)`. Keeps both momenta.
    pub const MIDPOINT: Self = Self::Configuration { theta: 0.5 };

    /// Whether the force depends on `q_n`.
    pub(crate) fn reads_start(self) -> bool {
        self != Self::END_POINT
    }

    /// Whether the force depends on `q_np1`; if not, its tangent is zero.
    pub(crate) fn reads_end(self) -> bool {
        self != Self::Configuration { theta: 0.0 }
    }
}

/// The two configurations of a step and the rule. Positions of the whole model, node-major, `3 * nodes` entries; a length.
#[derive(Clone, Copy, Debug)]
pub struct SolidStep<'a> {
    /// Beginning of the step (not read by [`StressRule::END_POINT`]).
    pub q_n: &'a [f64],
    /// End of the step: the unknown (not read by the rule with `theta = 0`).
    pub q_np1: &'a [f64],
    /// The rule.
    pub rule: StressRule,
}
