//! One step as a problem for Newton's method.

use crate::assembly::{Iterate, System};
use crate::system::FeSystem;
use crate::{Model, Phase, StepError, Timings};
use stoss_integrators::{ForceRule, Step, evaluate};
use stoss_linalg::{MatrixKind, NONE, vector};
use stoss_newton::{NewtonProblem, ResidualNorms};

/// Motions below this fraction of an edge length in a step are not resolved relative to themselves: the forces that they
/// need are the smallest scale that the residual is measured against. Without it a free, unstressed flight, whose
/// forces are round-off, could never converge relatively.
const SMALLEST_RESOLVED_MOTION: f64 = 1.0e-4;

/// One step as a problem for Newton's method.
pub(crate) struct StepProblem<'a> {
    pub model: &'a Model,
    pub system: &'a mut System,
    pub step: Step<'a>,
    pub iterate: &'a mut Iterate,
    pub timings: &'a mut Timings,
    /// Linear solves so far.
    pub solves: u32,
}

impl StepProblem<'_> {
    /// Fills residual, and matrix values if asked; returns the relative residual.
    fn evaluate(&mut self, want_tangent: bool) -> Result<f64, StepError> {
        let Self { model, system, step, iterate, .. } = self;
        let mut buffers = std::mem::take(&mut system.buffers);
        let mut fe = FeSystem { model, system, pressures: &iterate.pressures, active: &iterate.active };
        let result = evaluate(&mut fe, step, &iterate.q, want_tangent, &mut buffers);
        let s = &mut **system;
        s.buffers = buffers;
        result?;
        let rule = &step.rule;
        let mut scale = (rule.force.weight * s.force_scale)
            .max(SMALLEST_RESOLVED_MOTION * s.stiffness_force)
            .max(rule.constraint.weight * vector::norm2(&s.buffers.constraint));
        if rule.has_inertia() {
            scale = scale
                .max(vector::norm2(&s.buffers.inertia))
                .max(SMALLEST_RESOLVED_MOTION * s.mass_length * rule.inertia.increment);
        }
        if let Some(history) = rule.history {
            scale = scale.max(history.weight * vector::norm2(&step.state_n.history));
        }
        let mut sum = 0.0;
        for (rhs, &component) in s.rhs.iter_mut().zip(&s.numbering.free) {
            let r = s.buffers.residual[component as usize];
            *rhs = -r;
            sum += r * r;
        }
        Ok((sum.sqrt() / scale).max(s.gap_measure))
    }
}

impl NewtonProblem for StepProblem<'_> {
    type Error = StepError;

    fn assemble(&mut self) -> Result<ResidualNorms, StepError> {
        let mut timings = std::mem::take(self.timings);
        let residual = timings.measure(Phase::Assembly, || self.evaluate(true));
        *self.timings = timings;
        Ok(ResidualNorms { residual: residual?, scale: 1.0 })
    }

    fn solve(&mut self) -> Result<f64, StepError> {
        let kind = if self.model.contacts.is_empty()
            && self.step.rule.force.rule != ForceRule::DiscreteGradient
            && !self.system.has_followers
        {
            MatrixKind::Symmetric
        } else {
            MatrixKind::General
        };
        let s = &mut *self.system;
        let (solver, pattern, values) = (&mut s.solver, &s.pattern, &s.values);
        self.timings.measure(Phase::Factorisation, || {
            solver.analyse(pattern, kind)?;
            solver.factorise(values)
        })?;
        let (rhs, increment) = (&s.rhs, &mut s.increment);
        self.timings.measure(Phase::Solve, || solver.solve(rhs, increment))?;
        self.solves += 1;
        s.base_q.copy_from_slice(&self.iterate.q);
        for (base, pressures) in s.base_pressures.iter_mut().zip(&self.iterate.pressures) {
            base.copy_from_slice(pressures);
        }
        Ok(vector::norm2(&s.increment[..s.numbering.free.len()]))
    }

    fn update(&mut self, factor: f64) -> Result<(), StepError> {
        let s = &*self.system;
        self.iterate.q.copy_from_slice(&s.base_q);
        for (du, &component) in s.increment.iter().zip(&s.numbering.free) {
            self.iterate.q[component as usize] += factor * du;
        }
        for ((pressures, base), equations) in
            self.iterate.pressures.iter_mut().zip(&s.base_pressures).zip(&s.slot_equation)
        {
            for ((p, p0), &equation) in pressures.iter_mut().zip(base).zip(equations) {
                if equation != NONE {
                    *p = p0 + factor * s.increment[equation as usize];
                }
            }
        }
        Ok(())
    }

    fn residual_norm(&mut self) -> Result<f64, StepError> {
        let mut timings = std::mem::take(self.timings);
        let residual = timings.measure(Phase::Assembly, || self.evaluate(false));
        *self.timings = timings;
        residual
    }

    fn is_recoverable(&self, error: &StepError) -> bool {
        matches!(error, StepError::Solid(_) | StepError::Contact(_))
    }

    fn iterate_norm(&self) -> f64 {
        vector::norm2(&self.iterate.q)
    }
}
