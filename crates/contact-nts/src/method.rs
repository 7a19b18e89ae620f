//! Node-to-surface contact as a contact method.

use crate::crossing::{Crossing, MAX_NODES};
use crate::invariants;
use crate::kinematics::{Gap, LOCAL, Local, points};
use crate::slot::{ElementNodes, Slot};
use nalgebra::Vector3;
use stoss_contact::{
    ContactError, ContactMethod, ContactRule, ContactSurface, LocalContribution, MasterPoint, MasterSearch,
    SearchOptions, SearchView, SlotReport, StepConfiguration,
};
use stoss_geometry::BilinearPatch;

/// How far the foot at `n` may lie on the extension of the facet that a node closes on, in convective coordinates: up to one
/// facet beyond the edge the bilinear extension is still the same surface; farther off the crossing element is used.
const MODEST_EXTENSION: f64 = 2.0;

/// Changes of facet of one node in one step after which it stays where it is. A node in a valley or on a ridge can be sent to and fro
/// between two facets for ever; its distance to the facet not chosen is then of the second order in the overshoot, and the
/// next step starts from there.
const MAX_SWITCHES: u32 = 4;

/// A node that moves farther than this relative to the master in a step (in multiples of the facets' length) without
/// being found behind the surface is followed along its path, so that it cannot jump through.
const UNCHECKED_MOTION: f64 = 0.5;

/// What is kept zero while a node is closed (formulation §9.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConstraintForm {
    /// `g_np1 = 0`: energy changes in the step in which a node closes.
    #[default]
    Standard,
    /// `g_np1 = g_n`: energy is exact, nodes float at the gap that they had and bounce.
    Modified,
}

/// Options of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeToSurfaceOptions {
    /// Constraint while closed.
    pub constraint: ConstraintForm,
    /// Tolerances of the search.
    pub search: SearchOptions,
}

/// Slave nodes against master facets, frictionless, one pressure (traction on the node's reference area) a slave node.
#[derive(Clone, Debug)]
pub struct NodeToSurface {
    name: String,
    slave: ContactSurface,
    search: MasterSearch,
    constraint: ConstraintForm,
    slots: Vec<Slot>,
    /// Positions at `n`, for nodes that jump.
    q_n: Vec<f64>,
    /// A typical edge of the master.
    length: f64,
}

fn position(q: &[f64], node: u32) -> Vector3<f64> {
    let k = 3 * node as usize;
    Vector3::new(q[k], q[k + 1], q[k + 2])
}

fn local(q: &[f64], nodes: &[u32]) -> Local {
    let mut out = [0.0; LOCAL];
    for (block, &node) in out.chunks_exact_mut(3).zip(nodes) {
        block.copy_from_slice(&q[3 * node as usize..3 * node as usize + 3]);
    }
    out
}

impl NodeToSurface {
    /// From facets (global nodes, numbered outward) and reference positions (`3 * nodes`).
    ///
    /// # Errors
    /// Empty or degenerate surfaces, shared nodes, options out of range.
    pub fn new(
        name: &str,
        slave_facets: &[[u32; 4]],
        master_facets: &[[u32; 4]],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        let slave = ContactSurface::new("slave", slave_facets, reference)?;
        let master = ContactSurface::new("master", master_facets, reference)?;
        slave.check_disjoint(&master)?;
        let length = master.length_scale();
        let slots = vec![Slot { gap_n: f64::INFINITY, ..Slot::default() }; slave.nodes().len()];
        Ok(Self {
            name: name.to_owned(),
            search: MasterSearch::new(master, reference, options.search)?,
            constraint: options.constraint,
            slots,
            q_n: Vec::new(),
            length,
            slave,
        })
    }

    fn node(&self, slot: usize) -> u32 {
        self.slave.nodes()[slot]
    }

    fn patch(&self, facet: u32, q: &[f64]) -> BilinearPatch {
        self.search.surface().patch(facet, q)
    }

    /// Projection of a slot's node on an extended facet.
    fn gap(&self, slot: usize, facet: u32, q: &[f64]) -> Result<Gap, ContactError> {
        let node = self.node(slot);
        Gap::project(&position(q, node), &self.patch(facet, q), [0.0, 0.0])
            .ok_or(ContactError::Projection { node, facet })
    }

    fn closest(&self, view: &SearchView<'_>, slot: usize, q: &[f64]) -> MasterPoint {
        let normal = self.slave.node_normal(slot, q);
        view.closest(&position(q, self.node(slot)), Some(&normal))
    }

    fn pair(&self, view: &SearchView<'_>, slot: usize, q: &[f64], hint: Option<u32>) -> MasterPoint {
        let normal = self.slave.node_normal(slot, q);
        view.pair(&position(q, self.node(slot)), hint, Some(&normal))
    }

    /// The facet that a node went through between `n` and `n+1`, if it did: its path relative to the master is
    /// followed in steps shorter than half a facet.
    fn facet_crossed(&self, slot: usize, q_np1: &[f64], scratch: &mut Vec<f64>) -> Option<u32> {
        let start = self.slots[slot].start?;
        let node = self.node(slot);
        let facet = self.search.surface().facets()[start as usize];
        let mean = |q: &[f64]| facet.iter().map(|&n| position(q, n)).sum::<Vector3<f64>>() / 4.0;
        let relative = |q: &[f64]| position(q, node) - mean(q);
        let motion = (relative(q_np1) - relative(&self.q_n)).norm();
        let pieces = (motion / (UNCHECKED_MOTION * self.length)).ceil();
        if !(pieces > 1.0 && pieces.is_finite()) {
            return None;
        }
        let pieces = pieces.min(1000.0) as usize;
        for piece in 1..pieces {
            let s = piece as f64 / pieces as f64;
            scratch.clear();
            scratch.extend(self.q_n.iter().zip(q_np1).map(|(a, b)| a + s * (b - a)));
            let point = self.closest(&self.search.at(scratch), slot, scratch);
            if let Some(pairing) = point.pairing.filter(|_| point.gap < 0.0) {
                return Some(pairing.facet);
            }
        }
        None
    }

    /// Start and end facet of an active slot.
    fn facets(&self, slot: usize) -> Option<(u32, u32)> {
        let s = &self.slots[slot];
        let end = s.end?;
        Some((s.start.unwrap_or(end), end))
    }

    /// `g_n` that an active slot's constraint refers to.
    fn reference_gap(&self, slot: usize) -> f64 {
        match self.constraint {
            ConstraintForm::Standard => 0.0,
            ConstraintForm::Modified => self.slots[slot].gap_n,
        }
    }

    /// Decides against which facet the gap at `n` of a newly closed node is measured: the facet that it closes on, if the position
    /// at `n` projects on its near extension, so that the element with 17 invariants applies; otherwise the facet found at `n`.
    fn align_start(&mut self, slot: usize, end: u32) -> Result<(), ContactError> {
        if self.slots[slot].start == Some(end) {
            return Ok(());
        }
        let on_end = Gap::project(&position(&self.q_n, self.node(slot)), &self.patch(end, &self.q_n), [0.0, 0.0]);
        match on_end {
            Some(gap) if gap.outside() <= MODEST_EXTENSION => {
                self.slots[slot].start = Some(end);
                self.slots[slot].gap_n = gap.gap;
            }
            _ if self.slots[slot].start.is_none() => {
                return Err(ContactError::Projection { node: self.node(slot), facet: end });
            }
            _ => {}
        }
        Ok(())
    }

    /// Gap gradient of the rule and its derivative, over the element's nodes.
    fn gradient(
        &self,
        slot: usize,
        element: &ElementNodes,
        facets: (u32, u32),
        end: &Gap,
        step: StepConfiguration<'_>,
        work: &mut Work,
    ) -> Result<(), ContactError> {
        let n = 3 * element.count;
        let (start, facet) = facets;
        let node = self.node(slot);
        let failed = ContactError::Projection { node, facet };
        work.gradient[..n].fill(0.0);
        work.tangent.clear();
        work.tangent.resize(n * n, 0.0);
        if step.rule == ContactRule::EndPoint {
            work.set(&end.gradient, &end.hessian(), n, 1.0);
            return Ok(());
        }
        let (q_n, q_1) = (local(step.q_n, &element.nodes[..5]), local(step.q_np1, &element.nodes[..5]));
        let q_mid: Local = std::array::from_fn(|k| 0.5 * (q_n[k] + q_1[k]));
        if start == facet {
            if step.rule == ContactRule::EnergyMomentum {
                let (x, patch) = points(&q_n);
                let gap_n = Gap::project(&x, &patch, end.xi).ok_or_else(|| failed.clone())?;
                let (g, k) =
                    invariants::discrete_gradient_and_tangent(&q_n, &q_1, &gap_n, end, self.length).ok_or(failed)?;
                work.set(&g, &k, n, 1.0);
            } else {
                let (x, patch) = points(&q_mid);
                let mid = Gap::project(&x, &patch, end.xi).ok_or(failed)?;
                work.set(&mid.gradient, &mid.hessian(), n, 0.5);
            }
            return Ok(());
        }
        let (mut q_0, mut q_1) = ([0.0; 3 * MAX_NODES], [0.0; 3 * MAX_NODES]);
        for (k, &node) in element.list().iter().enumerate() {
            let at = 3 * node as usize;
            q_0[3 * k..3 * k + 3].copy_from_slice(&step.q_n[at..at + 3]);
            q_1[3 * k..3 * k + 3].copy_from_slice(&step.q_np1[at..at + 3]);
        }
        let mid_on = |facet: &[usize; 4]| {
            let mut q = [0.0; LOCAL];
            for (block, node) in [0, facet[0], facet[1], facet[2], facet[3]].into_iter().enumerate() {
                for i in 0..3 {
                    q[3 * block + i] = 0.5 * (q_0[3 * node + i] + q_1[3 * node + i]);
                }
            }
            let (x, patch) = points(&q);
            Gap::project(&x, &patch, [0.0, 0.0])
        };
        // The facet whose interior the midpoint is deeper in; both choices conserve the same.
        let candidates = [(mid_on(&element.end), &element.end), (mid_on(&element.start), &element.start)];
        let mid = candidates
            .iter()
            .filter_map(|(gap, nodes)| gap.as_ref().map(|g| (g, *nodes)))
            .min_by(|a, b| a.0.outside().total_cmp(&b.0.outside()))
            .ok_or(failed)?;
        Crossing {
            q_n: &q_0[..n],
            q_np1: &q_1[..n],
            gap_n: self.slots[slot].gap_n,
            end: (end, &element.end),
            mid,
            length: self.length,
            exact_work: step.rule == ContactRule::EnergyMomentum,
        }
        .evaluate(&mut work.gradient[..n], &mut work.tangent);
        Ok(())
    }
}

/// Gap gradient and tangent of one slot.
struct Work {
    gradient: [f64; 3 * MAX_NODES],
    tangent: Vec<f64>,
}

impl Work {
    fn set(&mut self, gradient: &Local, tangent: &[Local; LOCAL], n: usize, factor: f64) {
        self.gradient[..LOCAL].copy_from_slice(gradient);
        for (i, row) in tangent.iter().enumerate() {
            for (j, k) in row.iter().enumerate() {
                self.tangent[i * n + j] = factor * k;
            }
        }
    }
}

impl ContactMethod for NodeToSurface {
    fn name(&self) -> &str {
        &self.name
    }

    fn slot_count(&self) -> usize {
        self.slots.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.slave.nodal_areas()[slot]
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn begin_step(&mut self, q_n: &[f64], reach: f64) -> Result<(), ContactError> {
        self.q_n.clear();
        self.q_n.extend_from_slice(q_n);
        self.search.update(q_n, reach);
        for slot in 0..self.slots.len() {
            let committed = self.slots[slot].committed;
            let (start, gap_n) = match committed {
                // A node in contact keeps the facet and the gap that its last step ended with.
                Some(facet) => (Some(facet), self.gap(slot, facet, q_n)?.gap),
                None => {
                    let point = self.closest(&self.search.at(q_n), slot, q_n);
                    match point.pairing {
                        Some(pairing) => (Some(pairing.facet), point.gap),
                        None => (None, f64::INFINITY),
                    }
                }
            };
            self.slots[slot] = Slot { committed, start, gap_n, end: committed, switches: 0 };
        }
        Ok(())
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            if let Some((start, end)) = self.facets(slot) {
                let element = ElementNodes::new(self.node(slot), self.search.surface(), start, end);
                visit(element.list(), &[slot as u32]);
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
        let mut contribution = LocalContribution::default();
        let mut work = Work { gradient: [0.0; 3 * MAX_NODES], tangent: Vec::new() };
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let Some((start, facet)) = self.facets(slot) else { continue };
            let element = ElementNodes::new(self.node(slot), self.search.surface(), start, facet);
            let end = self.gap(slot, facet, step.q_np1)?;
            self.gradient(slot, &element, (start, facet), &end, step, &mut work)?;
            let (n, weight) = (3 * element.count, self.slot_weight(slot));
            let pressure = pressures[slot];
            contribution.nodes.clear();
            contribution.nodes.extend_from_slice(element.list());
            contribution.slots.clear();
            contribution.slots.push(slot as u32);
            contribution.reset(want_tangent);
            for (r, g) in contribution.residual.iter_mut().zip(&work.gradient[..n]) {
                *r = -weight * pressure * g;
            }
            contribution.residual[n] = -weight * (end.gap - self.reference_gap(slot));
            if want_tangent {
                let dim = n + 1;
                for i in 0..n {
                    for j in 0..n {
                        contribution.tangent[i * dim + j] = -weight * pressure * work.tangent[i * n + j];
                    }
                    contribution.tangent[i * dim + n] = -weight * work.gradient[i];
                }
                for j in 0..LOCAL {
                    // The end facet's nodes are the first five of the element.
                    contribution.tangent[n * dim + j] = -weight * end.gradient[j];
                }
            }
            visit(&contribution);
        }
        Ok(())
    }

    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), ContactError> {
        let view = self.search.at(q_np1);
        let mut scratch = Vec::new();
        for slot in 0..self.slots.len() {
            let end = self.slots[slot].end.filter(|_| active[slot]);
            out[slot] = match end {
                Some(facet) => {
                    let gap = self.gap(slot, facet, q_np1)?;
                    let slid_off = gap.outside() > self.search.options().overhang
                        && self.pair(&view, slot, q_np1, Some(facet)).pairing.is_none();
                    if slid_off { f64::INFINITY } else { gap.gap - self.reference_gap(slot) }
                }
                None => {
                    let gap = self.closest(&view, slot, q_np1).gap;
                    match if gap < 0.0 { None } else { self.facet_crossed(slot, q_np1, &mut scratch) } {
                        Some(facet) => self.gap(slot, facet, q_np1)?.gap,
                        None => gap,
                    }
                }
            };
        }
        Ok(())
    }

    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        let mut changes = 0;
        let mut scratch = Vec::new();
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let current = self.slots[slot].end;
            let wanted = match current {
                Some(facet) if self.gap(slot, facet, q_np1)?.outside() <= self.search.options().hysteresis => None,
                Some(facet) if self.slots[slot].switches < MAX_SWITCHES => {
                    let point = self.pair(&self.search.at(q_np1), slot, q_np1, Some(facet));
                    point.pairing.map(|p| p.facet)
                }
                Some(_) => None,
                None => {
                    let point = self.closest(&self.search.at(q_np1), slot, q_np1);
                    let behind = point.pairing.filter(|_| point.gap < 0.0).map(|p| p.facet);
                    behind
                        .or_else(|| self.facet_crossed(slot, q_np1, &mut scratch))
                        .or(point.pairing.map(|p| p.facet))
                        .or(self.slots[slot].start)
                }
            };
            let Some(facet) = wanted.filter(|&f| Some(f) != current) else { continue };
            if current.is_some() {
                self.slots[slot].switches += 1;
            }
            self.slots[slot].end = Some(facet);
            if self.slots[slot].committed.is_none() {
                self.align_start(slot, facet)?;
            }
            changes += 1;
        }
        for slot in (0..self.slots.len()).filter(|&s| !active[s]) {
            // A released node that closes again is paired anew.
            self.slots[slot].end = None;
        }
        Ok(changes)
    }

    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        let view = self.search.at(q);
        Ok((0..self.slots.len())
            .map(|slot| {
                let point = self.closest(&view, slot, q);
                SlotReport {
                    node: self.node(slot),
                    weight: self.slot_weight(slot),
                    gap: point.pairing.map(|_| point.gap),
                    normal: point.normal.into(),
                    feature: point.feature.name(),
                }
            })
            .collect())
    }

    fn commit(&mut self, _q_np1: &[f64], _pressures: &[f64], active: &[bool]) {
        for (slot, &active) in self.slots.iter_mut().zip(active) {
            slot.committed = slot.end.filter(|_| active);
        }
    }

    fn save_history(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(4 * self.slots.len());
        for slot in &self.slots {
            out.extend_from_slice(&slot.committed.unwrap_or(u32::MAX).to_le_bytes());
        }
        out
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        if bytes.len() != 4 * self.slots.len() {
            return Err(ContactError::History {
                reason: format!("{} bytes for {} slave nodes", bytes.len(), self.slots.len()),
            });
        }
        let facets = self.search.surface().facets().len() as u32;
        for (slot, chunk) in self.slots.iter_mut().zip(bytes.chunks_exact(4)) {
            let facet = u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
            if facet != u32::MAX && facet >= facets {
                return Err(ContactError::History { reason: format!("facet {facet} of {facets}") });
            }
            slot.committed = (facet != u32::MAX).then_some(facet);
        }
        Ok(())
    }
}
