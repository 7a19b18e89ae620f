//! Equations `phi(q) = 0` with a multiplier each: rigidity, joints.

use crate::compliance::{Compliance, Weights};
use crate::quadratic::{Evaluation, Quadratics};
use stoss_term::{At, Bilateral, Fault, GradientRule, Local, Rule, StepConfiguration, StepContext, Term};

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
pub(crate) fn gradient_fraction(rule: GradientRule) -> f64 {
    match rule {
        GradientRule::StartPoint => 0.0,
        GradientRule::EndPoint => 1.0,
        GradientRule::EndPointMean | GradientRule::Midpoint | GradientRule::DiscreteGradient => 0.5,
    }
}

/// Equations among the slots of a local contribution.
pub(crate) struct Rows<'a> {
    /// The functions, whose vectors are the nodes of the contribution.
    pub functions: &'a Quadratics,
    /// Slot of the first function; those after the first `count` are no equations.
    pub first: usize,
    /// Number of equations.
    pub count: usize,
    /// Fraction of the step at which gradients are taken, see [`gradient_fraction`].
    pub theta: f64,
}

impl Rows<'_> {
    /// Adds `-lambda_k grad phi_k` to the forces, the rows `-phi_k`, and their tangent, of all equations that are among the slots. Functions are evaluated at
    /// `theta` and at the end of the step.
    pub fn add(
        &self,
        [between, end]: [&Evaluation; 2],
        multipliers: &[f64],
        compliance: &Compliance,
        want_tangent: bool,
        local: &mut Local,
    ) {
        let (n, dim) = (3 * local.nodes.len(), local.dim());
        for at in 0..local.slots.len() {
            let slot = local.slots[at] as usize;
            let Some(k) = slot.checked_sub(self.first).filter(|k| *k < self.count) else { continue };
            let (multiplier, gradient) = (multipliers[slot], &between.gradients[k * n..(k + 1) * n]);
            for (r, g) in local.residual.iter_mut().zip(gradient) {
                *r -= multiplier * g;
            }
            local.residual[n + at] = -end.values[k];
            if want_tangent {
                self.functions.add_second_derivatives(k, -multiplier * self.theta, dim, &mut local.tangent);
                for i in 0..n {
                    local.tangent[i * dim + n + at] = -gradient[i];
                    local.tangent[(n + at) * dim + i] = -end.gradients[k * n + i];
                }
            }
            compliance.add(n + at, multiplier, want_tangent, local);
        }
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
    rigidity: bool,
    compliance: Compliance,
}

impl ConstraintSet {
    /// A set of equations with a length against which violations are judged.
    pub fn new(name: &str, length: f64, equations: Vec<Equation>) -> Self {
        let slots = equations.iter().map(|e| e.functions.len()).sum();
        Self { name: name.to_owned(), length, equations, slots, rigidity: false, compliance: Compliance::default() }
    }

    /// The set as rigidity of a body or of the nodes of a beam: what determines the shape of one thing and joins it to nothing.
    #[must_use]
    pub fn as_rigidity(mut self) -> Self {
        self.rigidity = true;
        self
    }

    /// Whether the set is rigidity, see [`Self::as_rigidity`].
    pub fn is_rigidity(&self) -> bool {
        self.rigidity
    }

    /// The equations; their functions are the slots, in this order.
    pub fn equations(&self) -> &[Equation] {
        &self.equations
    }

    /// Makes the slots compliant in the tangent, for sets some of whose equations follow from others; `None` takes it back. See [`crate::analyse`].
    pub fn set_redundant(&mut self, weights: Option<Weights>) {
        self.compliance.set(weights);
    }
}

impl Term for ConstraintSet {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn slot_count(&self) -> usize {
        self.slots
    }

    fn slot_weight(&self, _slot: usize) -> f64 {
        1.0
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        rule == Rule::Constraint(GradientRule::EndPoint)
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        self.compliance.begin(step.dt);
        Ok(())
    }

    fn renew(&mut self, _at: &At<'_>, want_tangent: bool) -> Result<bool, Fault> {
        self.compliance.renew(want_tangent);
        Ok(false)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let (mut slots, mut first) = (Vec::new(), 0);
        for equation in &self.equations {
            let count = equation.functions.len() as u32;
            slots.clear();
            slots.extend((first..first + count).filter(|&slot| active[slot as usize]));
            first += count;
            if !slots.is_empty() {
                visit(equation.functions.vectors(), &slots);
            }
        }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers, active, .. } = *at;
        let theta = gradient_fraction(step.rule);
        let mut local = Local::default();
        let (mut between, mut end) = (Evaluation::default(), Evaluation::default());
        let mut first = 0;
        for equation in &self.equations {
            let functions = &equation.functions;
            let range = first..first + functions.len();
            local.slots.clear();
            local.slots.extend(range.filter(|&slot| active[slot]).map(|slot| slot as u32));
            first += functions.len();
            if local.slots.is_empty() {
                continue;
            }
            local.nodes.clear();
            local.nodes.extend_from_slice(functions.vectors());
            local.reset(want_tangent);
            functions.evaluate(step.q_n, step.q_np1, theta, true, &mut between);
            functions.evaluate(step.q_n, step.q_np1, 1.0, want_tangent, &mut end);
            let rows = Rows { functions, first: first - functions.len(), count: functions.len(), theta };
            rows.add([&between, &end], multipliers, &self.compliance, want_tangent, &mut local);
            visit(&local);
        }
        Ok(())
    }

    fn bilateral(&self) -> Option<&dyn Bilateral> {
        Some(self)
    }
}

impl Bilateral for ConstraintSet {}
