//! Mortar contact as a contact method. Its friction is in `frictional`, `tangential` and `slip`.

use crate::frictional::SurfaceFriction;
use crate::kept::Closed;
use crate::opposite::{Counted, Overlap, Seen, Sides, at_sharp_edges, sheets, unit_normals};
use crate::slot::{NormalField, Slot, Work};
use crate::softening::Softening;
use crate::surfaces::{segment_shifted, thickness};
use crate::tangential::Scratch;
use crate::weights::{FacetWeights, Measure, facet_weights};
use crate::{CheckExtent, MortarError, MultiplierSpace, Quadrature, SurfaceCoverage, SurfaceSegmentation};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_contact::{
    Auxiliary, ContactError, ContactMethod, ContactRule, ContactSurface, ContactWork, Coverage, LocalContribution,
    SlotReport, StepConfiguration, clear_inactive, multipliers_of,
};
use stoss_segmentation::{FacetSegmentation, GapRange};

/// What is kept zero while a node is closed (formulation §9.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WeightedConstraint {
    /// `Phi_np1 = 0`.
    #[default]
    Standard,
    /// `Phi_np1 = Phi_n`, both with the integrals of the step: energy is exact, nodes float and bounce. Not with
    /// [`ContactRule::EndPoint`].
    Modified,
    /// `Phi_np1 = min(Phi_n, 0)`, both with the integrals of the step. When integrals are renewed at the start of a step, a closed node has a small gap
    /// of either sign; to set it to zero costs energy if it is open and *gives* energy if it is not. The latter is left out, so that sliding contact
    /// never gains energy; penetrations stay at what the renewals add up to.
    ///
    /// With [`ContactRule::EndPoint`], where integrals follow the iterate, a node that closes keeps the penetration that it had at the start of the step, and a
    /// closed one what it came to by another choice of what counts as contact at an edge. From then on it falls by a tenth a step (of full size): what would be thrown out at once is
    /// let out slowly.
    OneSided,
}

/// Options of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MortarOptions {
    /// Multiplier space of the pressures.
    pub space: MultiplierSpace,
    /// Rule and map of the integrals.
    pub quadrature: Quadrature,
    /// Normals of the weighted gaps.
    pub normals: NormalField,
    /// Constraint while closed.
    pub constraint: WeightedConstraint,
}

/// How deep a facet may be behind the master and still be opposite to it, in lengths of facets. What lies deeper is
/// another part of the body.
const DEPTH: f64 = 4.0;
/// Not deeper, either, than this times the sum of the thicknesses of both bodies, where both sides of both are in the surfaces: there the far sides face each
/// other, too.
const DEPTH_OF_THICKNESS: f64 = 0.25;
/// The same as [`DEPTH`] where integrals stay those of the start of the step: surfaces are not deep in each other there, and the far side of a thin or a hollow body
/// is not opposite.
const DEPTH_AT_START: f64 = 1.0;
/// How much farther than the step's reach facets are looked for, in lengths of facets.
const MARGIN: f64 = 2.0;
/// A slave node of whose reference area less than this is covered hands its multiplier over to the other nodes of its facets (the functions
/// still add up to one, so that constant pressures stay exact): a constraint on a sliver of the support would need pressures out of all
/// proportion, of either sign.
pub(crate) const HANDED_OVER: f64 = 0.05;
/// It takes it back above this. The distance of the two keeps it from flipping with the iterate.
const TAKEN_BACK: f64 = 0.1;
/// On a facet of which all nodes have small supports those with at least this part of the largest keep their multipliers.
const KEPT: f64 = 0.5;
/// A node is free along its normal if the part of the normal in free components is longer than this; it would have to slide ten times the gap to close it.
const FREE_ALONG_NORMAL: f64 = 0.1;

/// Integrals at one configuration.
#[derive(Clone, Debug)]
pub(crate) struct Integrated {
    segments: SurfaceSegmentation,
    /// Overlaps of every slave facet.
    pub(crate) overlaps: Vec<Vec<Overlap>>,
    pub(crate) slots: Vec<Slot>,
    /// Covered part of every slave node before functions were handed over, an area.
    bare_supports: Vec<f64>,
    /// Area of the segments that do not count.
    left_out: f64,
}

/// Slave surface against master surface with one pressure (traction) a slave node and weighted gaps (formulation §8.1).
///
/// Under [`ContactRule::EndPoint`] segmentation and integrals are renewed at every iterate, and the tangent has their
/// derivatives and those of the normals: Newton converges quadratically as long as no vertex of a segment passes an
/// edge. Under every other rule they stay for the whole step, and the slave is paired with what it will be opposite to in the middle
/// of the step if the velocities of `q_n` last (`slide`): had it the partners of `q_n`, forces and reactions would lie half the slide of the step apart,
/// and the angular momentum that is conserved would turn the slave over. As the integrals stay, the force of every rule is the gradient
/// of the weighted gap, so that it has neither resultant nor moment for any gap, and under
/// [`ContactRule::EnergyMomentum`] its work is the change of the weighted gaps (formulation §8.3; one director a slave
/// facet instead of one a segment, choice).
///
/// A node of which a part of the support is not covered keeps the weighted gap of the rest; below a twentieth of its reference area it hands
/// its function over to the other nodes of its facets (where integrals move and there is a stiffness for it, it fades instead:
/// [`MortarContact::with_softening`]), below 1e-8 it is out of contact. A slave node whose motion along the normal is prescribed
/// beside free ones gets no multiplier ([`MortarContact::with_crosspoints`]).
#[derive(Clone, Debug)]
pub struct MortarContact {
    name: String,
    pub(crate) slave: ContactSurface,
    pub(crate) master: ContactSurface,
    pub(crate) options: MortarOptions,
    /// Slave nodes without a multiplier, by local number.
    pub(crate) without: Vec<bool>,
    /// Covered part of slave nodes whose multiplier is handed over in this step because that is little, an area, by local number.
    handed_over: Vec<Option<f64>>,
    pub(crate) rule: ContactRule,
    range: GapRange,
    /// Depth from which facets behind are another part of the body, a length.
    deepest: f64,
    /// Whether a slave facet faces a master facet in the reference configuration.
    /// Unit normals of the slave facets in the reference configuration.
    reference_normals: Vec<Vector3<f64>>,
    /// Sides of the slave nodes.
    pub(crate) slave_sides: Sides,
    /// Which slave and master facets are at sharp edges of their surfaces.
    pub(crate) slave_edges: Vec<bool>,
    pub(crate) master_edges: Vec<bool>,
    /// The sheet between sharp edges that a master facet belongs to.
    pub(crate) master_sheets: Vec<u32>,
    /// What was seen in this step of slave facets and sheets.
    pub(crate) seen: BTreeMap<(usize, u32), Seen>,
    pub(crate) step_size: f64,
    /// Velocities at the start of the next step; empty if nobody told.
    told_velocity: Vec<f64>,
    /// The same of this step.
    pub(crate) velocity: Vec<f64>,
    /// The longest step that was asked for so far; a scene asks for its nominal one first.
    pub(crate) longest_step: f64,
    /// Half the slide of each slave facet in the step, a length; empty if there is none.
    slide: Vec<Vector3<f64>>,
    /// Positions at the start of the step.
    pub(crate) start: Vec<f64>,
    /// Positions that the integrals belong to; empty before the first step.
    at: Vec<f64>,
    pub(crate) integrated: Option<Integrated>,
    /// Slots whose derivatives are there.
    derivatives: Vec<bool>,
    /// Weighted gap at `q_n` with the integrals of the step over the support, a length each.
    pub(crate) gap_n: Vec<f64>,
    /// What each slot kept in the last step; `None` if it was open, or keeps nothing from step to step.
    pub(crate) closed: Vec<Option<Closed>>,
    pub(crate) friction: Option<SurfaceFriction>,
    pub(crate) softening: Option<Softening>,
}

/// Area of the segments of these facets.
fn segment_area<'a>(facets: impl Iterator<Item = &'a FacetSegmentation>) -> f64 {
    facets.flat_map(|found| &found.segments).map(|segment| segment.image_area()).sum()
}

fn segmentation_error(error: &MortarError) -> ContactError {
    ContactError::Segmentation { reason: error.to_string() }
}

impl MortarContact {
    /// From facets (global nodes, numbered outward) and reference positions (`3 * nodes`).
    ///
    /// # Errors
    /// Empty or degenerate surfaces, shared nodes.
    pub fn new(
        name: &str,
        slave_facets: &[[u32; 4]],
        master_facets: &[[u32; 4]],
        reference: &[f64],
        options: MortarOptions,
    ) -> Result<Self, ContactError> {
        let slave = ContactSurface::new("slave", slave_facets, reference)?;
        let master = ContactSurface::new("master", master_facets, reference)?;
        slave.check_disjoint(&master)?;
        let count = slave.nodes().len();
        let [reference_normals, master_normals] = [&slave, &master].map(|surface| unit_normals(surface, reference));
        let slave_sides = Sides::new(&slave, &reference_normals);
        let mut method = Self {
            name: name.to_owned(),
            without: vec![false; count],
            handed_over: vec![None; count],
            rule: ContactRule::EndPoint,
            range: GapRange::ALL,
            deepest: DEPTH_OF_THICKNESS * (thickness(&slave, reference) + thickness(&master, reference)),
            slave_edges: at_sharp_edges(&slave, &slave_sides),
            master_edges: at_sharp_edges(&master, &Sides::new(&master, &master_normals)),
            master_sheets: sheets(&master, &master_normals),
            slave_sides,
            reference_normals,
            seen: BTreeMap::new(),
            step_size: 0.0,
            told_velocity: Vec::new(),
            velocity: Vec::new(),
            longest_step: 0.0,
            slide: Vec::new(),
            start: reference.to_vec(),
            at: Vec::new(),
            integrated: None,
            derivatives: vec![false; count],
            gap_n: vec![0.0; count],
            closed: vec![None; count],
            friction: None,
            softening: None,
            slave,
            master,
            options,
        };
        method.range = method.range_for(0.0);
        Ok(method)
    }

    /// Takes the multipliers of crosspoints away: slave nodes whose motion along their normal is prescribed, on facets that have other nodes too.
    /// `prescribed`: which components of a global node are. Their functions go to the other nodes of the facet: beside a finer master they would be
    /// harmless, beside a coarser one there would be more pressures than motions. A surface that is prescribed as a whole (a rigid tool) keeps its
    /// multipliers.
    #[must_use]
    pub fn with_crosspoints(mut self, prescribed: impl Fn(u32) -> [bool; 3]) -> Self {
        let fixed: Vec<bool> = (self.slave.nodes().iter().enumerate())
            .map(|(a, &n)| self.is_held_along_normal(a, prescribed(n)))
            .collect();
        for node in 0..fixed.len() {
            let mut beside = self.slave.facets_around(node).iter().flat_map(|&f| self.slave.local_facets()[f as usize]);
            self.without[node] = fixed[node] && beside.any(|other| !fixed[other as usize]);
        }
        // A facet must keep a function to hand the others to.
        for facet in self.slave.local_facets() {
            if facet.iter().all(|&n| self.without[n as usize]) {
                facet.iter().for_each(|&n| self.without[n as usize] = false);
            }
        }
        self
    }

    /// Whether prescribed components leave a slave node (local number) no motion along its reference normal.
    pub fn is_held_along_normal(&self, local: usize, prescribed: [bool; 3]) -> bool {
        let around = self.slave.facets_around(local).iter();
        let sum: Vector3<f64> = around.map(|&f| self.reference_normals[f as usize]).sum();
        let free: f64 = (0..3).filter(|&i| !prescribed[i]).map(|i| sum[i] * sum[i]).sum();
        free.sqrt() <= FREE_ALONG_NORMAL * sum.norm()
    }

    /// The slave surface.
    pub fn slave(&self) -> &ContactSurface {
        &self.slave
    }

    /// The master surface.
    pub fn master(&self) -> &ContactSurface {
        &self.master
    }

    /// Segments that the present integrals belong to; `None` before the first step.
    pub fn segments(&self) -> Option<&SurfaceSegmentation> {
        self.integrated.as_ref().map(|i| &i.segments)
    }

    /// Covered part `int phi_A dA` of every slot, an area.
    pub fn supports(&self) -> Vec<f64> {
        self.integrated.iter().flat_map(|i| &i.slots).map(|s| s.support).collect()
    }

    /// Coverage of the present segments; `None` before the first step.
    ///
    /// # Errors
    /// Facets that cannot be segmented.
    pub fn coverage(&self) -> Result<Option<SurfaceCoverage>, MortarError> {
        let present = self.integrated.as_ref();
        present.map(|i| i.segments.check(&self.master, &self.at, CheckExtent::Near)).transpose()
    }

    fn range_for(&self, reach: f64) -> GapRange {
        let h = self.slave.length_scale().max(self.master.length_scale());
        let depth = if self.moves_integrals() { (DEPTH * h).min(self.deepest) } else { DEPTH_AT_START * h };
        GapRange { min: -depth, max: reach + MARGIN * h }
    }

    pub(crate) fn moves_integrals(&self) -> bool {
        self.rule == ContactRule::EndPoint && self.options.constraint != WeightedConstraint::Modified
    }

    fn directors(&self) -> bool {
        self.rule == ContactRule::EnergyMomentum
    }

    /// Segments and integrals at `q`, slave facets shifted by `slide`. `active`: slots that need derivatives. `old`: slots whose nodes stay.
    pub(crate) fn integrate(
        &self,
        q: &[f64],
        slide: &[Vector3<f64>],
        active: &[bool],
        old: &[Slot],
        measure: Measure,
    ) -> Result<Integrated, ContactError> {
        let segments =
            segment_shifted(&self.slave, &self.master, q, slide, self.range).map_err(|e| segmentation_error(&e))?;
        let Self { slave, master, options, .. } = self;
        let overlaps = self.overlaps(&segments);
        let opposite = self.opposite(&segments, &overlaps);
        let counted: Vec<Option<Counted<'_>>> = opposite
            .iter()
            .enumerate()
            .map(|(slave_facet, opposite)| opposite.then(|| self.counted(&segments, &overlaps, slave_facet)))
            .map(|counted| counted.filter(|counted| !counted.found.segments.is_empty()))
            .collect();
        let left_out =
            segment_area(segments.facets.iter()) - segment_area(counted.iter().flatten().map(|c| c.found.as_ref()));
        let weights = |measure| -> Vec<Option<FacetWeights>> {
            let of_facet = |(slave_facet, counted): (usize, &Option<Counted<'_>>)| {
                let nodes = &slave.local_facets()[slave_facet];
                let wanted = active.len() == self.without.len() && nodes.iter().any(|&n| active[n as usize]);
                let without = self.without_on(*nodes);
                let (space, rule) = (options.space, options.quadrature);
                let corners = |f| master.patch(f, q).corners;
                let Counted { found, part } = counted.as_ref()?;
                Some(facet_weights(found, corners, space, rule, measure, without, wanted).scaled(*part))
            };
            counted.iter().enumerate().map(of_facet).collect()
        };
        let facets = weights(measure);
        let mut bare_supports = vec![0.0; slave.nodes().len()];
        for (weights, nodes) in facets.iter().zip(slave.local_facets()) {
            for (support, &n) in weights.iter().flat_map(|w| w.bare_support).zip(nodes) {
                bare_supports[n as usize] += support;
            }
        }
        let normals = if measure == Measure::Parametric { NormalField::Facet } else { options.normals };
        let surfaces = [slave, master];
        let kept = |s| old.get(s).map_or(&[][..], |s: &Slot| &s.nodes);
        let sides = &self.slave_sides;
        let gather = |s| Slot::gather(s, surfaces, sides, &facets, normals, kept(s));
        let count = slave.nodes().len();
        let slots: Vec<Slot> = match (&self.friction, measure, normals) {
            // The groups of the pressures do.
            (None, ..) | (Some(_), Measure::Area, NormalField::Facet) => (0..count).map(gather).collect(),
            (Some(_), Measure::Area, NormalField::Averaged) => {
                (0..count).map(|s| gather(s).with_facets(s, surfaces, sides, &facets)).collect()
            }
            (Some(_), Measure::Parametric, _) => {
                let areas = weights(Measure::Area);
                (0..count).map(|s| gather(s).with_facets(s, surfaces, sides, &areas)).collect()
            }
        };
        Ok(Integrated { segments, overlaps, slots, bare_supports, left_out })
    }

    /// Which corners of a facet have no multiplier there. Where all would lose it to small supports, those of which most is covered keep it.
    fn without_on(&self, nodes: [u32; 4]) -> [bool; 4] {
        let covered = nodes.map(|n| self.handed_over[n as usize].filter(|_| !self.without[n as usize]));
        let is_small = |n: u32| self.without[n as usize] || self.handed_over[n as usize].is_some();
        if !nodes.iter().all(|&n| is_small(n)) {
            return nodes.map(is_small);
        }
        let largest = covered.iter().flatten().copied().fold(0.0, f64::max);
        covered.map(|covered| covered.is_none_or(|area| area < KEPT * largest))
    }

    /// Decides by the present integrals which multipliers are handed over; returns how many changed.
    fn hand_over_small_supports(&mut self) -> usize {
        let Some(integrated) = &self.integrated else { return 0 };
        let supports = integrated.bare_supports.iter().zip(&integrated.slots);
        let mut changes = 0;
        for (handed_over, (&support, slot)) in self.handed_over.iter_mut().zip(supports).filter(|(_, (s, _))| **s > 0.0)
        {
            let limit = if handed_over.is_some() { TAKEN_BACK } else { HANDED_OVER };
            let small = support < limit * slot.area;
            changes += usize::from(small != handed_over.is_some());
            *handed_over = small.then(|| handed_over.unwrap_or(support));
        }
        changes
    }

    pub(crate) fn slots(&self) -> &[Slot] {
        self.integrated.as_ref().map_or(&[], |i| &i.slots)
    }

    /// Renews the integrals at an iterate; tells whether stencils changed.
    fn follow(&mut self, q_np1: &[f64], active: &[bool], want_tangent: bool) -> Result<bool, ContactError> {
        let enough = !want_tangent || active.iter().zip(&self.derivatives).all(|(a, d)| *d || !*a);
        if enough && self.at == q_np1 {
            return Ok(false);
        }
        let wanted: &[bool] = if want_tangent { active } else { &[] };
        let new = self.integrate(q_np1, &[], wanted, self.slots(), Measure::Area)?;
        let pairs = new.slots.iter().zip(self.slots()).zip(active);
        let changed = pairs.filter(|(_, a)| **a).any(|((new, old), _)| new.nodes.len() != old.nodes.len());
        self.integrated = Some(new);
        self.remember_overlaps();
        self.derivatives.fill(false);
        if want_tangent {
            self.derivatives.copy_from_slice(active);
        }
        self.at.clear();
        self.at.extend_from_slice(q_np1);
        Ok(changed)
    }
}

impl ContactMethod for MortarContact {
    fn name(&self) -> &str {
        &self.name
    }

    fn slot_count(&self) -> usize {
        self.without.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.slave.nodal_areas()[slot]
    }

    fn length_scale(&self) -> f64 {
        self.slave.length_scale()
    }

    fn set_rule(&mut self, rule: ContactRule, step_size: f64) {
        self.rule = rule;
        self.step_size = step_size;
        self.longest_step = self.longest_step.max(step_size);
        self.set_friction_step(step_size);
    }

    fn set_velocity(&mut self, v_n: &[f64]) {
        self.told_velocity.clear();
        self.told_velocity.extend_from_slice(v_n);
    }

    fn begin_step(&mut self, q_n: &[f64], reach: f64) -> Result<(), ContactError> {
        self.range = self.range_for(reach);
        std::mem::swap(&mut self.velocity, &mut self.told_velocity);
        self.told_velocity.clear();
        self.start.clear();
        self.start.extend_from_slice(q_n);
        let measure = if self.directors() { Measure::Parametric } else { Measure::Area };
        // No memory of the last step: a run that is resumed has none.
        self.handed_over.fill(None);
        self.seen.clear();
        self.slide = self.half_slides(q_n)?;
        self.range.min -= self.slide.iter().map(Vector3::norm).fold(0.0, f64::max);
        self.integrated = Some(self.integrate(q_n, &self.slide, &[], &[], measure)?);
        self.remember_overlaps();
        if self.is_soft() {
            self.begin_softening();
        } else if self.hand_over_small_supports() > 0 {
            self.integrated = Some(self.integrate(q_n, &self.slide, &[], &[], measure)?);
        }
        let (directors, mut work) = (self.directors(), Work::default());
        for (gap, slot) in self.gap_n.iter_mut().zip(self.integrated.iter().flat_map(|i| &i.slots)) {
            *gap = slot.gap(q_n, directors, &mut work).map_or(f64::INFINITY, |g| g / slot.support);
        }
        self.derivatives.fill(false);
        self.at.clear();
        self.at.extend_from_slice(q_n);
        self.begin_friction(q_n)
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
        let changed = self.moves_integrals() && self.follow(q_np1, active, want_tangent)?;
        self.follow_softening(pressures, active);
        if want_tangent {
            self.follow_friction(q_np1, pressures, active);
        }
        Ok(changed)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let mut slots = Vec::new();
        for (k, slot) in self.slots().iter().enumerate().filter(|(k, _)| active[*k]) {
            slots.clear();
            slots.push(k as u32);
            self.push_partners(k, active, &mut slots);
            visit(&slot.nodes, &slots);
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
        let (mut work, mut scratch) = (Work::default(), Scratch::default());
        for (k, slot) in self.slots().iter().enumerate().filter(|(k, _)| active[*k]) {
            out.slots.clear();
            out.slots.push(k as u32);
            self.push_partners(k, active, &mut out.slots);
            out.nodes.clear();
            out.nodes.extend_from_slice(&slot.nodes);
            out.reset(want_tangent);
            let multiplier = multipliers_of(k, further, auxiliaries);
            if slot.support <= 0.0 {
                // The row `-A p = 0` keeps the system regular until the slot opens.
                let (n, weight) = (3 * slot.nodes.len(), self.slot_weight(k));
                let (dim, first) = (out.dim(), n + out.slots.len());
                out.residual[n] = -weight * pressures[k];
                for (row, value) in out.residual[first..].iter_mut().zip(&multiplier[..further]) {
                    *row = -weight * value;
                }
                for row in std::iter::once(n).chain(first..first + further).filter(|_| want_tangent) {
                    out.tangent[row * dim + row] = -weight;
                }
            } else {
                let kept = self.kept_gap(k, true);
                let reference = kept * slot.support;
                let there = slot.contribute(step, pressures[k], reference, want_tangent, &mut work, &mut out)
                    && self.add_friction(k, step, pressures[k], multiplier, want_tangent, &mut scratch, &mut out);
                if !there {
                    return Err(ContactError::NoNormal { node: slot.nodes[0] });
                }
                if want_tangent && kept != 0.0 {
                    let row = 3 * slot.nodes.len() * out.dim();
                    slot.for_each_support_derivative(|column, d| out.tangent[row + column] += kept * d);
                }
                self.soften(k, slot, pressures, active, want_tangent, &mut out);
            }
            visit(&out);
        }
        Ok(())
    }

    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), ContactError> {
        let mut work = Work::default();
        let directors = self.directors();
        for (k, (slot, out)) in self.slots().iter().zip(out).enumerate() {
            let gap = slot.gap(q_np1, directors, &mut work);
            let kept = self.kept_gap(k, active[k]) * slot.support;
            *out = gap.map_or(f64::INFINITY, |g| self.soft_gap(k, g - kept, slot.support));
        }
        Ok(())
    }

    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        let changes = if self.moves_integrals() && !self.is_soft() { self.hand_over_small_supports() } else { 0 };
        if changes > 0 {
            self.at.clear();
            self.follow(q_np1, active, true)?;
        }
        Ok(changes)
    }

    fn augment(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        self.augment_friction(q_np1, pressures, active)
    }

    fn work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        Ok(self.friction_work(q_np1, pressures, active))
    }

    fn commit(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        self.commit_friction(q_np1, pressures, active);
        self.commit_kept(q_np1, active);
    }

    fn save_history(&self) -> Vec<u8> {
        let mut bytes = self.save_friction();
        self.save_kept(&mut bytes);
        bytes
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        let count = self.closed.len();
        let kept = if bytes.len() == self.friction_history() { 0 } else { 16 * count };
        let Some(friction) = bytes.len().checked_sub(kept).filter(|friction| *friction == self.friction_history())
        else {
            let reason = format!("{} bytes for {count} slave nodes", bytes.len());
            return Err(ContactError::History { reason });
        };
        let (friction, kept) = bytes.split_at(friction);
        self.load_friction(friction);
        self.load_kept(kept);
        Ok(())
    }

    fn verify(&self) -> Result<Coverage, ContactError> {
        let Some(coverage) = self.coverage().map_err(|e| segmentation_error(&e))? else {
            return Ok(Coverage::default());
        };
        let left_out = self.integrated.as_ref().map_or(0.0, |i| i.left_out);
        match coverage.faults.first() {
            None => Ok(Coverage { defect: coverage.worst, left_out }),
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
        let (slots, directors) = if self.at == q && self.slide.is_empty() {
            (self.slots(), self.directors())
        } else {
            fresh = self.integrate(q, &[], &[], &[], Measure::Area)?;
            (fresh.slots.as_slice(), false)
        };
        let mut work = Work::default();
        Ok(slots
            .iter()
            .enumerate()
            .map(|(k, slot)| {
                let gap = slot.gap(q, directors, &mut work).map(|g| g / slot.support);
                SlotReport {
                    node: slot.nodes[0],
                    weight: self.slot_weight(k),
                    per_current_area: 1.0,
                    gap,
                    normal: if gap.is_some() { slot.normal(q) } else { [0.0; 3] },
                    feature: if gap.is_some() { "face" } else { "none" },
                    reference_gap: match gap {
                        Some(gap) if self.gives_way(k, slot.support, slot.area) => gap,
                        _ => self.kept_of(k),
                    },
                    friction: self.last_friction(k),
                }
            })
            .collect())
    }
}
