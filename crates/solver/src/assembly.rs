//! The global system of a step: storage, patterns, scatter, and its evaluation as a Newton problem.

use crate::numbering::Numbering;
use crate::{LoadKind, Model, Phase, StepError, Timings};
use std::sync::Arc;
use stoss_contact::{ContactRule, StepConfiguration};
use stoss_fe_solid::{
    MassMatrix, SolidStep, StressRule, TangentTarget, Workspace, add_follower_pressure, follower_pressure,
};
use stoss_integrators::{ForceRule, Scheme, State};
use stoss_linalg::{LinearSolver, MatrixKind, NONE, ScatterMap, SparsityPattern, vector};
use stoss_newton::{NewtonProblem, ResidualNorms};

/// Motions below this fraction of an edge length in a step are not resolved relative to themselves: the forces that they
/// need are the smallest scale that the residual is measured against. Without it a free, unstressed flight, whose
/// forces are round-off, could never converge relatively.
const SMALLEST_RESOLVED_MOTION: f64 = 1.0e-4;

/// Everything of fixed size that a step needs, allocated once (contact parts: once a change of the contact pattern).
#[derive(Debug)]
pub(crate) struct System {
    pub numbering: Numbering,
    pub masses: Vec<MassMatrix>,
    /// Pattern of the solids alone, its scatter map (bodies' elements in order, then follower facets).
    solid_pattern: Arc<SparsityPattern>,
    solid_map: ScatterMap,
    /// First stencil of each body in `solid_map`; last entry: first follower facet.
    first_stencil: Vec<usize>,
    mass_values: Vec<f64>,
    solid_values: Vec<f64>,
    /// Pattern with the active constraints, where each entry of the solids' pattern goes, and the constraints' scatter map.
    pattern: Arc<SparsityPattern>,
    solid_to_global: Vec<u32>,
    contact_map: ScatterMap,
    /// Equation of each slot of each contact pair, `NONE` if inactive.
    slot_equation: Vec<Vec<u32>>,
    values: Vec<f64>,
    pub solver: Box<dyn LinearSolver>,
    workspaces: Vec<Workspace>,
    stencils: StencilList,
    follower_equations: StencilList,
    // Nodal vectors, 3 * nodes.
    pub residual: Vec<f64>,
    internal: Vec<f64>,
    inertia: Vec<f64>,
    acceleration: Vec<f64>,
    /// Dead loads of the step (follower pressures are configuration dependent and go to `follower`).
    pub dead: Vec<f64>,
    pub follower: Vec<f64>,
    pub contact_force: Vec<f64>,
    // Vectors of equations.
    rhs: Vec<f64>,
    increment: Vec<f64>,
    base_q: Vec<f64>,
    base_pressures: Vec<Vec<f64>>,
    /// Sum of nodal masses times an edge length, and of shear modulus times squared edge length, as force scales.
    mass_length: f64,
    stiffness_force: f64,
}

/// Lists of equation numbers, flat.
#[derive(Debug, Default, Clone)]
struct StencilList {
    starts: Vec<usize>,
    entries: Vec<u32>,
}

impl StencilList {
    fn push(&mut self, fill: impl FnOnce(&mut Vec<u32>)) {
        self.starts.push(self.entries.len());
        fill(&mut self.entries);
    }
    fn iter(&self) -> impl Iterator<Item = &[u32]> + Clone {
        (0..self.starts.len()).map(|k| {
            let end = self.starts.get(k + 1).copied().unwrap_or(self.entries.len());
            &self.entries[self.starts[k]..end]
        })
    }
}

/// Iterate of a step.
#[derive(Debug, Clone)]
pub(crate) struct Iterate {
    pub q: Vec<f64>,
    pub pressures: Vec<Vec<f64>>,
    pub active: Vec<Vec<bool>>,
}

impl System {
    pub fn new(model: &Model, dynamic: bool, solver: Box<dyn LinearSolver>) -> Result<Self, StepError> {
        let components = model.reference.len();
        let mut blocked = vec![true; components];
        for body in &model.bodies {
            for &node in body.solid.connectivity().iter().flatten() {
                blocked[3 * node as usize..3 * node as usize + 3].fill(false);
            }
        }
        for prescription in &model.prescriptions {
            for &node in &prescription.nodes {
                for &component in &prescription.components {
                    blocked[3 * node as usize + component as usize] = true;
                }
            }
        }
        let numbering = Numbering::new(components, |c| blocked[c]);
        let mut solids = StencilList::default();
        let mut first_stencil = Vec::new();
        for body in &model.bodies {
            first_stencil.push(solids.starts.len());
            for element in body.solid.connectivity() {
                solids.push(|out| numbering.node_equations(element, out));
            }
        }
        first_stencil.push(solids.starts.len());
        let mut follower_equations = StencilList::default();
        for load in &model.loads {
            if let LoadKind::FollowerPressure { facets } = &load.kind {
                for facet in facets {
                    solids.push(|out| numbering.node_equations(facet, out));
                    follower_equations.push(|out| numbering.node_equations(facet, out));
                }
            }
        }
        let n = numbering.free.len();
        let solid_pattern = Arc::new(SparsityPattern::from_stencils(n, solids.iter())?);
        let solid_map = ScatterMap::new(&solid_pattern, solids.iter())?;
        let nnz = solid_pattern.nnz();
        let mut masses = Vec::new();
        let mut mass_values = Vec::new();
        let (mut mass_length, mut stiffness_force) = (0.0, 0.0);
        if dynamic {
            mass_values = vec![0.0; nnz];
        }
        for (b, body) in model.bodies.iter().enumerate() {
            let h = body.solid.characteristic_length();
            stiffness_force += body.solid.law().small_strain_moduli().shear * h * h;
            if let (true, Some(density)) = (dynamic, body.density) {
                let mass = body.solid.mass(density, body.mass_kind);
                mass.add_to_tangent(
                    1.0,
                    TangentTarget {
                        map: &solid_map,
                        first_stencil: first_stencil[b],
                        factor: 1.0,
                        values: &mut mass_values,
                    },
                );
                mass_length += mass.total() / (body.nodes.len().max(1) as f64) * h;
                masses.push(mass);
            }
        }
        let slot_equation: Vec<Vec<u32>> =
            model.contacts.iter().map(|pair| vec![NONE; pair.method.slot_count()]).collect();
        let zeros = || vec![0.0; components];
        let empty: [&[u32]; 0] = [];
        Ok(Self {
            contact_map: ScatterMap::new(&solid_pattern, empty.iter().copied())?,
            pattern: Arc::clone(&solid_pattern),
            solid_to_global: (0..nnz as u32).collect(),
            values: vec![0.0; nnz],
            solid_values: vec![0.0; nnz],
            workspaces: model.bodies.iter().map(|_| Workspace::default()).collect(),
            stencils: solids,
            residual: zeros(),
            internal: zeros(),
            inertia: if dynamic { zeros() } else { Vec::new() },
            acceleration: if dynamic { zeros() } else { Vec::new() },
            dead: zeros(),
            follower: zeros(),
            contact_force: if model.contacts.is_empty() { Vec::new() } else { zeros() },
            rhs: vec![0.0; n],
            increment: vec![0.0; n],
            base_q: zeros(),
            base_pressures: slot_equation.iter().map(|s| vec![0.0; s.len()]).collect(),
            numbering,
            masses,
            solid_pattern,
            solid_map,
            first_stencil,
            mass_values,
            slot_equation,
            solver,
            follower_equations,
            mass_length,
            stiffness_force,
        })
    }

    /// Number of equations at present: free components and active pressures.
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
            + 9 * self.residual.capacity()
            + 2 * self.rhs.capacity();
        8 * floats
            + self.solid_pattern.memory_bytes()
            + self.pattern.memory_bytes()
            + self.solid_map.memory_bytes()
            + self.contact_map.memory_bytes()
            + self.solver.memory_bytes()
    }

    /// True if a mass matrix exists.
    pub fn has_mass(&self) -> bool {
        !self.mass_values.is_empty()
    }

    /// Renews pattern and maps for the present active set and pairings.
    pub fn renew_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        let free = self.numbering.free.len();
        let mut next = free as u32;
        for (equations, active) in self.slot_equation.iter_mut().zip(active) {
            for (equation, &active) in equations.iter_mut().zip(active) {
                *equation = if active {
                    next += 1;
                    next - 1
                } else {
                    NONE
                };
            }
        }
        let n = next as usize;
        let mut contact = StencilList::default();
        for (pair, (equations, active)) in model.contacts.iter().zip(self.slot_equation.iter().zip(active)) {
            pair.method.stencils(active, &mut |nodes, slots| {
                contact.push(|out| {
                    self.numbering.node_equations(nodes, out);
                    out.extend(slots.iter().map(|&slot| equations[slot as usize]));
                });
            });
        }
        let pattern = Arc::new(SparsityPattern::from_stencils(n, self.stencils.iter().chain(contact.iter()))?);
        self.contact_map = ScatterMap::new(&pattern, contact.iter())?;
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
        Ok(())
    }
}

pub(crate) fn stress_rule(rule: ForceRule) -> StressRule {
    match rule {
        ForceRule::Midpoint => StressRule::Midpoint,
        ForceRule::DiscreteGradient => StressRule::EnergyMomentum,
        _ => StressRule::EndPoint,
    }
}

pub(crate) fn contact_rule(rule: ForceRule) -> ContactRule {
    match rule {
        ForceRule::Midpoint => ContactRule::Midpoint,
        ForceRule::DiscreteGradient => ContactRule::EnergyMomentum,
        _ => ContactRule::EndPoint,
    }
}

/// One step as a problem for Newton's method.
pub(crate) struct StepProblem<'a> {
    pub model: &'a Model,
    pub system: &'a mut System,
    pub state_n: &'a State,
    pub iterate: &'a mut Iterate,
    pub scheme: Option<&'a dyn Scheme>,
    pub rule: ForceRule,
    pub dt: f64,
    /// Time at which loads are taken.
    pub load_time: f64,
    pub timings: &'a mut Timings,
    /// Residual evaluations and linear solves so far.
    pub solves: u32,
}

impl StepProblem<'_> {
    /// Fills residual, and matrix values if asked; returns the relative residual.
    fn evaluate(&mut self, want_tangent: bool) -> Result<f64, StepError> {
        let Self { model, system, state_n, iterate, scheme, rule, dt, load_time, .. } = self;
        let s = &mut **system;
        s.internal.fill(0.0);
        if want_tangent {
            match scheme {
                Some(scheme) => {
                    let c = scheme.acceleration_factor(*dt);
                    for (k, m) in s.solid_values.iter_mut().zip(&s.mass_values) {
                        *k = c * m;
                    }
                }
                None => s.solid_values.fill(0.0),
            }
        }
        let step = SolidStep { q_n: &state_n.q, q_np1: &iterate.q, rule: stress_rule(*rule) };
        for (b, body) in model.bodies.iter().enumerate() {
            let target = want_tangent.then_some(TangentTarget {
                map: &s.solid_map,
                first_stencil: s.first_stencil[b],
                factor: 1.0,
                values: &mut s.solid_values,
            });
            body.solid.assemble(step, 1.0, &mut s.internal, target, &mut s.workspaces[b])?;
        }
        s.residual.copy_from_slice(&s.internal);
        let mut scale = vector::norm2(&s.internal).max(SMALLEST_RESOLVED_MOTION * s.stiffness_force);
        if let Some(scheme) = scheme {
            scheme.acceleration(state_n, &iterate.q, *dt, &mut s.acceleration);
            s.inertia.fill(0.0);
            for mass in &s.masses {
                mass.multiply_add(1.0, &s.acceleration, &mut s.inertia);
            }
            vector::axpy(1.0, &s.inertia, &mut s.residual);
            scale = scale
                .max(vector::norm2(&s.inertia))
                .max(SMALLEST_RESOLVED_MOTION * s.mass_length * scheme.acceleration_factor(*dt));
        }
        vector::axpy(-1.0, &s.dead, &mut s.residual);
        scale = scale.max(vector::norm2(&s.dead));
        evaluate_follower(model, s, step, *load_time, want_tangent);
        vector::axpy(-1.0, &s.follower, &mut s.residual);
        scale = scale.max(vector::norm2(&s.follower));
        if want_tangent {
            s.values.fill(0.0);
            for (value, &at) in s.solid_values.iter().zip(&s.solid_to_global) {
                s.values[at as usize] = *value;
            }
        }
        let free = s.numbering.free.len();
        s.rhs[free..].fill(0.0);
        let mut gap_measure = 0.0_f64;
        if !model.contacts.is_empty() {
            s.contact_force.fill(0.0);
            let mut k = 0;
            for (c, pair) in model.contacts.iter().enumerate() {
                let configuration = StepConfiguration { q_n: &state_n.q, q_np1: &iterate.q, rule: contact_rule(*rule) };
                let length = pair.method.length_scale();
                let (contact_force, rhs, values) = (&mut s.contact_force, &mut s.rhs, &mut s.values);
                let (equations, contact_map) = (&s.slot_equation[c], &s.contact_map);
                let method = &pair.method;
                method.assemble(
                    configuration,
                    &iterate.pressures[c],
                    &iterate.active[c],
                    want_tangent,
                    &mut |local| {
                        for (i, &node) in local.nodes.iter().enumerate() {
                            for d in 0..3 {
                                contact_force[3 * node as usize + d] -= local.residual[3 * i + d];
                            }
                        }
                        let rows = &local.residual[3 * local.nodes.len()..];
                        for (&slot, row) in local.slots.iter().zip(rows) {
                            rhs[equations[slot as usize] as usize] -= row;
                            gap_measure = gap_measure.max(row.abs() / (method.slot_weight(slot as usize) * length));
                        }
                        if want_tangent {
                            contact_map.add(k, &local.tangent, values);
                        }
                        k += 1;
                    },
                )?;
            }
            vector::axpy(-1.0, &s.contact_force, &mut s.residual);
            scale = scale.max(vector::norm2(&s.contact_force));
        }
        let mut sum = 0.0;
        for (rhs, &component) in s.rhs.iter_mut().zip(&s.numbering.free) {
            let r = s.residual[component as usize];
            *rhs = -r;
            sum += r * r;
        }
        Ok((sum.sqrt() / scale).max(gap_measure))
    }
}

/// Follower pressures at the configuration of the rule: `q_mid` for midpoint rules, `q_np1` otherwise.
fn evaluate_follower(model: &Model, s: &mut System, step: SolidStep<'_>, time: f64, want_tangent: bool) {
    if s.follower_equations.starts.is_empty() {
        return;
    }
    s.follower.fill(0.0);
    let half = step.rule != StressRule::EndPoint;
    let mut stencil = *s.first_stencil.last().unwrap_or(&0);
    for load in &model.loads {
        let LoadKind::FollowerPressure { facets } = &load.kind else { continue };
        let pressure = load.magnitude.value(time, 0);
        for facet in facets {
            let corners = facet.map(|node| {
                let at = 3 * node as usize;
                std::array::from_fn(|i| {
                    if half { 0.5 * (step.q_n[at + i] + step.q_np1[at + i]) } else { step.q_np1[at + i] }
                })
            });
            let (force, tangent) = follower_pressure(&corners, pressure);
            add_follower_pressure(facet, &force, &mut s.follower);
            if want_tangent {
                // The load enters the residual with a minus, and d q_mid / d q_np1 = 1/2.
                let factor = if half { -0.5 } else { -1.0 };
                let mut block = [0.0; 144];
                for (out, row) in block.chunks_exact_mut(12).zip(&tangent) {
                    for (o, t) in out.iter_mut().zip(row) {
                        *o = factor * t;
                    }
                }
                s.solid_map.add(stencil, &block, &mut s.solid_values);
            }
            stencil += 1;
        }
    }
}

impl NewtonProblem for StepProblem<'_> {
    type Error = StepError;

    fn assemble(&mut self) -> Result<ResidualNorms, StepError> {
        let mut timings = std::mem::take(self.timings);
        let residual = timings.measure(Phase::Assembly, || self.evaluate(true));
        *self.timings = timings;
        Ok(ResidualNorms { residual: residual?, scale: 1.0 })
    }

    fn solve(&mut self) -> Result<f64, StepError> {
        let kind = if self.model.contacts.is_empty()
            && self.rule != ForceRule::DiscreteGradient
            && self.system.follower_equations.starts.is_empty()
        {
            MatrixKind::Symmetric
        } else {
            MatrixKind::General
        };
        let s = &mut *self.system;
        let (solver, pattern, values) = (&mut s.solver, &s.pattern, &s.values);
        self.timings.measure(Phase::Factorisation, || {
            solver.analyse(pattern, kind)?;
            solver.factorise(values)
        })?;
        let (rhs, increment) = (&s.rhs, &mut s.increment);
        self.timings.measure(Phase::Solve, || solver.solve(rhs, increment))?;
        self.solves += 1;
        s.base_q.copy_from_slice(&self.iterate.q);
        for (base, pressures) in s.base_pressures.iter_mut().zip(&self.iterate.pressures) {
            base.copy_from_slice(pressures);
        }
        Ok(vector::norm2(&s.increment[..s.numbering.free.len()]))
    }

    fn update(&mut self, factor: f64) -> Result<(), StepError> {
        let s = &*self.system;
        self.iterate.q.copy_from_slice(&s.base_q);
        for (du, &component) in s.increment.iter().zip(&s.numbering.free) {
            self.iterate.q[component as usize] += factor * du;
        }
        for ((pressures, base), equations) in
            self.iterate.pressures.iter_mut().zip(&s.base_pressures).zip(&s.slot_equation)
        {
            for ((p, p0), &equation) in pressures.iter_mut().zip(base).zip(equations) {
                if equation != NONE {
                    *p = p0 + factor * s.increment[equation as usize];
                }
            }
        }
        Ok(())
    }

    fn residual_norm(&mut self) -> Result<f64, StepError> {
        let mut timings = std::mem::take(self.timings);
        let residual = timings.measure(Phase::Assembly, || self.evaluate(false));
        *self.timings = timings;
        residual
    }

    fn is_recoverable(&self, error: &StepError) -> bool {
        matches!(error, StepError::Solid(_) | StepError::Contact(_))
    }

    fn iterate_norm(&self) -> f64 {
        vector::norm2(&self.iterate.q)
    }
}
