//! One step as a problem for Newton's method.

use crate::accuracy::Accuracy;
use crate::assembly::{Base, System, has_condensed, with_nodes};
use crate::diagnosis::{blocked, linear_error};
use crate::iterate::Iterate;
use crate::system::FeSystem;
use crate::{CouplingTerm, Load, Model, Phase, PhaseTime, StepError, Timings};
use std::sync::Arc;
use stoss_integrators::{Buffers, Step, evaluate, evaluate_constraints};
use stoss_linalg::{LinalgError, LinearSolver, MatrixKind, NONE, SparsityPattern, vector};
use stoss_newton::{LineSearch, NewtonProblem, Potential, ResidualNorms};
use stoss_term::{Auxiliary, Rule, Term as _};

/// Motions below this fraction of an edge length in a step are not resolved relative to themselves: the forces that they
/// need are the smallest scale that the residual is measured against. Without it a free, unstressed flight, whose
/// forces are round-off, could never converge relatively.
pub(crate) const SMALLEST_RESOLVED_MOTION: f64 = 1.0e-4;

/// Round-off of an energy, in parts of the energy of a strain of one. (A difference of energies at strains of 0.1 has some 1e-15 of it.)
const ENERGY_ROUND_OFF: f64 = 1.0e-14;

/// One step as a problem for Newton's method.
pub(crate) struct StepProblem<'a> {
    pub model: &'a mut Model,
    pub system: &'a mut System,
    pub step: Step<'a>,
    pub iterate: &'a mut Iterate,
    pub timings: &'a mut Timings,
    /// Linear solves so far.
    pub solves: &'a mut u32,
    /// Whether the linear equations that were solved last were shifted ([`System::shifts_rows`]).
    pub solved_shifted: bool,
    /// Part of the last increment that the iterate has gone.
    pub part: f64,
    /// Shift of the last tangent that needed one in this solution.
    pub last_shift: f64,
    pub known: Known,
    pub accuracy: Accuracy,
    /// [`potential_energy`] at the iterate, once it was asked for there.
    energy: Option<f64>,
}

/// What of residual and tangent is known at the iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Known {
    Nothing,
    /// All but what the couplings have, in the buffers and in the fixed part of the matrix.
    WithoutCouplings,
    /// All of residual and tangent, with these norms.
    All(ResidualNorms),
}

/// Size of the motion, in multiples of an edge length, whose difference of forces replaces the product of prescribed motions and
/// stiffness in [`StepProblem::predict`]: truncation and round-off are both about 1e-10 of the result.
const DIFFERENCE: f64 = 1.0e-5;

/// Linear responses to what is left of prescribed motions, where surfaces stop each of them, before the step is given up.
const MAX_PREDICTIONS: u32 = 20;

/// Part of the way that is free which a prediction goes where surfaces come near each other. All of it would leave a tenth of the distances and forces out of all proportion.
const OF_FREE_WAY: f64 = 0.5;

impl<'a> StepProblem<'a> {
    /// The problem at an iterate of which nothing is known.
    pub fn new(
        model: &'a mut Model,
        system: &'a mut System,
        step: Step<'a>,
        iterate: &'a mut Iterate,
        timings: &'a mut Timings,
        solves: &'a mut u32,
    ) -> Self {
        Self {
            model,
            system,
            step,
            iterate,
            timings,
            solves,
            solved_shifted: false,
            part: 0.0,
            last_shift: 0.0,
            known: Known::Nothing,
            accuracy: Accuracy::default(),
            energy: None,
        }
    }
}

impl StepProblem<'_> {
    /// Fills residual, and matrix values if asked; returns norms of forces. (The constraints' violation is `system.tally.gap_measure`.)
    fn evaluate(&mut self, want_tangent: bool) -> Result<ResidualNorms, StepError> {
        let known = std::mem::replace(&mut self.known, Known::Nothing);
        self.energy = None;
        self.renew_contacts(want_tangent)?;
        let Self { model, system, step, iterate, .. } = self;
        let mut buffers = std::mem::take(&mut system.buffers);
        for node in system.tally.touched.drain(..) {
            buffers.constraint[3 * node as usize..3 * node as usize + 3].fill(0.0);
        }
        let Iterate { pressures, auxiliaries, active, .. } = &**iterate;
        let mut fe = FeSystem { model, system, pressures, auxiliaries, active };
        let result = match known {
            Known::Nothing => evaluate(&mut fe, step, iterate.end_point(), want_tangent, &mut buffers),
            Known::WithoutCouplings | Known::All(_) => {
                evaluate_constraints(&mut fe, step, &iterate.q, want_tangent, &mut buffers)
            }
        };
        let s = &mut **system;
        s.buffers = buffers;
        result?;
        let rule = &step.rule;
        if !s.tally.touched.is_empty() || s.tally.support.len() > s.own.len() {
            s.tally.touched.sort_unstable();
            s.tally.touched.dedup();
            s.tally.support = with_nodes(&s.own, &s.tally.touched);
            let Buffers { residual, constraint, .. } = &mut s.buffers;
            for c in s.tally.touched.iter().flat_map(|&node| 3 * node as usize..3 * node as usize + 3) {
                residual[c] = -rule.constraint.weight * constraint[c];
            }
            model.embedding.pull_back_of(&s.tally.touched, residual);
            if !s.tally.shift.is_empty() {
                model.embedding.pull_back_of(&s.tally.touched, &mut s.tally.shift);
            }
        }
        let mut scale = (rule.force.weight * s.tally.force_scale)
            .max(SMALLEST_RESOLVED_MOTION * s.scales.force)
            .max(rule.constraint.weight * vector::norm2_of(&s.buffers.constraint, &s.tally.support));
        if rule.has_inertia() {
            scale = scale
                .max(vector::norm2_of(&s.buffers.inertia, &s.own))
                .max(SMALLEST_RESOLVED_MOTION * s.scales.mass_length * rule.inertia.increment);
        }
        if s.present.has_damping && rule.damping_weight() != 0.0 {
            scale = scale.max(rule.damping_weight() * vector::norm2_of(&s.buffers.damping, &s.own));
        }
        if let Some(history) = rule.history
            && !step.state_n.history.is_empty()
        {
            scale = scale.max(history.weight * vector::norm2_of(&step.state_n.history, &s.own));
        }
        self.add_anchor(want_tangent);
        // Without couplings the matrix is what is fixed, and springs are in it.
        if want_tangent && !self.model.contacts.is_empty() {
            self.known = Known::WithoutCouplings;
        }
        let s = &mut *self.system;
        let mut sum = s.tally.auxiliary_square;
        for (rhs, &component) in s.rhs.iter_mut().zip(&s.matrix.numbering.free) {
            let r = s.buffers.residual[component as usize];
            *rhs = -r;
            sum += r * r;
        }
        if !s.tally.shift.is_empty() {
            for (rhs, &component) in s.rhs.iter_mut().zip(&s.matrix.numbering.free) {
                *rhs -= s.tally.shift[component as usize];
            }
        }
        Ok(ResidualNorms { residual: sum.sqrt(), scale })
    }

    /// Lets contact methods follow the iterate, and the pattern follow them.
    fn renew_contacts(&mut self, want_tangent: bool) -> Result<(), StepError> {
        if self.model.contacts.is_empty() {
            return Ok(());
        }
        let Self { model, system, iterate, step, .. } = self;
        let changed = system.tally.contact_time.measure(|| {
            model.couplings_mut().try_fold(false, |changed, (c, pair)| {
                Ok(pair.term.renew(&iterate.at(c, step), want_tangent)? || changed)
            })
        });
        if system.shares.agree(changed)? {
            self.system.renew_pattern(self.model, &self.iterate.active)?;
        }
        Ok(())
    }

    fn measured(&mut self, want_tangent: bool) -> Result<ResidualNorms, StepError> {
        let mut timings = std::mem::take(self.timings);
        self.system.tally.contact_time = PhaseTime::default();
        let norms = timings.measure(Phase::Assembly, || self.evaluate(want_tangent));
        timings.split(Phase::Assembly, Phase::Contact, self.system.tally.contact_time);
        *self.timings = timings;
        norms
    }

    /// Moves prescribed components (`component`, new position) and lets all others follow by one linear solution from the present
    /// iterate: `K_ff du_f = -R_f - K_fp du_p`. Putting prescribed motions on the boundary alone would squash the elements there.
    ///
    /// `K_fp du_p` is a central difference of the residual along `du_p`, because the matrix has no columns of prescribed components.
    ///
    /// Where surfaces must stay apart, all go a part of the way at most, which is returned: 1 if nothing is in the way.
    pub fn predict(&mut self, prescribed: &[(usize, f64)]) -> Result<f64, StepError> {
        let q_n = &self.step.state_n.q;
        let from: Vec<f64> = prescribed.iter().map(|&(component, _)| self.iterate.q[component]).collect();
        let largest = prescribed.iter().zip(&from).map(|((_, to), from)| (to - from).abs()).fold(0.0, f64::max);
        let bodies = self.model.bodies.iter().map(|b| b.solid.characteristic_length());
        let layers = self.model.contacts.iter().filter(|pair| pair.keeps_apart());
        let length = (bodies.chain(self.model.parts.iter().map(|p| p.length_scale())))
            .chain(layers.map(|pair| pair.term.length_scale()))
            .fold(f64::INFINITY, f64::min);
        if largest == 0.0 || !length.is_finite() {
            return Ok(1.0);
        }
        let fraction = DIFFERENCE * length / largest;
        let mut rhs_at = |fraction: f64| -> Result<Vec<f64>, StepError> {
            for (&(component, to), from) in prescribed.iter().zip(&from) {
                self.iterate.place(component, from + fraction * (to - from), q_n);
            }
            self.iterate.follow(&self.model.embedding);
            self.measured(false)?;
            Ok(self.system.rhs.clone())
        };
        let (ahead, behind) = (rhs_at(fraction)?, rhs_at(-fraction)?);
        for (&(component, _), from) in prescribed.iter().zip(&from) {
            self.iterate.place(component, *from, q_n);
        }
        self.iterate.follow(&self.model.embedding);
        self.measured(true)?;
        for ((rhs, ahead), behind) in self.system.rhs.iter_mut().zip(ahead).zip(behind) {
            *rhs += (ahead - behind) / (2.0 * fraction);
        }
        self.solve()?;
        let mut part = 1.0;
        if self.model.keeps_apart() {
            for (&(component, to), from) in prescribed.iter().zip(&from) {
                self.system.base.full_increment[component] = to - from;
            }
            part = self.longest_step()?;
            if part < 1.0 {
                part *= OF_FREE_WAY;
            }
            for &(component, _) in prescribed {
                self.system.base.full_increment[component] = 0.0;
            }
        }
        self.update(part)?;
        for (&(component, to), from) in prescribed.iter().zip(&from) {
            self.iterate.place(component, if part == 1.0 { to } else { from + part * (to - from) }, q_n);
        }
        self.iterate.follow(&self.model.embedding);
        Ok(part)
    }

    /// Brings the iterate, which is at the start of the step, as far towards a start of the iterations as surfaces stay apart, and the prescribed components all of their way.
    pub fn go_apart(&mut self, start: &Iterate, prescribed: &[(usize, f64)]) -> Result<(), StepError> {
        let q_n = &self.step.state_n.q;
        let increment: Vec<f64> = start.q.iter().zip(&self.iterate.q).map(|(to, from)| to - from).collect();
        let part = self.model.longest_step(&self.iterate.q, &increment);
        if part == 1.0 {
            self.iterate.clone_from(start);
            return Ok(());
        }
        for component in self.system.own.iter().flat_map(std::ops::Range::clone) {
            self.iterate.displace(component, part * start.increment[component], q_n);
        }
        self.iterate.follow(&self.model.embedding);
        self.predict_all(prescribed)
    }

    /// [`Self::predict`] until the prescribed components are where they have to be.
    pub fn predict_all(&mut self, prescribed: &[(usize, f64)]) -> Result<(), StepError> {
        for _ in 0..MAX_PREDICTIONS {
            if self.predict(prescribed)? == 1.0 {
                return Ok(());
            }
        }
        let is_prescribed = |node: u32| {
            let known = |component: usize| prescribed.iter().any(|&(other, _)| other == component);
            (3 * node as usize..3 * node as usize + 3).all(known)
        };
        let (place, at, remedy) = blocked(self.model, &self.iterate.q, &is_prescribed);
        Err(StepError::Blocked { attempts: MAX_PREDICTIONS, place, at: Box::new(at), remedy })
    }
}

impl StepProblem<'_> {
    /// Increments of all components after a linear solution, of embedded nodes too.
    pub(crate) fn full_increment(&mut self) {
        let System { base: Base { full_increment, .. }, increment, matrix, .. } = &mut *self.system;
        for (&component, du) in matrix.numbering.free.iter().zip(increment.iter()) {
            full_increment[component as usize] = *du;
        }
        self.model.embedding.follow(full_increment);
    }

    /// Increments of condensed auxiliaries after a linear solution.
    fn recover(&mut self) -> Result<(), StepError> {
        if !has_condensed(self.model) {
            return Ok(());
        }
        self.full_increment();
        let Self { model, system, step, iterate, .. } = self;
        let Base { full_increment, auxiliary_increment, .. } = &mut system.base;
        self.timings.measure(Phase::Contact, || {
            for (c, pair) in model.couplings() {
                pair.term.recover(&iterate.at(c, step), full_increment, &mut auxiliary_increment[c])?;
            }
            Ok(())
        })
    }
}

/// Energy of deformation and of potentials in a static step, minus what dead loads and stabilisation did since its start.
fn potential_energy(model: &Model, system: &System, iterate: &Iterate, step: &Step<'_>) -> Result<f64, StepError> {
    let mut energy = 0.0;
    let at = iterate.force_at(step);
    let of_bodies = model.bodies.iter().try_fold(0.0, |sum, body| Ok(sum + body.solid.merit(&at)?));
    energy += system.shares.sum(system.shares.agree(of_bodies)?);
    for (part, _) in model.parts.iter().zip(&system.present.acting.parts).filter(|(_, acts)| **acts) {
        energy += part.merit(&at)?;
    }
    for (c, pair) in model.couplings() {
        energy += pair.term.work(&iterate.at(c, step))?.stored;
    }
    if system.loads.has_dead {
        for range in &system.loads.support {
            energy -= vector::dot(&system.loads.dead[range.clone()], &iterate.increment[range.clone()]);
        }
    }
    Ok(energy + system.stabilisation_energy(&iterate.increment, step.dt))
}

/// Values from which the auxiliaries of the active slots start at the present iterate.
pub(crate) fn start_auxiliaries(model: &Model, step: &Step<'_>, iterate: &mut Iterate) -> Result<(), StepError> {
    for (c, pair) in model.couplings().filter(|(_, pair)| !pair.term.auxiliaries().is_empty()) {
        let mut values = std::mem::take(&mut iterate.auxiliaries[c]);
        let started = pair.term.start_auxiliaries(&iterate.at(c, step), &mut values);
        iterate.auxiliaries[c] = values;
        started?;
    }
    Ok(())
}

impl StepProblem<'_> {
    fn has_symmetric_forces(&self) -> bool {
        let rule = Rule::Force(self.step.rule.force.rule);
        self.model.forces(&self.system.present.acting).all(|(term, acts)| !acts || term.is_symmetric(rule))
    }

    /// Whether every part of the tangent is symmetric under the rule of the step. With a weight on constraint forces the constraint rows, which
    /// have none, are not their gradients.
    pub(crate) fn is_symmetric(&self) -> bool {
        let rule = &self.step.rule;
        let contact = Rule::Constraint(rule.constraint.rule);
        let loads = || self.model.acting_loads(&self.system.present.acting);
        loads().all(|load| load.is_symmetric(Rule::Force(rule.force.rule)))
            && (!(self.system.present.has_damping && self.system.present.has_rates)
                || self.model.bodies.iter().all(|body| body.damping.stiffness == 0.0))
            && self.has_symmetric_forces()
            && (self.model.contacts.is_empty()
                || rule.constraint.weight == 1.0
                    && self.model.couplings().all(|(_, pair)| pair.term.is_symmetric(contact)))
    }
}

impl StepProblem<'_> {
    /// Whether the residual is the gradient of a potential, but for friction: a static step under dead loads, with no force but those of energies, and no multiplier.
    fn has_potential(&self) -> bool {
        let rule = self.step.rule.constraint.rule;
        !self.step.rule.has_inertia()
            && !self.model.acting_loads(&self.system.present.acting).any(Load::follows)
            && self.has_symmetric_forces()
            && self.model.contacts.iter().filter_map(CouplingTerm::potential).all(|of| of.has_energy(rule))
            && !self.iterate.active.iter().flatten().any(|&active| active)
    }
}

/// Solves with the factors of an earlier iterate of the step while that is faster, else with new ones.
fn solve_linear(
    solver: &mut dyn LinearSolver,
    pattern: &Arc<SparsityPattern>,
    (kind, tolerance): (MatrixKind, f64),
    values: &[f64],
    rhs: &[f64],
    increment: &mut [f64],
    timings: &mut Timings,
) -> Result<(), LinalgError> {
    timings.measure(Phase::Factorisation, || solver.analyse(pattern, kind))?;
    let nearby = timings.measure(Phase::Solve, || solver.solve_nearby(values, rhs, increment, tolerance))?;
    if nearby.is_none() {
        timings.measure(Phase::Factorisation, || solver.factorise(values))?;
        timings.measure(Phase::Solve, || solver.solve(rhs, increment))?;
    }
    Ok(())
}

impl StepProblem<'_> {
    /// Remembers the iterate as the base of updates, completes the increment, and returns its norm.
    pub(crate) fn keep_base(&mut self) -> Result<f64, StepError> {
        let s = &mut *self.system;
        for own in &s.own {
            s.base.increment[own.clone()].copy_from_slice(&self.iterate.increment[own.clone()]);
        }
        if !s.base.linearised.is_empty() {
            s.base.linearised.copy_from_slice(&self.iterate.q);
            s.base.has_linearised = true;
        }
        for (base, pressures) in s.base.pressures.iter_mut().zip(&self.iterate.pressures) {
            base.copy_from_slice(pressures);
        }
        for (base, auxiliaries) in s.base.auxiliaries.iter_mut().zip(&self.iterate.auxiliaries) {
            base.copy_from_slice(auxiliaries);
        }
        self.recover()?;
        let s = &*self.system;
        Ok(vector::norm2(&s.increment[..s.matrix.free()]))
    }
}

impl NewtonProblem for StepProblem<'_> {
    type Error = StepError;

    fn aim(&mut self, relative: f64) {
        self.accuracy.aim(relative);
    }

    fn assemble(&mut self) -> Result<ResidualNorms, StepError> {
        if let Known::All(norms) = self.known {
            self.known = Known::WithoutCouplings;
            return Ok(norms);
        }
        self.measured(true)
    }

    fn solve(&mut self) -> Result<f64, StepError> {
        let tolerance = self.accuracy.tolerance();
        self.system.place_equations(self.model, &self.iterate.q);
        let kind = if self.is_symmetric() { MatrixKind::Symmetric } else { MatrixKind::General };
        let s = &mut *self.system;
        let values = s.matrix.values();
        debug_assert!(
            kind == MatrixKind::General || s.matrix.pattern.asymmetry(values) < 1e-8,
            "the tangent is announced as symmetric and is not"
        );
        let (solver, pattern) = (&mut s.solver, &s.matrix.pattern);
        let (rhs, increment) = (&s.rhs, &mut s.increment);
        let timings = &mut *self.timings;
        let mut solved = solve_linear(&mut **solver, pattern, (kind, tolerance), values, rhs, increment, timings);
        if let Err(LinalgError::Singular { row }) = solved
            && s.soften_singular()
        {
            let error = LinalgError::Singular { row };
            s.rows.dependent = Some(linear_error(self.model, s, self.iterate, false, error).to_string());
            let System { solver, matrix, rhs, increment, .. } = &mut *s;
            let (pattern, values) = (&matrix.pattern, matrix.values());
            solved = solve_linear(&mut **solver, pattern, (kind, tolerance), values, rhs, increment, self.timings);
            *self.solves += 1;
        }
        *self.solves += 1;
        self.solved_shifted = s.tally.shifts_rows;
        if let Err(error) = solved {
            return Err(linear_error(self.model, s, self.iterate, self.step.rule.has_inertia(), error));
        }
        if self.counts_directions() {
            self.system.excess = self.count_excess();
        }
        self.keep_base()
    }

    fn line_search(&self, chosen: LineSearch) -> LineSearch {
        let is_steep = self.model.contacts.iter().filter_map(CouplingTerm::potential).any(|of| of.acts());
        if is_steep && chosen != LineSearch::Off {
            LineSearch::best()
        } else if self.model.bodies.iter().any(|body| body.solid.has_history()) {
            // Points that begin to yield are kinks of the force.
            chosen.with_slope()
        } else {
            chosen
        }
    }

    fn solve_downhill(&mut self) -> Result<f64, StepError> {
        if !self.has_potential() {
            return self.solve();
        }
        if !self.is_symmetric() {
            let increment = self.solve_unsymmetric_downhill()?;
            self.set_line();
            return Ok(increment);
        }
        if self.solve_definite().map_err(|error| linear_error(self.model, self.system, self.iterate, false, error))? {
            return self.keep_base();
        }
        let shift = match self.factorise_downhill().and_then(|shift| self.solve_factorised().map(|()| shift)) {
            Ok(shift) => shift,
            Err(error) => {
                let has_inertia = self.step.rule.has_inertia();
                return Err(linear_error(self.model, self.system, self.iterate, has_inertia, error));
            }
        };
        self.lengthen(shift);
        self.solved_shifted = shift > 0.0;
        self.keep_base()
    }

    fn potential(&mut self) -> Result<Option<Potential>, StepError> {
        if !self.has_potential() {
            return Ok(None);
        }
        let is_fixed = self.is_symmetric();
        let Self { model, system, iterate, step, part, timings, .. } = self;
        let value = match self.energy {
            Some(value) => value,
            None => timings.measure(Phase::Assembly, || potential_energy(model, system, iterate, step))?,
        };
        self.energy = Some(value);
        let anchored = system
            .present
            .anchor
            .as_ref()
            .map_or(0.0, |anchor| anchor.energy(&iterate.q, &system.matrix.numbering.free));
        let friction: f64 =
            model.contacts.iter().filter_map(CouplingTerm::potential).map(|of| of.friction_along(*part)).sum();
        let friction = if is_fixed { 0.0 } else { friction };
        let round_off = ENERGY_ROUND_OFF * system.scales.energy;
        Ok(Some(Potential { value: value + anchored + friction, round_off, is_fixed }))
    }

    fn slope(&self) -> f64 {
        self.slope_of_increment()
    }

    fn longest_step(&mut self) -> Result<f64, StepError> {
        if !self.model.keeps_apart() {
            return Ok(1.0);
        }
        self.full_increment();
        let Self { model, system, iterate, timings, .. } = self;
        Ok(timings.measure(Phase::Search, || model.longest_step(&iterate.q, &system.base.full_increment)))
    }

    fn update(&mut self, factor: f64) -> Result<(), StepError> {
        (self.part, self.known, self.energy) = (factor, Known::Nothing, None);
        let s = &*self.system;
        let q_n = &self.step.state_n.q;
        for (du, &component) in s.increment.iter().zip(&s.matrix.numbering.free) {
            let component = component as usize;
            self.iterate.displace(component, s.base.increment[component] + factor * du, q_n);
        }
        self.iterate.follow(&self.model.embedding);
        for ((pressures, base), equations) in
            self.iterate.pressures.iter_mut().zip(&s.base.pressures).zip(&s.matrix.slots.equation)
        {
            for ((p, p0), &equation) in pressures.iter_mut().zip(base).zip(equations) {
                if equation != NONE {
                    *p = p0 + factor * s.increment[equation as usize];
                }
            }
        }
        for (c, pair) in self.model.contacts.iter().enumerate() {
            let kinds = pair.term.auxiliaries();
            if kinds.is_empty() {
                continue;
            }
            let (values, base) = (&mut self.iterate.auxiliaries[c], &s.base.auxiliaries[c]);
            for (slot, &first) in s.matrix.slots.equation[c].iter().enumerate() {
                if first == NONE || !self.iterate.active[c][slot] {
                    continue;
                }
                let mut row = first as usize;
                for (k, kind) in kinds.iter().enumerate() {
                    let at = slot * kinds.len() + k;
                    let increment = match kind {
                        Auxiliary::Condensed => s.base.auxiliary_increment[c][at],
                        _ => {
                            row += 1;
                            s.increment[row]
                        }
                    };
                    values[at] = base[at] + factor * increment;
                }
            }
        }
        Ok(())
    }

    fn residual_norms(&mut self) -> Result<ResidualNorms, StepError> {
        self.measured(false)
    }

    fn relative_violation(&self) -> f64 {
        self.system.tally.gap_measure
    }

    fn is_linearised(&self) -> bool {
        !self.solved_shifted
    }

    fn is_recoverable(&self, error: &StepError) -> bool {
        matches!(error, StepError::Term(_))
    }

    fn iterate_norm(&self) -> f64 {
        vector::norm2_of(&self.iterate.q, &self.system.own)
    }
}
