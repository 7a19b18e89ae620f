//! A flat mathematical pendulum with its constraint, and with reduced index (thesis C.2).

use crate::ModelProblem;
use nalgebra::DMatrix;
use stoss_integrators::State;

/// Position on the unit circle at rest: horizontal.
fn start(length: f64) -> State {
    State::at_rest(vec![length, 0.0])
}

/// `m x'' = -m g e_2 + lambda d Phi/dx` with `Phi = |x|^2 - l^2 = 0`: index 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum {
    /// Mass.
    pub mass: f64,
    /// Length.
    pub length: f64,
    /// Gravity along `-x_2`.
    pub gravity: f64,
}

impl Default for Pendulum {
    /// Everything one.
    fn default() -> Self {
        Self { mass: 1.0, length: 1.0, gravity: 1.0 }
    }
}

impl ModelProblem for Pendulum {
    fn name(&self) -> &str {
        "pendulum, index 3"
    }
    fn dimension(&self) -> usize {
        2
    }
    fn mass(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal_element(2, 2, self.mass)
    }
    fn initial_state(&self) -> State {
        start(self.length)
    }
    fn potential(&self, q: &[f64]) -> f64 {
        self.mass * self.gravity * q[1]
    }
    fn add_force(&self, _q: &[f64], out: &mut [f64]) {
        out[1] += self.mass * self.gravity;
    }
    fn add_stiffness(&self, _q: &[f64], _factor: f64, _out: &mut DMatrix<f64>) {}
    fn add_discrete_force(&self, _q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        self.add_force(q_np1, out);
    }
    fn add_discrete_stiffness(&self, _q_n: &[f64], _q_np1: &[f64], _factor: f64, _out: &mut DMatrix<f64>) {}
    fn constraint_count(&self) -> usize {
        1
    }
    fn constraints(&self, q: &[f64], out: &mut [f64]) {
        out[0] = q[0] * q[0] + q[1] * q[1] - self.length * self.length;
    }
    fn jacobian(&self, q: &[f64], out: &mut DMatrix<f64>) {
        out[(0, 0)] = 2.0 * q[0];
        out[(0, 1)] = 2.0 * q[1];
    }
    fn add_constraint_hessian(&self, p: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        out[(0, 0)] += 2.0 * factor * p[0];
        out[(1, 1)] += 2.0 * factor * p[0];
    }
}

/// The pendulum after three differentiations of its constraint: an ordinary differential equation that knows the circle only through its start.
///
/// From `x'' = 2 lambda x - g e_2` and `d^2 Phi/dt^2 = 0`: `lambda = (g x_2 - |v|^2)/(2 l^2)`, `lambda' = 3 g v_2/(2 l^2)` (thesis (C.24), (C.25) with this
/// orientation of gravity), that is `lambda = lambda_0 + 3 g (x_2 - x_2(0))/(2 l^2)`, which every scheme with linear updates integrates exactly. The
/// force is none of a potential; [`ModelProblem::potential`] is that of gravity alone.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ReducedPendulum(pub Pendulum);

impl ReducedPendulum {
    /// `lambda` at a height, per unit mass.
    fn multiplier(&self, height: f64) -> f64 {
        // It starts at rest on the horizontal axis, where lambda is zero.
        1.5 * self.0.gravity * height / (self.0.length * self.0.length)
    }
}

impl ModelProblem for ReducedPendulum {
    fn name(&self) -> &str {
        "pendulum, reduced index"
    }
    fn dimension(&self) -> usize {
        2
    }
    fn mass(&self) -> DMatrix<f64> {
        self.0.mass()
    }
    fn initial_state(&self) -> State {
        start(self.0.length)
    }
    fn potential(&self, q: &[f64]) -> f64 {
        self.0.potential(q)
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        let factor = 2.0 * self.0.mass * self.multiplier(q[1]);
        out[0] -= factor * q[0];
        out[1] -= factor * q[1] - self.0.mass * self.0.gravity;
    }
    fn add_stiffness(&self, q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        let m = 2.0 * self.0.mass * factor;
        let (lambda, slope) = (self.multiplier(q[1]), self.multiplier(1.0));
        out[(0, 0)] -= m * lambda;
        out[(0, 1)] -= m * slope * q[0];
        out[(1, 1)] -= m * (lambda + slope * q[1]);
    }
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        self.add_force(&[0.5 * (q_n[0] + q_np1[0]), 0.5 * (q_n[1] + q_np1[1])], out);
    }
    fn add_discrete_stiffness(&self, q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        self.add_stiffness(&[0.5 * (q_n[0] + q_np1[0]), 0.5 * (q_n[1] + q_np1[1])], 0.5 * factor, out);
    }
}
