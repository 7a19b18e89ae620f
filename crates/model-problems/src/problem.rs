//! The trait of a model problem.

use nalgebra::DMatrix;
use stoss_integrators::State;

/// Function that is zero while a constraint is active (theory/constraints#modified).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConstraintForm {
    /// `Phi(q_np1) = 0`.
    #[default]
    Standard,
    /// `Phi(q_np1) - Phi(q_n) = 0`: the step in which a unilateral constraint closes keeps the energy.
    Modified,
}

/// A small system `M v' + grad V(q) - G^T p = 0`, `Phi(q) = 0` or `Phi(q) >= 0, p >= 0, p Phi = 0`.
///
/// Matrices come zeroed or with values to be added to, as each method says.
pub trait ModelProblem: std::fmt::Debug {
    /// Name for reports.
    fn name(&self) -> &str;
    /// Number of coordinates.
    fn dimension(&self) -> usize;
    /// `M`, symmetric; singular only for coordinates that a constraint determines.
    fn mass(&self) -> DMatrix<f64>;
    /// Positions and velocities at time zero.
    fn initial_state(&self) -> State;
    /// `V(q)`.
    fn potential(&self, q: &[f64]) -> f64;
    /// Adds the force `F(q)` (the gradient of `V`, if there is one) to `out`.
    fn add_force(&self, q: &[f64], out: &mut [f64]);
    /// Adds `factor dF/dq`.
    fn add_stiffness(&self, q: &[f64], factor: f64, out: &mut DMatrix<f64>);
    /// Adds the discrete gradient of `V` between two configurations.
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]);
    /// Adds `factor` times its derivative with respect to `q_np1`.
    fn add_discrete_stiffness(&self, q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>);

    /// Number of constraints.
    fn constraint_count(&self) -> usize {
        0
    }
    /// True if constraints are `Phi >= 0`.
    fn is_unilateral(&self) -> bool {
        false
    }
    /// Form of active constraints.
    fn constraint_form(&self) -> ConstraintForm {
        ConstraintForm::Standard
    }
    /// `Phi(q)` into `out`.
    fn constraints(&self, _q: &[f64], _out: &mut [f64]) {}
    /// `G(q) = dPhi/dq` into `out` (constraints x coordinates).
    fn jacobian(&self, _q: &[f64], _out: &mut DMatrix<f64>) {}
    /// Adds `factor sum_k p_k d^2 Phi_k/dq^2`; constant, since constraints are at most quadratic.
    fn add_constraint_hessian(&self, _p: &[f64], _factor: f64, _out: &mut DMatrix<f64>) {}

    /// Number of points in space, to which the first `3 * spatial_nodes` coordinates belong, and whose momenta are reported.
    fn spatial_nodes(&self) -> usize {
        0
    }
}
