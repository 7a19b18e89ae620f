//! Accelerations and forces at the start, for schemes that carry them.

use super::Simulation;
use crate::assembly::no_auxiliaries;
use crate::run_state::SlotState;
use crate::system::FeSystem;
use crate::terms::Line;
use crate::{CouplingTerm, StepError};
use stoss_integrators::{ForceRule, GradientRule, SecondOrderSystem, State, StepConfiguration, StepRule, start};
use stoss_linalg::{MatrixKind, vector};
use stoss_term::{At, StepConfiguration as ContactConfiguration, StepContext};

/// Largest motion of a vector along the velocities, in multiples of a length of the model, over which constraint functions are differenced twice. For quadratic
/// and cubic functions the difference is exact.
const MOTION: f64 = 0.01;

impl Simulation {
    /// Acceleration and forces at the start of a run.
    pub(super) fn complete_initial_state(&mut self) -> Result<(), StepError> {
        if self.how.scheme.is_some() && self.model.contacts.iter().any(acts_always) {
            return self.complete_state();
        }
        let rule = self.step_rule(self.clock.dt());
        self.set_dead_loads(self.state.time);
        let auxiliaries = no_auxiliaries(&self.model);
        let (mut fe, state) = self.equations_of(&auxiliaries);
        start(&mut fe, &rule, state)
    }

    /// Acceleration and forces of the end point at the present state with the present multipliers, which those of bilateral constraints are not yet:
    ///
    /// `[M  -G^T; -G  0] (a, lambda) = (-F + F_c, (G v)' )`, `(G v)' = d^2/de^2 Phi(q + e v)`,
    ///
    /// with the forces `F_c` of contact and potentials. At rest in equilibrium `a` is zero, but for round-off. The velocities have to satisfy `G v = 0`.
    pub(super) fn complete_state(&mut self) -> Result<(), StepError> {
        let rule = self.step_rule(self.clock.dt());
        let keeps = rule.history.filter(|history| history.is_needed(!self.model.contacts.is_empty()));
        if rule.acceleration.is_none() && keeps.is_none() {
            return Ok(());
        }
        self.set_dead_loads(self.state.time);
        self.begin_at_rest(rule)?;
        let n = self.state.q.len();
        let auxiliaries = no_auxiliaries(&self.model);
        let (mut fe, state) = self.equations_of(&auxiliaries);
        let at = StepConfiguration { time: state.time, dt: 0.0, q_n: &state.q, q_np1: &state.q };
        let mut force = vec![0.0; n];
        fe.add_force(at, ForceRule::END_POINT, None, &mut force)?;
        let mut constraint = vec![0.0; n];
        let others = |pair: &CouplingTerm| !acts_always(pair);
        self.add_coupling_force(others, &mut constraint)?;
        let mut rhs: Vec<f64> = constraint.iter().zip(&force).map(|(c, f)| c - f).collect();
        if self.system.present.has_damping {
            let (mut fe, state) = self.equations_of(&auxiliaries);
            let mut damping = vec![0.0; n];
            fe.add_damping(&state.q, &state.v, None, &mut damping)?;
            vector::axpy(-1.0, &damping, &mut rhs);
        }
        let mut a = vec![0.0; n];
        if self.model.contacts.iter().any(acts_always) {
            self.solve_with_constraints(&mut rhs, &mut a)?;
            self.add_coupling_force(acts_always, &mut constraint)?;
        } else {
            self.equations_of(&auxiliaries).0.solve_mass(&rhs, &mut a)?;
        }
        if rule.acceleration.is_some() {
            self.model.embedding.follow(&mut a);
            self.state.a = a;
        }
        if let Some(history) = keeps {
            let mut kept = vec![0.0; n];
            if history.force {
                vector::axpy(1.0, &force, &mut kept);
            }
            if history.constraint {
                vector::axpy(-1.0, &constraint, &mut kept);
            }
            self.state.history = kept;
        }
        Ok(())
    }

    /// The equations at the present multipliers, and the state.
    pub(super) fn equations_of<'a>(&'a mut self, auxiliaries: &'a [Vec<f64>]) -> (FeSystem<'a>, &'a mut State) {
        let Self { model, system, state, slots: SlotState { pressures, active, .. }, .. } = self;
        (FeSystem { model, system, pressures, auxiliaries, active }, state)
    }

    /// Search and integrals at the present positions, as for a step that goes nowhere.
    fn begin_at_rest(&mut self, rule: StepRule) -> Result<(), StepError> {
        let auxiliaries = no_auxiliaries(&self.model);
        let dt = self.clock.dt();
        let Self { model, system, state, slots: SlotState { pressures, active, .. }, stage, .. } = self;
        let step = StepContext { rates: rule.has_inertia(), held: &stage.held, ..at_rest(state, dt) };
        let mut acting = model.terms_mut(&system.present.acting).filter(|(_, acts, _)| *acts);
        let begun = acting.try_for_each(|(line, _, term)| {
            // What flows in the coming step is none of the forces before it.
            let dt = if line == Line::Force { 0.0 } else { dt };
            term.begin(&StepContext { reach: 0.5 * term.length_scale(), dt, ..step })?;
            if let Line::Constraint(c) = line {
                term.renew(&At::end(&state.q, &pressures[c], &active[c]).with_auxiliaries(&auxiliaries[c]), false)?;
            }
            Ok(())
        });
        Ok(system.shares.agree(begun)?)
    }

    /// Adds `G^T p` of some couplings at the present state.
    fn add_coupling_force(&self, which: impl Fn(&CouplingTerm) -> bool, out: &mut [f64]) -> Result<(), StepError> {
        let q = &self.state.q;
        let step = ContactConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
        for (c, pair) in self.model.couplings().filter(|(_, pair)| which(pair)) {
            let at = step.at(&self.slots.pressures[c], &self.slots.active[c]);
            self.system.shares.visit_all(c, &*pair.term, &at, &mut |local| {
                for (&node, residual) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                    let first = 3 * node as usize;
                    out[first..first + 3].iter_mut().zip(residual).for_each(|(out, r)| *out -= r);
                }
            })?;
        }
        self.model.embedding.pull_back(out);
        Ok(())
    }

    /// Accelerations and multipliers with the bilateral constraints that act, for the forces `rhs`.
    fn solve_with_constraints(&mut self, rhs: &mut [f64], a: &mut [f64]) -> Result<(), StepError> {
        let others: Vec<usize> =
            (0..self.model.contacts.len()).filter(|&c| !acts_always(&self.model.contacts[c])).collect();
        let on: Vec<bool> = self.model.contacts.iter().map(|pair| pair.acts).collect();
        for &c in &others {
            self.model.contacts[c].acts = false;
        }
        let result = self.solve_saddle_point(rhs, a);
        for &c in &others {
            self.model.contacts[c].acts = on[c];
        }
        result
    }

    fn solve_saddle_point(&mut self, forces: &[f64], a: &mut [f64]) -> Result<(), StepError> {
        let Self { model, system, state, slots: SlotState { pressures, active, .. }, .. } = self;
        let free = system.matrix.free();
        let active: Vec<Vec<bool>> = model
            .contacts
            .iter()
            .zip(&*active)
            .map(|(pair, on)| on.iter().map(|&on| on && acts_always(pair)).collect())
            .collect();
        let zeros: Vec<Vec<f64>> = pressures.iter().map(|p| vec![0.0; p.len()]).collect();
        let auxiliaries = no_auxiliaries(model);
        system.begin_pattern(model, &active)?;
        let speed = state.v.chunks_exact(3).map(|v| v[0].hypot(v[1]).hypot(v[2])).fold(0.0, f64::max);
        let lengths = model.contacts.iter().filter(|pair| acts_always(pair)).map(|pair| pair.term.length_scale());
        let small = MOTION * lengths.fold(f64::INFINITY, f64::min);
        // What the constraints exert at zero multipliers: springs, friction and motors of joints.
        let mut at_zero = vec![0.0; forces.len()];
        // The rows of the equations are minus the constraint functions, and the right-hand side has their opposites.
        let mut functions = |distance: f64, tangent: bool| -> Result<Vec<f64>, StepError> {
            let mut q = state.q.clone();
            vector::axpy(distance, &state.v, &mut q);
            model.embedding.follow(&mut q);
            let renewed = model.couplings_mut().try_for_each(|(c, pair)| {
                let at = At::end(&q, &zeros[c], &active[c]).with_auxiliaries(&auxiliaries[c]);
                pair.term.renew(&at, tangent).map(|_| ())
            });
            system.shares.agree(renewed)?;
            let at = StepConfiguration { time: state.time, dt: 0.0, q_n: &state.q, q_np1: &q };
            let mut fe = FeSystem { model, system, pressures: &zeros, auxiliaries: &auxiliaries, active: &active };
            if tangent {
                fe.start_tangent(1.0);
            }
            at_zero.fill(0.0);
            fe.add_constraint_force(at, GradientRule::EndPoint, 1.0, tangent, &mut at_zero)?;
            Ok(system.rhs[free..].to_vec())
        };
        let mut curvature = Vec::new();
        if speed > 0.0 {
            let distance = small / speed;
            let (ahead, behind, here) =
                (functions(distance, false)?, functions(-distance, false)?, functions(0.0, false)?);
            let rows = ahead.iter().zip(&behind).zip(&here);
            curvature = rows.map(|((p, m), o)| ((p - o) + (m - o)) / (distance * distance)).collect();
        }
        functions(0.0, true)?;
        system.matrix.drop_constraint_stiffness();
        for (rhs, &component) in system.rhs.iter_mut().zip(&system.matrix.numbering.free) {
            *rhs = forces[component as usize] + at_zero[component as usize];
        }
        system.rhs[free..].fill(0.0);
        system.rhs[free..].iter_mut().zip(curvature).for_each(|(rhs, curvature)| *rhs = curvature);
        system.spread_equations();
        let solver = &mut system.solver;
        let solved = solver
            .analyse(&system.matrix.pattern, MatrixKind::General)
            .and_then(|()| solver.factorise(&system.matrix.values))
            .and_then(|()| solver.solve(&system.rhs, &mut system.increment));
        solver.forget();
        solved.map_err(StepError::Start)?;
        for (&component, value) in system.matrix.numbering.free.iter().zip(&system.increment) {
            a[component as usize] = *value;
        }
        for c in 0..active.len() {
            for (slot, &equation) in
                system.matrix.slots.equation[c].iter().enumerate().filter(|&(slot, _)| active[c][slot])
            {
                pressures[c][slot] = system.increment[equation as usize];
            }
        }
        Ok(())
    }
}

/// A step of statics of the size `dt` in which time stands still and nothing moves.
pub(super) fn at_rest(state: &State, dt: f64) -> StepContext<'_> {
    StepContext { time: state.time, end: state.time, ..StepContext::quasi_static(&state.q, dt) }
}

/// A bilateral constraint that is not switched off.
fn acts_always(pair: &CouplingTerm) -> bool {
    pair.bilateral().is_some()
}
