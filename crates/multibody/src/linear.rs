//! Linear equations between the displacements of points, each with a multiplier: multi-point constraints.

use crate::compliance::{Compliance, Weights};
use crate::{Drive, Embedded, PiecewiseLinear};
use std::collections::BTreeMap;
use stoss_term::{At, Bilateral, Fault, Local, Rule, SlotKind, StepConfiguration, StepContext, Term, Undefined, Work};

/// Part of the length scale by which an equation without a multiplier may be violated.
const MISSED: f64 = 1e-6;
/// Part of the factors of an equation that is round-off in their sum.
const ROUND_OFF: f64 = 1e-12;

/// Points `x_k` and their factors `a_k` in one equation.
pub type LinearTerms = Vec<(Embedded, [f64; 3])>;

/// Why factors make no equation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearEquationError {
    /// All factors are zero, cancel, or belong to points of the ground.
    #[error("equation {number} of {name} has no factor that is not zero at a point that can move")]
    NoFactor {
        /// Name of the equations.
        name: String,
        /// Number of the equation, from 1.
        number: usize,
    },
    /// A factor is not finite.
    #[error("equation {number} of {name} has a factor {value:e}, which is not finite")]
    Factor {
        /// Name of the equations.
        name: String,
        /// Number of the equation, from 1.
        number: usize,
        /// The factor.
        value: f64,
    },
}

/// An equation `phi = sum g . (q - Q) - b`.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    vectors: Vec<u32>,
    /// `g`, three entries for each vector.
    gradient: Vec<f64>,
    /// `Q`, the vectors in the reference configuration.
    reference: Vec<f64>,
    /// Largest entry of `g`.
    size: f64,
}

impl Row {
    /// `sum g . (q - Q)`.
    fn value(&self, q: &[f64]) -> f64 {
        let own = self.gradient.chunks_exact(3).zip(self.reference.chunks_exact(3)).zip(&self.vectors);
        own.map(|((g, x), &vector)| (0..3).map(|i| g[i] * (q[3 * vector as usize + i] - x[i])).sum::<f64>()).sum()
    }
}

/// Linear equations `sum_k a_k . (x_k - X_k) = b(t)` between points of bodies, with the same right-hand side `b`, a factor times a length (theory/multibody#linear).
///
/// The force on a point is `lambda a_k`. The gradient is constant, so that the equation and its force are the same under every rule of a scheme, and the work of the
/// forces in a step is `lambda (b_n+1 - b_n)`: zero for a constant `b`. All points of an equation form one dense contribution: use a few hundred nodes at most.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEquations {
    name: String,
    length: f64,
    rows: Vec<Row>,
    value: PiecewiseLinear,
    /// Whether the factors of each equation add up to zero.
    is_free_of_ground: bool,
    /// Start and end of the step.
    times: [f64; 2],
    has_rates: bool,
    /// Multipliers at the end of the last accepted step, for the work in statics.
    last: Vec<f64>,
    compliance: Compliance,
}

impl LinearEquations {
    /// The equations for these points with their factors, an equation each; `reference` has the positions of all vectors in the reference configuration (three
    /// entries each), and violations are judged against `length`.
    ///
    /// # Errors
    /// [`LinearEquationError`].
    pub fn new(
        name: &str,
        length: f64,
        equations: &[LinearTerms],
        value: PiecewiseLinear,
        reference: &[f64],
    ) -> Result<Self, LinearEquationError> {
        let rows = equations.iter().enumerate().map(|(k, terms)| row(name, k + 1, terms, reference));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        // Of a point the weights of its positions add up to 1.
        let balances = |terms: &LinearTerms| {
            let moving = || terms.iter().filter(|(point, _)| !point.terms.is_empty()).map(|(_, factor)| factor);
            let size = moving().flatten().fold(0.0_f64, |size, a| size.max(a.abs()));
            (0..3).all(|i| moving().map(|a| a[i]).sum::<f64>().abs() <= ROUND_OFF * size)
        };
        Ok(Self {
            name: name.to_owned(),
            length,
            last: vec![0.0; rows.len()],
            rows,
            value,
            is_free_of_ground: equations.iter().all(balances),
            times: [0.0; 2],
            has_rates: false,
            compliance: Compliance::default(),
        })
    }

    /// Whether the right-hand side changes with time.
    pub fn moves(&self) -> bool {
        self.value.0.windows(2).any(|pair| pair[0].1 != pair[1].1)
    }

    /// Makes the slots compliant in the tangent; see [`crate::ConstraintSet::set_redundant`].
    pub fn set_redundant(&mut self, weights: Option<Weights>) {
        self.compliance.set(weights);
    }

    /// `phi` of an equation at the end of the step.
    fn violation(&self, slot: usize, q: &[f64]) -> f64 {
        self.rows[slot].value(q) - self.value.value(self.times[1])
    }
}

/// The sum of the points by vectors.
fn row(name: &str, number: usize, terms: &LinearTerms, reference: &[f64]) -> Result<Row, LinearEquationError> {
    let mut by_vector: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for (point, factor) in terms {
        for &(vector, weight) in &point.terms {
            let own = by_vector.entry(vector).or_default();
            (0..3).for_each(|i| own[i] += weight * factor[i]);
        }
    }
    let given = terms.iter().flat_map(|(_, factor)| factor).fold(0.0_f64, |size, a| size.max(a.abs()));
    if let Some(&value) = terms.iter().flat_map(|(_, factor)| factor).find(|a| !a.is_finite()) {
        return Err(LinearEquationError::Factor { name: name.to_owned(), number, value });
    }
    by_vector.retain(|_, own| own.iter().any(|a| a.abs() > ROUND_OFF * given));
    let size = by_vector.values().flatten().fold(0.0_f64, |size, a| size.max(a.abs()));
    if size == 0.0 {
        return Err(LinearEquationError::NoFactor { name: name.to_owned(), number });
    }
    Ok(Row {
        reference: by_vector.keys().flat_map(|&v| (0..3).map(move |i| reference[3 * v as usize + i])).collect(),
        gradient: by_vector.values().flatten().copied().collect(),
        vectors: by_vector.into_keys().collect(),
        size,
    })
}

impl Term for LinearEquations {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn conserves_linear_momentum(&self) -> bool {
        self.is_free_of_ground
    }

    // The directions are fixed in space.
    fn conserves_angular_momentum(&self) -> bool {
        false
    }

    fn slot_count(&self) -> usize {
        self.rows.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.rows[slot].size
    }

    fn is_symmetric(&self, _rule: Rule) -> bool {
        true
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        (self.times, self.has_rates) = ([step.time, step.end], step.rates);
        self.compliance.begin(step.dt);
        Ok(())
    }

    fn renew(&mut self, _at: &At<'_>, want_tangent: bool) -> Result<bool, Fault> {
        self.compliance.renew(want_tangent);
        Ok(false)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for (slot, row) in self.rows.iter().enumerate().filter(|&(slot, _)| active[slot]) {
            visit(&row.vectors, &[slot as u32]);
        }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let mut local = Local::default();
        for (slot, row) in self.rows.iter().enumerate().filter(|&(slot, _)| at.active[slot]) {
            local.nodes.clear();
            local.nodes.extend_from_slice(&row.vectors);
            local.slots.clear();
            local.slots.push(slot as u32);
            local.reset(want_tangent);
            let (n, multiplier) = (row.gradient.len(), at.multipliers[slot]);
            for (r, g) in local.residual.iter_mut().zip(&row.gradient) {
                *r = -multiplier * g;
            }
            local.residual[n] = -self.violation(slot, step.q_np1);
            if want_tangent {
                for (i, g) in row.gradient.iter().enumerate() {
                    local.tangent[i * (n + 1) + n] = -g;
                    local.tangent[n * (n + 1) + i] = -g;
                }
            }
            self.compliance.add(n, multiplier, want_tangent, &mut local);
            visit(&local);
        }
        Ok(())
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        let [from, to] = self.times.map(|time| self.value.value(time));
        // Forces of statics are those of the end of a step: their work is that of the trapezium rule.
        let force = |slot: usize| match (at.active[slot], self.has_rates) {
            (false, _) => 0.0,
            (true, true) => at.multipliers[slot],
            (true, false) => 0.5 * (at.multipliers[slot] + self.last[slot]),
        };
        let force: f64 = (0..self.rows.len()).map(force).sum();
        Ok(Work { driven: force * (to - from), ..Work::default() })
    }

    fn commit(&mut self, at: &At<'_>) {
        for ((last, multiplier), active) in self.last.iter_mut().zip(at.multipliers).zip(at.active) {
            *last = if *active { *multiplier } else { 0.0 };
        }
    }

    fn save_history(&self) -> Vec<u8> {
        self.last.iter().flat_map(|force| force.to_le_bytes()).collect()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let (numbers, rest) = bytes.as_chunks::<8>();
        if numbers.len() != self.last.len() || !rest.is_empty() {
            let reason = format!("it has {} bytes of history, not {}", bytes.len(), 8 * self.last.len());
            return Err(Fault::other(Undefined { term: format!("equation {}", self.name), reason }));
        }
        self.last = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        Ok(())
    }

    fn bilateral(&self) -> Option<&dyn Bilateral> {
        Some(self)
    }
}

impl Bilateral for LinearEquations {
    fn slot_kind(&self, _slot: usize) -> SlotKind {
        if self.moves() { SlotKind::Driven } else { SlotKind::Equation }
    }

    fn verify_inactive(&self, q_np1: &[f64], active: &[bool]) -> Result<(), Fault> {
        for slot in (0..self.rows.len()).filter(|&slot| !active[slot]) {
            let missed = self.violation(slot, q_np1).abs() / self.rows[slot].size;
            if missed.is_nan() || missed > MISSED * self.length {
                let reason = format!(
                    "prescribed motions contradict its equation {}, by {missed:.2e}; remove one of them, or let them agree",
                    slot + 1
                );
                return Err(Fault::other(Undefined { term: format!("equation {}", self.name), reason }));
            }
        }
        Ok(())
    }
}
