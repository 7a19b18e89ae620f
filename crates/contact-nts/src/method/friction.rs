//! Friction as a part of the contact method: which rule takes what, history, energies.

use crate::crossing::{MAX_NODES, local_of};
use crate::friction::{FrictionElement, FrictionState, PointHistory, Slip, SurfaceFriction, carry};
use crate::kinematics::{Gap, mean, points};
use crate::method::NodeToSurface;
use crate::options::ConstraintForm;
use crate::slot::{ElementNodes, PairedSlot};
use stoss_contact::friction::{Friction, Stick};
use stoss_contact::{ContactError, position};
use stoss_term::{GradientRule, Local, SlotFriction, StepConfiguration, Work};

/// Bytes of history of a slot: two components of the traction, path slid.
const HISTORY: usize = 24;

/// Positions of an element, its configuration of the force and the projection there.
struct Placed {
    /// `q_np1 - q_n`.
    increment: [f64; 3 * MAX_NODES],
    /// Positions of the configuration of the force.
    q: [f64; 3 * MAX_NODES],
    /// `None`: the kinematics are those at the end.
    mid: Option<Gap>,
}

impl NodeToSurface {
    /// The contact of the same surfaces with friction.
    ///
    /// Under the rule `EndPoint` backward Euler (statics), under `Midpoint` and `DiscreteGradient` the stepping of `friction`; under the last
    /// one the work of the friction is exact: kinetic, strain and spring energy fall by exactly what is dissipated, which is not negative.
    ///
    /// # Errors
    /// [`ContactError::FrictionUnavailable`] with the modified constraint: its nodes bounce at every step, so that nothing sticks.
    pub fn with_friction(mut self, friction: Friction) -> Result<Self, ContactError> {
        if self.constraint == ConstraintForm::Modified {
            return Err(ContactError::FrictionUnavailable { what: "the modified constraint".into() });
        }
        self.friction = Some(SurfaceFriction::new(friction, self.slots.len()));
        Ok(self)
    }

    /// Lets the multipliers of the friction yield by [`stoss_contact::friction::STICK_COMPLIANCE`] everywhere, and not only where supports or other contacts may
    /// determine the motion of a node ([`stoss_term::HeldNodes::may_hold`]); to be called after [`Self::with_friction`].
    #[must_use]
    pub fn with_compliant_stick(mut self) -> Self {
        if let Some(surface) = &mut self.friction {
            surface.is_compliant = true;
        }
        self
    }

    fn place(&self, at: PairedSlot<'_>) -> Result<Placed, ContactError> {
        let PairedSlot { slot, element, pairing, end, step } = at;
        let mut placed = Placed { increment: [0.0; 3 * MAX_NODES], q: [0.0; 3 * MAX_NODES], mid: None };
        let at_end = match step.rule {
            GradientRule::EndPoint => true,
            GradientRule::Midpoint | GradientRule::DiscreteGradient => false,
            rule @ (GradientRule::StartPoint | GradientRule::EndPointMean) => {
                return Err(ContactError::FrictionUnavailable { what: format!("the rule {rule:?}") });
            }
        };
        for (k, &node) in element.list().iter().enumerate() {
            for i in 0..3 {
                let (a, b) = (step.q_n[3 * node as usize + i], step.q_np1[3 * node as usize + i]);
                placed.increment[3 * k + i] = b - a;
                placed.q[3 * k + i] = if at_end { b } else { 0.5 * (a + b) };
            }
        }
        if !at_end {
            let kind = element.mid.kind();
            let local = local_of(&element.mid, |node| std::array::from_fn(|i| placed.q[3 * node + i]));
            let (x, patch) = points(&local, kind);
            let from = if pairing.start == pairing.end { end.xi } else { kind.centre() };
            let failed = ContactError::Projection { node: self.node(slot), facet: pairing.mid };
            let mid = if self.augmented {
                Gap::at(&x, &patch, mean(self.start_coordinates(slot, pairing.end), end.xi))
            } else {
                Gap::project(&x, &patch, from)
            };
            placed.mid = Some(mid.ok_or(failed)?);
        }
        Ok(placed)
    }

    /// Hands the friction element of a paired slot over; `None` without friction.
    fn with_element<R>(
        &self,
        of: PairedSlot<'_>,
        pressure: f64,
        multiplier: [f64; 2],
        evaluate: impl FnOnce(&FrictionElement<'_>) -> R,
    ) -> Result<Option<R>, ContactError> {
        let Some(surface) = &self.friction else { return Ok(None) };
        let PairedSlot { slot, element, pairing, end, step } = of;
        let history = PointHistory { multiplier, ..surface.points[slot] };
        let placed = self.place(of)?;
        let n = 3 * element.count;
        let at = match &placed.mid {
            Some(mid) => (mid, &element.mid),
            None => (end, &element.end),
        };
        // Over an edge the feet lie on facets that are inclined to each other: only what the traction works on is a slip there. With coordinate augmentation
        // the feet are unknowns, and the traction works on their difference.
        let slip = match step.rule {
            GradientRule::DiscreteGradient if !self.augmented => Slip::Work(&placed.increment[..n]),
            GradientRule::Midpoint if !self.augmented && pairing.start != pairing.end => {
                Slip::Work(&placed.increment[..n])
            }
            GradientRule::StartPoint
            | GradientRule::EndPoint
            | GradientRule::EndPointMean
            | GradientRule::Midpoint
            | GradientRule::DiscreteGradient => Slip::Feet(end, &element.end),
        };
        Ok(Some(evaluate(&FrictionElement {
            friction: &surface.friction,
            at_end: placed.mid.is_none(),
            q: &placed.q[..n],
            at,
            start: &element.start,
            history: &history,
            compliance: surface.compliance[slot],
            slip,
            pressure,
            step_size: surface.step_size,
        })))
    }

    /// Adds a slot's friction to its contribution.
    pub(crate) fn add_friction(
        &self,
        of: PairedSlot<'_>,
        pressure: f64,
        multiplier: [f64; 2],
        want_tangent: bool,
        contribution: &mut Local,
    ) -> Result<(), ContactError> {
        let weight = self.slave.weights()[of.slot];
        self.with_element(of, pressure, multiplier, |friction| {
            let state = friction.state();
            let rows = 3 * of.element.count + 1..contribution.dim();
            let add = |rows: &mut [f64], mismatch: [f64; 2]| {
                rows.iter_mut().zip(mismatch).for_each(|(row, m)| *row += weight * m);
            };
            friction.add_residual(weight, state.tau, &mut contribution.residual);
            add(&mut contribution.residual[rows.clone()], state.mismatch);
            if let Some([tau, mismatch]) = friction.shift(&state) {
                contribution.shift.resize(contribution.dim(), 0.0);
                friction.add_residual(weight, tau, &mut contribution.shift);
                add(&mut contribution.shift[rows], mismatch);
            }
            if want_tangent {
                friction.add_tangent(weight, &state, contribution.dim(), &mut contribution.tangent);
            }
        })?;
        Ok(())
    }

    /// Whether the traction of each slot is a pair of unknowns.
    pub(crate) fn has_stick_multipliers(&self) -> bool {
        self.friction.as_ref().is_some_and(|surface| surface.friction.stick() == Stick::Multiplier)
    }

    /// Keeps the multipliers of an iterate: the first two of the `count` auxiliaries of each slot.
    pub(crate) fn keep_multipliers(&mut self, auxiliaries: &[f64], count: usize) {
        if !self.has_stick_multipliers() {
            return;
        }
        let points = self.friction.iter_mut().flat_map(|surface| &mut surface.points);
        for (point, values) in points.zip(auxiliaries.chunks_exact(count)) {
            point.multiplier = [values[0], values[1]];
        }
    }

    /// State of an active, paired slot at the end of the present step.
    fn friction_state(&self, slot: usize, q_np1: &[f64], pressure: f64) -> Result<Option<FrictionState>, ContactError> {
        let (Some(surface), Some(pairing)) = (&self.friction, self.slots[slot].pairing) else { return Ok(None) };
        let element = ElementNodes::new(self.node(slot), self.search.surface(), pairing);
        let end = self.gap(slot, pairing.end, q_np1)?;
        let step = StepConfiguration { q_n: &self.q_n, q_np1, rule: surface.rule };
        let multiplier = surface.points[slot].multiplier;
        let of = PairedSlot { slot, element: &element, pairing, end: &end, step };
        self.with_element(of, pressure, multiplier, |friction| friction.state())
    }

    /// The traction with which a slot begins its step: that of the last one, on the facet that it starts from now.
    pub(crate) fn begin_friction(&mut self, slot: usize, committed: Option<u32>) {
        let pairing = self.slots[slot].pairing;
        let Some(surface) = &mut self.friction else { return };
        let point = &mut surface.points[slot];
        let (Some(facet), Some(pairing)) = (committed, pairing) else {
            // The report is that of the last step until another one is accepted: this attempt may fail.
            *point = PointHistory { last: point.last, ..PointHistory::default() };
            return;
        };
        *point = PointHistory {
            committed: point.committed,
            slid: point.slid,
            start: point.committed,
            last: point.last,
            ..PointHistory::default()
        };
        self.place_foot(slot);
        if facet != pairing.start {
            let from = (&self.patch(facet, &self.q_n), self.foot(slot, facet));
            let to = (&self.patch(pairing.start, &self.q_n), self.foot(slot, pairing.start));
            if let Some(surface) = &mut self.friction {
                let point = &mut surface.points[slot];
                point.start = carry(point.committed, from, to);
            }
        }
    }

    /// Foot at `n` on an extended facet, or the closest point of the facet where there is no foot.
    fn foot(&self, slot: usize, facet: u32) -> [f64; 2] {
        let patch = self.patch(facet, &self.q_n);
        let x = position(&self.q_n, self.node(slot));
        Gap::project(&x, &patch, [0.0, 0.0]).map_or_else(|| patch.closest_point(&x).xi, |gap| gap.xi)
    }

    /// Stores the foot at `n` on the facet that the slot starts from.
    pub(crate) fn place_foot(&mut self, slot: usize) {
        if self.friction.is_none() {
            return;
        }
        let foot = self.slots[slot].pairing.map(|pairing| self.foot(slot, pairing.start));
        if let (Some(surface), Some(foot)) = (&mut self.friction, foot) {
            surface.points[slot].foot = foot;
        }
    }

    /// Looks where the points slide at an iterate that is linearised.
    pub(crate) fn follow_friction(
        &mut self,
        q_np1: &[f64],
        pressures: &[f64],
        active: &[bool],
    ) -> Result<(), ContactError> {
        if self.friction.is_none() {
            return Ok(());
        }
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let Some(state) = self.friction_state(slot, q_np1, pressures[slot])? else { continue };
            let Some(surface) = &mut self.friction else { return Ok(()) };
            surface.points[slot].iteration.follow(&state.step);
        }
        Ok(())
    }

    pub(crate) fn friction_work(
        &self,
        q_np1: &[f64],
        pressures: &[f64],
        active: &[bool],
    ) -> Result<Work, ContactError> {
        let mut total = Work::default();
        let Some(surface) = &self.friction else { return Ok(total) };
        for (slot, point) in surface.points.iter().enumerate() {
            let weight = self.slave.weights()[slot];
            let compliance = surface.compliance[slot];
            let energy =
                |traction| surface.friction.stored(traction) + surface.friction.stored_by(compliance, traction);
            let before = energy(point.committed);
            let state = if active[slot] { self.friction_state(slot, q_np1, pressures[slot])? } else { None };
            let Some(state) = state else {
                // What a released spring held is lost.
                total.dissipated += weight * before;
                continue;
            };
            let stored = energy(state.step.force);
            // What was carried over an edge is turned, or dropped: it holds no more than before.
            let dropped = (before - energy(point.start)).max(0.0);
            // Of the compliance of multipliers, whose spring is loaded by backward Euler.
            let yielding = surface.friction.stored_by(compliance, point.multiplier);
            total += Work {
                stored: weight * stored,
                dissipated: weight * (state.step.dissipated + yielding + dropped),
                friction_stored: weight * stored,
                friction_work: weight * state.step.work,
                driven: -weight * (0..2).map(|i| state.step.force[i] * state.way[i]).sum::<f64>(),
                ..Work::default()
            };
        }
        Ok(total)
    }

    /// Traction and path at the end of an accepted step, in the frame of the facet reached, at `q_np1`; `None` without friction or pairing.
    fn committed_point(&self, slot: usize, q_np1: &[f64], pressure: f64) -> Option<PointHistory> {
        let (surface, pairing) = (self.friction.as_ref()?, self.slots[slot].pairing?);
        let point = &surface.points[slot];
        // `work` has evaluated both at the same positions before (the protocol of the method), and had it failed the step would not have been
        // accepted. Were it otherwise, the traction of the last step would be better than none.
        let (Ok(Some(state)), Ok(end)) =
            (self.friction_state(slot, q_np1, pressure), self.gap(slot, pairing.end, q_np1))
        else {
            return Some(PointHistory { committed: point.committed, slid: point.slid, ..PointHistory::default() });
        };
        let from = (&self.patch(pairing.start, q_np1), point.foot);
        let committed = carry(state.carried, from, (&self.patch(pairing.end, q_np1), end.xi));
        let slid = point.slid + if state.step.sticks { 0.0 } else { state.slip[0].hypot(state.slip[1]) };
        let of_step = [pressure, point.slid, surface.step_size];
        let last = Some(surface.friction.slot_friction(&state.step, state.history, state.slip, of_step));
        Some(PointHistory { committed, slid, last, ..PointHistory::default() })
    }

    /// Friction of a slot in the last accepted step.
    pub(crate) fn last_friction(&self, slot: usize) -> Option<SlotFriction> {
        self.friction.as_ref()?.points[slot].last
    }

    /// Must come before the facets are committed.
    pub(crate) fn commit_friction(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        if self.friction.is_none() {
            return;
        }
        for slot in 0..self.slots.len() {
            let point = if active[slot] { self.committed_point(slot, q_np1, pressures[slot]) } else { None };
            if let Some(surface) = &mut self.friction {
                surface.points[slot] = point.unwrap_or_default();
            }
        }
    }

    /// Bytes of a slot's history of friction.
    pub(crate) fn friction_bytes(&self) -> usize {
        if self.friction.is_some() { HISTORY } else { 0 }
    }

    pub(crate) fn save_friction(&self, out: &mut Vec<u8>) {
        for point in self.friction.iter().flat_map(|surface| &surface.points) {
            for value in [point.committed[0], point.committed[1], point.slid] {
                out.extend_from_slice(&value.to_le_bytes());
            }
        }
    }

    /// Reads the history from as many bytes as [`Self::save_friction`] writes.
    pub(crate) fn load_friction(&mut self, bytes: &[u8]) {
        let points = self.friction.iter_mut().flat_map(|surface| &mut surface.points);
        for (point, chunk) in points.zip(bytes.chunks_exact(HISTORY)) {
            let value = |k: usize| f64::from_le_bytes(std::array::from_fn(|i| chunk[8 * k + i]));
            *point = PointHistory { committed: [value(0), value(1)], slid: value(2), ..PointHistory::default() };
        }
    }
}
