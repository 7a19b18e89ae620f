//! Impacts: the velocities after a step in which something closed (theory/impacts).
//!
//! After a step is solved its velocities hold the impulses `dt p` of the slots that are closed, and these depend on where in the step a gap closed. They are taken out and replaced by those of an
//! impact law, with all bilateral constraints in the system. Positions stay.

mod complementarity;
mod friction;
mod groups;
mod law;
mod response;
mod rows;
mod sliding;
mod velocities;

use super::Simulation;
use crate::StepError;
use crate::iterate::Iterate;
use groups::{Group, Groups};
use response::Response;
use rows::Row;
use sliding::Sliding;
use stoss_integrators::{State, StepRule};
use stoss_linalg::{NONE, vector};
use stoss_term::{GradientRule, SlotKind, StepConfiguration, Work};
use velocities::{Event, Law, Targets, Velocities};

/// Closed slots of deformable bodies whose rate is below this part of the largest one of a closing so far are at rest: facets that turn change it in the second order.
const AT_REST: f64 = 1e-3;

/// Part of the largest velocity below which closed slots of rigid bodies are at rest.
const RIGID_AT_REST: f64 = 1e-12;

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

impl Closed {
    /// Keeps the slots that `keeps` has.
    fn retain(&mut self, keeps: &[bool]) {
        fn retain<T>(list: &mut Vec<T>, keeps: &[bool]) {
            let mut keeps = keeps.iter();
            list.retain(|_| keeps.next().copied().unwrap_or(false));
        }
        retain(&mut self.rows, keeps);
        retain(&mut self.slots, keeps);
        retain(&mut self.impulses, keeps);
        retain(&mut self.restitution, keeps);
        retain(&mut self.settling, keeps);
        retain(&mut self.is_new, keeps);
        retain(&mut self.is_deformable, keeps);
    }
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
        let mut closed = self.closed(iterate, rule.constraint.weight * dt, dt, &next.q)?;
        let speed = |row: &Row, v: &[f64]| row.dot(v).abs() / row.norm();
        let moves = |row: &Row, than: f64| speed(row, &next.v) > than;
        let round_off = RIGID_AT_REST * vector::norm_inf(&next.v).max(vector::norm_inf(&self.state.v));
        let slot_moves = |row: &Row| match rigid {
            true => moves(row, round_off),
            false => largest > 0.0 && moves(row, AT_REST * largest),
        };
        if closed.rows.is_empty() || !rigid && !closed.is_new.contains(&true) && !closed.rows.iter().any(slot_moves) {
            return Ok(None);
        }
        let held = self.held(iterate, &next.q)?;
        let mut groups = self.groups(&closed, &held);
        let acts = |group: &Group| {
            group.is_new
                || group.slots.iter().any(|&k| slot_moves(&closed.rows[k]))
                || rigid && group.held.iter().any(|&k| moves(&held.rows[k], round_off))
        };
        let acting: Vec<bool> = groups.groups.iter().map(acts).collect();
        if acting.contains(&false) {
            let keeps: Vec<bool> = groups.of_slots.iter().map(|&group| acting[group as usize]).collect();
            closed.retain(&keeps);
            groups = self.groups(&closed, &held);
        }
        if closed.rows.is_empty() {
            return Ok(None);
        }
        let of_new = closed.rows.iter().zip(&closed.is_new).filter(|(_, new)| **new);
        let largest_rate = of_new.map(|(row, _)| speed(row, &self.state.v)).fold(largest, f64::max);
        let mut closings = self.closing_work(iterate, of_pairs, rule, &next.q)?;
        closings.iter_mut().zip(&groups.of_pairs).filter(|(_, of)| **of == NONE).for_each(|(work, _)| *work = 0.0);
        let mut sliding = Vec::new();
        if closed.is_new.contains(&true) {
            sliding = self.sliding(iterate, &closed, rule, dt, &next.q)?;
            // Where nothing closes only what alternates along the normals is taken out.
            sliding.retain(|of| groups.groups[groups.of_slots[of.slot] as usize].is_new);
        }
        let slipped: Vec<f64> = of_pairs.iter().map(|work| work.dissipated).collect();
        let v_1 = next.v.clone();
        let Held { rows, slots, is_driven } = held;
        self.impacts.response.prepare(&self.system, rows)?;
        let (mut impact, last) =
            self.after((&closed, &sliding, &groups), &is_driven, (closings, slipped), rule, &v_1)?;
        next.v.copy_from_slice(&last.v);
        self.model.embedding.follow(&mut next.v);
        let change: Vec<f64> = next.v.iter().zip(&v_1).map(|(v, v_1)| v - v_1).collect();
        let rows = (&closed, &sliding[..], &slots[..]);
        impact.mean = self.mean(iterate, rows, (&last, &change), rule.constraint.weight * dt);
        Ok(Some(Impact { largest_rate, ..impact }))
    }

    fn groups(&self, closed: &Closed, held: &Held) -> Groups {
        let equation = &self.system.matrix.numbering.equation;
        let is_free = |component: u32| equation[component as usize] != NONE;
        Groups::new(&self.model, &self.system.inertia.masses, &is_free, closed, &held.rows)
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

    /// The velocities after the impact, with the impulses of the rows that made them from those of the step, and what it did to the energy.
    fn after(
        &mut self,
        (closed, sliding, groups): (&Closed, &[Sliding], &Groups),
        is_driven: &[bool],
        (closings, slipped): (Vec<f64>, Vec<f64>),
        rule: &StepRule,
        v_1: &[f64],
    ) -> Result<(Impact, Velocities), StepError> {
        let Self { impacts, system, state, ledger, stage, .. } = &mut *self;
        let (masses, free) = (&system.inertia.masses, &system.matrix.numbering.free[..]);
        let event = Event { closed, sliding, groups, is_driven, v_n: &state.v, v_1, masses, free };
        let mut law = Law::new(&event, &mut impacts.response)?;
        let mut has_friction = vec![false; closings.len()];
        sliding.iter().for_each(|of| has_friction[closed.slots[of.slot].0] = true);
        // Backward Euler takes the energy of the jump of the velocity itself, more or less of it as the gap closes late or early.
        let energies = if rule.velocity.velocity == -1.0 {
            let by_friction =
                groups.sums(has_friction.iter().zip(&slipped).map(|(has, work)| if *has { *work } else { 0.0 }));
            let works = groups.sums(closings.iter().copied()).into_iter().zip(by_friction);
            law.first().iter().zip(works).map(|(first, (closing, by_friction))| first + closing + by_friction).collect()
        } else {
            law.energies(law.free_end())
        };
        let largest = ledger.balance.largest_energy;
        let round_off = energies.iter().map(|target| ROUND_OFF * largest.max(*target)).collect();
        let targets = Targets { energies, round_off };
        let (last, mut excess) = law.without_friction(&targets)?;
        let last = law.with_friction(last, &targets, &mut excess)?;
        let of_last = law.energies(&last);
        let is_carried = sliding.iter().any(|of| of.carried != [0.0; 2]);
        let moves =
            is_driven.contains(&true) || is_carried || stage.prescribed.iter().any(|&(c, ..)| v_1[c as usize] != 0.0);
        let kinetic = groups.kinetic_energies(masses, &last.v);
        let left = if moves { &of_last } else { &kinetic };
        let mut loss: Vec<f64> = targets.energies.iter().zip(left).map(|(target, left)| target - left).collect();
        let external =
            if moves { kinetic.iter().zip(&of_last).map(|(kinetic, last)| kinetic - last).sum() } else { 0.0 };
        // What friction takes of it.
        let mut friction = vec![0.0; closings.len()];
        for (of, changes) in sliding.iter().zip(last.sliding.chunks_exact(2)) {
            let taken = (0..2).map(|i| {
                let j = changes[i] + of.impulses[i];
                -0.5 * j * (of.rows[i].dot(&law.free_end().v) + of.rows[i].dot(&last.v) - 2.0 * of.carried[i])
            });
            friction[closed.slots[of.slot].0] += taken.sum::<f64>();
        }
        let all_friction = groups.sums(friction.iter().copied());
        let parts = all_friction
            .iter()
            .zip(&loss)
            .map(|(all, loss)| if *all > loss.max(0.0) { loss.max(0.0) / all } else { 1.0 });
        let parts: Vec<f64> = parts.collect();
        for (c, work) in friction.iter_mut().enumerate().filter(|(c, _)| has_friction[*c]) {
            let group = groups.of_pairs[c] as usize;
            *work = parts[group] * work.max(0.0);
            loss[group] -= *work;
            *work -= slipped[c];
        }
        let mut losses = vec![0.0; closings.len()];
        let mut deformable = 0.0;
        for (group, loss) in groups.groups.iter().zip(&loss) {
            // By impulse times rate of approach.
            let share = |&k: &usize| ((last.slots[k] + closed.impulses[k]) * (-law.before()[k]).max(0.0)).max(0.0);
            let all: f64 = group.slots.iter().map(share).sum();
            for k in &group.slots {
                let part = loss * if all > 0.0 { share(k) / all } else { 1.0 / group.slots.len() as f64 };
                losses[closed.slots[*k].0] += part;
                deformable += if closed.is_deformable[*k] { part } else { 0.0 };
            }
        }
        let impact = Impact {
            loss: loss.iter().sum(),
            losses,
            deformable,
            closing: closings.iter().sum(),
            closings,
            external,
            friction,
            closed: closed.is_new.iter().filter(|new| **new).count() as u64,
            excess: excess.iter().sum(),
            ..Impact::default()
        };
        Ok((impact, last))
    }
}
