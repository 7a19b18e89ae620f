//! What a contribution is evaluated at.

use stoss_integrators::{ForceRule, GradientRule};

/// The line of a scheme's residual `R = M a + w F - c G^T p` that is assembled, with the place in the step where its contributions are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// `F`: forces of energies, dampers and loads.
    Force(ForceRule),
    /// `-G^T p` and the rows of the multipliers; also the forces of potentials that act in the place of constraints.
    Constraint(GradientRule),
}

impl Rule {
    /// Configuration of the forces, if they are asked for.
    pub fn force(self) -> Option<ForceRule> {
        match self {
            Self::Force(rule) => Some(rule),
            Self::Constraint(_) => None,
        }
    }

    /// Configuration of the constraint gradients, if they are asked for.
    pub fn constraint(self) -> Option<GradientRule> {
        match self {
            Self::Force(_) => None,
            Self::Constraint(rule) => Some(rule),
        }
    }
}

/// An iterate of a step. Positions have `3 * nodes` entries, node-major, a length each; multipliers and flags are those of the term's own slots.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Converged positions at `n`.
    pub q_n: &'a [f64],
    /// Iterate of the positions at `n+1`.
    pub q_np1: &'a [f64],
    /// Which line of the residual, and where in the step.
    pub rule: Rule,
    /// Time at `n`.
    pub time: f64,
    /// Size of the step, a time.
    pub dt: f64,
    /// Whether there are rates: not in statics, nor at the start of a run; nothing is viscous then.
    pub rates: bool,
    /// One multiplier a slot.
    pub multipliers: &'a [f64],
    /// Further unknowns, slot by slot ([`crate::Term::auxiliaries`]). Empty: those that [`crate::Term::start_auxiliaries`] gives.
    pub auxiliaries: &'a [f64],
    /// Which slots act.
    pub active: &'a [bool],
    /// The positions at which the linear equations were solved last in this step: mixed solids linearise about what that solution says of their pressures.
    pub before: Option<&'a [f64]>,
}

impl<'a> At<'a> {
    /// The state at which the forces of a step with rates are taken.
    pub fn force([q_n, q_np1]: [&'a [f64]; 2], rule: ForceRule, dt: f64) -> Self {
        let rule = Rule::Force(rule);
        let (multipliers, auxiliaries, active) = (&[], &[], &[]);
        Self { q_n, q_np1, rule, time: 0.0, dt, rates: true, multipliers, auxiliaries, active, before: None }
    }

    /// The state at which constraints with these multipliers are taken, of which those act that `active` names.
    pub fn constraint(
        positions: [&'a [f64]; 2],
        rule: GradientRule,
        multipliers: &'a [f64],
        active: &'a [bool],
    ) -> Self {
        let rule = Rule::Constraint(rule);
        Self { rule, multipliers, active, ..Self::force(positions, ForceRule::END_POINT, 0.0) }
    }

    /// The end of a step of constraints, where their gradients are taken there.
    pub fn end(q_np1: &'a [f64], multipliers: &'a [f64], active: &'a [bool]) -> Self {
        Self::constraint([q_np1; 2], GradientRule::EndPoint, multipliers, active)
    }

    /// The state at given values of the further unknowns.
    #[must_use]
    pub fn with_auxiliaries(self, auxiliaries: &'a [f64]) -> Self {
        Self { auxiliaries, ..self }
    }

    /// A vector of the configuration `(1 - theta) q_n + theta q_np1`.
    pub fn between(&self, theta: f64, node: u32) -> [f64; 3] {
        let at = 3 * node as usize;
        std::array::from_fn(|i| {
            if theta == 1.0 {
                self.q_np1[at + i]
            } else {
                (1.0 - theta) * self.q_n[at + i] + theta * self.q_np1[at + i]
            }
        })
    }
}

/// Positions that a step's evaluation may read. All slices have `3 * nodes` entries, node-major.
#[derive(Clone, Copy, Debug)]
pub struct StepConfiguration<'a> {
    /// Converged positions at `n`.
    pub q_n: &'a [f64],
    /// Iterate of the positions at `n+1`.
    pub q_np1: &'a [f64],
    /// Rule of the scheme.
    pub rule: GradientRule,
}

impl<'a> StepConfiguration<'a> {
    /// Both configurations of an iterate, if constraints are asked for.
    pub fn of(at: &At<'a>) -> Option<Self> {
        Some(Self { q_n: at.q_n, q_np1: at.q_np1, rule: at.rule.constraint()? })
    }

    /// An iterate of constraints with these multipliers, of which those act that `active` names.
    pub fn at(self, multipliers: &'a [f64], active: &'a [bool]) -> At<'a> {
        At::constraint([self.q_n, self.q_np1], self.rule, multipliers, active)
    }
}
