//! Mortar contact as a contact method. Its friction is in `frictional`, `tangential` and `slip`.

use crate::MortarError;
use crate::candidates::{Candidates, SearchRange};
use crate::factors::Factors;
use crate::friction::SurfaceFriction;
use crate::options::{Force, Integrals, MortarOptions};
use crate::positions::Positions;
use crate::sides::{has_sharp_edges, rows, sheets, unit_normals};
use crate::slot::{Slot, Want};
use crate::state::{Integrated, Need, StepState, Surfaces, segmentation_error};
use crate::surfaces::{CheckExtent, SurfaceCoverage, SurfaceSegmentation, thickness};
use crate::tangential::Scratch;
use crate::weights::Integration;
use nalgebra::Vector3;
use stoss_contact::{
    Auxiliary, Constraint, ContactError, ContactMethod, ContactRule, ContactSurface, ContactWork, Coverage, FacetNodes,
    History, LocalContribution, Report, SlotReport, StepConfiguration, SurfaceTree, clear_inactive, multipliers_of,
};
use stoss_segmentation::{FacetSegmentation, GapRange};

/// How much farther than the step's reach facets are looked for along the slave's normal, in lengths of facets.
const MARGIN: f64 = 3.0;
/// How deep they are looked for where no depth is lost, in the same.
const DEPTH: f64 = 4.0;
/// Penetration at which points take no part any more, in lengths of slave facets, where a surface has sharp edges or both sides of its body: beyond that other sides
/// are.
const DEEPEST: f64 = 1.0;
/// A row of which less than this part of the reference area is opposite the master carries no multiplier in the step: the pressure would be a force divided by next
/// to nothing.
pub(crate) const CARRIED: f64 = 0.02;
/// A penetration at the start of a step that is less than this, in lengths of facets, is what the iteration left.
const NO_PENETRATION: f64 = 1e-11;
/// A node is free along its normal if the part of the normal in free components is longer than this; it would have to slide ten times the gap to close it.
const FREE_ALONG_NORMAL: f64 = 0.1;

/// Slave surface against master surface with one pressure (traction) for each side of a slave node and weighted gaps (theory/mortar#eq-gap) whose integrals move:
/// the weighted gap `Phi_A(q)` is a function of the positions alone, see theory/mortar#gap.
///
/// The constraint of a closed row is `Phi_A(q_np1) = 0` under every rule. Under [`ContactRule::EndPoint`] the force is `p grad Phi_A(q_np1)`, under
/// [`ContactRule::Midpoint`] and [`ContactRule::EnergyMomentum`] the discrete gradient about the middle of the step: it has neither resultant nor moment about `q_m`, for
/// any gap, and its work is the change of the weighted gap. So the energy changes by what closing gaps cost, `p Phi_A(q_n)`, and by nothing else.
///
/// A row of which less than a fiftieth is opposite the master at the start of a step carries no multiplier in it. A slave node whose motion along the normal is prescribed
/// beside free ones gets no multiplier ([`MortarContact::with_crosspoints`]).
#[derive(Clone, Debug)]
pub struct MortarContact {
    name: String,
    pub(crate) surfaces: Surfaces,
    /// Over the master.
    tree: SurfaceTree,
    pub(crate) options: MortarOptions,
    pub(crate) rule: ContactRule,
    step_size: f64,
    /// Stress per length, see [`MortarContact::with_stiffness`].
    pub(crate) stiffness: f64,
    /// Velocities at the start of the next step; empty if nobody told.
    velocity: Vec<f64>,
    pub(crate) step: StepState,
    /// At the end of the step, and at its middle where the rule asks for it. With frozen integrals both have the weights of the step.
    pub(crate) end: Integrated,
    pub(crate) middle: Integrated,
    pub(crate) friction: Option<SurfaceFriction>,
}

impl MortarContact {
    /// From facets (global nodes, numbered outward) and reference positions (`3 * nodes`).
    ///
    /// # Errors
    /// Empty or degenerate surfaces, shared nodes.
    pub fn new<S: Copy + Into<FacetNodes>, M: Copy + Into<FacetNodes>>(
        name: &str,
        slave_facets: &[S],
        master_facets: &[M],
        reference: &[f64],
        options: MortarOptions,
    ) -> Result<Self, ContactError> {
        let slave = ContactSurface::new("slave", slave_facets, reference)?;
        let master = ContactSurface::new("master", master_facets, reference)?;
        slave.check_disjoint(&master)?;
        let [normals, master_normals] = [&slave, &master].map(|surface| unit_normals(surface, reference));
        let sharp = has_sharp_edges(&slave, &normals) || has_sharp_edges(&master, &master_normals);
        let thinner = thickness(&slave, reference).min(thickness(&master, reference));
        let h = slave.length_scale();
        let factors = Factors {
            facing: true,
            deepest: if sharp || thinner.is_finite() { thinner.min(DEEPEST * h) } else { f64::INFINITY },
            nearness: if sharp { options.nearness / h } else { 0.0 },
        };
        let integration = Integration { space: options.space, rule: options.rule, factors };
        let (sheets, sheet_count) = sheets(&master, &master_normals);
        let rows = rows(&slave, &normals, sheet_count);
        let without = vec![false; slave.nodes().len()];
        Ok(Self {
            name: name.to_owned(),
            tree: SurfaceTree::new(&master, reference)?,
            surfaces: Surfaces { slave, master, rows, sheets, sheet_count, normals, without, integration },
            rule: ContactRule::EndPoint,
            step_size: 0.0,
            stiffness: 0.0,
            velocity: Vec::new(),
            step: StepState { q_n: reference.to_vec(), ..StepState::default() },
            end: Integrated::default(),
            middle: Integrated::default(),
            friction: None,
            options,
        })
    }

    /// Takes the multipliers of crosspoints away: slave nodes whose motion along their normal is prescribed, on facets that have other nodes too.
    /// `prescribed`: which components of a global node are. Their functions go to the other nodes of the facet: beside a finer master they would be
    /// harmless, beside a coarser one there would be more pressures than motions. A surface that is prescribed as a whole (a rigid tool) keeps its
    /// multipliers.
    #[must_use]
    pub fn with_crosspoints(mut self, prescribed: impl Fn(u32) -> [bool; 3]) -> Self {
        let slave = &self.surfaces.slave;
        let fixed: Vec<bool> =
            (slave.nodes().iter().enumerate()).map(|(a, &n)| self.is_held_along_normal(a, prescribed(n))).collect();
        let mut without = vec![false; fixed.len()];
        for node in 0..fixed.len() {
            let mut beside = slave.facets_around(node).iter().flat_map(|&f| slave.local_facets()[f as usize]);
            without[node] = fixed[node] && beside.any(|other| !fixed[other as usize]);
        }
        // A facet must keep a function to hand the others to.
        for facet in slave.local_facets() {
            if facet.iter().all(|&n| without[n as usize]) {
                facet.iter().for_each(|&n| without[n as usize] = false);
            }
        }
        self.surfaces.without = without;
        self
    }

    /// Tells the stress per length, Young's modulus over the length of a facet, that compliances are measured by. Without it there are none.
    #[must_use]
    pub fn with_stiffness(mut self, stiffness: f64) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Whether prescribed components leave a slave node (local number) no motion along its reference normal.
    pub fn is_held_along_normal(&self, local: usize, prescribed: [bool; 3]) -> bool {
        let sum = self.reference_normal(local);
        let free: f64 = (0..3).filter(|&i| !prescribed[i]).map(|i| sum[i] * sum[i]).sum();
        free.sqrt() <= FREE_ALONG_NORMAL * sum.norm()
    }

    /// The sum of the reference normals of the facets around a slave node.
    fn reference_normal(&self, local: usize) -> Vector3<f64> {
        let around = self.surfaces.slave.facets_around(local).iter();
        around.map(|&f| self.surfaces.normals[f as usize]).sum()
    }

    /// Whether a prescribed component takes a motion across the reference normal from a slave node (local number).
    pub fn is_held_across_normal(&self, local: usize, prescribed: [bool; 3]) -> bool {
        let n = self.reference_normal(local);
        (0..3).any(|i| prescribed[i] && n.norm_squared() - n[i] * n[i] > FREE_ALONG_NORMAL.powi(2) * n.norm_squared())
    }

    /// The slave surface.
    pub fn slave(&self) -> &ContactSurface {
        &self.surfaces.slave
    }

    /// The master surface.
    pub fn master(&self) -> &ContactSurface {
        &self.surfaces.master
    }

    /// Factors of the integrands of these surfaces.
    pub fn factors(&self) -> Factors {
        self.surfaces.integration.factors
    }

    /// Another choice of the factors, for tests and comparisons.
    #[must_use]
    pub fn with_factors(mut self, factors: Factors) -> Self {
        self.surfaces.integration.factors = factors;
        self
    }

    /// Segments at the end of the step, where integrals are there; `None` before the first step.
    pub fn segments(&self) -> Option<SurfaceSegmentation> {
        let range = self.step.range?;
        let facets: Option<Vec<FacetSegmentation>> = self.end.segments.iter().cloned().collect();
        facets.filter(|facets| !facets.is_empty()).map(|facets| SurfaceSegmentation { facets, range })
    }

    /// Covered part `int phi_A dA` of every slot, an area.
    pub fn supports(&self) -> Vec<f64> {
        self.end.slots.iter().map(|s| s.support).collect()
    }

    /// Coverage of the present segments, which are those at `q_np1`; `None` before the first step.
    ///
    /// # Errors
    /// Facets that cannot be segmented.
    pub fn coverage(&self, q_np1: &[f64]) -> Result<Option<SurfaceCoverage>, MortarError> {
        let present = self.segments();
        let check =
            |s: SurfaceSegmentation| s.check_with(&self.surfaces.master, Some(&self.tree), q_np1, CheckExtent::Near);
        present.map(check).transpose()
    }

    pub(crate) fn is_frozen(&self) -> bool {
        self.options.integrals == Integrals::Frozen
    }

    /// Whether forces are evaluated at the middle of the step.
    pub(crate) fn has_middle(&self) -> bool {
        matches!(self.rule, ContactRule::Midpoint | ContactRule::EnergyMomentum)
    }

    /// Slots whose weights friction has: those of the middle of the step, or of the end if the rule takes forces there.
    pub(crate) fn friction_slots(&self) -> &[Slot] {
        if self.has_middle() { &self.middle.slots } else { &self.end.slots }
    }

    pub(crate) fn length(&self) -> f64 {
        self.surfaces.slave.length_scale()
    }

    /// Pairs of facets that may meet within `reach` of `q`, and how far they were looked for.
    fn search(&self, tree: &SurfaceTree, q: &[f64], reach: f64) -> Result<(Candidates, SearchRange), ContactError> {
        let Surfaces { slave, master, integration, .. } = &self.surfaces;
        let h = slave.length_scale().max(master.length_scale());
        let range = SearchRange { depth: integration.factors.deepest.min(DEPTH * h), far: MARGIN * h, reach };
        let candidates = Candidates::find(slave, master, tree, q, range).map_err(|error| segmentation_error(&error))?;
        Ok((candidates, range))
    }

    /// Renews the slots of the end (and of the middle) at an iterate; tells whether stencils changed. Derivatives of `active` rows are there afterwards.
    fn follow(&mut self, q_np1: &[f64], active: &[bool], want_tangent: bool) -> Result<bool, ContactError> {
        let has = |of: &Integrated, at_all: bool| at_all && active.iter().zip(&of.derivatives).all(|(a, d)| *d || !*a);
        let at_end = self.step.is_at(q_np1, &self.end.at);
        let needs_end = want_tangent || self.rule == ContactRule::EndPoint || self.rule == ContactRule::EndPointMean;
        let end_done = at_end && (!needs_end || has(&self.end, at_end));
        let middle_done = !self.has_middle() || (at_end && has(&self.middle, !self.middle.derivatives.is_empty()));
        if end_done && middle_done {
            return Ok(false);
        }
        let Self { surfaces, step, .. } = &*self;
        let count = |slots: &[Slot]| -> Vec<usize> { slots.iter().map(|s| s.nodes.len()).collect() };
        let before = count(&self.end.slots);
        let with_facets = self.friction.is_some();
        let candidates = &step.candidates;
        let chosen: &[bool] = if needs_end { active } else { &[] };
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
            let needs = surfaces.needs(Need::Nothing, active);
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
        let after = count(&self.end.slots);
        Ok(before.iter().zip(&after).zip(active).any(|((a, b), active)| *active && a != b))
    }

    /// Gradients at the start of the step, for the rows that need them.
    fn follow_start(&mut self, active: &[bool]) -> Result<(), ContactError> {
        let missing: Vec<bool> =
            active.iter().zip(&self.step.gradient).map(|(active, gradient)| *active && gradient.is_empty()).collect();
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
            let evaluation = evaluation.ok_or(ContactError::NoNormal { node: slot.nodes[0] })?;
            gradients.push((k, slot.nodes.clone(), evaluation.gradient));
        }
        for (k, nodes, gradient) in gradients {
            // In the order of the slot at the end, which nodes are only added to.
            if !frozen {
                self.end.slots[k].widen(&nodes);
                if let Some(middle) = self.middle.slots.get_mut(k) {
                    middle.widen(&self.end.slots[k].nodes);
                }
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

impl Report for MortarContact {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length()
    }

    fn verify(&self, q_np1: &[f64]) -> Result<Coverage, ContactError> {
        if self.is_frozen() {
            return Ok(Coverage::default());
        }
        self.check_passage()?;
        let Some(coverage) = self.coverage(q_np1).map_err(|e| segmentation_error(&e))? else {
            return Ok(Coverage::default());
        };
        match coverage.faults.first() {
            None => Ok(Coverage { defect: coverage.worst }),
            Some(first) => Err(ContactError::Coverage {
                faults: coverage.faults.len(),
                facet: first.slave_facet,
                uncovered: first.uncovered_opposite,
                double: first.double,
                open_edges: first.open_edges,
            }),
        }
    }

    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        let fresh;
        let slots = if self.step.is_at(q, &self.end.at) && !self.is_frozen() {
            &self.end.slots
        } else {
            let mut tree = self.tree.clone();
            tree.update(&self.surfaces.master, q);
            let (candidates, _) = self.search(&tree, q, 0.0)?;
            let needs = self.surfaces.needs(Need::Value, &[]);
            fresh = self.surfaces.integrate(
                &candidates,
                q.into(),
                &needs,
                &self.surfaces.handing_over(None),
                &[],
                false,
            )?;
            &fresh.slots
        };
        let nodes = self.surfaces.slave.nodes();
        let rows = self.surfaces.rows.iter().zip(slots).enumerate();
        let report = rows.map(|(k, (row, slot))| {
            let there = slot.support > 1e-8 * row.area;
            let gap = if there { slot.gap(q).map(|gap| gap / slot.support) } else { None };
            let kept = self.step.reference.get(k).copied().unwrap_or(0.0);
            let of_law = gap.filter(|gap| self.options.overclosure.is_some() && *gap < 0.0);
            SlotReport {
                node: nodes[row.local],
                weight: row.area,
                per_current_area: 1.0,
                area: slot.support,
                gap,
                normal: if gap.is_some() { slot.normal(q).into() } else { [0.0; 3] },
                feature: if gap.is_some() { "face" } else { "none" },
                reference_gap: of_law.unwrap_or(if there { kept / slot.support } else { 0.0 }),
                friction: self.last_friction(k),
            }
        });
        Ok(report.collect())
    }
}

impl Constraint for MortarContact {
    fn slot_count(&self) -> usize {
        self.surfaces.rows.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.surfaces.rows[slot].area
    }

    fn set_rule(&mut self, rule: ContactRule, step_size: f64) {
        self.rule = rule;
        self.step_size = step_size;
        self.set_friction_step(step_size);
    }

    fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.surfaces.master.set_carriers(of);
        if self.surfaces.master.carriers().is_some() {
            self.tree.forget();
        }
    }

    fn set_velocity(&mut self, v_n: &[f64]) {
        self.velocity.clear();
        self.velocity.extend_from_slice(v_n);
    }

    fn begin_step(&mut self, q_n: &[f64], reach: f64) -> Result<(), ContactError> {
        let velocity = std::mem::take(&mut self.velocity);
        self.tree.update(&self.surfaces.master, q_n);
        let surfaces = &self.surfaces;
        let factors = self.factors();
        let (candidates, range) = self.search(&self.tree, q_n, reach)?;
        let values = surfaces.needs(Need::Value, &[]);
        let with_facets = self.friction.is_some();
        let crosspoints = surfaces.handing_over(None);
        let predicted = |part: f64| {
            let ahead = Positions::Ahead(q_n, part * self.step_size, &velocity);
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
        let hands_over = self.options.force == Force::HeldWeights && self.rule == ContactRule::EndPoint;
        let without = if hands_over { surfaces.handing_over(Some(&carried)) } else { crosspoints.clone() };
        if without != crosspoints {
            start = surfaces.integrate(&candidates, q_n.into(), &values, &without, &[], with_facets)?;
        }
        let (frozen, no_penetration) = (self.is_frozen(), NO_PENETRATION * surfaces.slave.length_scale());
        let weights = if frozen { middle.as_ref().unwrap_or(&start) } else { &start };
        let gap: Vec<Option<f64>> =
            weights.slots.iter().map(|slot| if slot.opposite > 0.0 { slot.gap(q_n) } else { None }).collect();
        let reference = gap.iter().zip(&surfaces.rows).map(|(gap, row)| match gap {
            Some(gap) if self.options.keeps_penetration && !frozen && *gap < -no_penetration * row.area => *gap,
            _ => 0.0,
        });
        let reference = reference.collect();
        let count = surfaces.rows.len();
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
            carried,
            without,
        };
        self.step.note(q_n, &mut self.end.at);
        self.begin_friction()
    }

    fn renew(
        &mut self,
        q_np1: &[f64],
        pressures: &[f64],
        auxiliaries: &[f64],
        active: &[bool],
        want_tangent: bool,
    ) -> Result<bool, ContactError> {
        self.keep_multipliers(auxiliaries);
        let carrying: Vec<bool> = active.iter().zip(&self.step.carried).map(|(a, c)| *a && *c).collect();
        let mut changed = !self.is_frozen() && self.follow(q_np1, &carrying, want_tangent)?;
        if self.rule != ContactRule::EndPoint {
            let before: Vec<usize> = self.end.slots.iter().map(|s| s.nodes.len()).collect();
            self.follow_start(&carrying)?;
            changed |= before.iter().zip(&self.end.slots).any(|(n, slot)| *n != slot.nodes.len());
        }
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

    /// Two multipliers of the friction, if stick is enforced by them: components in the frame of the node of what they add to the traction
    /// at the start.
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
        let mut out = LocalContribution { auxiliaries: further, ..LocalContribution::default() };
        let mut scratch = Scratch::default();
        for (k, slot) in self.end.slots.iter().enumerate().filter(|(k, _)| active[*k]) {
            out.slots.clear();
            out.slots.push(k as u32);
            out.nodes.clear();
            out.nodes.extend_from_slice(&slot.nodes);
            out.reset(want_tangent);
            let multiplier = multipliers_of(k, further, auxiliaries);
            let of_friction = self.friction_slots().get(k).filter(|slot| slot.support > 0.0);
            let carries = self.step.carried[k];
            if carries {
                self.contribute(k, step, pressures[k], want_tangent, &mut out)?;
            }
            let slides = carries && of_friction.is_some();
            if slides && !self.add_friction(k, step, pressures[k], multiplier, want_tangent, &mut scratch, &mut out) {
                return Err(ContactError::NoNormal { node: slot.nodes[0] });
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
            visit(&out);
        }
        Ok(())
    }
}

impl History for MortarContact {
    fn work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        let mut work = self.friction_work(q_np1, pressures, active);
        if let Some(stiffness) = self.options.overclosure {
            let closed = self.end.slots.iter().zip(pressures).zip(active).filter(|(_, active)| **active);
            work.stored += closed.map(|((slot, p), _)| 0.5 * slot.support * p * p / stiffness).sum::<f64>();
        }
        work.closing = self.has_middle().then(|| {
            let carrying = (0..self.slot_count()).filter(|&k| active[k] && self.step.carried[k]);
            let gaps = |k: usize| Some(self.step.gap[k].unwrap_or(0.0) - self.end.slots[k].gap(q_np1)?);
            carrying.filter_map(|k| Some(pressures[k] * gaps(k)?)).sum()
        });
        Ok(work)
    }

    fn commit(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        self.commit_friction(q_np1, pressures, active);
    }

    fn save_history(&self) -> Vec<u8> {
        self.save_friction()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        if bytes.len() != self.friction_history() {
            let reason = format!("{} bytes for {} slots", bytes.len(), self.slot_count());
            return Err(ContactError::History { reason });
        }
        self.load_friction(bytes);
        Ok(())
    }
}

impl ContactMethod for MortarContact {
    fn has_friction(&self) -> bool {
        self.friction.is_some()
    }

    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), ContactError> {
        let rows = self.surfaces.rows.iter().zip(&self.end.slots).enumerate();
        for ((k, (row, slot)), out) in rows.zip(out) {
            let there = self.step.carried[k] && slot.support > 0.0;
            let gap = if there { slot.gap(q_np1) } else { None };
            let area = slot.support.max(CARRIED * row.area);
            *out = gap.map_or(f64::INFINITY, |gap| (gap - self.step.reference[k]) / area);
            // The law gives a closed row the gap that its pressure asks for.
            if active[k] && self.options.overclosure.is_some() {
                *out = 0.0;
            }
            if gap.is_none() && self.step.carried[k] && active[k] {
                *out = 0.0;
            }
        }
        Ok(())
    }

    /// Rows that have come opposite the master since the start of the step carry multipliers from now on, if they are inside.
    fn repair(&mut self, q_np1: &[f64], _active: &[bool]) -> Result<usize, ContactError> {
        let mut changes = 0;
        if self.is_frozen() {
            return Ok(0);
        }
        let tolerance = NO_PENETRATION * self.length();
        for (k, row) in self.surfaces.rows.iter().enumerate() {
            let slot = &self.end.slots[k];
            if self.step.carried[k] || slot.support <= CARRIED * row.area {
                continue;
            }
            let inside = slot.gap(q_np1).is_some_and(|gap| gap < self.step.reference[k] - tolerance * row.area);
            self.step.carried[k] = inside;
            changes += usize::from(inside);
        }
        if changes > 0 && self.step.without != self.surfaces.handing_over(None) {
            // What they had handed over comes back to them.
            self.step.without = self.surfaces.handing_over(Some(&self.step.carried));
            self.end.at.clear();
        }
        Ok(changes)
    }

    fn augment(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        self.augment_friction(q_np1, pressures, active)
    }

    fn constraint_gradients(
        &self,
        q_np1: &[f64],
        active: &[bool],
        visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), ContactError> {
        let carrying: Vec<bool> = active.iter().zip(&self.step.carried).map(|(a, c)| *a && *c).collect();
        let StepState { candidates, without, .. } = &self.step;
        let needs = self.surfaces.needs(Need::Nothing, &carrying);
        let end = self.surfaces.integrate(candidates, q_np1.into(), &needs, without, &self.end.slots, false)?;
        for (k, slot) in end.slots.iter().enumerate().filter(|(k, slot)| carrying[*k] && slot.support > 0.0) {
            let evaluation = slot.evaluate(q_np1, slot.nodes.len(), Want::Gradient);
            let evaluation = evaluation.ok_or(ContactError::NoNormal { node: slot.nodes[0] })?;
            visit(k, &slot.nodes, &evaluation.gradient);
        }
        Ok(())
    }
}
