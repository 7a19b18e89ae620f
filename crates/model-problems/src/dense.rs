//! A model problem as a system that the schemes can drive, with dense matrices.

use crate::{ConstraintForm, ModelError, ModelProblem};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use stoss_integrators::{ForceRule, GradientRule, SecondOrderSystem, StepConfiguration};

/// Matrices and multipliers of a problem.
pub(crate) struct Dense<'a> {
    pub problem: &'a dyn ModelProblem,
    pub mass: DMatrix<f64>,
    mass_factor: Option<Cholesky<f64, Dyn>>,
    /// Coordinates, then constraints.
    pub tangent: DMatrix<f64>,
    pub multipliers: Vec<f64>,
    pub active: Vec<bool>,
    /// Constraint rows of the residual.
    pub rows: Vec<f64>,
    point: Vec<f64>,
    block: DMatrix<f64>,
    gradient: DMatrix<f64>,
    /// Evaluations of the forces so far.
    pub evaluations: u64,
}

impl<'a> Dense<'a> {
    pub fn new(problem: &'a dyn ModelProblem) -> Self {
        let (n, m) = (problem.dimension(), problem.constraint_count());
        Self {
            mass: problem.mass(),
            mass_factor: None,
            tangent: DMatrix::zeros(n + m, n + m),
            multipliers: vec![0.0; m],
            active: vec![!problem.is_unilateral(); m],
            rows: vec![0.0; m],
            point: vec![0.0; n],
            block: DMatrix::zeros(n, n),
            gradient: DMatrix::zeros(m, n),
            evaluations: 0,
            problem,
        }
    }

    /// Adds the `n x n` block to the tangent.
    fn add_block(&mut self) {
        let n = self.block.nrows();
        let mut view = self.tangent.view_mut((0, 0), (n, n));
        view += &self.block;
    }

    /// `out += share G(q)^T p` over active constraints; the gradient stays in `self.gradient`.
    fn add_gradient(&mut self, q: &[f64], share: f64, out: &mut [f64]) {
        self.problem.jacobian(q, &mut self.gradient);
        for (k, &p) in self.multipliers.iter().enumerate().filter(|&(k, _)| self.active[k]) {
            for (i, out) in out.iter_mut().enumerate() {
                *out += share * p * self.gradient[(k, i)];
            }
        }
    }

    /// Multipliers of active constraints, zero for the others.
    fn active_multipliers(&self) -> Vec<f64> {
        self.multipliers.iter().zip(&self.active).map(|(&p, &active)| if active { p } else { 0.0 }).collect()
    }
}

impl SecondOrderSystem for Dense<'_> {
    type Error = ModelError;

    fn dimension(&self) -> usize {
        self.problem.dimension()
    }

    fn add_mass_product(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out += factor * self.mass.row(i).iter().zip(x).map(|(m, x)| m * x).sum::<f64>();
        }
    }

    fn solve_mass(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), ModelError> {
        if self.mass_factor.is_none() {
            self.mass_factor = Some(Cholesky::new(self.mass.clone()).ok_or(ModelError::SingularMass)?);
        }
        if let Some(factor) = &self.mass_factor {
            x.copy_from_slice(factor.solve(&DVector::from_column_slice(rhs)).as_slice());
        }
        Ok(())
    }

    fn start_tangent(&mut self, factor: f64) {
        self.tangent.fill(0.0);
        let n = self.mass.nrows();
        self.tangent.view_mut((0, 0), (n, n)).copy_from(&(&self.mass * factor));
    }

    fn add_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), ModelError> {
        self.evaluations += 1;
        self.block.fill(0.0);
        match rule {
            ForceRule::Configuration { theta } => {
                for ((point, q0), q1) in self.point.iter_mut().zip(step.q_n).zip(step.q_np1) {
                    *point = if theta == 1.0 { *q1 } else { (1.0 - theta) * q0 + theta * q1 };
                }
                self.problem.add_force(&self.point, out);
                if let Some(weight) = tangent {
                    self.problem.add_stiffness(&self.point, weight * theta, &mut self.block);
                }
            }
            ForceRule::DiscreteGradient => {
                self.problem.add_discrete_force(step.q_n, step.q_np1, out);
                if let Some(weight) = tangent {
                    self.problem.add_discrete_stiffness(step.q_n, step.q_np1, weight, &mut self.block);
                }
            }
        }
        if tangent.is_some() {
            self.add_block();
        }
        Ok(())
    }

    fn add_constraint_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: GradientRule,
        weight: f64,
        tangent: bool,
        out: &mut [f64],
    ) -> Result<(), ModelError> {
        let m = self.rows.len();
        if m == 0 {
            return Ok(());
        }
        let n = self.problem.dimension();
        // Configurations whose gradients are averaged, with share and derivative by q_np1.
        let mid: Vec<f64> = step.q_n.iter().zip(step.q_np1).map(|(a, b)| 0.5 * (a + b)).collect();
        let places: &[(&[f64], f64, f64)] = match rule {
            GradientRule::StartPoint => &[(step.q_n, 1.0, 0.0)],
            GradientRule::EndPoint => &[(step.q_np1, 1.0, 1.0)],
            GradientRule::EndPointMean => &[(step.q_n, 0.5, 0.0), (step.q_np1, 0.5, 1.0)],
            // Exact discrete gradient of what is at most quadratic.
            GradientRule::Midpoint | GradientRule::DiscreteGradient => &[(&mid, 1.0, 0.5)],
        };
        for &(place, share, slope) in places {
            self.add_gradient(place, share, out);
            if tangent {
                self.block.fill(0.0);
                let p = self.active_multipliers();
                self.problem.add_constraint_hessian(&p, -weight * share * slope, &mut self.block);
                self.add_block();
                for k in (0..m).filter(|&k| self.active[k]) {
                    for i in 0..n {
                        self.tangent[(i, n + k)] -= weight * share * self.gradient[(k, i)];
                    }
                }
            }
        }
        self.problem.constraints(step.q_np1, &mut self.rows);
        if self.problem.constraint_form() == ConstraintForm::Modified {
            let mut before = vec![0.0; m];
            self.problem.constraints(step.q_n, &mut before);
            for (row, before) in self.rows.iter_mut().zip(before) {
                *row -= before;
            }
        }
        if tangent {
            self.problem.jacobian(step.q_np1, &mut self.gradient);
        }
        for k in 0..m {
            if !self.active[k] {
                self.rows[k] = self.multipliers[k];
            }
            if tangent && self.active[k] {
                for i in 0..n {
                    self.tangent[(n + k, i)] = self.gradient[(k, i)];
                }
            } else if tangent {
                self.tangent[(n + k, n + k)] = 1.0;
            }
        }
        Ok(())
    }
}
