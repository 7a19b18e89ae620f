//! Node-to-surface contact as a contact method.
//!
//! Pairings are made in `pairing`, gap gradients in `gradient`, enforcement in `normal` and `enforced`, friction in `friction` and `frictional`.

use crate::crossing::{component, spread};
use crate::friction::SurfaceFriction;
use crate::kinematics::Gap;
use crate::normal::Normal;
use crate::options::{ConstraintForm, NodeToSurfaceOptions};
use crate::slave::Slave;
use crate::slot::{ElementNodes, Pairing, Slot};
use crate::work::Work;
use stoss_contact::{
    Auxiliary, Constraint, ContactError, ContactLine, ContactMethod, ContactRule, ContactSurface, ContactWork,
    Enforcement, FacetNodes, History, LocalContribution, MasterPoint, MasterSearch, Report, SlotReport,
    StepConfiguration, clear_inactive, multipliers_of, position,
};
use stoss_geometry::Patch;

/// Slave nodes against master facets, with or without friction, one pressure a slave node: traction on the node's reference area or, of a line, force per reference
/// length.
#[derive(Clone, Debug)]
pub struct NodeToSurface {
    name: String,
    pub(crate) slave: Slave,
    pub(crate) search: MasterSearch,
    pub(crate) constraint: ConstraintForm,
    pub(crate) normal: Normal,
    pub(crate) slots: Vec<Slot>,
    /// Positions at `n`, for pairing.
    pub(crate) q_n: Vec<f64>,
    /// A typical edge of the master.
    pub(crate) length: f64,
    pub(crate) friction: Option<SurfaceFriction>,
    /// Serves coordinate augmentation ([`crate::augmented`]): the coordinates at the midpoint are the mean of those at the ends.
    pub(crate) augmented: bool,
}

/// Bytes of history of a slot: facet, gap kept, strayed or not.
const HISTORY: usize = 13;

impl NodeToSurface {
    /// From facets (global nodes, numbered outward) and reference positions (`3 * nodes`).
    ///
    /// # Errors
    /// Empty or degenerate surfaces, shared nodes, options out of range, a penalty with the modified constraint.
    pub fn new<S: Copy + Into<FacetNodes>, M: Copy + Into<FacetNodes>>(
        name: &str,
        slave_facets: &[S],
        master_facets: &[M],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        let slave = Slave::Surface(ContactSurface::new("slave", slave_facets, reference)?);
        Self::of(name, slave, master_facets, reference, options)
    }

    /// As [`Self::new`] with the nodes of a string or of a beam as the slave side. They may touch from any side.
    ///
    /// # Errors
    /// Those of [`Self::new`] but for the slave's facets.
    pub fn of_line<M: Copy + Into<FacetNodes>>(
        name: &str,
        slave: ContactLine,
        master_facets: &[M],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        Self::of(name, Slave::Line(slave), master_facets, reference, options)
    }

    fn of<M: Copy + Into<FacetNodes>>(
        name: &str,
        slave: Slave,
        master_facets: &[M],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        let master = ContactSurface::new("master", master_facets, reference)?;
        slave.check_disjoint(&master)?;
        let length = master.length_scale();
        let slots = vec![Slot::FREE; slave.nodes().len()];
        Ok(Self {
            name: name.to_owned(),
            search: MasterSearch::new(master, reference, options.search)?,
            constraint: options.constraint,
            normal: Normal::new(options, slots.len())?,
            slots,
            q_n: Vec::new(),
            length,
            friction: None,
            augmented: false,
            slave,
        })
    }

    pub(crate) fn node(&self, slot: usize) -> u32 {
        self.slave.nodes()[slot]
    }

    pub(crate) fn patch(&self, facet: u32, q: &[f64]) -> Patch {
        self.search.surface().patch(facet, q)
    }

    /// Projection of a slot's node on an extended facet.
    pub(crate) fn gap(&self, slot: usize, facet: u32, q: &[f64]) -> Result<Gap, ContactError> {
        let node = self.node(slot);
        Gap::from_centre(&position(q, node), &self.patch(facet, q)).ok_or(ContactError::Projection { node, facet })
    }

    /// What the gap of a node that is not active may fall to before it counts as closed: a node that was released while it kept a negative gap
    /// must not be caught by that, in this step or later.
    fn allowance(&self, slot: usize) -> f64 {
        let slot = &self.slots[slot];
        if slot.committed.is_none() {
            return slot.kept;
        }
        // The penetration of a spring is no gap that is kept.
        let is_spring = matches!(self.normal.enforcement, Enforcement::Penalty(_));
        if is_spring { slot.kept.min(0.0) } else { slot.origin_gap.min(0.0) }
    }

    /// Gap to the surface; of a node behind it the gap to the extension of its facet, which is what the constraint keeps if it closes. In a valley the two
    /// differ: there the surface ends where the extension goes on.
    fn gap_to_keep(&self, slot: usize, point: &MasterPoint, q: &[f64]) -> f64 {
        match point.pairing {
            Some(pairing) if point.gap < 0.0 => {
                self.gap(slot, pairing.facet, q).map_or(point.gap, |extended| extended.gap.clamp(point.gap, 0.0))
            }
            _ => point.gap,
        }
    }

    /// True if a node behind the surface came there from the side or from behind: without a partner at `n` it was not in front of this
    /// facet's extension then. Closing it would push it out with work that nobody did.
    fn came_from_behind(&self, slot: usize, facet: u32) -> bool {
        let state = &self.slots[slot];
        state.strayed || state.origin.is_none() && self.gap(slot, facet, &self.q_n).is_ok_and(|at_n| at_n.gap < 0.0)
    }

    /// An active slot that found no facet (the union of sets of the active-set control can ask for one): the row `-A p = 0`, which keeps
    /// the system regular until the slot opens, its gap being infinite. Auxiliaries of the contribution are zero likewise.
    pub(crate) fn without_partner(
        &self,
        slot: usize,
        pressure: f64,
        auxiliaries: &[f64],
        want_tangent: bool,
        contribution: &mut LocalContribution,
    ) {
        contribution.nodes.push(self.node(slot));
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

impl Report for NodeToSurface {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.slave.length_scale()
    }

    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        let view = self.search.at(q);
        let current = self.slave.weights_at(q);
        Ok((0..self.slots.len())
            .map(|slot| {
                let point = self.closest(&view, slot, q);
                SlotReport {
                    node: self.node(slot),
                    weight: self.slot_weight(slot),
                    per_current_area: self.slot_weight(slot) / current[slot],
                    area: current[slot],
                    gap: point.pairing.map(|_| point.gap),
                    normal: point.normal.into(),
                    feature: point.feature.name(),
                    reference_gap: self.slots[slot].kept,
                    friction: self.last_friction(slot),
                }
            })
            .collect())
    }
}

impl Constraint for NodeToSurface {
    fn slot_count(&self) -> usize {
        self.slots.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.slave.weights()[slot]
    }

    /// At the end point, without friction: the Hessian of the gap, and one gradient for force and constraint. The row of a spring has the other sign.
    fn is_symmetric(&self, rule: ContactRule) -> bool {
        let is_spring = matches!(self.normal.enforcement, Enforcement::Penalty(_));
        rule == ContactRule::EndPoint && self.friction.is_none() && !is_spring
    }

    fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.search.set_carriers(of);
    }

    fn set_rule(&mut self, rule: ContactRule, step_size: f64) {
        self.normal.rule = rule;
        if let Some(friction) = &mut self.friction {
            friction.rule = rule;
            friction.step_size = step_size;
            friction.friction.begin(step_size);
        }
    }

    fn begin_step(&mut self, q_n: &[f64], reach: f64) -> Result<(), ContactError> {
        self.q_n.clear();
        self.q_n.extend_from_slice(q_n);
        self.normal.begin_step();
        self.search.update(q_n, reach);
        let view = self.search.at(q_n);
        // Facets that the last step ended on, for friction only.
        let mut last = Vec::new();
        if self.friction.is_some() {
            last.extend(self.slots.iter().map(|slot| slot.committed));
        }
        for slot in 0..self.slots.len() {
            let state = self.slots[slot];
            let normal = self.slave.normal(slot, q_n);
            let closest = || view.closest(&position(q_n, self.slave.nodes()[slot]), normal.as_ref());
            self.slots[slot] = match state.committed {
                // A node in contact keeps the gap that its last step ended with. It keeps its facet too, unless it stands on the extension
                // of that: then it starts from the facet below it, with the gap that it has there. (Crossing the edge with
                // the gap of the old facet would need a force tilted by the difference of both gaps over the motion.)
                Some(facet) => {
                    let on_facet = self.gap(slot, facet, q_n)?;
                    let mut at_n = (facet, on_facet.gap);
                    if on_facet.outside() > 0.0
                        && let Some(pairing) = closest().pairing
                        && pairing.facet != facet
                    {
                        at_n = (pairing.facet, self.gap(slot, pairing.facet, q_n)?.gap);
                    }
                    let (kept, wanted) = match self.constraint {
                        ConstraintForm::Standard => (state.kept + (at_n.1 - on_facet.gap), 0.0),
                        ConstraintForm::Modified => (at_n.1, at_n.1),
                    };
                    Slot::closed(at_n.0, at_n.1, kept, wanted)
                }
                None => {
                    let point = closest();
                    let kept = if state.kept < 0.0 { self.gap_to_keep(slot, &point, q_n).min(0.0) } else { 0.0 };
                    Slot::open(point.pairing.map(|p| p.facet), point.gap, kept, state.strayed)
                }
            };
        }
        for (slot, facet) in last.into_iter().enumerate() {
            self.begin_friction(slot, facet);
        }
        Ok(())
    }

    fn renew(
        &mut self,
        q_np1: &[f64],
        pressures: &[f64],
        auxiliaries: &[f64],
        active: &[bool],
        want_tangent: bool,
    ) -> Result<bool, ContactError> {
        self.keep_multipliers(auxiliaries, 2);
        if want_tangent {
            self.follow_friction(q_np1, pressures, active)?;
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

    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        pressures: &[f64],
        active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        self.assemble_with(step, pressures, &[], active, want_tangent, visit)
    }

    /// Two multipliers of the friction, if stick is enforced by them: components in the frame of the old foot of what they add to the
    /// traction at the start.
    fn auxiliaries(&self) -> &[Auxiliary] {
        if self.has_stick_multipliers() { &[Auxiliary::Constraint; 2] } else { &[] }
    }

    fn start_auxiliaries(
        &self,
        _step: StepConfiguration<'_>,
        _pressures: &[f64],
        active: &[bool],
        out: &mut [f64],
    ) -> Result<(), ContactError> {
        clear_inactive(active, self.auxiliaries().len(), out);
        Ok(())
    }

    fn assemble_with(
        &self,
        step: StepConfiguration<'_>,
        pressures: &[f64],
        auxiliaries: &[f64],
        active: &[bool],
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        let further = self.auxiliaries().len();
        let mut contribution = LocalContribution { auxiliaries: further, ..LocalContribution::default() };
        let mut work = Work::new();
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            contribution.slots.clear();
            contribution.slots.push(slot as u32);
            contribution.nodes.clear();
            let multiplier = multipliers_of(slot, further, auxiliaries);
            let Some(pairing) = self.slots[slot].pairing else {
                self.without_partner(slot, pressures[slot], &multiplier, want_tangent, &mut contribution);
                visit(&contribution);
                continue;
            };
            let element = ElementNodes::new(self.node(slot), self.search.surface(), pairing);
            let end = self.gap(slot, pairing.end, step.q_np1)?;
            self.gradient(slot, &element, pairing, &end, step, want_tangent, &mut work)?;
            let (n, weight) = (3 * element.count, self.slot_weight(slot));
            let pressure = pressures[slot];
            contribution.nodes.extend_from_slice(element.list());
            contribution.reset(want_tangent);
            for (r, g) in contribution.residual.iter_mut().zip(&work.gradient[..n]) {
                *r = -weight * pressure * g;
            }
            let row = self.normal_row(slot, step.rule, end.gap, pressure);
            contribution.residual[n] = -weight * row.value;
            if want_tangent {
                let dim = contribution.dim();
                for i in 0..n {
                    for j in 0..n {
                        contribution.tangent[i * dim + j] = -weight * pressure * work.tangent[i * n + j];
                    }
                    contribution.tangent[i * dim + n] = -weight * work.gradient[i];
                }
                let nodes = spread(&element.end);
                for (j, gradient) in end.gradient.iter().enumerate() {
                    contribution.tangent[n * dim + component(&nodes, j)] -= weight * row.d_gap * gradient;
                }
                contribution.tangent[n * dim + n] = -weight * row.d_pressure;
            }
            if self.friction.is_some() {
                self.add_friction(
                    slot,
                    &element,
                    pairing,
                    &end,
                    step,
                    pressure,
                    multiplier,
                    want_tangent,
                    &mut contribution,
                )?;
            }
            visit(&contribution);
        }
        Ok(())
    }
}

impl History for NodeToSurface {
    fn work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        let mut total = self.friction_work(q_np1, pressures, active)?;
        total.stored += self.normal_stored(q_np1, active)?;
        Ok(ContactWork { closing: None, ..total })
    }

    fn commit(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        self.commit_friction(q_np1, pressures, active);
        self.normal.commit(pressures, active);
        let view = self.search.at(q_np1);
        let behind: Vec<(bool, f64)> = (0..self.slots.len())
            .map(|slot| {
                let state = &self.slots[slot];
                // Most nodes are in front, or far away: nothing to look for.
                let may_stray = state.origin.is_none() || state.strayed;
                let was_kept = state.committed.is_some() || state.kept < 0.0;
                if active[slot] || !(may_stray || was_kept) {
                    return (false, 0.0);
                }
                let point = self.closest(&view, slot, q_np1);
                match point.pairing {
                    Some(pairing) if point.gap < 0.0 => {
                        let strayed = may_stray && self.came_from_behind(slot, pairing.facet);
                        (strayed, if was_kept { self.gap_to_keep(slot, &point, q_np1) } else { 0.0 })
                    }
                    _ => (false, 0.0),
                }
            })
            .collect();
        for ((slot, &active), (strayed, left_behind)) in self.slots.iter_mut().zip(active).zip(behind) {
            slot.committed = slot.pairing.filter(|_| active).map(|p| p.end);
            slot.kept = if slot.committed.is_some() { slot.reference } else { left_behind };
            slot.strayed = strayed;
        }
    }

    fn save_history(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HISTORY * self.slots.len());
        for slot in &self.slots {
            out.extend_from_slice(&slot.committed.unwrap_or(u32::MAX).to_le_bytes());
            out.extend_from_slice(&slot.kept.to_le_bytes());
            out.push(u8::from(slot.strayed));
        }
        self.normal.save(&mut out);
        self.save_friction(&mut out);
        out
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        let size = HISTORY + self.normal.bytes() + self.friction_bytes();
        if bytes.len() != size * self.slots.len() {
            return Err(ContactError::History {
                reason: format!("{} bytes for {} slave nodes of {size} bytes", bytes.len(), self.slots.len()),
            });
        }
        let (bytes, rest) = bytes.split_at(HISTORY * self.slots.len());
        let (normal, friction) = rest.split_at(self.normal.bytes() * self.slots.len());
        let facets = self.search.surface().facets().len() as u32;
        for (slot, chunk) in self.slots.iter_mut().zip(bytes.chunks_exact(HISTORY)) {
            let facet = u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
            if facet != u32::MAX && facet >= facets {
                return Err(ContactError::History { reason: format!("facet {facet} of {facets}") });
            }
            let kept: [u8; 8] = std::array::from_fn(|k| chunk[4 + k]);
            slot.committed = (facet != u32::MAX).then_some(facet);
            slot.kept = f64::from_le_bytes(kept);
            slot.strayed = chunk[12] != 0;
        }
        self.normal.load(normal);
        self.load_friction(friction);
        Ok(())
    }
}

impl ContactMethod for NodeToSurface {
    fn has_friction(&self) -> bool {
        self.friction.is_some()
    }

    fn candidates(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for slot in (0..self.slots.len()).filter(|&s| !active[s]) {
            if let Some(facet) = self.slots[slot].origin {
                let element = ElementNodes::new(self.node(slot), self.search.surface(), Pairing::single(facet));
                visit(element.list(), &[slot as u32]);
            }
        }
    }

    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), ContactError> {
        let view = self.search.at(q_np1);
        let mut in_front = Vec::new();
        for slot in 0..self.slots.len() {
            let pairing = self.slots[slot].pairing.filter(|_| active[slot]);
            out[slot] = match pairing {
                Some(Pairing { end, .. }) => {
                    let gap = self.gap(slot, end, q_np1)?;
                    let slid_off = gap.outside() > self.search.options().overhang
                        && self.pair(&view, slot, q_np1, end).pairing.is_none();
                    if slid_off { f64::INFINITY } else { self.normal_complementarity(slot, gap.gap) }
                }
                None => {
                    let point = self.closest(&view, slot, q_np1);
                    let behind = point.gap < 0.0 && point.pairing.is_some_and(|p| self.came_from_behind(slot, p.facet));
                    let allowance = self.allowance(slot);
                    match behind {
                        true => f64::INFINITY,
                        false if allowance < 0.0 => self.gap_to_keep(slot, &point, q_np1) - allowance,
                        false => point.gap,
                    }
                }
            };
            if !active[slot] && out[slot] >= 0.0 && self.pieces(slot, q_np1).is_some() {
                in_front.push(slot);
            }
        }
        for (slot, _, gap) in self.jumps(q_np1, &in_front)? {
            out[slot] = gap;
        }
        Ok(())
    }

    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        let mut changes = 0;
        for (slot, facet) in self.wanted(q_np1, active)? {
            // A node that closes (again) always gets its facet.
            let first = self.slots[slot].pairing.is_none();
            if self.slots[slot].admits(facet) || first {
                self.set_end(slot, facet, q_np1)?;
                self.place_foot(slot);
                changes += 1;
            }
        }
        changes += self.relax(q_np1, active)? + self.rechoose_midpoint_facets(q_np1, active)?;
        for (slot, &active) in self.slots.iter_mut().zip(active) {
            if !active {
                // A released node that closes again is paired again.
                slot.pairing = None;
            }
        }
        Ok(changes)
    }

    fn augment(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        Ok(self.augment_normal(q_np1, pressures, active)? + self.augment_friction(q_np1, pressures, active)?)
    }
}
