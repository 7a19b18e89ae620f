//! Friction as a part of the contact method: rules, history, energies.

use super::MortarContact;
use crate::friction::{
    FrictionState, MaterialFrames, NodeFriction, PointHistory, SLIVER, Scratch, SlipMeasure, SurfaceFriction,
};
use crate::slot::Slot;
use crate::state::Surfaces;
use stoss_contact::friction::{Friction, Stick, stick_compliance};
use stoss_contact::{ContactError, in_order};
use stoss_term::{GradientRule, Local, SlotFriction, StepConfiguration, StepContext, Work};

/// Bytes of history of a slot: two components of the traction, path slid, covered area.
const HISTORY: usize = 32;

fn norm(v: [f64; 2]) -> f64 {
    v[0].hypot(v[1])
}

impl MortarContact {
    /// The contact of the same surfaces with friction, its slip measured in one of the ways of [`SlipMeasure`].
    ///
    /// Under [`GradientRule::EndPoint`] force and slip have the integrals of the iterate, the slip at both ends of the step: it is the relative motion of
    /// what came to lie opposite each other, also at a node that had no partner at `q_n`. Under [`GradientRule::Midpoint`] and
    /// [`GradientRule::DiscreteGradient`] integrals stay in the step for both; with [`SlipMeasure::Objective`] the work of the friction is exact then.
    ///
    /// # Errors
    /// [`ContactError::FrictionUnavailable`] with the modified constraint: its nodes bounce at every step, so that nothing sticks.
    /// `begin` refuses the other rules.
    pub fn with_friction(mut self, friction: Friction, measure: SlipMeasure) -> Result<Self, ContactError> {
        let count = self.surfaces.rows.len();
        let (points, compliance) = (vec![PointHistory::default(); count], vec![0.0; count]);
        let slivers = vec![false; count];
        let (step_size, is_compliant) = (0.0, false);
        // Before the first step these are the reference positions.
        let frames = MaterialFrames::new(&self.surfaces.slave, &self.step.q_n);
        self.friction =
            Some(SurfaceFriction { friction, measure, frames, step_size, points, compliance, is_compliant, slivers });
        Ok(self)
    }

    /// Lets the multipliers of the friction yield by [`stoss_contact::friction::STICK_COMPLIANCE`] everywhere, and not only where supports or other contacts may determine the motion
    /// of a node ([`stoss_term::HeldNodes::may_hold`]) or the node has several rows; to be called after [`Self::with_friction`].
    #[must_use]
    pub fn with_compliant_stick(mut self) -> Self {
        if let Some(surface) = &mut self.friction {
            surface.is_compliant = true;
        }
        self
    }

    pub(crate) fn begin_friction_step(&mut self, step: &StepContext<'_>) {
        let Some(surface) = &mut self.friction else { return };
        surface.step_size = step.dt;
        surface.friction.begin(step);
        let Surfaces { slave, rows, .. } = &self.surfaces;
        for (compliance, row) in surface.compliance.iter_mut().zip(rows) {
            // Where a node has several rows, what one says along its face another may say across its own.
            let may_be_held = surface.is_compliant || row.shared || step.held.may_hold(slave.nodes()[row.local]);
            *compliance = stick_compliance(may_be_held);
        }
    }

    /// Starts a step with the slots at `q_n`.
    pub(crate) fn begin_friction(&mut self) -> Result<(), ContactError> {
        let Some(surface) = &mut self.friction else { return Ok(()) };
        if let rule @ (GradientRule::StartPoint | GradientRule::EndPointMean) = self.rule {
            return Err(ContactError::FrictionUnavailable { what: format!("the rule {rule:?}") });
        }
        let start = &self.step.start;
        let exact = surface.friction.stick() != Stick::Penalty && self.rule == GradientRule::EndPoint;
        let rows = start.iter().zip(&self.surfaces.rows);
        for (sliver, (slot, row)) in surface.slivers.iter_mut().zip(rows) {
            *sliver = exact && slot.support < SLIVER * row.area;
        }
        let nodes = start.iter().zip(&surface.compliance).zip(&surface.slivers);
        for (point, ((slot, &compliance), &sliver)) in surface.points.iter_mut().zip(nodes) {
            // The springs of an area that has grown must not hold more energy than before; what a part that was uncovered held is lost.
            let stored =
                surface.friction.stored(point.committed) + surface.friction.stored_by(compliance, point.committed);
            let stores = stored > 0.0 && slot.support > point.support;
            let factor = match (sliver, stores) {
                (true, _) => 0.0,
                (false, true) => (point.support / slot.support).sqrt(),
                (false, false) => 1.0,
            };
            *point = PointHistory {
                start: point.committed.map(|t| factor * t),
                committed: point.committed,
                slid: point.slid,
                support: point.support,
                // The report is that of the last step until another one is accepted: this attempt may fail.
                last: point.last,
                ..PointHistory::default()
            };
        }
        Ok(())
    }

    fn node_friction(&self, slot: usize, pressure: f64, multiplier: [f64; 2]) -> Option<NodeFriction<'_>> {
        let surface = self.friction.as_ref()?;
        let point = surface.points[slot];
        // Slips of the midpoint rules have the weights of the middle at both ends.
        let start =
            if self.rule == GradientRule::EndPoint { &self.step.start } else { self.friction_slots() }.get(slot)?;
        Some(NodeFriction {
            friction: &surface.friction,
            measure: surface.measure,
            frames: &surface.frames,
            local: self.surfaces.rows[slot].local,
            across: self.surfaces.rows[slot].across,
            start,
            area: self.slip_area(slot),
            history: point.start,
            multiplier,
            compliance: if surface.slivers[slot] {
                surface.friction.spring_compliance()
            } else {
                surface.compliance[slot]
            },
            weight: self.surfaces.rows[slot].area,
            slid: point.slid,
            step_size: surface.step_size,
            pressure,
            reversed: point.iteration.is_reversed(),
        })
    }

    /// Covered area that slip and energies of a slot belong to: that of the start of the step for the midpoint rules, that of the end for the end point.
    fn slip_area(&self, slot: usize) -> f64 {
        let of = |slots: &[Slot]| slots.get(slot).map_or(0.0, |slot| slot.support);
        let (start, present) = (of(&self.step.start), of(self.friction_slots()));
        match self.rule {
            GradientRule::EndPoint => present,
            GradientRule::StartPoint
            | GradientRule::Midpoint
            | GradientRule::EndPointMean
            | GradientRule::DiscreteGradient => {
                // A node that had no partner has the area of the middle.
                if start > 0.0 { start } else { present }
            }
        }
    }

    /// Adds a slot's friction to its contribution; false if the node has no tangent plane.
    pub(crate) fn add_friction(
        &self,
        slot: usize,
        step: StepConfiguration<'_>,
        pressure: f64,
        multiplier: [f64; 2],
        want_tangent: bool,
        work: &mut Scratch,
        out: &mut Local,
    ) -> bool {
        let node = self.node_friction(slot, pressure, multiplier);
        node.is_none_or(|node| node.contribute(&self.friction_slots()[slot], step, want_tangent, work, out))
    }

    /// State of a slot at the end of the present step; `None` without friction or partner.
    fn friction_state(&self, slot: usize, q_np1: &[f64], pressure: f64, work: &mut Scratch) -> Option<FrictionState> {
        let present = self.friction_slots().get(slot).filter(|s| s.support > 0.0)?;
        let surface = self.friction.as_ref()?;
        let step = StepConfiguration { q_n: &self.step.q_n, q_np1, rule: self.rule };
        self.node_friction(slot, pressure, surface.points[slot].multiplier)?.state(present, step, work)
    }

    /// Whether the traction of each slot is a pair of unknowns.
    pub(crate) fn has_stick_multipliers(&self) -> bool {
        self.friction.as_ref().is_some_and(|surface| surface.friction.stick() == Stick::Multiplier)
    }

    /// Keeps the multipliers of an iterate.
    pub(crate) fn keep_multipliers(&mut self, auxiliaries: &[f64]) {
        if !self.has_stick_multipliers() {
            return;
        }
        let points = self.friction.iter_mut().flat_map(|surface| &mut surface.points);
        for (point, values) in points.zip(auxiliaries.chunks_exact(2)) {
            point.multiplier = [values[0], values[1]];
        }
    }

    /// Looks where the nodes slide at an iterate that is linearised.
    pub(crate) fn follow_friction(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        if self.friction.is_none() {
            return;
        }
        let slots: Vec<usize> = (0..active.len().min(pressures.len())).filter(|&s| active[s]).collect();
        let mut steps = Vec::with_capacity(slots.len());
        let compute = |&slot: &usize, (state, work): &mut (Option<FrictionState>, Scratch)| {
            *state = self.friction_state(slot, q_np1, pressures[slot], work);
            Ok::<_, ContactError>(())
        };
        // cannot fail: no state does.
        in_order(&slots, compute, |_, (state, _)| steps.push(state.take().map(|state| state.step))).unwrap_or(());
        let Some(surface) = &mut self.friction else { return };
        for (&slot, step) in slots.iter().zip(&steps) {
            step.iter().for_each(|step| surface.points[slot].iteration.follow(step));
        }
    }

    pub(crate) fn friction_work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Work {
        let mut total = Work::default();
        let Some(surface) = &self.friction else { return total };
        let mut work = Scratch::default();
        for (slot, point) in surface.points.iter().enumerate() {
            let compliance = surface.compliance[slot];
            let energy =
                |traction| surface.friction.stored(traction) + surface.friction.stored_by(compliance, traction);
            let before = point.support * energy(point.committed);
            let state = if active[slot] { self.friction_state(slot, q_np1, pressures[slot], &mut work) } else { None };
            let Some(FrictionState { step, way, .. }) = state else {
                // What a released spring held is lost.
                total.dissipated += before;
                continue;
            };
            let support = self.slip_area(slot);
            let driven = -support * (step.force[0] * way[0] + step.force[1] * way[1]);
            if surface.slivers[slot] {
                // Nothing is kept for the next step.
                let friction_work = support * step.work;
                let dissipated = before + friction_work;
                total += Work { dissipated, friction_work, driven, ..Work::default() };
                continue;
            }
            // What springs held at the start, on the area of then and on that of the slip: the difference is that of an area that was uncovered.
            let uncovered = before - support * energy(point.start);
            // Of the compliance of multipliers, whose spring is loaded by backward Euler.
            let yielding = surface.friction.stored_by(compliance, point.multiplier);
            let stored = support * energy(step.force);
            total += Work {
                stored,
                dissipated: support * (step.dissipated + yielding) + uncovered,
                friction_stored: stored,
                friction_work: support * step.work,
                driven,
                ..Work::default()
            };
        }
        total
    }

    pub(crate) fn commit_friction(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        let mut work = Scratch::default();
        let count = self.friction.as_ref().map_or(0, |surface| surface.points.len());
        for slot in 0..count {
            let state = if active[slot] { self.friction_state(slot, q_np1, pressures[slot], &mut work) } else { None };
            let support = self.slip_area(slot);
            let Some(surface) = &mut self.friction else { continue };
            let sliver = surface.slivers[slot];
            let (point, step_size) = (&mut surface.points[slot], surface.step_size);
            let (start, slid) = (point.start, point.slid);
            *point = state.map_or_else(PointHistory::default, |state| PointHistory {
                committed: if sliver { [0.0; 2] } else { state.step.force },
                slid: point.slid + if state.step.sticks { 0.0 } else { norm(state.slip) },
                support,
                last: Some(surface.friction.slot_friction(
                    &state.step,
                    start,
                    state.slip,
                    [pressures[slot], slid, step_size],
                )),
                ..PointHistory::default()
            });
        }
    }

    /// Friction of a slot in the last accepted step.
    pub(crate) fn last_friction(&self, slot: usize) -> Option<SlotFriction> {
        self.friction.as_ref()?.points.get(slot)?.last
    }

    pub(crate) fn save_friction(&self) -> Vec<u8> {
        let points = self.friction.iter().flat_map(|surface| &surface.points);
        let values = points.flat_map(|p| [p.committed[0], p.committed[1], p.slid, p.support]);
        values.flat_map(f64::to_le_bytes).collect()
    }

    /// Number of bytes of the history of friction.
    pub(crate) fn friction_history(&self) -> usize {
        HISTORY * self.friction.as_ref().map_or(0, |surface| surface.points.len())
    }

    pub(crate) fn load_friction(&mut self, bytes: &[u8]) {
        let points = self.friction.iter_mut().flat_map(|surface| &mut surface.points);
        for (point, chunk) in points.zip(bytes.chunks_exact(HISTORY)) {
            let value = |k: usize| f64::from_le_bytes(std::array::from_fn(|i| chunk[8 * k + i]));
            *point = PointHistory {
                committed: [value(0), value(1)],
                slid: value(2),
                support: value(3),
                ..PointHistory::default()
            };
        }
    }
}
