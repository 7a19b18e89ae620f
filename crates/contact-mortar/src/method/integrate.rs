//! Integrals at the start of a step and at its iterates: which facets may meet, slots at the end and in the middle, gradients at the start.

use super::MortarContact;
use crate::candidates::{Candidates, SearchRange};
use crate::positions::Positions;
use crate::slot::Want;
use crate::state::{Integrated, Need, Surfaces, segmentation_error};
use stoss_contact::{ContactError, SurfaceTree};
use stoss_term::GradientRule;

/// How much farther than the step's reach facets are looked for along the slave's normal, in lengths of facets.
pub(super) const MARGIN: f64 = 3.0;
/// How deep they are looked for where no depth is lost, in the same.
const DEPTH: f64 = 4.0;

impl MortarContact {
    /// Pairs of facets that may meet within `reach` of `q`, and how far they were looked for.
    pub(super) fn search(
        &self,
        tree: &SurfaceTree,
        q: &[f64],
        reach: f64,
    ) -> Result<(Candidates, SearchRange), ContactError> {
        let Surfaces { slave, master, integration, .. } = &self.surfaces;
        let h = slave.length_scale().max(master.length_scale());
        let range = SearchRange { depth: integration.factors.deepest.min(DEPTH * h), far: MARGIN * h, reach };
        let candidates = Candidates::find(slave, master, tree, q, range).map_err(|error| segmentation_error(&error))?;
        Ok((candidates, range))
    }

    /// The rows among these that are of the share.
    pub(super) fn of_share(&self, rows: &[bool]) -> Vec<bool> {
        rows.iter().zip(&self.own).map(|(row, own)| *row && *own).collect()
    }

    /// Renews the slots of the end (and of the middle) at an iterate. Derivatives of `active` rows of the share are there afterwards if forces or a tangent need them.
    pub(super) fn follow(&mut self, q_np1: &[f64], active: &[bool], want_tangent: bool) -> Result<(), ContactError> {
        let own = &self.of_share(active)[..];
        let has = |of: &Integrated, at_all: bool| at_all && own.iter().zip(&of.derivatives).all(|(a, d)| *d || !*a);
        let at_end = self.step.is_at(q_np1, &self.end.at);
        let by_end = matches!(self.rule, GradientRule::EndPoint | GradientRule::EndPointMean);
        let needs_end = want_tangent || by_end && !self.has_fixed_weights();
        let end_done = at_end && (!needs_end || has(&self.end, at_end));
        let middle_done = !self.has_middle() || (at_end && has(&self.middle, !self.middle.derivatives.is_empty()));
        if end_done && middle_done {
            return Ok(());
        }
        let Self { surfaces, step, .. } = &*self;
        let with_facets = self.friction.is_some();
        let candidates = &step.candidates;
        let chosen: &[bool] = if needs_end { own } else { &[] };
        let mut end = if end_done {
            self.end.clone()
        } else {
            let needs = surfaces.needs(Need::Value, chosen);
            surfaces.integrate(
                candidates,
                q_np1.into(),
                &needs,
                &step.without,
                &self.end.slots,
                with_facets && !self.has_middle(),
            )?
        };
        step.note(q_np1, &mut end.at);
        let mut middle = Integrated::default();
        if self.has_middle() {
            let q_m = Positions::Mean(&step.q_n, q_np1);
            let needs = surfaces.needs_among(active, own);
            middle = surfaces.integrate(candidates, q_m, &needs, &step.without, &end.slots, with_facets)?;
            // Nodes of the middle belong to the stencil of the end.
            for (slot, of_middle) in end.slots.iter_mut().zip(&middle.slots) {
                slot.widen(&of_middle.nodes);
            }
        }
        for (slot, of_end) in middle.slots.iter_mut().zip(&end.slots).filter(|(slot, _)| !slot.nodes.is_empty()) {
            slot.widen(&of_end.nodes);
        }
        self.end = end;
        self.middle = middle;
        Ok(())
    }

    /// Adds nodes to the stencil of a row.
    fn widen(&mut self, row: usize, nodes: &[u32]) {
        self.end.slots[row].widen(nodes);
        if let Some(middle) = self.middle.slots.get_mut(row) {
            middle.widen(&self.end.slots[row].nodes);
        }
    }

    /// Gradients at the start of the step, for the rows that need them.
    pub(super) fn follow_start(&mut self, active: &[bool]) -> Result<(), ContactError> {
        // What other ranks need widens the stencils as here.
        let elsewhere = (0..active.len()).filter(|&k| active[k] && !self.own[k] && !self.is_frozen());
        for k in elsewhere.collect::<Vec<_>>() {
            self.widen(k, &self.step.start[k].nodes.clone());
        }
        let own = self.of_share(active);
        let missing: Vec<bool> =
            own.iter().zip(&self.step.gradient).map(|(own, gradient)| *own && gradient.is_empty()).collect();
        if !missing.iter().any(|m| *m) {
            return Ok(());
        }
        let frozen = self.is_frozen();
        let integrated;
        let slots = if frozen {
            &self.end.slots
        } else {
            let needs = self.surfaces.needs(Need::Nothing, &missing);
            integrated = self.surfaces.integrate(
                &self.step.candidates,
                (&self.step.q_n).into(),
                &needs,
                &self.step.without,
                &self.step.start,
                false,
            )?;
            &integrated.slots
        };
        let mut gradients = Vec::new();
        for (k, _) in missing.iter().enumerate().filter(|(_, m)| **m) {
            let slot = &slots[k];
            let evaluation = slot.evaluate(&self.step.q_n, slot.nodes.len(), Want::Gradient);
            let mut evaluation = evaluation.ok_or(ContactError::NoNormal { node: slot.nodes[0] })?;
            evaluation.beyond(self.step.distance[k], 0.0);
            gradients.push((k, slot.nodes.clone(), evaluation.gradient));
        }
        for (k, nodes, gradient) in gradients {
            // In the order of the slot at the end, which nodes are only added to.
            if !frozen {
                self.widen(k, &nodes);
            }
            let order = &self.end.slots[k].nodes;
            let mut sorted = vec![0.0; 3 * order.len()];
            for (n, g) in nodes.iter().zip(gradient.chunks_exact(3)) {
                if let Some(to) = order.iter().position(|m| m == n) {
                    sorted[3 * to..3 * to + 3].copy_from_slice(g);
                }
            }
            self.step.gradient[k] = sorted;
        }
        Ok(())
    }
}
