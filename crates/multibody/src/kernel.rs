//! Force and tangent of a function of invariants.

use crate::quadratic::{Evaluation, Quadratics};
use crate::response::Response;
use stoss_term::{ForceRule, Local};

/// Where the gradient of a function between two configurations is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GradientAt {
    /// The configuration `(1 - theta) q_n + theta q_np1`.
    Configuration(f64),
    /// Discrete gradient.
    Discrete,
}

impl GradientAt {
    /// Where the forces of a step are taken.
    pub fn of(rule: ForceRule) -> Self {
        match rule {
            ForceRule::Configuration { theta } => Self::Configuration(theta),
            ForceRule::DiscreteGradient => Self::Discrete,
        }
    }
}

/// Work space of [`Kernel::evaluate`].
#[derive(Clone, Debug, Default)]
pub struct Kernel {
    start: Evaluation,
    end: Evaluation,
    between: Evaluation,
    /// `dW/dphi`, and its derivatives with respect to `phi_np1` (discrete) or to `phi` (configuration).
    gradient: Vec<f64>,
    second: Vec<f64>,
    /// `second` times the gradients of the functions at the end.
    product: Vec<f64>,
    /// `dW/dq`, `3 * vectors` entries.
    pub force: Vec<f64>,
    /// `d force / d q_np1`, row-major.
    pub tangent: Vec<f64>,
}

impl Kernel {
    /// `force = sum_k W_k grad phi_k` and, if asked, its tangent. Under [`GradientAt::Discrete`] `force . (q_np1 - q_n) = W_np1 - W_n`, for the gradients of the
    /// `phi_k` are taken at the midpoint and the `W_k` as discrete gradient.
    pub fn evaluate(
        &mut self,
        functions: &Quadratics,
        response: &dyn Response,
        q_n: &[f64],
        q_np1: &[f64],
        at: GradientAt,
        want_tangent: bool,
    ) {
        let (count, n) = (functions.len(), 3 * functions.vectors().len());
        self.gradient.clear();
        self.gradient.resize(count, 0.0);
        self.second.clear();
        self.second.resize(count * count, 0.0);
        let theta = match at {
            GradientAt::Configuration(theta) => theta,
            GradientAt::Discrete => 0.5,
        };
        functions.evaluate(q_n, q_np1, theta, true, &mut self.between);
        match at {
            GradientAt::Configuration(_) => {
                response.derivatives(&self.between.values, &mut self.gradient, &mut self.second);
            }
            GradientAt::Discrete => {
                functions.evaluate(q_n, q_np1, 0.0, false, &mut self.start);
                functions.evaluate(q_n, q_np1, 1.0, want_tangent, &mut self.end);
                let (start, end) = (&self.start.values, &self.end.values);
                response.discrete_gradient(start, end, &mut self.gradient, &mut self.second);
            }
        }
        self.force.clear();
        self.force.resize(n, 0.0);
        for (w, row) in self.gradient.iter().zip(self.between.gradients.chunks_exact(n.max(1))) {
            for (f, g) in self.force.iter_mut().zip(row) {
                *f += w * g;
            }
        }
        if want_tangent {
            self.tangent(functions, at, theta);
        }
    }

    /// Adds force and, if asked, tangent to a contribution with the same vectors in the same order.
    pub fn add_to(&self, local: &mut Local, want_tangent: bool) {
        local.residual.iter_mut().zip(&self.force).for_each(|(r, f)| *r += f);
        if want_tangent {
            local.tangent.iter_mut().zip(&self.tangent).for_each(|(t, k)| *t += k);
        }
    }

    fn tangent(&mut self, functions: &Quadratics, at: GradientAt, theta: f64) {
        let (count, n) = (functions.len(), 3 * functions.vectors().len());
        self.tangent.clear();
        self.tangent.resize(n * n, 0.0);
        for (k, w) in self.gradient.iter().enumerate() {
            functions.add_second_derivatives(k, theta * w, n, &mut self.tangent);
        }
        let (factor, columns) = match at {
            GradientAt::Configuration(theta) => (theta, &self.between.gradients),
            GradientAt::Discrete => (1.0, &self.end.gradients),
        };
        self.product.clear();
        self.product.resize(count * n, 0.0);
        for k in 0..count {
            for l in 0..count {
                let s = factor * self.second[k * count + l];
                if s != 0.0 {
                    let row = &columns[l * n..(l + 1) * n];
                    self.product[k * n..(k + 1) * n].iter_mut().zip(row).for_each(|(p, c)| *p += s * c);
                }
            }
        }
        for k in 0..count {
            let gradient = &self.between.gradients[k * n..(k + 1) * n];
            let product = &self.product[k * n..(k + 1) * n];
            for (i, g) in gradient.iter().enumerate().filter(|(_, g)| **g != 0.0) {
                self.tangent[i * n..(i + 1) * n].iter_mut().zip(product).for_each(|(t, p)| *t += g * p);
            }
        }
    }

    /// Value of the function at a configuration.
    pub fn value(&mut self, functions: &Quadratics, response: &dyn Response, q: &[f64]) -> f64 {
        functions.evaluate(q, q, 1.0, false, &mut self.end);
        response.value(&self.end.values)
    }
}
