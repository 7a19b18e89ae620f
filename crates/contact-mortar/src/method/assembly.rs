//! The equations of the slots: what is constant in a step, residual, tangent.

use super::integrate::MARGIN;
use super::{CARRIED, COVERED, LARGEST_HELD, MortarContact, NO_PENETRATION};
use crate::friction::Scratch;
use crate::positions::Positions;
use crate::secant::Secant;
use crate::state::{Integrated, Need, StepState};
use stoss_contact::{ContactError, in_order};
use stoss_segmentation::GapRange;
use stoss_term::{
    At, Auxiliary, Coverage, Fault, GradientRule, Hold, Local, Share, SlotReport, StepConfiguration, StepContext, Term,
    Unilateral, Work, multipliers_of,
};

impl Term for MortarContact {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length()
    }

    fn has_friction(&self) -> bool {
        self.friction.is_some()
    }

    fn slot_count(&self) -> usize {
        self.surfaces.rows.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.surfaces.rows[slot].area
    }

    /// The nodes of a stencil are those of all facets around it, ascending.
    fn slot_node(&self, slot: usize) -> Option<u32> {
        Some(self.surfaces.slave.nodes()[self.surfaces.rows[slot].local])
    }

    fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.surfaces.master.set_carriers(of);
        if self.surfaces.master.carriers().is_some() {
            self.tree.forget();
        }
    }

    fn set_share(&mut self, share: Share) -> Option<Share> {
        Some(self.take_share(share))
    }

    fn holds(&self, visit: &mut dyn FnMut(u32, Hold)) {
        let nodes = self.surfaces.slave.nodes().iter().chain(self.surfaces.master.nodes());
        nodes.for_each(|&node| visit(node, Hold::Surface));
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        self.take(step);
        self.secants.iter_mut().for_each(Secant::begin);
        let StepContext { q_n, v_n: velocity, reach, .. } = *step;
        self.tree.update(&self.surfaces.master, q_n);
        let surfaces = &self.surfaces;
        let factors = self.factors();
        let (candidates, range) = self.search(&self.tree, q_n, reach)?;
        let values = surfaces.needs(Need::Value, &[]);
        let with_facets = self.friction.is_some();
        let crosspoints = surfaces.handing_over(None);
        let predicted = |part: f64| {
            let ahead = Positions::Ahead(q_n, part * self.step_size, velocity);
            let q = if velocity.is_empty() { q_n.into() } else { ahead };
            surfaces.integrate(&candidates, q, &values, &crosspoints, &[], with_facets && self.is_frozen())
        };
        let mut start = surfaces.integrate(&candidates, q_n.into(), &values, &crosspoints, &[], with_facets)?;
        let still = velocity.is_empty() || self.step_size == 0.0;
        let middle = if (self.has_middle() && !still) || self.is_frozen() { Some(predicted(0.5)?) } else { None };
        let end = if still || self.is_frozen() { None } else { Some(predicted(1.0)?) };
        let seen: Vec<&Integrated> = match (&middle, &end) {
            (None, None) => vec![&start],
            _ => middle.iter().chain(&end).collect(),
        };
        let rows = surfaces.rows.iter().enumerate();
        let carried: Vec<bool> =
            rows.map(|(k, row)| seen.iter().all(|of| of.slots[k].opposite > CARRIED * row.area)).collect();
        // In statics no energy is at stake, and constant pressures stay exact.
        let without =
            if self.has_fixed_weights() { surfaces.handing_over(Some(&carried)) } else { crosspoints.clone() };
        if without != crosspoints {
            start = surfaces.integrate(&candidates, q_n.into(), &values, &without, &[], with_facets)?;
        }
        let (frozen, no_penetration) = (self.is_frozen(), NO_PENETRATION * surfaces.slave.length_scale());
        let weights = if frozen { middle.as_ref().unwrap_or(&start) } else { &start };
        let gap: Vec<Option<f64>> =
            weights.slots.iter().map(|slot| if slot.opposite > 0.0 { slot.gap(q_n) } else { None }).collect();
        let (rows, slots) = (&surfaces.rows, &weights.slots);
        self.reference_gap.begin(step, rows.len(), |k| {
            // A mean over next to nothing is no distance.
            gap[k].filter(|_| slots[k].support > COVERED * rows[k].area).map(|gap| gap / slots[k].support)
        });
        if let Some(surface) = &mut self.friction {
            surface.friction.weaken(self.reference_gap.friction_factor(step));
        }
        let hold = self.options.hold.filter(|_| step.impacts && !frozen);
        let highest = LARGEST_HELD * surfaces.slave.length_scale();
        let is_kept = self.has_rates && !frozen && self.options.overclosure.is_none();
        let count = surfaces.rows.len();
        let mut settling = vec![0.0; count];
        let own: Vec<f64> = (0..count).map(|k| self.reference_gap.of(k)).collect();
        let mut distance = if self.has_rates { own.clone() } else { vec![0.0; count] };
        let mut reference = own.clone();
        for (k, row) in surfaces.rows.iter().enumerate() {
            let slot = &weights.slots[k];
            let Some(gap) = gap[k].filter(|_| slot.support > COVERED * row.area) else { continue };
            // Beyond the distance that the row keeps by itself.
            let own = own[k];
            let (volume, gap) = (gap - own * slot.support, gap / slot.support - own);
            let closed = self.closed_steps[k];
            match hold {
                // A row that overlaps stays so far inside: to push it out would be work that no force does. The depth of a spring is no gap that is kept.
                _ if is_kept && volume < -no_penetration * row.area => reference[k] = own + gap,
                Some(settle) if closed > 0 && gap > 0.0 => {
                    settling[k] = if closed >= settle { -gap / f64::from(settle) } else { 0.0 };
                    reference[k] = own + gap + settling[k];
                }
                Some(_) if closed == 0 && gap <= highest => reference[k] = own + gap.max(0.0),
                _ => {}
            }
            distance[k] = match self.rule {
                _ if !self.has_rates => 0.0,
                GradientRule::StartPoint => own + gap,
                GradientRule::EndPoint => reference[k],
                GradientRule::Midpoint | GradientRule::DiscreteGradient | GradientRule::EndPointMean => {
                    0.5 * (own + gap + reference[k])
                }
            };
        }
        self.middle = Integrated::default();
        self.end = match middle {
            Some(middle) if frozen => middle,
            _ => start.clone(),
        };
        if frozen && self.has_middle() {
            self.middle.slots.clone_from(&self.end.slots);
        }
        self.step = StepState {
            nodes: candidates.nodes(&surfaces.slave, &surfaces.master),
            candidates,
            range: Some(GapRange { min: -factors.fading_depth().min(range.depth), max: range.far / MARGIN }),
            q_n: q_n.to_vec(),
            start: if frozen { self.end.slots.clone() } else { start.slots },
            gap,
            gradient: vec![Vec::new(); count],
            reference,
            distance,
            settling,
            carried,
            without,
        };
        self.step.note(q_n, &mut self.end.at);
        Ok(self.begin_friction()?)
    }

    fn renew(&mut self, at: &At<'_>, want_tangent: bool) -> Result<bool, Fault> {
        let At { q_np1, multipliers: pressures, auxiliaries, active, .. } = *at;
        self.keep_multipliers(auxiliaries);
        let carrying: Vec<bool> = active.iter().zip(&self.step.carried).map(|(a, c)| *a && *c).collect();
        // Rows without a part of the master have stencils too, so that all active ones count.
        let nodes = |method: &Self| -> Vec<usize> { method.end.slots.iter().map(|slot| slot.nodes.len()).collect() };
        let before = nodes(self);
        if !self.is_frozen() {
            self.follow(q_np1, &carrying, want_tangent)?;
        }
        if self.rule != GradientRule::EndPoint {
            self.follow_start(&carrying)?;
        }
        if want_tangent && self.learns() {
            self.learn(q_np1, &self.of_share(&carrying))?;
        }
        let changed =
            before.iter().zip(nodes(self)).zip(active).any(|((before, now), active)| *active && *before != now);
        if want_tangent {
            self.follow_friction(q_np1, pressures, active);
        }
        Ok(changed)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for (k, slot) in self.end.slots.iter().enumerate().filter(|(k, _)| active[*k]) {
            visit(&slot.nodes, &[k as u32]);
        }
    }

    /// Two multipliers of the friction, if stick is enforced by them: components in the frame of the node of what they add to the traction
    /// at the start.
    fn auxiliaries(&self) -> &[Auxiliary] {
        if self.has_stick_multipliers() { &[Auxiliary::Constraint; 2] } else { &[] }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers: pressures, auxiliaries, active, .. } = *at;
        let further = self.auxiliaries().len();
        let slots: Vec<usize> = (0..self.end.slots.len()).filter(|&k| active[k]).collect();
        let compute = |&k: &usize, (out, scratch): &mut (Local, Scratch)| -> Result<(), Fault> {
            let slot = &self.end.slots[k];
            out.auxiliaries = further;
            out.slots.clear();
            out.slots.push(k as u32);
            out.nodes.clear();
            out.nodes.extend_from_slice(&slot.nodes);
            if !self.share.has(&slot.nodes) {
                out.set_elsewhere();
                return Ok(());
            }
            out.reset(want_tangent);
            let multiplier = multipliers_of(k, further, auxiliaries);
            let of_friction = self.friction_slots().get(k).filter(|slot| slot.support > 0.0);
            let carries = self.step.carried[k];
            if carries {
                self.contribute(k, step, pressures[k], want_tangent, out)?;
            }
            let slides = carries && of_friction.is_some();
            if slides && !self.add_friction(k, step, pressures[k], multiplier, want_tangent, scratch, out) {
                return Err(ContactError::NoNormal { node: slot.nodes[0] }.into());
            }
            // The row `-A p = 0` keeps the system regular until the slot opens.
            let (n, weight) = (3 * slot.nodes.len(), self.slot_weight(k));
            let (dim, first) = (out.dim(), n + out.slots.len());
            let values =
                [(n, pressures[k], !carries), (first, multiplier[0], !slides), (first + 1, multiplier[1], !slides)];
            for (row, value, _) in values[..1 + further].iter().filter(|(.., idle)| *idle) {
                out.residual[*row] = -weight * value;
                if want_tangent {
                    out.tangent[row * dim + row] = -weight;
                }
            }
            Ok(())
        };
        in_order(&slots, compute, |_, (out, _)| visit(out))
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        Ok(self.step_work(at.q_np1, at.multipliers, at.active))
    }

    fn verify(&self, q_np1: &[f64]) -> Result<Coverage, Fault> {
        Ok(self.check_coverage(q_np1)?)
    }

    fn commit(&mut self, at: &At<'_>) {
        self.end_step(at.q_np1, at.multipliers, at.active);
    }

    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, Fault> {
        Ok(self.slot_reports(q)?)
    }

    fn save_history(&self) -> Vec<u8> {
        self.history()
    }

    fn join_histories(&self, parts: &[Vec<u8>]) -> Result<Vec<u8>, Fault> {
        Ok(self.join(parts)?)
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
