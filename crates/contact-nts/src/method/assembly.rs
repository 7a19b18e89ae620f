//! The equations of the slots: gaps at the start of a step, residual, tangent.

use crate::crossing::{component, spread};
use crate::gap_gradient::GapGradient;
use crate::method::NodeToSurface;
use crate::options::ConstraintForm;
use crate::slot::{ElementNodes, PairedSlot, Pairing, Slot};
use stoss_contact::{Enforcement, in_order, position};
use stoss_term::{
    At, Auxiliary, Fault, GradientRule, Hold, Local, Rule, Share, SlotReport, StepConfiguration, StepContext, Term,
    Unilateral, Work, multipliers_of,
};

/// Room for the contribution of a slot.
#[derive(Default)]
struct Room {
    contribution: Local,
    gradient: GapGradient,
}

impl NodeToSurface {
    /// An active slot that found no facet (the union of sets of the active-set control can ask for one): the row `-A p = 0`, which keeps
    /// the system regular until the slot opens, its gap being infinite. Auxiliaries of the contribution are zero likewise.
    pub(crate) fn without_partner(
        &self,
        slot: usize,
        pressure: f64,
        auxiliaries: &[f64],
        want_tangent: bool,
        contribution: &mut Local,
    ) {
        contribution.nodes.push(self.node(slot));
        if !self.share.has(&contribution.nodes) {
            contribution.set_elsewhere();
            return;
        }
        contribution.reset(want_tangent);
        let (weight, dim) = (self.slot_weight(slot), contribution.dim());
        contribution.residual[3] = -weight * pressure;
        for (row, value) in contribution.residual[4..].iter_mut().zip(auxiliaries) {
            *row = weight * value;
        }
        for k in (3..dim).filter(|_| want_tangent) {
            contribution.tangent[k * dim + k] = if k == 3 { -weight } else { weight };
        }
    }
}

impl Term for NodeToSurface {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.slave.length_scale()
    }

    fn has_friction(&self) -> bool {
        self.friction.is_some()
    }

    fn slot_count(&self) -> usize {
        self.slots.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.slave.weights()[slot]
    }

    /// At the end point, without friction: the Hessian of the gap, and one gradient for force and constraint. The row of a spring has the other sign.
    fn is_symmetric(&self, rule: Rule) -> bool {
        let is_spring = matches!(self.normal.enforcement, Enforcement::Penalty(_));
        rule == Rule::Constraint(GradientRule::EndPoint) && self.friction.is_none() && !is_spring
    }

    fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.search.set_carriers(of);
    }

    fn set_share(&mut self, share: Share) -> Option<Share> {
        self.share = share;
        Some(self.share.clone())
    }

    fn holds(&self, visit: &mut dyn FnMut(u32, Hold)) {
        let nodes = self.slave.nodes().iter().chain(self.search.surface().nodes());
        nodes.for_each(|&node| visit(node, Hold::Surface));
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        let StepContext { q_n, reach, rule, .. } = *step;
        self.holds = self.hold.is_some() && step.impacts;
        self.leaves = step.rates;
        self.search.take_sides(!step.rates);
        if let Some(friction) = &mut self.friction {
            friction.begin(self.slave.nodes(), step);
        }
        self.q_n.clear();
        self.q_n.extend_from_slice(q_n);
        self.normal.rule = rule;
        self.search.update(q_n, reach);
        let view = self.search.at(q_n);
        // Not `self.closest`, which counts from the gaps that are asked for here.
        let mut reference_gap = std::mem::take(&mut self.reference_gap);
        reference_gap.begin(step, self.slots.len(), |slot| {
            let point = view.closest(&position(q_n, self.node(slot)), self.slave.normal(slot, q_n).as_ref());
            point.pairing.map(|_| point.gap)
        });
        if let Some(surface) = &mut self.friction {
            surface.friction.weaken(reference_gap.friction_factor(step));
        }
        self.reference_gap = reference_gap;
        // Facets that the last step ended on, for friction only.
        let mut last = Vec::new();
        if self.friction.is_some() {
            last.extend(self.slots.iter().map(|slot| slot.committed));
        }
        for slot in 0..self.slots.len() {
            let state = self.slots[slot];
            let closest = || self.closest(&view, slot, q_n);
            self.slots[slot] = match state.committed {
                // A node in contact keeps the gap that its last step ended with. It keeps its facet too, unless it stands on the extension
                // of that: then it starts from the facet below it, with the gap that it has there. (Crossing the edge with
                // the gap of the old facet would need a force tilted by the difference of both gaps over the motion.)
                Some(facet) => {
                    let on_facet = self.gap(slot, facet, q_n)?;
                    let gap = on_facet.gap - self.reference_gap.of(slot);
                    let mut at_n = (facet, gap);
                    if on_facet.outside() > 0.0
                        && let Some(pairing) = closest().pairing
                        && pairing.facet != facet
                    {
                        at_n = (pairing.facet, self.gap_beyond(slot, pairing.facet, q_n)?);
                    }
                    let kept = state.kept + (at_n.1 - gap);
                    match (self.constraint, self.hold) {
                        (ConstraintForm::Modified, _) => Slot::closed(at_n.0, at_n.1, at_n.1, at_n.1),
                        (ConstraintForm::Standard, Some(settle)) if self.holds => {
                            let settling = if state.steps >= settle { state.held / f64::from(settle) } else { 0.0 };
                            let slot = Slot::closed(at_n.0, at_n.1, kept, 0.0);
                            slot.holding(state.held - settling, settling, state.steps)
                        }
                        // Where nothing is held, in statics for instance, what was held comes down at once.
                        (ConstraintForm::Standard, _) => Slot::closed(at_n.0, at_n.1, kept - state.held, 0.0),
                    }
                }
                None => {
                    let point = closest();
                    let kept = if self.leaves && state.kept < 0.0 {
                        self.gap_to_keep(slot, &point, q_n).min(0.0)
                    } else {
                        0.0
                    };
                    Slot::open(point.pairing.map(|p| p.facet), point.gap, kept, state.strayed)
                }
            };
        }
        for (slot, facet) in last.into_iter().enumerate() {
            self.begin_friction(slot, facet);
        }
        Ok(())
    }

    fn renew(&mut self, at: &At<'_>, want_tangent: bool) -> Result<bool, Fault> {
        self.keep_multipliers(at.auxiliaries, 2);
        if want_tangent {
            self.follow_friction(at.q_np1, at.multipliers, at.active)?;
        }
        Ok(false)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            match self.slots[slot].pairing {
                Some(pairing) => {
                    let element = ElementNodes::new(self.node(slot), self.search.surface(), pairing);
                    visit(element.list(), &[slot as u32]);
                }
                None => visit(&[self.node(slot)], &[slot as u32]),
            }
        }
    }

    fn candidates(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for slot in (0..self.slots.len()).filter(|&s| !active[s]) {
            if let Some(facet) = self.slots[slot].origin {
                let element = ElementNodes::new(self.node(slot), self.search.surface(), Pairing::single(facet));
                visit(element.list(), &[slot as u32]);
            }
        }
    }

    /// Two multipliers of the friction, if stick is enforced by them: components in the frame of the old foot of what they add to the
    /// traction at the start.
    fn auxiliaries(&self) -> &[Auxiliary] {
        if self.has_stick_multipliers() { &[Auxiliary::Constraint; 2] } else { &[] }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers: pressures, auxiliaries, active, .. } = *at;
        let further = self.auxiliaries().len();
        let slots: Vec<usize> = (0..self.slots.len()).filter(|&s| active[s]).collect();
        let compute = |&slot: &usize, Room { contribution, gradient }: &mut Room| -> Result<(), Fault> {
            contribution.auxiliaries = further;
            contribution.slots.clear();
            contribution.slots.push(slot as u32);
            contribution.nodes.clear();
            let multiplier = multipliers_of(slot, further, auxiliaries);
            let Some(pairing) = self.slots[slot].pairing else {
                self.without_partner(slot, pressures[slot], &multiplier, want_tangent, contribution);
                return Ok(());
            };
            let element = ElementNodes::new(self.node(slot), self.search.surface(), pairing);
            contribution.nodes.extend_from_slice(element.list());
            if !self.share.has(element.list()) {
                contribution.set_elsewhere();
                return Ok(());
            }
            let end = self.gap(slot, pairing.end, step.q_np1)?;
            let of = PairedSlot { slot, element: &element, pairing, end: &end, step };
            self.gradient(of, want_tangent, gradient)?;
            let (n, weight) = (3 * element.count, self.slot_weight(slot));
            let pressure = pressures[slot];
            contribution.reset(want_tangent);
            for (r, g) in contribution.residual.iter_mut().zip(&gradient.values[..n]) {
                *r = -weight * pressure * g;
            }
            let row = self.normal_row(slot, step.rule, end.gap, pressure);
            contribution.residual[n] = -weight * row.value;
            if want_tangent {
                let dim = contribution.dim();
                for i in 0..n {
                    for j in 0..n {
                        contribution.tangent[i * dim + j] = -weight * pressure * gradient.tangent[i * n + j];
                    }
                    contribution.tangent[i * dim + n] = -weight * gradient.values[i];
                }
                let nodes = spread(&element.end);
                for (j, g) in end.gradient.iter().enumerate() {
                    contribution.tangent[n * dim + component(&nodes, j)] -= weight * row.d_gap * g;
                }
                contribution.tangent[n * dim + n] = -weight * row.d_pressure;
            }
            if self.friction.is_some() {
                self.add_friction(of, pressure, multiplier, want_tangent, contribution)?;
            }
            Ok(())
        };
        in_order(&slots, compute, |_, room| visit(&room.contribution))
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        Ok(self.step_work(at.q_np1, at.multipliers, at.active)?)
    }

    fn commit(&mut self, at: &At<'_>) {
        self.end_step(at.q_np1, at.multipliers, at.active);
    }

    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, Fault> {
        Ok(self.slot_reports(q))
    }

    fn save_history(&self) -> Vec<u8> {
        self.history()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        Ok(self.set_history(bytes)?)
    }

    fn unilateral(&self) -> Option<&dyn Unilateral> {
        Some(self)
    }

    fn unilateral_mut(&mut self) -> Option<&mut dyn Unilateral> {
        Some(self)
    }
}
