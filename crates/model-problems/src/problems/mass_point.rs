//! A mass point that falls on rigid ground (theory/constraints#mass-point; thesis (5.76)-(5.95)).

use crate::{ConstraintForm, ModelProblem};
use nalgebra::DMatrix;
use stoss_integrators::State;

/// `m x'' + m g - p = 0`, `x - h >= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassPoint {
    /// Mass.
    pub mass: f64,
    /// Gravity, downward.
    pub gravity: f64,
    /// Height of the ground.
    pub ground: f64,
    /// Initial height.
    pub height: f64,
    /// Initial velocity, upward.
    pub velocity: f64,
    /// Constraint while closed: the standard one loses the energy of the impact, the modified one returns it.
    pub form: ConstraintForm,
}

impl MassPoint {
    /// The data of theory/constraints#mass-point: `m = 1`, `g = 9.81`, `h = 5`, `x_0 = 15`, `v_0 = -5`.
    pub fn new(form: ConstraintForm) -> Self {
        Self { mass: 1.0, gravity: 9.81, ground: 5.0, height: 15.0, velocity: -5.0, form }
    }
}

impl ModelProblem for MassPoint {
    fn name(&self) -> &str {
        "mass point"
    }
    fn dimension(&self) -> usize {
        1
    }
    fn mass(&self) -> DMatrix<f64> {
        DMatrix::from_element(1, 1, self.mass)
    }
    fn initial_state(&self) -> State {
        State::new(vec![self.height], vec![self.velocity])
    }
    fn potential(&self, q: &[f64]) -> f64 {
        self.mass * self.gravity * q[0]
    }
    fn add_force(&self, _q: &[f64], out: &mut [f64]) {
        out[0] += self.mass * self.gravity;
    }
    fn add_stiffness(&self, _q: &[f64], _factor: f64, _out: &mut DMatrix<f64>) {}
    fn add_discrete_force(&self, _q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        self.add_force(q_np1, out);
    }
    fn add_discrete_stiffness(&self, _q_n: &[f64], _q_np1: &[f64], _factor: f64, _out: &mut DMatrix<f64>) {}
    fn constraint_count(&self) -> usize {
        1
    }
    fn is_unilateral(&self) -> bool {
        true
    }
    fn constraint_form(&self) -> ConstraintForm {
        self.form
    }
    fn constraints(&self, q: &[f64], out: &mut [f64]) {
        out[0] = q[0] - self.ground;
    }
    fn jacobian(&self, _q: &[f64], out: &mut DMatrix<f64>) {
        out[(0, 0)] = 1.0;
    }
}
