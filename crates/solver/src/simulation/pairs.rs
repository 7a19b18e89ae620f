//! What the contact pairs did in a step: work, and the rows of the tables.

use super::Simulation;
use super::impact::Mean;
use crate::iterate::Iterate;
use crate::rotation::cross;
use crate::step::Attempt;
use crate::{ContactSummary, Model, PairSummary, Phase, StepError};
use std::collections::BTreeMap;
use stoss_integrators::{Step, StepRule};
use stoss_term::{SlotReport, SurfaceForce, Work};

/// What the slots of each contact report.
type Slaves = Vec<Vec<SlotReport>>;

fn add_force(sums: &mut BTreeMap<u32, SurfaceForce>, of: SurfaceForce) {
    let none = SurfaceForce { node: of.node, force: [0.0; 3], moment: [0.0; 3] };
    let sum = sums.entry(of.node).or_insert(none);
    sum.force.iter_mut().zip(of.force).for_each(|(sum, f)| *sum += f);
    sum.moment.iter_mut().zip(of.moment).for_each(|(sum, m)| *sum += m);
}

/// Calls `add` with each node of a body that has the forces at `node`, and with its part of them: of a vertex of the trace of a quadratic face the nodes of the face, else the node itself.
fn share(model: &Model, node: u32, mut add: impl FnMut(u32, f64)) {
    match model.embedding.carriers(node).filter(|_| model.traces.contains_key(&node)) {
        Some(carriers) => carriers.iter().for_each(|&(carrier, weight)| add(carrier, weight)),
        None => add(node, 1.0),
    }
}

impl Simulation {
    /// What the contacts store and dissipate in the step, all and each.
    pub(super) fn contact_work(
        &mut self,
        iterate: &Iterate,
        rule: StepRule,
        dt: f64,
    ) -> Result<(Work, Vec<Work>), StepError> {
        let step = Step { state_n: &self.state, dt, rule };
        let mut total = Work::default();
        let mut of_pairs = Vec::with_capacity(self.model.contacts.len());
        for (c, pair) in self.model.contacts.iter().enumerate() {
            let at = iterate.at(c, &step);
            let work = match pair.acts {
                true => self.log.timings.measure(Phase::Contact, || pair.term.work(&at))?,
                false => Work::default(),
            };
            total += work;
            of_pairs.push(work);
        }
        Ok((total, of_pairs))
    }

    /// What the contact pairs do at the end of the step, with the work of each, without the impulses of the law of impact.
    pub(super) fn contact_summary(
        &mut self,
        attempt: &Attempt,
        rule: StepRule,
        dt: f64,
        of_pairs: &[Work],
    ) -> Result<Option<(ContactSummary, Slaves)>, StepError> {
        if !self.model.has_contact_pairs() {
            return Ok(None);
        }
        let Attempt { iterate, repaired, .. } = attempt;
        let Iterate { q, pressures, active, .. } = iterate;
        let step = Step { state_n: &self.state, dt, rule };
        let mut summary = ContactSummary { repaired: *repaired, min_gap: f64::INFINITY, ..ContactSummary::default() };
        let mut is_slave = vec![false; self.model.node_count()];
        let mut slaves: Slaves = vec![Vec::new(); self.model.contacts.len()];
        for (c, pair) in self.model.contacts.iter().enumerate() {
            let mut of_pair = PairSummary { friction_work: of_pairs[c].friction_work, ..PairSummary::default() };
            if pair.always_holds() || !pair.acts {
                summary.pairs.push(of_pair);
                continue;
            }
            let of = pair.potential();
            let bodies = self.log.timings.measure(Phase::Contact, || of.map(|of| of.body_pairs()).unwrap_or_default());
            for body in &bodies {
                of_pair.active += body.active;
                of_pair.min_gap = of_pair.min_gap.min(body.distance);
                of_pair.max_pressure = of_pair.max_pressure.max(body.pressure);
                of_pair.area += body.area;
            }
            summary.bodies.extend(bodies);
            let on_surface = self.log.timings.measure(Phase::Contact, || {
                summary.surface.extend(of.map(|of| of.surface_nodes(q)).unwrap_or_default());
                of.map(|of| of.surface_forces()).unwrap_or_default()
            });
            for of in &on_surface {
                share(&self.model, of.node, |node, weight| {
                    let [force, moment] = [of.force, of.moment].map(|v| v.map(|x| weight * x));
                    add_force(&mut summary.moved, SurfaceForce { node, force, moment });
                });
            }
            let reports = self.log.timings.measure(Phase::Search, || pair.term.report(q))?;
            for (slot, report) in reports.iter().enumerate() {
                is_slave[report.node as usize] = true;
                let (now, then) = (active[c][slot], self.slots.active[c][slot]);
                summary.closed += usize::from(now && !then);
                summary.released += usize::from(then && !now);
                of_pair.min_gap = of_pair.min_gap.min(report.gap.unwrap_or(f64::INFINITY));
                if now {
                    of_pair.active += 1;
                    of_pair.area += report.area;
                }
                of_pair.max_pressure = of_pair.max_pressure.max(report.shown(slot, |slot| pressures[c][slot]));
            }
            let at = iterate.at(c, &step);
            self.log.timings.measure(Phase::Contact, || {
                self.system.shares.visit_all(c, &*pair.term, &at, &mut |local| {
                    for (&node, residual) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                        if !on_surface.is_empty() {
                            // Minus the force of the nodes that carry it.
                            share(&self.model, node, |node, weight| {
                                let force = [residual[0], residual[1], residual[2]].map(|f| weight * f);
                                let moment = cross([0, 1, 2].map(|i| q[3 * node as usize + i]), force);
                                add_force(&mut summary.moved, SurfaceForce { node, force, moment });
                            });
                        }
                        if is_slave[node as usize] {
                            let force = [-residual[0], -residual[1], -residual[2]];
                            let moment = cross([0, 1, 2].map(|i| q[3 * node as usize + i]), force);
                            for i in 0..3 {
                                of_pair.force[i] += force[i];
                                of_pair.moment[i] += moment[i];
                            }
                        }
                    }
                })
            })?;
            for report in &reports {
                is_slave[report.node as usize] = false;
            }
            slaves[c] = reports;
            summary.active += of_pair.active;
            summary.min_gap = summary.min_gap.min(of_pair.min_gap);
            summary.max_pressure = summary.max_pressure.max(of_pair.max_pressure);
            for i in 0..3 {
                summary.force_on_slave[i] += of_pair.force[i];
            }
            summary.pairs.push(of_pair);
        }
        Ok(Some((summary, slaves)))
    }

    /// Adds the impulses of the law of impact, over the step size, to what the contact pairs do.
    pub(super) fn add_impulses(
        &self,
        mean: &Mean,
        slaves: &Slaves,
        active: &[Vec<bool>],
        q: &[f64],
        summary: &mut ContactSummary,
    ) {
        let is_contact = |c: usize| self.model.contacts[c].unilateral().is_some();
        for c in (0..slaves.len()).filter(|&c| is_contact(c) && !mean.forces[c].is_empty()) {
            let of_pair = &mut summary.pairs[c];
            let mut nodes: Vec<u32> = slaves[c].iter().map(|slave| slave.node).collect();
            nodes.sort_unstable();
            for &(component, force) in &mean.forces[c] {
                let (node, i) = (component / 3, component as usize % 3);
                if nodes.binary_search(&node).is_ok() {
                    let vector: [f64; 3] = std::array::from_fn(|d| if d == i { force } else { 0.0 });
                    let moment = cross([0, 1, 2].map(|d| q[3 * node as usize + d]), vector);
                    of_pair.force[i] += force;
                    of_pair.moment.iter_mut().zip(moment).for_each(|(sum, m)| *sum += m);
                    summary.force_on_slave[i] += force;
                }
            }
            let of = |slot: usize| if active[c][slot] { mean.pressures[c][slot] } else { 0.0 };
            let pressures = slaves[c].iter().enumerate().map(|(slot, slave)| slave.shown(slot, of));
            of_pair.max_pressure = pressures.fold(0.0, f64::max);
        }
        summary.max_pressure = summary.pairs.iter().map(|pair| pair.max_pressure).fold(0.0, f64::max);
    }
}
