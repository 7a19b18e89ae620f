//! Normal force and constraint row of a slot.

use super::{CARRIED, MortarContact};
use crate::discrete::RelativeMotion;
use crate::positions::Positions;
use crate::secant::Secant;
use crate::slot::{Evaluation, Slot, Want};
use nalgebra::Vector3;
use stoss_contact::{ContactError, in_order, position};
use stoss_term::{GradientRule, Local, StepConfiguration};

/// Part of [`CARRIED`] below which the row of a multiplier gets a compliance, so that it cannot vanish.
const VANISHING: f64 = 0.1;
/// Compliance of such a row, in lengths of facets over Young's modulus.
const COMPLIANCE: f64 = 1e-6;

impl MortarContact {
    /// Whether the support of a row that carries a multiplier has all but vanished.
    fn is_vanishing(&self, k: usize) -> bool {
        let least = VANISHING * CARRIED * self.surfaces.rows[k].area;
        let present = [&self.end, &self.middle].into_iter().filter_map(|of| of.slots.get(k));
        self.stiffness > 0.0 && present.filter(|slot| !slot.nodes.is_empty()).any(|slot| slot.support < least)
    }

    /// Compliance of a row, a volume per stress: that of the law, and next to nothing for a row that would vanish.
    fn compliance(&self, k: usize) -> f64 {
        let of_law = self.options.overclosure.map_or(0.0, |stiffness| self.end.slots[k].support / stiffness);
        if self.is_vanishing(k) { of_law + COMPLIANCE * self.surfaces.rows[k].area / self.stiffness } else { of_law }
    }

    /// Learns what the second derivatives lack from the gradients at this iterate, of the rows that carry.
    pub(super) fn learn(&mut self, q_np1: &[f64], carrying: &[bool]) -> Result<(), ContactError> {
        let edge = self.length();
        let at = if self.has_middle() { Positions::Mean(&self.step.q_n, q_np1) } else { q_np1.into() };
        let slots = if self.has_middle() { &self.middle.slots } else { &self.end.slots };
        let (ends, distance) = (&self.end.slots, &self.step.distance);
        let carrying: Vec<usize> = (0..slots.len()).filter(|&k| carrying[k]).collect();
        let known: Vec<bool> = self.secants.iter().map(Secant::has_last).collect();
        let compute = |&k: &usize, here: &mut Evaluation| {
            let nodes = &ends[k].nodes;
            let want = if known[k] { Want::Hessian } else { Want::Gradient };
            *here = slots[k].evaluate(at, nodes.len(), want).ok_or(ContactError::NoNormal { node: nodes[0] })?;
            here.beyond(distance[k], 0.0);
            Ok(())
        };
        in_order(&carrying, compute, |&k, here| {
            let nodes = &ends[k].nodes;
            let x = nodes.iter().flat_map(|&node| <[f64; 3]>::from(at.of(node))).collect();
            self.secants[k].learn(nodes, x, std::mem::take(&mut here.gradient), &here.hessian, edge);
        })
    }

    /// Adds force and row of a slot with their derivatives to `out`.
    pub(crate) fn contribute(
        &self,
        k: usize,
        step: StepConfiguration<'_>,
        p: f64,
        want_tangent: bool,
        out: &mut Local,
    ) -> Result<(), ContactError> {
        let slot = &self.end.slots[k];
        let nodes = slot.nodes.len();
        let n = 3 * nodes;
        let no_normal = || ContactError::NoNormal { node: slot.nodes[0] };
        let end_point = self.rule == GradientRule::EndPoint;
        let mean_of_ends = self.rule == GradientRule::EndPointMean;
        let has_fixed_weights = self.has_fixed_weights();
        let want_at_end = match (has_fixed_weights, want_tangent && (end_point || mean_of_ends)) {
            (true, true) => Want::FixedWeights,
            (true, false) => Want::GradientAtFixedWeights,
            (false, true) => Want::Hessian,
            (false, false) => Want::Gradient,
        };
        let mut at_end = slot.evaluate(step.q_np1, nodes, want_at_end).ok_or_else(no_normal)?;
        let (reference, distance) = (self.step.reference[k], self.step.distance[k]);
        at_end.beyond(distance, 0.0);
        let start = &self.step.gradient[k];
        let start_of = |c: usize| start.get(c).copied().unwrap_or(0.0);
        // G and its derivative by q_np1.
        let mut force = vec![0.0; n];
        let mut hessian = Vec::new();
        if end_point {
            force.copy_from_slice(if has_fixed_weights { &at_end.at_fixed_weights } else { &at_end.gradient });
            hessian.clone_from(&at_end.hessian);
            if self.learns() {
                self.secants[k].add_to(&slot.nodes, &mut hessian);
            }
        } else if mean_of_ends {
            (0..n).for_each(|c| force[c] = 0.5 * (at_end.gradient[c] + start_of(c)));
            hessian.extend(at_end.hessian.iter().map(|h| 0.5 * h));
        } else if self.has_middle() {
            let q_m = Positions::Mean(step.q_n, step.q_np1);
            let middle = if self.is_frozen() { slot } else { &self.middle.slots[k] };
            let mut at_middle = middle
                .evaluate(q_m, nodes, if want_tangent { Want::Hessian } else { Want::Gradient })
                .ok_or_else(no_normal)?;
            at_middle.beyond(distance, 0.0);
            if self.learns() {
                self.secants[k].add_to(&slot.nodes, &mut at_middle.hessian);
            }
            self.discrete_gradient(k, middle, step, &at_middle, &at_end, &mut force, &mut hessian);
        } else {
            (0..n).for_each(|c| force[c] = start_of(c));
        }
        let compliance = self.compliance(k);
        at_end.beyond(reference, distance);
        out.residual[n] -= at_end.value + compliance * p;
        out.residual[..n].iter_mut().zip(&force).for_each(|(r, g)| *r -= p * g);
        if !want_tangent {
            return Ok(());
        }
        let dim = out.dim();
        for (i, g) in force.iter().enumerate() {
            out.tangent[i * dim + n] -= g;
        }
        for (t, g) in out.tangent[n * dim..].iter_mut().zip(&at_end.gradient) {
            *t -= g;
        }
        out.tangent[n * dim + n] -= compliance;
        if let Some(stiffness) = self.options.overclosure {
            slot.for_each_support_derivative(|column, d| out.tangent[n * dim + column] -= p / stiffness * d);
        }
        for (row, h) in out.tangent.chunks_exact_mut(dim).zip(hessian.chunks_exact(n)) {
            row.iter_mut().zip(h).for_each(|(t, h)| *t -= p * h);
        }
        Ok(())
    }

    fn discrete_gradient(
        &self,
        k: usize,
        middle: &Slot,
        step: StepConfiguration<'_>,
        at_middle: &Evaluation,
        at_end: &Evaluation,
        force: &mut [f64],
        hessian: &mut Vec<f64>,
    ) {
        let slot = &self.end.slots[k];
        let area = self.surfaces.rows[k].area;
        force.copy_from_slice(&at_middle.gradient);
        let work: f64 = (slot.nodes.iter().zip(at_middle.gradient.chunks_exact(3)))
            .map(|(&node, g)| {
                (position(step.q_np1, node) - position(step.q_n, node)).dot(&Vector3::new(g[0], g[1], g[2]))
            })
            .sum();
        let defect = at_end.value - self.step.start_beyond(k) - work;
        let relative = RelativeMotion::new(&middle.positive, &slot.nodes, step.q_n, step.q_np1);
        let length = at_middle.gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        let (theta, _) = relative.factor(defect, area, self.length(), length);
        let motion = || relative.motion.iter().flat_map(|w| w.iter());
        force.iter_mut().zip(motion()).for_each(|(g, w)| *g += theta * w);
        if at_middle.hessian.is_empty() {
            return;
        }
        hessian.extend(at_middle.hessian.iter().map(|h| 0.5 * h));
        if theta == 0.0 {
            return;
        }
        // Hess Phi(q_m) dq by the difference of the gradients at both ends.
        let n = force.len();
        let start = &self.step.gradient[k];
        let slope: Vec<f64> = motion()
            .enumerate()
            .map(|(c, w)| {
                let ends = 0.5 * (at_end.gradient[c] + start.get(c).copied().unwrap_or(0.0));
                (ends - at_middle.gradient[c] - 2.0 * theta * w) / relative.work
            })
            .collect();
        for (row, w) in hessian.chunks_exact_mut(n).zip(motion()) {
            row.iter_mut().zip(&slope).for_each(|(h, s)| *h += w * s);
        }
        relative.add_projection(theta, n, hessian);
    }
}
