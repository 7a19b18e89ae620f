//! Storage of the global system: equations, patterns, scatter maps, mass, vectors. What is computed with it is in
//! [`crate::system`] and [`crate::problem`].

use crate::anchor::Anchor;
use crate::books::Works;
use crate::contributions::{Contributions, StencilList};
use crate::embedding::Transform;
use crate::mass_solve::MassSolver;
use crate::masses::{Masses, PartMass};
use crate::numbering::Numbering;
use crate::rows::{ClosedDiagonal, Rows};
use crate::stabilise::Stabilisation;
use crate::switches::Acting;
use crate::{Load, Model, PhaseTime, StepError};
use std::ops::Range;
use std::sync::Arc;
use stoss_fe_solid::{TangentTarget, Volumetric};
use stoss_integrators::Buffers;
use stoss_linalg::{LinalgError, LinearSolver, NONE, ScatterMap, SparsityPattern};
use stoss_term::{Auxiliary, Term as _};

/// Part of what a mass moves in a step under a force.
const RIGID_COMPLIANCE: f64 = 1e-3;

/// Everything of fixed size that a step needs, allocated once (contact parts: once a change of the contact pattern).
#[derive(Debug)]
pub(crate) struct System {
    pub numbering: Numbering,
    pub masses: Masses,
    /// Pattern of the solids alone, its scatter map (bodies' elements in order, then what loads follow, then parts).
    pub solid_pattern: Arc<SparsityPattern>,
    pub solid_map: ScatterMap,
    /// Stencils of each body, then of each part, in `solid_map`.
    pub force_stencils: Vec<Range<usize>>,
    /// Stencils of each load there.
    pub load_stencils: Vec<Range<usize>>,
    pub mass_values: Vec<f64>,
    pub solid_values: Vec<f64>,
    /// Pattern with the constraints that are or may become active, where each entry of the solids' pattern goes, and the scatter map of the
    /// active constraints. Without contact: the solids' pattern, and nothing.
    pub pattern: Arc<SparsityPattern>,
    pub solid_to_global: Vec<u32>,
    pub contact_map: ScatterMap,
    /// Equation of each slot of each contact pair, `NONE` if the pattern has none. That of an inactive slot says that its pressure
    /// stays, so that the pattern need not change with the active set. The equations of its
    /// auxiliaries follow.
    pub slot_equation: Vec<Vec<u32>>,
    /// Equations of a slot of each contact pair: one and those of its auxiliaries.
    pub slot_width: Vec<u32>,
    /// Positions of the diagonal entries of inactive slots, and the weights of the slots, see [`System::fill_inactive`]; infinity for a force row.
    pub inactive_diagonal: Vec<(u32, f64)>,
    /// Diagonal entries of closed slots of unilateral contact.
    pub closed_diagonal: Vec<ClosedDiagonal>,
    /// How rows of unilateral contact are scattered.
    pub rows: Rows,
    /// Largest stiffness on the diagonal when the step was first linearised.
    pub slot_stiffness: f64,
    /// What the pattern was made from.
    contributions: Contributions,
    /// With the active constraints; empty without contact: then the matrix is `solid_values`.
    pub values: Vec<f64>,
    pub solver: Box<dyn LinearSolver>,
    /// Made when a scheme first asks for it.
    pub mass_solver: Option<MassSolver>,
    pub stencils: StencilList,
    /// Label of the group of each vector that a part owns, from the first of them on.
    groups: Vec<u32>,
    first_grouped: u32,
    pub has_followers: bool,
    pub has_dead_loads: bool,
    /// Of a static stage.
    pub stabilisation: Option<Stabilisation>,
    /// Springs that hold what nothing holds yet.
    pub anchor: Option<Anchor>,
    /// Whether forces of dampers act on bodies at present.
    pub has_damping: bool,
    /// What of the model acts.
    pub acting: Acting,
    /// Whether the present stage has inertia.
    pub has_rates: bool,
    /// Residual and its terms, `3 * nodes` each. Those of embedded nodes are zero, but for the forces of contact on the nodes in `touched`.
    pub buffers: Buffers,
    /// Components of nodes that are not embedded, in ascending runs.
    pub own: Vec<Range<usize>>,
    /// Embedded nodes that have a force of contact.
    pub touched: Vec<u32>,
    /// Components that have forces of contact: those with equations and those of `touched`, ascending.
    pub support: Vec<Range<usize>>,
    /// Embedded nodes that have loads, and the components that loads act at: theirs, and those with equations.
    pub loaded: Vec<u32>,
    pub load_support: Vec<Range<usize>>,
    /// Dead loads of the step, empty if there are none (those that depend on the configuration go to `follower`).
    pub dead: Vec<f64>,
    /// Follower pressures, moments, centrifugal loads; empty without.
    pub follower: Vec<f64>,
    /// Largest norm of the forces that were summed up in the last evaluation.
    pub force_scale: f64,
    /// Largest constraint violation of the last evaluation, relative to an edge length.
    pub gap_measure: f64,
    /// Sum of the squares of the auxiliaries' force rows in the last evaluation.
    pub auxiliary_square: f64,
    /// Work of the forces of the last evaluation.
    pub works: Works,
    /// Time of contact contributions since somebody took it.
    pub contact_time: PhaseTime,
    /// What contact contributions add to the linear equations only; empty as long as none did.
    pub shift: Vec<f64>,
    /// Scratch for weighted local tangents.
    pub weighted: Vec<f64>,
    /// Scratch for local tangents of embedded nodes.
    pub transform: Transform,
    pub expanded: Vec<u32>,
    // Vectors of equations.
    pub rhs: Vec<f64>,
    pub increment: Vec<f64>,
    pub base_increment: Vec<f64>,
    /// Positions at which the linear equations were solved last in this step, if `has_linearised`; empty without mixed bodies.
    pub linearised: Vec<f64>,
    pub has_linearised: bool,
    pub base_pressures: Vec<Vec<f64>>,
    /// Auxiliaries of the iterate and their increments (of condensed ones only).
    pub base_auxiliaries: Vec<Vec<f64>>,
    pub auxiliary_increment: Vec<Vec<f64>>,
    /// Increment of all components, for pairs with condensed auxiliaries and those that limit motions; else empty.
    pub full_increment: Vec<f64>,
    /// Whether masses were made, if only of what cannot move at present.
    has_mass: bool,
    /// Whether rows of constraints in the last linear equations were written for the multipliers and not for their increments.
    pub shifts_rows: bool,
    /// Negative eigenvalues of the tangent of a static step that was factorised last, beyond those of its constraints.
    pub excess: usize,
    /// Evaluations with a tangent since the step began.
    pub tangents: u32,
    /// Smallest mass of a part, zero if none has any.
    part_mass: f64,
    /// Sum of nodal masses times an edge length, and of shear modulus times squared edge length, as force scales.
    pub mass_length: f64,
    pub stiffness_force: f64,
    /// Sum of shear modulus times volume of the bodies, and of force scale times length of the parts: the energy of a strain of one.
    pub strain_energy_scale: f64,
}

/// Label of a node for the linear solver: itself, or the cluster of a vector of a part.
fn label(groups: &[u32], first: u32, node: u32) -> u32 {
    node.checked_sub(first).and_then(|k| groups.get(k as usize)).copied().unwrap_or(node)
}

/// Ascending ranges of components, and those of nodes that are in none of them.
pub(crate) fn with_nodes(ranges: &[Range<usize>], nodes: &[u32]) -> Vec<Range<usize>> {
    let of_nodes = nodes.iter().map(|&node| 3 * node as usize..3 * node as usize + 3);
    let mut all: Vec<Range<usize>> = ranges.iter().cloned().chain(of_nodes).collect();
    all.sort_unstable_by_key(|range| range.start);
    all
}

/// Embedded nodes that loads act on, ascending.
fn loaded(model: &Model) -> Vec<u32> {
    let mut nodes: Vec<u32> = Vec::new();
    for load in &model.loads {
        load.stencils(&[], &mut |of, _| nodes.extend_from_slice(of));
    }
    nodes.retain(|&node| model.embedding.has(node));
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Zero for every auxiliary of every slot of every contact pair.
pub(crate) fn no_auxiliaries(model: &Model) -> Vec<Vec<f64>> {
    model.contacts.iter().map(|c| vec![0.0; c.term.slot_count() * c.term.auxiliaries().len()]).collect()
}

/// Whether a pair has auxiliaries without equations.
pub(crate) fn has_condensed(model: &Model) -> bool {
    model.contacts.iter().any(|c| c.term.auxiliaries().contains(&Auxiliary::Condensed))
}

impl System {
    /// With a mass matrix if `dynamic`, whether or not the present stage needs it.
    pub fn new(model: &Model, acting: Acting, dynamic: bool, solver: Box<dyn LinearSolver>) -> Result<Self, StepError> {
        let components = model.reference.len();
        let mut blocked = vec![true; components];
        for body in &model.bodies {
            for &node in body.solid.elements().iter().flatten() {
                blocked[3 * node as usize..3 * node as usize + 3].fill(false);
            }
        }
        for part in &model.parts {
            let own = part.own_vectors();
            blocked[3 * own.start as usize..3 * own.end as usize].fill(false);
        }
        for (prescription, _) in model.prescriptions.iter().zip(&acting.prescriptions).filter(|(_, acts)| **acts) {
            for &node in &prescription.nodes {
                for &component in &prescription.components {
                    blocked[3 * node as usize + component as usize] = true;
                }
            }
        }
        let numbering = Numbering::new(components, |c| blocked[c]);
        let mut solids = StencilList::default();
        let mut force_stencils = Vec::with_capacity(model.bodies.len() + model.parts.len());
        let mut body_masses = Vec::new();
        for body in &model.bodies {
            force_stencils.push(solids.push_term(&body.solid, &numbering));
            if let (true, Some(density)) = (dynamic, body.density) {
                let mass = body.mass(density);
                mass.stencils().for_each(|stencil| solids.push(|out| numbering.node_equations(stencil, out)));
                body_masses.push(mass);
            }
        }
        force_stencils.extend(model.parts.iter().map(|part| solids.push_term(&**part, &numbering)));
        // What does not follow has no tangent.
        let mut of_load = |load: &Load| if load.follows() { solids.push_term(load, &numbering) } else { 0..0 };
        let load_stencils = model.loads.iter().map(&mut of_load).collect();
        let has_followers = model.loads.iter().any(Load::follows);
        let has_dead_loads = model.loads.iter().any(|load| !load.follows());
        let part_masses: Vec<PartMass> =
            if dynamic { model.parts.iter().map(|part| PartMass::new(&**part)).collect() } else { Vec::new() };
        for &(i, j, _) in part_masses.iter().flat_map(|mass| &mass.entries) {
            solids.push(|out| numbering.node_equations(&[i, j][..if i == j { 1 } else { 2 }], out));
        }
        let first_grouped = model.parts.iter().map(|part| part.own_vectors().start).min().unwrap_or(u32::MAX);
        let last_grouped = model.parts.iter().map(|part| part.own_vectors().end).max().unwrap_or(0);
        let mut groups: Vec<u32> = (first_grouped.min(last_grouped)..last_grouped).collect();
        for part in &model.parts {
            for vector in part.own_vectors() {
                groups[(vector - first_grouped) as usize] = part.cluster(vector);
            }
        }
        let n = numbering.free.len();
        let labels = numbering.groups(|node| label(&groups, first_grouped, node));
        let solid_pattern = Arc::new(SparsityPattern::from_stencils(n, solids.iter())?.with_groups(labels)?);
        let solid_map = ScatterMap::new(&solid_pattern, solids.iter())?;
        let nnz = solid_pattern.nnz();
        let masses = Masses { bodies: body_masses, parts: part_masses };
        let mut mass_values = Vec::new();
        let (mut mass_length, mut stiffness_force, mut strain_energy_scale) = (0.0, 0.0, 0.0);
        if dynamic {
            mass_values = vec![0.0; nnz];
        }
        let mut of_bodies = masses.bodies.iter();
        for (b, body) in model.bodies.iter().enumerate() {
            let h = body.solid.characteristic_length();
            let shear = body.solid.law().small_strain_moduli().shear;
            stiffness_force += shear * h * h;
            strain_energy_scale += shear * body.solid.element_count() as f64 * h * h * h;
            if body.density.is_some()
                && let Some(mass) = of_bodies.next()
            {
                let (map, values, first_stencil) = (&solid_map, &mut mass_values[..], force_stencils[b].start);
                mass.add_to_tangent(1.0, TangentTarget { map, first_stencil, factor: 1.0, values });
                mass_length += mass.total() / (body.nodes.len().max(1) as f64) * h;
            }
        }
        for (part, mass) in model.parts.iter().zip(&masses.parts) {
            let total: f64 = mass.entries.iter().map(|&(i, j, m)| if i == j { m } else { 2.0 * m }).sum();
            mass_length += total / part.own_vectors().len().max(1) as f64 * part.length_scale();
            for &(i, j, m) in &mass.entries {
                for d in 0..3 {
                    let [a, b] = [i, j].map(|v| numbering.equation[3 * v as usize + d]);
                    for (row, column) in if i == j { [(a, b), (NONE, NONE)] } else { [(a, b), (b, a)] } {
                        // Entries of prescribed components have no place.
                        if let Some(at) = solid_pattern.position(row, column) {
                            mass_values[at] += m;
                        }
                    }
                }
            }
        }
        let positions = model.parts.iter().zip(&masses.parts).flat_map(|(part, mass)| {
            mass.entries.iter().filter(|&&(i, j, m)| i == j && m > 0.0 && !part.is_direction(i)).map(|&(_, _, m)| m)
        });
        let part_mass = Some(positions.fold(f64::INFINITY, f64::min)).filter(|m| m.is_finite()).unwrap_or(0.0);
        stiffness_force += model.parts.iter().map(|part| part.force_scale()).sum::<f64>();
        strain_energy_scale += model.parts.iter().map(|part| part.force_scale() * part.length_scale()).sum::<f64>();
        let slot_equation: Vec<Vec<u32>> =
            model.contacts.iter().map(|pair| vec![NONE; pair.term.slot_count()]).collect();
        let own = model.embedding.own(components);
        let loaded = loaded(model);
        let empty: [&[u32]; 0] = [];
        Ok(Self {
            contact_map: ScatterMap::new(&solid_pattern, empty.iter().copied())?,
            pattern: Arc::clone(&solid_pattern),
            solid_to_global: Vec::new(),
            values: Vec::new(),
            solid_values: vec![0.0; nnz],
            stencils: solids,
            touched: Vec::new(),
            support: if model.contacts.is_empty() { Vec::new() } else { own.clone() },
            load_support: with_nodes(&own, &loaded),
            loaded,
            buffers: Buffers::with_own(components, own.clone(), dynamic, !model.contacts.is_empty()),
            own,
            dead: vec![0.0; if has_dead_loads { components } else { 0 }],
            follower: vec![0.0; if has_followers { components } else { 0 }],
            force_scale: 0.0,
            gap_measure: 0.0,
            auxiliary_square: 0.0,
            works: Works::new(model.bodies.len() + model.parts.len(), model.contacts.len()),
            contact_time: PhaseTime::default(),
            shift: Vec::new(),
            weighted: Vec::new(),
            transform: Transform::default(),
            expanded: Vec::new(),
            groups,
            first_grouped,
            mass_solver: None,
            rhs: vec![0.0; n],
            increment: vec![0.0; n],
            base_increment: vec![0.0; components],
            linearised: if has_mixed(model) { model.reference.clone() } else { Vec::new() },
            has_linearised: false,
            base_pressures: slot_equation.iter().map(|s| vec![0.0; s.len()]).collect(),
            base_auxiliaries: no_auxiliaries(model),
            auxiliary_increment: no_auxiliaries(model),
            full_increment: vec![0.0; if has_condensed(model) || model.keeps_apart() { components } else { 0 }],
            numbering,
            masses,
            solid_pattern,
            solid_map,
            force_stencils,
            load_stencils,
            mass_values,
            slot_width: (model.contacts.iter())
                .map(|pair| 1 + Auxiliary::equations(pair.term.auxiliaries()) as u32)
                .collect(),
            slot_equation,
            inactive_diagonal: Vec::new(),
            closed_diagonal: Vec::new(),
            rows: Rows::default(),
            slot_stiffness: 0.0,
            contributions: Contributions::default(),
            solver,
            has_followers,
            has_dead_loads,
            stabilisation: None,
            anchor: None,
            has_damping: false,
            has_mass: dynamic,
            tangents: 0,
            excess: 0,
            shifts_rows: false,
            part_mass,
            acting,
            has_rates: dynamic,
            mass_length,
            stiffness_force,
            strain_energy_scale,
        })
    }

    /// Compliance of contact between rigid bodies, a length over a force. More nodes touch than three, and their multipliers are not determined: with this on the diagonals of
    /// the tangent, and not in the residual, the gaps close exactly and the multipliers are those of least norm (theory/multibody#redundancy). It is measured against the lightest body
    /// in dynamics, in statics against the present forces: they move an iterate by a small part of the `length` of an edge.
    pub fn rigid_compliance(&self, dt: f64, length: f64) -> f64 {
        let stiffness = if self.has_rates && dt > 0.0 && self.part_mass > 0.0 {
            self.part_mass / (dt * dt)
        } else {
            // Without forces what they would be; without anything elastic either there are none.
            let force = if self.force_scale > 0.0 { self.force_scale } else { self.stiffness_force };
            if force > 0.0 { force / length } else { 1.0 }
        };
        RIGID_COMPLIANCE / stiffness
    }

    /// Number of equations at present: free components, active pressures with their auxiliaries.
    pub fn equations(&self) -> usize {
        self.pattern.n()
    }

    /// Entries of the matrix at present.
    pub fn matrix_entries(&self) -> usize {
        self.pattern.nnz()
    }

    /// Bytes of the arrays held here and by the solver.
    pub fn memory_bytes(&self) -> usize {
        let floats = self.values.capacity()
            + self.solid_values.capacity()
            + self.mass_values.capacity()
            + self.dead.capacity()
            + self.follower.capacity()
            + self.base_increment.capacity()
            + self.linearised.capacity()
            + 2 * self.rhs.capacity();
        8 * floats
            + self.buffers.memory_bytes()
            + self.solid_pattern.memory_bytes()
            + self.pattern.memory_bytes()
            + self.solid_map.memory_bytes()
            + self.contact_map.memory_bytes()
            + self.solver.memory_bytes()
    }

    /// Takes the stiffness of constraints out of the assembled matrix: the block of the free components is that of solids and parts again.
    pub fn drop_constraint_stiffness(&mut self) {
        let free = self.numbering.free.len();
        for column in 0..free {
            let range = self.pattern.column_range(column);
            let rows = self.pattern.column(column).iter();
            self.values[range].iter_mut().zip(rows).filter(|(_, row)| **row < free).for_each(|(value, _)| *value = 0.0);
        }
        for (value, &at) in self.solid_values.iter().zip(&self.solid_to_global) {
            self.values[at as usize] = *value;
        }
    }

    /// True if a mass matrix exists.
    pub fn has_mass(&self) -> bool {
        self.has_mass
    }

    /// Pattern and maps for a step that begins with this active set: with room for all candidates. What earlier steps left in the pattern is
    /// dropped, because it would show in the last bits, and a run that is resumed knows nothing of it.
    pub fn begin_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        self.tangents = 0;
        let present = Contributions::active(model, active);
        let mut all = Contributions::default();
        all.append(&present);
        for (c, pair) in model.couplings() {
            pair.term.candidates(&active[c], &mut |nodes, slots| all.push(model, c, nodes, slots));
        }
        if all != self.contributions || self.solid_to_global.is_empty() {
            self.set_pattern(model, all)?;
        }
        self.set_contact_map(model, &present, active)
    }

    /// Maps for the present active set and pairings. The pattern grows if it has no room for them, else it stays as it is.
    pub fn renew_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        let present = Contributions::active(model, active);
        match self.set_contact_map(model, &present, active) {
            Err(StepError::Linear(LinalgError::EntryNotInPattern { .. })) => {}
            result => return result,
        }
        let mut all = std::mem::take(&mut self.contributions);
        all.append(&present);
        self.set_pattern(model, all)?;
        self.set_contact_map(model, &present, active)
    }

    /// The pattern of solids and contributions, with an equation for each slot.
    fn set_pattern(&mut self, model: &Model, contributions: Contributions) -> Result<(), StepError> {
        self.slot_equation.iter_mut().for_each(|equations| equations.fill(NONE));
        for (pair, _, slots) in contributions.iter() {
            slots.iter().for_each(|&slot| self.slot_equation[pair][slot as usize] = 0);
        }
        let free = self.numbering.free.len();
        let mut next = free as u32;
        for (pair, equations) in self.slot_equation.iter_mut().enumerate() {
            for equation in equations.iter_mut().filter(|equation| **equation != NONE) {
                *equation = next;
                next += self.slot_width[pair];
            }
        }
        let n = next as usize;
        // A pressure and its auxiliaries belong to the node of the slot: the method names it, or it is the first one of the contribution that names the slot first. Others may depend
        // on it, and name it later.
        let label = |node| label(&self.groups, self.first_grouped, node);
        let mut groups = self.numbering.groups(label);
        groups.resize(n, NONE);
        for own in [true, false] {
            for (pair, nodes, slots) in contributions.iter() {
                for &slot in if own { &slots[..slots.len().min(1)] } else { slots } {
                    let first = self.slot_equation[pair][slot as usize] as usize;
                    for group in &mut groups[first..first + self.slot_width[pair] as usize] {
                        if *group == NONE {
                            let named = model.contacts[pair].term.slot_node(slot as usize);
                            *group = named.or(nodes.first().copied()).map_or(NONE, label);
                        }
                    }
                }
            }
        }
        let contact = contributions.stencils(&self.numbering, &self.slot_equation, &self.slot_width);
        let pattern = SparsityPattern::from_stencils(n, self.stencils.iter().chain(contact.iter()))?;
        let pattern = Arc::new(pattern.with_groups(groups)?.with_first_multiplier(free));
        self.solid_to_global.clear();
        for column in 0..free {
            // Both row lists are sorted and the solids' rows are all in the larger pattern.
            let (rows, range) = (pattern.column(column), pattern.column_range(column));
            let mut at = 0;
            for &row in self.solid_pattern.column(column) {
                while rows[at] < row {
                    at += 1;
                }
                self.solid_to_global.push((range.start + at) as u32);
            }
        }
        self.values.resize(pattern.nnz(), 0.0);
        self.rhs.resize(n, 0.0);
        self.increment.resize(n, 0.0);
        self.pattern = pattern;
        self.contributions = contributions;
        Ok(())
    }

    /// Where the entries of the active contributions go; [`LinalgError::EntryNotInPattern`] if the pattern has no room for them.
    fn set_contact_map(
        &mut self,
        model: &Model,
        present: &Contributions,
        active: &[Vec<bool>],
    ) -> Result<(), StepError> {
        for (stencil, (pair, _, slots)) in present.iter().enumerate() {
            if slots.iter().any(|&slot| self.slot_equation[pair][slot as usize] == NONE) {
                return Err(LinalgError::EntryNotInPattern { stencil, row: NONE, column: NONE }.into());
            }
        }
        let stencils = present.stencils(&self.numbering, &self.slot_equation, &self.slot_width);
        self.contact_map = ScatterMap::new(&self.pattern, stencils.iter())?;
        self.inactive_diagonal.clear();
        self.set_closed_diagonal(model, active)?;
        for ((equations, active), pair) in self.slot_equation.iter().zip(active).zip(&model.contacts) {
            let slots = equations.iter().zip(active).enumerate();
            for (slot, (&first, _)) in slots.filter(|&(_, (&first, &active))| first != NONE && !active) {
                let weight = pair.term.slot_weight(slot);
                let of_auxiliaries = pair.term.auxiliaries().iter().filter_map(|kind| match kind {
                    Auxiliary::Condensed => None,
                    Auxiliary::Balance => Some(f64::INFINITY),
                    _ => Some(weight),
                });
                for (equation, weight) in (first..).zip(std::iter::once(weight).chain(of_auxiliaries)) {
                    let missing = LinalgError::EntryNotInPattern { stencil: 0, row: equation, column: equation };
                    let position = self.pattern.position(equation, equation).ok_or(missing)?;
                    self.inactive_diagonal.push((position as u32, weight));
                }
            }
        }
        Ok(())
    }
}

/// Whether a body has averaged changes of volume.
fn has_mixed(model: &Model) -> bool {
    model.bodies.iter().any(|body| body.solid.options().volumetric == Volumetric::Mixed)
}
