//! The matrix of the system: equations, patterns, scatter maps, values. What is added to it is in [`crate::system`].

use crate::contributions::{Contributions, StencilList};
use crate::groups::Groups;
use crate::inertia::Inertia;
use crate::numbering::Numbering;
use crate::rows::ClosedDiagonal;
use crate::shares::Shares;
use crate::{Load, Model, StepError};
use std::ops::Range;
use std::sync::Arc;
use stoss_fe_solid::TangentTarget;
use stoss_linalg::{LinalgError, NONE, ScatterMap, SparsityPattern};
use stoss_term::Auxiliary;

/// What no constraint enters: forces and masses. It stays as long as the numbering does.
#[derive(Debug)]
pub(crate) struct Fixed {
    pub pattern: Arc<SparsityPattern>,
    /// Scatter map of the stencils.
    pub map: ScatterMap,
    pub stencils: StencilList,
    /// Stencils of each body, then of each part.
    pub forces: Vec<Range<usize>>,
    /// Stencils of each load, if it has a tangent.
    pub loads: Vec<Range<usize>>,
    /// The mass matrix; empty without.
    pub mass: Vec<f64>,
    pub values: Vec<f64>,
}

impl Fixed {
    /// The fixed part with a place for each contribution of bodies, parts, loads that follow, and masses.
    fn new(model: &Model, numbering: &Numbering, groups: &Groups, inertia: &Inertia) -> Result<Self, StepError> {
        let shares = &inertia.masses.shares;
        let mut stencils = StencilList::default();
        let mut forces = Vec::with_capacity(model.bodies.len() + model.parts.len());
        let mut masses = inertia.masses.bodies.iter();
        for body in &model.bodies {
            // A body has the elements of this rank.
            forces.push(stencils.push_term(&body.solid, numbering, |_| true));
            // Those of its mass are behind its own.
            if let Some(mass) = masses.next() {
                mass.stencils().for_each(|nodes| stencils.push(|out| numbering.node_equations(nodes, out)));
            }
        }
        let is_own = |node| shares.has(node);
        forces.extend(model.parts.iter().map(|part| stencils.push_term(&**part, numbering, is_own)));
        // What does not follow has no tangent.
        let mut of_load = |load: &Load| if load.follows() { stencils.push_term(load, numbering, is_own) } else { 0..0 };
        let loads = model.loads.iter().map(&mut of_load).collect();
        for &(i, j, _) in inertia.masses.own_entries() {
            stencils.push(|out| numbering.node_equations(&[i, j][..if i == j { 1 } else { 2 }], out));
        }
        let labels = numbering.groups(|node| groups.label(node));
        let is_own = |equation: usize| shares.has(numbering.free[equation] / 3);
        let pattern = SparsityPattern::from_own_stencils(numbering.free.len(), stencils.iter(), is_own)?;
        let pattern = pattern.with_groups(labels)?;
        let (map, values) = (ScatterMap::new(&pattern, stencils.iter())?, vec![0.0; pattern.nnz()]);
        let mut fixed = Self { pattern: Arc::new(pattern), map, stencils, forces, loads, mass: Vec::new(), values };
        if inertia.exists {
            fixed.mass = vec![0.0; fixed.pattern.nnz()];
            fixed.add_masses(numbering, inertia);
        }
        Ok(fixed)
    }

    fn add_masses(&mut self, numbering: &Numbering, inertia: &Inertia) {
        for (mass, stencils) in inertia.masses.bodies.iter().zip(&self.forces) {
            let (map, values, first_stencil) = (&self.map, &mut self.mass[..], stencils.start);
            mass.add_to_tangent(1.0, TangentTarget { map, first_stencil, factor: 1.0, values });
        }
        for &(i, j, m) in inertia.masses.own_entries() {
            for d in 0..3 {
                let [a, b] = [i, j].map(|v| numbering.equation[3 * v as usize + d]);
                for (row, column) in if i == j { [(a, b), (NONE, NONE)] } else { [(a, b), (b, a)] } {
                    // Entries of prescribed components have no place.
                    if let Some(at) = self.pattern.position(row, column) {
                        self.mass[at] += m;
                    }
                }
            }
        }
    }

    /// `values <- factor M`.
    pub fn start(&mut self, factor: f64) {
        if self.mass.is_empty() {
            self.values.fill(0.0);
        }
        for (k, m) in self.values.iter_mut().zip(&self.mass) {
            *k = factor * m;
        }
    }
}

/// The diagonal of the first equations of a matrix of which each rank has a part; zero where there is none.
pub(crate) fn diagonal_of(pattern: &SparsityPattern, values: &[f64], count: usize, shares: &Shares) -> Vec<f64> {
    let value = |i| pattern.position(i, i).map_or(0.0, |at| values[at]);
    let mut diagonal: Vec<f64> = (0..count as u32).map(value).collect();
    shares.sum_all(&mut diagonal);
    diagonal
}

/// Where the slots of couplings are in the equations.
#[derive(Debug)]
pub(crate) struct Slots {
    /// Equation of each slot of each coupling, `NONE` if the pattern has none. That of an inactive slot says that its pressure
    /// stays, so that the pattern need not change with the active set. The equations of its
    /// auxiliaries follow.
    pub equation: Vec<Vec<u32>>,
    /// Equations of a slot of each coupling: one and those of its auxiliaries.
    pub width: Vec<u32>,
    /// Positions of the diagonal entries of inactive slots, and the weights of the slots, see [`Matrix::fill_inactive`]; infinity for a force row.
    pub inactive: Vec<(u32, f64)>,
    /// Diagonal entries of closed slots of unilateral contact, in rows of this rank.
    pub closed: Vec<ClosedDiagonal>,
    /// Whether there are such slots on any rank.
    pub has_closed: bool,
    /// Largest stiffness on the diagonal when the step was first linearised.
    pub stiffness: f64,
}

impl Slots {
    fn new(model: &Model) -> Self {
        let width = |pair: &crate::CouplingTerm| 1 + Auxiliary::equations(pair.term.auxiliaries()) as u32;
        Self {
            equation: model.contacts.iter().map(|pair| vec![NONE; pair.term.slot_count()]).collect(),
            width: model.contacts.iter().map(width).collect(),
            inactive: Vec::new(),
            closed: Vec::new(),
            has_closed: false,
            stiffness: 0.0,
        }
    }
}

/// The matrix.
#[derive(Debug)]
pub(crate) struct Matrix {
    /// The share of this rank: patterns and values are those of its contributions.
    pub shares: Arc<Shares>,
    pub numbering: Numbering,
    groups: Groups,
    pub fixed: Fixed,
    /// Pattern with the constraints that are or may become active. Without couplings: that of what is fixed.
    pub pattern: Arc<SparsityPattern>,
    /// Where each entry of what is fixed goes; empty without couplings.
    pub from_fixed: Vec<u32>,
    /// Scatter map of the active constraints.
    pub map: ScatterMap,
    /// Values with the active constraints; empty without couplings: then the matrix is what is fixed.
    pub values: Vec<f64>,
    pub slots: Slots,
    /// What the pattern was made from.
    contributions: Contributions,
    /// What the map was made from, if it is one of this pattern.
    mapped: Option<Contributions>,
}

impl Matrix {
    /// A matrix without constraints.
    pub fn new(model: &Model, numbering: Numbering, inertia: &Inertia) -> Result<Self, StepError> {
        let groups = Groups::new(model);
        let fixed = Fixed::new(model, &numbering, &groups, inertia)?;
        let empty: [&[u32]; 0] = [];
        Ok(Self {
            shares: Arc::clone(&inertia.masses.shares),
            pattern: Arc::clone(&fixed.pattern),
            from_fixed: Vec::new(),
            map: ScatterMap::new(&fixed.pattern, empty.iter().copied())?,
            values: Vec::new(),
            slots: Slots::new(model),
            contributions: Contributions::default(),
            mapped: None,
            numbering,
            groups,
            fixed,
        })
    }

    /// Number of equations of displacement components.
    pub fn free(&self) -> usize {
        self.numbering.free.len()
    }

    /// The values of the pattern.
    pub fn values(&self) -> &[f64] {
        if self.slots.equation.is_empty() { &self.fixed.values } else { &self.values }
    }

    /// The values of the pattern, to be changed.
    pub fn values_mut(&mut self) -> &mut [f64] {
        if self.slots.equation.is_empty() { &mut self.fixed.values } else { &mut self.values }
    }

    /// Whether this rank has the row of an equation of the pattern.
    pub fn is_own(&self, equation: usize) -> bool {
        self.shares.has(self.owner_label(equation))
    }

    /// The node, or label of a group, whose rank has the row of an equation.
    fn owner_label(&self, equation: usize) -> u32 {
        match self.numbering.free.get(equation) {
            Some(component) => component / 3,
            None => self.pattern.groups().map_or(NONE, |groups| groups[equation]),
        }
    }

    /// The rank that has the row of each equation.
    pub fn owners(&self) -> impl ExactSizeIterator<Item = u32> {
        (0..self.pattern.n()).map(|equation| self.shares.owner(self.owner_label(equation)))
    }

    /// Positions and values on the diagonal of the displacement components whose rows this rank has.
    pub fn diagonal(&self) -> impl Iterator<Item = (usize, f64)> {
        let own = (0..self.free()).filter(|&i| self.is_own(i)).map(|i| i as u32);
        let positions = own.filter_map(|i| self.pattern.position(i, i));
        positions.map(|at| (at, self.values()[at]))
    }

    /// Sum of the magnitudes on the diagonal of the displacement components.
    pub fn diagonal_sum(&self) -> f64 {
        diagonal_of(&self.pattern, self.values(), self.free(), &self.shares).iter().map(|value| value.abs()).sum()
    }

    /// Bytes of the arrays held here.
    pub fn memory_bytes(&self) -> usize {
        let Fixed { pattern, map, mass, values, .. } = &self.fixed;
        8 * (self.values.capacity() + values.capacity() + mass.capacity())
            + pattern.memory_bytes()
            + self.pattern.memory_bytes()
            + map.memory_bytes()
            + self.map.memory_bytes()
    }

    /// Begins the sum of constraints: the values are those of what is fixed.
    pub fn spread(&mut self) {
        self.values.fill(0.0);
        self.copy_fixed();
    }

    fn copy_fixed(&mut self) {
        for (value, &at) in self.fixed.values.iter().zip(&self.from_fixed) {
            self.values[at as usize] = *value;
        }
    }

    /// Takes the stiffness of constraints out again: the block of the free components is that of solids and parts.
    pub fn drop_constraint_stiffness(&mut self) {
        let free = self.free();
        for column in 0..free {
            let range = self.pattern.column_range(column);
            let rows = self.pattern.column(column).iter();
            self.values[range]
                .iter_mut()
                .zip(rows)
                .filter(|(_, row)| (**row as usize) < free)
                .for_each(|(value, _)| *value = 0.0);
        }
        self.copy_fixed();
    }

    /// Pattern and maps for a step that begins with this active set: with room for all candidates. What earlier steps left in the pattern is
    /// dropped, because it would show in the last bits, and a run that is resumed knows nothing of it.
    pub fn begin_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        let present = Contributions::active(model, active);
        let mut all = Contributions::default();
        all.append(&present);
        for (c, pair) in model.couplings() {
            pair.term.candidates(&active[c], &mut |nodes, slots| all.push(model, c, nodes, slots));
        }
        if all != self.contributions || self.from_fixed.is_empty() {
            self.set_pattern(model, all)?;
        }
        self.set_map(model, present, active)
    }

    /// Maps for the present active set and pairings. The pattern grows if it has no room for them, else it stays as it is.
    pub fn renew_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        let present = Contributions::active(model, active);
        let mapped = self.set_map(model, present.clone(), active);
        let lacks_room = matches!(mapped, Err(StepError::Linear(LinalgError::EntryNotInPattern { .. })));
        // If one rank has no room all make it: their lists stay the same.
        if !self.shares.any(lacks_room) {
            return mapped;
        }
        let mut all = std::mem::take(&mut self.contributions);
        all.append(&present);
        self.set_pattern(model, all)?;
        self.set_map(model, present, active)
    }

    /// The pattern of solids and contributions, with an equation for each slot.
    fn set_pattern(&mut self, model: &Model, contributions: Contributions) -> Result<(), StepError> {
        let Slots { equation, width, .. } = &mut self.slots;
        equation.iter_mut().for_each(|equations| equations.fill(NONE));
        for (pair, _, slots) in contributions.iter() {
            slots.iter().for_each(|&slot| equation[pair][slot as usize] = 0);
        }
        let free = self.numbering.free.len();
        let mut next = free as u32;
        for (equations, width) in equation.iter_mut().zip(&*width) {
            for equation in equations.iter_mut().filter(|equation| **equation != NONE) {
                *equation = next;
                next += width;
            }
        }
        let n = next as usize;
        // A pressure and its auxiliaries belong to the node of the slot: the method names it, or it is the first one of the contribution that names the slot first. Others may depend
        // on it, and name it later.
        let label = |node| self.groups.label(node);
        let mut groups = self.numbering.groups(label);
        groups.resize(n, NONE);
        for own in [true, false] {
            for (pair, nodes, slots) in contributions.iter() {
                for &slot in if own { &slots[..slots.len().min(1)] } else { slots } {
                    let first = equation[pair][slot as usize] as usize;
                    for group in &mut groups[first..first + width[pair] as usize] {
                        if *group == NONE {
                            let named = model.contacts[pair].term.slot_node(slot as usize);
                            *group = named.or(nodes.first().copied()).map_or(NONE, label);
                        }
                    }
                }
            }
        }
        self.groups.relieve(&mut groups, free, &contributions);
        let shares = &self.shares;
        let contact = contributions.stencils(&self.numbering, equation, width, shares);
        let is_own = |equation: usize| match self.numbering.free.get(equation) {
            Some(component) => shares.has(component / 3),
            None => shares.has(groups[equation]),
        };
        let stencils = self.fixed.stencils.iter().chain(contact.iter());
        let pattern = SparsityPattern::from_own_stencils(n, stencils, is_own)?;
        let pattern = Arc::new(pattern.with_groups(groups)?.with_first_multiplier(free));
        self.from_fixed.clear();
        for column in 0..free {
            // Both row lists are sorted and the rows of what is fixed are all in the larger pattern.
            let (rows, range) = (pattern.column(column), pattern.column_range(column));
            let mut at = 0;
            for &row in self.fixed.pattern.column(column) {
                while rows[at] < row {
                    at += 1;
                }
                self.from_fixed.push((range.start + at) as u32);
            }
        }
        self.values.resize(pattern.nnz(), 0.0);
        self.pattern = pattern;
        self.contributions = contributions;
        self.mapped = None;
        Ok(())
    }

    /// Where the entries of the active contributions go; [`LinalgError::EntryNotInPattern`] if the pattern has no room for them.
    fn set_map(&mut self, model: &Model, present: Contributions, active: &[Vec<bool>]) -> Result<(), StepError> {
        if self.mapped.as_ref() != Some(&present) {
            self.mapped = None;
            let Slots { equation, width, .. } = &self.slots;
            for (stencil, (pair, _, slots)) in present.iter().enumerate() {
                if slots.iter().any(|&slot| equation[pair][slot as usize] == NONE) {
                    return Err(LinalgError::EntryNotInPattern { stencil, row: NONE, column: NONE }.into());
                }
            }
            let stencils = present.stencils(&self.numbering, equation, width, &self.shares);
            self.map = ScatterMap::new(&self.pattern, stencils.iter())?;
            self.mapped = Some(present);
        }
        self.slots.inactive.clear();
        self.set_closed_diagonal(model, active)?;
        let mut inactive = std::mem::take(&mut self.slots.inactive);
        let Slots { equation, .. } = &self.slots;
        for ((equations, active), pair) in equation.iter().zip(active).zip(&model.contacts) {
            let slots = equations.iter().zip(active).enumerate();
            for (slot, (&first, _)) in slots.filter(|&(_, (&first, &active))| first != NONE && !active) {
                let weight = pair.term.slot_weight(slot);
                let of_auxiliaries = pair.term.auxiliaries().iter().filter_map(|kind| match kind {
                    Auxiliary::Condensed => None,
                    Auxiliary::Balance => Some(f64::INFINITY),
                    _ => Some(weight),
                });
                let all = (first..).zip(std::iter::once(weight).chain(of_auxiliaries));
                for (equation, weight) in all.filter(|(equation, _)| self.is_own(*equation as usize)) {
                    let missing = LinalgError::EntryNotInPattern { stencil: 0, row: equation, column: equation };
                    let position = self.pattern.position(equation, equation).ok_or(missing)?;
                    inactive.push((position as u32, weight));
                }
            }
        }
        self.slots.inactive = inactive;
        Ok(())
    }
}
