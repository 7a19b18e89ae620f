//! Springs and dampers between two points.

use crate::Embedded;
use crate::error::{PartDataError, not_negative};
use crate::kernel::{GradientAt, Kernel};
use crate::quadratic::{Evaluation, Quadratics, QuadraticsBuilder};
use crate::response::Response;
use stoss_term::{At, Fault, ForceRule, Local, Rule, Term, Undefined, Work};

/// Stiffness and damping of a [`Spring`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpringData {
    /// `k`, a force per length.
    pub stiffness: f64,
    /// `L`, the length without force.
    pub rest_length: f64,
    /// Whether the spring has no force where it is shorter than `L`.
    pub tension_only: bool,
    /// `d`, a force per velocity.
    pub damping: f64,
}

/// Spring and damper along the line between two [`Embedded`] points, of which one may be a point of the ground.
///
/// The energy is `V = k/2 (l - L)^2` with `l = |a - b|`, for tension only zero where `l < L`. With the invariant `pi = l^2` its discrete gradient is
/// `k/2 (l_0 + l_1 - 2 L) / (l_0 + l_1)`. The damper has the force `d (l_1 - l_0) / dt`, as `d (l_1 - l_0) / (dt (l_0 + l_1))` times the gradient of `pi` at the
/// midpoint of the step whatever the rule: it dissipates `d (l_1 - l_0)^2 / dt` in a step and changes no momentum.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    name: String,
    ends: [Embedded; 2],
    data: SpringData,
    squared: Quadratics,
    /// A typical length.
    length: f64,
}

impl Spring {
    /// A spring between two points.
    ///
    /// # Errors
    /// [`PartDataError::Number`].
    pub fn new(name: &str, ends: [Embedded; 2], data: SpringData) -> Result<Self, PartDataError> {
        not_negative("stiffness of a spring", data.stiffness)?;
        not_negative("rest length of a spring", data.rest_length)?;
        not_negative("damping of a spring", data.damping)?;
        let mut builder = QuadraticsBuilder::new();
        let arm = builder.form(&ends[0].plus(-1.0, &ends[1]));
        builder.function(0.0, &[(1.0, arm, arm)]);
        let length = if data.rest_length > 0.0 { data.rest_length } else { 1.0 };
        Ok(Self { name: name.to_owned(), ends, data, squared: builder.build(), length })
    }

    /// The spring with a positive length that is typical of it, if it has no rest length; small motions are measured against it. Without one it is 1.
    pub fn with_length(mut self, length: f64) -> Self {
        if self.data.rest_length == 0.0 && length > 0.0 {
            self.length = length;
        }
        self
    }

    /// Ends of the spring.
    pub fn ends(&self) -> &[Embedded; 2] {
        &self.ends
    }

    /// Stiffness and damping.
    pub fn data(&self) -> &SpringData {
        &self.data
    }

    /// Length at `q`.
    pub fn length(&self, q: &[f64]) -> f64 {
        let mut squared = Evaluation::default();
        self.squared.evaluate(q, q, 1.0, false, &mut squared);
        squared.values[0].sqrt()
    }

    /// Force of the spring at `q`, positive if it pulls; without the damper.
    pub fn tension(&self, q: &[f64]) -> f64 {
        self.data.stiffness * (self.stretched(self.length(q)) - self.data.rest_length)
    }

    /// `max(l, L)` for tension only, else `l`.
    fn stretched(&self, l: f64) -> f64 {
        if self.data.tension_only { l.max(self.data.rest_length) } else { l }
    }

    /// An error if the ends of a spring with a force coincide.
    fn check(&self, at: &At<'_>, gradient: GradientAt) -> Result<(), Undefined> {
        let pushes = self.data.stiffness > 0.0 && self.data.rest_length > 0.0 && !self.data.tension_only;
        let no_length = pushes
            && match gradient {
                GradientAt::Configuration(theta) => {
                    let mut squared = Evaluation::default();
                    self.squared.evaluate(at.q_n, at.q_np1, theta, false, &mut squared);
                    squared.values[0] == 0.0
                }
                GradientAt::Discrete => self.length(at.q_n) + self.length(at.q_np1) == 0.0,
            };
        if no_length {
            let reason = "its ends coincide: the force has no direction".to_owned();
            return Err(Undefined { term: self.name.clone(), reason });
        }
        Ok(())
    }
}

impl Term for Spring {
    fn name(&self) -> &str {
        &self.name
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(self.squared.vectors(), &[]);
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let gradient = GradientAt::of(rule);
        self.check(at, gradient)?;
        let (mut kernel, mut local) = (Kernel::default(), Local::default());
        local.nodes.extend_from_slice(self.squared.vectors());
        local.reset(want_tangent);
        kernel.evaluate(&self.squared, &self.data, at.q_n, at.q_np1, gradient, want_tangent);
        kernel.add_to(&mut local, want_tangent);
        if at.rates && self.data.damping > 0.0 {
            let damper = Damper(self.data.damping / at.dt);
            kernel.evaluate(&self.squared, &damper, at.q_n, at.q_np1, GradientAt::Discrete, want_tangent);
            kernel.add_to(&mut local, want_tangent);
        }
        visit(&local);
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let l = self.length(q);
        Ok(self.data.value(&[l * l]))
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        let stored = self.energy(at.q_np1)?;
        let change = self.length(at.q_np1) - self.length(at.q_n);
        let dissipated = if at.rates { self.data.damping * change * change / at.dt } else { 0.0 };
        Ok(Work { stored, dissipated, ..Work::default() })
    }

    fn conserves_linear_momentum(&self) -> bool {
        self.ends.iter().all(|end| !end.terms.is_empty())
    }

    fn conserves_angular_momentum(&self) -> bool {
        self.conserves_linear_momentum()
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn force_scale(&self) -> f64 {
        self.data.stiffness * self.length
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        self.data.damping == 0.0 && rule != Rule::Force(ForceRule::DiscreteGradient)
    }
}

impl SpringData {
    fn is_slack(&self, l: f64) -> bool {
        self.tension_only && l <= self.rest_length
    }

    /// `dV/dpi = k/2 (1 - L / l)`.
    fn slope(&self, l: f64) -> f64 {
        let rest = self.rest_length;
        if self.is_slack(l) {
            0.0
        } else if rest == 0.0 {
            0.5 * self.stiffness
        } else {
            0.5 * self.stiffness * (l - rest) / l
        }
    }

    /// `k/2 (l_0 + l_1 - 2 L) / (l_0 + l_1)`.
    fn quotient(&self, l_0: f64, l_1: f64) -> f64 {
        if self.rest_length == 0.0 {
            return 0.5 * self.stiffness;
        }
        0.5 * self.stiffness * ((l_0 - self.rest_length) + (l_1 - self.rest_length)) / (l_0 + l_1)
    }
}

/// Functions of `pi = l^2`.
impl Response for SpringData {
    fn value(&self, phi: &[f64]) -> f64 {
        let l = phi[0].sqrt();
        if self.is_slack(l) { 0.0 } else { 0.5 * self.stiffness * (l - self.rest_length) * (l - self.rest_length) }
    }

    fn derivatives(&self, phi: &[f64], gradient: &mut [f64], second: &mut [f64]) {
        let l = phi[0].sqrt();
        gradient[0] = self.slope(l);
        if !self.is_slack(l) && self.rest_length > 0.0 {
            second[0] = 0.25 * self.stiffness * self.rest_length / (l * l * l);
        }
    }

    fn discrete_gradient(&self, phi_n: &[f64], phi_np1: &[f64], gradient: &mut [f64], derivative: &mut [f64]) {
        let (a, b, rest) = (phi_n[0].sqrt(), phi_np1[0].sqrt(), self.rest_length);
        match (self.is_slack(a), self.is_slack(b)) {
            (true, true) => {}
            (false, false) => {
                gradient[0] = self.quotient(a, b);
                // d/dpi_1 = d/dl_1 / (2 l_1). Where the end has no length, the length has no derivative.
                if rest > 0.0 && b > 0.0 {
                    derivative[0] = 0.5 * self.stiffness * rest / ((a + b) * (a + b) * b);
                }
            }
            (a_slack, _) => {
                // Across the kink: `a` and `b` are on different sides of `L`, thus apart; the taut end alone has an energy, of second order in its distance from `L`.
                let energy = |l: f64| 0.5 * self.stiffness * (l - rest) * (l - rest);
                let work = if a_slack { energy(b) } else { -energy(a) };
                let difference = (b - a) * (b + a);
                gradient[0] = work / difference;
                derivative[0] = (self.slope(b) - gradient[0]) / difference;
            }
        }
    }
}

/// `W_pi = c (l_1 - l_0) / (l_1 + l_0)` with `c = d / dt`: no gradient, but evaluated as one.
#[derive(Clone, Copy, Debug)]
struct Damper(f64);

impl Response for Damper {
    fn value(&self, _phi: &[f64]) -> f64 {
        0.0
    }

    fn derivatives(&self, _phi: &[f64], _gradient: &mut [f64], _second: &mut [f64]) {}

    fn discrete_gradient(&self, phi_n: &[f64], phi_np1: &[f64], gradient: &mut [f64], derivative: &mut [f64]) {
        let (a, b) = (phi_n[0].sqrt(), phi_np1[0].sqrt());
        if a + b > 0.0 {
            gradient[0] = self.0 * (b - a) / (a + b);
            if b > 0.0 {
                derivative[0] = self.0 * a / ((a + b) * (a + b) * b);
            }
        }
    }
}
