//! Equations `phi(q) = 0` with a multiplier each: rigidity, joints.

use crate::quadratic::{Evaluation, Quadratics};
use stoss_contact::{
    Constraint, ContactError, ContactRule, History, LocalContribution, Report, SlotReport, StepConfiguration,
};

/// Equations of the same vectors: each of the functions is to be zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    functions: Quadratics,
}

impl Equation {
    /// One equation, thus one multiplier, for each function.
    pub fn each(functions: Quadratics) -> Self {
        Self { functions }
    }

    /// The functions.
    pub fn functions(&self) -> &Quadratics {
        &self.functions
    }
}

/// Fraction of the step at which a rule takes the gradients. They are linear in `q`, so that the mean of the gradients at both ends and the discrete
/// gradient are those at the midpoint.
pub(crate) fn gradient_fraction(rule: ContactRule) -> f64 {
    match rule {
        ContactRule::StartPoint => 0.0,
        ContactRule::EndPoint => 1.0,
        _ => 0.5,
    }
}

/// Bilateral constraints whose functions are quadratic in the positions, each with a multiplier. The functions are lengths and the multipliers
/// forces: `F = lambda grad phi`.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintSet {
    name: String,
    length: f64,
    equations: Vec<Equation>,
    slots: usize,
}

impl ConstraintSet {
    /// With a length against which violations are judged.
    pub fn new(name: &str, length: f64, equations: Vec<Equation>) -> Self {
        let slots = equations.iter().map(|e| e.functions.len()).sum();
        Self { name: name.to_owned(), length, equations, slots }
    }

    /// The equations; their functions are the slots, in this order.
    pub fn equations(&self) -> &[Equation] {
        &self.equations
    }
}

impl Report for ConstraintSet {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn report(&self, _q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        Ok(Vec::new())
    }
}

impl History for ConstraintSet {}

impl Constraint for ConstraintSet {
    fn slot_count(&self) -> usize {
        self.slots
    }

    fn slot_weight(&self, _slot: usize) -> f64 {
        1.0
    }

    fn is_symmetric(&self, rule: ContactRule) -> bool {
        rule == ContactRule::EndPoint
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let (mut slots, mut first) = (Vec::new(), 0);
        for equation in &self.equations {
            let count = equation.functions.len() as u32;
            slots.clear();
            slots.extend(first..first + count);
            first += count;
            visit(equation.functions.vectors(), &slots);
        }
    }

    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        multipliers: &[f64],
        _active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        let theta = gradient_fraction(step.rule);
        let mut local = LocalContribution::default();
        let (mut between, mut end) = (Evaluation::default(), Evaluation::default());
        let mut first = 0;
        for equation in &self.equations {
            let functions = &equation.functions;
            local.nodes.clear();
            local.nodes.extend_from_slice(functions.vectors());
            local.slots.clear();
            local.slots.extend((first..first + functions.len()).map(|slot| slot as u32));
            local.reset(want_tangent);
            functions.evaluate(step.q_n, step.q_np1, theta, true, &mut between);
            functions.evaluate(step.q_n, step.q_np1, 1.0, want_tangent, &mut end);
            let (n, dim) = (3 * local.nodes.len(), local.dim());
            for k in 0..functions.len() {
                let (multiplier, gradient) = (multipliers[first + k], &between.gradients[k * n..(k + 1) * n]);
                for (r, g) in local.residual.iter_mut().zip(gradient) {
                    *r -= multiplier * g;
                }
                local.residual[n + k] = -end.values[k];
                if want_tangent {
                    functions.add_second_derivatives(k, -multiplier * theta, dim, &mut local.tangent);
                    for i in 0..n {
                        local.tangent[i * dim + n + k] = -gradient[i];
                        local.tangent[(n + k) * dim + i] = -end.gradients[k * n + i];
                    }
                }
            }
            first += functions.len();
            visit(&local);
        }
        Ok(())
    }
}
