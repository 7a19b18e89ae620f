//! Impacts: the velocities after a step in which something closed (theory/impacts).
//!
//! After a step is solved its velocities hold the impulses `dt p` of the slots that are closed, and these depend on where in the step a gap closed. They are taken out and replaced by those of an
//! impact law, with all bilateral constraints in the system. Positions stay.

mod complementarity;
mod friction;
mod law;
mod response;
mod rows;
mod sliding;

use super::Simulation;
use crate::StepError;
use crate::iterate::Iterate;
use complementarity::{DenseCompliance, OperatorCompliance};
use friction::{Cone, with_friction};
use law::{EnergyOnLine, Impulses, Rates, impulses};
use response::Response;
use rows::Row;
use sliding::Sliding;
use stoss_integrators::{State, StepRule};
use stoss_linalg::vector;
use stoss_term::{GradientRule, SlotKind, StepConfiguration, Work};

/// Closed slots of deformable bodies whose rate is below this part of the largest one of a closing so far are at rest: facets that turn change it in the second order.
const AT_REST: f64 = 1e-3;

/// Part of the largest velocity below which closed slots of rigid bodies are at rest.
const RIGID_AT_REST: f64 = 1e-12;

/// Up to so many slots `W` is computed by its columns, each of which takes a solution; the iteration for more of them takes about as many.
const DENSE_SLOTS: usize = 96;

/// Number of equations up to which a solution costs less than the rest, and the number of slots up to which `W` is then computed by its columns.
const FEW_EQUATIONS: usize = 2000;
const DENSE_SLOTS_OF_FEW: usize = 600;

/// Energy beside the largest of the run that is round-off.
const ROUND_OFF: f64 = 1e-13;

/// What is kept from one impact to the next.
#[derive(Debug, Default)]
pub(super) struct Impacts {
    response: Response,
    /// The largest rate of a slot that closed so far; history.
    pub largest_rate: f64,
}

/// What the law did to the velocities of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Impact {
    /// Kinetic energy that is lost.
    pub loss: f64,
    /// Kinetic energy that is lost by constraint of the model: shares by impulse times rate of approach.
    pub losses: Vec<f64>,
    /// The part of `loss` at slots of deformable bodies.
    pub deformable: f64,
    /// Energy that contact took from the bodies in the step itself, and which `loss` contains.
    pub closing: f64,
    /// Energy that contact took from the bodies in the step itself, by constraint.
    pub closings: Vec<f64>,
    /// Work of supports and drives.
    pub external: f64,
    /// Work of friction by constraint, in the place of what the step has: the difference.
    pub friction: Vec<f64>,
    /// Slots that closed.
    pub closed: u64,
    /// Energy that the law would have added.
    pub excess: f64,
    /// The largest rate of a slot that closed so far.
    pub largest_rate: f64,
    /// What the law put in the place of the forces of the step.
    pub mean: Mean,
}

/// Forces of the step by the impulses of the law: the difference from those of the step's own equations, an impulse over the step size.
#[derive(Clone, Debug, Default)]
pub(super) struct Mean {
    /// Pressures of all slots, those of the step included: with them the forces of the step give the change of momentum.
    pub pressures: Vec<Vec<f64>>,
    /// Forces of each constraint at the nodes that it knows: components in ascending order, and the forces.
    pub forces: Vec<Vec<(u32, f64)>>,
    /// Forces at prescribed components.
    pub reactions: Vec<(u32, f64)>,
}

/// Closed one-sided slots.
#[derive(Debug, Default)]
struct Closed {
    rows: Vec<Row>,
    /// The constraint of the model, and its slot.
    slots: Vec<(usize, usize)>,
    /// `dt p`, positive.
    impulses: Vec<f64>,
    restitution: Vec<f64>,
    /// Rates of gaps that are held and settle, not positive.
    settling: Vec<f64>,
    is_new: Vec<bool>,
    /// Whether a node of a solid is in the row.
    is_deformable: Vec<bool>,
}

/// Bilateral constraints.
#[derive(Debug, Default)]
struct Held {
    rows: Vec<Row>,
    /// The constraint of the model, and its slot.
    slots: Vec<(usize, usize)>,
    is_driven: Vec<bool>,
}

/// Velocities with the impulses of the rows that made them from those of the step.
#[derive(Clone, Debug)]
struct Velocities {
    v: Vec<f64>,
    slots: Vec<f64>,
    /// Two for each slot with friction.
    sliding: Vec<f64>,
    held: Vec<f64>,
}

impl Simulation {
    /// Whether velocities at the end of a step can come from an impact law: those of the mean velocity and of backward Euler. Schemes that carry accelerations, momenta or forces of constraints
    /// have the impact in what they carry.
    pub(super) fn has_impacts(rule: &StepRule) -> bool {
        rule.has_inertia()
            && rule.impulse.is_none()
            && rule.acceleration.is_none()
            && rule.history.is_none_or(|history| !history.constraint)
    }

    /// Replaces the velocities in `next` by those after the impact of what closed in the step. `None` if nothing did, and nothing that is closed moves.
    pub(super) fn impact(
        &mut self,
        iterate: &Iterate,
        of_pairs: &[Work],
        rule: &StepRule,
        dt: f64,
        next: &mut State,
    ) -> Result<Option<Impact>, StepError> {
        if !Self::has_impacts(rule) || !self.is_closed(iterate) {
            return Ok(None);
        }
        let (rigid, largest) = (self.model.bodies.is_empty(), self.impacts.largest_rate);
        let closes = |c: usize| {
            let before = self.slots.active[c].iter().zip(&iterate.active[c]);
            self.model.contacts[c].always_holds() || before.into_iter().any(|(before, now)| *now && !before)
        };
        let mut with_law = (0..self.model.contacts.len()).filter(|&c| self.model.contacts[c].restitution.is_some());
        if !rigid && largest == 0.0 && !with_law.any(closes) {
            // Nothing that is closed has been set in motion by an impact.
            return Ok(None);
        }
        let closed = self.closed(iterate, rule.constraint.weight * dt, dt, &next.q)?;
        if closed.rows.is_empty() {
            return Ok(None);
        }
        let new = closed.is_new.contains(&true);
        let speed = |row: &Row, v: &[f64]| row.dot(v).abs() / row.norm();
        let moves = |rows: &[Row], than: f64| rows.iter().any(|row| speed(row, &next.v) > than);
        let round_off = RIGID_AT_REST * vector::norm_inf(&next.v).max(vector::norm_inf(&self.state.v));
        if !new && !rigid && (largest == 0.0 || !moves(&closed.rows, AT_REST * largest)) {
            return Ok(None);
        }
        let held = self.held(iterate, &next.q)?;
        if !new && rigid && !moves(&closed.rows, round_off) && !moves(&held.rows, round_off) {
            return Ok(None);
        }
        let of_new = closed.rows.iter().zip(&closed.is_new).filter(|(_, new)| **new);
        let largest_rate = of_new.map(|(row, _)| speed(row, &self.state.v)).fold(largest, f64::max);
        let closings = self.closing_work(iterate, of_pairs, rule, &next.q)?;
        // Where nothing closes only what alternates along the normals is taken out.
        let sliding = if new { self.sliding(iterate, &closed, rule, dt, &next.q)? } else { Vec::new() };
        let slipped: Vec<f64> = of_pairs.iter().map(|work| work.dissipated).collect();
        let v_1 = next.v.clone();
        let works = (closings, slipped, new);
        let (mut impact, last) = self.after(&closed, &sliding, held.rows, &held.is_driven, works, rule, next)?;
        let change: Vec<f64> = next.v.iter().zip(&v_1).map(|(v, v_1)| v - v_1).collect();
        let rows = (&closed, &sliding[..], &held.slots[..]);
        impact.mean = self.mean(iterate, rows, (&last, &change), rule.constraint.weight * dt);
        Ok(Some(Impact { largest_rate, ..impact }))
    }

    /// Whether a slot that has the law is closed.
    fn is_closed(&self, iterate: &Iterate) -> bool {
        let pairs = self.model.contacts.iter().zip(&iterate.active).zip(&iterate.pressures);
        pairs.filter(|((pair, _), _)| pair.restitution.is_some()).any(|((pair, active), pressures)| {
            match pair.unilateral() {
                Some(_) => active.contains(&true),
                None => pair.bilateral().filter(|of| of.has_limits()).is_some_and(|of| {
                    let is_closed = |slot: usize| of.slot_kind(slot) == SlotKind::Limit && pressures[slot] != 0.0;
                    (0..active.len()).any(|slot| active[slot] && is_closed(slot))
                }),
            }
        })
    }

    /// The slots that are closed at the end of the step and carry.
    fn closed(&self, iterate: &Iterate, weight: f64, dt: f64, q: &[f64]) -> Result<Closed, StepError> {
        let (mut closed, model) = (Closed::default(), &self.model);
        for (c, pair) in model.contacts.iter().enumerate() {
            let Some(restitution) = pair.restitution.filter(|_| pair.acts) else { continue };
            let (pressures, active) = (&iterate.pressures[c], &iterate.active[c]);
            let mut add = |row: Row, slot: usize, settling: f64, is_new: bool| {
                if !row.is_zero() {
                    let of_body =
                        |component: u32| model.bodies.iter().any(|body| body.nodes.contains(&(component / 3)));
                    closed.is_deformable.push(row.entries.iter().any(|entry| of_body(entry.0)));
                    closed.rows.push(row);
                    closed.slots.push((c, slot));
                    closed.impulses.push(weight * pressures[slot].abs());
                    closed.restitution.push(restitution);
                    closed.settling.push(settling / dt);
                    closed.is_new.push(is_new);
                }
            };
            if let Some(method) = pair.unilateral() {
                let carrying: Vec<bool> = active.iter().zip(pressures).map(|(active, p)| *active && *p > 0.0).collect();
                method.constraint_gradients(q, &carrying, &mut |slot, nodes, gradient| {
                    let row = Row::new(&model.embedding, nodes, gradient, 1.0);
                    add(row, slot, method.settling(slot), !self.slots.active[c][slot]);
                })?;
            } else if let Some(of) = pair.bilateral().filter(|of| of.has_limits()) {
                let before = &self.slots.pressures[c];
                self.bilateral_rows(c, iterate, q, &mut |slot, nodes, gradient| {
                    if of.slot_kind(slot) == SlotKind::Limit && pressures[slot] != 0.0 {
                        // The row is minus the gradient of the gap where the multiplier is positive.
                        let row = Row::new(&model.embedding, nodes, gradient, -pressures[slot].signum());
                        add(row, slot, 0.0, before[slot] == 0.0);
                    }
                })?;
            }
        }
        Ok(closed)
    }

    /// Gradients of the active slots of a bilateral constraint at `q`: slot, nodes, three entries a node.
    fn bilateral_rows(
        &self,
        c: usize,
        iterate: &Iterate,
        q: &[f64],
        visit: &mut (dyn FnMut(usize, &[u32], &[f64]) + Send),
    ) -> Result<(), StepError> {
        let at_end = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
        let (multipliers, auxiliaries, active) = (&iterate.pressures[c], &iterate.auxiliaries[c], &iterate.active[c]);
        self.model.contacts[c].term.assemble(
            &at_end.at(multipliers, active).with_auxiliaries(auxiliaries),
            true,
            &mut |local| {
                let (dim, coordinates) = (local.dim(), 3 * local.nodes.len());
                for (k, &slot) in local.slots.iter().enumerate() {
                    let first = (coordinates + k) * dim;
                    visit(slot as usize, &local.nodes, &local.tangent[first..first + coordinates]);
                }
            },
        )?;
        Ok(())
    }

    /// The equations that hold at all times.
    fn held(&self, iterate: &Iterate, q: &[f64]) -> Result<Held, StepError> {
        let (mut held, embedding) = (Held::default(), &self.model.embedding);
        for (c, pair) in self.model.contacts.iter().enumerate() {
            let Some(of) = pair.bilateral() else { continue };
            self.bilateral_rows(c, iterate, q, &mut |slot, nodes, gradient| {
                let kind = of.slot_kind(slot);
                if matches!(kind, SlotKind::Equation | SlotKind::Driven) {
                    let row = Row::new(embedding, nodes, gradient, 1.0);
                    if !row.is_zero() {
                        held.rows.push(row);
                        held.slots.push((c, slot));
                        held.is_driven.push(kind == SlotKind::Driven);
                    }
                }
            })?;
        }
        Ok(held)
    }

    /// What the normal forces of each constraint that has the law took from the bodies in the step. What they gave (bodies that overlap) is none of the law's: it stays where it is seen as a gain.
    fn closing_work(
        &self,
        iterate: &Iterate,
        of_pairs: &[Work],
        rule: &StepRule,
        q: &[f64],
    ) -> Result<Vec<f64>, StepError> {
        let q_n = &self.state.q;
        let configuration = StepConfiguration { q_n, q_np1: q, rule: rule.constraint.rule };
        let mut closings = vec![0.0; self.model.contacts.len()];
        for (c, pair) in self.model.contacts.iter().enumerate().filter(|(_, pair)| pair.restitution.is_some()) {
            if let Some(closing) = of_pairs[c].closing {
                closings[c] = closing.max(0.0);
                continue;
            }
            let (pressures, auxiliaries, active) = (&iterate.pressures[c], &iterate.auxiliaries[c], &iterate.active[c]);
            let mut work = of_pairs[c].friction_work - of_pairs[c].driven;
            self.system.shares.visit_all(
                c,
                &*pair.term,
                &configuration.at(pressures, active).with_auxiliaries(auxiliaries),
                &mut |local| {
                    for (&node, residual) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                        let first = 3 * node as usize;
                        let moved = (0..3).map(|i| residual[i] * (q[first + i] - q_n[first + i]));
                        work -= moved.sum::<f64>();
                    }
                },
            )?;
            closings[c] = (-work).max(0.0);
        }
        Ok(closings)
    }

    /// Forces of the step with the impulses of the law.
    fn mean(
        &self,
        iterate: &Iterate,
        (closed, sliding, held): (&Closed, &[Sliding], &[(usize, usize)]),
        (last, change): (&Velocities, &[f64]),
        time: f64,
    ) -> Mean {
        let mut pressures = iterate.pressures.clone();
        let mut by_constraint = vec![Vec::new(); pressures.len()];
        let one_sided = closed.rows.iter().zip(&closed.slots).zip(&last.slots).map(|((row, &(c, slot)), j)| {
            // The row of a limit at its upper end is minus the gradient that its multiplier goes with.
            let sign = if iterate.pressures[c][slot] < 0.0 { -1.0 } else { 1.0 };
            (row, (c, slot), j / time, sign)
        });
        let bilateral = self.impacts.response.rows().iter().zip(held).zip(&last.held);
        for (row, (c, slot), force, sign) in
            one_sided.chain(bilateral.map(|((row, &place), j)| (row, place, j / time, -1.0)))
        {
            pressures[c][slot] += sign * force;
            by_constraint[c].push((row, force));
        }
        for (of, j) in sliding.iter().zip(last.sliding.chunks_exact(2)) {
            by_constraint[closed.slots[of.slot].0].extend(of.rows.iter().zip(j).map(|(row, j)| (row, j / time)));
        }
        let mut sum = vec![0.0; change.len()];
        let mut gather = |rows: &[(&Row, f64)]| -> Vec<(u32, f64)> {
            rows.iter().for_each(|(row, force)| row.add_to_nodes(*force, &mut sum));
            let mut components: Vec<u32> = rows.iter().flat_map(|(row, _)| row.components()).collect();
            components.sort_unstable();
            components.dedup();
            components.into_iter().map(|c| (c, std::mem::take(&mut sum[c as usize]))).collect()
        };
        let forces = by_constraint.iter().map(|rows| gather(rows)).collect();
        let mut reactions = Vec::new();
        if !self.stage.prescribed.is_empty() {
            // What changes the momentum and is no impulse of a row comes from the supports.
            let mut momentum = vec![0.0; change.len()];
            self.system.inertia.masses.multiply_add(1.0 / time, change, &mut momentum);
            by_constraint.iter().flatten().for_each(|(row, force)| row.add_to(-force, &mut momentum));
            reactions.extend(self.stage.prescribed.iter().map(|&(c, ..)| (c, momentum[c as usize])));
        }
        Mean { pressures, forces, reactions }
    }

    /// Sets the velocities after the impact. Also the impulses of the rows that made them from those of the step.
    fn after(
        &mut self,
        closed: &Closed,
        sliding: &[Sliding],
        held: Vec<Row>,
        is_driven: &[bool],
        (closings, slipped, new): (Vec<f64>, Vec<f64>, bool),
        rule: &StepRule,
        next: &mut State,
    ) -> Result<(Impact, Velocities), StepError> {
        let v_1 = &next.v;
        let of_rows = |rows: &[Row], v: &[f64]| -> Vec<f64> { rows.iter().map(|row| row.dot(v)).collect() };
        let rates_held = of_rows(&held, v_1);
        let Self { impacts, system, state, ledger, stage, .. } = &mut *self;
        impacts.response.prepare(system, held)?;
        let response = &mut impacts.response;
        let (masses, free) = (&system.inertia.masses, &system.matrix.numbering.free[..]);
        let m = closed.rows.len();
        // Impulses of the slots, then of their friction.
        let along = || sliding.iter().flat_map(|of| &of.rows);
        // Rates of sliding: on a surface that moves beside its mesh they are zero where the slave goes along with it.
        let slid = |v: &[f64]| -> Vec<f64> {
            let rows = sliding.iter().flat_map(|of| of.rows.iter().zip(of.carried));
            rows.map(|(row, carried)| row.dot(v) - carried).collect()
        };
        let force_of = |j: &[f64]| -> Vec<f64> {
            let mut force = vec![0.0; v_1.len()];
            closed.rows.iter().chain(along()).zip(j).for_each(|(row, &j)| row.add_to(j, &mut force));
            force
        };
        // The end of the step without the impulses of the closed slots, on the bilateral constraints.
        let of_friction = || sliding.iter().flat_map(|of| of.impulses);
        let without: Vec<f64> = closed.impulses.iter().copied().chain(of_friction()).map(|j| -j).collect();
        let to_constraints: Vec<f64> =
            rates_held.iter().zip(is_driven).map(|(rate, driven)| if *driven { 0.0 } else { -rate }).collect();
        let (change, of_held) = response.velocities((masses, free), &force_of(&without), Some(&to_constraints))?;
        let v: Vec<f64> = v_1.iter().zip(&change).map(|(v, change)| v + change).collect();
        let free_end = Velocities { v, slots: without[..m].to_vec(), sliding: without[m..].to_vec(), held: of_held };
        // In a step without an impact only what alternates is taken out.
        let no_restitution = vec![0.0; m];
        let before = of_rows(&closed.rows, &state.v);
        let rates = Rates {
            before: &before,
            free: &of_rows(&closed.rows, &free_end.v),
            least: &closed.settling,
            restitution: if new { &closed.restitution } else { &no_restitution },
        };
        let is_dense = m <= DENSE_SLOTS || m <= DENSE_SLOTS_OF_FEW && free.len() <= FEW_EQUATIONS;
        let found: Impulses = if is_dense {
            let mut columns = Vec::with_capacity(m * m);
            for row in &closed.rows {
                let mut force = vec![0.0; v_1.len()];
                row.add_to(1.0, &mut force);
                let (velocity, _) = response.velocities((masses, free), &force, None)?;
                columns.extend(closed.rows.iter().map(|row| row.dot(&velocity)));
            }
            let mut w = DenseCompliance::new(m, columns);
            let Ok(found) = impulses(&mut w, &rates);
            found
        } else {
            let mass = masses.diagonal(v_1.len());
            let own = |row: &Row| -> f64 {
                let terms = row.entries.iter().map(|&(c, g)| (mass[c as usize], g * g));
                terms.filter(|(mass, _)| *mass > 0.0).map(|(mass, square)| square / mass).sum()
            };
            let diagonal = closed.rows.iter().map(own).collect();
            let mut w = OperatorCompliance::new(diagonal, |j: &[f64], out: &mut [f64]| -> Result<(), StepError> {
                let (velocity, _) = response.velocities((masses, free), &force_of(j), None)?;
                out.iter_mut().zip(&closed.rows).for_each(|(out, row)| *out = row.dot(&velocity));
                Ok(())
            });
            impulses(&mut w, &rates)?
        };
        let with = |response: &mut Response, j: &[f64]| -> Result<Velocities, StepError> {
            let (change, held) = response.velocities((masses, free), &force_of(j), None)?;
            let sum = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
            Ok(Velocities {
                v: sum(&free_end.v, &change),
                slots: sum(&free_end.slots, &j[..m]),
                sliding: match j.len() > m {
                    true => sum(&free_end.sliding, &j[m..]),
                    false => free_end.sliding.clone(),
                },
                held: sum(&free_end.held, &held),
            })
        };
        let plastic = with(response, &found.plastic)?;
        let elastic = if found.all == found.plastic { None } else { Some(with(response, &found.all)?) };
        // Energy without the work of supports and drives: that of the step, and the work of the impulses since.
        let first = masses.kinetic_energy(v_1);
        let rates_1 = of_rows(&closed.rows, v_1);
        let sliding_1 = slid(v_1);
        let energy = |response: &Response, of: &Velocities| -> f64 {
            let slots = closed.rows.iter().zip(&of.slots).zip(&rates_1);
            let by_slots: f64 = slots.map(|((row, j), rate)| j * (rate + row.dot(&of.v))).sum();
            let of_sliding = slid(&of.v).into_iter().zip(&of.sliding).zip(&sliding_1);
            let by_sliding: f64 = of_sliding.map(|((now, j), rate)| j * (rate + now)).sum();
            let held = response.rows().iter().zip(&of.held).zip(&rates_held).zip(is_driven);
            let not_driven = held.filter(|(_, driven)| !**driven);
            let by_held: f64 = not_driven.map(|(((row, j), rate), _)| j * (rate + row.dot(&of.v))).sum();
            first + 0.5 * (by_slots + by_sliding + by_held)
        };
        let closing: f64 = closings.iter().sum();
        // Backward Euler takes the energy of the jump of the velocity itself, more or less of it as the gap closes late or early.
        let has_mean_velocity = rule.velocity.velocity == -1.0;
        let mut has_friction = vec![false; closings.len()];
        sliding.iter().for_each(|of| has_friction[closed.slots[of.slot].0] = true);
        let by_friction: f64 = has_friction.iter().zip(&slipped).filter(|(has, _)| **has).map(|(_, work)| work).sum();
        let target = if has_mean_velocity { first + closing + by_friction } else { energy(response, &free_end) };
        let round_off = ROUND_OFF * ledger.balance.largest_energy.max(target);
        let of_plastic = energy(response, &plastic);
        let mut excess = 0.0;
        let between = |from: &[f64], to: &[f64], s: f64| -> Vec<f64> {
            from.iter().zip(to).map(|(from, to)| from + s * (to - from)).collect()
        };
        let mix = |from: &Velocities, to: &Velocities, s: f64| Velocities {
            v: between(&from.v, &to.v, s),
            slots: between(&from.slots, &to.slots, s),
            sliding: between(&from.sliding, &to.sliding, s),
            held: between(&from.held, &to.held, s),
        };
        let of_step = || Velocities {
            v: v_1.clone(),
            slots: vec![0.0; m],
            sliding: vec![0.0; 2 * sliding.len()],
            held: vec![0.0; rates_held.len()],
        };
        let difference = |from: &[f64], to: &[f64]| -> f64 {
            let change: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
            masses.kinetic_energy(&change)
        };
        let last = if of_plastic > target + round_off {
            // The law may not add energy: as far from the velocities of the step as there is energy.
            excess = of_plastic - target;
            let line = EnergyOnLine { start: first, end: of_plastic, curvature: difference(v_1, &plastic.v) };
            let s = line.reaches(target).filter(|s| (0.0..=1.0).contains(s)).unwrap_or(line.lowest());
            mix(&of_step(), &plastic, s)
        } else if let Some(elastic) = elastic {
            let line = EnergyOnLine {
                start: of_plastic,
                end: energy(response, &elastic),
                curvature: difference(&plastic.v, &elastic.v),
            };
            let to_be_had = target - of_plastic;
            let s = match found.uniform {
                Some(e) => line.reaches(of_plastic + e * e * to_be_had).unwrap_or(1.0),
                None if line.end > target => line.reaches(target).unwrap_or(line.lowest()).min(1.0),
                None => 1.0,
            };
            mix(&plastic, &elastic, s)
        } else {
            plastic
        };
        // Normal rates that the law without friction gives are those of the law with it; impulses of both are found together.
        let last = if sliding.is_empty() {
            last
        } else {
            let mut columns = Vec::new();
            for k in 0..m + 2 * sliding.len() {
                let mut one = vec![0.0; m + 2 * sliding.len()];
                one[k] = 1.0;
                let (velocity, _) = response.velocities((masses, free), &force_of(&one), None)?;
                columns.extend(closed.rows.iter().chain(along()).map(|row| row.dot(&velocity)));
            }
            let w = DenseCompliance::new(m + 2 * sliding.len(), columns);
            let start: Vec<f64> = last.slots.iter().zip(&closed.impulses).map(|(j, p)| j + p).collect();
            let largest = start.iter().copied().fold(0.0, f64::max);
            let rates = of_rows(&closed.rows, &last.v);
            let least = (0..m).map(|i| if start[i] > RIGID_AT_REST * largest { rates[i] } else { closed.settling[i] });
            let coefficients: Vec<(usize, f64)> = sliding.iter().map(|of| (of.slot, of.coefficient)).collect();
            let mut free_rates = of_rows(&closed.rows, &free_end.v);
            free_rates.extend(slid(&free_end.v));
            let with_least = |response: &mut Response, least: &[f64]| -> Result<Velocities, StepError> {
                let cone = Cone { least, free: &free_rates, sliding: &coefficients };
                let start: Vec<f64> = start.iter().copied().chain(vec![0.0; 2 * sliding.len()]).collect();
                with(response, &with_friction(&w, &cone, &start))
            };
            let found = with_least(response, &least.collect::<Vec<f64>>())?;
            if energy(response, &found) <= target + round_off {
                found
            } else {
                // Newton's restitution at single slots can add energy: as far from the result without it as there is some.
                let plastic = with_least(response, &closed.settling)?;
                let of_plastic = energy(response, &plastic);
                let line = |from: &Velocities, to: &Velocities| EnergyOnLine {
                    start: energy(response, from),
                    end: energy(response, to),
                    curvature: difference(&from.v, &to.v),
                };
                if of_plastic <= target + round_off {
                    let s = line(&plastic, &found).reaches(target).filter(|s| (0.0..=1.0).contains(s)).unwrap_or(0.0);
                    mix(&plastic, &found, s)
                } else {
                    excess += of_plastic - target;
                    let line = line(&of_step(), &plastic);
                    let s = line.reaches(target).filter(|s| (0.0..=1.0).contains(s)).unwrap_or(line.lowest());
                    mix(&of_step(), &plastic, s)
                }
            }
        };
        let of_last = energy(response, &last);
        let is_carried = sliding.iter().any(|of| of.carried != [0.0; 2]);
        let moves =
            is_driven.contains(&true) || is_carried || stage.prescribed.iter().any(|&(c, ..)| v_1[c as usize] != 0.0);
        let kinetic = masses.kinetic_energy(&last.v);
        let (mut loss, external) = if moves { (target - of_last, kinetic - of_last) } else { (target - kinetic, 0.0) };
        // What friction takes of it.
        let mut friction = vec![0.0; closings.len()];
        let mut of_slot = sliding.iter().zip(last.sliding.chunks_exact(2));
        of_slot.by_ref().for_each(|(of, changes)| {
            let taken = (0..2).map(|i| {
                let j = changes[i] + of.impulses[i];
                -0.5 * j * (of.rows[i].dot(&free_end.v) + of.rows[i].dot(&last.v) - 2.0 * of.carried[i])
            });
            friction[closed.slots[of.slot].0] += taken.sum::<f64>();
        });
        let all_friction: f64 = friction.iter().sum();
        let part = if all_friction > loss.max(0.0) { loss.max(0.0) / all_friction } else { 1.0 };
        for (c, work) in friction.iter_mut().enumerate() {
            *work = part * work.max(0.0);
            loss -= *work;
            *work -= if has_friction[c] { slipped[c] } else { 0.0 };
        }
        let mut losses = vec![0.0; closings.len()];
        let approach = last.slots.iter().zip(&closed.impulses).zip(&before).map(|((j, p), u)| (j + p) * (-u).max(0.0));
        let shares: Vec<f64> = approach.map(|share| share.max(0.0)).collect();
        let all: f64 = shares.iter().sum();
        let mut deformable = 0.0;
        for (k, &(c, _)) in closed.slots.iter().enumerate() {
            let part = loss * if all > 0.0 { shares[k] / all } else { 1.0 / m as f64 };
            losses[c] += part;
            deformable += if closed.is_deformable[k] { part } else { 0.0 };
        }
        next.v.copy_from_slice(&last.v);
        self.model.embedding.follow(&mut next.v);
        let closed = closed.is_new.iter().filter(|new| **new).count() as u64;
        let impact = Impact {
            loss,
            losses,
            deformable,
            closing,
            closings,
            external,
            friction,
            closed,
            excess,
            ..Impact::default()
        };
        Ok((impact, last))
    }
}
