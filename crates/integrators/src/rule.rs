//! The equations of one step of a scheme, as data.
//!
//! The rules are exhaustive on purpose: a new one is a compile error wherever somebody has to decide what to do under it.

/// Configuration at which the forces `F(q)` of a step are evaluated, of solids (theory/kinematics#force, theory/integrators#schemes), parts and loads alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ForceRule {
    /// The force `F(q)` at one configuration `q_{n+theta} = (1 - theta) q_n + theta q_np1`: 0 the start, 1/2 the midpoint, 1 the end of the step. Of a solid: stress and strain-displacement
    /// matrix both with `F(q_{n+theta})`.
    ///
    /// Its derivative by `q_np1` is `theta` times the static one, symmetric. Forces have no resultant and, about `q_{n+theta}`, no moment; what that means for the momenta of a step is the
    /// scheme's matter (both are kept for `theta = 1/2` with `q_np1 - q_n = dt (v_n + v_np1)/2`).
    Configuration {
        /// Fraction of the step, in `[0, 1]`. `q_n` is not read for 1; `q_np1` is not read for 0, whose derivative is zero and is not computed. A number
        /// outside extrapolates.
        theta: f64,
    },
    /// Discrete gradient between `q_n` and `q_np1`: `F_bar . (q_np1 - q_n) = V_np1 - V_n`. Of a solid: the stress of theory/integrators#eq-ems with the mean deformation gradient. Keeps
    /// momenta, and its work is the change of energy. Unsymmetric derivative (theory/integrators#eq-ems-stiffness).
    DiscreteGradient,
}

impl ForceRule {
    /// Forces at `q_n`.
    pub const START: Self = Self::Configuration { theta: 0.0 };
    /// Forces at the midpoint.
    pub const MIDPOINT: Self = Self::Configuration { theta: 0.5 };
    /// Forces at `q_np1`.
    pub const END_POINT: Self = Self::Configuration { theta: 1.0 };

    /// Whether the force depends on `q_n`.
    pub fn reads_start(self) -> bool {
        self != Self::END_POINT
    }

    /// Whether the force depends on `q_np1`; if not, its derivative is zero.
    pub fn reads_end(self) -> bool {
        self != Self::START
    }

    /// Fraction of the step at which time-dependent loads are evaluated (`t_n + fraction * dt`).
    pub fn load_fraction(self) -> f64 {
        match self {
            Self::Configuration { theta } => theta,
            Self::DiscreteGradient => 0.5,
        }
    }
}

/// Configuration at which the constraint gradients `G(q)` of a step are evaluated: those of joints, and of the gap that make the contact force `A p G` (theory/node-to-surface#residual).
///
/// The constraint itself is always that of `q_np1`, for multipliers. The forces of every rule have no resultant; about which configuration they have no moment is said for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GradientRule {
    /// `G(q_n)`, constant in the step (variational midpoint scheme: theory/integrators#eq-variational). No moment about `q_n`.
    StartPoint,
    /// `G(q_mid)` (midpoint rule: theory/integrators#eq-midpoint). No moment about `q_mid`.
    Midpoint,
    /// `G(q_np1)` (statics, backward Euler: theory/integrators#eq-backward-euler). No moment about `q_np1`.
    EndPoint,
    /// `(G(q_n) + G(q_np1)) / 2` (trapezoidal rule: theory/integrators#eq-trapezoidal). The moment about `q_mid` is `-(1/4) sum dq x (G(q_np1) - G(q_n))`: for a contact it vanishes in a
    /// rigid motion on one facet, otherwise only with the step.
    EndPointMean,
    /// Discrete gradient between `q_n` and `q_np1`: `G . (q_np1 - q_n) = g_np1 - g_n`. No moment about `q_mid`.
    DiscreteGradient,
}

impl GradientRule {
    /// All rules of gradients.
    pub const ALL: [Self; 5] =
        [Self::StartPoint, Self::EndPoint, Self::EndPointMean, Self::Midpoint, Self::DiscreteGradient];
}

/// `increment (q_np1 - q_n) + velocity v_n + acceleration a_n`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Combination {
    /// Factor of `q_np1 - q_n`.
    pub increment: f64,
    /// Factor of `v_n`.
    pub velocity: f64,
    /// Factor of `a_n`.
    pub acceleration: f64,
}

impl Combination {
    /// A combination without an acceleration.
    pub fn new(increment: f64, velocity: f64) -> Self {
        Self { increment, velocity, acceleration: 0.0 }
    }
}

/// `weight * F_rule`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceTerm {
    /// Configuration of the forces.
    pub rule: ForceRule,
    /// Factor in the residual; with zero they are not evaluated during the iteration.
    pub weight: f64,
}

/// `weight * G_rule^T p`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstraintTerm {
    /// Configuration of the constraint gradients.
    pub rule: GradientRule,
    /// Factor in the residual.
    pub weight: f64,
}

/// `weight * H_n`: forces of the last end point, kept in [`crate::State::history`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryTerm {
    /// Factor in the residual.
    pub weight: f64,
    /// `H` contains `F`.
    pub force: bool,
    /// `H` contains `-G^T p`.
    pub constraint: bool,
}

impl HistoryTerm {
    /// False if no history is needed: constraint forces only, in a system without constraints.
    pub fn is_needed(&self, constrained: bool) -> bool {
        self.force || (self.constraint && constrained)
    }
}

/// Equations of one step of a scheme for one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRule {
    /// Algorithmic acceleration `a_alg`; all zero: no inertia.
    pub inertia: Combination,
    /// Forces.
    pub force: ForceTerm,
    /// Constraint forces.
    pub constraint: ConstraintTerm,
    /// Forces of the last end point. A scheme that asks for `H` takes its forces and constraint gradients, as far as they are in `H`, at
    /// the end point, so that those of the converged step are the next history.
    pub history: Option<HistoryTerm>,
    /// `v_np1`, if `impulse` is `None`.
    pub velocity: Combination,
    /// `M v_np1 = M velocity(..) + impulse F_rule`: an update of momenta. A time.
    pub impulse: Option<f64>,
    /// `a_np1`, for schemes that carry an acceleration.
    pub acceleration: Option<Combination>,
}

impl StepRule {
    /// Static equilibrium at the end of the step, without inertia; the velocity is the mean one of the step.
    pub fn quasi_static(dt: f64) -> Self {
        Self {
            inertia: Combination::default(),
            force: ForceTerm { rule: ForceRule::END_POINT, weight: 1.0 },
            constraint: ConstraintTerm { rule: GradientRule::EndPoint, weight: 1.0 },
            history: None,
            velocity: Combination::new(1.0 / dt, 0.0),
            impulse: None,
            acceleration: None,
        }
    }

    /// Factor of the damping forces in the residual: the sum of the weights of the forces at both ends, because damping forces have no history.
    pub fn damping_weight(&self) -> f64 {
        self.force.weight + self.history.filter(|history| history.force).map_or(0.0, |history| history.weight)
    }

    /// Whether a barrier potential can be integrated: constraint forces must be those of the end of the step, or a discrete gradient, without history. A scheme that carries
    /// accelerations keeps the force of an impact in the next step, and gains energy.
    pub fn carries_barriers(&self) -> bool {
        let ConstraintTerm { rule, weight } = self.constraint;
        matches!(rule, GradientRule::EndPoint | GradientRule::DiscreteGradient)
            && weight == 1.0
            && self.history.is_none()
            && self.acceleration.is_none()
    }

    /// True for a rule whose state has accelerations (generalised-alpha and its relatives): the acceleration of a node that has just closed holds the force of the impact, and the next
    /// step takes it for one that goes on. The gain of energy does not fall with the step.
    pub fn gains_energy_in_impacts(&self) -> bool {
        self.acceleration.is_some()
    }

    /// True if the step has a mass term.
    pub fn has_inertia(&self) -> bool {
        self.inertia != Combination::default()
    }
}
