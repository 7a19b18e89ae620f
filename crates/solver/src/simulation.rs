//! The run: state, steps, balance of energy and momenta.

mod accept;
mod advance;
mod books;
mod departure;
mod fields;
mod impact;
mod overlaps;
mod pairs;
mod restart;
mod sliding_supports;
mod smoothed;
mod stage;
mod start;
mod steered;
mod sudden;
mod warnings;

pub use stage::Stage;
use start::at_rest;
pub use steered::Steered;

use crate::assembly::System;
use crate::books::work_at;
use crate::control::Clock;
use crate::held::depends_on_free;
use crate::problem::SMALLEST_RESOLVED_MOTION;
use crate::run_state::{Ledger, Log, NodalForces, SlotState, StageState};
use crate::shares::Shares;
use crate::stabilise::Stabilisation;
use crate::switches::Acting;
use crate::{
    Balance, Books, Decision, FailedAttempt, Model, Release, SimulationError, Stabilise, StepControl, StepError,
    StepRecord, Switches, Timings,
};
use std::collections::BTreeMap;
use stoss_integrators::{ForceRule, Scheme, State, StepRule};
use stoss_linalg::{AutoSolver, LinearSolver, SolverStatistics};
use stoss_newton::NewtonOptions;
use stoss_term::{At, HeldNodes, Local, SlotReport, StepContext, SurfaceForce, Term as _};

/// Slave nodes nearer to the master surface than this (in multiples of an edge length of the slave surface) are in contact from the
/// start of a quasi-static run; tension releases them. Without inertia a body that is held by contact alone could not move
/// until it touches.
const TOUCHING: f64 = 1.0e-3;

/// Settings of a run; of a run in stages those of the first one.
#[derive(Debug)]
pub struct Settings {
    /// Step size, end, cuts.
    pub control: StepControl,
    /// Time-stepping scheme; `None`: quasi-static.
    pub scheme: Option<Box<dyn Scheme>>,
    /// Newton's settings.
    pub newton: NewtonOptions,
    /// Treatment of elements that are inverted at a vertex.
    pub inside_out: InsideOutTreatment,
    /// Largest increment of the equivalent plastic strain that a point may have in a step, positive: a step with more fails with [`StepError::PlasticIncrement`], thus is tried again with
    /// a smaller one, and a step with more than half of it is not followed by a larger one. No limit if `None`.
    pub max_plastic_increment: Option<f64>,
    /// Direct solver.
    pub solver: Box<dyn LinearSolver>,
}

/// Further settings of a run in stages.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FirstStage {
    /// Stabilisation of the first stage, if it is static.
    pub stabilise: Option<Stabilise>,
    /// What is switched off in the first stage.
    pub off: Switches,
    /// Whether a later stage is dynamic: then there is a mass matrix from the beginning.
    pub later_dynamics: bool,
}

/// Treatment of elements that are inverted at a vertex at the end of a step and were not before: the
/// integrals are not affected as long as `det F > 0` at the Gauss points, see [`stoss_fe_solid::SolidBody::inside_out`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InsideOutTreatment {
    /// The step fails with [`StepError::InsideOut`], thus is tried again with a smaller one.
    #[default]
    Refuse,
    /// The step is accepted with a warning.
    Warn,
}

/// Sizes and arrays of a run, without running it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Nodes of all bodies.
    pub nodes: usize,
    /// Elements of all bodies.
    pub elements: usize,
    /// Free displacement components.
    pub free_components: usize,
    /// Free components of nodes of bodies: the others are of rigid bodies and beams.
    pub elastic_components: usize,
    /// Prescribed components.
    pub prescribed_components: usize,
    /// Potential contact constraints (one pressure each while active) and components of tie multipliers.
    pub slots: usize,
    /// Nonzeros of the matrix without contact.
    pub matrix_entries: usize,
    /// Nominal steps.
    pub steps: u64,
    /// True if there is a mass matrix.
    pub mass_matrix: bool,
    /// True if there is a contact search.
    pub contact_search: bool,
    /// True if there is a matrix with pressure rows beside that of the solids.
    pub contact_matrix: bool,
    /// True if nodal contact forces are kept.
    pub contact_force: bool,
    /// True if support forces are kept.
    pub reactions: bool,
    /// True if there is a vector of dead loads.
    pub dead_loads: bool,
    /// True if there is a vector of loads that depend on the configuration: follower pressures, moments, centrifugal forces.
    pub follower_pressure: bool,
    /// True if systems with the mass matrix alone have been solved.
    pub mass_solver: bool,
    /// True if the state has accelerations.
    pub accelerations: bool,
    /// True if the state has forces of the last end point.
    pub history: bool,
    /// The scheme's rule for the present step size: which stress and which contact gradient are evaluated.
    pub rule: StepRule,
    /// Bytes held by the system before the first factorisation.
    pub memory_bytes: usize,
}

/// Settings by which steps are done.
#[derive(Debug)]
struct How {
    control: StepControl,
    scheme: Option<Box<dyn Scheme>>,
    newton: NewtonOptions,
    inside_out: InsideOutTreatment,
    max_plastic_increment: Option<f64>,
}

/// A running simulation. See [`Self::advance`].
#[derive(Debug)]
pub struct Simulation {
    model: Model,
    how: How,
    stage: StageState,
    system: System,
    clock: Clock,
    state: State,
    step: u64,
    slots: SlotState,
    ledger: Ledger,
    forces: NodalForces,
    impacts: impact::Impacts,
    log: Log,
    /// Failed attempts of the step that was tried last.
    failures: Vec<FailedAttempt>,
}

/// What couplings are told of what acts; nothing if there are none.
fn held_nodes(model: &Model, acting: &Acting) -> HeldNodes {
    if model.contacts.is_empty() { HeldNodes::default() } else { model.held_nodes(|p| acting.prescriptions[p]) }
}

impl Simulation {
    /// Checks the model, numbers the unknowns, builds the pattern and (in dynamics) the mass matrix.
    ///
    /// # Errors
    /// [`SimulationError::Model`] for inconsistent sizes, doubly prescribed components or a scheme that does not go with the model,
    /// [`SimulationError::Setup`] if the initial state cannot be evaluated.
    pub fn new(model: Model, settings: Settings) -> Result<Self, SimulationError> {
        Self::staged(model, settings, FirstStage::default())
    }

    /// A simulation as of [`Self::new`], for a run in stages; the others follow with [`Self::begin_stage`].
    ///
    /// # Errors
    /// The errors of [`Self::new`]; [`SimulationError::Model`] also if `first.off` names what does not exist.
    pub fn staged(mut model: Model, settings: Settings, first: FirstStage) -> Result<Self, SimulationError> {
        let FirstStage { stabilise, off, later_dynamics } = first;
        let acting = model.acting(&off, &[]).map_err(SimulationError::Model)?;
        for (pair, &acts) in model.contacts.iter_mut().zip(&acting.contacts) {
            pair.acts = acts;
            if !model.embedding.is_empty() {
                pair.term.set_carriers(&|node| model.embedding.carriers(node));
            }
        }
        model.check_places().map_err(SimulationError::Model)?;
        let prescribed = model.prescribed_components(&acting)?;
        let held = held_nodes(&model, &acting);
        let components = model.reference.len();
        let dynamic = settings.scheme.is_some();
        let has_mass = dynamic || later_dynamics;
        if has_mass {
            if model.velocity.len() != components {
                return Err(SimulationError::Model(format!(
                    "{} initial velocity components for {components} position components",
                    model.velocity.len()
                )));
            }
            if let Some(body) = model.bodies.iter().find(|b| b.density.is_none()) {
                return Err(SimulationError::Model(format!("body {} has no density", body.solid.name())));
            }
        }
        if let Some(scheme) = &settings.scheme {
            stage::check_scheme(&**scheme, &model).map_err(SimulationError::Model)?;
        }
        let Settings { control, scheme, newton, inside_out, max_plastic_increment, solver } = settings;
        let shares = Shares::new(&mut model, solver.communicator())?;
        let mut system = System::new(&model, acting, has_mass, solver, shares)?;
        system.set_has_rates(dynamic, &model);
        let clock = Clock::new(control);
        system.present.stabilisation =
            stabilise.filter(|_| !dynamic).map(|how| Stabilisation::new(&model, how, clock.length()));
        let mut state = State::at_rest(model.reference.clone());
        if dynamic {
            state.v.copy_from_slice(&model.velocity);
            model.embedding.follow(&mut state.v);
        }
        let (departures, sudden) = (Vec::new(), Vec::new());
        let count = |pair: &crate::CouplingTerm| pair.term.slot_count();
        let has_supports = model.prescriptions.iter().any(|p| !p.nodes.is_empty());
        let mut simulation = Self {
            how: How { control, scheme, newton, inside_out, max_plastic_increment },
            stage: StageState {
                number: 1,
                off,
                released: Vec::new(),
                departures,
                from_motion: false,
                prescribed,
                held,
                sudden,
            },
            system,
            clock,
            state,
            step: 0,
            slots: SlotState {
                pressures: model.contacts.iter().map(|pair| vec![0.0; count(pair)]).collect(),
                mean_pressures: Vec::new(),
                active: model.contacts.iter().map(|pair| vec![pair.bilateral().is_some(); count(pair)]).collect(),
            },
            ledger: Ledger {
                balance: Balance::default(),
                books: Books::default(),
                stored: vec![[0.0; 2]; model.contacts.len()],
                energies: Vec::new(),
            },
            forces: NodalForces {
                reactions: vec![0.0; if has_supports { components } else { 0 }],
                contact: vec![0.0; if model.contacts.is_empty() { 0 } else { components }],
                ..NodalForces::default()
            },
            impacts: impact::Impacts::default(),
            log: Log::default(),
            failures: Vec::new(),
            model,
        };
        simulation.stage.departures = simulation.departures_of(&simulation.system.present.acting, None);
        simulation.stage.sudden = simulation.sudden_loads(&simulation.system.present.acting, None);
        if dynamic {
            let (time, mut v) = (0.0, std::mem::take(&mut simulation.state.v));
            simulation.set_prescribed_velocities(time, &mut v);
            simulation.model.embedding.follow(&mut v);
            simulation.state.v = v;
        }
        simulation.set_prescribed_positions_at_start();
        simulation.set_bilateral()?;
        simulation.start_at_sliding_supports();
        simulation.complete_initial_state()?;
        if !dynamic {
            simulation.close_touching()?;
        }
        let strain = simulation.strain_energy(&simulation.state.q)?;
        simulation.ledger.balance = simulation.measure_balance(strain, 0.0);
        for (c, pair) in simulation.model.couplings() {
            let energy = pair.term.energy(&simulation.state.q).map_err(StepError::from)?;
            simulation.ledger.stored[c][0] = energy;
            simulation.ledger.balance.contact += energy;
        }
        Ok(simulation)
    }

    /// Activates the slots of all bilateral constraints that act, but for those that nothing which can move enters: they determine nothing.
    fn set_bilateral(&mut self) -> Result<(), StepError> {
        let (embedding, numbering, dt) = (&self.model.embedding, &self.system.matrix.numbering, self.clock.dt());
        let begins = StepContext { end: self.state.time + dt, held: &self.stage.held, ..at_rest(&self.state, dt) };
        for (pair, active) in self.model.contacts.iter_mut().zip(&mut self.slots.active) {
            if pair.bilateral().is_none() {
                continue;
            }
            active.fill(true);
            // Which slots a tie has depends on what is prescribed.
            pair.term.begin(&begins)?;
            // A constraint may hand out its nodes one by one.
            let mut can_move = vec![false; active.len()];
            let mut in_part = false;
            pair.term.stencils(active, &mut |nodes, slots| {
                let moves = nodes.iter().any(|&node| numbering.moves(embedding, node));
                slots.iter().for_each(|&slot| can_move[slot as usize] |= moves);
                in_part |= nodes.iter().any(|&node| numbering.is_held_in_part(node));
            });
            in_part &= pair.bilateral().is_some_and(|of| of.joint(&self.state.q, &vec![0.0; active.len()]).is_some());
            if in_part && let Some(depends) = depends_on_free(&mut *pair.term, numbering, &begins) {
                can_move.iter_mut().zip(depends).for_each(|(can, depends)| *can &= depends);
            }
            active.copy_from_slice(&can_move);
        }
        self.drop_dependent_directions();
        Ok(())
    }

    /// Activates slots whose node touches the master, see [`TOUCHING`], in statics also what is behind it: nothing else may hold a body in the first iterate.
    fn close_touching(&mut self) -> Result<(), StepError> {
        let (q, dt, is_static) = (&self.state.q, self.clock.dt(), self.how.scheme.is_none());
        let (embedding, numbering) = (&self.model.embedding, &self.system.matrix.numbering);
        for (pair, active) in self.model.contacts.iter_mut().zip(&mut self.slots.active) {
            if pair.unilateral().is_none() {
                continue;
            }
            let near = TOUCHING * pair.term.length_scale();
            pair.term.begin(&StepContext { reach: near, held: &self.stage.held, ..at_rest(&self.state, dt) })?;
            let mut gaps = vec![0.0; active.len()];
            let Some(method) = pair.unilateral_mut() else { continue };
            method.complementarity_gaps(q, active, &mut gaps)?;
            for (active, gap) in active.iter_mut().zip(gaps) {
                *active = gap <= near && (is_static || gap >= -near);
            }
            method.repair(q, active)?;
            // A constraint between nodes that cannot move determines nothing.
            let mut free = vec![false; active.len()];
            pair.term.stencils(active, &mut |nodes, slots| {
                let moves = nodes.iter().any(|&node| numbering.moves(embedding, node));
                slots.iter().for_each(|&slot| free[slot as usize] = moves);
            });
            active.iter_mut().zip(free).for_each(|(active, free)| *active &= free);
            pair.term.commit(&At::end(q, &vec![0.0; active.len()], active));
        }
        Ok(())
    }

    /// Embedded nodes do not follow yet.
    fn set_prescribed_velocities(&self, time: f64, v: &mut [f64]) {
        for &(component, p, column) in &self.stage.prescribed {
            let prescription = &self.model.prescriptions[p as usize];
            v[component as usize] =
                prescription.velocity(component / 3, self.reference_of(component), time, column as usize)
                    + self.rate_of_offset(component, p, time);
        }
    }

    fn step_rule(&self, dt: f64) -> StepRule {
        self.how.scheme.as_ref().map_or_else(|| StepRule::quasi_static(dt), |scheme| scheme.rule(dt))
    }

    fn set_dead_loads(&mut self, time: f64) {
        if !self.system.loads.has_dead {
            return;
        }
        for range in &self.system.loads.support {
            self.system.loads.dead[range.clone()].fill(0.0);
        }
        let at = At { time, ..At::force([&self.state.q; 2], ForceRule::END_POINT, 0.0) };
        for load in self.model.acting_loads(&self.system.present.acting).filter(|load| !load.follows()) {
            // cannot fail: the forces are constant.
            load.add_force(&at, 1.0, &mut self.system.loads.dead).unwrap_or(());
        }
    }

    fn set_prescribed_positions_at_start(&mut self) {
        let time = self.state.time;
        for k in 0..self.stage.prescribed.len() {
            let (component, value) = self.prescribed_position(k, time);
            self.state.q[component] = value;
        }
        self.model.embedding.follow(&mut self.state.q);
    }

    fn prescribed_position(&self, k: usize, time: f64) -> (usize, f64) {
        let (component, p, column) = self.stage.prescribed[k];
        let prescription = &self.model.prescriptions[p as usize];
        let reference = self.reference_of(component);
        let position = prescription.position(component / 3, reference, time, column as usize);
        (component as usize, position + self.offset(component, p, time))
    }

    /// Reference position of the node that a component belongs to.
    fn reference_of(&self, component: u32) -> [f64; 3] {
        let first = component as usize / 3 * 3;
        std::array::from_fn(|i| self.model.reference[first + i])
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }
    /// The model, with its terms where the last completed step left them.
    pub fn into_model(self) -> Model {
        self.model
    }
    /// Positions, velocities, time of the last completed step.
    pub fn state(&self) -> &State {
        &self.state
    }
    /// Completed steps.
    pub fn step(&self) -> u64 {
        self.step
    }
    /// Clock and step control.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }
    /// Balance of the last completed step.
    pub fn balance(&self) -> &Balance {
        &self.ledger.balance
    }
    /// Books of all steps of this process: what is stored now, and sums of the rest.
    pub fn books(&self) -> &Books {
        &self.ledger.books
    }
    /// Pressures of each contact pair's slots, of the equations of the last step.
    pub fn pressures(&self) -> &[Vec<f64>] {
        &self.slots.pressures
    }
    /// Pressures with which the forces of the last step give its change of momentum: with the impulses of the law of impact, over the step size, where it
    /// acted.
    pub fn mean_pressures(&self) -> &[Vec<f64>] {
        if self.slots.mean_pressures.is_empty() { &self.slots.pressures } else { &self.slots.mean_pressures }
    }
    /// Active slots of each contact pair.
    pub fn active(&self) -> &[Vec<bool>] {
        &self.slots.active
    }
    /// Force of contact and ties on each node in the last step (`3 * nodes`; empty without either). On quadratic faces these are the consistent forces at the nodes of the elements:
    /// of a uniform pressure those at corners are zero or pull.
    pub fn contact_force(&self) -> &[f64] {
        &self.forces.contact
    }
    /// Corrections by node that give the forces on inset surfaces (general contact) when added to [`Self::contact_force`]: there the nodes of elements below the surface carry the forces.
    /// The moment is about the origin, in addition to that of `contact_force` at the nodes. Of the last step of this process; empty after a restart.
    pub fn moved_contact_force(&self) -> &BTreeMap<u32, SurfaceForce> {
        &self.forces.moved
    }
    /// Seconds by phase.
    pub fn timings(&self) -> &Timings {
        &self.log.timings
    }
    /// Seconds by phase, to add the time of writing output.
    pub fn timings_mut(&mut self) -> &mut Timings {
        &mut self.log.timings
    }
    /// All decisions so far.
    pub fn decisions(&self) -> &[Decision] {
        &self.log.decisions
    }
    /// Failed attempts at the last step, in order; of a completed step those before it succeeded.
    pub fn failures(&self) -> &[FailedAttempt] {
        &self.failures
    }
    /// Linear solves so far, failed attempts included.
    pub fn solves(&self) -> u64 {
        self.log.solves
    }
    /// Statistics of the linear solver.
    pub fn solver_statistics(&self) -> SolverStatistics {
        self.system.solver.statistics()
    }
    /// Wraps the linear solver, for instance to record its systems; to be called before the first step.
    pub fn wrap_solver(&mut self, wrap: impl FnOnce(Box<dyn LinearSolver>) -> Box<dyn LinearSolver>) {
        let solver = std::mem::replace(&mut self.system.solver, Box::new(AutoSolver::new()));
        self.system.solver = wrap(solver);
    }
    /// Name of the linear solver.
    pub fn solver_name(&self) -> &str {
        self.system.solver.name()
    }
    /// Equations at present.
    pub fn equations(&self) -> usize {
        self.system.equations()
    }
    /// Number of the present stage, from 1.
    pub fn stage(&self) -> u32 {
        self.stage.number
    }
    /// Releases so far.
    pub fn released(&self) -> &[Release] {
        &self.stage.released
    }
    /// Whether the stage is static, without velocities.
    pub fn is_static(&self) -> bool {
        self.how.scheme.is_none()
    }
    /// True at the end of the stage, which is the end of the run if no other stage begins.
    pub fn finished(&self) -> bool {
        self.clock.finished()
    }

    /// Sizes and arrays of the run.
    pub fn plan(&self) -> Plan {
        Plan {
            nodes: self.model.node_count(),
            elements: self.model.bodies.iter().map(|b| b.solid.element_count()).sum(),
            free_components: self.system.matrix.free(),
            elastic_components: self.system.elastic_components(&self.model),
            prescribed_components: self.stage.prescribed.len(),
            slots: self.slots.pressures.iter().map(Vec::len).sum(),
            matrix_entries: self.system.matrix.pattern.nnz(),
            steps: self.clock.nominal_steps(),
            mass_matrix: self.system.inertia.exists,
            contact_search: self.model.has_unilateral_contact(),
            contact_matrix: !self.system.matrix.from_fixed.is_empty(),
            contact_force: !self.forces.contact.is_empty(),
            reactions: !self.forces.reactions.is_empty() || self.has_sliding_supports(),
            dead_loads: !self.system.loads.dead.is_empty(),
            follower_pressure: !self.system.loads.follower.is_empty(),
            mass_solver: self.system.inertia.solver.is_some(),
            accelerations: !self.state.a.is_empty(),
            history: !self.state.history.is_empty(),
            rule: self.step_rule(self.clock.dt()),
            memory_bytes: self.system.memory_bytes()
                + self.model.bodies.iter().map(|b| b.solid.memory_bytes()).sum::<usize>(),
        }
    }

    /// Gap, normal and feature of every slot of a contact pair at the last completed step.
    ///
    /// # Errors
    /// If the projection fails.
    pub fn contact_report(&self, pair: usize) -> Result<Vec<SlotReport>, StepError> {
        let pair = &self.model.contacts[pair];
        Ok(if pair.acts { pair.term.report(&self.state.q)? } else { Vec::new() })
    }

    /// The record of the initial state (step 0).
    pub fn initial_record(&self) -> StepRecord {
        StepRecord {
            step: self.step,
            stage: self.stage.number,
            time: self.state.time,
            dt: 0.0,
            nominal: true,
            balance: self.ledger.balance,
            newton: Vec::new(),
            iterations: 0,
            decisions: Vec::new(),
            inside_out: 0,
            unstable: 0,
            closing: Vec::new(),
            books: Books::default(),
            impact_losses: Vec::new(),
            stabilising: None,
            contact: None,
        }
    }

    fn set_has_rates(&mut self, has_rates: bool) {
        self.system.set_has_rates(has_rates, &self.model);
    }

    fn measure_balance(&self, strain: f64, external_work: f64) -> Balance {
        let mut balance = Balance { strain, external_work, ..Balance::default() };
        let masses = &self.system.inertia.masses;
        // The velocities of a static stage are mean ones of the last step, for its predictor.
        if self.system.present.has_rates {
            balance.kinetic = masses.kinetic_energy(&self.state.v);
            balance.linear_momentum = masses.linear_momentum(&self.state.v);
            balance.angular_momentum = masses.angular_momentum(&self.state.q, &self.state.v);
        }
        for load in self.model.acting_loads(&self.system.present.acting).filter(|load| load.is_conservative()) {
            let at = At::force([&self.model.reference, &self.state.q], ForceRule::END_POINT, 0.0);
            // cannot fail: the forces are constant.
            load.assemble(&at, false, &mut |local| {
                balance.potential += work_at(&local.nodes, &local.residual, at.q_n, at.q_np1);
            })
            .unwrap_or(());
        }
        balance.largest_energy = self.ledger.balance.largest_energy.max(balance.kinetic + balance.strain);
        balance
    }

    /// Mass of all bodies; zero in runs without a dynamic stage, which have none.
    pub fn total_mass(&self) -> f64 {
        self.system.inertia.masses.total(self.state.q.len())
    }

    /// Energy of motions that are not resolved: of small deformations against the stiffness, and of small parts of the way through the model against constant loads. Round-off of
    /// energies is far below it.
    pub fn unresolved_energy(&self) -> f64 {
        let model = &self.model;
        if model.parts.is_empty() {
            return 0.0;
        }
        let lengths = model.parts.iter().map(|part| part.length_scale());
        let length = lengths.chain(model.contacts.iter().map(|pair| pair.term.length_scale())).fold(0.0, f64::max);
        let small = SMALLEST_RESOLVED_MOTION * SMALLEST_RESOLVED_MOTION;
        let mut force = 0.0;
        let at = At { time: self.state.time, ..At::force([&self.state.q; 2], ForceRule::END_POINT, 0.0) };
        for load in model.acting_loads(&self.system.present.acting).filter(|load| !load.follows()) {
            let mut add = |local: &Local| force += local.residual.iter().map(|r| r.abs()).sum::<f64>();
            // cannot fail: the forces are constant.
            load.assemble(&at, false, &mut add).unwrap_or(());
        }
        let radius = self.state.q.iter().fold(length, |radius, x| radius.max(x.abs()));
        small * self.system.scales.force * length + SMALLEST_RESOLVED_MOTION * force * radius
    }

    /// What the iteration of a step of the size `h` may leave of the balance of forces, in the norm over all nodes, if motions are not resolved: the tolerance of
    /// Newton's method times the smallest scales of the residual, and round-off of positions. As a force, and as a mass times a length over `h^2`.
    pub fn unresolved_forces(&self) -> [f64; 2] {
        let small = self.how.newton.relative_tolerance * SMALLEST_RESOLVED_MOTION;
        let lengths = self.model.bodies.iter().map(|body| body.solid.characteristic_length());
        let edge = lengths.fold(f64::INFINITY, f64::min);
        let radius = self.state.q.iter().fold(0.0_f64, |radius, x| radius.max(x.abs()));
        let round_off = f64::EPSILON * (radius / edge).max(1.0) * (self.state.q.len() as f64).sqrt();
        // `2 / h^2` is the factor of inertia of the schemes that conserve energy.
        let inertia = 2.0 * (small + round_off) * self.system.scales.mass_length;
        [(small + round_off) * self.system.scales.force + self.how.newton.absolute_tolerance, inertia]
    }

    /// Momenta, kinetic and strain energy of one body at the last completed step (loads and contact belong to the model).
    pub fn body_balance(&self, body: usize) -> Balance {
        // The state was accepted, so its strain energy exists; NaN would show a contradiction.
        let shares = &self.system.shares;
        let strain = shares.sum(self.model.bodies[body].solid.strain_energy(&self.state.q).unwrap_or(f64::NAN));
        let mut balance = Balance { strain, ..Balance::default() };
        if let Some(mass) = self.system.inertia.masses.bodies.get(body).filter(|_| self.system.present.has_rates) {
            balance.kinetic = shares.sum(mass.kinetic_energy(&self.state.v));
            balance.linear_momentum = shares.sum3(mass.linear_momentum(&self.state.v));
            balance.angular_momentum = shares.sum3(mass.angular_momentum(&self.state.q, &self.state.v));
        }
        balance
    }

    /// Momenta, kinetic and strain energy of one part at the last completed step.
    pub fn part_balance(&self, part: usize) -> Balance {
        // As in `body_balance`.
        let energy = || self.model.parts[part].energy(&self.state.q).unwrap_or(f64::NAN);
        let strain = if self.system.present.acting.parts[part] { energy() } else { 0.0 };
        let mut balance = Balance { strain, ..Balance::default() };
        if let Some(mass) = self.system.inertia.masses.parts.get(part).filter(|_| self.system.present.has_rates) {
            balance.kinetic = mass.kinetic_energy(&self.state.v);
            balance.linear_momentum = mass.linear_momentum(&self.state.v);
            balance.angular_momentum = mass.angular_momentum(&self.state.q, &self.state.v);
        }
        balance
    }

    fn strain_energy(&self, q: &[f64]) -> Result<f64, StepError> {
        Ok(self.energies(q)?.iter().fold(0.0, |sum, energy| sum + energy))
    }
}
