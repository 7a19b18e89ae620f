//! The finite-element model as a system that every scheme can drive: forces of solids, loads and contact, mass.

use crate::assembly::System;
use crate::books::{work_at, work_of};
use crate::mass_solve::MassSolver;
use crate::moment::moment_forces;
use crate::rows::SmoothedPair;
use crate::{Load, LoadKind, Model, StepError};
use std::ops::Range;
use stoss_fe_solid::{SolidStep, TangentTarget, add_follower_pressure, follower_pressure};
use stoss_integrators::{DampingTangent, ForceRule, GradientRule, SecondOrderSystem, StepConfiguration};
use stoss_linalg::vector;
use stoss_reference_element::MAX_FACE_NODES;
use stoss_term::{At, Auxiliary, Fault, Undefined};

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

impl FeSystem<'_> {
    /// Follower pressures, moments and centrifugal loads at the configuration of the rule, into `system.follower` and, with their tangent, the solids' values.
    ///
    /// # Errors
    /// [`StepError::Term`] if the directors that a moment acts on are on a line in this configuration, which they are not where they are orthogonal.
    pub fn evaluate_follower(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
    ) -> Result<(), StepError> {
        let s = &mut *self.system;
        for range in &s.load_support {
            s.follower[range.clone()].fill(0.0);
        }
        let theta = rule.load_fraction();
        let mut stencil = *s.first_stencil.last().unwrap_or(&0);
        let model = self.model;
        let is_centrifugal = |load: &Load| matches!(load.kind, LoadKind::Centrifugal { .. });
        // What is off keeps its place in the pattern.
        for (l, load) in model.loads.iter().enumerate().filter(|(_, load)| !is_centrifugal(load)) {
            if self.system.acting.loads[l] {
                self.add_follower(l, stencil, step, theta, tangent)?;
            }
            stencil += load.stencils();
        }
        for (l, _) in model.loads.iter().enumerate().filter(|(_, load)| is_centrifugal(load)) {
            if self.system.acting.loads[l] {
                self.add_follower(l, stencil, step, theta, tangent)?;
            }
        }
        Ok(())
    }

    /// Forces of one of those loads, added to `system.follower`; its stencils begin with `stencil`.
    pub fn add_follower(
        &mut self,
        load: usize,
        stencil: usize,
        step: StepConfiguration<'_>,
        theta: f64,
        tangent: Option<f64>,
    ) -> Result<(), StepError> {
        let (load, s) = (&self.model.loads[load], &mut *self.system);
        match &load.kind {
            LoadKind::Dead { .. } => {}
            LoadKind::Centrifugal { .. } => s.add_centrifugal(load, step, theta, tangent),
            LoadKind::Moment { directors } => {
                for (k, &three) in directors.iter().enumerate() {
                    let (force, mut derivative) = moment(load, three, step, theta)?;
                    for (&vector, f) in three.iter().zip(force.chunks_exact(3)) {
                        let at = 3 * vector as usize;
                        s.follower[at..at + 3].iter_mut().zip(f).for_each(|(sum, f)| *sum += f);
                    }
                    if let Some(weight) = tangent {
                        derivative.iter_mut().for_each(|d| *d *= -weight * theta);
                        s.solid_map.add(stencil + k, &derivative, &mut s.solid_values);
                    }
                }
            }
            LoadKind::FollowerPressure { facets } => {
                let pressure = load.magnitude.value(step.time + theta * step.dt, 0);
                for (k, facet) in facets.iter().enumerate() {
                    let mut places = [[0.0; 3]; MAX_FACE_NODES];
                    places.iter_mut().zip(facet.iter()).for_each(|(x, &node)| *x = between(step, theta, node));
                    let mut load = follower_pressure(facet.kind(), &places[..facet.len()], pressure);
                    add_follower_pressure(facet, load.force(), &mut s.follower);
                    if let Some(weight) = tangent {
                        // The load enters the residual with a minus, and d q_theta / d q_np1 = theta.
                        let factor = -weight * theta;
                        load.tangent_mut().iter_mut().for_each(|t| *t *= factor);
                        s.solid_map.add(stencil + k, load.tangent(), &mut s.solid_values);
                    }
                }
            }
        }
        Ok(())
    }

    /// Work of a load in a step with its forces at `(1 - theta) q_n + theta q_np1` and the time of that.
    ///
    /// # Errors
    /// As of [`FeSystem::evaluate_follower`].
    pub fn load_work(&mut self, load: usize, step: StepConfiguration<'_>, theta: f64) -> Result<f64, StepError> {
        let Load { kind, magnitude, .. } = &self.model.loads[load];
        let moved = |c: usize| step.q_np1[c] - step.q_n[c];
        if let LoadKind::Dead { patterns } = kind {
            let time = step.time + theta * step.dt;
            let columns = patterns.iter().enumerate().map(|(column, pattern)| {
                let unit: f64 = pattern.iter().map(|&(c, unit)| unit * moved(c as usize)).sum();
                magnitude.value(time, column) * unit
            });
            return Ok(columns.sum());
        }
        let empty = vec![0.0; self.system.follower.len()];
        let kept = std::mem::replace(&mut self.system.follower, empty);
        let result = self.add_follower(load, 0, step, theta, None);
        let force = std::mem::replace(&mut self.system.follower, kept);
        result?;
        Ok(self.system.load_support.iter().flat_map(Range::clone).map(|c| force[c] * moved(c)).sum())
    }
}

/// A vector at `(1 - theta) q_n + theta q_np1`.
pub(crate) fn between(step: StepConfiguration<'_>, theta: f64, vector: u32) -> [f64; 3] {
    let at = 3 * vector as usize;
    std::array::from_fn(|i| {
        if theta == 1.0 { step.q_np1[at + i] } else { (1.0 - theta) * step.q_n[at + i] + theta * step.q_np1[at + i] }
    })
}

/// Forces of a moment on three directors, and their derivatives with respect to these.
fn moment(
    load: &Load,
    directors: [u32; 3],
    step: StepConfiguration<'_>,
    theta: f64,
) -> Result<([f64; 9], [f64; 81]), StepError> {
    let time = step.time + theta * step.dt;
    let moment = [0, 1, 2].map(|column| load.magnitude.value(time, column));
    moment_forces(&directors.map(|vector| between(step, theta, vector)), moment).ok_or_else(|| {
        let reason =
            "the directors of a loaded part turn by nearly half a turn in one step; use smaller steps".to_owned();
        Fault::from(Undefined { term: load.name.clone(), reason }).into()
    })
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
        self.system.masses.multiply_add(factor, x, out);
    }

    fn solve_mass(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), StepError> {
        let System { masses, numbering, mass_solver, .. } = &mut *self.system;
        mass_solver.get_or_insert_with(|| MassSolver::new(masses, &numbering.free, x.len())).solve(masses, rhs, x)
    }

    fn start_tangent(&mut self, factor: f64) {
        let s = &mut *self.system;
        if s.mass_values.is_empty() {
            s.solid_values.fill(0.0);
            return;
        }
        for (k, m) in s.solid_values.iter_mut().zip(&s.mass_values) {
            *k = factor * m;
        }
    }

    fn add_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let s = &mut *self.system;
        let solid_step = SolidStep { q_n: step.q_n, q_np1: step.q_np1, rule };
        for (b, body) in self.model.bodies.iter().enumerate() {
            let target = tangent.map(|factor| TangentTarget {
                map: &s.solid_map,
                first_stencil: s.first_stencil[b],
                factor,
                values: &mut s.solid_values,
            });
            let before = s.has_linearised.then_some(&s.linearised[..]);
            body.solid.assemble_after(before, solid_step, 1.0, out, target, &mut s.workspaces[b])?;
        }
        for (b, body) in self.model.bodies.iter().enumerate() {
            let components = 3 * body.nodes.start as usize..3 * body.nodes.end as usize;
            s.works.bodies[b] = work_of(out, components, step.q_n, step.q_np1);
        }
        if !self.model.parts.is_empty() {
            self.add_part_forces(step, rule, tangent, out)?;
        }
        let s = &mut *self.system;
        s.force_scale = vector::norm2_of(out, &s.own);
        if s.has_dead_loads {
            s.force_scale = s.force_scale.max(vector::norm2_of(&s.dead, &s.load_support));
            subtract(&s.dead, &s.load_support, out);
        }
        if s.has_followers {
            self.evaluate_follower(step, rule, tangent)?;
            let s = &mut *self.system;
            subtract(&s.follower, &s.load_support, out);
            s.force_scale = s.force_scale.max(vector::norm2_of(&s.follower, &s.load_support));
        }
        self.model.embedding.pull_back_of(&self.system.loaded, out);
        Ok(())
    }

    fn has_damping(&self) -> bool {
        self.system.has_damping
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
            s.values.fill(0.0);
            for (value, &at) in s.solid_values.iter().zip(&s.solid_to_global) {
                s.values[at as usize] = *value;
            }
            s.fill_inactive();
            s.soften_closed();
        }
        let free = s.numbering.free.len();
        s.rhs[free..].fill(0.0);
        s.gap_measure = 0.0;
        if !s.shift.is_empty() {
            // Embedded nodes have handed theirs over.
            for range in &s.own {
                s.shift[range.clone()].fill(0.0);
            }
        }
        s.auxiliary_square = 0.0;
        let mut time = s.contact_time;
        let result = time.measure(|| self.add_contact_elements(step, rule, weight, tangent, out));
        self.system.contact_time = time;
        result
    }
}

impl FeSystem<'_> {
    /// Forces of springs, beams, strings.
    fn add_part_forces(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let s = &mut *self.system;
        let mut stencil = s.first_part_stencil;
        // A step of no length is the start of a run, where nothing has a rate.
        let has_rates = s.has_rates && step.dt > 0.0;
        let at = At { time: step.time, rates: has_rates, ..At::force([step.q_n, step.q_np1], rule, step.dt) };
        let System { solid_map, solid_values, weighted, acting, works, .. } = s;
        for ((part, &acts), work) in self.model.parts.iter().zip(&acting.parts).zip(&mut works.parts) {
            *work = 0.0;
            if !acts {
                part.stencils(&[], &mut |_, _| stencil += 1);
                continue;
            }
            part.assemble(&at, tangent.is_some(), &mut |local| {
                for (&vector, r) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                    let first = 3 * vector as usize;
                    out[first..first + 3].iter_mut().zip(r).for_each(|(o, r)| *o += r);
                }
                *work += work_at(&local.nodes, &local.residual, step.q_n, step.q_np1);
                if let Some(factor) = tangent {
                    weighted.clear();
                    weighted.extend(local.tangent.iter().map(|t| factor * t));
                    solid_map.add(stencil, weighted, solid_values);
                }
                stencil += 1;
            })?;
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
        s.tangents = s.tangents.saturating_add(u32::from(tangent));
        if tangent {
            s.shifts_rows = false;
        }
        let from_zero = s.tangents <= FROM_ZERO;
        let has_rates = s.has_rates && step.dt > 0.0;
        let mut k = 0;
        for (c, pair) in model.couplings() {
            let term = &pair.term;
            let length = term.length_scale();
            let compliance = s.rigid_compliance(step.dt, length);
            let System {
                rhs,
                values,
                slot_equation,
                contact_map,
                weighted,
                shift,
                gap_measure,
                auxiliary_square,
                touched,
                transform,
                expanded,
                shifts_rows,
                rows,
                works,
                ..
            } = s;
            let work = &mut works.couplings[c];
            *work = 0.0;
            let smoothed = match (pair.unilateral(), rows.smoothing.get(c)) {
                (Some(_), Some(&theta)) => {
                    Some(SmoothedPair { theta, factor: pair.complementarity, pressures: &self.pressures[c] })
                }
                _ => None,
            };
            let equations = &slot_equation[c];
            let (pressures, auxiliaries, active) = (&self.pressures[c], &self.auxiliaries[c], &self.active[c]);
            let at = At {
                time: step.time,
                dt: step.dt,
                rates: has_rates,
                auxiliaries,
                ..At::constraint([step.q_n, step.q_np1], rule, pressures, active)
            };
            term.assemble(&at, tangent, &mut |local| {
                let coordinates = 3 * local.nodes.len();
                *work += work_at(&local.nodes, &local.residual, step.q_n, step.q_np1);
                for (i, &node) in local.nodes.iter().enumerate() {
                    if model.embedding.has(node) {
                        touched.push(node);
                    }
                    for d in 0..3 {
                        out[3 * node as usize + d] -= local.residual[3 * i + d];
                    }
                }
                if !local.shift.is_empty() {
                    shift.resize(out.len(), 0.0);
                    for (part, &node) in local.shift.chunks_exact(3).zip(&local.nodes) {
                        for d in 0..3 {
                            shift[3 * node as usize + d] += weight * part[d];
                        }
                    }
                }
                *shifts_rows |= local.shift.iter().skip(coordinates).take(local.slots.len()).any(|&shift| shift != 0.0);
                for (k, (&slot, &row)) in local.slots.iter().zip(&local.residual[coordinates..]).enumerate() {
                    let weight = term.slot_weight(slot as usize);
                    let row = smoothed.map_or(row, |smoothed| smoothed.row(slot, row, weight));
                    rhs[equations[slot as usize] as usize] -= row + local.shift.get(coordinates + k).unwrap_or(&0.0);
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
                            rhs[first + 1 + k] -= row + local.shift.get(at).unwrap_or(&0.0);
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
                                    rhs[equations[slot as usize] as usize] += entry * pressures[slot as usize];
                                }
                            }
                        }
                        (&transform.matrix, 3 * expanded.len())
                    } else {
                        (&local.tangent, coordinates)
                    };
                    if weight == 1.0 && smoothed.is_none() {
                        contact_map.add(k, tangent, values);
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
                        contact_map.add(k, weighted, values);
                    }
                }
                k += 1;
            })?;
        }
        Ok(())
    }
}
