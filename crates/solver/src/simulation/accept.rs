//! Acceptance of a step that succeeded. Nothing of it can fail.

use super::Simulation;
use super::advance::Completed;
use super::impact::Impact;
use crate::assembly::{System, Tally};
use crate::step::{Attempt, decision};
use crate::{Automatic, Balance, CouplingTerm, DecisionKind, StepChange, StepRecord};
use std::ops::Range;
use stoss_integrators::{ForceRule, State, Step, StepConfiguration, StepRule};
use stoss_linalg::vector;
use stoss_term::{At, MaterialWork, Work};

/// What was taken from motion and strain in a step, but for contact.
struct Damped {
    /// Energy taken by dampers of parts.
    by_parts: f64,
    /// Energy taken in bodies, all of it.
    in_bodies: f64,
    /// The part of it by the damping of bodies.
    by_damping: f64,
    /// What materials with history took and store.
    material: MaterialWork,
}

impl Simulation {
    /// Takes the end of the step as the state, and tells what was done.
    pub(super) fn accept(&mut self, completed: Completed, first_decision: usize) -> StepRecord {
        self.warn_inside_out(&completed.inside_out);
        self.warn_dependent();
        let Completed { attempt, next, rule, draft, mut contact, stored, closing, impact, inside_out, solves, .. } =
            completed;
        self.forces.moved = contact.as_mut().map(|contact| std::mem::take(&mut contact.moved)).unwrap_or_default();
        let contact_work = completed.work;
        let Attempt { iterate, newton, unstable, .. } = attempt;
        let dt = self.clock.dt();
        let (time_n, quasi_static) = (self.state.time, self.how.scheme.is_none());
        let [mut work, of_supports] = self.external_work(&next, &rule, &iterate.auxiliaries);
        // Nothing is judged by it in statics.
        let closes = |pair: &CouplingTerm| pair.acts && !pair.always_holds();
        let has_contact = contact.is_some() && self.model.contacts.iter().any(closes);
        let work_of_contact = (!quasi_static && has_contact).then(|| -> f64 {
            let System { tally, buffers, .. } = &self.system;
            let components = tally.support.iter().flat_map(Range::clone);
            components.map(|c| buffers.constraint[c] * (next.q[c] - self.state.q[c])).sum()
        });
        let (stabilised, stabilising) = if self.system.present.stabilisation.is_some() {
            let increment: Vec<f64> = next.q.iter().zip(&self.state.q).map(|(next, q)| next - q).collect();
            let force = self.system.stabilising(&increment, dt);
            let work = self.system.stabilised(self.ramp(time_n), &self.state.v, &increment, dt);
            (work, force.map(|force| [force, self.external_forces()]))
        } else {
            (0.0, None)
        };
        let damped_bodies = self.system.damped(dt);
        let in_bodies = damped_bodies + draft.dissipated_in_bodies();
        let step = Step { state_n: &self.state, dt, rule };
        for (line, _, term) in self.model.terms_mut(&self.system.present.acting).filter(|(_, acts, _)| *acts) {
            term.commit(&At { q_np1: &next.q, ..iterate.at_line(line, &step) });
        }
        self.state = next;
        let jump = self.meet_supports(&rule);
        work += jump;
        self.take_contact_force(impact.as_ref());
        let mut impact = impact.unwrap_or_default();
        for &(c, force) in &impact.mean.reactions {
            self.forces.reactions[c as usize] += force;
        }
        self.impacts.largest_rate = self.impacts.largest_rate.max(impact.largest_rate);
        work += impact.external;
        self.ledger.stored = stored;
        self.slots.pressures = iterate.pressures;
        self.slots.mean_pressures = std::mem::take(&mut impact.mean.pressures);
        self.slots.active = iterate.active;
        self.take_sliding_supports_from_contact_force();
        let driven = contact_work.driven + draft.driven();
        let balance = self.measure_balance(draft.strain(), self.ledger.balance.external_work + work + driven);
        let before = self.ledger.balance;
        let damped = Damped {
            by_parts: draft.dissipated_by_parts(),
            in_bodies,
            by_damping: damped_bodies,
            material: draft.material(),
        };
        self.enter(balance, &contact_work, work_of_contact, &impact, damped, stabilised);
        if std::mem::take(&mut self.stage.from_motion) {
            // What the forces of inertia held goes the way of the kinetic energy.
            let dropped = before.total() - self.ledger.balance.total();
            self.ledger.balance.dissipation += dropped.max(0.0);
        }
        let near_limit = self.how.max_plastic_increment.is_some_and(|limit| draft.flows_beyond(0.5 * limit).is_some());
        let books = self.close_books(draft, &impact, [of_supports, jump], stabilised, &before);
        self.step += 1;
        self.compare_ranks();
        self.stage.sudden.clear();
        if let Some(work) = work_of_contact {
            self.warn_contact_gain(work - contact_work.driven, &before);
        }
        self.choose_next_size(solves, near_limit);
        self.warn_stabilisation();
        self.warn_fallbacks();
        self.warn_handed_over();
        StepRecord {
            step: self.step,
            stage: self.stage.number,
            time: self.state.time,
            dt,
            nominal: self.clock.on_nominal_grid(),
            balance: self.ledger.balance,
            newton,
            iterations: solves,
            decisions: self.log.decisions[first_decision..].to_vec(),
            unstable,
            closing,
            books,
            impact_losses: impact.losses,
            stabilising,
            inside_out: inside_out.iter().flatten().map(|found| found.count).sum(),
            contact,
        }
    }

    /// Ends a run whose ranks differ.
    fn compare_ranks(&self) {
        let signs = |on: &bool| if *on { &1.0 } else { &0.0 };
        let active = self.slots.active.iter().flatten().map(signs);
        let numbers = self.state.q.iter().chain(&self.state.v).chain(self.slots.pressures.iter().flatten());
        self.system.shares.compare(self.step, numbers.chain(active));
    }

    /// Work of the step from outside, and the part of supports that move: of the forces of the rule, or in statics, where all forces are those of the end, by the trapezium rule. Takes the reactions.
    fn external_work(&mut self, next: &State, rule: &StepRule, auxiliaries: &[Vec<f64>]) -> [f64; 2] {
        let (dt, time_n) = (self.clock.dt(), self.state.time);
        let mut varying = vec![0.0; self.state.q.len()];
        let quasi_static = self.how.scheme.is_none();
        if quasi_static {
            self.add_varying_loads(time_n, 0.5, &mut varying);
            self.add_reactions(0.5, &mut varying);
        }
        let mut of_supports = if quasi_static { 0.5 * self.reaction_work(&next.q) } else { 0.0 };
        let end_weight = if quasi_static { 0.5 } else { 1.0 };
        self.add_varying_loads(time_n + rule.force.rule.load_fraction() * dt, end_weight, &mut varying);
        if self.system.loads.has_followers {
            vector::axpy(end_weight, &self.system.loads.follower, &mut varying);
            if quasi_static {
                let (mut fe, state) = self.equations_of(auxiliaries);
                let at_n = StepConfiguration { time: time_n, dt: 0.0, q_n: &state.q, q_np1: &state.q };
                // cannot fail: directors are orthogonal at the end of a step.
                fe.evaluate_follower(at_n, ForceRule::END_POINT, None).unwrap_or(());
                vector::axpy(0.5, &self.system.loads.follower, &mut varying);
            }
        }
        for &(component, ..) in &self.stage.prescribed {
            // The residual at a prescribed component is what the support has to exert.
            let c = component as usize;
            self.forces.reactions[c] = self.system.buffers.residual[c];
        }
        self.add_reactions(end_weight, &mut varying);
        of_supports += end_weight * self.reaction_work(&next.q);
        let mut work = 0.0;
        for c in self.system.loads.support.iter().flat_map(Range::clone) {
            work += varying[c] * (next.q[c] - self.state.q[c]);
        }
        [work, of_supports]
    }

    /// Supports get the velocities of their tables; returns what that adds to the kinetic energy.
    fn meet_supports(&mut self, rule: &StepRule) -> f64 {
        // Velocities from momenta lack the next impulse of the constraints, and get it in the next step.
        let has_supports = rule.impulse.is_none() && self.has_sliding_supports();
        if self.how.scheme.is_none() || self.stage.prescribed.is_empty() && !has_supports {
            return 0.0;
        }
        let time = self.state.time;
        // Supports move with the slope of their tables; the jump of kinetic energy at a kink is work of the support.
        let before = self.kinetic(&self.state.v);
        let mut v = std::mem::take(&mut self.state.v);
        let mut followed = self.model.embedding.followed(&v);
        self.set_prescribed_velocities(time, &mut v);
        if has_supports {
            self.meet_held_directions(time, |held| held.rate, &mut v);
        }
        self.model.embedding.follow_changes(&mut v, &mut followed);
        self.state.v = v;
        self.kinetic(&self.state.v) - before
    }

    /// Forces of contact on nodes, with those of an impact.
    fn take_contact_force(&mut self, impact: Option<&Impact>) {
        if self.model.contacts.is_empty() {
            return;
        }
        let System { tally: Tally { support, touched, .. }, buffers, .. } = &self.system;
        for node in self.forces.pushed.drain(..) {
            self.forces.contact[3 * node as usize..3 * node as usize + 3].fill(0.0);
        }
        for range in support {
            self.forces.contact[range.clone()].copy_from_slice(&buffers.constraint[range.clone()]);
        }
        self.forces.pushed.extend_from_slice(touched);
        if let Some(impact) = &impact {
            let forces = impact.mean.forces.iter().flatten();
            forces.for_each(|&(c, force)| self.forces.contact[c as usize] += force);
        }
        // Vertices of traces belong to no body: its nodes have the forces on its faces.
        if !self.model.traces.is_empty() {
            let traces = &self.model.traces;
            let vertices: Vec<u32> = touched.iter().copied().filter(|node| traces.contains_key(node)).collect();
            self.model.embedding.pull_back_of(&vertices, &mut self.forces.contact);
        }
    }

    /// Enters the step into the balance, of which the present energies and momenta are given.
    fn enter(
        &mut self,
        balance: Balance,
        contact_work: &Work,
        work_of_contact: Option<f64>,
        impact: &Impact,
        Damped { by_parts, in_bodies, by_damping, material }: Damped,
        stabilised: f64,
    ) {
        let (before, quasi_static) = (self.ledger.balance, self.how.scheme.is_none());
        let stored_by_normal = |stored: f64, by_friction: f64| stored - by_friction;
        // Without contact the constraints are those of joints, and what they lose is what their limits report.
        let limits = if quasi_static { 0.0 } else { contact_work.closing.unwrap_or(0.0) };
        let normal_work = work_of_contact.map_or(-limits, |work| {
            let stored = stored_by_normal(contact_work.stored, contact_work.friction_stored)
                - stored_by_normal(before.contact, before.friction_stored);
            work + contact_work.friction_work + contact_work.damped + stored - contact_work.driven
        });
        // Friction of the law of impact in the place of that of the step.
        let of_impact: f64 = impact.friction.iter().sum();
        self.ledger.balance = Balance {
            contact: contact_work.stored,
            dissipation: before.dissipation + contact_work.dissipated + of_impact + by_parts + in_bodies,
            damping: before.damping + by_damping,
            plastic_loss: before.plastic_loss + material.plastic,
            viscous_loss: before.viscous_loss + material.viscous,
            softening_loss: before.softening_loss + material.softening,
            hardening: material.hardening,
            stabilisation: before.stabilisation + stabilised,
            friction_work: before.friction_work + contact_work.friction_work + of_impact + by_parts,
            friction_stored: contact_work.friction_stored,
            closing_loss: before.closing_loss - normal_work - impact.closing,
            contact_remainder: before.contact_remainder
                + if quasi_static { 0.0 } else { contact_work.closing.map_or(0.0, |closing| -normal_work - closing) },
            impact_loss: before.impact_loss + impact.loss,
            impact_deformable: before.impact_deformable + impact.deformable,
            impacts: before.impacts + impact.closed,
            impact_capped: before.impact_capped + impact.excess,
            ..balance
        };
    }

    /// Tells the clock how many iterations the step took, and notes what it makes of that. `near_limit`: points flow by so much that the next step must not be larger.
    fn choose_next_size(&mut self, solves: u32, near_limit: bool) {
        let (time, dt) = (self.state.time, self.clock.dt());
        if near_limit {
            self.clock.stay();
            return;
        }
        let change = match (self.clock.accept(solves), self.how.control.automatic) {
            (StepChange::None, _) => None,
            (StepChange::Doubled, None) => {
                Some((DecisionKind::Grow, format!("{} steps succeeded in a row", self.how.control.grow_after)))
            }
            (StepChange::Doubled, Some(Automatic { easy, after, .. })) => {
                Some((DecisionKind::Grow, format!("{after} steps in a row took at most {easy} iterations each")))
            }
            (StepChange::Halved, automatic) => {
                let hard = automatic.map_or(0, |automatic| automatic.hard);
                Some((DecisionKind::Shrink, format!("the step took {solves} iterations, more than {hard}")))
            }
        };
        if let Some((kind, reason)) = change {
            self.log.decisions.push(decision(self.step, time, dt, kind, reason));
        }
    }

    /// Adds `factor` times the dead loads that vary in time.
    fn add_varying_loads(&self, time: f64, factor: f64, force: &mut [f64]) {
        let at = At { time, ..At::force([&self.state.q; 2], ForceRule::END_POINT, 0.0) };
        let loads = self.model.acting_loads(&self.system.present.acting);
        for load in loads.filter(|load| !load.follows() && !load.is_conservative()) {
            // cannot fail: the forces are constant.
            load.add_force(&at, factor, force).unwrap_or(());
        }
    }

    /// Sum of the magnitudes of the components of the forces of supports and loads at the end of a step.
    fn external_forces(&self) -> f64 {
        let reactions =
            self.stage.prescribed.iter().map(|&(component, ..)| self.forces.reactions[component as usize].abs());
        let loads = self.system.loads.support.iter().flat_map(Range::clone).map(|c| {
            let follower = if self.system.loads.has_followers { self.system.loads.follower[c] } else { 0.0 };
            let dead = if self.system.loads.has_dead { self.system.loads.dead[c] } else { 0.0 };
            (dead + follower).abs()
        });
        reactions.sum::<f64>() + loads.sum::<f64>()
    }

    /// Work of the present reactions on the way to `q`.
    fn reaction_work(&self, q: &[f64]) -> f64 {
        let components = self.stage.prescribed.iter().map(|&(component, ..)| component as usize);
        components.map(|c| self.forces.reactions[c] * (q[c] - self.state.q[c])).sum()
    }

    fn add_reactions(&self, factor: f64, force: &mut [f64]) {
        for &(component, ..) in &self.stage.prescribed {
            force[component as usize] += factor * self.forces.reactions[component as usize];
        }
    }
}
