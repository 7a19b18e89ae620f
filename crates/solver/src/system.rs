//! The finite-element model as a system that every scheme can drive: forces of solids, loads and contact, mass.

use crate::assembly::{LoadForces, Scratch, System, Tally};
use crate::books::{work_at, work_of};
use crate::dealt::Dealt;
use crate::inertia::Inertia;
use crate::mass_solve::MassSolver;
use crate::matrix::{Fixed, Matrix};
use crate::rows::SmoothedPair;
use crate::{Model, StepError};
use std::ops::Range;
use stoss_integrators::{DampingTangent, ForceRule, GradientRule, SecondOrderSystem, StepConfiguration};
use stoss_linalg::{ScatterMap, vector};
use stoss_term::{At, Auxiliary, Fault, Term, Undefined};

/// Evaluations with a tangent in a step in which the equations of constraints between rigid bodies are written for the multipliers themselves and not for their increments.
const FROM_ZERO: u32 = 2;

/// `out <- out - x` in those components.
fn subtract(x: &[f64], ranges: &[Range<usize>], out: &mut [f64]) {
    for range in ranges {
        for (out, x) in out[range.clone()].iter_mut().zip(&x[range.clone()]) {
            *out -= x;
        }
    }
}

/// Model and storage at an iterate of the pressures.
pub(crate) struct FeSystem<'a> {
    pub model: &'a Model,
    pub system: &'a mut System,
    pub pressures: &'a [Vec<f64>],
    /// Further unknowns of the slots.
    pub auxiliaries: &'a [Vec<f64>],
    pub active: &'a [Vec<bool>],
}

/// Where contributions of forces go: a vector, and the values of a pattern.
struct Sink<'a> {
    out: &'a mut [f64],
    /// Sign of the residual in the vector.
    sign: f64,
    map: &'a ScatterMap,
    values: &'a mut [f64],
    /// Weight of the tangent, if there is one.
    tangent: Option<f64>,
    weighted: &'a mut Vec<f64>,
    /// Stencil of the next contribution.
    stencil: usize,
    /// Work of what was added.
    work: f64,
}

impl<'a> Sink<'a> {
    fn new(
        out: &'a mut [f64],
        sign: f64,
        (map, values): (&'a ScatterMap, &'a mut [f64]),
        tangent: Option<f64>,
        weighted: &'a mut Vec<f64>,
    ) -> Self {
        Self { out, sign, map, values, tangent, weighted, stencil: 0, work: 0.0 }
    }

    /// Adds all contributions of a term, which has these stencils. Those of a tangent of weight one are added as they are.
    fn add(&mut self, term: &dyn Term, at: &At<'_>, stencils: Range<usize>) -> Result<(), Fault> {
        (self.work, self.stencil) = (0.0, stencils.start);
        term.assemble(at, self.tangent.is_some(), &mut |local| {
            for (&node, r) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                let first = 3 * node as usize;
                self.out[first..first + 3].iter_mut().zip(r).for_each(|(o, r)| *o += self.sign * r);
            }
            self.work += work_at(&local.nodes, &local.residual, at.q_n, at.q_np1);
            match self.tangent {
                None => {}
                Some(1.0) => self.map.add(self.stencil, &local.tangent, self.values),
                Some(factor) => {
                    self.weighted.clear();
                    self.weighted.extend(local.tangent.iter().map(|t| factor * t));
                    self.map.add(self.stencil, self.weighted, self.values);
                }
            }
            self.stencil += 1;
        })?;
        if self.stencil == stencils.end {
            return Ok(());
        }
        let (name, made, named) = (term.name().to_owned(), self.stencil - stencils.start, stencils.len());
        let reason = format!(
            "it has assembled {made} contributions, and `stencils` names {named}: all of them are needed in every step"
        );
        Err(Fault::other(Undefined { term: name, reason }))
    }
}

impl FeSystem<'_> {
    /// An iterate of the forces. A step of no length is the start of a run, where nothing has a rate.
    fn force_at<'b>(&self, step: StepConfiguration<'b>, rule: ForceRule) -> At<'b> {
        let rates = self.system.present.has_rates && step.dt > 0.0;
        At { time: step.time, rates, ..At::force([step.q_n, step.q_np1], rule, step.dt) }
    }

    /// Loads that depend on the configuration, into `system.loads.follower` and, with their tangent, the solids' values.
    ///
    /// # Errors
    /// [`StepError::Term`] if the directors that a moment acts on are on a line in this configuration, which they are not where they are orthogonal.
    pub fn evaluate_follower(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
    ) -> Result<(), StepError> {
        let at = self.force_at(step, rule);
        let System { matrix, loads: LoadForces { support, follower, .. }, present, scratch, .. } = &mut *self.system;
        for range in support.iter() {
            follower[range.clone()].fill(0.0);
        }
        let Fixed { map, values, loads, .. } = &mut matrix.fixed;
        let mut sink = Sink::new(follower, -1.0, (map, values), tangent, &mut scratch.weighted);
        let loads = self.model.loads.iter().zip(&present.acting.loads).zip(&*loads);
        // What is off keeps its place in the pattern.
        for ((load, _), stencils) in loads.filter(|((load, acts), _)| **acts && load.follows()) {
            sink.add(load, &at, stencils.clone())?;
        }
        Ok(())
    }
}

impl SecondOrderSystem for FeSystem<'_> {
    type Error = StepError;

    fn dimension(&self) -> usize {
        self.model.reference.len()
    }

    fn has_constraints(&self) -> bool {
        !self.model.contacts.is_empty()
    }

    fn add_mass_product(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        self.system.inertia.masses.multiply_add(factor, x, out);
    }

    fn solve_mass(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), StepError> {
        let System { matrix, inertia: Inertia { masses, solver, .. }, .. } = &mut *self.system;
        solver.get_or_insert_with(|| MassSolver::new(masses, &matrix.numbering.free, x.len())).solve(masses, rhs, x)
    }

    fn start_tangent(&mut self, factor: f64) {
        self.system.matrix.fixed.start(factor);
    }

    fn add_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        self.add_forces(step, rule, tangent, out)?;
        let s = &mut *self.system;
        s.tally.force_scale = vector::norm2_of(out, &s.own);
        if s.loads.has_dead {
            s.tally.force_scale = s.tally.force_scale.max(vector::norm2_of(&s.loads.dead, &s.loads.support));
            subtract(&s.loads.dead, &s.loads.support, out);
        }
        if s.loads.has_followers {
            self.evaluate_follower(step, rule, tangent)?;
            let s = &mut *self.system;
            subtract(&s.loads.follower, &s.loads.support, out);
            s.tally.force_scale = s.tally.force_scale.max(vector::norm2_of(&s.loads.follower, &s.loads.support));
        }
        self.model.embedding.pull_back_of(&self.system.loads.embedded, out);
        Ok(())
    }

    fn has_damping(&self) -> bool {
        self.system.present.has_damping
    }

    fn add_damping(
        &mut self,
        q: &[f64],
        v: &[f64],
        tangent: Option<DampingTangent>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        self.add_body_damping(q, v, tangent, out)
    }

    fn add_constraint_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: GradientRule,
        weight: f64,
        tangent: bool,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let s = &mut *self.system;
        if tangent {
            s.matrix.spread();
            s.matrix.fill_inactive(s.tally.tangents == 0);
            s.matrix.soften_closed(s.rows.compliance, s.present.has_rates);
        }
        let free = s.matrix.free();
        s.rhs[free..].fill(0.0);
        s.tally.gap_measure = 0.0;
        if !s.tally.shift.is_empty() {
            // Embedded nodes have handed theirs over.
            for range in &s.own {
                s.tally.shift[range.clone()].fill(0.0);
            }
        }
        s.tally.auxiliary_square = 0.0;
        let mut time = s.tally.contact_time;
        let result = time.measure(|| self.add_contact_elements(step, rule, weight, tangent, out));
        self.system.tally.contact_time = time;
        result
    }
}

impl FeSystem<'_> {
    /// Forces of bodies and parts.
    fn add_forces(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let at = self.force_at(step, rule);
        let System { shares, matrix, present, scratch, base, tally, .. } = &mut *self.system;
        let at = At { before: base.has_linearised.then_some(&base.linearised[..]), ..at };
        let Fixed { map, values, forces, .. } = &mut matrix.fixed;
        let works = &mut tally.works.forces;
        let (bodies, parts) = forces.split_at(self.model.bodies.len());
        let added = shares.add_sum(out, |out| {
            let mut sink = Sink::new(out, 1.0, (map, &mut *values), tangent, &mut scratch.weighted);
            let mut bodies = self.model.bodies.iter().zip(bodies);
            bodies.try_for_each(|(body, stencils)| sink.add(&body.solid, &at, stencils.clone()))
        });
        shares.agree(added)?;
        // Their nodes have no other forces yet.
        for (work, body) in works.iter_mut().zip(&self.model.bodies) {
            *work = work_of(out, body.components(), step.q_n, step.q_np1);
        }
        let mut sink = Sink::new(out, 1.0, (map, values), tangent, &mut scratch.weighted);
        let parts = self.model.parts.iter().zip(&present.acting.parts).zip(parts);
        for (((part, &acts), stencils), work) in parts.zip(&mut works[bodies.len()..]) {
            *work = 0.0;
            if acts {
                sink.add(&**part, &at, stencils.clone())?;
                *work = sink.work;
            }
        }
        Ok(())
    }

    /// The part of [`SecondOrderSystem::add_constraint_force`] that the contact methods have.
    fn add_contact_elements(
        &mut self,
        step: StepConfiguration<'_>,
        rule: GradientRule,
        weight: f64,
        tangent: bool,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let (model, s) = (self.model, &mut *self.system);
        s.tally.tangents = s.tally.tangents.saturating_add(u32::from(tangent));
        if tangent {
            s.tally.shifts_rows = false;
        }
        let from_zero = s.tally.tangents <= FROM_ZERO;
        let has_rates = s.present.has_rates && step.dt > 0.0;
        let mut k = 0;
        for (c, pair) in model.couplings() {
            let term = &pair.term;
            let length = term.length_scale();
            let compliance = s.rigid_compliance(step.dt, length);
            let System { shares, rhs, matrix, scratch: Scratch { weighted, transform, expanded }, rows, tally, .. } = s;
            let Matrix { map, values, slots, .. } = matrix;
            let Tally { shift, gap_measure, auxiliary_square, touched, shifts_rows, works, .. } = tally;
            let work = &mut works.couplings[c];
            *work = 0.0;
            let smoothed = match (pair.unilateral(), rows.smoothing.get(c)) {
                (Some(_), Some(&theta)) => {
                    Some(SmoothedPair { theta, factor: pair.complementarity, pressures: &self.pressures[c] })
                }
                _ => None,
            };
            let equations = &slots.equation[c];
            let (pressures, auxiliaries, active) = (&self.pressures[c], &self.auxiliaries[c], &self.active[c]);
            // Sums of this rank, if the term deals out its contributions.
            let deals = shares.deals(c);
            let mut dealt = deals.then(|| Dealt::new(out.len(), rhs.len()));
            let squares = if deals { std::mem::take(auxiliary_square) } else { 0.0 };
            let (sums, row_sums, shifts, mut seen) = match &mut dealt {
                Some(Dealt { out, rhs, shift, seen }) => (&mut out[..], &mut rhs[..], shift, Some(seen)),
                None => (&mut *out, &mut rhs[..], &mut *shift, None),
            };
            let at = At {
                time: step.time,
                dt: step.dt,
                rates: has_rates,
                auxiliaries,
                ..At::constraint([step.q_n, step.q_np1], rule, pressures, active)
            };
            let assembled = term.assemble(&at, tangent, &mut |local| {
                touched.extend(local.nodes.iter().filter(|&&node| model.embedding.has(node)));
                if let Some(seen) = &mut seen {
                    seen.note(local, equations, slots.width[c]);
                }
                if local.is_elsewhere {
                    k += 1;
                    return;
                }
                let coordinates = 3 * local.nodes.len();
                *work += work_at(&local.nodes, &local.residual, step.q_n, step.q_np1);
                for (i, &node) in local.nodes.iter().enumerate() {
                    for d in 0..3 {
                        sums[3 * node as usize + d] -= local.residual[3 * i + d];
                    }
                }
                if !local.shift.is_empty() {
                    shifts.resize(sums.len(), 0.0);
                    for (part, &node) in local.shift.chunks_exact(3).zip(&local.nodes) {
                        for d in 0..3 {
                            shifts[3 * node as usize + d] += weight * part[d];
                        }
                    }
                }
                *shifts_rows |= local.shift.iter().skip(coordinates).take(local.slots.len()).any(|&shift| shift != 0.0);
                for (k, (&slot, &row)) in local.slots.iter().zip(&local.residual[coordinates..]).enumerate() {
                    let weight = term.slot_weight(slot as usize);
                    let row = smoothed.map_or(row, |smoothed| smoothed.row(slot, row, weight));
                    row_sums[equations[slot as usize] as usize] -=
                        row + local.shift.get(coordinates + k).unwrap_or(&0.0);
                    *gap_measure = gap_measure.max(row.abs() / (weight * length));
                }
                *gap_measure = gap_measure.max(local.violation);
                if local.auxiliaries > 0 {
                    let kinds = || term.auxiliaries().iter().filter(|&&kind| kind != Auxiliary::Condensed);
                    let rows = local.residual[coordinates + local.slots.len()..].chunks_exact(local.auxiliaries);
                    for (s, (&slot, rows)) in local.slots.iter().zip(rows).enumerate() {
                        let (first, size) = (equations[slot as usize] as usize, term.slot_weight(slot as usize));
                        for (k, (row, kind)) in rows.iter().zip(kinds()).enumerate() {
                            let at = coordinates + local.slots.len() + local.auxiliaries * s + k;
                            row_sums[first + 1 + k] -= row + local.shift.get(at).unwrap_or(&0.0);
                            match kind {
                                Auxiliary::Balance => *auxiliary_square += row * row,
                                _ => *gap_measure = gap_measure.max(row.abs() / (size * length)),
                            }
                        }
                    }
                }
                if tangent {
                    let (tangent, coordinates) = if model.embedding.touches(&local.nodes) {
                        let rest = local.dim() - coordinates;
                        model.embedding.expand(&local.nodes, expanded);
                        model.embedding.transform(&local.nodes, expanded, rest, &local.tangent, transform);
                        if model.are_rigid(&local.nodes) {
                            let dim = 3 * expanded.len() + rest;
                            for (k, &slot) in local.slots.iter().enumerate() {
                                let area = term.slot_weight(slot as usize);
                                let (at, entry) = (3 * expanded.len() + k, compliance * area * area);
                                transform.matrix[at * dim + at] -= entry;
                                if from_zero {
                                    *shifts_rows = true;
                                    row_sums[equations[slot as usize] as usize] += entry * pressures[slot as usize];
                                }
                            }
                        }
                        (&transform.matrix, 3 * expanded.len())
                    } else {
                        (&local.tangent, coordinates)
                    };
                    if weight == 1.0 && smoothed.is_none() {
                        map.add(k, tangent, values);
                    } else {
                        // Forces are weighted, constraint rows are not.
                        let dim = coordinates + local.dim() - 3 * local.nodes.len();
                        weighted.clear();
                        weighted.extend_from_slice(tangent);
                        for entry in &mut weighted[..coordinates * dim] {
                            *entry *= weight;
                        }
                        if let Some(smoothed) = smoothed {
                            let of_slot = |slot: u32| term.slot_weight(slot as usize);
                            smoothed.change_tangent(local, weighted, coordinates, of_slot);
                        }
                        map.add(k, weighted, values);
                    }
                }
                k += 1;
            });
            if let Some(dealt) = dealt {
                shares.agree(assembled)?;
                dealt.add_to(shares, out, rhs, shift);
                let mut sums = [*work, *auxiliary_square];
                shares.sum_all(&mut sums);
                (*work, *auxiliary_square) = (sums[0], squares + sums[1]);
                let mut largest = [*gap_measure, f64::from(u8::from(*shifts_rows))];
                shares.max_all(&mut largest);
                (*gap_measure, *shifts_rows) = (largest[0], largest[1] > 0.0);
            } else {
                assembled?;
            }
        }
        Ok(())
    }
}
