//! The run: state, steps, ledger.

use crate::assembly::{Iterate, System};
use crate::control::Clock;
use crate::step::{Attempt, StepInput, attempt, decision};
use crate::system::{FeSystem, stress_rule};
use crate::{
    Balance, Checkpoint, CheckpointError, ContactSummary, Decision, DecisionKind, LoadKind, Model, Phase,
    SimulationError, StepControl, StepError, StepRecord, Timings,
};
use std::collections::BTreeMap;
use stoss_contact::SlotReport;
use stoss_integrators::{Scheme, State, Step, StepRule, finish, start};
use stoss_linalg::{LinearSolver, SolverStatistics, vector};
use stoss_newton::NewtonOptions;

/// How to run.
#[derive(Debug)]
pub struct Settings {
    /// Step size, end, cuts.
    pub control: StepControl,
    /// Time-stepping scheme; `None`: quasi-static.
    pub scheme: Option<Box<dyn Scheme>>,
    /// Newton's settings.
    pub newton: NewtonOptions,
    /// Direct solver.
    pub solver: Box<dyn LinearSolver>,
}

/// What a run will use, without running it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Nodes of all bodies.
    pub nodes: usize,
    /// Elements of all bodies.
    pub elements: usize,
    /// Free displacement components.
    pub free_components: usize,
    /// Prescribed components.
    pub prescribed_components: usize,
    /// Potential contact constraints (one pressure each while active).
    pub slots: usize,
    /// Nonzeros of the matrix without contact.
    pub matrix_entries: usize,
    /// Nominal steps.
    pub steps: u64,
    /// True if there is a mass matrix.
    pub mass_matrix: bool,
    /// True if there is a contact search.
    pub contact_search: bool,
    /// Bytes held by the system before the first factorisation.
    pub memory_bytes: usize,
}

/// An attempt that succeeded, with what could still have failed.
struct Completed {
    attempt: Attempt,
    next: State,
    rule: StepRule,
    strain: f64,
    contact: Option<ContactSummary>,
}

/// A running simulation. See [`Self::advance`].
#[derive(Debug)]
pub struct Simulation {
    model: Model,
    control: StepControl,
    scheme: Option<Box<dyn Scheme>>,
    newton: NewtonOptions,
    system: System,
    clock: Clock,
    state: State,
    step: u64,
    pressures: Vec<Vec<f64>>,
    active: Vec<Vec<bool>>,
    /// (component, prescription, column), sorted.
    prescribed: Vec<(u32, u32, u32)>,
    reactions: Vec<f64>,
    contact_force: Vec<f64>,
    balance: Balance,
    timings: Timings,
    decisions: Vec<Decision>,
    solves: u64,
}

impl Simulation {
    /// Checks the model, numbers the unknowns, builds the pattern and (in dynamics) the mass matrix.
    ///
    /// # Errors
    /// [`SimulationError::Model`] for inconsistent sizes or doubly prescribed components, [`SimulationError::Setup`] if the
    /// initial state cannot be evaluated.
    pub fn new(model: Model, settings: Settings) -> Result<Self, SimulationError> {
        let prescribed = model.prescribed_components()?;
        let components = model.reference.len();
        let dynamic = settings.scheme.is_some();
        if dynamic {
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
        if let Some(scheme) = settings.scheme.as_ref().filter(|s| !s.claims().constraints && !model.contacts.is_empty())
        {
            return Err(SimulationError::Model(format!("scheme {} cannot carry contact constraints", scheme.name())));
        }
        let Settings { control, scheme, newton, solver } = settings;
        let system = System::new(&model, dynamic, solver)?;
        let clock = Clock::new(control);
        let mut state = State::at_rest(model.reference.clone());
        if dynamic {
            state.v.copy_from_slice(&model.velocity);
        }
        let slots = |pair: &crate::ContactPair| pair.method.slot_count();
        let contact_components = if model.contacts.is_empty() { 0 } else { components };
        let mut simulation = Self {
            pressures: model.contacts.iter().map(|p| vec![0.0; slots(p)]).collect(),
            active: model.contacts.iter().map(|p| vec![false; slots(p)]).collect(),
            reactions: vec![0.0; if prescribed.is_empty() { 0 } else { components }],
            contact_force: vec![0.0; contact_components],
            prescribed,
            system,
            clock,
            state,
            step: 0,
            balance: Balance::default(),
            timings: Timings::default(),
            decisions: Vec::new(),
            solves: 0,
            model,
            control,
            scheme,
            newton,
        };
        if dynamic {
            let (time, mut v) = (0.0, std::mem::take(&mut simulation.state.v));
            simulation.set_prescribed_velocities(time, &mut v);
            simulation.state.v = v;
        }
        simulation.set_prescribed_positions_at_start();
        simulation.complete_initial_state()?;
        let strain = simulation.strain_energy(&simulation.state.q)?;
        simulation.balance = simulation.measure_balance(strain, 0.0);
        Ok(simulation)
    }

    fn set_prescribed_velocities(&self, time: f64, v: &mut [f64]) {
        for &(component, p, column) in &self.prescribed {
            let table = &self.model.prescriptions[p as usize].displacement;
            v[component as usize] = table.slope(time, column as usize);
        }
    }

    /// Acceleration and forces at the start, for schemes that carry them.
    fn complete_initial_state(&mut self) -> Result<(), StepError> {
        let rule = self.step_rule(self.clock.dt());
        self.set_dead_loads(self.state.time);
        let Self { model, system, state, pressures, active, .. } = self;
        start(&mut FeSystem { model, system, pressures, active }, &rule, state)
    }

    fn step_rule(&self, dt: f64) -> StepRule {
        self.scheme.as_ref().map_or_else(|| StepRule::quasi_static(dt), |scheme| scheme.rule(dt))
    }

    fn set_dead_loads(&mut self, time: f64) {
        self.system.dead.fill(0.0);
        for load in &self.model.loads {
            load.add_dead(time, 1.0, &mut self.system.dead);
        }
    }

    fn set_prescribed_positions_at_start(&mut self) {
        let time = self.state.time;
        for k in 0..self.prescribed.len() {
            let (component, value) = self.prescribed_position(k, time);
            self.state.q[component] = value;
        }
    }

    fn prescribed_position(&self, k: usize, time: f64) -> (usize, f64) {
        let (component, p, column) = self.prescribed[k];
        let table = &self.model.prescriptions[p as usize].displacement;
        (component as usize, self.model.reference[component as usize] + table.value(time, column as usize))
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
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
        &self.balance
    }
    /// Pressures of each contact pair's slots.
    pub fn pressures(&self) -> &[Vec<f64>] {
        &self.pressures
    }
    /// Active slots of each contact pair.
    pub fn active(&self) -> &[Vec<bool>] {
        &self.active
    }
    /// Force that the supports exerted on prescribed components in the last step (`3 * nodes`; empty without prescriptions;
    /// zero at free components).
    pub fn reactions(&self) -> &[f64] {
        &self.reactions
    }
    /// Contact force on each node in the last step (`3 * nodes`; empty without contact).
    pub fn contact_force(&self) -> &[f64] {
        &self.contact_force
    }
    /// Seconds by phase.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }
    /// For whoever writes output, to add its seconds.
    pub fn timings_mut(&mut self) -> &mut Timings {
        &mut self.timings
    }
    /// All decisions so far.
    pub fn decisions(&self) -> &[Decision] {
        &self.decisions
    }
    /// Linear solves so far, failed attempts included.
    pub fn solves(&self) -> u64 {
        self.solves
    }
    /// What the linear solver did.
    pub fn solver_statistics(&self) -> SolverStatistics {
        self.system.solver.statistics()
    }
    /// Name of the linear solver.
    pub fn solver_name(&self) -> &str {
        self.system.solver.name()
    }
    /// Equations at present.
    pub fn equations(&self) -> usize {
        self.system.equations()
    }
    /// True at the end of the run.
    pub fn finished(&self) -> bool {
        self.clock.finished()
    }
    /// Moves the end of the run.
    pub fn set_end(&mut self, end: f64) {
        self.clock.set_end(end);
    }

    /// What the run uses.
    pub fn plan(&self) -> Plan {
        Plan {
            nodes: self.model.node_count(),
            elements: self.model.bodies.iter().map(|b| b.solid.element_count()).sum(),
            free_components: self.system.numbering.free.len(),
            prescribed_components: self.prescribed.len(),
            slots: self.pressures.iter().map(Vec::len).sum(),
            matrix_entries: self.system.matrix_entries(),
            steps: self.clock.nominal_steps(),
            mass_matrix: self.system.has_mass(),
            contact_search: !self.model.contacts.is_empty(),
            memory_bytes: self.system.memory_bytes()
                + self.model.bodies.iter().map(|b| b.solid.memory_bytes()).sum::<usize>(),
        }
    }

    /// Gap, normal and feature of every slot of a contact pair at the last completed step.
    ///
    /// # Errors
    /// If the projection fails.
    pub fn contact_report(&self, pair: usize) -> Result<Vec<SlotReport>, StepError> {
        Ok(self.model.contacts[pair].method.report(&self.state.q)?)
    }

    /// The record of the initial state (step 0).
    pub fn initial_record(&self) -> StepRecord {
        StepRecord {
            step: self.step,
            time: self.state.time,
            dt: 0.0,
            nominal: true,
            balance: self.balance,
            newton: Vec::new(),
            iterations: 0,
            decisions: Vec::new(),
            contact: None,
        }
    }

    fn measure_balance(&self, strain: f64, external_work: f64) -> Balance {
        let mut balance = Balance { strain, external_work, ..Balance::default() };
        for mass in &self.system.masses {
            balance.kinetic += mass.kinetic_energy(&self.state.v);
            let l = mass.linear_momentum(&self.state.v);
            let j = mass.angular_momentum(&self.state.q, &self.state.v);
            for i in 0..3 {
                balance.linear_momentum[i] += l[i];
                balance.angular_momentum[i] += j[i];
            }
        }
        for load in self.model.loads.iter().filter(|load| load.is_conservative()) {
            if let LoadKind::Dead { patterns } = &load.kind {
                for (column, pattern) in patterns.iter().enumerate() {
                    let magnitude = load.magnitude.value(0.0, column);
                    for &(component, unit) in pattern {
                        let c = component as usize;
                        balance.potential -= magnitude * unit * (self.state.q[c] - self.model.reference[c]);
                    }
                }
            }
        }
        balance
    }

    /// Momenta, kinetic and strain energy of one body at the last completed step (loads and contact belong to the model).
    pub fn body_balance(&self, body: usize) -> Balance {
        // The state was accepted, so its strain energy exists; NaN would show a contradiction.
        let strain = self.model.bodies[body].solid.strain_energy(&self.state.q).unwrap_or(f64::NAN);
        let mut balance = Balance { strain, ..Balance::default() };
        if let Some(mass) = self.system.masses.get(body) {
            balance.kinetic = mass.kinetic_energy(&self.state.v);
            balance.linear_momentum = mass.linear_momentum(&self.state.v);
            balance.angular_momentum = mass.angular_momentum(&self.state.q, &self.state.v);
        }
        balance
    }

    fn kinetic(&self, v: &[f64]) -> f64 {
        self.system.masses.iter().map(|m| m.kinetic_energy(v)).sum()
    }

    /// Does one step: tries the present step size and halves it as often as the settings allow.
    ///
    /// # Errors
    /// [`SimulationError::StepFailed`]; state, balance and records are then those of the last completed step.
    pub fn advance(&mut self) -> Result<StepRecord, SimulationError> {
        let first_decision = self.decisions.len();
        loop {
            match self.try_step() {
                Ok(completed) => return Ok(self.accept(completed, first_decision)),
                Err(cause) => {
                    let (time, dt) = (self.state.time, self.clock.dt());
                    if !self.clock.cut() {
                        return Err(SimulationError::StepFailed { step: self.step + 1, time, dt, cause });
                    }
                    self.decisions.push(decision(self.step + 1, time, dt, DecisionKind::Cut, cause.to_string()));
                }
            }
        }
    }

    fn try_step(&mut self) -> Result<Completed, StepError> {
        let dt = self.clock.dt();
        let time = self.state.time;
        let rule = self.step_rule(dt);
        for body in &mut self.model.bodies {
            body.solid.begin_step(&self.state.q, stress_rule(rule.force.rule))?;
        }
        if !self.model.contacts.is_empty() {
            // The farthest that two surfaces can approach each other in the step if nothing accelerates them much.
            let speed = self.state.v.chunks_exact(3).map(|v| v[0].hypot(v[1]).hypot(v[2])).fold(0.0, f64::max);
            let reach = 2.0 * speed * dt;
            let (model, state) = (&mut self.model, &self.state);
            self.timings.measure(Phase::Search, || -> Result<(), StepError> {
                for pair in &mut model.contacts {
                    pair.method.begin_step(&state.q, reach + 0.5 * pair.method.length_scale())?;
                }
                Ok(())
            })?;
        }
        self.set_dead_loads(time + rule.force.rule.load_fraction() * dt);
        match self.try_from(true, dt, rule) {
            Err(StepError::Solid(cause)) if self.predictor_moves(dt) => {
                self.decisions.push(decision(
                    self.step + 1,
                    time,
                    dt,
                    DecisionKind::Restart,
                    format!("from the predictor: {cause}"),
                ));
                self.try_from(false, dt, rule)
            }
            result => result,
        }
    }

    fn predictor_moves(&self, dt: f64) -> bool {
        vector::norm_inf(&self.state.v) * dt > 0.0
    }

    fn try_from(&mut self, predict: bool, dt: f64, rule: StepRule) -> Result<Completed, StepError> {
        let mut q = self.state.q.clone();
        if predict {
            match &self.scheme {
                Some(scheme) => scheme.predict(&self.state, dt, &mut q),
                None => vector::axpy(dt, &self.state.v, &mut q),
            }
        }
        let end = self.clock.next_time();
        for k in 0..self.prescribed.len() {
            let (component, value) = self.prescribed_position(k, end);
            q[component] = value;
        }
        let start = Iterate { q, pressures: self.pressures.clone(), active: self.active.clone() };
        let input = StepInput { step: Step { state_n: &self.state, dt, rule }, start, newton: self.newton };
        let attempt = attempt(&mut self.model, &mut self.system, input, &mut self.timings)?;
        // Whatever can still fail is done before anything of the state is changed: at the end of a midpoint step, for
        // instance, an element may be inverted although it is not at the midpoint.
        let strain = self.strain_energy(&attempt.iterate.q)?;
        let contact = self.contact_summary(&attempt)?;
        let next = self.next_state(&attempt.iterate, dt, rule)?;
        Ok(Completed { attempt, next, rule, strain, contact })
    }

    /// Velocities and whatever else the scheme carries, at the end of a converged step.
    fn next_state(&mut self, iterate: &Iterate, dt: f64, rule: StepRule) -> Result<State, StepError> {
        let mut next = State { v: self.state.v.clone(), ..State::at_rest(iterate.q.clone()) };
        let end = self.clock.next_time();
        self.set_prescribed_velocities(end, &mut next.v);
        let Self { model, system, state, .. } = self;
        let mut buffers = std::mem::take(&mut system.buffers);
        let mut fe = FeSystem { model, system, pressures: &iterate.pressures, active: &iterate.active };
        let step = Step { state_n: state, dt, rule };
        let result = finish(&mut fe, &step, &mut buffers, &mut next);
        if let Ok(true) = result {
            vector::axpy(1.0, &buffers.inertia, &mut buffers.residual);
        }
        self.system.buffers = buffers;
        result?;
        // The clock's ticks, not the sum of steps.
        next.time = end;
        Ok(next)
    }

    fn strain_energy(&self, q: &[f64]) -> Result<f64, StepError> {
        let mut energy = 0.0;
        for body in &self.model.bodies {
            energy += body.solid.strain_energy(q)?;
        }
        Ok(energy)
    }

    fn accept(&mut self, completed: Completed, first_decision: usize) -> StepRecord {
        let Completed { attempt, next, rule, strain, contact } = completed;
        let Attempt { iterate, newton, solves, .. } = attempt;
        self.solves += u64::from(solves);
        let dt = self.clock.dt();
        let (time_n, time) = (self.state.time, next.time);
        // Work of the step: loads that vary in time, follower pressures, and reactions at moving supports.
        let load_time = time_n + rule.force.rule.load_fraction() * dt;
        let mut varying = vec![0.0; self.state.q.len()];
        for load in self.model.loads.iter().filter(|load| !load.is_conservative()) {
            load.add_dead(load_time, 1.0, &mut varying);
        }
        if self.system.has_followers {
            vector::axpy(1.0, &self.system.follower, &mut varying);
        }
        for &(component, ..) in &self.prescribed {
            // The residual at a prescribed component is what the support has to exert.
            let c = component as usize;
            self.reactions[c] = self.system.buffers.residual[c];
            varying[c] += self.reactions[c];
        }
        let mut work = 0.0;
        for ((f, q1), q0) in varying.iter().zip(&next.q).zip(&self.state.q) {
            work += f * (q1 - q0);
        }
        for (c, pair) in self.model.contacts.iter_mut().enumerate() {
            pair.method.commit(&next.q, &iterate.pressures[c], &iterate.active[c]);
        }
        self.state = next;
        if self.scheme.is_some() && !self.prescribed.is_empty() {
            // Supports move with the slope of their tables; the jump of kinetic energy at a kink is work of the support.
            let before = self.kinetic(&self.state.v);
            let mut v = std::mem::take(&mut self.state.v);
            self.set_prescribed_velocities(time, &mut v);
            self.state.v = v;
            work += self.kinetic(&self.state.v) - before;
        }
        if !self.model.contacts.is_empty() {
            self.contact_force.copy_from_slice(&self.system.buffers.constraint);
        }
        self.pressures = iterate.pressures;
        self.active = iterate.active;
        self.balance = self.measure_balance(strain, self.balance.external_work + work);
        self.step += 1;
        if self.clock.accept() {
            let reason = format!("{} steps succeeded in a row", self.control.grow_after);
            self.decisions.push(decision(self.step, time, dt, DecisionKind::Grow, reason));
        }
        StepRecord {
            step: self.step,
            time,
            dt,
            nominal: self.clock.on_nominal_grid(),
            balance: self.balance,
            newton,
            iterations: solves,
            decisions: self.decisions[first_decision..].to_vec(),
            contact,
        }
    }

    fn contact_summary(&mut self, attempt: &Attempt) -> Result<Option<ContactSummary>, StepError> {
        if self.model.contacts.is_empty() {
            return Ok(None);
        }
        let Attempt { iterate, repaired, .. } = attempt;
        let mut summary = ContactSummary { repaired: *repaired, min_gap: f64::INFINITY, ..ContactSummary::default() };
        for (c, pair) in self.model.contacts.iter().enumerate() {
            let reports = self.timings.measure(Phase::Search, || pair.method.report(&iterate.q))?;
            for (slot, report) in reports.iter().enumerate() {
                let (now, then) = (iterate.active[c][slot], self.active[c][slot]);
                summary.active += usize::from(now);
                summary.closed += usize::from(now && !then);
                summary.released += usize::from(then && !now);
                summary.min_gap = summary.min_gap.min(report.gap.unwrap_or(f64::INFINITY));
                if now {
                    summary.max_pressure = summary.max_pressure.max(iterate.pressures[c][slot]);
                }
                for i in 0..3 {
                    summary.force_on_slave[i] += self.system.buffers.constraint[3 * report.node as usize + i];
                }
            }
        }
        Ok(Some(summary))
    }

    /// The present state as a checkpoint.
    pub fn checkpoint(&self, tag: &str, attachments: BTreeMap<String, Vec<u8>>) -> Checkpoint {
        Checkpoint {
            tag: tag.to_owned(),
            clock: self.clock,
            step: self.step,
            time: self.state.time,
            q: self.state.q.clone(),
            v: self.state.v.clone(),
            a: self.state.a.clone(),
            history: self.state.history.clone(),
            pressures: self.pressures.clone(),
            active: self.active.clone(),
            histories: self.model.contacts.iter().map(|p| p.method.save_history()).collect(),
            reactions: self.reactions.clone(),
            contact_force: self.contact_force.clone(),
            balance: self.balance,
            timings: self.timings,
            decisions: self.decisions.clone(),
            solves: self.solves,
            attachments,
        }
    }

    /// Continues from a checkpoint of the same scene.
    ///
    /// # Errors
    /// [`CheckpointError::Mismatch`] if tag or sizes differ.
    pub fn restore(&mut self, checkpoint: Checkpoint, tag: &str) -> Result<BTreeMap<String, Vec<u8>>, SimulationError> {
        let mismatch = |reason: String| SimulationError::Checkpoint(CheckpointError::Mismatch { reason });
        if checkpoint.tag != tag {
            return Err(mismatch(format!("it was written for {}, this is {tag}", checkpoint.tag)));
        }
        let sizes = |p: &[Vec<f64>]| p.iter().map(Vec::len).collect::<Vec<_>>();
        if checkpoint.q.len() != self.state.q.len() || sizes(&checkpoint.pressures) != sizes(&self.pressures) {
            return Err(mismatch("numbers of unknowns differ".into()));
        }
        for (pair, bytes) in self.model.contacts.iter_mut().zip(&checkpoint.histories) {
            pair.method.load_history(bytes).map_err(StepError::from)?;
        }
        self.clock = checkpoint.clock;
        self.step = checkpoint.step;
        self.state = State {
            time: checkpoint.time,
            q: checkpoint.q,
            v: checkpoint.v,
            a: checkpoint.a,
            history: checkpoint.history,
        };
        self.pressures = checkpoint.pressures;
        self.active = checkpoint.active;
        self.reactions = checkpoint.reactions;
        self.contact_force = checkpoint.contact_force;
        self.balance = checkpoint.balance;
        self.timings = checkpoint.timings;
        self.decisions = checkpoint.decisions;
        self.solves = checkpoint.solves;
        Ok(checkpoint.attachments)
    }
}
